//! Meshes of several files: put together they are the mesh of one file; what does not fit is said at its file.

use super::{flat, temporary};
use moreau::deck::{Class, Given, Problem, open_in};
use moreau::files::write_mesh;
use moreau::mesh::{CellKind, Mesh, block2, block3, uniform};
use moreau::simulation::Simulation;
use std::fs;
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Two blocks, one on the other, whose meshes do not match.
fn blocks() -> [Mesh<2>; 2] {
    let block = |name, kind, cells, y| {
        block2(
            name,
            kind,
            &uniform(0.0, 4.0, cells),
            &uniform(y, y + 2.0, 2),
        )
        .expect("a mesh")
    };
    [
        block("lower", CellKind::Quad8, 4, 0.0),
        block("upper", CellKind::Quad4, 3, 2.0),
    ]
}

/// A folder with these blocks in one file, in two, and the upper one where it is not.
fn meshes() -> PathBuf {
    let at = temporary("parts");
    fs::create_dir_all(&at).expect("a folder");
    let [lower, upper] = blocks();
    let write = |name: &str, mesh: &Mesh<2>| write_mesh(&at.join(name), mesh).expect("written");
    write("lower.msh", &lower);
    write("upper.msh", &upper);
    write(
        "both.msh",
        &lower.joined(upper.clone()).expect("other names"),
    );
    let (s, c) = 30f64.to_radians().sin_cos();
    let away = upper.map(|[x, y]| {
        let (x, y) = (1e3 * x, 1e3 * (y - 2.0));
        [c * x - s * y, s * x + c * y]
    });
    write("away.msh", &away.expect("a mesh"));
    at
}

/// A block pressed on another and dragged, of plastic metal under friction.
fn deck(mesh: &str, lower: &str, upper: &str) -> String {
    format!(
        r#"
units = "mm-N-MPa"
analysis = "plane-strain"
{mesh}
[[material]]
on = "{lower}"
young = 1000.0
poisson = 0.3
yield-stress = 20.0
[[material]]
on = "{upper}"
young = 2000.0
poisson = 0.2
[[contact]]
surface = "{lower}.top"
against = "{upper}.bottom"
friction = 0.3
[[step]]
name = "drag"
increments = 3
fix = [{{ on = "{lower}.bottom", u = ["x", "y"] }}]
move = [{{ on = "{upper}.top", u = {{ x = 0.06, y = -0.1 }} }}]
"#
    )
}

/// The force at the bottom of the lower block, increment by increment.
fn forces(deck: &str, lower: &str) -> Vec<[f64; 2]> {
    let (simulation, findings) = Simulation::open(deck, &meshes(), &Given::default());
    let shown = || findings.render("deck.toml", deck, false);
    let mut simulation = simulation.unwrap_or_else(|| panic!("{}", shown()));
    let mut advance = || simulation.advance(&mut |_, _| ControlFlow::Continue(()));
    while advance().expect("an increment").is_some() {}
    let column = |axis| {
        simulation
            .history()
            .numbers(&format!("force.{lower}.bottom.{axis}"))
            .to_vec()
    };
    let (x, y) = (column("x"), column("y"));
    x.into_iter().zip(y).map(|(x, y)| [x, y]).collect()
}

#[test]
fn two_files_are_one() {
    let one = forces(&deck("mesh.file = \"both.msh\"", "lower", "upper"), "lower");
    assert!(
        one.len() == 3 && one[2][1] > 50.0 && one[1][0] < -10.0,
        "{one:?}"
    );
    let parts = "mesh.part = [{ file = \"lower.msh\" }, { file = \"upper.msh\" }]";
    assert_eq!(
        forces(&deck(parts, "lower", "upper"), "lower"),
        one,
        "to the bit"
    );
    let parts = "[mesh]\nfile = \"lower.msh\"\n[[mesh.part]]\nfile = \"upper.msh\"\nscale = 1\n";
    assert_eq!(
        forces(&deck(parts, "lower", "upper"), "lower"),
        one,
        "to the bit"
    );
    // Named, and from where it was written to where it belongs.
    let parts = "[[mesh.part]]\nfile = \"away.msh\"\nname = \"a\"\nscale = 1e-3\nturn = -30\nposition = [0, 2]\n\
                 [[mesh.part]]\nfile = \"lower.msh\"\nname = \"b\"\n";
    let put = forces(&deck(parts, "b.lower", "a.upper"), "b.lower");
    for (a, b) in one.iter().flatten().zip(put.iter().flatten()) {
        assert!((a - b).abs() < 1e-9 * one[2][1], "{a} {b}");
    }
    // A block is as good as a file.
    let parts = "[mesh]\nfile = \"lower.msh\"\n[[mesh.block]]\nname = \"upper\"\nelement = \"quad4\"\n\
                 x = [0, 4]\ny = [2, 4]\ncells = [3, 2]\n";
    let block = forces(&deck(parts, "lower", "upper"), "lower");
    for (a, b) in one.iter().flatten().zip(block.iter().flatten()) {
        assert!((a - b).abs() < 1e-9 * one[2][1], "{a} {b}");
    }
}

