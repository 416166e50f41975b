//! Runs with known answers: the examples, sums of forces, cylinders of metal and of soil.

use super::{BALL, column, directory, examples, last, moreau, run, text};
use rayon::prelude::*;
use std::fs;
use std::path::Path;

/// Every example has expectations, and meets them.
#[test]
fn every_example_is_as_expected() {
    let entries = fs::read_dir(examples()).expect("examples");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let decks: Vec<_> = paths
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    assert!(decks.len() >= 6);
    decks.par_iter().for_each(|deck| is_as_expected(deck));
}

fn is_as_expected(path: &Path) {
    let deck = fs::read_to_string(path).expect("a deck");
    assert!(deck.contains("[expect]"), "{}", path.display());
    let name = path.file_stem().expect("a name").to_string_lossy();
    let results = directory(&name);
    let (from, to) = (path.to_string_lossy(), results.to_string_lossy());
    let output = moreau(&["run", &from, "--out", &to, "--verify"]);
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    let status = output.status.code().expect("a status");
    assert_eq!(status, 0, "{}\n{out}{err}", path.display());
    assert!(out.contains("met") && !out.contains("FAILED"), "{out}");
    let touches = deck.contains("[[contact]]");
    let files = [
        "history.csv",
        "contact.csv",
        "run.json",
        "deck.resolved.toml",
        "result.pvd",
        "history.svg",
        "deformed.svg",
        "report.html",
        "log.jsonl",
    ];
    for file in files {
        assert!(results.join(file).exists(), "{name}: {file}");
    }
    let drawn = results.join("contact.svg").exists();
    assert_eq!(drawn, touches, "{name}: contact.svg");
    let check = moreau(&["check", &from]);
    assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
}

/// On a mesh of Gmsh, forces balance: punch and foundation, friction and symmetry plane.
#[test]
fn forces_balance_on_a_mesh_of_gmsh() {
    let deck = examples().join("punch-on-gmsh-mesh.toml");
    let results = directory("balance");
    let (from, to) = (deck.to_string_lossy(), results.to_string_lossy());
    assert_eq!(
        moreau(&["run", &from, "--out", &to, "--quiet"])
            .status
            .code(),
        Some(0)
    );
    let pairs = [
        ("force.punch.y", "force.foundation.y"),
        ("force.symmetry.x", "force.foundation.x"),
    ];
    for (given, taken) in pairs {
        for (a, b) in column(&results, given).iter().zip(column(&results, taken)) {
            assert!((a + b).abs() < 1e-9 * b.abs().max(1.0), "{given}: {a} {b}");
        }
    }
    // The foundation carries what the punch gives, and friction at most a tenth of it.
    let (normal, friction) = (
        last(&results, "force.foundation.y"),
        last(&results, "force.foundation.x"),
    );
    assert!(normal > 0.0 && friction < 0.0 && -friction <= 0.1 * normal * (1.0 + 1e-9));
}

/// A sphere pressed into a block of hexahedra; and a ring squeezed along its axis.
#[test]
fn solids_and_rings_run() {
    let (status, out, err, results) = run("solid", BALL, &[]);
    assert_eq!(status, 0, "{out}{err}");
    let vtu = fs::read(results.join("contact_00002.vtu")).expect("a surface");
    assert!(text(&vtu).contains("NumberOfPoints=\"25\" NumberOfCells=\"16\""));
    // A hollow cylinder, x from 1 to 2, free at both rims: E ε A = 1000 · 0.01 · 3 π.
    let force = 1000.0 * 0.01 * 3.0 * std::f64::consts::PI;
    let ring = format!(
        r#"
units = "mm-N-MPa"
analysis = "axisymmetric"
mesh.block = [{{ name = "b", element = "quad8", x = [1, 2], y = [0, 1], cells = [2, 2] }}]
material = [{{ on = "b", young = 1000.0, poisson = 0.3 }}]
[[step]]
name = "pull"
increments = 1
fix = [{{ on = "b.bottom", u = ["y"] }}]
move = [{{ on = "b.top", u = {{ y = 0.01 }} }}]
[expect]
"force.b.top.y" = {{ value = {force}, relative = 1e-9 }}
"#
    );
    let (status, out, err, _) = run("ring", &ring, &["--verify"]);
    assert_eq!(status, 0, "{out}{err}");
}

/// A cylinder of soil between smooth plates carries 2 c cos φ/(1 − sin φ), associated or not, and says
/// what it is made of.
#[test]
fn a_soil_has_its_strength_in_compression() {
    let (sine, cosine) = 30f64.to_radians().sin_cos();
    let force = -2.0 * 0.02 * cosine / (1.0 - sine) * 4.0 * std::f64::consts::PI;
    for dilatancy in [30, 15] {
        // The axial plastic strain ε less the elastic one, and e_v = k_t √(3/2) (ε + e_v/3).
        let axial = 0.02 + force / (4.0 * std::f64::consts::PI) / 20.0;
        let sine = f64::from(dilatancy).to_radians().sin();
        let slope = 1.5f64.sqrt() * 2.0 * 6f64.sqrt() * sine / (3.0 - sine);
        let dilation = slope * axial / (1.0 - slope / 3.0);
        let deck = format!(
            r#"
units = "mm-N-MPa"
analysis = "axisymmetric"
mesh.block = [{{ name = "b", element = "quad8", x = [0, 2], y = [0, 4], cells = [2, 2] }}]
[[material]]
on = "b"
young = 20.0
poisson = 0.3
cohesion = 0.02
friction-angle = 30
dilatancy-angle = {dilatancy}
[[step]]
name = "compress"
increments = 10
fix = [{{ on = "b.bottom", u = ["y"] }}, {{ on = "b.left", u = ["x"] }}]
move = [{{ on = "b.top", u = {{ y = -0.08 }} }}]
[expect]
"force.b.top.y" = {{ value = {force}, relative = 1e-7 }}
"largest.plastic_dilation" = {{ value = {dilation}, relative = 1e-6 }}
"#
        );
        let (status, out, err, results) = run("soil", &deck, &["--verify"]);
        assert_eq!(status, 0, "{out}{err}");
        let resolved = results.join("deck.resolved.toml");
        let again = fs::read_to_string(resolved).expect("a deck");
        assert!(again.contains("friction-angle = 30.0"), "{again}");
        assert!(
            again.contains(&format!("dilatancy-angle = {dilatancy}.0")),
            "{again}"
        );
    }
}
