//! Bodies and cells that lie on each other or within each other, with nothing between them.

use moreau::deck::{Given, Meshes, open, open_with};
use std::path::Path;

/// What the warnings say of a deck.
fn told(text: &str, given: &Given) -> Vec<String> {
    let (_, problem, findings) = open_with(text, Path::new(""), given);
    let shown = findings.render("deck.toml", text, false);
    assert!(problem.is_some(), "{shown}");
    findings.iter().map(|f| f.message.clone()).collect()
}

/// Two blocks, the second from an x on and with so many cells along y, and what is said between them.
fn blocks(element: &str, from: f64, cells: usize, between: &str) -> Vec<String> {
    let text = format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
{between}
[[mesh.block]]
name = "l"
element = "{element}"
x = [0, 20]
y = [0, 10]
cells = [4, 4]
[[mesh.block]]
name = "r"
element = "{element}"
x = [{from:?}, {:?}]
y = [0, 10]
cells = [3, {cells}]
[[material]]
on = ["l", "r"]
young = 210000
poisson = 0.3
[[step]]
name = "p"
increments = 1
fix = [{{ on = "l.left", u = ["x", "y"] }}, {{ on = "r.bottom", u = ["x", "y"] }}]
"#,
        from + 20.0
    );
    told(&text, &Given::default())
}

const CONTACT: &str =
    r#"contact = [{ surface = "l.right", against = "r.left", friction = 0.1, adjust = true }]"#;
const TIE: &str = r#"tie = [{ surface = "l.right", to = "r.left" }]"#;

#[test]
fn blocks_on_each_other_are_told_unless_they_are_joined() {
    for element in ["quad4", "quad8"] {
        for cells in [4, 7] {
            let on_each_other = |said: &String| said.contains("lie on each other");
            let told = blocks(element, 20.0, cells, "");
            let [said] = &told[told.len() - 1..] else {
                panic!("{told:?}")
            };
            assert!(said.contains("of \"l\" and \"r\""), "{said}");
            let sides = said.contains("of \"l.right\"") && said.contains("of \"r.left\"");
            assert!(on_each_other(said) && sides, "{said}");
            let joined = [(20.0, TIE), (20.0, CONTACT), (20.001, "")];
            for (from, between) in joined {
                let told = blocks(element, from, cells, between);
                assert!(!told.iter().any(on_each_other), "{told:?}");
            }
        }
    }
}

#[test]
fn bodies_that_begin_within_each_other_are_told() {
    let within = |said: &String| said.contains("\"l\" and \"r\" begin within each other, by 5 mm");
    assert!(blocks("quad8", 10.0, 4, "").iter().any(within));
    let within = |said: &String| said.contains("begin within each other");
    assert!(!blocks("quad8", 20.0, 4, TIE).iter().any(within));
    // What a contact is between is told of the contact.
    let contact = CONTACT.replace(", adjust = true", "");
    assert!(!blocks("quad8", 19.4, 4, &contact).iter().any(within));
    assert!(blocks("quad8", 19.4, 4, "").iter().any(within));
    // A bow of the mesh is no other body.
    assert!(!blocks("quad8", 19.95, 4, "").iter().any(within));
}

/// A square of four cells, with what belongs into a file of Gmsh besides or instead.
fn square(nodes: &[[f64; 2]], cells: &str) -> Vec<String> {
    let mut all: Vec<[f64; 2]> = (0..9)
        .map(|k| [f64::from(k % 3), f64::from(k / 3)])
        .collect();
    all.extend(nodes);
    let lines = all.iter().zip(1..);
    let lines: String = lines
        .map(|([x, y], k)| format!("{k} {x} {y} 0\n"))
        .collect();
    let cells: Vec<&str> = cells.split(", ").collect();
    let kind = |cell: &str| 1 + cell.split(' ').count() - 2;
    let elements = cells.iter().zip(1..);
    let elements: String = elements
        .map(|(cell, k)| format!("{k} {} 2 1 1 {cell}\n", kind(cell)))
        .collect();
    let mesh = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"b\"\n$EndPhysicalNames\n$Nodes\n{}\n{lines}$EndNodes\n\
         $Elements\n{}\n{elements}$EndElements\n",
        all.len(),
        cells.len()
    );
    let text = r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = { file = "square.msh" }
material = [{ on = "b", young = 1000, poisson = 0.3 }]
step = [{ name = "p", increments = 1, fix = [{ on = "b", u = ["x", "y"] }] }]
"#;
    let given = Given {
        meshes: Meshes::from([("square.msh".into(), mesh.into_bytes())]),
        ..Given::default()
    };
    told(text, &given)
}

#[test]
fn cracks_and_doubled_cells_of_a_mesh_are_told() {
    let whole = "1 2 5 4, 2 3 6 5, 4 5 8 7, 5 6 9 8";
    let said = |told: &[String], what: &str| told.iter().any(|s| s.contains(what));
    let of = |nodes: &[[f64; 2]], cells: &str| square(nodes, cells);
    let told = of(&[], whole);
    assert!(
        !said(&told, "lie on") && !said(&told, "share volume"),
        "{told:?}"
    );
    // The upper cells have a middle and a right node of their own, off by rounding.
    let told = of(
        &[[1.0, 1.0 + 1e-7], [2.0, 1.0]],
        "1 2 5 4, 2 3 6 5, 4 10 8 7, 10 11 9 8",
    );
    assert!(
        said(&told, "2 pairs of facets in \"b\" lie on each other"),
        "{told:?}"
    );
    // The middle of the cell that the triangle is in lies on the side of that.
    let told = of(&[], &format!("{whole}, 1 2 4"));
    assert!(said(&told, "2 cells of \"b\" share volume"), "{told:?}");
}

#[test]
fn a_layer_that_is_tied_is_not_told() {
    let coated = include_str!("../../../../docs/examples/coated-block.toml");
    let (_, _, findings) = open(coated);
    assert_eq!(findings.warnings(), 0);
}
