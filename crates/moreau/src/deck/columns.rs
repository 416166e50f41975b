//! The columns of `history.csv`, which expectations name; not their values.

use super::build::Setup;
use super::units::Units;

const AXES: [&str; 3] = ["x", "y", "z"];

/// Columns of every history, each with the unit that it has.
const FIXED: [(&str, Unit); 20] = [
    ("step", Unit::Count),
    ("increment", Unit::Count),
    ("time", Unit::None),
    ("newton_iterations", Unit::Count),
    ("contact_iterations", Unit::Count),
    ("cuts", Unit::Count),
    ("open", Unit::Count),
    ("stick", Unit::Count),
    ("slip", Unit::Count),
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
    ("factorisations", Unit::Count),
];

/// What a column is measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Unit {
    /// Nothing: a whole number.
    Count,
    /// Nothing: a ratio, or what a law has of its own.
    None,
    Length,
    Force,
    Stress,
    Energy,
    Degree,
}

impl Unit {
    /// How it is written; empty for a number without one.
    pub(crate) fn symbol(self, units: Units) -> &'static str {
        match self {
            Self::Count | Self::None => "",
            Self::Length => units.length(),
            Self::Force => units.force(),
            Self::Stress => units.stress(),
            Self::Energy => units.energy(),
            Self::Degree => "°",
        }
    }
}

/// Names and units: those of every history, then force and displacement of the groups that are
/// held or moved, of the tools, with their moments where they may turn, and of the surfaces of bodies that touch each other; then the largest
/// size of every field that a law has of its own.
pub(crate) fn columns<const D: usize>(setup: &Setup<D>) -> Vec<(String, Unit)> {
    let mut list: Vec<(String, Unit)> = FIXED.iter().map(|(n, u)| ((*n).into(), *u)).collect();
    let add = |list: &mut Vec<_>, name: &String| {
        for (what, unit) in [("force", Unit::Force), ("u", Unit::Length)] {
            for axis in &AXES[..D] {
                list.push((format!("{what}.{name}.{axis}"), unit));
            }
        }
    };
    setup.held.iter().for_each(|[name, _]| add(&mut list, name));
    for name in &setup.tools {
        add(&mut list, name);
        match (setup.moments, D) {
            (false, _) => {}
            (true, 3) => {
                let of = |axis| (format!("moment.{name}.{axis}"), Unit::Energy);
                list.extend(AXES.map(of));
            }
            (true, _) => {
                list.push((format!("moment.{name}"), Unit::Energy));
                list.push((format!("turn.{name}"), Unit::Degree));
            }
        }
    }
    setup.surfaces.iter().for_each(|name| add(&mut list, name));
    if setup.driver.has_large_strains() {
        list.push(("cell_quality".into(), Unit::None));
    }
    for field in setup.driver.fields() {
        let unit = match field.name.contains("stress") {
            true => Unit::Stress,
            false => Unit::None,
        };
        list.push((format!("largest.{}", field.name), unit));
    }
    list
}
