//! Limit loads of what has been heated or cooled: of shrink fits by their pressure, and of self-stresses that change none.

use super::*;

/// A ring of 20 mm height on a shaft, neither of which contracts across, of a yield stress, and steps.
fn fit(friction: f64, flow: f64, steps: &str) -> String {
    format!(
        r#"units = "mm-N-MPa"
analysis = "axisymmetric"
[[mesh.block]]
name = "shaft"
element = "quad8"
x = [0, 10]
y = [0, 20]
cells = [4, 6]
[[mesh.block]]
name = "ring"
element = "quad8"
x = [10, 20]
y = [0, 20]
cells = [6, 6]
[[material]]
on = "shaft"
young = 210e3
poisson = 0.0
yield-stress = {flow:?}
[[material]]
on = "ring"
young = 210e3
poisson = 0.0
expansion = 1.2e-5
yield-stress = {flow:?}
[[contact]]
surface = "ring.left"
against = "shaft.right"
friction = {friction:?}
{steps}"#
    )
}

/// A step that holds both along the axis.
fn held(name: &str, load: &str) -> String {
    format!(
        r#"[[step]]
name = "{name}"
increments = 2
fix = [{{ on = "shaft", u = ["y"] }}, {{ on = "ring", u = ["y"] }}]
load = [{load}]
"#
    )
}

const COLD: &str = r#"{ on = "ring", temperature = -150.0 }"#;

fn load_factor(deck: &str) -> f64 {
    let run = finish(simulation(deck));
    let (_, collapse) = run.outcome().collapse.clone().expect("a limit");
    assert!(!collapse.added, "{collapse}");
    collapse.load_factor
}

/// A ring that has cooled by 150 K presses by Lamé's p = E α |ΔT| (c² − b²)/(2 c²); a force b per volume pushes the shaft out at
/// μ p 2 π r h = b π r² h, whatever μ.
#[test]
fn a_shaft_is_pushed_out_at_the_friction_of_the_shrink_pressure() {
    let pressure = 210e3 * 1.2e-5 * 150.0 * (400.0 - 100.0) / 800.0;
    for friction in [0.02, 0.3] {
        let push = format!(
            r#"[[step]]
name = "push"
increments = 4
until = "collapse"
fix = [{{ on = "ring", u = ["y"] }}]
load = [{COLD}, {{ on = "shaft", body-force = [0, {:?}] }}]
"#,
            50.0 * friction
        );
        let found = load_factor(&fit(friction, 4000.0, &(held("cool", COLD) + &push)));
        let exact = friction * pressure * 2.0 / 10.0 / (50.0 * friction);
        // Cells for Lamé's stresses, and the ends of the joint.
        assert!((found / exact - 1.0).abs() < 1e-3, "{found} of {exact}");
    }
}

/// Without friction a limit load is what yields: stresses of cold change nothing of it, nor does it that they have gone again.
#[test]
fn thermal_stresses_change_no_limit_load() {
    let inside = r#"{ on = "shaft", temperature = 0.0 }, { on = "ring.right", pressure = -600.0 }"#;
    let pull = |more: &str| {
        let step = held("pull", &format!("{inside}{more}"));
        step.replace("increments = 2", "increments = 8\nuntil = \"collapse\"")
    };
    // The ring alone, pulled outwards, leaves the shaft; colder it is pressed on at first.
    let never = load_factor(&fit(0.0, 400.0, &pull("")));
    let cold = load_factor(&fit(
        0.0,
        400.0,
        &(held("cool", COLD) + &pull(&format!(", {COLD}"))),
    ));
    let again = load_factor(&fit(
        0.0,
        400.0,
        &(held("cool", COLD) + &held("warm", "") + &pull("")),
    ));
    assert!((cold / never - 1.0).abs() < 1e-5, "{cold} of {never}");
    assert!((again / never - 1.0).abs() < 1e-5, "{again} of {never}");
}
