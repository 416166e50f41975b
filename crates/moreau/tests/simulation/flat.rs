//! Flat cells with reduced quadrature under a force at one node.

use super::*;

/// How far a force at one node on top of a layer moves that node, by the kind of cells, their rule and side over thickness.
fn way(element: &str, rule: &str, ratio: f64) -> f64 {
    let thickness = 1.0 / ratio;
    let (analysis, z, depth, row, foot) = match element {
        "hex20" => ("solid", "z = [0, 3]", ", 1", ", 3", r#""x", "y", "z""#),
        _ => ("plane-strain", "", "", "", r#""x", "y""#),
    };
    let force = if z.is_empty() { "" } else { ", 0" };
    let pressed = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "{analysis}"
[[mesh.block]]
name = "b"
element = "{element}"
x = [0, 6]
y = [0, {thickness:?}]
{z}
cells = [6, 1{row}]
[[mesh.group]]
name = "centre"
on = "b"
nearest = [3, {thickness:?}{depth}]
[[material]]
on = "b"
young = 210000
poisson = 0.3
quadrature = "{rule}"
[[step]]
name = "press"
increments = 1
fix = [{{ on = "b.bottom", u = [{foot}] }}]
load = [{{ on = "centre", force = [0, -100{force}] }}]
[output]
probes = ["centre"]
"#
    )));
    let way = pressed.history().numbers("u.centre.y");
    way.last().expect("an increment").abs()
}

/// The table of docs/theory/elements.md.
#[test]
fn flat_cells_with_reduced_quadrature_are_too_soft_under_a_force_at_one_node() {
    let table = [
        (
            "quad8",
            [(1.0, 1.04), (3.0, 1.48), (10.0, 5.65), (33.0, 87.6)],
        ),
        (
            "hex20",
            [(1.0, 1.11), (3.0, 1.85), (10.0, 11.7), (33.0, 226.0)],
        ),
    ];
    for (element, rows) in table {
        for (ratio, expected) in rows {
            let found = way(element, "reduced", ratio) / way(element, "full", ratio);
            assert!(
                (found / expected - 1.0).abs() < 5e-3,
                "{element} {ratio}: {found}"
            );
        }
    }
}
