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
        let results = directory(&name);
        let (from, to) = (path.to_string_lossy(), results.to_string_lossy());
        let output = moreau(&["run", &from, "--out", &to, "--verify"]);
        let (out, err) = (text(&output.stdout), text(&output.stderr));
        let status = output.status.code().expect("a status");
        assert_eq!(status, 0, "{}\n{out}{err}", path.display());
        assert!(out.contains("met") && !out.contains("FAILED"), "{out}");
        // Pictures are of the plane.
        let plane = !deck.contains("analysis = \"solid\"");
        let touches = deck.contains("[[contact]]");
        let files = [
            "history.csv",
            "contact.csv",
            "run.json",
            "deck.resolved.toml",
            "result.pvd",
            "history.svg",
            "report.html",
            "log.jsonl",
        ];
        for file in files {
            assert!(results.join(file).exists(), "{name}: {file}");
        }
        for (file, drawn) in [("contact.svg", plane && touches), ("deformed.svg", plane)] {
            assert_eq!(results.join(file).exists(), drawn, "{name}: {file}");
        }
        let check = moreau(&["check", path.to_str().expect("a path")]);
        assert_eq!(check.status.code(), Some(0), "{}", text(&check.stderr));
        count += 1;
    }
    assert!(count >= 6);
}

/// A column of history.csv, by the name before its unit.
fn column(results: &Path, name: &str) -> Vec<f64> {
    let history = fs::read_to_string(results.join("history.csv")).expect("a history");
    let mut lines = history.lines();
    let header = lines.next().expect("a header");
    let at = header
        .split(',')
        .position(|h| h.split(' ').next() == Some(name));
    let at = at.unwrap_or_else(|| panic!("{name} in {header}"));
    let value = |line: &str| line.split(',').nth(at).and_then(|v| v.parse().ok());
    lines.map(|l| value(l).expect("a number")).collect()
}

