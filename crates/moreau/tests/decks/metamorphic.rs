//! The same problem said differently has the same answer: in other units, mirrored, shifted, with
//! its nodes numbered otherwise, on one thread, with a pause. No answer needs to be known.

use super::{folder, temporary};
use moreau::deck::{Problem, open_in};
use moreau::driver::StepReport;
use moreau::mesh::{Mesh, block2, uniform, write_gmsh};
use moreau::run::{Event, Watch, resume, run};
use std::fs;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// The examples in the plane, with two increments a step and loads in proportion.
fn examples() -> Vec<(String, Table)> {
    let mut all = Vec::new();
    for entry in fs::read_dir(folder("docs/examples")).expect("examples") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let name = path.file_stem().expect("a name").to_string_lossy();
        let text = fs::read_to_string(&path).expect("a deck");
        let mut deck: Table = text.parse().expect("toml");
        if deck["analysis"].as_str() == Some("solid") {
            continue;
        }
        deck.remove("expect");
        let mut part = 1.0f64;
        for step in steps(&mut deck) {
            let increments = step["increments"].as_integer().expect("a number") as f64;
            part = part.min(2.0 / increments);
            step.insert("increments".into(), 2.into());
        }
        let scale = |key: &str, v: f64| if loads(key) { part * v } else { v };
        for step in steps(&mut deck) {
            numbers(step, &scale);
        }
        let output = "directory = \"out\"\nvtu = \"none\"\ncheckpoint = 1";
        let output: Table = output.parse().expect("toml");
        deck.insert("output".into(), output.into());
        all.push((name.into_owned(), deck));
    }
    assert!(all.len() >= 7);
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn steps(deck: &mut Table) -> impl Iterator<Item = &mut Table> {
    let steps = deck["step"].as_array_mut().expect("steps").iter_mut();
    steps.map(|s| s.as_table_mut().expect("a step"))
}

fn loads(key: &str) -> bool {
    let is = |name: &str| key.split('.').any(|k| k == name);
    ["move", "load"].map(is).contains(&true) || (is("tools") && is("move"))
}

/// Changes all numbers of a table but counts, each told by the keys on the way to it.
fn numbers(table: &mut Table, change: &impl Fn(&str, f64) -> f64) {
    fn walk(value: &mut Value, keys: &str, change: &impl Fn(&str, f64) -> f64) {
        match value {
            Value::Integer(v) => *value = Value::Float(change(keys, *v as f64)),
            Value::Float(v) => *v = change(keys, *v),
            Value::Array(items) => {
                for (k, item) in items.iter_mut().enumerate() {
                    walk(item, &format!("{keys}.{k}"), change);
                }
            }
            Value::Table(table) => inside(table, &format!("{keys}."), change),
            _ => {}
        }
    }
    fn inside(table: &mut Table, keys: &str, change: &impl Fn(&str, f64) -> f64) {
        for (key, value) in table.iter_mut() {
            if !["cells", "increments", "checkpoint"].contains(&key.as_str()) {
                walk(value, &format!("{keys}{key}"), change);
            }
        }
    }
    inside(table, "", change);
}

/// A history: names, units and rows.
struct History {
    names: Vec<String>,
    units: Vec<String>,
    rows: Vec<Vec<f64>>,
    text: String,
}

/// Stops after an increment.
struct Pause(usize);

impl Watch for Pause {
    fn converged(&mut self, event: &Event<'_>) {
        let report: &StepReport = event.report;
        self.0 = self.0.saturating_sub(report.increment);
    }

    fn stops(&self) -> bool {
        self.0 == 0
    }
}

