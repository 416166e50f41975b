//! Recorded runs and how far two of them are apart; not what is expected of them.

use crate::paper::reference;
use crate::{Check, Kind, Table};
use moreau::driver::{ContactRecord, Driver, ModelError, Step, StepError, StepReport};
use moreau::laws::Status;
use moreau::mesh::NodeKind;

/// Source named for numbers of the independent implementation.
pub(super) const INDEPENDENT: &str = "independent implementation, tests/reference";

/// Every increment of a run.
#[derive(Debug, Clone, Default)]
pub struct History {
    /// Reports.
    pub reports: Vec<StepReport>,
    /// Load after every increment, as the run defines it \[N/mm\].
    pub loads: Vec<f64>,
    /// Contact points after every increment.
    pub contacts: Vec<Vec<ContactRecord<2>>>,
}

impl History {
    /// The last load \[N/mm\]; NaN if there is none.
    pub fn last_load(&self) -> f64 {
        self.loads.last().copied().unwrap_or(f64::NAN)
    }

    /// The contact points at the end.
    pub fn last_contacts(&self) -> &[ContactRecord<2>] {
        self.contacts.last().map_or(&[], |c| c)
    }

    /// Sum of Newton iterations.
    pub fn newton_iterations(&self) -> usize {
        self.reports.iter().map(|r| r.newton_iterations).sum()
    }

    /// Largest bipotential gap of an increment over the external work done until then.
    pub fn largest_gap(&self) -> f64 {
        self.reports
            .iter()
            .map(|r| r.relative_gap().abs())
            .fold(0.0, f64::max)
    }

    /// Largest penetration of the bodies at a contact point \[mm\], springs of a penalty included.
    pub fn largest_penetration(&self) -> f64 {
        self.contacts
            .iter()
            .flatten()
            .map(|c| -c.u[0])
            .fold(0.0, f64::max)
    }

    /// Largest difference of a contact force from another run, over the largest force; infinite
    /// if the runs differ in length.
    pub fn force_difference(&self, other: &Self) -> f64 {
        if self.contacts.len() != other.contacts.len() {
            return f64::INFINITY;
        }
        let pairs = || {
            self.contacts
                .iter()
                .flatten()
                .zip(other.contacts.iter().flatten())
        };
        let largest = pairs().map(|(a, _)| a.t.norm()).fold(0.0, f64::max);
        pairs().map(|(a, b)| (a.t - b.t).norm()).fold(0.0, f64::max) / largest
    }

    /// Contact points and increments at which the status differs from another run.
    pub fn status_differences(&self, other: &Self) -> usize {
        let pairs = self
            .contacts
            .iter()
            .flatten()
            .zip(other.contacts.iter().flatten());
        pairs.filter(|(a, b)| a.status != b.status).count()
    }
}

/// Runs a step and records it, after what `history` holds already.
///
/// # Errors
/// Those of the run; what converged is in `history`.
pub fn record(
    driver: &mut Driver<2>,
    step: &Step<2>,
    increments: usize,
    load: fn(&Driver<2>) -> Result<f64, ModelError>,
    history: &mut History,
) -> Result<(), StepError> {
    let outcome = driver.run(step, increments, |driver, report| {
        history.reports.push(report.clone());
        history.loads.push(load(driver).unwrap_or(f64::NAN));
        history.contacts.push(driver.contacts().to_vec());
    });
    outcome.map(|_| ())
}

/// Largest relative difference of two columns of numbers; infinite if their lengths differ.
pub(super) fn largest_difference(computed: &[f64], expected: &[f64]) -> f64 {
    if computed.len() != expected.len() {
        return f64::INFINITY;
    }
    let relative = |(a, b): (&f64, &f64)| ((a - b) / b).abs();
    let largest = computed.iter().zip(expected).map(relative);
    largest.fold(
        0.0,
        |a, b| if b.is_nan() { f64::INFINITY } else { a.max(b) },
    )
}

