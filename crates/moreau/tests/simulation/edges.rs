//! Nodes at the edge of a body that touch two tools, and slip on both.

use super::*;

/// A block on a rough floor is dragged against a rough wall by another one: along the edge slips become as small as may be,
/// where friction turns steeply with them.
#[test]
fn slips_along_an_edge_settle_however_small_they_become() {
    let dragged = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "lo"
element = "hex27"
x = [0, 4]
y = [0, 3]
z = [0, 1]
cells = [4, 3, 2]
[[mesh.block]]
name = "up"
element = "hex27"
x = [0.7, 3.1]
y = [0.3, 2.3]
z = [1, 2]
cells = [3, 3, 2]
[[material]]
on = ["lo", "up"]
young = 1000.0
poisson = 0.3
[[tool]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[tool]]
name = "wall"
plane = { point = [4.02, 0, 0], normal = [-1, 0, 0] }
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
move = [{ on = "up.front", u = { x = 0, y = 0 } }]
load = [{ on = "up.front", traction = [0, 0, -4] }]
[[step]]
name = "drag"
increments = 4
move = [{ on = "up.front", u = { x = 0.1, y = 0.03 } }]
load = [{ on = "up.front", traction = [0, 0, -4] }]
[output]
vtu = "none"
"#,
    ));
    let history = dragged.history();
    assert_eq!(history.rows(), 6);
    let iterations = history.numbers("newton_iterations");
    assert!(iterations.iter().all(|&n| n <= 20.0), "{iterations:?}");
}
