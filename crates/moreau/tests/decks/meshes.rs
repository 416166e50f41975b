//! Decks on mesh files: what is read, and what is said of a file that is not right.

use super::{DECK, flat, folder, temporary};
use moreau::deck::{Class, Problem, Setup, open_in};
use moreau::files::{read_mesh, write_mesh};
use moreau::mesh::{CellKind, Mesh, block2, uniform};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;

fn example() -> String {
    fs::read_to_string(folder("docs/examples/punch-on-gmsh-mesh.toml")).expect("a deck")
}

/// The plane problem of a deck beside the examples.
fn plane(text: &str) -> Box<Setup<2>> {
    let (_, problem, findings) = open_in(text, &folder("docs/examples"));
    match problem {
        Some(Problem::Plane(setup)) => setup,
        _ => panic!("{}", findings.render("deck.toml", text, false)),
    }
}

/// What is said of a deck beside the examples, at the line of the mesh file.
fn says(text: &str, words: &[&str]) {
    let (_, problem, findings) = open_in(text, &folder("docs/examples"));
    let out = findings.render("deck.toml", text, false);
    let line = 1 + text
        .lines()
        .position(|l| l.starts_with("file"))
        .expect("a file");
    assert!(
        problem.is_none() && out.contains(&format!("deck.toml:{line}:")),
        "{out}"
    );
    let flat = flat(&out);
    for word in words {
        assert!(flat.contains(word), "{word:?} in {flat}");
    }
}

#[test]
fn physical_names_are_groups() {
    let setup = plane(&example());
    let [body] = &setup.bodies[..] else {
        panic!("one body")
    };
    assert_eq!(body.name, "block");
    assert_eq!(body.cells, [(CellKind::Tri6, 161)]);
    // A rectangle less what the rounding takes.
    let area = 1000.0 - (1.0 - 0.25 * PI) * 144.0;
    assert!((body.volume / area - 1.0).abs() < 1e-5, "{}", body.volume);
    let groups: Vec<&str> = body.motions[0]
        .iter()
        .map(|m| m.groups[0].0.as_str())
        .collect();
    assert_eq!(groups, ["symmetry", "punch", "symmetry"]);
    // The arc is five parabolas of 18° each.
    for (name, measure) in [("bottom", 50.0), ("punch", 20.0), ("round", 6.0 * PI)] {
        let group = setup.groups.iter().find(|g| g.name == name).expect(name);
        let found = group.measure.expect("a length");
        assert!(
            group.kind == "facets" && (found / measure - 1.0).abs() < 2e-5,
            "{name}: {found}"
        );
    }
}

/// Wherever the line ends, a path and a name are never cut: they are there to be copied.
#[test]
fn paths_stay_whole_when_a_message_is_wrapped() {
    for length in 1..120 {
        let file = format!(
            "{}/no-such-mesh-of-a-punch.msh",
            "a-b/".repeat(length / 4) + &"c".repeat(length % 4)
        );
        let text = example().replace("punch-on-gmsh-mesh.msh", &file);
        let (_, _, findings) = open_in(&text, &folder("docs/examples"));
        let out = findings.render("deck.toml", &text, false);
        let message = out.split("╭").next().unwrap_or_default();
        assert!(message.contains(&file), "{file} in {out}");
    }
}

