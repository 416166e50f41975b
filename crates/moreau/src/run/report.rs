//! `report.html`: a run on one page that needs nothing but a browser; its template is beside it.

mod viewer;

use super::RunError;
use super::files::{history_table, read_text};
use crate::deck::Deck;
use crate::driver::Driver;
use crate::numbers::shown;
use crate::simulation::pictures::over_time;
use crate::table::Table;
use crate::vtu::Array;
use minijinja::value::Value;
use minijinja::{Environment, context};
use std::path::Path;
use viewer::viewer;

/// The page of a run. `last` is the end of the run where no file has it; The stills are its deformed body and its
/// contact.
pub(super) fn report<const D: usize>(
    driver: &Driver<D>,
    deck: &Deck,
    directory: &Path,
    last: Option<&[Array]>,
    [deformed, contact]: [Option<String>; 2],
) -> Result<String, RunError> {
    let history = history_table(directory)?;
    let increment = history.numbers("increment").pop().unwrap_or(0.0) as usize;
    let resolved = read_text(&directory.join("deck.resolved.toml"))?;
    let run = read_text(&directory.join("run.json"))?;
    let run: serde_json::Value = serde_json::from_str(&run).unwrap_or_default();
    let text = |key: &str| run[key].as_str().unwrap_or_default().to_owned();
    let name = directory.canonicalize().ok();
    let name = name.as_deref().and_then(Path::file_name);
    let forces = over_time(&history, deck);
    let warnings = list(&run["warnings"]);
    let page = context! {
        title => if deck.title.is_empty() { "moreau" } else { &deck.title },
        status => text("status"),
        error => text("error"),
        suggestion => run["diagnosis"]["suggestion"].as_str().unwrap_or_default(),
        name => name.unwrap_or_default().to_string_lossy(),
        version => text("version"),
        finished => run["finished"].as_u64(),
        results => results(&run, deck),
        energies => energies(&history, deck),
        exactness => exactness(&run, deck),
        effort => effort(&run),
        expectations => expectations(&run),
        warned => match warnings.len() {
            1 => "1 warning".to_owned(),
            n => format!("{n} warnings"),
        },
        warnings => warnings,
        certificate => certificate(&history, deck),
        deck => resolved,
        history => forces.as_ref().and_then(|chart| chart.to_svg().ok()),
        deformed => deformed,
        contact => contact,
        solid => D == 3,
        // No name in it may end the script.
        data => viewer(driver, deck, directory, forces.as_ref(), (increment, last))?.to_string().replace("</", "<\\/"),
    };
    let mut environment = Environment::new();
    let html = environment
        .add_template("report.html", include_str!("report.html"))
        .and_then(|()| environment.get_template("report.html")?.render(page));
    html.map_err(|error| RunError::Write {
        path: directory.join("report.html"),
        source: std::io::Error::other(error),
    })
}

fn list(value: &serde_json::Value) -> Vec<String> {
    let items = value.as_array().into_iter().flatten();
    items
        .filter_map(|v| v.as_str().map(str::to_owned))
        .collect()
}

/// Rows of a table: what, and how much.
type Rows = Vec<[String; 2]>;

/// What was computed: loads at collapse, forces, displacements.
fn results(run: &serde_json::Value, deck: &Deck) -> Rows {
    let units = deck.units;
    let collapse = &run["collapse"];
    let factor = match collapse["added"].as_bool() {
        Some(true) => "load factor at collapse, from the forces at the start on",
        _ => "load factor at collapse",
    };
    let bound = match collapse["strict"].as_bool() {
        Some(true) => "its upper bound",
        _ => "its kinematic estimate",
    };
    let mut rows: Rows = [(factor, "load_factor"), (bound, "upper_bound")]
        .into_iter()
        .filter_map(|(name, key)| Some([name.to_owned(), shown(collapse[key].as_f64()?, 6)]))
        .collect();
    for (name, value) in run["values"].as_object().into_iter().flatten() {
        let unit = units.of_value(name);
        let value = value.as_f64().unwrap_or(f64::NAN);
        rows.push([format!("{name} [{unit}]"), shown(value, 9)]);
    }
    rows
}

