//! A body that is dragged over the end of another.

use super::*;

/// Force on the lower body at the end, and the Newton iterations.
fn dragged(surface: &str, friction: f64, press: f64) -> ([f64; 2], f64) {
    let dragged = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "base"
element = "quad4"
x = [-6, 6]
y = [-4, 0]
cells = [6, 2]
[[mesh.block]]
name = "b"
element = "quad4"
x = [-2, 2]
y = [0, 3]
cells = [4, 2]
[[material]]
on = "base"
young = 1000
poisson = 0.3
[[material]]
on = "b"
young = 500
poisson = 0.4
[[contact]]
surface = {surface}
against = "base.top"
friction = {friction}
[[step]]
name = "press"
increments = 4
fix = [{{ on = "base.bottom", u = ["x", "y"] }}, {{ on = "b.top", u = ["x"] }}]
move = [{{ on = "b.top", u = {{ y = -{press} }} }}]
[[step]]
name = "drag"
increments = 20
fix = [{{ on = "base.bottom", u = ["x", "y"] }}]
move = [{{ on = "b.top", u = {{ x = 4.5, y = -{press} }} }}]
"#
    )));
    let last = |name: &str| dragged.history().numbers(name).pop().expect("a row");
    let force = ["x", "y"].map(|i| last(&format!("force.base.bottom.{i}")));
    (
        force,
        dragged.history().numbers("newton_iterations").iter().sum(),
    )
}

/// Its side hangs over the end, and touches nothing: with it or without it in the surface forces are the same.
#[test]
fn the_side_of_a_body_over_an_end_bears_nothing() {
    for (friction, press) in [(0.0, 0.05), (0.3, 0.4)] {
        let (bottom, alone) = dragged(r#""b.bottom""#, friction, press);
        let (both, iterations) = dragged(r#"["b.bottom", "b.right"]"#, friction, press);
        for (force, expected) in both.iter().zip(bottom) {
            assert!(
                (force - expected).abs() < 1e-8 * bottom[1].abs(),
                "friction {friction}: {both:?} {bottom:?}"
            );
        }
        assert!(iterations < 1.2 * alone, "{iterations} {alone}");
    }
}
