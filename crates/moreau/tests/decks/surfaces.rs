//! Tools of triangles: what is read, and what is said of a file that is not right.

use super::{flat, temporary};
use moreau::deck::{Problem, open_in};
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

const DECK: &str = r#"
units = "mm-N-MPa"
analysis = "solid"
strain = "finite"

[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 1]
y = [0, 1]
z = [0, 1]
cells = [1, 1, 1]

[[material]]
on = "b"
young = 1000.0
poisson = 0.3

[[tool]]
name = "die"
surface = { file = "cube.stl" }

[[contact]]
surface = "b.top"
against = "die"
friction = 0.1

[[step]]
name = "press"
increments = 1
fix = [{ on = "b.bottom", u = ["y"] }, { on = "b.left", u = ["x"] }, { on = "b.back", u = ["z"] }]
tools = [{ name = "die", move = [0, -0.1, 0] }]
"#;

/// Corners and triangles of the cube from (−1, 1, −1) to (2, 4, 2).
fn cube() -> Vec<[[f64; 3]; 3]> {
    let corner = |k: usize| [0, 1, 2].map(|i| [-1.0, 1.0, -1.0][i] + 3.0 * ((k >> i) & 1) as f64);
    let sides = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = |[a, b, c, d]: [usize; 4]| [[a, b, c], [a, c, d]];
    let faces = sides.into_iter().flat_map(halves);
    faces.map(|face| face.map(corner)).collect()
}

fn stl(triangles: &[[[f64; 3]; 3]]) -> String {
    let mut text = "solid die\n".to_owned();
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle {
            writeln!(text, "vertex {x} {y} {z}").expect("a line");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid die\n"
}

/// A mesh file of triangles alone, in the group `skin`.
fn msh(triangles: &[[[f64; 3]; 3]]) -> String {
    let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"skin\"\n\
                    $EndPhysicalNames\n"
        .to_owned();
    writeln!(text, "$Nodes\n{}", 3 * triangles.len()).expect("a line");
    for (k, [x, y, z]) in triangles.iter().flatten().enumerate() {
        writeln!(text, "{} {x} {y} {z}", k + 1).expect("a line");
    }
    writeln!(text, "$EndNodes\n$Elements\n{}", triangles.len()).expect("a line");
    for k in 0..triangles.len() {
        let nodes = format!("{} {} {}", 3 * k + 1, 3 * k + 2, 3 * k + 3);
        writeln!(text, "{} 2 2 1 1 {nodes}", k + 1).expect("a line");
    }
    text + "$EndElements\n"
}

/// A folder of its own with these files.
fn with(name: &str, files: &[(&str, String)]) -> PathBuf {
    let folder = temporary(name);
    fs::create_dir_all(&folder).expect("a folder");
    for (file, text) in files {
        fs::write(folder.join(file), text).expect("written");
    }
    folder
}

/// What is said of the deck with these replacements beside these files, and whether it can run.
fn shown(name: &str, files: &[(&str, String)], changes: &[(&str, &str)]) -> (bool, String) {
    let text = changes.iter().fold(DECK.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    });
    let (_, problem, findings) = open_in(&text, &with(name, files));
    let out = flat(&findings.render("deck.toml", &text, false));
    (problem.is_some(), out)
}

/// No condition but those of a `move`.
const FREE: (&str, &str) = (
    "fix = [{ on = \"b.bottom\", u = [\"y\"] }, { on = \"b.left\", u = [\"x\"] }, { on = \"b.back\", u = [\"z\"] }]",
    "",
);

/// The force of the die at the end of a deck in a folder.
fn force_of_die(text: &str, folder: &Path) -> [f64; 3] {
    let (_, problem, findings) = open_in(text, folder);
    let Some(Problem::Solid(mut setup)) = problem else {
        panic!("{}", findings.render("deck.toml", text, false));
    };
    let stage = &setup.stages[0];
    let run = setup.driver.run(&stage.step, stage.increments, |_, _| {});
    run.expect("converges");
    setup.driver.tool_force("die").expect("a force").into()
}

/// The forces of a die of triangles and of a plane in its place, on the deck with these replacements.
fn pressed(name: &str, die: &[[[f64; 3]; 3]], changes: &[(&str, &str)]) -> [[f64; 3]; 2] {
    let folder = with(name, &[("cube.stl", stl(die))]);
    let plane = "plane = { point = [0, 1, 0], normal = [0, -1, 0] }";
    ["surface = { file = \"cube.stl\" }", plane].map(|tool| {
        let text = changes.iter().fold(DECK.to_owned(), |text, (from, to)| {
            assert!(text.contains(from), "{from}");
            text.replacen(from, to, 1)
        });
        let text = text.replace("surface = { file = \"cube.stl\" }", tool);
        force_of_die(&text, &folder)
    })
}

/// A cube with the face of the block presses it as a plane does, but for friction along its edges: nodes there and at its corners
/// are held by any normal.
#[test]
fn a_cube_as_wide_as_the_block_presses_as_a_plane() {
    let narrow = cube()
        .into_iter()
        .map(|face| face.map(|[x, y, z]| [(x + 1.0) / 3.0, y, (z + 1.0) / 3.0]));
    let narrow: Vec<_> = narrow.collect();
    for strain in ["small", "finite"] {
        let changes = [
            ("finite", strain),
            ("cells = [1, 1, 1]", "cells = [3, 3, 3]"),
            ("friction = 0.1", "friction = 0.8"),
            ("poisson = 0.3", "poisson = 0.1"),
            FREE,
            (
                "tools = [{ name = \"die\", move = [0, -0.1, 0] }]",
                "move = [{ on = \"b.bottom\", u = { x = 0, y = 0.1, z = 0 } }]",
            ),
        ];
        let [cube, plane] = pressed("surface-narrow", &narrow, &changes);
        let off = (0..3)
            .map(|i| (cube[i] - plane[i]).abs())
            .fold(0.0, f64::max);
        assert!(
            plane[1] < -90.0 && off < 1e-3 * plane[1].abs(),
            "{strain}: {cube:?} {plane:?}"
        );
    }
}

