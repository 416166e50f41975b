//! One problem said or solved in several ways: the same answer, or nearly so where a way is not exact.

use super::{column, directory, last, moreau, punched, run, text};
use std::fs;
use std::path::Path;

/// A floor given as a polyline, one that touches at a distance, and one that is a little too low
/// are the same floor.
#[test]
fn floors_that_are_the_same() {
    let plane = "plane = { point = [0, 0], normal = [0, 1] }";
    for (name, from, to) in [
        (
            "polyline",
            plane.to_owned(),
            "polyline = [[-9, 0], [20, 0], [99, 0]]".to_owned(),
        ),
        (
            "offset",
            format!("{plane}\n\n[[contact]]"),
            "plane = { point = [0, -0.5], normal = [0, 2] }\n\n[[contact]]\ngap-offset = 0.5"
                .into(),
        ),
        (
            "adjust",
            format!("{plane}\n\n[[contact]]"),
            "plane = { point = [0, -0.01], normal = [0, 1] }\n\n[[contact]]\nadjust = 0.02".into(),
        ),
        (
            // A twentieth of a cell of 5 mm.
            "near",
            format!("{plane}\n\n[[contact]]"),
            "plane = { point = [0, 0.2], normal = [0, 1] }\n\n[[contact]]\nadjust = true".into(),
        ),
    ] {
        let deck = punched().replace(&from, &to);
        assert_ne!(deck, punched());
        let (status, out, err, results) = run(&format!("floor-{name}"), &deck, &["--verify"]);
        assert_eq!(status, 0, "{name}: {out}{err}");
        let force = last(&results, "force.punch.y");
        assert!((force + 10519.53783).abs() < 1e-3, "{name}: {force}");
    }
}

