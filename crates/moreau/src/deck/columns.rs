//! The columns of `history.csv`, which expectations name; not their values.

use super::build::Setup;
use super::described::{Described, Unit};

const AXES: [&str; 3] = ["x", "y", "z"];

/// Columns of every history, in their order.
const FIXED: [Described; 20] = [
    Described::new("step", Unit::Count, "Number of the step, from 1."),
    Described::new(
        "increment",
        Unit::Count,
        "Number of the increment since the virgin state, from 1.",
    ),
    Described::new(
        "time",
        Unit::None,
        "Steps done, with the part of the one under way: 1.5 is halfway through the second. It falls where the load of a step does.",
    ),
    Described::new(
        "newton_iterations",
        Unit::Count,
        "Newton iterations of the increment, those on ways that led to no balance among them; not those before a cut.",
    ),
    Described::new(
        "contact_iterations",
        Unit::Count,
        "Iterations of the contact solver, summed over the Newton iterations.",
    ),
    Described::new(
        "cuts",
        Unit::Count,
        "Times that the increment was halved before it converged.",
    ),
    Described::new("open", Unit::Count, "Contact points that are open."),
    Described::new(
        "stick",
        Unit::Count,
        "Contact points that stick; those held along the surface by a condition are not counted.",
    ),
    Described::new(
        "slip",
        Unit::Count,
        "Contact points that slip; those held along the surface by a condition are not counted.",
    ),
    Described::new(
        "plastic_fraction",
        Unit::None,
        "Part of the volume in which plastic strain grew in the increment.",
    ),
    Described::new(
        "external_work",
        Unit::Energy,
        "Work of loads, prescribed displacements and tools so far.",
    ),
    Described::new(
        "elastic_energy",
        Unit::Energy,
        "Energy stored in the bodies: elastic, and what hardening stores.",
    ),
    Described::new(
        "plastic_dissipation",
        Unit::Energy,
        "Energy dissipated by plastic flow so far.",
    ),
    Described::new(
        "friction_dissipation",
        Unit::Energy,
        "Energy dissipated by friction so far.",
    ),
    Described::new(
        "penalty_energy",
        Unit::Energy,
        "Energy held by the springs of the penalty method; zero for exact methods.",
    ),
    Described::new(
        "bipotential_gap",
        Unit::Energy,
        "Certificate: sum over the contacts of the bipotential and the work of the forces, zero exactly where the contact law holds.",
    ),
    Described::new(
        "penetration",
        Unit::Length,
        "Certificate: largest penetration of a contact point.",
    ),
    Described::new(
        "excess_force",
        Unit::Force,
        "Certificate: largest distance of a contact force to the friction cone.",
    ),
    Described::new(
        "out_of_balance",
        Unit::Force,
        "Largest force at a node that nothing balances.",
    ),
    Described::new(
        "factorisations",
        Unit::Count,
        "Sparse factorisations of the increment.",
    ),
];

