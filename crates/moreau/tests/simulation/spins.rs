//! A body that spreads under friction between platens is unstable where it buckles, and not because it might spin.

use super::*;

/// A prism of a width and a height under a platen that comes down, on a floor with the friction of the platen.
fn pressed(
    strain: &str,
    width: f64,
    height: f64,
    cells: [usize; 2],
    way: f64,
    friction: f64,
    more: [&str; 3],
) -> Vec<String> {
    let half = 0.5 * width;
    let ([across, along], [flow, floor, platen]) = (cells, more);
    let simulation = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "solid"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "hex8"
x = [-{half}, {half}]
y = [0, {height}]
z = [-{half}, {half}]
cells = [{across}, {along}, {across}]
[[material]]
on = "b"
young = 210e3
poisson = 0.3
{flow}
[[tool]]
name = "platen"
plane = {{ point = [0, {height}, 0], normal = [0, -1, 0] }}
[[contact]]
surface = "b.top"
against = "platen"
friction = {friction}
{floor}
tools = [{{ name = "platen", move = [0, -{way}, 0]{platen} }}]
"#
    )));
    simulation.outcome().warnings.clone()
}

const FLOW: &str = "yield-stress = 300.0\nhardening = { linear = 500.0 }";
const LOOSE: &str = r#"[[tool]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 1, 0] }
[[contact]]
surface = "b.bottom"
against = "floor"
friction = 0.1
[[step]]
name = "press"
increments = 2"#;
const CLAMPED: &str = r#"[[step]]
name = "press"
increments = 8
fix = [{ on = "b.bottom", u = ["x", "y", "z"] }]"#;

fn is_unstable(warnings: &[String]) -> bool {
    warnings
        .iter()
        .any(|w| w.contains("equilibrium is unstable"))
}

#[test]
fn a_short_block_that_spreads_under_friction_is_stable() {
    let turns = ", moment = { axis = [0, 1, 0], value = 0 }";
    for platen in ["", turns] {
        for (width, height) in [(10.0, 10.0), (20.0, 5.0)] {
            let warnings = pressed(
                "finite",
                width,
                height,
                [2, 2],
                0.1 * height,
                0.1,
                [FLOW, LOOSE, platen],
            );
            assert!(!is_unstable(&warnings), "{warnings:?}");
        }
    }
}

/// Its top slips outwards at every node, and may go aside.
#[test]
fn a_slender_column_that_slips_buckles() {
    for friction in [0.0, 0.01] {
        let warnings = pressed(
            "finite",
            2.0,
            40.0,
            [1, 10],
            0.4,
            friction,
            ["", CLAMPED, ""],
        );
        assert!(is_unstable(&warnings), "{friction}: {warnings:?}");
    }
}

/// Under small strains, too, the critical load factor is that of the body and not of a spin.
#[test]
fn a_slab_that_may_spin_about_the_one_node_that_sticks_does_not_buckle() {
    let buckles = |warnings: &[String]| warnings.iter().any(|w| w.contains("buckling"));
    let slid = finish(simulation(SLAB)).outcome();
    assert_eq!(slid.contacts[1], 1, "one sticks: {:?}", slid.contacts);
    assert!(!buckles(&slid.warnings), "{:?}", slid.warnings);
    for friction in [0.0, 0.01] {
        let column = pressed(
            "small",
            2.0,
            40.0,
            [1, 10],
            0.4,
            friction,
            ["", CLAMPED, ""],
        );
        assert!(buckles(&column), "{friction}: {column:?}");
    }
}

/// A slab between a floor and a punch that is dragged across it, both with friction, once a wall has pushed it back.
const SLAB: &str = r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "lo"
element = "hex8"
x = [0,4]
y = [0,3]
z = [0,1]
cells = [4,3,2]
[[mesh.block]]
name = "up"
element = "hex8"
x = [0.7,3.1]
y = [0.3,2.3]
z = [1,2]
cells = [3,3,2]
[[material]]
on = ["lo","up"]
young = 1000.0
poisson = 0.3
yield-stress = 20.0
hardening = { linear = 50.0 }
[[tool]]
name = "floor"
plane = { point = [0,0,0],normal = [0.0, 0.0, 1.0] }
[[tool]]
name = "wall"
plane = { point = [4.02, 0.0, 0.0],normal = [-1.0, 0.0, 0.0] }
[[contact]]
surface = "lo.back"
against = "floor"
friction = 0.2
[[contact]]
surface = "lo.right"
against = "wall"
friction = 0.1
[[contact]]
surface = "up.back"
against = "lo.front"
friction = 0.4


[[step]]
name = "press"
increments = 2
move = [{ on = "up.front",along = [1.0, 0.0, 0.0],u = 0.0 },{ on = "up.front",along = [0.0, 1.0, 0.0],u = 0.0 }]
load = [{ on = "up.front",traction = [0.0, 0.0, -4.0] }]
tools = [{ name = "wall",move = [0.0, 0.0, 0.0] }]

[[step]]
name = "drag"
increments = 4
move = [{ on = "up.front",along = [1.0, 0.0, 0.0],u = 0.1 },{ on = "up.front",along = [0.0, 1.0, 0.0],u = 0.03 }]
load = [{ on = "up.front",traction = [0.0, 0.0, -4.0] }]
tools = [{ name = "wall",move = [0.0, 0.0, 0.0] }]

[[step]]
name = "rev"
increments = 4
move = [{ on = "up.front",along = [1.0, 0.0, 0.0],u = -0.05 },{ on = "up.front",along = [0.0, 1.0, 0.0],u = -0.015 }]
load = [{ on = "up.front",traction = [0.0, 0.0, -4.0] }]
tools = [{ name = "wall",move = [0.0, 0.0, 0.0] }]

[[step]]
name = "wall"
increments = 2
move = [{ on = "up.front",along = [1.0, 0.0, 0.0],u = -0.05 },{ on = "up.front",along = [0.0, 1.0, 0.0],u = -0.015 }]
load = [{ on = "up.front",traction = [0.0, 0.0, -4.0] }]
tools = [{ name = "wall",move = [-0.06, 0.0, 0.0] }]

[[step]]
name = "off"
increments = 2
move = [{ on = "up.front",along = [1.0, 0.0, 0.0],u = -0.05 },{ on = "up.front",along = [0.0, 1.0, 0.0],u = -0.015 }]
load = [{ on = "up.front",traction = [0.0, 0.0, -0.5] }]
tools = [{ name = "wall",move = [0.1, 0.0, 0.0] }]
"#;
