//! Runs that converge and are doubtful: what is told in the terminal, in `run.json` and in the report, and by
//! `check` before anything is solved; and that ordinary runs tell nothing.

use super::{directory, examples, moreau, punched, run, text};
use std::fs;
use std::path::Path;

/// A block under a tool, of steel.
fn block(element: &str, x: [f64; 2], cells: [usize; 2], tool: &str, travel: f64) -> String {
    format!(
        r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{{ name = "b", element = "{element}", x = {x:?}, y = [0, 10], cells = {cells:?} }}]
material = [{{ on = "b", young = 210e3, poisson = 0.3, yield-stress = 300, hardening = {{ linear = 1000 }} }}]
tool = [{{ name = "t", {tool} }}]
contact = [{{ surface = "b.top", against = "t", friction = 0.2 }}]
[output]
vtu = "none"
[[step]]
name = "s"
increments = 2
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "t", move = [0, {travel:?}] }}]
"#
    )
}

fn warnings(results: &Path) -> Vec<String> {
    let json = fs::read_to_string(results.join("run.json")).expect("a summary");
    let json: serde_json::Value = serde_json::from_str(&json).expect("json");
    let list = json["warnings"].as_array().expect("a list").iter();
    list.map(|w| w.as_str().expect("a text").to_owned())
        .collect()
}

/// As the page has it.
fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

/// Runs a deck to its end; each of these words is in one warning, which the terminal, `run.json` and the
/// report have, and there are no other warnings.
#[track_caller]
fn tells(name: &str, deck: &str, words: &[&[&str]]) -> Vec<String> {
    let (status, out, err, results) = run(name, deck, &[]);
    assert_eq!(status, 0, "{out}{err}");
    let warnings = warnings(&results);
    assert_eq!(warnings.len(), words.len(), "{warnings:#?}");
    let page = fs::read_to_string(results.join("report.html")).expect("a report");
    for (warning, words) in warnings.iter().zip(words) {
        for word in *words {
            assert!(warning.contains(word), "{word:?} in {warning:?}");
        }
        assert!(out.contains(&format!("warning: {warning}")), "{out}");
        let (top, _) = page.split_once("id=\"viewer\"").expect("a viewer");
        assert!(top.contains(&escaped(warning)), "{warning}");
    }
    warnings
}

#[test]
fn strains_and_rotations_that_are_not_small_are_told() {
    // A cylinder of 5 mm pressed 4 mm into a block of 10 mm.
    let tool = "cylinder = { center = [0, 15], radius = 5 }";
    let deck = block("quad8", [-10.0, 10.0], [20, 5], tool, -4.0);
    let told: [&[&str]; 2] = [
        &["strains are no longer small", " in cell ", "in increment 2"],
        &["rotations are no longer small", "° in cell "],
    ];
    tells("large", &deck, &told);
    // Pressed 0.02 mm it is small.
    tells("small", &deck.replace("-4.0", "-0.02"), &[]);
}

/// A block pressed flat, through itself.
#[test]
fn cells_turned_inside_out_are_told() {
    let tool = "plane = { point = [0, 10], normal = [0, -1] }";
    let deck = block("quad4", [0.0, 10.0], [2, 2], tool, -11.0);
    let (_, _, _, results) = run("inverted", &deck, &[]);
    let warnings = warnings(&results);
    let told = |w: &&String| w.contains("turned inside out") && w.contains("in increment 2");
    assert_eq!(warnings.iter().filter(told).count(), 1, "{warnings:#?}");
}

