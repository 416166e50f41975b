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
