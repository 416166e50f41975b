//! What is told of a tool whose force is not carried: beyond the limit load, or held by nothing.

use super::*;

/// The whole message of a block without hardening under a punch that a force drives, in so few increments that no limit is
/// found.
fn stopped(punch: &str, force: &str, young: f64) -> String {
    let mut simulation = simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 30]
y = [0, 20]
cells = [6, 4]
[[material]]
on = "b"
young = {young}
poisson = 0.3
yield-stress = 300.0
[[tool]]
name = "punch"
{punch}
[[contact]]
surface = "b.top"
against = "punch"
friction = 0.1
[[step]]
name = "press"
increments = {{ start = 0.5, min = 0.1, max = 0.5 }}
fix = [{{ on = "b.bottom", u = ["x", "y"] }}, {{ on = "b.left", u = ["x"] }}]
tools = [{{ name = "punch", force = {force} }}]
"#
    ));
    let error = simulation.advance(&mut |_, _| ControlFlow::Continue(()));
    let error = error.expect_err("not carried");
    format!("{error}\n{:?}", simulation.outcome().diagnosis)
}

const FLAT: &str = "profile = { points = [[6, 40], [6, 20], [-1, 20]], radii = [0.5] }";
const ROUND: &str = "cylinder = { center = [0, 30], radius = 10 }";

/// A punch that is moved would go on.
#[test]
fn a_force_beyond_the_limit_load_is_told_as_that() {
    for punch in [FLAT, ROUND] {
        let told = stopped(punch, "[0, -200000]", 210e3);
        assert!(told.contains("beyond the limit load"), "{told}");
        assert!(!told.contains("nothing holds"), "{told}");
        assert!(!told.contains("missing support"), "{told}");
    }
}

/// Ten times what friction bears, and hardly any pressure.
#[test]
fn a_force_that_drags_its_tool_off_is_not_beyond_the_limit_load() {
    let told = stopped(FLAT, "[3000, -2000]", 210e3);
    assert!(told.contains("nothing holds the tool"), "{told}");
    assert!(told.contains("missing support"), "{told}");
    assert!(!told.contains("limit load"), "{told}");
}
