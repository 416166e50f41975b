//! Rolls that are nearly flat.

use super::*;

/// Force and cuts of a block that is pressed by 0.02 mm with a tool that touches its top at one end.
fn pressed(tool: &str) -> (f64, f64) {
    let pressed = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
[[mesh.block]]
name = "pad"
element = "quad8"
x = [0, 9]
y = [0, 5]
cells = [7, 3]
[[material]]
on = "pad"
young = 100e3
poisson = 0.33
[[tool]]
name = "die"
{tool}
[[contact]]
surface = "pad.top"
against = "die"
friction = 0.1
[[step]]
name = "press"
increments = 5
fix = [{{ on = "pad.bottom", u = ["x", "y"] }}, {{ on = "pad.left", u = ["x"] }}]
tools = [{{ name = "die", move = [0, -0.02] }}]
[output]
vtu = "none"
"#
    )));
    let force = pressed.history().numbers("force.die.y");
    let cuts = pressed.history().numbers("cuts").iter().sum();
    (*force.last().expect("an increment"), cuts)
}

/// Their gaps are as exact as those of a plane, which they become: from the first 9 mm of the surface that of a radius R is
/// 81/(2R) mm away at most, over which a force of 4729 N is that of 0.02 mm.
#[test]
fn a_flat_roll_presses_as_a_plane() {
    let (plane, _) = pressed("plane = { point = [0, 5], normal = [0, -1] }");
    for radius in [1e3, 2e3, 3e3, 3e4, 3e6, 3e8] {
        let center = 5.0 + radius;
        let (roll, cuts) = pressed(&format!(
            "cylinder = {{ center = [0, {center:?}], radius = {radius:?} }}"
        ));
        let farther = 40.5 / radius / 0.02;
        assert!(
            cuts == 0.0 && roll.abs() <= plane.abs() && roll / plane > 1.0 - farther,
            "{radius}: {roll} {plane}"
        );
    }
}