const NAMED: &str = "NAME is a group that a step fixes or moves, a tool, a surface of a contact between bodies or of a tie, or a probe";
const FORCE: Described = Described::new(
    "force.NAME.AXIS",
    Unit::Force,
    "Force on the body: of a group along the directions in which the step holds or moves it, and what is left of the \
     reactions that a step lets go; of a tool, of a surface by its own contacts and ties, and of a probe by all contacts \
     and what holds it or is left of that. Loads are no part of it. Groups that share \
     nodes with one that is held share its reactions. Under axial symmetry x is the sum of radial forces, all around.",
)
.when(NAMED);
const DISPLACEMENT: Described = Described::new(
    "u.NAME.AXIS",
    Unit::Length,
    "Displacement since the virgin state: of a tool its own, of a group or surface the mean of its nodes.",
)
.when(NAMED);
const MOMENT: Described = Described::new(
    "moment.NAME.AXIS",
    Unit::Energy,
    "Moment of the forces of a tool on the body about the reference point of the tool, where that is now.",
)
.when("NAME is a tool in space, under large strains or where a tool turns");
const MOMENT_IN_PLANE: Described = Described::new(
    "moment.NAME",
    Unit::Energy,
    "Moment of the forces of a tool on the body about the reference point of the tool, about the third axis.",
)
.when("NAME is a tool in the plane, under large strains or where a tool turns");
const TURN: Described = Described::new(
    "turn.NAME",
    Unit::Degree,
    "Rotation of a tool since the virgin state, about the third axis.",
)
.when("NAME is a tool in the plane, under large strains or where a tool turns");
const TURN_IN_SPACE: Described = Described::new(
    "turn.NAME.AXIS",
    Unit::Degree,
    "Rotation of a tool since the virgin state: along the axis of the rotation, as long as its angle.",
)
.when("NAME is a tool in space, under large strains or where a tool turns");
const QUALITY: Described = Described::new(
    "cell_quality",
    Unit::None,
    "Quality of the worst cell where the body is now.",
)
.when("under large strains");
const LARGEST_STRESS: Described = Described::new(
    "largest.STRESS",
    Unit::Stress,
    "Largest size of a field of a law over its points: of a scalar its absolute value, of a vector its length, of a tensor \
     the equivalent value √(3/2 s : s).",
)
.when("STRESS is a field that a law has of its own, with `stress` in its name");
const LARGEST: Described = Described::new(
    "largest.FIELD",
    Unit::None,
    "The same of a field that is no stress, in the unit that the law has for it.",
)
.when("FIELD is a field that a law has of its own, without `stress` in its name");

/// All columns that a history may have, each kind once.
pub(crate) fn history_columns() -> impl Iterator<Item = &'static Described> {
    const NAMED: [Described; 9] = [
        FORCE,
        DISPLACEMENT,
        MOMENT,
        MOMENT_IN_PLANE,
        TURN,
        TURN_IN_SPACE,
        QUALITY,
        LARGEST_STRESS,
        LARGEST,
    ];
    FIXED.iter().chain(&NAMED)
}

/// Names and units: those of every history, then force and displacement of the groups that are held or moved, of the
/// tools, with their moments where they may turn, and of the surfaces of bodies that touch each other; then the largest
/// size of every field that a law has of its own.
pub(crate) fn columns<const D: usize>(setup: &Setup<D>) -> Vec<(String, Unit)> {
    let mut list: Vec<_> = FIXED.iter().map(|c| (c.name.to_owned(), c.unit)).collect();
    let axes = &AXES[..D];
    let add = |list: &mut Vec<_>, name: &String| {
        list.extend(axes.iter().map(|axis| named(&FORCE, name, axis)));
        list.extend(axes.iter().map(|axis| named(&DISPLACEMENT, name, axis)));
    };
    setup.held.iter().for_each(|[name, _]| add(&mut list, name));
    for name in &setup.tools {
        add(&mut list, name);
        match (setup.moments, D) {
            (false, _) => {}
            (true, 3) => {
                let both = [&MOMENT, &TURN_IN_SPACE].into_iter();
                list.extend(both.flat_map(|c| AXES.map(|axis| named(c, name, axis))));
            }
            (true, _) => list.extend([&MOMENT_IN_PLANE, &TURN].map(|c| named(c, name, ""))),
        }
    }
    setup.surfaces.iter().for_each(|name| add(&mut list, name));
    if setup.driver.has_large_strains() {
        list.push((QUALITY.name.to_owned(), QUALITY.unit));
    }
    for field in setup.driver.fields() {
        let (column, word) = match field.name.contains("stress") {
            true => (LARGEST_STRESS, "STRESS"),
            false => (LARGEST, "FIELD"),
        };
        list.push((column.name.replace(word, &field.name), column.unit));
    }
    list
}

/// One of the columns of a kind, with its unit.
fn named(column: &Described, name: &str, axis: &str) -> (String, Unit) {
    // The axis first: a name may have its word in it.
    let of_axis = column.name.replace("AXIS", axis);
    (of_axis.replace("NAME", name), column.unit)
}