/// A cantilever of 1 mm by 40 mm pushed along its axis: straight on, it is unstable from Euler's load on, which is
/// 27.0 N per mm with ν = 0. Its tip would go sideways, and that is a file.
#[test]
fn a_column_that_may_buckle_under_large_strains_is_told() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
mesh.block = [{ name = "b", element = "quad8", x = [0, 1], y = [0, 40], cells = [1, 16] }]
material = [{ on = "b", young = 210000.0, poisson = 0.0 }]
output = { vtu = "last" }
[[step]]
name = "squeeze"
increments = 4
fix = [{ on = "b.bottom", u = ["x", "y"] }]
load = [{ on = "b.top", traction = [0, -30.0] }]
"#;
    let euler = std::f64::consts::PI.powi(2) * 210_000.0 / 12.0 / 6400.0;
    assert!(euler > 22.5 && euler < 30.0, "{euler}");
    let told: &[&str] = &[
        "unstable from increment 4 on",
        "one path among several; it gives way with node",
        "at [",
        "40] moving most, along [",
    ];
    tells("unstable", deck, &[told]);
    let (_, _, _, results) = run("unstable", deck, &[]);
    let mode = std::fs::read(results.join("mode_00004.vtu")).expect("a mode");
    assert!(String::from_utf8_lossy(&mode).contains("Name=\"mode\""));
    let list = std::fs::read_to_string(results.join("result.pvd")).expect("a list");
    assert_eq!(list.matches("mode_00004.vtu").count(), 1);
}

/// A column of 1 mm by 40 mm under a plate: 17 times the stresses of Euler for clamped ends, at the end of the
/// step; then none, when the plate has gone.
#[test]
fn a_column_that_has_buckled_is_told() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 1], y = [0, 40], cells = [1, 16] }]
material = [{ on = "b", young = 210000.0, poisson = 0.3 }]
tool = [{ name = "t", plane = { point = [0, 40], normal = [0, -1] } }]
contact = [{ surface = "b.top", against = "t", friction = 0.3 }]
[[step]]
name = "squeeze"
increments = 2
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "t", move = [0, -0.8] }]
"#;
    // π²/3 (h/L)² is the strain of Euler, of 0.02.
    let critical = std::f64::consts::PI.powi(2) / 3.0 / 1600.0 / 0.02;
    let warnings = tells(
        "buckled",
        deck,
        &[&[
            "buckling",
            "end of step \"squeeze\"",
            "at [",
            "has buckled before",
        ]],
    );
    let after = warnings[0]
        .split("with the surface, at ")
        .nth(1)
        .expect("a factor");
    let factor: f64 = after
        .split(' ')
        .next()
        .expect("a number")
        .parse()
        .expect("it is");
    assert!(
        (factor / critical - 1.0).abs() < 0.05,
        "{factor} {critical}"
    );
    let short = deck.replace("y = [0, 40]", "y = [0, 2]");
    let short = short
        .replace("cells = [1, 16]", "cells = [1, 4]")
        .replace("point = [0, 40]", "point = [0, 2]")
        .replace("-0.8", "-0.01");
    tells("not buckled", &short, &[]);
}

#[test]
fn tools_that_pass_between_nodes_are_told() {
    let tip = "polyline = [[10, 20], [0, 10], [-10, 20]]";
    let deck = block("quad4", [-10.0, 10.0], [21, 4], tip, -0.3);
    let told: [&[&str]; 2] = [
        &[
            "the tool \"t\" is 0.3",
            "\"b.top\"",
            "at [0, 10] in increment 2",
            "0.952",
        ],
        &["never closed"],
    ];
    tells("tip", &deck, &told);
    let wire = "cylinder = { center = [6.1, 10.3], radius = 0.3 }";
    let deck = block("quad8", [0.0, 20.0], [4, 2], wire, -2.0);
    tells(
        "wire",
        &deck,
        &[&["the tool \"t\" is 2 mm"], &["never closed"]],
    );
}

