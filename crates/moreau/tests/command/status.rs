//! Runs that fail, stop early or are doubtful: the exit status, and what is said about them.

use super::{directory, examples, moreau, punched, run, text};
use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn exit_status_tells_what_happened() {
    let wrong = punched().replace("poisson = 0.3", "poisson = 3");
    let (status, _, err, _) = run("wrong", &wrong, &[]);
    assert_eq!(status, 1);
    assert!(
        err.contains("deck.toml:22:11")
            && err.contains("Poisson")
            && err.contains("1 error, 0 warnings"),
        "{err}"
    );

    let other = punched().replace("value = -10519.5378", "value = -10520.5378");
    let (status, out, _, _) = run("unexpected", &other, &["--verify"]);
    assert_eq!(status, 3);
    assert!(out.contains("FAILED"), "{out}");
    // Without being asked to verify, a run that ends is done.
    assert_eq!(run("unasked", &other, &["--quiet"]).0, 0);

    // A pressure beyond the limit load: not carried, but followed to the plateau and told.
    let collapse = punched()
        .replace(
            "move = [{ on = \"punch\", u = { y = -0.2 } }]",
            "load = [{ on = \"punch\", pressure = 1000 }]",
        )
        .replace(
            "\"force.punch.y\" = { value = -10519.5378, absolute = 1e-3 }",
            "",
        );
    let summary = |results: &Path| -> serde_json::Value {
        let json = fs::read_to_string(results.join("run.json")).expect("a summary");
        serde_json::from_str(&json).expect("json")
    };
    let (status, out, err, results) = run("collapse", &collapse, &["--verify"]);
    assert_eq!(status, 2, "{out}{err}");
    assert!(err.contains("collapse at load factor 0.388"), "{err}");
    assert!(out.contains("limit load") && err.contains("until = \"collapse\""));
    let rows = fs::read_to_string(results.join("history.csv")).expect("a history");
    assert!(rows.lines().count() > 3);
    let json = summary(&results);
    assert_eq!(json["status"], "collapsed");
    let factor = json["collapse"]["load_factor"].as_f64().expect("a number");
    let bound = json["collapse"]["upper_bound"].as_f64().expect("a number");
    assert!(bound >= factor && bound < factor + 1e-4, "{factor} {bound}");
    assert_eq!(json["collapse"]["strict"], false, "Coulomb friction");
    // Asked for, it is the end of the step; a load that is carried is not.
    let until = "increments = 20\nuntil = \"collapse\"";
    let sought = collapse.replace("increments = 20", until);
    let (status, _, err, results) = run("sought", &sought, &["--quiet"]);
    assert_eq!(
        (status, summary(&results)["status"].as_str()),
        (0, Some("done")),
        "{err}"
    );
    let carried = sought.replace("pressure = 1000", "pressure = 100");
    let (status, _, err, _) = run("carried", &carried, &["--quiet"]);
    assert!(status == 2 && err.contains("loads are carried"), "{err}");

    // Pulled off its foundation: no equilibrium, and advice.
    let pulled = collapse.replace("pressure = 1000", "pressure = -10");
    let (status, _, err, results) = run("pulled", &pulled, &["--quiet"]);
    assert_eq!(status, 2, "{err}");
    let json = summary(&results);
    assert_eq!(json["status"], "not converged");
    let suggestion = json["diagnosis"]["suggestion"].as_str();
    let suggestion = suggestion.unwrap_or_default();
    for words in ["nothing holds the body \"block\"", "translation along y"] {
        assert!(suggestion.contains(words), "{suggestion}");
    }

    let told = |arguments: &[&str], words: &[&str]| {
        let output = moreau(arguments);
        let err = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{err}");
        assert!(words.iter().all(|w| err.contains(w)), "{err}");
    };
    told(&["run", "no-such-deck.toml"], &["no-such-deck.toml"]);
    let [deck, file] = ["../deck.toml", "run.json"].map(|f| results.join(f).display().to_string());
    told(&["run", &deck, "--out", &file], &[&file, "this is a file"]);
    for command in ["plot", "resume"] {
        told(
            &[command, "no-such"],
            &["no-such is no directory of results"],
        );
    }
    assert_eq!(moreau(&["fly"]).status.code(), Some(1));
    assert_eq!(moreau(&["--help"]).status.code(), Some(0));
}

