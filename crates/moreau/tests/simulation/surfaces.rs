//! Forces on surfaces are those of their contacts, also where they share nodes with others.

use super::*;

/// Two blocks on a base: one is pushed against the other until both slide. They share the nodes at their lower corners.
#[test]
fn surfaces_that_share_a_node_have_the_forces_of_their_own_contacts() {
    let pushed = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
[[mesh.block]]
name = "base"
element = "quad8"
x = [-10, 60]
y = [-5, 0]
cells = [14, 2]
[[mesh.block]]
name = "l"
element = "quad8"
x = [0, 20]
y = [0, 10]
cells = [4, 4]
[[mesh.block]]
name = "r"
element = "quad8"
x = [20.1, 40.1]
y = [0, 10]
cells = [4, 4]
[[material]]
on = ["l", "r", "base"]
young = 210000.0
poisson = 0.3
[[contact]]
surface = "l.bottom"
against = "base.top"
friction = 0.2
[[contact]]
surface = "r.bottom"
against = "base.top"
friction = 0.2
[[contact]]
surface = "l.right"
against = "r.left"
friction = 0.2
[[step]]
name = "press"
increments = 1
fix = [{ on = "base.bottom", u = ["x", "y"] }, { on = "l.left", u = ["x"] }]
load = [{ on = "l.top", pressure = 10 }, { on = "r.top", pressure = 10 }]
[[step]]
name = "slide"
increments = 4
fix = [{ on = "base.bottom", u = ["x", "y"] }]
move = [{ on = "l.left", u = { x = 1 } }]
load = [{ on = "l.top", pressure = 10 }, { on = "r.top", pressure = 10 }]
"#,
    ));
    let force = |column: &str| {
        let all = pushed.history().numbers(column);
        all[all.len() - 1]
    };
    let within = |part: f64, a: f64, b: f64| assert!((a - b).abs() < part * a.abs(), "{a} {b}");
    for i in ["x", "y"] {
        let on = |surface: &str| force(&format!("force.{surface}.{i}"));
        within(1e-7, on("l.right"), -on("r.left"));
        within(1e-7, on("base.top"), -on("l.bottom") - on("r.bottom"));
    }
    // All of both bottoms slips, along surfaces that loads have tilted a little, and nothing but that holds the right block.
    for block in ["l", "r"] {
        let on = |i: &str| force(&format!("force.{block}.bottom.{i}"));
        within(1e-4, on("x"), -0.2 * on("y"));
    }
    within(1e-7, force("force.r.left.x"), -force("force.r.bottom.x"));
    within(
        1e-7,
        force("force.r.left.y") + force("force.r.bottom.y"),
        200.0,
    );
}