/// Runs a deck into a directory, after a pause if that is asked for.
fn history(deck: &Table, beside: &Path, name: &str, pause: bool) -> History {
    let at = temporary(&format!("metamorphic/{name}"));
    let text = deck.to_string();
    let mut watch = Pause(if pause { 1 } else { usize::MAX });
    for go_on in [false, true] {
        let (deck, problem, findings) = open_in(&text, beside);
        let shown = || findings.render(name, &text, false);
        match (problem.unwrap_or_else(|| panic!("{}", shown())), go_on) {
            (Problem::Plane(setup), false) => run(*setup, &deck, &at, &mut watch),
            (Problem::Plane(setup), true) => resume(*setup, &deck, &at, &mut ()),
            (Problem::Solid(setup), false) => run(*setup, &deck, &at, &mut watch),
            (Problem::Solid(setup), true) => resume(*setup, &deck, &at, &mut ()),
        }
        .expect("a run");
        if !pause {
            break;
        }
    }
    let text = fs::read_to_string(at.join("history.csv")).expect("a history");
    let mut lines = text.lines();
    let header = lines.next().expect("a header").split(',');
    let (names, units) = header
        .map(|h| h.split_once(" [").unwrap_or((h, "")))
        .map(|(name, unit)| (name.to_owned(), unit.trim_end_matches(']').to_owned()))
        .unzip();
    let row = |line: &str| {
        line.split(',')
            .map(|v| v.parse().expect("a number"))
            .collect()
    };
    let rows = lines.map(row).collect();
    History {
        names,
        units,
        rows,
        text: text.clone(),
    }
}

/// Columns that are nothing but rounding.
const ROUNDING: [&str; 4] = [
    "bipotential_gap",
    "penetration",
    "excess_force",
    "out_of_balance",
];
/// Compares histories, the second times a factor for each of its columns. Efforts are compared as
/// well: no number of iterations may hang on rounding.
fn same(a: &History, b: &History, what: &str, factor: impl Fn(&str, &str) -> f64) {
    assert_eq!(a.names, b.names, "{what}");
    assert_eq!(a.rows.len(), b.rows.len(), "{what}");
    // A force that is zero by symmetry is zero in parts of the largest force, and so on; where all
    // forces are, in parts of work over displacement.
    let largest = |unit: &str| {
        let of = |k: &usize| a.units[*k] == unit;
        let columns = (0..a.names.len()).filter(of);
        let all = columns.flat_map(|k| a.rows.iter().map(move |r| r[k].abs()));
        all.fold(0.0, f64::max)
    };
    let scale = |unit: &str| match unit {
        "N" => largest("N").max(largest("N·mm") / largest("mm")),
        unit => largest(unit),
    };
    for (k, name) in a.names.iter().enumerate() {
        let unit = &a.units[k];
        if ROUNDING.contains(&name.as_str()) {
            continue;
        }
        let most = match name.as_str() {
            "plastic_fraction" => 1e-9,
            _ if unit.is_empty() => 0.0,
            _ => 1e-9 * scale(unit),
        };
        for (x, y) in a.rows.iter().zip(&b.rows) {
            let y = y[k] * factor(name, &b.units[k]);
            assert!((x[k] - y).abs() <= most, "{what}, {name}: {} and {y}", x[k]);
        }
    }
}

/// Factors of lengths and stresses from a deck in mm, N and MPa: to other units, and to bodies much
/// smaller, larger and softer.
const UNITS: [(&str, f64, f64); 4] = [
    ("m-N-Pa", 1e-3, 1e6),
    // An inch is 25.4 mm, a pound-force 4.4482216152605 N.
    ("in-lbf-psi", 1.0 / 25.4, 25.4 * 25.4 / 4.448_221_615_260_5),
    ("mm-N-MPa", 1e3, 1.0),
    ("mm-N-MPa", 1.0, 1e-6),
];

/// Factors that only add to the exponents of all numbers, and to those of their roots.
const EXACT: [(&str, f64, f64); 2] = [
    ("mm-N-MPa", 1.0 / 4096.0, 16_777_216.0),
    ("mm-N-MPa", 4096.0, 1.0 / 16_777_216.0),
];