/// Uzawa's method around the nonlinear solve follows no path: beyond collapse it stops, and says how
/// far that was. Without contacts it has nothing to do otherwise.
#[test]
fn a_run_that_stops_below_collapse_says_how_far_it_is() {
    let example = examples().join("cylinder-to-collapse.toml");
    let example = fs::read_to_string(example).expect("the example");
    let head = example.split("[expect]").next().expect("a deck");
    let head = head.replace("until = \"collapse\"\n", "");
    let solver = |nesting: &str| format!("{head}[solver]\ncontact = \"uzawa\"\n{nesting}\n");
    let (status, _, err, _) = run("no-contact", &solver(""), &["--quiet"]);
    assert!(
        status == 2 && err.contains("collapse at load factor 0.5"),
        "{err}"
    );
    let outside = solver("nesting = \"outside\"");
    let (status, _, err, results) = run("outside", &outside, &["--quiet"]);
    assert_eq!(status, 2, "{err}");
    assert!(err.contains("the last increments put at 50.0 %"), "{err}");
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    let json: serde_json::Value = serde_json::from_str(&json).expect("json");
    let told = &json["diagnosis"];
    let limit = told["load_factor"].as_f64().expect("an estimate");
    assert!((limit / 0.5 - 1.0).abs() < 2e-2, "{limit}");
    assert!(told["plastic_fraction"].as_f64().is_some_and(|p| p > 0.5));
}

/// A footing on soil without dilatancy, in one increment that Newton's method is too slow for and that
/// must not be cut: what is out of balance is told and shown.
#[test]
fn a_run_that_fails_says_what_is_out_of_balance() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 4], y = [0, 4], cells = [8, 8] }]
mesh.group = [{ name = "foot", on = "b.top", x = [0, 1] }]
[[material]]
on = "b"
young = 20.0
poisson = 0.3
cohesion = 0.02
friction-angle = 40
dilatancy-angle = 0
[[step]]
name = "press"
increments = { start = 1, min = 1, max = 1 }
fix = [
  { on = "b.bottom", u = ["x", "y"] },
  { on = "b.left", u = ["x"] },
  { on = "b.right", u = ["x"] },
]
move = [{ on = "foot", u = { y = -0.4 } }]
"#;
    let (status, out, err, results) = run("footing", deck, &[]);
    assert_eq!(status, 2, "{out}{err}");
    assert!(out.contains("nodes farthest out of balance"), "{out}");
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    let json: serde_json::Value = serde_json::from_str(&json).expect("json");
    let told = &json["diagnosis"];
    assert!(told["plastic_fraction"].as_f64().is_some_and(|p| p > 0.1));
    assert!(
        told["load_factor"].is_null(),
        "the footing is moved, not loaded"
    );
    let worst = told["worst"].as_array().expect("nodes");
    let force = |k: usize| worst[k]["force"].as_f64().expect("a force");
    assert_eq!(worst.len(), 5);
    assert!((1..5).all(|k| force(k) <= force(k - 1)) && force(4) > 1e-6);
    // The attempt is there to be looked at, beside what nothing balances.
    let shown = text(&fs::read(results.join("failed.vtu")).expect("a file"));
    assert!(shown.contains("NumberOfPoints=\"225\"") && shown.contains("\"out_of_balance\""));
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

/// Klarbring's triangle, of which the critical friction is 2: told above it, with the node, and not below.
#[test]
fn friction_at_its_critical_value_is_told() {
    let at = directory("klarbring");
    let mesh = at.join("triangle.msh");
    // Nodes 1, the tip, to 3; what holds it, what may touch, and the triangle.
    let triangle = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n\
        $PhysicalNames\n4\n0 1 \"tip\"\n1 2 \"held\"\n1 3 \"side\"\n2 4 \"body\"\n$EndPhysicalNames\n\
        $Nodes\n3\n1 0 0 0\n2 0 2 0\n3 -1 1 0\n$EndNodes\n\
        $Elements\n4\n1 15 2 1 1 1\n2 1 2 2 2 2 3\n3 1 2 3 3 1 2\n4 2 2 4 4 1 2 3\n$EndElements\n";
    fs::write(&mesh, triangle).expect("a mesh");
    let deck = |mu: f64| {
        format!(
            r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.file = {mesh:?}
material = [{{ on = "body", young = 2.5, poisson = 0.25 }}]
tool = [{{ name = "floor", plane = {{ point = [0, 0], normal = [0, 1] }} }}]
contact = [{{ surface = "side", against = "floor", friction = {mu} }}]
[[step]]
name = "press"
increments = 1
fix = [{{ on = "held", u = ["x", "y"] }}]
load = [{{ on = "tip", force = [-3.5, -1] }}]
"#
        )
    };
    for mu in [1.9, 2.1] {
        let name = format!("critical-{mu}");
        let (status, out, err, results) = run(&name, &deck(mu), &[]);
        assert_eq!(status, 0, "{out}{err}");
        let json = fs::read_to_string(results.join("run.json")).expect("a summary");
        let json: serde_json::Value = serde_json::from_str(&json).expect("json");
        let ratio = json["certificate"]["friction_over_critical"].as_f64();
        assert!(
            ratio.is_some_and(|r| (r - mu / 2.0).abs() < 1e-12),
            "{json}"
        );
        let warnings = json["warnings"].as_array().expect("a list");
        let told =
            "the friction of \"side\" with \"floor\" is 1.05 times its critical value at node 0";
        let critical = warnings
            .iter()
            .filter(|w| w.to_string().contains("critical value"));
        assert_eq!(critical.count(), usize::from(mu > 2.0), "{warnings:?}");
        assert_eq!(out.contains(told), mu > 2.0, "{out}");
    }
}

