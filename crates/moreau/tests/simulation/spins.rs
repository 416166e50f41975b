//! A body that spreads under friction between platens is unstable where it buckles, and not because it might spin.

use super::*;

/// A prism of a width and a height under a platen that comes down, on a floor with the friction of the platen.
fn pressed(
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
strain = "finite"
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
        let warnings = pressed(2.0, 40.0, [1, 10], 0.4, friction, ["", CLAMPED, ""]);
        assert!(is_unstable(&warnings), "{friction}: {warnings:?}");
    }
}
