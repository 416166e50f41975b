//! Recorded runs and how far two of them are apart; not what is expected of them.

use crate::paper::{
    BLOCK_INCREMENTS, BLOCK_TRAVEL, block, block_punch_load, block_step, reference,
};
use crate::{Check, Table};
use moreau::driver::{
    ContactRecord, Driver, IncrementError, IncrementReport, ModelError, Settings, Step,
};
use moreau::laws::Status;
use moreau::mesh::Integration;
use std::error::Error;

/// Source named for numbers of the independent implementation.
pub(super) const INDEPENDENT: &str = "independent implementation, tests/reference";

/// Every increment of a run.
#[derive(Debug, Clone, Default)]
pub struct History {
    /// Reports.
    pub reports: Vec<IncrementReport>,
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
        largest_gap(&self.reports)
    }

    /// Loads over the travel of a punch that is at `travel` in the end, in equal increments and
    /// from the origin on.
    pub(super) fn path(&self, travel: f64) -> Vec<[f64; 2]> {
        let count = self.loads.len() as f64;
        let points = (1..).zip(&self.loads);
        let points = points.map(|(i, &load)| [f64::from(i) * travel / count, load]);
        std::iter::once([0.0, 0.0]).chain(points).collect()
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
) -> Result<(), IncrementError> {
    let outcome = driver.run(step, increments, |driver, report| {
        history.reports.push(report.clone());
        history.loads.push(load(driver).unwrap_or(f64::NAN));
        history.contacts.push(driver.contacts().to_vec());
    });
    outcome.map(|_| ())
}

/// Presses the paper's block over the whole travel of its punch.
pub(super) fn press_block(
    cells: [usize; 2],
    friction: f64,
    integration: Integration,
    settings: Settings<2>,
) -> Result<(Driver<2>, History), Box<dyn Error>> {
    let mut driver = block(cells, friction, integration, settings)?;
    let mut history = History::default();
    let step = block_step(BLOCK_TRAVEL);
    record(
        &mut driver,
        &step,
        BLOCK_INCREMENTS,
        block_punch_load,
        &mut history,
    )?;
    Ok((driver, history))
}

/// Largest bipotential gap of an increment over the external work done until then.
pub(super) fn largest_gap(reports: &[IncrementReport]) -> f64 {
    let gaps = reports.iter().map(|r| r.relative_gap().abs());
    gaps.fold(0.0, f64::max)
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
    vec![
        Check::at_most(
            format!("{what}: nodal reactions, largest difference over the largest force"),
            (force / largest_force, "1"),
            1e-8,
            INDEPENDENT,
        ),
        Check::at_most(
            format!("{what}: displacements and slips of contact nodes, largest difference"),
            (displacement, "mm"),
            1e-9,
            INDEPENDENT,
        ),
        Check::at_most(
            format!("{what}: statuses that differ"),
            (statuses as f64, "nodes"),
            0.0,
            INDEPENDENT,
        ),
        Check::at_most(
            format!("{what}: contact nodes without a partner"),
            (missing, "nodes"),
            0.0,
            INDEPENDENT,
        ),
    ]
}

/// Check of a column of numbers against the same of the independent implementation.
pub(super) fn column_check(name: String, computed: &[f64], expected: &[f64]) -> Check {
    let largest = largest_difference(computed, expected);
    Check::at_most(name, (largest, "1"), 1e-8, INDEPENDENT)
}

/// Check that the contact forces obey the law.
pub(super) fn gap_check(what: &str, history: &History) -> Check {
    Check::at_most(
        format!("{what}: largest bipotential gap over the external work"),
        (history.largest_gap(), "1"),
        1e-10,
        "zero exactly at the law, [39]",
    )
}

/// Name of a rule of quadrature in the eight-node cell.
pub(super) fn quadrature(integration: Integration) -> &'static str {
    match integration {
        Integration::Reduced => "2×2",
        Integration::Full | Integration::BBar => "3×3",
    }
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
pub(super) fn certificate_row(method: &str, history: &History) -> [String; 5] {
    let energies = history
        .reports
        .last()
        .map(|r| r.energies)
        .unwrap_or_default();
    [
        method.into(),
        history.reports.len().to_string(),
        scientific(history.largest_gap()),
        scientific(history.largest_penetration()),
        scientific(energies.penalty / energies.external_work),
    ]
}

/// How exact the methods were.
pub(super) fn certificate_table(name: &str, rows: Vec<[String; 5]>) -> Table {
    let title = "Certificate: the bipotential gap, taken at the irreversible displacement, and \
        what it cannot see";
    let header = [
        "method",
        "increments",
        "largest gap over external work",
        "largest penetration [mm]",
        "energy in the penalty springs over external work",
    ];
    Table::new(name, title, header, rows)
}
