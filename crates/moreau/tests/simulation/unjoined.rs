//! Bodies that move into each other, or are pushed, where nothing is in their way.

use super::*;

fn warned(simulation: &Simulation, what: &str) -> bool {
    let warnings = simulation.outcome().warnings;
    warnings.iter().any(|said| said.contains(what))
}

/// Whether nodes of a block are said to have moved into another, 0.1 mm beside it, at the end of a step.
fn passes(strain: &str, more: &str, step: &str) -> bool {
    let ended = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
{more}
[[mesh.block]]
name = "l"
element = "quad8"
x = [0, 20]
y = [0, 10]
cells = [4, 2]
[[mesh.block]]
name = "r"
element = "quad4"
x = [20.1, 40.1]
y = [0, 10]
cells = [3, 3]
[[step]]
name = "p"
{step}
"#
    )));
    warned(
        &ended,
        "nodes have moved into another body at the end of step \"p\"",
    )
}

/// A block pushed through the gap: the run says so where no contact is between them.
#[test]
fn bodies_that_pass_through_each_other_are_told() {
    let pushed = |strain: &str, by: f64, between: &str| {
        let elastic = "material = [{ on = [\"l\", \"r\"], young = 1000, poisson = 0.3 }]";
        let step = format!(
            r#"increments = 2
fix = [{{ on = "r.right", u = ["x", "y"] }}]
move = [{{ on = "l.left", u = {{ x = {by:?}, y = 0 }} }}]"#
        );
        passes(strain, &format!("{elastic}\n{between}"), &step)
    };
    let contact = "contact = [{ surface = \"l.right\", against = \"r.left\", friction = 0 }]";
    for strain in ["small", "finite"] {
        assert!(pushed(strain, 3.0, ""), "{strain}");
        assert!(!pushed(strain, 0.09, ""), "{strain}");
        assert!(!pushed(strain, 0.5, contact), "{strain}");
    }
}

/// A bar pulled to collapse goes through another body: displacements of a mechanism have no size. A step that ends before,
/// though it goes as far, is told.
#[test]
fn a_mechanism_passes_through_nothing() {
    let pulled = |ends: &str| {
        let flows =
            "material = [{ on = [\"l\", \"r\"], young = 1000, poisson = 0.3, yield-stress = 10 }]";
        let step = format!(
            r#"increments = 5
fix = [
    {{ on = "r.right", u = ["x", "y"] }},
    {{ on = "l.left", u = ["x"] }},
    {{ on = "l.bottom", u = ["y"] }},
]
{ends}"#
        );
        passes("small", flows, &step)
    };
    let collapse = "until = \"collapse\"\nload = [{ on = \"l.right\", pressure = -20 }]";
    assert!(!pulled(collapse));
    assert!(pulled("move = [{ on = \"l.right\", u = { x = 3 } }]"));
}

/// A die on a block that lies on nothing, and on one that a floor or a condition holds.
#[test]
fn a_body_that_is_pushed_and_not_held_is_told() {
    let pressed = |strain: &str, floor: &str, fix: &str| {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 40]
y = [0, 10]
cells = [8, 4]
[[material]]
on = "b"
young = 210000
poisson = 0.3
[[tool]]
name = "die"
plane = {{ point = [0, 10], normal = [0, -1] }}
[[contact]]
surface = "b.top"
against = "die"
friction = 0.1
{floor}
[[step]]
name = "press"
increments = 2
fix = [{{ on = "b.left", u = ["x"] }}{fix}]
tools = [{{ name = "die", move = [0, -0.05] }}]
"#
        )));
        warned(&pressed, "pushed and not held")
    };
    let floor = r#"[[tool]]
name = "floor"
plane = { point = [0, 0], normal = [0, 1] }
[[contact]]
surface = "b.bottom"
against = "floor"
friction = 0.1"#;
    for strain in ["small", "finite"] {
        assert!(pressed(strain, "", ""), "{strain}");
        assert!(!pressed(strain, floor, ""), "{strain}");
        let held = ", { on = \"b.bottom\", u = [\"y\"] }";
        assert!(!pressed(strain, "", held), "{strain}");
    }
}
