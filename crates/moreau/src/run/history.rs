//! `history.csv`: a row for each converged increment; contact points have a file of their own.

use super::number;
use crate::deck::{Setup, Units};
use crate::driver::{Driver, StepReport};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Columns of every history, each with the unit that it has.
const FIXED: [(&str, Unit); 20] = [
    ("step", Unit::None),
    ("increment", Unit::None),
    ("time", Unit::None),
    ("newton_iterations", Unit::None),
    ("contact_iterations", Unit::None),
    ("cuts", Unit::None),
    ("open", Unit::None),
    ("stick", Unit::None),
    ("slip", Unit::None),
    ("plastic_fraction", Unit::None),
    ("external_work", Unit::Energy),
    ("elastic_energy", Unit::Energy),
    ("plastic_dissipation", Unit::Energy),
    ("friction_dissipation", Unit::Energy),
    ("penalty_energy", Unit::Energy),
    ("bipotential_gap", Unit::Energy),
    ("penetration", Unit::Length),
    ("excess_force", Unit::Force),
    ("out_of_balance", Unit::Force),
    ("factorisations", Unit::None),
];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Unit {
    None,
    Length,
    Force,
    Energy,
}

/// Names of the columns of `history.csv`, without units.
pub fn columns<const D: usize>(setup: &Setup<D>) -> Vec<String> {
    let names = setup.held.iter().map(|[n, _]| n).chain(&setup.tools);
    names_of(D, names).into_iter().map(|(n, _)| n).collect()
}

fn names_of<'a>(dimension: usize, named: impl Iterator<Item = &'a String>) -> Vec<(String, Unit)> {
    let mut list: Vec<(String, Unit)> = FIXED.iter().map(|(n, u)| ((*n).into(), *u)).collect();
    for name in named {
        for (what, unit) in [("force", Unit::Force), ("u", Unit::Length)] {
            for axis in &AXES[..dimension] {
                list.push((format!("{what}.{name}.{axis}"), unit));
            }
        }
    }
    list
}

/// Where an increment is.
pub(super) struct Place<'a> {
    /// Number of the step, from 1.
    pub(super) stage: usize,
    /// Directions in which the step holds or moves each group.
    pub(super) directions: &'a [Vec<usize>],
}

/// How a row is made, and the last one.
pub(super) struct History {
    units: Units,
    columns: Vec<(String, Unit)>,
    held: Vec<[String; 2]>,
    tools: Vec<String>,
    /// The last row; empty before the first.
    pub(super) last: Vec<f64>,
}

impl History {
    pub(super) fn new(
        units: Units,
        dimension: usize,
        held: Vec<[String; 2]>,
        tools: Vec<String>,
    ) -> Self {
        Self {
            units,
            columns: names_of(dimension, held.iter().map(|[n, _]| n).chain(&tools)),
            held,
            tools,
            last: Vec::new(),
        }
    }

    /// The header: a name, and its unit in brackets if it has one.
    pub(super) fn header(&self) -> String {
        let label = |(name, unit): &(String, Unit)| match unit {
            Unit::None => name.clone(),
            Unit::Length => format!("{name} [{}]", self.units.length()),
            Unit::Force => format!("{name} [{}]", self.units.force()),
            Unit::Energy => format!("{name} [{}]", self.units.energy()),
        };
        self.columns.iter().map(label).collect::<Vec<_>>().join(",")
    }

    /// Makes the row of an increment, and returns it as a line.
    pub(super) fn record<const D: usize>(
        &mut self,
        driver: &Driver<D>,
        report: &StepReport,
        place: &Place<'_>,
    ) -> String {
        let energies = &report.energies;
        let mut row = vec![
            place.stage as f64,
            report.increment as f64,
            (place.stage - 1) as f64 + report.fraction,
            report.newton_iterations as f64,
            report.contact_iterations as f64,
            report.cuts as f64,
            report.open as f64,
            report.stick as f64,
            report.slip as f64,
            report.plastic_fraction,
            energies.external_work,
            energies.stored,
            energies.plastic_dissipation,
            energies.friction_dissipation,
            energies.penalty,
            report.certificate.bipotential_gap,
            report.certificate.penetration,
            report.certificate.excess_force,
            report.out_of_balance,
            report.factorisations as f64,
        ];
        for ([_, nodes], directions) in self.held.iter().zip(place.directions) {
            // A node on two groups is held by each along its own directions.
            let force = driver.reaction(nodes).ok();
            row.extend((0..D).map(|i| match directions.contains(&i) {
                true => force.map_or(f64::NAN, |f| f[i]),
                false => 0.0,
            }));
            let list = driver.mesh().node_group(nodes).unwrap_or_default();
            row.extend((0..D).map(|i| {
                let sum: f64 = list.iter().map(|&n| driver.displacement(n)[i]).sum();
                sum / list.len() as f64
            }));
        }
        for tool in &self.tools {
            let force = driver.tool_force(tool).ok();
            row.extend((0..D).map(|i| force.map_or(f64::NAN, |f| f[i])));
            let motion = driver.tool_displacement(tool).ok();
            row.extend((0..D).map(|i| motion.map_or(f64::NAN, |u| u[i])));
        }
        let line: Vec<String> = row.iter().map(|&v| number(v)).collect();
        self.last = row;
        line.join(",")
    }

    /// Steps done so far, with the part of the current one.
    pub(super) fn time(&self) -> f64 {
        self.last.get(2).copied().unwrap_or(0.0)
    }

    /// Names of the columns.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|(name, _)| name.as_str())
    }

    /// The last value of a column, by name.
    pub(super) fn value(&self, name: &str) -> Option<f64> {
        let index = self.names().position(|n| n == name)?;
        self.last.get(index).copied()
    }
}