/// A cylinder in space on a slice that cannot strain along it is a circle in plane strain.
#[test]
fn a_cylinder_in_space_is_a_circle_in_the_plane() {
    let deck = |analysis: &str, element: &str, z: [&str; 4], tool: &str, up: &str| {
        format!(
            r#"
units = "mm-N-MPa"
analysis = "{analysis}"
mesh.block = [{{ name = "b", element = "{element}", x = [0, 4], y = [0, 3], {} cells = [8, 6{}] }}]
material = [{{ on = "b", young = 1000.0, poisson = 0.3 }}]
tool = [{{ name = "roll", cylinder = {{ {tool}, radius = 10 }} }}]
contact = [{{ surface = "b.top", against = "roll", friction = 0.3 }}]
[[step]]
name = "press"
increments = 2
fix = [
  {{ on = "b.bottom", u = ["y"] }},
  {{ on = "b.left", u = ["x"] }},
  {}
]
tools = [{{ name = "roll", move = {up} }}]
"#,
            z[0], z[1], z[2]
        )
    };
    let flat = deck(
        "plane-strain",
        "quad4",
        ["", "", "", ""],
        "center = [0, 13]",
        "[0, -0.2]",
    );
    let solid = deck(
        "solid",
        "hex8",
        ["z = [0, 1],", ", 1", "{ on = \"b\", u = [\"z\"] },", ""],
        "center = [0, 13, 7], axis = [0, 0, -3]",
        "[0, -0.2, 0]",
    );
    let (a, _, err, flat) = run("circle", &flat, &[]);
    assert_eq!(a, 0, "{err}");
    let (b, _, err, solid) = run("roll", &solid, &[]);
    assert_eq!(b, 0, "{err}");
    let forces = (last(&flat, "force.roll.y"), last(&solid, "force.roll.y"));
    assert!(
        forces.0 < -1.0 && (forces.1 / forces.0 - 1.0).abs() < 1e-8,
        "{forces:?}"
    );
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
    let body = fs::read_to_string(results.join("deformed.svg")).expect("a picture");
    assert!(body.contains(" m</text>") && !body.contains("mm"), "{body}");
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

#[test]
fn algorithms_are_compared() {
    let deck = punched()
        .replace("increments = 20", "increments = 1")
        .replace("y = -0.2", "y = -0.01");
    let deck = deck.split("[expect]").next().expect("a deck");
    let at = directory("bench");
    let file = at.join("deck.toml");
    fs::write(&file, deck).expect("a deck");
    let (file, out) = (file.to_str().expect("a path"), at.join("out"));
    let output = moreau(&["bench", file, "--out", out.to_str().expect("a path")]);
    let (told, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{told}{err}");
    let punch = told.split("force.punch.y").nth(1).expect("a force");
    let mut lines = punch.lines().skip(1);
    for name in ["exact", "gauss-seidel", "uzawa", "penalty", "uzawa outside"] {
        let line = lines.next().expect("a line").trim();
        assert!(line.starts_with(name), "{line}");
        let off = line.split_whitespace().last().expect("a number");
        let off: f64 = off.parse().expect("a number");
        // The springs of the penalty give way; what is exact agrees.
        let most = if name == "penalty" { 1e-2 } else { 1e-8 };
        assert!(off.abs() < most, "{told}");
    }
}

/// Where nothing presses there is no table of forces to head.
#[test]
fn algorithms_without_forces_say_so() {
    let deck = punched()
        .replace("increments = 20", "increments = 1")
        .replace("y = -0.2", "y = 0.0");
    let deck = deck.split("[expect]").next().expect("a deck");
    let at = directory("bench-free");
    let file = at.join("deck.toml");
    fs::write(&file, deck).expect("a deck");
    let (file, out) = (file.to_str().expect("a path"), at.join("out"));
    let output = moreau(&["bench", file, "--out", out.to_str().expect("a path")]);
    let told = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{told}");
    assert!(
        told.contains("\nno forces at the end\n") && !told.contains("forces at the end ["),
        "{told}"
    );
}

/// A limit load is what a deck to collapse is for, and known to what is left to be gained on its plateau; the displacements of its
/// mechanism tend to nothing. The cylinder carries 2/√3 σ_y ln(b/a).
#[test]
fn a_limit_load_converges_and_its_mechanism_is_left_out() {
    let deck = r#"units = "mm-N-MPa"
analysis = "axisymmetric"
mesh.block = [{ name = "b", element = "quad8", x = [100, 200], y = [0, 20], cells = [6, 1] }]
material = [{ on = "b", young = 210e3, poisson = 0.3, yield-stress = 240.0 }]
[[step]]
name = "press"
increments = 5
until = "collapse"
fix = [{ on = "b", u = ["y"] }]
load = [{ on = "b.left", pressure = 300.0 }]
"#;
    let file = directory("limit").join("deck.toml");
    fs::write(&file, deck).expect("a deck");
    let output = moreau(&["converge", file.to_str().expect("a path")]);
    let told = text(&output.stdout);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{told}{}",
        text(&output.stderr)
    );
    let tables: Vec<&str> = told.split("\n\n").skip(1).collect();
    let headings = tables.iter().filter_map(|table| table.lines().next());
    let headings: Vec<&str> = headings.collect();
    assert_eq!(headings[0], "load factor of step \"press\"", "{told}");
    assert!(
        headings.contains(&"force.b.y") && !told.contains("\nu."),
        "{told}"
    );
    assert!(!tables[0].contains("not seen"), "{told}");
    let exact = 240.0 * 2.0 / 3f64.sqrt() * 2f64.ln() / 300.0;
    for of in ["cells", "increments"] {
        let row = tables[0]
            .lines()
            .find(|line| line.trim_start().starts_with(of));
        let values = row.expect("a row").split_whitespace().skip(1).take(3);
        for value in values.map(|value| value.parse::<f64>().expect("a number")) {
            assert!((value / exact - 1.0).abs() < 1e-5, "{told}");
        }
    }
}

/// Springs by the penetration that is wanted: no node goes deeper, and the load is nearly exact.
#[test]
fn a_penetration_is_kept() {
    let solver = "[solver]\ncontact = { penetration = 1e-3 }\n[expect]";
    let deck = punched().replace("[expect]", solver);
    let (status, _, err, results) = run("penetration", &deck, &[]);
    assert_eq!(status, 0, "{err}");
    let contact = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    let gap = |line: &str| line.split(',').nth(9)?.parse::<f64>().ok();
    let depth = contact
        .lines()
        .skip(1)
        .map(|l| -gap(l).expect("a gap"))
        .fold(0.0, f64::max);
    // Cells of 5 mm.
    assert!(depth > 1e-4 * 5.0 && depth <= 1e-3 * 5.0, "{depth}");
    // The certificate tells the same.
    let told = column(&results, "penetration");
    let told = told.into_iter().fold(0.0, f64::max);
    assert!((told - depth).abs() <= 1e-12, "{told} {depth}");
    let force = last(&results, "force.punch.y");
    assert!((force / -10519.53783 - 1.0).abs() < 1e-2, "{force}");
}

/// Automatic increments grow, end at the end, and give nearly the same load.
#[test]
fn automatic_increments_grow() {
    let automatic = "increments = { start = 0.02, min = 1e-4, max = 0.2 }";
    let deck = punched().replace("increments = 20", automatic);
    let (status, _, err, results) = run("automatic", &deck, &[]);
    assert_eq!(status, 0, "{err}");
    let time = column(&results, "time");
    let lengths: Vec<f64> = time.windows(2).map(|t| t[1] - t[0]).collect();
    assert!(
        time.len() < 20 && time[0] == 0.02 && time[time.len() - 1] == 1.0,
        "{time:?}"
    );
    assert!(
        lengths.iter().all(|l| *l > 0.0 && *l <= 0.2 + 1e-12),
        "{lengths:?}"
    );
    assert!(lengths.iter().any(|l| *l > 0.15), "{lengths:?}");
    let force = last(&results, "force.punch.y");
    assert!((force / -10519.53783 - 1.0).abs() < 2e-3, "{force}");
}
