//! Flat serendipity cells of the reduced rule below surfaces that touch.

use moreau::deck::{Given, Meshes, open_with};
use std::path::Path;

/// What is said of flat cells in a deck.
fn told(text: &str) -> Vec<String> {
    told_with(text, &Given::default())
}

fn told_with(text: &str, given: &Given) -> Vec<String> {
    let (_, problem, findings) = open_with(text, Path::new(""), given);
    let shown = findings.render("deck.toml", text, false);
    assert!(problem.is_some(), "{shown}");
    let all = findings.iter().map(|f| f.message.clone());
    all.filter(|m| m.contains("of flat")).collect()
}

/// A layer below a roll, of cells 0.5 mm long.
fn layer(element: &str, thickness: f64, rule: &str) -> String {
    format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
[[mesh.block]]
name = "b"
element = "{element}"
x = [-3, 3]
y = [0, {thickness:?}]
cells = [12, 1]
[[material]]
on = "b"
young = 210000
poisson = 0.3
{rule}
[[tool]]
name = "roll"
cylinder = {{ center = [0, {:?}], radius = 20 }}
[[contact]]
surface = "b.top"
against = "roll"
friction = 0.1
[[step]]
name = "s"
increments = 1
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "roll", move = [0, -0.001] }}]
"#,
        20.0 + thickness
    )
}

#[test]
fn flat_cells_of_the_reduced_rule_below_a_contact_are_told() {
    let said = told(&layer("quad8", 0.05, ""));
    let [said] = said.as_slice() else {
        panic!("{said:?}")
    };
    for words in [
        "12 of the 12 facets of \"b.top\" are of flat quad8 cells",
        "0.05] is 10 times as long along the surface as it is deep",
        "quadrature = \"full\", or quad9",
    ] {
        assert!(said.contains(words), "{words:?} in {said}");
    }
    let reduced = "quadrature = \"reduced\"";
    assert_eq!(told(&layer("quad8", 0.05, reduced)).len(), 1);
    for (element, thickness, rule) in [
        ("quad8", 0.125, ""),
        ("quad8", 0.05, "quadrature = \"full\""),
        ("quad9", 0.05, ""),
        ("quad4", 0.05, ""),
        ("tri6", 0.05, ""),
    ] {
        let said = told(&layer(element, thickness, rule));
        assert!(said.is_empty(), "{element} {thickness} {rule}: {said:?}");
    }
    // Nothing touches the layer.
    let loose = layer("quad8", 0.05, "");
    let (before, after) = (loose.find("[[tool]]"), loose.find("[[step]]"));
    let (before, after) = (before.expect("a tool"), after.expect("a step"));
    let held = loose[after..].replace("tools = [{ name = \"roll\", move = [0, -0.001] }]", "");
    assert!(told(&format!("{}{held}", &loose[..before])).is_empty());
}

/// Each side of a pair of bodies is looked at; of a facet in space the longer edge counts.
#[test]
fn both_sides_of_a_pair_are_looked_at() {
    let pair = |depth: f64, cells: usize| {
        format!(
            r#"units = "mm-N-MPa"
analysis = "solid"
mesh.block = [
  {{ name = "low", element = "hex20", x = [0, 4], y = [0, 1], z = [0, 1], cells = [{cells}, 1, 1] }},
  {{ name = "top", element = "hex20", x = [0, 4], y = [1, {:?}], z = [0, 1], cells = [4, 1, 1] }},
]
material = [{{ on = ["low", "top"], young = 210000, poisson = 0.3 }}]
contact = [{{ surface = "low.top", against = "top.bottom", friction = 0.1 }}]
[[step]]
name = "s"
increments = 1
fix = [{{ on = "low.bottom", u = ["x", "y", "z"] }}, {{ on = "top.top", u = ["x", "z"] }}]
move = [{{ on = "top.top", u = {{ y = -0.001 }} }}]
"#,
            1.0 + depth
        )
    };
    assert!(told(&pair(0.25, 1)).is_empty());
    let said = told(&pair(0.2, 1));
    let is_top =
        |m: &String| m.contains("4 of the 4 facets of \"top.bottom\"") && m.contains("is 5 times");
    assert!(said.len() == 1 && is_top(&said[0]), "{said:?}");
    assert!(said[0].contains("hex27 or tet10"), "{said:?}");
    let flat_below = pair(0.5, 1).replace("y = [0, 1], z", "y = [0.5, 1], z");
    let said = told(&flat_below);
    assert!(
        said.len() == 1 && said[0].contains("1 of the 1 facets of \"low.top\""),
        "{said:?}"
    );
    assert!(said[0].contains("is 8 times"), "{said:?}");
}

/// A cell 1 mm long that leans over, by so much on its height, has the depth of one that does not.
#[test]
fn the_depth_of_a_cell_that_leans_is_across_its_facet() {
    let cell = |lean: f64, depth: f64| {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0 + lean, depth], [lean, depth]];
        let middle = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
        };
        let nodes = corners.into_iter().chain((0..4).map(middle)).zip(1..);
        let nodes: String = nodes
            .map(|([x, y], k)| format!("{k} {x} {y} 0\n"))
            .collect();
        let mesh = format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"b\"\n1 2 \"top\"\n1 3 \"foot\"\n\
             $EndPhysicalNames\n$Nodes\n8\n{nodes}$EndNodes\n\
             $Elements\n3\n1 16 2 1 1 1 2 3 4 5 6 7 8\n2 8 2 2 2 3 4 7\n3 8 2 3 3 1 2 5\n$EndElements\n"
        );
        let given = Given {
            meshes: Meshes::from([("cell.msh".into(), mesh.into_bytes())]),
            ..Given::default()
        };
        let text = format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = {{ file = "cell.msh" }}
material = [{{ on = "b", young = 1000, poisson = 0.3 }}]
tool = [{{ name = "t", plane = {{ point = [0, {depth:?}], normal = [0, -1] }} }}]
contact = [{{ surface = "top", against = "t", friction = 0.1 }}]
step = [{{ name = "p", increments = 1, fix = [{{ on = "foot", u = ["x", "y"] }}] }}]
"#
        );
        told_with(&text, &given)
    };
    assert!(cell(0.0, 0.25).is_empty());
    for lean in [0.0, 0.5, -1.5] {
        let said = cell(lean, 0.2);
        assert!(
            said.len() == 1 && said[0].contains("is 5 times"),
            "{lean}: {said:?}"
        );
    }
}