/// Checks of a final state against a reference file: nodal forces, displacements and statuses.
pub(super) fn final_state_checks(what: &str, driver: &Driver<2>, file: &str) -> Vec<Check> {
    let rows = reference::rows(file);
    let number = |row: &reference::Row, column: &str| -> f64 {
        row.get(column)
            .and_then(|v| v.parse().ok())
            .unwrap_or(f64::NAN)
    };
    let largest_force = rows.iter().map(|r| number(r, "tn_N")).fold(0.0, f64::max);
    let (mut force, mut displacement) = (0.0f64, 0.0f64);
    let mut statuses = 0;
    let mut seen = 0;
    for row in &rows {
        let at = number(row, "x_mm");
        let Some(c) = driver
            .contacts()
            .iter()
            .find(|c| (c.position[0] - at).abs() < 1e-6)
        else {
            continue;
        };
        seen += 1;
        // The tangent is the x-axis, turned round where the tool is above.
        force = force.max((c.t[0] - number(row, "tn_N")).abs());
        force = force.max((c.force[0] - number(row, "tt_N")).abs());
        let u = driver.displacement(c.node);
        displacement = displacement.max((u[0] - number(row, "ux_mm")).abs());
        displacement = displacement.max((u[1] - number(row, "uy_mm")).abs());
        let same = match row.get("status").copied().unwrap_or_default() {
            "open" => c.status == Status::Open,
            "stick" => c.status == Status::Stick,
            "slip" => c.status == Status::Slip,
            "closed" | "symmetry" => c.status != Status::Open,
            _ => false,
        };
        statuses += usize::from(!same);
    }
    let missing = (rows.len().abs_diff(seen) + driver.contacts().len().abs_diff(seen)) as f64;
    let at_most = |name: String, value: (f64, &str), bound: f64| {
        Check::new(name, value, Kind::AtMost, (bound, 0.0), INDEPENDENT)
    };
    vec![
        at_most(
            format!("{what}: nodal reactions, largest difference over the largest force"),
            (force / largest_force, "1"),
            1e-8,
        ),
        at_most(
            format!("{what}: displacements and slips of contact nodes, largest difference"),
            (displacement, "mm"),
            1e-9,
        ),
        at_most(
            format!("{what}: statuses that differ"),
            (statuses as f64, "nodes"),
            0.0,
        ),
        at_most(
            format!("{what}: contact nodes without a partner"),
            (missing, "nodes"),
            0.0,
        ),
    ]
}

/// Positions \[mm\] and values of the contact points of one kind.
pub(super) fn along(
    contacts: &[ContactRecord<2>],
    kind: NodeKind,
    value: impl Fn(&ContactRecord<2>) -> f64,
) -> Vec<[f64; 2]> {
    contacts
        .iter()
        .filter(|c| c.kind == kind)
        .map(|c| [c.position[0], value(c)])
        .collect()
}

/// A number with as many digits as a table needs.
pub(super) fn digits(value: f64, digits: usize) -> String {
    format!("{value:.digits$}")
}

/// A number in scientific notation.
pub(super) fn scientific(value: f64) -> String {
    format!("{value:.2e}")
}

/// A row of [`certificate_table`].
pub(super) fn certificate_row(method: &str, history: &History) -> Vec<String> {
    let energies = history
        .reports
        .last()
        .map(|r| r.energies)
        .unwrap_or_default();
    vec![
        method.into(),
        history.reports.len().to_string(),
        scientific(history.largest_gap()),
        scientific(history.largest_penetration()),
        scientific(energies.penalty / energies.external_work),
    ]
}

/// How exact the methods were.
pub(super) fn certificate_table(name: &str, rows: Vec<Vec<String>>) -> Table {
    Table {
        name: name.into(),
        title:
            "Certificate: the bipotential gap, taken at the irreversible displacement, and what \
            it cannot see"
                .into(),
        header: [
            "method",
            "increments",
            "largest gap over external work",
            "largest penetration [mm]",
            "energy in the penalty springs over external work",
        ]
        .map(Into::into)
        .to_vec(),
        rows,
    }
}