/// The power of lengths and stresses that a number of a deck is, by the keys on the way to it.
fn powers(keys: &str) -> (i32, i32) {
    let is = |names: &[&str]| keys.split('.').any(|k| names.contains(&k));
    match keys {
        _ if is(&["normal", "axis", "friction", "poisson"]) => (0, 0),
        _ if is(&["young", "yield-stress", "hardening", "pressure", "traction"]) => (0, 1),
        _ if is(&["body-force"]) => (-1, 1),
        _ if is(&["force"]) => (2, 1),
        _ if is(&[
            "x",
            "y",
            "z",
            "point",
            "center",
            "radius",
            "polyline",
            "move",
            "u",
            "thickness",
        ]) =>
        {
            (1, 0)
        }
        other => panic!("what is {other} measured in?"),
    }
}

/// A history to be multiplied by these factors of its columns, of a deck in other units.
fn in_units(
    name: &str,
    deck: &Table,
    (units, length, stress): (&str, f64, f64),
) -> (History, impl Fn(&str, &str) -> f64) {
    let mut deck = deck.clone();
    deck.insert("units".into(), units.into());
    let change = |keys: &str, v: f64| {
        let (l, s) = powers(keys);
        v * length.powi(l) * stress.powi(s)
    };
    numbers(&mut deck, &change);
    let name = format!("{name}-{units}");
    let found = history(&deck, &folder("docs/examples"), &name, false);
    let factor = move |_: &str, unit: &str| match unit {
        "mm" | "m" | "in" => 1.0 / length,
        "N" | "lbf" => 1.0 / (stress * length * length),
        "N·mm" | "N·m" | "in·lbf" | "lbf·in" => 1.0 / (stress * length.powi(3)),
        "" => 1.0,
        other => panic!("the unit {other}"),
    };
    (found, factor)
}

#[test]
fn units_change_nothing() {
    for (name, mut deck) in examples() {
        if deck["mesh"].get("file").is_some() {
            continue; // Its coordinates are those of the file.
        }
        if deck["analysis"].as_str() == Some("plane-strain") {
            deck.insert("thickness".into(), 1.0.into());
        }
        let base = history(
            &deck,
            &folder("docs/examples"),
            &format!("{name}-mm"),
            false,
        );
        for units in UNITS {
            let (found, factor) = in_units(&name, &deck, units);
            same(&base, &found, &format!("{name} in {units:?}"), factor);
        }
        // Where no number rounds otherwise nothing differs, unless something is measured in itself.
        for units in EXACT {
            let (found, factor) = in_units(&name, &deck, units);
            for (a, b) in base.rows.iter().zip(&found.rows) {
                for (k, column) in base.names.iter().enumerate() {
                    let b = b[k] * factor(column, &found.units[k]);
                    assert!(
                        a[k] == b,
                        "{name} times {units:?}, {column}: {} and {b}",
                        a[k]
                    );
                }
            }
        }
    }
}

/// A deck whose mesh is a file with the nodes of another mesh moved and numbered anew.
fn moved(
    name: &str,
    deck: &Table,
    number: impl Fn(usize, usize) -> usize,
    place: impl Fn([f64; 2]) -> [f64; 2],
) -> (Table, PathBuf) {
    let (_, problem, _) = open_in(&deck.to_string(), &folder("docs/examples"));
    let Some(Problem::Plane(setup)) = problem else {
        panic!("a plane problem: {name}")
    };
    let old = setup.driver.mesh();
    let count = old.nodes().len();
    let mut nodes = vec![[0.0; 2]; count];
    for (n, &x) in old.nodes().iter().enumerate() {
        nodes[number(n, count)] = place(x);
    }
    let at = temporary("metamorphic");
    fs::create_dir_all(&at).expect("a folder");
    let file = at.join(format!("{name}.msh"));
    fs::write(&file, text_of(old, &nodes, |n| number(n, count))).expect("a mesh");
    let mut deck = deck.clone();
    let mut mesh = Table::new();
    mesh.insert("file".into(), format!("{name}.msh").into());
    deck.insert("mesh".into(), mesh.into());
    (deck, at)
}

