//! Ways around round tools: in a hollow, and at a distance from them.

use super::*;

/// The moment of a tool that turns about a corner of a block, over all of which it slips at the end, its dissipation in the
/// last increment, and by how much it has turned there \[rad\].
fn turned(tool: &str, (offset, strain): (f64, &str)) -> [f64; 3] {
    let turned = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "quad8"
x = [-0.5, 0.5]
y = [0, 1]
cells = [2, 2]
[[material]]
on = "b"
young = 1000.0
poisson = 0.3
[[tool]]
name = "t"
{tool}
[[contact]]
surface = "b.top"
against = "t"
friction = 0.2
gap-offset = {offset:?}
[[step]]
name = "press"
increments = 1
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "t", move = [0, -0.04] }}]
[[step]]
name = "turn"
increments = 5
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "t", move = [0, -0.04], turn = 1 }}]
"#
    )));
    let history = turned.history();
    let of = |column: &str| history.numbers(column);
    let (moment, dissipated) = (of("moment.t"), of("friction_dissipation"));
    let last = moment.len() - 1;
    let done = dissipated[last] - dissipated[last - 1];
    [moment[last], done, 0.2f64.to_radians()]
}

/// What slips on a tool that turns about its center makes heat of the work of the moment, wherever the surface of the tool is
/// within the one that is touched, and where the body is in the tool.
#[test]
fn friction_around_a_tool_is_the_work_of_its_moment() {
    for strain in ["small", "finite"] {
        let mut solid = Vec::new();
        for offset in [0.0, 1.0, -1.0] {
            let radius = 10.0 - offset;
            let tool = format!("cylinder = {{ center = [0, 11], radius = {radius:?} }}");
            let [moment, done, angle] = turned(&tool, (offset, strain));
            assert!(
                moment > 1.0 && (done / (moment * angle) - 1.0).abs() < 2e-3,
                "{strain} {offset}: {done} {moment}"
            );
            solid.push(moment);
        }
        assert!((solid[1] / solid[0] - 1.0).abs() < 1e-9, "{solid:?}");
        assert!((solid[2] / solid[0] - 1.0).abs() < 1e-9, "{solid:?}");
        let hollow = "cylinder = { center = [0, -8.98], radius = 10 }\ninside = true";
        let [moment, done, angle] = turned(hollow, (0.0, strain));
        assert!(
            moment > 1.0 && (done / (moment * angle) - 1.0).abs() < 2e-3,
            "{strain} hollow: {done} {moment}"
        );
    }
}
