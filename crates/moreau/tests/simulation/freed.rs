//! What is let go may move as a rigid body, which is no instability.

use super::*;

/// A block is squeezed between two tools and then free.
#[test]
fn a_body_that_is_let_go_is_not_unstable() {
    let freed = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [-10, 10]
y = [0, 4]
cells = [9, 2]
[[material]]
on = "b"
young = 70e3
poisson = 0.33
yield-stress = 150.0
hardening = { linear = 500 }
[[tool]]
name = "f"
plane = { point = [0, 0], normal = [0, 1] }
[[tool]]
name = "d"
plane = { point = [0, 4], normal = [0, -1] }
[[contact]]
surface = "b.bottom"
against = "f"
friction = 0.6
[[contact]]
surface = "b.top"
against = "d"
friction = 0.6
[[step]]
name = "press"
increments = 4
tools = [{ name = "d", move = [0, -0.09] }]
[[step]]
name = "drag"
increments = 6
tools = [{ name = "d", move = [0.05, -0.09] }]
[[step]]
name = "release"
increments = 4
tools = [{ name = "d", move = [0.05, 0.05] }]
"#,
    ));
    let warnings = &freed.outcome().warnings;
    assert!(
        warnings
            .iter()
            .any(|w| w.contains("rigid motions are free")),
        "{warnings:?}"
    );
    assert!(
        !warnings.iter().any(|w| w.contains("unstable")),
        "{warnings:?}"
    );
}