/// A block that is moved as a whole has forces that are rounding, whose work is no imbalance.
#[test]
fn energies_that_are_rounding_are_not_told() {
    let tool = "plane = { point = [0, 20], normal = [0, -1] }";
    let deck = block("quad8", [0.0, 20.0], [4, 2], tool, -0.1);
    let deck = deck.replace(
        "fix = [{ on = \"b.bottom\", u = [\"x\", \"y\"] }]",
        "move = [{ on = \"b.bottom\", u = { x = 0.03, y = 0.07 } }]",
    );
    tells("rounding", &deck, &[&["never closed"]]);
    // Where all that moves is prescribed next to nothing is out of balance, and reactions are rounding.
    let cube = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "hex8", x = [0, 1], y = [0, 1], z = [0, 1], cells = [2, 2, 2] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "t", plane = { point = [0, 30, 0], normal = [0, -1, 0] } }]
contact = [{ surface = "b.top", against = "t", friction = 0.2 }]
[[step]]
name = "press"
increments = 3
fix = [{ on = "b.right", u = ["y", "z"] }]
move = [{ on = "b.right", u = { x = 0.1 } }]
"#;
    tells("reactions", cube, &[&["never closed"]]);
}

/// A body that is heated freely has next to no energy, and what its first increments left out of balance is more.
#[test]
fn what_early_increments_leave_out_of_balance_is_rounding() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "axisymmetric"
strain = "finite"
mesh.block = [{ name = "b", element = "quad8", x = [0, 1], y = [0, 1], cells = [1, 1] }]
material = [{ on = "b", young = 210e3, poisson = 0.3, expansion = 1.2e-5 }]
[[step]]
name = "heat"
increments = 4
fix = [{ on = "b.bottom", u = ["y"] }]
load = [{ on = "b", temperature = 100 }]
"#;
    tells("heated", deck, &[]);
}

/// A cylinder through 100 mm of air and 0.1 mm into a block in one increment, with friction all the way; with
/// the way in a step of its own the balance closes.
#[test]
fn energies_that_do_not_balance_are_told() {
    let tool = "cylinder = { center = [10, 160], radius = 50 }";
    let deck = block("quad8", [0.0, 20.0], [20, 5], tool, -100.1);
    let deck = deck.replace("increments = 2", "increments = 1");
    let told: [&[&str]; 1] = [&[
        "energies do not balance",
        "N·mm of it from increment 1",
        "smaller increments",
    ]];
    tells("energies", &deck, &told);
    let apart = deck.replace("-100.1", "-100")
        + r#"
[[step]]
name = "press"
increments = 8
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "t", move = [0, -100.1] }]
"#;
    tells("apart", &apart, &[]);
}

/// No file of a run that is done has a number that is none.
#[test]
fn displacements_beyond_all_numbers_are_no_result() {
    let deck = punched()
        .split("[expect]")
        .next()
        .expect("a deck")
        .to_owned();
    for (name, u) in [("huge", "-1e300"), ("less", "-1e100")] {
        let deck = deck.replace("y = -0.2", &format!("y = {u}"));
        let deck = deck.replace("increments = 20", "increments = 2");
        let (status, out, err, results) = run(name, &deck, &[]);
        assert_eq!(status, 2, "{out}{err}");
        for file in ["history.csv", "contact.csv"] {
            let text = fs::read_to_string(results.join(file)).expect("a table");
            assert!(!text.contains("inf") && !text.contains("NaN"), "{text}");
        }
        assert!(
            warnings(&results)[0].contains("but the whole mesh is"),
            "{out}"
        );
    }
}

#[test]
fn penetrations_before_anything_moves_are_told_by_check_and_run() {
    let deck = punched()
        .split("[expect]")
        .next()
        .expect("a deck")
        .to_owned();
    let deck = deck.replace("increments = 20", "increments = 2");
    let deck = deck.replace("point = [0, 0]", "point = [0, 0.05]");
    let (_, _, err, results) = run("penetration", &deck, &[]);
    let words = [
        "inside of the body at \"block.bottom\", by 0.05 mm at node 0 at [0, 0]",
        "21 nodes",
    ];
    for word in words {
        assert!(warnings(&results)[0].contains(word), "{err}");
    }
    let at = directory("check-gaps");
    let check = |name: &str, deck: &str| {
        let file = at.join(name);
        fs::write(&file, deck).expect("a deck");
        let output = moreau(&["check", file.to_str().expect("a path")]);
        (
            output.status.code(),
            text(&output.stdout),
            text(&output.stderr),
        )
    };
    let (status, out, err) = check("inside.toml", &deck);
    assert_eq!(status, Some(0), "{err}");
    assert!(
        out.contains("least gap -0.05 mm, at node 0 at [0, 0]"),
        "{out}"
    );
    assert!(err.contains("1 warning"), "{err}");
    let (_, out, _) = check("apart.toml", &deck.replace("[0, 0.05]", "[0, -0.05]"));
    assert!(out.contains("least gap 0.05 mm"), "{out}");
}

