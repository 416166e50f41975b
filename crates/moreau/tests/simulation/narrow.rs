//! Round tools that are narrower than a facet.

use super::*;

/// A rod above a node of a block, thin or not for the cells below it, and one above several of them.
#[test]
fn a_rod_on_one_node_is_told() {
    let pressed = |element: &str, cells: usize, shape: &str| {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
[[mesh.block]]
name = "b"
element = "{element}"
x = [0, 40]
y = [0, 10]
cells = [{cells}, 4]
[[material]]
on = "b"
young = 210000
poisson = 0.3
[[tool]]
name = "die"
{shape}
[[contact]]
surface = "b.top"
against = "die"
friction = 0.1
[[step]]
name = "press"
increments = 2
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "die", move = [0, -0.01] }}]
"#
        )));
        let warnings = pressed.outcome().warnings;
        let told = |w: &String| w.contains("\"die\", of a radius of 0.5 mm there, bears on node");
        warnings.iter().any(told)
    };
    let rod = "cylinder = { center = [20, 10.5], radius = 0.5 }";
    let roll = "cylinder = { center = [20, 30], radius = 20 }";
    // The corners of a punch are as round, but beside a face that bears.
    let punch = "profile = { points = [[30.45, 20], [30.45, 10], [9.55, 10], [9.55, 20]], radii = [0.5, 0.5] }";
    for element in ["quad4", "quad8"] {
        assert!(pressed(element, 8, rod), "{element}");
        assert!(!pressed(element, 80, rod), "{element}");
        assert!(!pressed(element, 8, roll), "{element}");
        assert!(!pressed(element, 8, punch), "{element}");
    }
}

/// A rod along a row of nodes of a solid, and a small ball on one of them.
#[test]
fn a_rod_on_one_row_of_nodes_is_told() {
    let pressed = |shape: &str| {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 8]
y = [0, 8]
z = [0, 4]
cells = [4, 4, 2]
[[material]]
on = "b"
young = 210000
poisson = 0.3
[[tool]]
name = "die"
{shape}
[[contact]]
surface = "b.front"
against = "die"
friction = 0
[[step]]
name = "press"
increments = 1
fix = [{{ on = "b.back", u = ["x", "y", "z"] }}]
tools = [{{ name = "die", move = [0, 0, -0.01] }}]
"#
        )));
        let warnings = pressed.outcome().warnings;
        warnings.iter().any(|w| w.contains("and on none beside it"))
    };
    assert!(pressed(
        "cylinder = { center = [4, 0, 4.5], axis = [0, 1, 0], radius = 0.5 }"
    ));
    assert!(pressed("sphere = { center = [4, 4, 4.5], radius = 0.5 }"));
    assert!(!pressed(
        "cylinder = { center = [4, 0, 24], axis = [0, 1, 0], radius = 20 }"
    ));
}