#[test]
fn files_that_cannot_be_read_are_pointed_at() {
    let with = |file: &str| example().replace("punch-on-gmsh-mesh.msh", file);
    says(
        &with("punch-on-gmesh-mesh.msh"),
        &[
            "docs/examples/punch-on-gmesh-mesh.msh",
            "beside it is \"punch-on-gmsh-mesh.msh\"",
            "relative to the folder of the deck",
        ],
    );
    says(
        &with("punched-block.toml"),
        &["of no known format", ".msh", ".inp"],
    );
    says(&with("punch-on-gmsh-mesh.py"), &["of no known format"]);
    says(
        &with("../../crates/mesh/tests/data/hex8.4b.msh"),
        &["is of dimension 3", "needs analysis = \"solid\""],
    );
    says(
        &example()
            .replace("\"plane-strain\"", "\"solid\"")
            .replace("[0, 0]", "[0, 0, 0]")
            .replace("[0, 1]", "[0, 1, 0]"),
        &["none of the", "dimension 3", "plane-strain"],
    );
    let (_, _, findings) = open_in(&with("none.msh"), &folder("docs/examples"));
    assert!(findings.iter().all(|f| f.class == Class::Meshes));
    // A mesh across the axis is no half-section.
    let across = block2(
        "block",
        CellKind::Quad8,
        &uniform(-1.0, 1.0, 2),
        &uniform(0.0, 1.0, 1),
    );
    let file = temporary("across.msh");
    write_mesh(&file, &across.expect("valid")).expect("written");
    says(
        &with(&file.to_string_lossy()).replace("plane-strain", "axisymmetric"),
        &["reaches the radius -1"],
    );
}

#[test]
fn groups_that_nothing_uses_are_a_warning() {
    let (_, problem, findings) = open_in(&example(), &folder("docs/examples"));
    assert!(problem.is_some());
    let messages: Vec<&str> = findings.iter().map(|f| f.message.as_str()).collect();
    assert_eq!(
        messages,
        ["nothing uses these groups of the mesh: \"round\""]
    );
}

/// The mesh of the file and a block beside it, of other elements, both in contact.
#[test]
fn files_and_blocks_combine() {
    let block = r#"
[[mesh.block]]
name = "second"
element = "quad8"
x = [100, 110]
y = [0, 10]
cells = [2, 2]
[[material]]
on = "second"
young = 1000.0
poisson = 0.2
[[contact]]
surface = "second.bottom"
against = "foundation"
friction = 0.3
[[step]]"#;
    let deck = example().replace("[[step]]", block);
    let setup = plane(&deck);
    let names: Vec<&str> = setup.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["block", "second"]);
    assert!((setup.bodies[1].volume - 100.0).abs() < 1e-9);
    let twice = deck.replace("\"second", "\"block");
    let (_, problem, findings) = open_in(&twice, &folder("docs/examples"));
    let shown = flat(&findings.render("deck.toml", &twice, false));
    assert!(problem.is_none() && shown.contains("\"block\""), "{shown}");
}

/// Cells of several kinds in one group: each kind has the rule that does not lock.
#[test]
fn rules_are_chosen_by_the_kind_of_the_cells() {
    // A triangle of 3 nodes beside a quadrangle of 8.
    let mesh = Mesh::<2>::new(
        vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [0.5, 0.0],
            [1.0, 0.5],
            [0.5, 1.0],
            [0.0, 0.5],
            [3.0, 0.0],
            [4.0, 0.0],
            [3.0, 1.0],
        ],
        vec![
            (CellKind::Quad8, (0..8).collect()),
            (CellKind::Tri3, vec![8, 9, 10]),
        ],
    );
    let file = temporary("kinds.msh");
    write_mesh(&file, &mesh.expect("valid")).expect("written");
    let text = format!(
        r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.file = '{}'
material = [{{ on = "ungrouped", young = 1.0, poisson = 0.3 }}]
[[step]]
name = "pull"
increments = 1
fix = [{{ on = "ungrouped", u = ["x", "y"] }}]
"#,
        file.display()
    );
    let (deck, problem, findings) = open_in(&text, Path::new(""));
    let Some(Problem::Plane(setup)) = problem else {
        panic!("{}", findings.render("deck.toml", &text, false))
    };
    assert_eq!(deck.quadrature(&deck.materials[0]), "by element");
    // 2 × 2 points in the quadrangle, those of the full rule in the triangle.
    let points = |cell: usize| {
        setup
            .driver
            .points()
            .iter()
            .filter(|p| p.cell == cell)
            .count()
    };
    assert_eq!(points(0), 4);
    assert!(setup.groups.iter().all(|g| g.name == "ungrouped"));
    assert!(open_in(&deck.resolved(), Path::new("")).1.is_some());
}

