//! The command as a person runs it: exit status, what it says, and the files that it leaves.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples")
}

fn directory(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    // Nothing may be there yet.
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a directory");
    path
}

fn moreau(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_moreau"))
        .args(arguments)
        .output()
        .expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a deck, given as text, into a directory; status, stdout and stderr.
fn run(name: &str, deck: &str, more: &[&str]) -> (i32, String, String, PathBuf) {
    let at = directory(name);
    let file = at.join("deck.toml");
    fs::write(&file, deck).expect("a deck");
    let out = at.join("results");
    let mut arguments = vec!["run", file.to_str().expect("a path"), "--out"];
    arguments.push(out.to_str().expect("a path"));
    arguments.extend(more);
    let output = moreau(&arguments);
    let status = output.status.code().expect("a status");
    (status, text(&output.stdout), text(&output.stderr), out)
}

fn punched() -> String {
    fs::read_to_string(examples().join("punched-block.toml")).expect("the example")
}

/// Every example has expectations, and meets them.
#[test]
fn every_example_is_as_expected() {
    let mut count = 0;
    for entry in fs::read_dir(examples()).expect("examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let deck = fs::read_to_string(&path).expect("a deck");
        assert!(deck.contains("[expect]"), "{}", path.display());
        let name = path
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let (status, out, err, results) = run(&name, &deck, &["--verify"]);
        assert_eq!(status, 0, "{}\n{out}{err}", path.display());
        assert!(out.contains("met") && !out.contains("FAILED"), "{out}");
        for file in [
            "history.csv",
            "contact.csv",
            "run.json",
            "deck.resolved.toml",
            "result.pvd",
            "history.svg",
            "contact.svg",
            "deformed.svg",
        ] {
            assert!(results.join(file).exists(), "{name}: {file}");
        }
        let check = moreau(&["check", path.to_str().expect("a path")]);
        assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
        count += 1;
    }
    assert!(count >= 4);
}

#[test]
fn the_history_has_its_columns_and_the_force_of_the_library() {
    let (status, out, _, results) = run("history", &punched(), &[]);
    assert_eq!(status, 0);
    assert!(
        out.contains("certificate") && out.contains("force.punch.y"),
        "{out}"
    );
    let history = fs::read_to_string(results.join("history.csv")).expect("a history");
    let mut lines = history.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|l| l.split(',').collect()).collect();
    assert_eq!(rows.len(), 20);
    assert!(rows.iter().all(|r| r.len() == header.len()));
    let plain: Vec<&str> = header.iter().filter_map(|h| h.split(' ').next()).collect();
    for name in [
        "step",
        "increment",
        "time",
        "newton_iterations",
        "contact_iterations",
        "cuts",
        "open",
        "stick",
        "slip",
        "plastic_fraction",
        "external_work",
        "elastic_energy",
        "plastic_dissipation",
        "friction_dissipation",
        "bipotential_gap",
        "out_of_balance",
        "force.punch.x",
        "u.punch.y",
        "force.foundation.y",
        "u.foundation.x",
        "force.block.left.x",
    ] {
        assert!(plain.contains(&name), "{name} in {plain:?}");
    }
    assert!(header.contains(&"external_work [N·mm]"));
    let last = |name: &str| -> f64 {
        let k = plain.iter().position(|n| *n == name).expect("a column");
        rows[19][k].parse().expect("a number")
    };
    assert!((last("force.punch.y") + 10519.53783).abs() < 1e-3);
    assert_eq!(last("time"), 1.0);
    assert!((last("u.punch.y") + 0.2).abs() < 1e-12);
    // Only what holds the group along x: the sum of forces along x is zero.
    assert!((last("force.block.left.x") + last("force.foundation.x")).abs() < 1e-6);
    assert_eq!(last("force.punch.x"), 0.0);

    let contact = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    assert_eq!(contact.lines().count(), 1 + 20 * 21);
    assert!(contact.starts_with("step,increment,contact,node,x [mm],"));
    assert!(contact.lines().all(|l| l.split(',').count() == 18));
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    let json: serde_json::Value = serde_json::from_str(&json).expect("json");
    assert_eq!(json["status"], "done");
    assert_eq!(json["dofs"], 170);
    assert!(
        json["certificate"]["relative_gap"]
            .as_f64()
            .is_some_and(|g| g < 1e-10)
    );
    let pvd = fs::read_to_string(results.join("result.pvd")).expect("a list");
    assert_eq!(pvd.matches("<DataSet").count(), 40);
}

#[test]
fn units_are_named_in_the_headers_and_change_nothing_else() {
    // The same block in metres and pascals.
    let deck = punched()
        .replace("mm-N-MPa", "m-N-Pa")
        .replace("x = [0, 50]", "x = [0, 0.05]")
        .replace("y = [0, 20]", "y = [0, 0.02]")
        .replace("x = [0, 25]", "x = [0, 0.025]")
        .replace("210000.0", "210e9")
        .replace("300.0", "300e6")
        .replace("y = -0.2", "y = -0.2e-3")
        .replace("analysis =", "thickness = 1e-3\nanalysis =");
    let (status, out, err, results) = run("metres", &deck, &["--verify"]);
    assert_eq!(status, 0, "{out}{err}");
    let history = fs::read_to_string(results.join("history.csv")).expect("a history");
    assert!(history.contains("external_work [N·m]") && history.contains("u.punch.y [m]"));
}