/// A die drawn along two of its edges, on which nodes of the block are: those slide along them, and have no friction there.
#[test]
fn nodes_at_an_edge_slide_along_it() {
    let rail = cube()
        .into_iter()
        .map(|face| face.map(|[x, y, z]| [(x + 1.0) / 3.0, y, z]));
    let rail: Vec<_> = rail.collect();
    let changes = [
        ("strain = \"finite\"", "strain = \"small\""),
        ("cells = [1, 1, 1]", "cells = [4, 1, 2]"),
        FREE,
        ("poisson = 0.3", "poisson = 0.0"),
        (
            "tools = [{ name = \"die\", move = [0, -0.1, 0] }]",
            "move = [{ on = \"b.bottom\", u = { x = 0, y = 0.02, z = -0.4 } }]",
        ),
    ];
    let [rail, plane] = pressed("surface-rail", &rail, &changes);
    assert!(
        (plane[2] - 0.1 * plane[1].abs()).abs() < 1e-4 * plane[2],
        "{plane:?}"
    );
    assert!(
        rail[2] < 0.9 * plane[2] && rail[2] > 0.3 * plane[2],
        "{rail:?} {plane:?}"
    );
    assert!(
        (rail[1] / plane[1] - 1.0).abs() < 0.05,
        "{rail:?} {plane:?}"
    );
}

/// A plane face of triangles presses as a plane does, whatever file it comes from.
#[test]
fn a_cube_presses_as_a_plane() {
    let files = [("cube.stl", stl(&cube())), ("cube.msh", msh(&cube()))];
    let folder = with("surface-cube", &files);
    let tools = [
        "plane = { point = [0, 1, 0], normal = [0, -1, 0] }",
        "surface = { file = \"cube.stl\" }",
        "surface = { file = \"cube.msh\", group = \"skin\", sharp = 80 }",
    ];
    let forces = tools.map(|tool| {
        let text = DECK.replace("surface = { file = \"cube.stl\" }", tool);
        force_of_die(&text, &folder)
    });
    assert!(forces[0][1] < -90.0, "{forces:?}");
    for force in &forces[1..] {
        let off = (0..3).map(|i| (force[i] - forces[0][i]).abs());
        assert!(
            off.fold(0.0, f64::max) < 1e-9 * forces[0][1].abs(),
            "{forces:?}"
        );
    }
}

#[test]
fn what_is_no_closed_surface_is_pointed_at() {
    let whole = cube();
    let mut turned = whole.clone();
    turned[4].swap(0, 1);
    for (name, triangles, words) in [
        ("open", &whole[1..], "the surface is open along an edge"),
        (
            "turned",
            &turned[..],
            "two triangles go along an edge in the same sense",
        ),
    ] {
        let files = [("cube.stl", stl(triangles))];
        let (runs, out) = shown(&format!("surface-{name}"), &files, &[]);
        assert!(!runs && out.contains(words), "{out}");
    }
}

#[test]
fn files_and_groups_have_their_nearest_names() {
    let files = [("cube.stl", stl(&cube())), ("cube.msh", msh(&cube()))];
    let given = "surface = { file = \"cube.stl\" }";
    for (tool, words) in [
        (
            "surface = { file = \"cubes.stl\" }",
            "beside it is \"cube.stl\"",
        ),
        (
            "surface = { file = \"cube.obj\" }",
            "expected a name that ends in .stl or .msh",
        ),
        (
            "surface = { file = \"cube.msh\", group = \"skins\" }",
            "did you mean \"skin\"?",
        ),
        (
            "surface = { file = \"cube.stl\", group = \"skin\" }",
            "only a file of Gmsh has groups",
        ),
        ("surface = { file = \"cube.stl\", sharp = 190 }", "0 to 180"),
        ("surface = { file = \"cube.stl\", sharp = -1 }", "0 to 180"),
        ("surface = { group = \"skin\" }", "file"),
    ] {
        let (runs, out) = shown("surface-names", &files, &[(given, tool)]);
        assert!(!runs && out.contains(words), "{tool}: {out}");
    }
    let (_, out) = shown("surface-names", &[("cube.stl", "solid x".into())], &[]);
    assert!(
        out.contains("no STL file") || out.contains("no triangles"),
        "{out}"
    );
}

/// A body within a tool is told so, unless the tool is hollow.
#[test]
fn a_body_within_a_tool_is_told_so() {
    let low: Vec<_> = cube()
        .iter()
        .map(|t| t.map(|[x, y, z]| [x, y - 2.0, z]))
        .collect();
    let files = [("cube.stl", stl(&low))];
    let (_, out) = shown("surface-within", &files, &[]);
    assert!(out.contains("lie inside of the tool"), "{out}");
    let given = "surface = { file = \"cube.stl\" }";
    let hollow = format!("{given}\ninside = true");
    let (runs, out) = shown("surface-within", &files, &[(given, &hollow)]);
    assert!(runs && !out.contains("lie inside of the tool"), "{out}");
}
