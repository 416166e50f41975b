//! `[solver]`, `[output]` and `[expect]`: how to solve, what to write, what to expect.

use crate::deck::entries::{Expectation, Method, SolverEntry, Vtu};
use crate::deck::finding::At;
use crate::deck::reader::{self, Table};

const METHODS: [&str; 3] = ["exact", "uzawa", "gauss-seidel"];

/// Force that is out of balance over the largest one, unless the deck says; and what it may say.
const TOLERANCE: f64 = 1e-10;
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-13..=1e-4;

/// Increments between checkpoints, unless the deck says.
const CHECKPOINT: usize = 10;

fn section<'a>(root: &Table<'a>, key: &'static str, shown: &str) -> Option<Table<'a>> {
    reader::table(root.get(key)?, key, shown, root.log())
}

pub(super) fn read_solver(root: &Table<'_>) -> SolverEntry {
    let mut solver = SolverEntry {
        method: Method::Exact,
        outside: false,
        chosen: 0..0,
        threads: 0,
        tolerance: TOLERANCE,
    };
    let Some(table) = section(root, "solver", "[solver]") else {
        return solver;
    };
    let log = table.log();
    let method = method(&table);
    let nesting = table.choice_if("nesting", &["inside", "outside"]);
    solver.outside = nesting.as_ref().is_some_and(|n| n.value == "outside");
    solver.chosen = match (nesting, table.get("contact")) {
        (Some(nesting), _) if solver.outside => nesting.span,
        (_, Some(contact)) => contact.span(),
        _ => 0..0,
    };
    if let Some(value) = table.get("contact")
        && solver.outside
        && method != Some(Method::Uzawa)
    {
        log.borrow_mut().warning(
            &value.span(),
            "nesting = \"outside\" is Uzawa's method around the nonlinear solve: this is not used",
            "not used",
        );
    }
    solver.method = method.unwrap_or(Method::Exact);
    let threads = table.get("threads");
    let threads = threads.and_then(|v| reader::integer(v, "threads", 0..=1024, log));
    if let Some(tolerance) = table.number_if("tolerance") {
        if TOLERANCES.contains(&tolerance.value) {
            solver.tolerance = tolerance.value;
        } else {
            log.borrow_mut().error(
                &tolerance.span,
                format!(
                    "tolerance is {:?}, expected a part of the largest force from {:?} to {:?}",
                    tolerance.value,
                    TOLERANCES.start(),
                    TOLERANCES.end()
                ),
                "below it rounding decides, above it the answer is none",
            );
        }
    }
    solver.threads = threads.map_or(0, |t| t.value);
    table.finish();
    solver
}

fn method(table: &Table<'_>) -> Option<Method> {
    let log = table.log();
    let value = table.get("contact")?;
    if !value.get_ref().is_table() {
        let choice = reader::choice(value, "contact", &METHODS, log)?;
        return Some(match choice.value {
            "uzawa" => Method::Uzawa,
            "gauss-seidel" => Method::GaussSeidel,
            _ => Method::Exact,
        });
    }
    let inner = reader::table(value, "contact", "contact", log)?;
    if let Some(value) = inner.get("penetration") {
        inner.finish();
        let part = reader::number(value, "penetration", log)?;
        if !(part.value > 0.0 && part.value < 1.0) {
            let expected = "a part of the size of a cell, between 0 and 1";
            return reader::wrong(value, "penetration", expected, log);
        }
        return Some(Method::Penetration(part));
    }
    let springs = inner.need("penalty", "{ normal = …, tangent = … }");
    let method = springs.and_then(|v| {
        let springs = reader::table(v, "penalty", "penalty", log)?;
        let (normal, tangent) = (springs.number("normal"), springs.number("tangent"));
        springs.finish();
        Some(Method::Penalty(normal?, tangent?))
    });
    inner.finish();
    method
}

/// Directory, the increments of which bodies and points are written, increments between checkpoints.
/// `[output]`.
pub(super) struct Output {
    pub(super) directory: Option<String>,
    pub(super) vtu: Vtu,
    pub(super) points: Vtu,
    pub(super) checkpoint: usize,
    pub(super) probes: Vec<At<String>>,
}

pub(super) fn read_output(root: &Table<'_>) -> Output {
    let Some(table) = section(root, "output", "[output]") else {
        return Output {
            directory: None,
            vtu: Vtu::All,
            points: Vtu::Last,
            checkpoint: CHECKPOINT,
            probes: Vec::new(),
        };
    };
    let log = table.log();
    let directory = table
        .get("directory")
        .and_then(|v| reader::text(v, "directory", log));
    let which = |key, default| match table.choice_if(key, &Vtu::NAMES).map(|v| v.value) {
        Some("all") => Vtu::All,
        Some("last") => Vtu::Last,
        Some(_) => Vtu::None,
        None => default,
    };
    let vtu = which("vtu", Vtu::All);
    // The points are several times as many numbers: of all increments only where they are asked for.
    let few = if vtu == Vtu::None { vtu } else { Vtu::Last };
    let points = which("points", few);
    let every = table.get("checkpoint");
    let every = every.and_then(|v| reader::integer(v, "checkpoint", 0..=1_000_000, log));
    let probes = table.get("probes").and_then(|value| {
        let items = reader::items(value, "probes", "an array of groups", log)?;
        let probe = |item| reader::text(item, "a probe", log);
        items.into_iter().map(probe).collect()
    });
    table.finish();
    Output {
        directory: directory.map(|d| d.value),
        vtu,
        points,
        checkpoint: every.map_or(CHECKPOINT, |e| e.value),
        probes: probes.unwrap_or_default(),
    }
}

pub(super) fn read_expectations(root: &Table<'_>) -> Vec<Expectation> {
    let log = root.log();
    let Some(table) = section(root, "expect", "[expect]") else {
        return Vec::new();
    };
    let mut list = Vec::new();
    for (column, value) in table.entries() {
        let Some(inner) = reader::table(value, &column.value, "an expectation", log) else {
            continue;
        };
        let number = inner.number("value");
        let tolerance = |key| inner.number_if(key).filter(|t| t.value >= 0.0);
        let (relative, absolute) = (tolerance("relative"), tolerance("absolute"));
        inner.finish();
        if let Some(number) = number {
            list.push(Expectation {
                column,
                value: number.value,
                relative: relative.map(|t| t.value),
                absolute: absolute.map(|t| t.value),
            });
        }
    }
    list
}