#[test]
fn results_do_not_depend_on_the_threads() {
    let (_, _, _, one) = run("one-thread", &punched(), &["--threads", "1", "--quiet"]);
    let (_, _, _, two) = run("two-threads", &punched(), &["--threads", "2", "--quiet"]);
    for file in ["history.csv", "contact.csv", "body_00020.vtu"] {
        let read = |d: &Path| fs::read(d.join(file)).expect("a file");
        assert_eq!(read(&one), read(&two), "{file}");
    }
}

#[test]
fn exit_status_tells_what_happened() {
    let wrong = punched().replace("poisson = 0.3", "poisson = 3");
    let (status, _, err, _) = run("wrong", &wrong, &[]);
    assert_eq!(status, 1);
    assert!(
        err.contains("deck.toml:22:11") && err.contains("Poisson"),
        "{err}"
    );

    let other = punched().replace("value = -10519.5378", "value = -10520.5378");
    let (status, out, _, _) = run("unexpected", &other, &["--verify"]);
    assert_eq!(status, 3);
    assert!(out.contains("FAILED"), "{out}");
    // Without being asked to verify, a run that ends is done.
    assert_eq!(run("unasked", &other, &["--quiet"]).0, 0);

    // A pressure beyond the limit load: what converged before it is written.
    let collapse = punched()
        .replace(
            "move = [{ on = \"punch\", u = { y = -0.2 } }]",
            "load = [{ on = \"punch\", pressure = 1000 }]",
        )
        .replace(
            "\"force.punch.y\" = { value = -10519.5378, absolute = 1e-3 }",
            "",
        );
    let (status, out, err, results) = run("collapse", &collapse, &["--verify"]);
    assert_eq!(status, 2, "{out}{err}");
    assert!(err.contains("limit load"), "{err}");
    let rows = fs::read_to_string(results.join("history.csv")).expect("a history");
    assert!(rows.lines().count() > 3);
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    assert!(json.contains("not converged"));
    assert!(results.join("deformed.svg").exists());

    assert_eq!(moreau(&["run", "no-such-deck.toml"]).status.code(), Some(1));
    assert_eq!(moreau(&["fly"]).status.code(), Some(1));
    assert_eq!(moreau(&["--help"]).status.code(), Some(0));
}

#[test]
fn every_contact_method_gives_the_same_force() {
    for (k, solver) in [
        "contact = \"uzawa\"",
        "contact = \"gauss-seidel\"",
        "contact = \"uzawa\"\nnesting = \"outside\"",
        "contact = { penalty = { normal = 1e12, tangent = 1e12 } }",
    ]
    .into_iter()
    .enumerate()
    {
        let deck = punched()
            .replace("increments = 20", "increments = 5")
            .replace("y = -0.2", "y = -0.02")
            .replace("[expect]", &format!("[solver]\n{solver}\n[expect]"));
        let exact = deck.replace(solver, "contact = \"exact\"");
        let force = |name: &str, deck: &str| -> f64 {
            let (status, out, err, results) = run(name, deck, &[]);
            assert_eq!(status, 0, "{solver}: {out}{err}");
            let json = fs::read_to_string(results.join("run.json")).expect("a summary");
            let json: serde_json::Value = serde_json::from_str(&json).expect("json");
            json["expectations"][0]["found"].as_f64().expect("a force")
        };
        let (a, b) = (
            force(&format!("m{k}"), &deck),
            force(&format!("e{k}"), &exact),
        );
        assert!((a / b - 1.0).abs() < 1e-6, "{solver}: {a} {b}");
    }
}

/// A sphere pressed into a block of hexahedra; and a ring squeezed along its axis.
#[test]
fn solids_and_rings_run() {
    let solid = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "hex8", x = [0, 4], y = [0, 4], z = [0, 4], cells = [4, 4, 4] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "ball", sphere = { center = [0, 14, 0], radius = 10 } }]
contact = [{ surface = "b.top", against = "ball", friction = 0.3 }]
[[step]]
name = "press"
increments = 2
fix = [
  { on = "b.bottom", u = ["y"] },
  { on = "b.left", u = ["x"] },
  { on = "b.back", u = ["z"] },
]
tools = [{ name = "ball", move = [0, -0.2, 0] }]
"#;
    let (status, out, err, results) = run("solid", solid, &[]);
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

#[test]
fn a_contact_that_never_closes_is_told() {
    let hover = punched()
        .replace("point = [0, 0]", "point = [0, -5]")
        .replace(
            "move = [{ on = \"punch\", u = { y = -0.2 } }]",
            "move = [{ on = \"punch\", u = { x = 0, y = -0.2 } }]",
        );
    let (status, out, err, _) = run("hover", &hover, &[]);
    assert_eq!(status, 0, "{out}{err}");
    assert!(out.contains("never closed"), "{out}");
}
