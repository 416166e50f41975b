//! Cells that are turned inside out where nothing is integrated.

use super::*;

/// The free side of a strip that is squeezed folds over itself: corners of cells turn inside out, and their points do not.
#[test]
fn cells_that_fold_at_their_corners_are_told_as_inside_out() {
    let squeezed = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 10]
y = [0, 2]
cells = [20, 4]
[[material]]
on = "b"
young = 70000.0
poisson = 0.33
yield-stress = 173.2
[[tool]]
name = "p"
plane = { point = [0, 2], normal = [0, -1] }
[[contact]]
surface = ["b.top", "b.right"]
against = "p"
friction = { coulomb = 0.5, tau-max = 50 }
[[step]]
name = "squeeze"
increments = 20
fix = [{ on = "b.left", u = ["x"] }, { on = "b.bottom", u = ["y"] }]
tools = [{ name = "p", move = [0, -0.7] }]
"#,
    ));
    let quality = squeezed.history().numbers("cell_quality");
    let first = quality
        .iter()
        .position(|&q| q < 0.0)
        .expect("one that folds");
    let warnings = squeezed.outcome().warnings.clone();
    let told = format!("first was turned so in increment {};", first + 1);
    assert!(warnings.iter().any(|w| w.contains(&told)), "{warnings:?}");
}