/// Where the work has gone by the end.
fn energies(history: &Table, deck: &Deck) -> Rows {
    let columns = [
        ("external work", "external_work"),
        ("stored in the bodies", "elastic_energy"),
        ("dissipated by plastic flow", "plastic_dissipation"),
        ("dissipated by friction", "friction_dissipation"),
        ("in springs of penalty or compliance", "penalty_energy"),
    ];
    let unit = deck.units.energy();
    let last = |(name, column): (&str, &str)| {
        let value = history.numbers(column).pop()?;
        (value != 0.0).then(|| [format!("{name} [{unit}]"), shown(value, 6)])
    };
    let mut rows: Rows = columns.into_iter().filter_map(last).collect();
    let value = |column: &str| history.numbers(column).pop().unwrap_or(0.0);
    let found: f64 = columns[1..].iter().map(|c| value(c.1)).sum();
    if !rows.is_empty() {
        let lacks = value(columns[0].1) - found;
        rows.push([format!("not found again [{unit}]"), shown(lacks, 3)]);
    }
    rows
}

/// How exactly the law of contact holds.
fn exactness(run: &serde_json::Value, deck: &Deck) -> Rows {
    let units = deck.units;
    let rows = [
        ("largest bipotential gap", "bipotential_gap", units.energy()),
        ("the same, over the work", "relative_gap", "–"),
        ("largest penetration", "penetration", units.length()),
        (
            "largest force outside the cone",
            "excess_force",
            units.force(),
        ),
    ];
    let row = |(name, key, unit): (&str, &str, &str)| {
        let value = run["certificate"][key].as_f64();
        let value = value.map_or("–".to_owned(), |v| shown(v, 3));
        [format!("{name} [{unit}]"), value]
    };
    rows.map(row).into()
}

/// What it took.
fn effort(run: &serde_json::Value) -> Rows {
    let number = |v: &serde_json::Value| match v {
        serde_json::Value::Null => "–".to_owned(),
        v if v.is_f64() => format!("{:.4}", v.as_f64().unwrap_or(f64::NAN)),
        v => v.to_string(),
    };
    [
        ("increments", "increments"),
        ("Newton iterations", "newton_iterations"),
        ("contact iterations", "contact_iterations"),
        ("factorisations", "factorisations"),
        ("conjugate gradients", "linear_iterations"),
        ("solves for contact", "contact_solves"),
        ("cuts", "cuts"),
        ("degrees of freedom", "dofs"),
        ("seconds", "seconds"),
        ("threads", "threads"),
        ("peak memory [MB]", "peak_memory_mb"),
    ]
    .map(|(name, key)| [name.to_owned(), number(&run[key])])
    .into()
}

fn expectations(run: &serde_json::Value) -> Vec<Value> {
    let row = |v: &serde_json::Value| {
        let number = |key: &str| v[key].as_f64().unwrap_or(f64::NAN);
        context! {
            column => v["column"].as_str().unwrap_or_default(),
            expected => shown(number("expected"), 9),
            tolerance => shown(number("tolerance"), 3),
            found => shown(number("found"), 9),
            passed => v["passed"] == true,
        }
    };
    let verdicts = run["expectations"].as_array().into_iter().flatten();
    verdicts.map(row).collect()
}

/// Header and rows of the certificate of every increment.
fn certificate(history: &Table, deck: &Deck) -> Value {
    let units = deck.units;
    let columns = [
        ("step", "step", ""),
        ("increment", "increment", ""),
        ("time", "time", ""),
        ("newton_iterations", "Newton", ""),
        ("contact_iterations", "contact", ""),
        ("cuts", "cuts", ""),
        ("open", "open", ""),
        ("stick", "stick", ""),
        ("slip", "slip", ""),
        ("plastic_fraction", "plastic", "–"),
        ("bipotential_gap", "gap", units.energy()),
        ("external_work", "external work", units.energy()),
        ("penetration", "penetration", units.length()),
        ("excess_force", "outside the cone", units.force()),
        ("out_of_balance", "out of balance", units.force()),
    ];
    let header = |&(_, name, unit): &(&str, &str, &str)| match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    };
    let values: Vec<Vec<f64>> = columns.iter().map(|c| history.numbers(c.0)).collect();
    let show = |v: f64| match v.fract() == 0.0 && v.abs() < 1e9 {
        true => format!("{v}"),
        false if v.abs() >= 1e-3 && v.abs() < 1e6 => format!("{v:.4}"),
        false => format!("{v:.2e}"),
    };
    let rows: Vec<Vec<String>> = (0..values[0].len())
        .map(|row| values.iter().map(|c| show(c[row])).collect())
        .collect();
    context! {
        header => columns.iter().map(header).collect::<Vec<_>>(),
        rows => rows,
    }
}