/// A mesh with other nodes as text of Gmsh: cells that are turned over are turned by the reader.
fn text_of(mesh: &Mesh<2>, nodes: &[[f64; 2]], number: impl Fn(usize) -> usize) -> String {
    // Written as it is, with coordinates and numbers replaced line by line.
    let text = write_gmsh(mesh);
    let (mut out, mut section) = (String::new(), "");
    for line in text.lines() {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let renumbered =
            |n: &&str| (1 + number(n.parse::<usize>().expect("a node") - 1)).to_string();
        if let Some(name) = line.strip_prefix('$') {
            section = name;
        }
        out += &match (section, fields.len()) {
            ("Nodes", 4) => {
                let new = number(fields[0].parse::<usize>().expect("a node") - 1);
                format!("{} {:?} {:?} 0", new + 1, nodes[new][0], nodes[new][1])
            }
            ("Elements", 6..) => {
                let tags: usize = fields[2].parse().expect("a count");
                let (head, own) = fields.split_at(3 + tags);
                let own: Vec<String> = own.iter().map(renumbered).collect();
                format!("{} {}", head.join(" "), own.join(" "))
            }
            _ => line.to_owned(),
        };
        out.push('\n');
    }
    out
}

/// Moves tools and loads along x and y.
fn tools_moved(deck: &mut Table, change: impl Fn(&str, f64) -> f64) {
    let only = |keys: &str, v: f64| {
        let first = keys.split('.').next().expect("a key");
        match ["tool", "step"].contains(&first) {
            true => change(keys, v),
            false => v,
        }
    };
    numbers(deck, &only);
}

/// Number of a node that has nothing to do with where it was.
fn shuffled(n: usize, count: usize) -> usize {
    let primes = [7919, 104_729, 1_299_709];
    let prime = primes.into_iter().find(|p| !count.is_multiple_of(*p));
    (n * prime.expect("a small mesh") + 17) % count
}

#[test]
fn numbers_of_nodes_change_nothing() {
    for (name, deck) in examples() {
        let base = history(
            &deck,
            &folder("docs/examples"),
            &format!("{name}-ordered"),
            false,
        );
        let (other, at) = moved(&format!("{name}-shuffled"), &deck, shuffled, |x| x);
        let found = history(&other, &at, &format!("{name}-shuffled"), false);
        same(&base, &found, &format!("{name}, shuffled"), |_, _| 1.0);
    }
}

#[test]
fn a_mirror_and_a_shift_change_nothing() {
    for (name, deck) in examples() {
        if deck["analysis"].as_str() == Some("axisymmetric") {
            continue; // The axis has its place.
        }
        let base = history(
            &deck,
            &folder("docs/examples"),
            &format!("{name}-base"),
            false,
        );
        let (mut mirror, at) = moved(&format!("{name}-mirror"), &deck, |n, _| n, |[x, y]| [-x, y]);
        let horizontal = |keys: &str, v: f64| {
            let last = keys.rsplit('.').next().expect("a key");
            let vectors = ["point", "normal", "center", "traction", "force", "move"];
            let in_vector = keys.split('.').any(|k| vectors.contains(&k));
            let first = last == "0" && in_vector;
            let in_move = keys.contains("move.") && last == "x";
            if first || in_move { -v } else { v }
        };
        tools_moved(&mut mirror, horizontal);
        let found = history(&mirror, &at, &format!("{name}-mirror"), false);
        let factor = |column: &str, _: &str| if column.ends_with(".x") { -1.0 } else { 1.0 };
        same(&base, &found, &format!("{name}, mirrored"), factor);

        let by = [37.5, -12.25];
        let shift = |[x, y]: [f64; 2]| [x + by[0], y + by[1]];
        let (mut shifted, at) = moved(&format!("{name}-shift"), &deck, |n, _| n, shift);
        let along = |keys: &str, v: f64| {
            let place = keys.contains(".point.") || keys.contains(".center.");
            match keys.rsplit('.').next() {
                Some("0") if place => v + by[0],
                Some("1") if place => v + by[1],
                _ => v,
            }
        };
        tools_moved(&mut shifted, along);
        let found = history(&shifted, &at, &format!("{name}-shift"), false);
        same(&base, &found, &format!("{name}, shifted"), |_, _| 1.0);
    }
}

