//! Bodies of a single layer of cells with the mean dilatation.

use moreau::deck::{Given, open_with};
use std::path::Path;

/// What is said of single layers in a deck.
fn told(text: &str) -> Vec<String> {
    let (_, problem, findings) = open_with(text, Path::new(""), &Given::default());
    let shown = findings.render("deck.toml", text, false);
    assert!(problem.is_some(), "{shown}");
    let all = findings.iter().map(|f| f.message.clone());
    all.filter(|m| m.contains("single layer")).collect()
}

/// A strip of so many cells of an element, held at one end.
fn strip(element: &str, cells: &[usize], rule: &str) -> String {
    let (analysis, z, foot) = match cells {
        [_, _, _] => ("solid", "z = [0, 1]", r#""x", "y", "z""#),
        _ => ("plane-strain", "", r#""x", "y""#),
    };
    format!(
        r#"units = "mm-N-MPa"
analysis = "{analysis}"
[[mesh.block]]
name = "s"
element = "{element}"
x = [0, 6]
y = [0, 1]
{z}
cells = {cells:?}
[[material]]
on = "s"
young = 200000.0
poisson = 0.3
{rule}
[[step]]
name = "bend"
increments = 1
fix = [{{ on = "s.left", u = [{foot}] }}]
move = [{{ on = "s.right", u = {{ y = -0.01 }} }}]
"#
    )
}

#[test]
fn a_single_layer_of_cells_with_the_mean_dilatation_is_told() {
    let said = told(&strip("quad4", &[6, 1], ""));
    let [said] = said.as_slice() else {
        panic!("{said:?}")
    };
    for words in [
        "6 of the 6 quad4 cells of a body have its surface on two opposite sides, as cell 0 at [0.5, 0.5]",
        "use two or more cells across",
        "or quad8",
    ] {
        assert!(said.contains(words), "{words:?} in {said}");
    }
    assert_eq!(
        told(&strip("quad4", &[1, 6], "")).len(),
        0,
        "as wide as six high"
    );
    assert_eq!(told(&strip("quad4", &[3, 1], "")).len(), 1);
    for cells in [[6, 1, 1], [6, 1, 3], [6, 3, 1]] {
        let said = told(&strip("hex8", &cells, "quadrature = \"b-bar\""));
        assert!(
            said.len() == 1 && said[0].contains("or hex20"),
            "{cells:?}: {said:?}"
        );
    }
}

#[test]
fn what_does_not_bend_or_has_more_cells_across_is_not_told() {
    for (element, cells, rule) in [
        ("quad4", &[6, 2][..], ""),
        ("quad4", &[2, 1], ""),
        ("quad4", &[6, 1], "quadrature = \"full\""),
        ("quad8", &[6, 1], ""),
        ("hex8", &[6, 2, 2], ""),
        ("hex8", &[1, 1, 1], ""),
        ("hex20", &[6, 1, 1], ""),
    ] {
        let said = told(&strip(element, cells, rule));
        assert!(said.is_empty(), "{element} {cells:?} {rule}: {said:?}");
    }
    // Held across on one side: by a support, or as plane strain is.
    let moved = r#"move = [{ on = "s.right", u = { y = -0.01 } }]"#;
    let pressed = r#"load = [{ on = "s.top", pressure = 1 }]"#;
    let bedded = strip("quad4", &[6, 1], "").replace("s.left", "s.bottom");
    let bedded = bedded.replace(moved, pressed);
    assert!(told(&bedded).is_empty());
    let slab = strip("hex8", &[6, 3, 1], "");
    let slab = slab.replace("}]\nmove", "}, { on = \"s.back\", u = [\"z\"] }]\nmove");
    assert!(told(&slab).is_empty(), "plane strain");
    // On a table, and above one.
    let on_table = |height: f64| {
        let table = format!(
            r#"[[tool]]
name = "table"
plane = {{ point = [9, {height:?}], normal = [0, 2] }}
[[contact]]
surface = "s.bottom"
against = "table"
friction = 0.1
[[step]]"#
        );
        told(&strip("quad4", &[6, 1], "").replace("[[step]]", &table))
    };
    assert!(on_table(0.0).is_empty());
    assert_eq!(on_table(-0.1).len(), 1);
    // Let go in another step.
    let freed = format!(
        "{bedded}[[step]]\nname = \"free\"\nincrements = 1\nfix = [{{ on = \"s.left\", u = [\"x\", \"y\"] }}]\n"
    );
    assert_eq!(told(&freed).len(), 1);
    // The axis is no surface, and a wall has two.
    let rod = strip("quad4", &[1, 24], "").replace("plane-strain", "axisymmetric");
    let rod = rod
        .replace("[0, 6]", "[0, 1]")
        .replace("y = [0, 1]", "y = [0, 24]");
    let rod = rod.replace("s.left\", u = [\"x\", \"y\"]", "s.bottom\", u = [\"y\"]");
    let rod = rod.replace("s.right", "s.top");
    assert!(told(&rod).is_empty());
    assert_eq!(told(&rod.replace("x = [0, 1]", "x = [10, 11]")).len(), 1);
}

/// Bodies of two materials are looked at as a whole, and tied ones have no surface between them.
#[test]
fn layers_on_each_other_are_not_single() {
    let tied = |tie: &str| {
        format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [
  {{ name = "low", element = "quad4", x = [0, 6], y = [0, 1], cells = [6, 1] }},
  {{ name = "top", element = "quad4", x = [0, 6], y = [1, 2], cells = [9, 1] }},
]
material = [{{ on = ["low", "top"], young = 210000, poisson = 0.3 }}]
{tie}
[[step]]
name = "s"
increments = 1
fix = [{{ on = "low.left", u = ["x", "y"] }}, {{ on = "top.left", u = ["x", "y"] }}]
move = [{{ on = "top.right", u = {{ y = -0.01 }} }}]
"#
        )
    };
    let tie = r#"tie = [{ surface = "low.top", to = "top.bottom" }]"#;
    assert!(told(&tied(tie)).is_empty());
    assert_eq!(told(&tied("")).len(), 2);
}
