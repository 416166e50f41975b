//! The files of a run, of a conversion and of the schema: what is in them.

use super::{BALL, directory, examples, moreau, punched, run, text};
use std::fs;

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
    assert!(contact.starts_with("step,increment,contact,against,node,x [mm],"));
    assert!(contact.lines().all(|l| l.split(',').count() == 23));
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
    // At the start the body, then the body, its contacts and the tools.
    assert_eq!(pvd.matches("<DataSet").count(), 61);
    let tools = pvd.lines().filter(|l| l.contains("name=\"tools\""));
    assert_eq!(tools.count(), 20);
    let tools = fs::read(results.join("tools_00020.vtu")).expect("tools");
    let tools = String::from_utf8_lossy(&tools);
    assert!(tools.contains("displacement") && tools.contains("\"tool\""));
}

#[test]
fn the_log_has_every_iteration() {
    let (status, out, err, results) = run("log", &punched(), &["--json-log"]);
    assert_eq!((status, err.as_str()), (0, ""));
    let log = fs::read_to_string(results.join("log.jsonl")).expect("a log");
    assert_eq!(out, log);
    let lines: Vec<serde_json::Value> = log
        .lines()
        .map(|l| serde_json::from_str(l).expect("json"))
        .collect();
    let newton = lines.iter().filter(|l| l["iteration"] != 0).count();
    let contact = lines
        .iter()
        .filter_map(|l| l["contact_iterations"].as_u64());
    let contact: u64 = contact.sum();
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    let json: serde_json::Value = serde_json::from_str(&json).expect("json");
    assert_eq!(json["newton_iterations"], newton);
    assert_eq!(json["contact_iterations"], contact);
    let last = lines.last().expect("a line");
    assert!(last["increment"] == 20 && last["cut"] == 0 && last["step"] == "press");
    let relative = last["relative_residual"].as_f64();
    assert!(relative.is_some_and(|r| r <= 1e-10));
}

/// Streams, not lists: thirty times the increments take no more memory.
#[test]
fn memory_does_not_grow_with_the_increments() {
    let peak = |increments: usize| {
        let deck = punched()
            .replace("increments = 20", &format!("increments = {increments}"))
            .replace("yield-stress = 300.0", "");
        let deck = deck.split("[expect]").next().expect("a deck").to_owned();
        let deck = deck + "[output]\nvtu = \"last\"\ncheckpoint = 100\n";
        let (status, _, err, results) = run(&format!("many-{increments}"), &deck, &["--quiet"]);
        assert_eq!(status, 0, "{err}");
        let json = fs::read_to_string(results.join("run.json")).expect("a summary");
        let json: serde_json::Value = serde_json::from_str(&json).expect("json");
        json["peak_memory_mb"].as_f64()
    };
    // Where the system does not tell there is nothing to see.
    if let (Some(few), Some(many)) = (peak(30), peak(1000)) {
        assert!(many < few + 2.0, "{few} MB, then {many} MB");
    }
}

#[test]
fn meshes_are_converted() {
    let mesh = examples().join("punch-on-gmsh-mesh.msh");
    let at = directory("converted");
    let from = mesh.to_string_lossy();
    for name in ["mesh.msh", "mesh.vtu"] {
        let to = at.join(name);
        let output = moreau(&["convert", &from, &to.to_string_lossy()]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("358 nodes, 161 cells, 5 groups"));
    }
    let vtu = text(&fs::read(at.join("mesh.vtu")).expect("a file"));
    assert!(vtu.contains("NumberOfPoints=\"358\" NumberOfCells=\"161\""));
    assert!(vtu.contains("Name=\"block\"") && vtu.contains("Name=\"round\""));
    let hex = examples().join("../../crates/mesh/tests/data/hex8.4b.msh");
    let to = at.join("hex.msh");
    let output = moreau(&["convert", &hex.to_string_lossy(), &to.to_string_lossy()]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    for (from, to, word) in [
        ("none.msh", "a.vtu", "none.msh"),
        (&*from, "a.stl", ".msh (Gmsh) or .vtu (VTK)"),
        ("a.stl", "a.vtu", ".msh (Gmsh) or .inp"),
    ] {
        let output = moreau(&["convert", from, to]);
        assert_eq!(output.status.code(), Some(1));
        assert!(
            text(&output.stderr).contains(word),
            "{}",
            text(&output.stderr)
        );
    }
}

#[test]
fn the_schema_is_printed() {
    let output = moreau(&["schema"]);
    let schema: serde_json::Value = serde_json::from_slice(&output.stdout).expect("json");
    assert_eq!(schema["title"], "moreau deck");
}

#[test]
fn numbers_for_people_have_powers_only_where_they_must() {
    for (value, digits, text) in [
        (0.0, 9, "0"),
        (-0.0, 9, "0"),
        (40.000000000001, 7, "40"),
        (322.114523456, 9, "322.114523"),
        (-1822.435412345, 9, "-1822.43541"),
        (0.00012345678, 4, "0.0001235"),
        (1.2345e-17, 3, "1.23e-17"),
        (2.1e11, 7, "2.1e11"),
        (f64::NAN, 9, "NaN"),
    ] {
        assert_eq!(moreau::numbers::shown(value, digits), text);
    }
}

/// Quadrature points of the last increment unless the deck says otherwise, as a part of the list.
#[test]
fn quadrature_points_are_written_as_asked_for() {
    let of = |name: &str, output: &str| {
        let deck = BALL.to_owned() + "[output]\n" + output;
        let (status, _, err, results) = run(&format!("points-{name}"), &deck, &["--quiet"]);
        assert_eq!(status, 0, "{err}");
        let list = fs::read_to_string(results.join("result.pvd")).unwrap_or_default();
        let parts = |name: &str| list.matches(&format!("name=\"{name}\"")).count();
        for k in 1..=2 {
            let file = format!("points_{k:05}.vtu");
            assert_eq!(list.contains(&file), results.join(&file).exists(), "{file}");
        }
        assert!(parts("points") != 1 || list.contains("points_00002.vtu"));
        [parts("body"), parts("contact"), parts("points")]
    };
    assert_eq!(of("default", ""), [2, 2, 1]);
    assert_eq!(of("all", "points = \"all\""), [2, 2, 2]);
    assert_eq!(of("none", "points = \"none\""), [2, 2, 0]);
    assert_eq!(of("alone", "vtu = \"none\"\npoints = \"last\""), [0, 0, 1]);
    assert_eq!(of("nothing", "vtu = \"none\""), [0, 0, 0]);
}
