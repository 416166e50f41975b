//! Corners of a body that go between the nodes of the surface that is kept out of it.

use super::*;

/// A billet pressed by a wider block, with either side as the surface whose nodes are kept out of the other.
fn pressed(contact: &str) -> (f64, Vec<String>) {
    let pressed = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "axisymmetric"
strain = "finite"
[[mesh.block]]
name = "w"
element = "quad8"
x = [0, 5]
y = [0, 5]
cells = [6, 6]
[[mesh.block]]
name = "t"
element = "quad8"
x = [0, 15]
y = [5, 15]
cells = [10, 6]
[[material]]
on = "w"
young = 70e3
poisson = 0.33
yield-stress = 100.0
hardening = {{ linear = 100 }}
[[material]]
on = "t"
young = 210e3
poisson = 0.3
[[contact]]
{contact}
friction = 0.1
[[step]]
name = "press"
increments = 10
fix = [{{ on = "w.bottom", u = ["y"] }}]
move = [{{ on = "t.top", u = {{ y = -1.5 }} }}]
"#
    )));
    let forces = pressed.history().numbers("force.t.top.y");
    (-forces[forces.len() - 1], pressed.outcome().warnings)
}

/// The edge of the billet goes into the block between its nodes, which takes away from the force, and is told; with the
/// billet as the surface it does not.
#[test]
fn a_corner_between_the_nodes_of_a_surface_is_told() {
    let told = |warnings: &[String]| {
        let of = |w: &&String| w.contains("of \"w.top\" is") && w.contains("within \"t.bottom\"");
        warnings.iter().filter(of).count()
    };
    let (coarse, warnings) = pressed("surface = \"t.bottom\"\nagainst = \"w.top\"");
    assert_eq!(told(&warnings), 1, "{warnings:?}");
    let (right, warnings) = pressed("surface = [\"w.top\", \"w.right\"]\nagainst = \"t.bottom\"");
    assert!(
        warnings.iter().all(|w| !w.contains("between its nodes")),
        "{warnings:?}"
    );
    assert!(coarse < 0.99 * right, "{coarse} {right}");
}