/// Who reads may go away, as `head` does: the run goes on to its end, and says so to nobody.
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let at = directory("pipe");
    let deck = examples().join("punched-block.toml");
    for (k, arguments) in [
        &["run"][..],
        &["run", "--json-log"],
        &["check"],
        &["schema"],
    ]
    .iter()
    .enumerate()
    {
        let mut command = Command::new(env!("CARGO_BIN_EXE_moreau"));
        command.args(*arguments);
        if arguments[0] != "schema" {
            command.arg(&deck);
        }
        let out = at.join(k.to_string());
        if arguments[0] == "run" {
            command.arg("--out").arg(&out);
        }
        let piped = std::process::Stdio::piped;
        let mut child = command
            .stdout(piped())
            .stderr(piped())
            .spawn()
            .expect("it starts");
        drop((child.stdout.take(), child.stderr.take()));
        assert_eq!(
            child.wait().expect("it ends").code(),
            Some(0),
            "{arguments:?}"
        );
        if arguments[0] == "run" {
            assert!(out.join("report.html").exists());
        }
    }
}

/// A log that is not written whole is told, and the run goes on to its end without it.
#[test]
#[cfg(target_os = "linux")]
fn a_log_that_cannot_be_written_is_told() {
    let out = directory("full").join("out");
    let full = std::fs::File::create("/dev/full").expect("a device");
    let result = Command::new(env!("CARGO_BIN_EXE_moreau"))
        .args(["run", "--json-log", "--out"])
        .args([&out, &examples().join("punched-block.toml")])
        .stdout(full)
        .output()
        .expect("it starts");
    let told = text(&result.stderr);
    assert_eq!(result.status.code(), Some(2), "{told}");
    assert!(
        told.contains("cannot write the log to the standard output"),
        "{told}"
    );
    assert!(out.join("report.html").exists());
}

/// A tool that a force takes past everything, and one that slides off: by name, with what to do.
#[test]
fn a_tool_that_nothing_holds_is_told() {
    let example = examples().join("block-under-driven-roll.toml");
    let example = fs::read_to_string(example).expect("the example");
    let (head, _) = example
        .split_once("[[step]]\nname = \"relax\"")
        .expect("two steps");
    let head = head.replace("cells = [20, 10]", "cells = [8, 4]");
    let beside = head.replace("center = [0, 70]", "center = [90, 70]");
    let (status, _, err, results) = run("beside", &beside, &["--quiet"]);
    assert_eq!(status, 1, "{err}");
    for words in [
        "tool \"roll\"",
        "nothing resists it",
        "36.02",
        "meets nothing",
    ] {
        assert!(err.contains(words), "{words} in {err}");
    }
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    assert!(json.contains("\"refused\"") && json.contains("nothing resists it"));
    let askew = head.replace("force = [0, -1000]", "force = [500, -1000]");
    let (status, _, err, _) = run("askew", &askew, &["--quiet"]);
    assert_eq!(status, 2, "{err}");
    assert!(
        err.contains("nothing holds the tool \"roll\" against its force"),
        "{err}"
    );
}

/// A block that is pushed harder than friction holds it: nothing has opened, and nothing says so.
#[test]
fn a_body_that_slides_away_is_told() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 4], y = [0, 2], cells = [4, 2] }]
material = [{ on = "b", young = 1e5, poisson = 0.3 }]
tool = [{ name = "floor", plane = { point = [0, 0], normal = [0, 1] } }]
contact = [{ surface = "b.bottom", against = "floor", friction = 0.3 }]
[[step]]
name = "push"
increments = 2
load = [{ on = "b", body-force = [0.2, -0.5] }]
"#;
    let (status, out, err, _) = run("slides", deck, &[]);
    assert_eq!(status, 2, "{out}{err}");
    assert!(
        err.contains("contacts alone hold the body \"b\" against its translation along x"),
        "{err}"
    );
    assert!(!err.contains("are open"), "{err}");
    // What needs bodies that are held without their contacts does not begin.
    let solver = "[solver]\ncontact = \"uzawa\"\nnesting = \"outside\"\n";
    let nested = format!("{}{solver}", deck.replace("[0.2, -0.5]", "[0, -0.5]"));
    let (status, out, err, _) = run("floats", &nested, &[]);
    assert_eq!(status, 1, "{out}{err}");
    assert!(
        err.contains("alone stop") && err.contains("`contact = \"exact\"`"),
        "{err}"
    );
}
