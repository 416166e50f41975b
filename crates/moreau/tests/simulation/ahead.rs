//! Tools beside facets whose nodes between corners have one gap with those.

use super::*;

/// A ball beside the long sides of `tet10` bears on nodes that it does not reach, whatever the units, and the run says so.
#[test]
fn a_tool_that_bears_on_what_it_does_not_reach_is_told() {
    let pressed = |element: &str, units: &str, length: f64, young: f64| {
        let [x, y, z, radius, ahead] = [4.0, 3.0, 2.0, 6.0, 0.003].map(|l| l * length);
        let center = [2.392, 1.111, 8.01].map(|l| l * length);
        let ball = finish(simulation(&format!(
            r#"units = "{units}"
analysis = "solid"
[[mesh.block]]
name = "a"
element = "{element}"
x = [0, {x:?}]
y = [0, {y:?}]
z = [0, {z:?}]
cells = [2, 1, 1]
[[material]]
on = "a"
young = {young:?}
poisson = 0.3
[[tool]]
name = "t"
sphere = {{ center = {center:?}, radius = {radius:?} }}
[[contact]]
surface = "a.front"
against = "t"
friction = 0
[[step]]
name = "p"
increments = 1
fix = [{{ on = "a.back", u = ["x", "y", "z"] }}]
tools = [{{ name = "t", move = [0, 0, {:?}] }}]
"#,
            -ahead
        )));
        let warnings = ball.outcome().warnings;
        let told = warnings.iter().any(|w| w.contains("\"t\" bears on node"));
        (told, ball.history().numbers("force.t.z")[0])
    };
    let (told, force) = pressed("tet10", "mm-N-MPa", 1.0, 210e3);
    let (also, same) = pressed("tet10", "m-N-Pa", 1e-3, 210e9);
    assert!(told && also && force < -1e3);
    assert!((same / force - 1.0).abs() < 1e-6, "{same} {force}");
    assert_eq!(pressed("hex8", "mm-N-MPa", 1.0, 210e3), (false, 0.0));
}

/// A block that is about to topple leaves its floor, a plane that holds nodes between corners of which one is away: it bends,
/// and no curve is too much for its facets.
#[test]
fn what_a_plane_lets_go_of_is_no_matter_of_a_curve() {
    let lifted = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "b"
element = "hex20"
x = [0, 2]
y = [0, 2]
z = [0, 1]
cells = [4, 4, 2]
[[material]]
on = "b"
young = 1000
poisson = 0.3
[[tool]]
name = "floor"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[contact]]
surface = "b.back"
against = "floor"
friction = 1.5
[[step]]
name = "press"
increments = 1
load = [{ on = "b.front", traction = [0, 0, -2.0] }]
[[step]]
name = "push"
increments = 4
load = [{ on = "b.front", traction = [0.9, 0.2, -2.0] }]
"#,
    ));
    assert!(lifted.history().numbers("open")[4] > 5.0);
    let warnings = lifted.outcome().warnings;
    let told = warnings.iter().any(|w| w.contains("bears on node"));
    assert!(!told, "{warnings:?}");
}
