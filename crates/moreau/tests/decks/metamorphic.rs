//! The same problem said differently has the same answer: in other units, mirrored, shifted, turned,
//! with its nodes numbered otherwise, on one thread, with a pause. No answer needs to be known.

mod bits;
mod moved;
mod units;

use super::{folder, temporary};
use moreau::deck::{Given, open_in};
use moreau::run::{Directory, Watch, resume, run};
use moreau::simulation::{Converged, Simulation};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::{Arc, LazyLock, Mutex, OnceLock};
use toml::{Table, Value};

/// The examples, with two increments a step and loads in proportion; solids on a third of the lines, large plane
/// bodies on half of them.
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
        if deck.contains_key("include") {
            let whole = open_in(&text, &folder("docs/examples")).0.resolved();
            deck = whole.parse().expect("toml");
            // Nothing but defaults, which have no units.
            deck.remove("solver");
        }
        let solid = is_solid(&deck);
        let blocks = deck["mesh"].as_table_mut().expect("a mesh");
        let blocks = blocks.get_mut("block").and_then(Value::as_array_mut);
        for block in blocks.into_iter().flatten() {
            let along = block["cells"].as_array_mut().expect("cells");
            let all: i64 = along.iter().filter_map(Value::as_integer).product();
            let coarser = match (solid, all > 100) {
                (true, _) => 3,
                (false, true) => 2,
                (false, false) => 1,
            };
            for cells in along {
                let count = cells.as_integer().expect("a count");
                *cells = ((count + coarser - 1) / coarser).into();
            }
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
    assert!(all.len() >= 11);
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn is_solid(deck: &Table) -> bool {
    deck["analysis"].as_str() == Some("solid")
}

fn steps(deck: &mut Table) -> impl Iterator<Item = &mut Table> {
    let steps = deck["step"].as_array_mut().expect("steps").iter_mut();
    steps.map(|s| s.as_table_mut().expect("a step"))
}

fn loads(key: &str) -> bool {
    let is = |name: &str| key.split('.').any(|k| k == name);
    ["move", "load"].map(is).contains(&true) || (is("tools") && is("move"))
}

/// Whether a number has no unit and no place: a count, or a share of a motion or load over the time of its step.
fn is_pure(keys: &str, key: &str) -> bool {
    let of_a_value = ["move", "load", "tools"];
    let is_share = key == "table" && keys.split('.').any(|k| of_a_value.contains(&k));
    is_share || ["cells", "increments", "checkpoint"].contains(&key)
}

/// Changes all numbers of a table but pure ones, each told by the keys on the way to it.
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
            if !is_pure(keys, key) {
                walk(value, &format!("{keys}{key}"), change);
            }
        }
    }
    inside(table, "", change);
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Changes all formulas of the position.
fn formulas(table: &mut Table, change: &impl Fn(&str) -> String) {
    fn walk(value: &mut Value, change: &impl Fn(&str) -> String) {
        match value {
            Value::String(text) => {
                if let Some(formula) = text.strip_prefix('=') {
                    *text = format!("= {}", change(formula));
                }
            }
            Value::Array(items) => items.iter_mut().for_each(|item| walk(item, change)),
            Value::Table(table) => table.iter_mut().for_each(|(_, v)| walk(v, change)),
            _ => {}
        }
    }
    table.iter_mut().for_each(|(_, value)| walk(value, change));
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
    fn converged(&mut self, increment: &Converged, _: f64) {
        self.0 = self.0.saturating_sub(increment.report.increment);
    }

    fn stops(&self) -> bool {
        self.0 == 0
    }
}

/// The histories of the examples as they are, on two threads, each made once for all who compare with it.
static AS_IT_IS: LazyLock<Mutex<BTreeMap<String, Arc<OnceLock<History>>>>> =
    LazyLock::new(Mutex::default);

/// Compares something with the history of an example as it is.
fn beside_itself(name: &str, deck: &Table, compare: impl FnOnce(&History)) {
    let all = || AS_IT_IS.lock().expect("no panic holds it");
    let kept = all().entry(name.to_owned()).or_default().clone();
    compare(kept.get_or_init(|| on_threads(2, name, deck)));
}

/// The history of an example on so many threads.
fn on_threads(threads: usize, name: &str, deck: &Table) -> History {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let (beside, name) = (folder("docs/examples"), format!("{name}-{threads}"));
    pool.expect("threads")
        .install(|| history(deck, &beside, &name, false))
}

/// Runs a deck into a directory, after a pause if that is asked for.
fn history(deck: &Table, beside: &Path, name: &str, pause: bool) -> History {
    let at = temporary(&format!("metamorphic/{name}"));
    let to = Directory::take(&at).expect("a directory");
    let text = deck.to_string();
    let mut watch = Pause(if pause { 1 } else { usize::MAX });
    for go_on in [false, true] {
        let (simulation, findings) = Simulation::open(&text, beside, &Given::default());
        let shown = || findings.render(name, &text, false);
        let simulation = simulation.unwrap_or_else(|| panic!("{}", shown()));
        match go_on {
            false => run(simulation, &to, &mut watch),
            true => resume(simulation, &to, &mut ()),
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

/// What a run has done to get there.
const EFFORTS: [&str; 4] = [
    "newton_iterations",
    "contact_iterations",
    "factorisations",
    "cuts",
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
    let large = a.names.iter().any(|name| name == "largest.jacobian");
    for (k, name) in a.names.iter().enumerate() {
        let unit = &a.units[k];
        if ROUNDING.contains(&name.as_str()) {
            continue;
        }
        let most = match name.as_str() {
            // Beyond limit points and bifurcations rounding decides how far a step is shortened.
            _ if large && EFFORTS.contains(&name.as_str()) => f64::INFINITY,
            "plastic_fraction" | "cell_quality" => 1e-9,
            name if name.starts_with("largest.") && unit.is_empty() => 1e-9,
            _ if unit.is_empty() => 0.0,
            _ => 1e-9 * scale(unit),
        };
        for (x, y) in a.rows.iter().zip(&b.rows) {
            let y = y[k] * factor(name, &b.units[k]);
            assert!((x[k] - y).abs() <= most, "{what}, {name}: {} and {y}", x[k]);
        }
    }
}
