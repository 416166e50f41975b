//! Contacts that are far from touching change nothing, and cost little.

use super::*;

/// A strip on two rolls under a third, which press it and then turn: only they hold it.
fn rolled(groups: &str, [top, left, right]: [&str; 3]) -> Simulation {
    finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "s"
element = "quad8"
x = [-40, 40]
y = [0, 2]
cells = [40, 2]
{groups}
[[material]]
on = "s"
young = 210000.0
poisson = 0.3
yield-stress = 300.0
hardening = {{ linear = 1000.0 }}
[[tool]]
name = "top"
cylinder = {{ center = [0, 6], radius = 4 }}
[[tool]]
name = "l"
cylinder = {{ center = [-12, -4], radius = 4 }}
[[tool]]
name = "r"
cylinder = {{ center = [12, -4], radius = 4 }}
[[contact]]
surface = "{top}"
against = "top"
friction = 0.2
[[contact]]
surface = "{left}"
against = "l"
friction = 0.2
[[contact]]
surface = "{right}"
against = "r"
friction = 0.2
[[step]]
name = "press"
increments = 5
tools = [{{ name = "top", move = [0, -1.5], turn = 0 }}, {{ name = "l", turn = 0 }}, {{ name = "r", turn = 0 }}]
[[step]]
name = "roll"
increments = 4
tools = [{{ name = "top", move = [0, -1.5], turn = 24 }}, {{ name = "l", turn = -24 }}, {{ name = "r", turn = -24 }}]
"#
    )))
}

/// Whole surfaces are given as contacts, or the parts of them at the rolls.
#[test]
fn surfaces_beside_the_rolls_change_nothing() {
    let group = |name: &str, on: &str, [from, to]: [i32; 2]| {
        format!("[[mesh.group]]\nname = \"{name}\"\non = \"{on}\"\nx = [{from}, {to}]\n")
    };
    let groups = group("above", "s.top", [-8, 8])
        + &group("left", "s.bottom", [-18, -6])
        + &group("right", "s.bottom", [6, 18]);
    let near = rolled(&groups, ["above", "left", "right"]);
    let all = rolled("", ["s.top", "s.bottom", "s.bottom"]);
    for column in ["force.top.y", "force.l.x", "force.r.y", "moment.r"] {
        let (near, all) = (
            near.history().numbers(column),
            all.history().numbers(column),
        );
        let largest = near.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
        assert!(largest > 1.0 && near.len() == all.len(), "{column}");
        for (near, all) in near.iter().zip(&all) {
            assert!(
                (near - all).abs() < 1e-6 * largest,
                "{column}: {near} {all}"
            );
        }
    }
    let iterations = |s: &Simulation| s.outcome().contact_iterations;
    assert!(
        iterations(&all) < 2 * iterations(&near),
        "{} {}",
        iterations(&all),
        iterations(&near)
    );
}