fn last(results: &Path, name: &str) -> f64 {
    column(results, name).pop().expect("a row")
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

/// Springs by the penetration that is wanted: no node goes deeper, and the load is nearly exact.
#[test]
fn a_penetration_is_kept() {
    let solver = "[solver]\ncontact = { penetration = 1e-3 }\n[expect]";
    let deck = punched().replace("[expect]", solver);
    let (status, _, err, results) = run("penetration", &deck, &[]);
    assert_eq!(status, 0, "{err}");
    let contact = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    let gap = |line: &str| line.split(',').nth(8)?.parse::<f64>().ok();
    let depth = contact
        .lines()
        .skip(1)
        .map(|l| -gap(l).expect("a gap"))
        .fold(0.0, f64::max);
    // Cells of 5 mm.
    assert!(depth > 1e-4 * 5.0 && depth <= 1e-3 * 5.0, "{depth}");
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
    assert!(
        json["diagnosis"]["suggestion"]
            .as_str()
            .is_some_and(|s| !s.is_empty())
    );

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

/// A cylinder of soil between smooth plates carries 2 c cos φ/(1 − sin φ), associated or not, and says
/// what it is made of.
#[test]
fn a_soil_has_its_strength_in_compression() {
    let (sine, cosine) = 30f64.to_radians().sin_cos();
    let force = -2.0 * 0.02 * cosine / (1.0 - sine) * 4.0 * std::f64::consts::PI;
    for dilatancy in [30, 15] {
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

/// Two steps, the second without the punch: plastic flow, friction, release.
fn pressed_and_released(increments: usize) -> String {
    let deck = punched().replace("increments = 20", &format!("increments = {increments}"));
    let head = deck.split("[expect]").next().expect("a deck").to_owned();
    head + "[[step]]\nname = \"release\"\nincrements = 4\n\
            fix = [{ on = \"block.left\", u = [\"x\"] }]\n[output]\ncheckpoint = 3\n"
}

fn copy(from: &Path, to: &Path) {
    // Nothing may be there yet.
    let _ = fs::remove_dir_all(to);
    fs::create_dir_all(to.join("checkpoint")).expect("a directory");
    for directory in [PathBuf::new(), "checkpoint".into()] {
        for entry in fs::read_dir(from.join(&directory)).expect("a directory") {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                let name = path.file_name().expect("a name");
                fs::copy(&path, to.join(&directory).join(name)).expect("a copy");
            }
        }
    }
}

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).expect("a directory");
    let name = |e: fs::DirEntry| e.file_name().to_string_lossy().into_owned();
    let mut names: Vec<String> = entries.map(|e| name(e.expect("an entry"))).collect();
    names.sort();
    names
}

/// All files of two directories are equal to the byte, but for times.
fn equal_but_for_times(a: &Path, b: &Path) {
    assert_eq!(names(a), names(b));
    for name in names(a) {
        let read = |d: &Path| fs::read(d.join(&name)).unwrap_or_default();
        let timeless = |text: &str| {
            let mut v: serde_json::Value = serde_json::from_str(text).expect("json");
            for key in ["seconds", "peak_memory_mb", "threads"] {
                v[key] = 0.into();
            }
            v
        };
        match name.as_str() {
            "checkpoint" | "report.html" => {}
            "log.jsonl" => {
                let lines = |d: &Path| text(&read(d)).lines().map(timeless).collect::<Vec<_>>();
                assert_eq!(lines(a), lines(b));
            }
            "run.json" => assert_eq!(timeless(&text(&read(a))), timeless(&text(&read(b)))),
            _ => assert!(read(a) == read(b), "{name} differs"),
        }
    }
}

fn resume(at: &Path, more: &[&str]) -> (i32, String) {
    let mut arguments = vec!["resume", at.to_str().expect("a path"), "--quiet"];
    arguments.extend(more);
    let output = moreau(&arguments);
    (
        output.status.code().expect("a status"),
        text(&output.stderr),
    )
}

/// From the last checkpoint, or from the one before a torn one, a run ends to the bit as if it had
/// never stopped.
#[test]
fn a_resumed_run_is_the_uninterrupted_one() {
    let (status, _, err, whole) = run("whole", &pressed_and_released(10), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let kept = names(&whole.join("checkpoint"));
    assert_eq!(kept, ["increment-000009.ckpt", "increment-000012.ckpt"]);

    // What a crash leaves: rows and files beyond the checkpoint, the last of them cut off.
    let crashed = whole.with_file_name("crashed");
    copy(&whole, &crashed);
    fs::remove_file(crashed.join("run.json")).expect("was there");
    let history = fs::read(crashed.join("history.csv")).expect("a history");
    fs::write(crashed.join("history.csv"), &history[..history.len() - 17]).expect("shorter");
    assert_eq!(resume(&crashed, &[]), (0, String::new()));
    equal_but_for_times(&whole, &crashed);

    // The newest checkpoint torn, or altered: the one before it, in the step before.
    for length in [1000, usize::MAX] {
        copy(&whole, &crashed);
        let newest = crashed.join("checkpoint").join(&kept[1]);
        let mut bytes = fs::read(&newest).expect("a checkpoint");
        bytes.truncate(length);
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&newest, bytes).expect("written");
        assert_eq!(resume(&crashed, &["--threads", "1"]), (0, String::new()));
        equal_but_for_times(&whole, &crashed);
    }

    // None whole, or of another deck: told.
    for name in &kept {
        let path = crashed.join("checkpoint").join(name);
        fs::write(path, b"moreau checkpoint 1\n").expect("written");
    }
    let (status, err) = resume(&crashed, &[]);
    assert!(status == 1 && err.contains("torn"), "{status} {err}");
    copy(&whole, &crashed);
    let deck = fs::read_to_string(crashed.join("deck.resolved.toml")).expect("a deck");
    let other = deck.replace("poisson = 0.3", "poisson = 0.29");
    fs::write(crashed.join("deck.resolved.toml"), other).expect("written");
    let (status, err) = resume(&crashed, &[]);
    assert!(
        status == 1 && err.contains("another deck"),
        "{status} {err}"
    );
    assert_eq!(resume(&directory("empty"), &[]).0, 1);
}

/// Killed at some moment, or asked to stop: it goes on from the last checkpoint.
#[cfg(unix)]
#[test]
fn a_run_that_is_killed_or_interrupted_goes_on() {
    let (status, _, err, whole) = run("long", &pressed_and_released(30), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let file = whole.with_file_name("deck.toml");
    for signal in ["-KILL", "-INT"] {
        let out = whole.with_file_name(&signal[1..]);
        let mut child = Command::new(env!("CARGO_BIN_EXE_moreau"))
            .args(["run", file.to_str().expect("a path"), "--quiet", "--out"])
            .arg(&out)
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("it starts");
        let rows = || {
            let history = fs::read_to_string(out.join("history.csv"));
            history.map_or(0, |h| h.lines().count())
        };
        while rows() < 10 && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let number = child.id().to_string();
        let _ = Command::new("kill")
            .args([signal, number.as_str()])
            .status();
        let ended = child.wait_with_output().expect("it ends");
        if signal == "-INT" && ended.status.code() == Some(2) {
            let told = text(&ended.stderr);
            assert!(told.contains("moreau resume"), "{told}");
            let json = fs::read_to_string(out.join("run.json")).expect("a summary");
            assert!(json.contains("\"interrupted\""), "{json}");
        }
        assert_eq!(resume(&out, &[]), (0, String::new()));
        equal_but_for_times(&whole, &out);
    }
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

/// From files alone: the same pictures, others on demand, and a report that needs no network.
#[test]
fn a_run_is_drawn_again_from_its_files() {
    let (status, _, err, results) = run("draw", &punched(), &["--quiet"]);
    assert_eq!(status, 0, "{err}");
    let usual = || {
        ["history.svg", "contact.svg", "deformed.svg", "report.html"]
            .map(|f| fs::read(results.join(f)).expect("a picture"))
    };
    let before = usual();
    let at = results.to_str().expect("a path");
    assert_eq!(moreau(&["plot", at]).status.code(), Some(0));
    assert!(before == usual());
    let one = "--field displacement.y --increment 7 --scale 3";
    let one: Vec<&str> = ["plot", at].into_iter().chain(one.split(' ')).collect();
    let output = moreau(&one);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let svg = fs::read_to_string(results.join("deformed-displacement.y-7.svg"));
    assert!(svg.expect("a picture").contains("displacement.y [mm]"));
    assert!(results.join("contact-7.svg").exists());
    let output = moreau(&["plot", at, "--png"]);
    if cfg!(feature = "png") {
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        for name in ["history.png", "contact.png", "deformed.png"] {
            let png = fs::read(results.join(name)).expect("a picture");
            assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n", "{name}");
        }
    } else {
        assert_eq!(output.status.code(), Some(1));
        let told = text(&output.stderr);
        assert!(told.contains("feature `png`") && told.contains("--features png"));
    }
    for (key, value, named) in [
        ("--field", "pres", "von_mises"),
        ("--increment", "21", "1 to 20"),
    ] {
        let output = moreau(&["plot", at, key, value]);
        assert_eq!(output.status.code(), Some(1));
        let told = text(&output.stderr);
        assert!(told.contains(value) && told.contains(named), "{told}");
    }

    let page = text(&before[3]);
    let outside = page.replace("http://www.w3.org/2000/svg", "");
    assert!(!outside.contains("http") && !outside.contains("src="));
    let data = page.split("id=\"data\">").nth(1);
    let data = data.and_then(|d| d.split("</script>").next());
    let data: serde_json::Value = serde_json::from_str(data.expect("data")).expect("json");
    assert_eq!(data["frames"].as_array().map(Vec::len), Some(20));
    assert_eq!(data["faces"].as_array().map(Vec::len), Some(20));
    let punch = data["frames"][19]["values"]["displacement.y"]["low"].as_f64();
    assert!((punch.expect("a number") + 0.2).abs() < 1e-12);
    // The contact line of every frame: pressures and shears of the floor at 21 points.
    let contact = &data["contact"];
    assert_eq!(contact["frames"].as_array().map(Vec::len), Some(20));
    assert_eq!(contact["surfaces"][0]["name"], "block.bottom");
    let most = |frame: usize| contact["frames"][frame][0][0]["high"].as_f64();
    let rows = fs::read_to_string(results.join("contact.csv")).expect("contacts");
    for frame in [0, 19] {
        let field = |line: &str, k: usize| line.split(',').nth(k).map(str::to_owned);
        let own = (frame + 1).to_string();
        let found = rows.lines().filter(|l| field(l, 1) == Some(own.clone()));
        let pressures = found.filter_map(|l| field(l, 14)?.parse::<f64>().ok());
        let found = pressures.reduce(f64::max).expect("a pressure");
        let shown = most(frame).expect("a number");
        assert!((shown / found - 1.0).abs() < 1e-12, "{shown} {found}");
    }
    assert!(page.contains("Certificate of every increment") && page.contains("force.punch.y"));
    assert!(page.contains("[[mesh.block]]"));
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