/// A block between two rough platens, which alone hold it: the whole turned by 37° has the same
/// answer in the turned frame.
#[test]
fn a_rotation_turns_the_answer() {
    let turned = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        let turn = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
        let show = |x: [f64; 2]| {
            let [x, y] = turn(x);
            format!("[{x:?}, {y:?}]")
        };
        let kind = moreau::mesh::CellKind::Quad8;
        let (x, y) = (uniform(0.0, 8.0, 4), uniform(0.0, 4.0, 3));
        let mesh = block2("b", kind, &x, &y).expect("a mesh");
        let nodes: Vec<[f64; 2]> = mesh.nodes().iter().map(|&x| turn(x)).collect();
        let at = temporary("metamorphic");
        fs::create_dir_all(&at).expect("a folder");
        let name = format!("turned-{degrees}");
        fs::write(
            at.join(format!("{name}.msh")),
            text_of(&mesh, &nodes, |n| n),
        )
        .expect("a mesh");
        let deck = format!(
            r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.file = "{name}.msh"
material = [{{ on = "b", young = 1000.0, poisson = 0.3, yield-stress = 5.0, hardening = {{ linear = 50 }} }}]
contact = [
  {{ surface = "b.bottom", against = "low", friction = 0.3 }},
  {{ surface = "b.top", against = "high", friction = 0.2 }},
]
tool = [
  {{ name = "low", plane = {{ point = {}, normal = {} }} }},
  {{ name = "high", plane = {{ point = {}, normal = {} }} }},
]
step = [{{ name = "press", increments = 3, tools = [{{ name = "high", move = {} }}] }}]
output = {{ directory = "out", vtu = "none", checkpoint = 0 }}
"#,
            show([0.0, 0.0]),
            show([0.0, 1.0]),
            show([0.0, 4.0]),
            show([0.0, -1.0]),
            show([0.03, -0.04]),
        );
        history(&deck.parse().expect("toml"), &at, &name, false)
    };
    let (straight, oblique) = (turned(0.0), turned(37.0));
    let column = |h: &History, name: &str| -> Vec<f64> {
        let k = h.names.iter().position(|n| n == name).expect(name);
        h.rows.iter().map(|r| r[k]).collect()
    };
    for name in ["newton_iterations", "open", "stick", "slip"] {
        assert_eq!(column(&straight, name), column(&oblique, name), "{name}");
    }
    let (s, c) = 37f64.to_radians().sin_cos();
    let all = |h: &History| {
        ["low.x", "low.y", "high.x", "high.y"].map(|n| column(h, &format!("force.{n}")))
    };
    let (a, b) = (all(&straight), all(&oblique));
    for row in 0..3 {
        assert!(a[1][row] > 1.0, "pressed");
        for k in [0, 2] {
            let expected = [
                c * a[k][row] - s * a[k + 1][row],
                s * a[k][row] + c * a[k + 1][row],
            ];
            let found = [b[k][row], b[k + 1][row]];
            for i in 0..2 {
                assert!(
                    (found[i] - expected[i]).abs() < 1e-9 * a[1][row],
                    "{found:?} {expected:?}"
                );
            }
        }
    }
}

/// On one thread or two, and with a pause after the first increment: the same to the bit.
#[test]
fn threads_and_pauses_change_no_bit() {
    let beside = folder("docs/examples");
    for (name, deck) in examples() {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let name = format!("{name}-{threads}");
            pool.expect("threads")
                .install(|| history(&deck, &beside, &name, false))
        };
        let (one, two) = (on(1), on(2));
        assert!(one.text == two.text, "{name}: threads");
        let paused = history(&deck, &beside, &format!("{name}-paused"), true);
        assert!(one.text == paused.text, "{name}: a pause");
    }
}