/// A part that has a name has a group of that name, of all its cells; the echo is the same problem.
#[test]
fn a_named_part_is_a_group() {
    let at = meshes();
    let parts = "[[mesh.part]]\nfile = \"lower.msh\"\nname = \"b\"\nscale = 2\nposition = [1, -2]\n\
                 [[mesh.part]]\nfile = \"upper.msh\"\nname = \"a\"\nposition = [0.0, 0.0]\n";
    let text = deck(parts, "b.lower", "a.upper").replace("on = \"a.upper\"", "on = \"a\"");
    let (read, problem, findings) = open_in(&text, &at);
    let Some(Problem::Plane(setup)) = problem else {
        panic!("{}", findings.render("deck.toml", &text, false))
    };
    let volumes: Vec<f64> = setup.bodies.iter().map(|b| b.volume).collect();
    assert!((volumes[0] - 32.0).abs() < 1e-12 && (volumes[1] - 8.0).abs() < 1e-12);
    assert_eq!(setup.driver.mesh().nodes()[0], [1.0, -2.0]);
    let once = read.resolved();
    let (again, problem, _) = open_in(&once, &at);
    assert!(problem.is_some(), "{once}");
    assert_eq!(again.resolved(), once);
}

/// In space a part is turned about an axis.
#[test]
fn parts_in_space() {
    let at = meshes();
    let line = uniform(0.0, 1.0, 1);
    let mesh = block3("cube", CellKind::Hex8, &uniform(0.0, 3.0, 1), &line, &line);
    write_mesh(&at.join("cube.msh"), &mesh.expect("a mesh")).expect("written");
    let text = r#"
units = "mm-N-MPa"
analysis = "solid"
[[mesh.part]]
file = "cube.msh"
turn = { axis = [0, 0, 2], angle = 90 }
position = [0, 0, 5]
[[material]]
on = "cube"
young = 1.0
poisson = 0.3
[[step]]
name = "hold"
increments = 1
fix = [{ on = "cube", u = ["x", "y", "z"] }]
"#;
    let (_, problem, findings) = open_in(text, &at);
    let Some(Problem::Solid(setup)) = problem else {
        panic!("{}", findings.render("deck.toml", text, false))
    };
    let (low, high) = setup.driver.mesh().bounds();
    for (found, expected) in [(low, [-1.0, 0.0, 5.0]), (high, [0.0, 3.0, 6.0])] {
        let off = (0..3).map(|i| (found[i] - expected[i]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-14, "{found:?}");
    }
    let flat_axis = text.replace("[0, 0, 2]", "[0, 0, 0]");
    let (_, _, findings) = open_in(&flat_axis, &at);
    let out = findings.render("deck.toml", &flat_axis, false);
    assert!(
        out.contains("axis of no length") && findings.errors() == 1,
        "{out}"
    );
}

#[test]
fn parts_that_do_not_fit_are_pointed_at() {
    let at = meshes();
    let solid = block3(
        "cube",
        CellKind::Hex8,
        &[0.0, 1.0],
        &[0.0, 1.0],
        &[0.0, 1.0],
    );
    write_mesh(&at.join("solid.msh"), &solid.expect("a mesh")).expect("written");
    let first = "[mesh]\nfile = \"lower.msh\"\n[[mesh.part]]\n";
    for (part, place, words) in [
        (
            "file = \"lower.msh\"",
            ":7:8",
            &[
                "the group \"lower\" exists already",
                "has this group",
                "name = \"part\"",
            ][..],
        ),
        (
            "file = \"both.msh\"",
            ":7:8",
            &["the group \"lower\" exists already"],
        ),
        ("file = \"solid.msh\"", ":7:8", &["is of dimension 3"]),
        (
            "file = \"uper.msh\"",
            ":7:8",
            &["beside it is \"upper.msh\""],
        ),
        ("name = \"a\"", ":6:1", &["has no key \"file\""]),
        (
            "file = \"upper.msh\"\nname = \"a b\"",
            ":8:8",
            &["not a name"],
        ),
        (
            "file = \"upper.msh\"\nscale = -1",
            ":8:9",
            &["scale is -1, expected a positive number"],
        ),
        ("file = \"upper.msh\"\nscale = 1e-320", ":7:8", &["cell"]),
        (
            "file = \"upper.msh\"\nposition = [1]",
            ":8:12",
            &["expected 2 numbers"],
        ),
        (
            "file = \"upper.msh\"\nturn = { axis = [0, 0, 1], angle = 2 }",
            ":8:8",
            &["turn is a table"],
        ),
        (
            "file = \"upper.msh\"\nprefix = \"a\"",
            ":8:1",
            &["unknown key \"prefix\"", "name"],
        ),
    ] {
        let text = deck(&format!("{first}{part}\n"), "lower", "upper");
        let (_, problem, findings) = open_in(&text, &at);
        let out = findings.render("deck.toml", &text, false);
        assert!(
            problem.is_none() && out.contains(&format!("deck.toml{place}")),
            "{place}: {out}"
        );
        for word in words {
            assert!(flat(&out).contains(word), "{word:?} in {out}");
        }
        let all = |class| findings.iter().all(|f| f.class == class);
        let few = findings.errors() == 1;
        assert!(
            few && [Class::Meshes, Class::Values, Class::Keys]
                .into_iter()
                .any(all),
            "{out}"
        );
    }
    let across = "[[mesh.part]]\nfile = \"lower.msh\"\nposition = [-1, 0]\n[[mesh.part]]\nfile = \"upper.msh\"\n";
    let text = deck(across, "lower", "upper").replace("plane-strain", "axisymmetric");
    let (_, _, findings) = open_in(&text, &at);
    let out = findings.render("deck.toml", &text, false);
    assert!(
        out.contains("reaches the radius -1") && out.contains("deck.toml:5:8"),
        "{out}"
    );
}