/// Bodies that overlap by more than a facet are not "free to move" but within each other.
#[test]
fn overlapping_bodies_are_told_as_such() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [
  { name = "lo", element = "quad8", x = [0, 20], y = [0, 10], cells = [20, 10] },
  { name = "up", element = "quad8", x = [5, 15], y = [8, 15], cells = [7, 4] },
]
material = [{ on = "lo", young = 210e3, poisson = 0.3 }, { on = "up", young = 210e3, poisson = 0.3 }]
contact = [{ surface = "up.bottom", against = "lo.top", friction = 0.3 }]
[[step]]
name = "s"
increments = 1
fix = [{ on = "lo.bottom", u = ["x", "y"] }]
load = [{ on = "up.top", pressure = 10 }]
"#;
    let (status, _, err, _) = run("overlap", deck, &[]);
    assert_eq!(status, 1);
    let flat = err
        .replace("│", " ")
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    let word = "body \"up\": the bodies at \"up.bottom\" and \"lo.top\" overlap, by 2 mm at node";
    assert!(flat.contains(word), "{flat}");
}

/// Interrupted and resumed, a run has the doubts of the one that was not.
#[test]
fn a_resumed_run_tells_what_happened_before() {
    let tip = "polyline = [[10, 20], [0, 10], [-10, 20]]";
    let deck = block("quad4", [-10.0, 10.0], [21, 4], tip, -0.3)
        + "[[step]]\nname = \"back\"\nincrements = 2\nfix = [{ on = \"b.bottom\", u = [\"x\", \"y\"] }]\ntools = [{ name = \"t\", move = [0, 5] }]\n";
    let deck = deck.replace("vtu = \"none\"", "vtu = \"none\"\ncheckpoint = 1");
    let (_, _, err, results) = run("doubts-resumed", &deck, &["--quiet"]);
    let whole = warnings(&results);
    // Who wants no summary wants to know of these.
    assert!(
        !whole.is_empty() && whole.iter().all(|w| err.contains(w)),
        "{err}"
    );
    assert_eq!(whole.len(), 2, "{whole:?}");
    // From the checkpoint before the last increment: the tip is out again.
    let checkpoints = fs::read_dir(results.join("checkpoint")).expect("checkpoints");
    let mut paths: Vec<_> = checkpoints.map(|e| e.expect("an entry").path()).collect();
    paths.sort();
    fs::remove_file(paths.pop().expect("a checkpoint")).expect("removed");
    let output = moreau(&["resume", results.to_str().expect("a path"), "--quiet"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(warnings(&results), whole);
}

/// What is ordinary is not doubted.
#[test]
fn ordinary_runs_are_not_doubted() {
    let mut decks = Vec::new();
    for name in [
        "block-opening-sliding-sticking",
        "block-pulled-across-grain",
        "cylinder-pressed-into-block",
        "punched-block",
    ] {
        let path = examples().join(format!("{name}.toml"));
        decks.push((
            name.to_owned(),
            fs::read_to_string(path).expect("an example"),
        ));
    }
    for (name, deck) in decks {
        let (status, out, err, results) = run(&format!("ordinary-{name}"), &deck, &["--quiet"]);
        assert_eq!(
            (status, warnings(&results)),
            (0, vec![]),
            "{name}: {out}{err}"
        );
    }
}

/// Asserts that exactly one warning of a run that ends well has these words.
#[track_caller]
fn tells_once(name: &str, deck: &str, words: &[&str]) {
    let (status, out, err, results) = run(name, deck, &[]);
    assert_eq!(status, 0, "{out}{err}");
    let warnings = warnings(&results);
    let told = |w: &&String| words.iter().all(|word| w.contains(word));
    assert_eq!(warnings.iter().filter(told).count(), 1, "{warnings:#?}");
}

/// A rule that leaves deformations without strain is told.
#[test]
fn hourglasses_are_told() {
    let tool = "plane = { point = [0, 10], normal = [0, -1] }";
    let told = |element: &str, rule: &str| {
        let deck = block(element, [0.0, 10.0], [4, 2], tool, -0.01);
        let deck = deck.replace("poisson", &format!("quadrature = \"{rule}\", poisson"));
        let (.., results) = run(&format!("hourglass-{element}-{rule}"), &deck, &[]);
        let words = format!("{element} with reduced quadrature deforms without strain");
        warnings(&results).iter().any(|w| w.contains(&words))
    };
    assert!(told("quad4", "reduced") && told("quad9", "reduced"));
    assert!(!told("quad8", "reduced") && !told("quad4", "b-bar"));
}

/// A floor that is 0.1 mm inside of a block whose bottom does not move: the gap has its sign in all files.
#[test]
fn nodes_that_are_held_inside_of_a_tool_are_told() {
    let tool = "plane = { point = [0, 0.1], normal = [0, 1] }";
    let deck = block("quad8", [0.0, 10.0], [4, 2], tool, 0.0).replace("b.top\",", "b.bottom\",");
    let words = [
        "9 nodes of \"b.bottom\" are held inside of \"t\"",
        "by 0.1 mm",
    ];
    tells_once("held", &deck, &words);
    let (_, out, _, results) = run("held", &deck, &[]);
    assert!(out.contains("penetration 1.0e-1 mm"), "{out}");
    let contacts = fs::read_to_string(results.join("contact.csv")).expect("a table");
    assert_eq!(
        contacts.lines().filter(|l| l.contains(",-0.1")).count(),
        18,
        "{contacts}"
    );
}

#[test]
fn a_node_at_a_sharp_corner_of_a_tool_is_told() {
    let tip = "polyline = [[10, 20], [0, 10], [-10, 20]]";
    let deck = block("quad8", [-10.0, 10.0], [8, 4], tip, -0.005);
    let words = [
        "at a sharp corner of \"t\"",
        "[0, 10]",
        "give the corner a radius",
    ];
    tells_once("corner", &deck, &words);
}

/// A block of which every node slips, half to each side.
#[test]
fn a_position_that_nothing_decides_is_told() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad4", x = { lines = [0, 1, 3, 4] }, y = [0, 3], cells = [0, 3] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3, quadrature = "full" }]
tool = [{ name = "g", plane = { point = [0, 0], normal = [0, 1] } }]
contact = [{ surface = "b.bottom", against = "g", friction = 0.05 }]
[[step]]
name = "press"
increments = 2
load = [{ on = "b.top", pressure = 3.0 }]
"#;
    tells_once(
        "free",
        deck,
        &["1 rigid motions are free", "translation along x"],
    );
}

/// The sign of an interference is easily mistaken: what leaves room instead is told.
#[test]
fn an_offset_that_leaves_room_is_told_where_nothing_touches() {
    let tool = "plane = { point = [0, 10], normal = [0, -1] }";
    let deck = block("quad8", [0.0, 10.0], [4, 2], tool, -0.01);
    let fit = deck.replace("friction = 0.2", "friction = 0.2, gap-offset = -0.02");
    let words = [
        "\"b.top\" with \"t\" never closed",
        "gap-offset is negative",
    ];
    tells_once("apart", &fit, &words);
}