/// Mixed triangles and quadrangles as Gmsh wrote them, with names that have blanks.
#[test]
fn meshes_of_several_materials_and_kinds() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.file = "../../crates/mesh/tests/data/mixed.4b.msh"
material = [
  { on = "left half", young = 1000.0, poisson = 0.3 },
  { on = "right half", young = 2000.0, poisson = 0.3 },
]
[[step]]
name = "pull"
increments = 1
fix = [{ on = "bottom", u = ["y"] }, { on = "left", u = ["x"] }]
load = [{ on = "top", traction = [0, 1] }]
"#;
    let setup = plane(deck);
    assert_eq!(setup.bodies[0].name, "plate");
    let kinds: Vec<CellKind> = setup.bodies[0].cells.iter().map(|c| c.0).collect();
    assert_eq!(kinds, [CellKind::Tri3, CellKind::Quad4]);
}

#[test]
fn surfaces_inside_a_body_are_a_warning() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.file = "../../crates/mesh/tests/data/quad8.4b.msh"
material = [{ on = "plate", young = 1000.0, poisson = 0.3 }]
[[step]]
name = "pull"
increments = 1
fix = [{ on = "bottom", u = ["y"] }, { on = "left", u = ["x"] }]
load = [{ on = "cut", pressure = 1 }]
"#;
    let (_, problem, findings) = open_in(deck, &folder("docs/examples"));
    assert!(problem.is_some());
    let out = findings.render("deck.toml", deck, false);
    assert!(
        out.contains("3 of the 3 facets of \"cut\" lie between two cells"),
        "{out}"
    );
}

#[test]
fn a_hundred_thousand_cells_are_checked() {
    let lines = uniform(0.0, 1.0, 320);
    let mesh = block2("block", CellKind::Quad4, &lines, &lines).expect("valid");
    assert!(mesh.cell_count() > 100_000);
    let file = temporary("large.msh");
    write_mesh(&file, &mesh).expect("written");
    let deck = DECK
        .replace(
            "[[mesh.block]]",
            &format!("[mesh]\nfile = '{}'\n#", file.display()),
        )
        .replace("element =", "# ")
        .replace("name = \"block\"", "")
        .replace("x = [0, 50]", "")
        .replace("y = [0, 20]", "")
        .replace("cells = [10, 2]", "")
        .replace("x = [0, 25]", "x = [0, 0.5]");
    let setup = plane(&deck);
    assert_eq!(setup.driver.mesh().cell_count(), mesh.cell_count());
    assert!((setup.bodies[0].volume - 1.0).abs() < 1e-9);
    let (again, losses): (Mesh<2>, _) = read_mesh(&file).expect("read");
    assert_eq!(losses, []);
    assert_eq!(again.nodes(), mesh.nodes());
}

/// Of a mesh file that is not taken over as a whole, what is lost is a warning at its name.
#[test]
fn what_a_mesh_file_loses_is_a_warning() {
    let at = temporary("losses");
    fs::create_dir_all(&at).expect("a folder");
    let mesh = fs::read_to_string(folder("docs/examples/punch-on-gmsh-mesh.msh")).expect("a mesh");
    let ghost = "$PhysicalNames\n6\n2 99 \"ghost\"\n";
    let lossy = mesh.replace("$PhysicalNames\n5\n", ghost);
    assert_ne!(lossy, mesh);
    fs::write(at.join("punch-on-gmsh-mesh.msh"), lossy).expect("a mesh");
    let text = example();
    let (_, problem, findings) = open_in(&text, &at);
    let out = findings.render("deck.toml", &text, false);
    // The other one is that nothing uses a group of the example.
    assert!(problem.is_some() && findings.warnings() == 2, "{out}");
    let said = "the group \"ghost\" is left out: no element";
    assert!(flat(&out).contains(said), "{out}");
}
