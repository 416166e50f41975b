//! A body of revolution stays on its axis, without being held there.

use super::*;

/// A cone pressed into a disc, its tip on the axis, or a load on the disc alone.
fn disc(strain: &str, conditions: &str) -> String {
    format!(
        r#"units = "mm-N-MPa"
analysis = "axisymmetric"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "quad4"
x = [0, 4]
y = [0, 4]
cells = [4, 4]
[[material]]
on = "b"
young = 210000.0
poisson = 0.3
yield-stress = 300.0
hardening = {{ linear = 1000.0 }}
[[tool]]
name = "cone"
polyline = [[8, 12], [0, 4], [-8, 12]]
[[contact]]
surface = "b.top"
against = "cone"
friction = 0.1
[[step]]
name = "press"
increments = 5
{conditions}
"#
    )
}

/// As where the axis is held by conditions, to the bit.
#[test]
fn nodes_on_the_axis_stay_there() {
    for (strain, depth) in [("small", 0.02), ("finite", 0.5)] {
        let press = |fixed: &str| {
            let conditions = format!(
                "fix = [{{ on = \"b.bottom\", u = [\"y\"] }}{fixed}]\n\
                 tools = [{{ name = \"cone\", move = [0, -{depth}] }}]"
            );
            finish(simulation(&disc(strain, &conditions)))
        };
        let pressed = press("");
        let held = press(", { on = \"b.left\", u = [\"x\"] }");
        let radial = |s: &Simulation| {
            s.displacements()
                .iter()
                .step_by(2)
                .copied()
                .take(25)
                .collect::<Vec<_>>()
        };
        assert_eq!(pressed.displacements(), held.displacements(), "{strain}");
        assert!(radial(&pressed).iter().any(|u| *u > 0.0), "{strain}");
        let load = |s: &Simulation| s.history().numbers("force.cone.y").last().copied();
        assert!(load(&pressed).is_some_and(|f| f < -100.0), "{strain}");
    }
}

/// What would move the axis, or press on what has no area.
#[test]
fn nothing_crosses_the_axis() {
    let refused = |conditions: &str| {
        let text = disc("small", conditions);
        let (simulation, findings) = Simulation::open(&text, &examples(), &Given::default());
        assert!(simulation.is_none(), "{conditions}");
        findings.render("deck", &text, false)
    };
    let hold = "fix = [{ on = \"b.bottom\", u = [\"y\"] }]\n";
    let moved = refused(&format!(
        "{hold}move = [{{ on = \"b.left\", u = {{ x = 0.1 }} }}]"
    ));
    let across = "moves node 0 by 0.1 mm across the axis of symmetry, by the conditions on \"b.bottom\" and \"b.left\"";
    assert!(moved.contains(across), "{moved}");
    for load in ["force = [1000, 0]", "pressure = 5", "traction = [0, 3]"] {
        let loaded = refused(&format!("{hold}load = [{{ on = \"b.left\", {load} }}]"));
        let area = "loads \"b.left\", which is on the axis of symmetry: it has no area";
        assert!(loaded.contains(area), "{loaded}");
    }
    let ball = |x: f64| {
        let conditions = format!("{hold}tools = [{{ name = \"cone\", move = [{x}, -0.02] }}]");
        let polyline = "polyline = [[8, 12], [0, 4], [-8, 12]]";
        disc("small", &conditions).replace(polyline, "sphere = { center = [0, 9], radius = 5 }")
    };
    let (moved, findings) = Simulation::open(&ball(1.0), &examples(), &Given::default());
    assert!(
        moved.is_none()
            && findings
                .render("deck", &ball(1.0), false)
                .contains("motion along x of tool \"cone\" is 1, expected none")
    );
    finish(simulation(&ball(0.0)));
    // A force along the axis is one of points.
    let along = format!("{hold}load = [{{ on = \"b.left\", force = [0, -10] }}]");
    finish(simulation(&disc("small", &along)));
}
