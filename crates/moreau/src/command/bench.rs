//! `moreau bench`: a deck under every contact algorithm, as a table.

use super::{INPUT_ERROR, NOT_CONVERGED, run, say, tell};
use crate::deck::{At, Deck, Given, Method, Vtu};
use crate::run::Directory;
use crate::simulation::{Outcome, RunStatus, Simulation};
use std::path::{Path, PathBuf};

/// Penetration of the penalty that a deck does not give, in parts of the shortest side of a cell.
const PENETRATION: f64 = 1e-4;

/// Runs a deck under every algorithm; the exit status is that of the first that fails.
pub(super) fn bench(path: &Path, out: Option<PathBuf>, force: bool) -> u8 {
    let Some(simulation) = run::simulation(path, &Given::default()) else {
        return INPUT_ERROR;
    };
    let deck = simulation.deck().clone();
    drop(simulation);
    let Some(pool) = run::pool(deck.solver.threads) else {
        return INPUT_ERROR;
    };
    let out = out.unwrap_or_else(|| run::default_directory(path, "-bench"));
    say!(
        "{:<34} {:>9} {:>7} {:>8} {:>7} {:>10} {:>11}  status",
        "algorithm",
        "seconds",
        "Newton",
        "contact",
        "factors",
        "gap/work",
        "penetration"
    );
    let mut status = 0;
    let mut results = Vec::new();
    for (name, deck) in algorithms(&deck) {
        let directory = out.join(name.replace([' ', ','], "-"));
        let Some(directory) = run::taken(Directory::take_for(&directory, path, force)) else {
            return INPUT_ERROR;
        };
        // The deck as text, so that it is checked as any other.
        let text = deck.resolved();
        let (simulation, findings) = Simulation::open(&text, Path::new(""), &Given::default());
        let Some(simulation) = simulation else {
            // The first, the exact method, goes with every deck that is right; others need more.
            if results.is_empty() {
                tell!("{}", findings.render(&name, &text, false));
                return INPUT_ERROR;
            }
            say!("{name:<34} does not go with the deck");
            continue;
        };
        let outcome = pool.install(|| crate::run::run(simulation, &directory, &mut ()));
        match outcome {
            Ok(outcome) => {
                say!(
                    "{name:<34} {:>9.3} {:>7} {:>8} {:>7} {:>10.1e} {:>11.1e}  {}",
                    outcome.seconds,
                    outcome.newton_iterations,
                    outcome.contact_iterations,
                    outcome.factorisations,
                    outcome.relative_gap,
                    outcome.certificate.penetration,
                    outcome.status.name()
                );
                if outcome.status != RunStatus::Done {
                    status = NOT_CONVERGED;
                }
                results.push((name, outcome));
            }
            Err(error) => {
                tell!("{error}");
                return INPUT_ERROR;
            }
        }
    }
    forces(&results);
    say!("results in {}", out.display());
    status
}

/// Final forces, a line for each and a column for each algorithm.
fn forces(results: &[(String, Outcome)]) {
    let Some((_, first)) = results.first() else {
        return;
    };
    let largest = first.values.iter().map(|v| v.1.abs()).fold(0.0, f64::max);
    let acts = |v: &&(String, f64)| v.0.starts_with("force.") && v.1.abs() > 1e-9 * largest;
    let acting: Vec<_> = first.values.iter().filter(acts).collect();
    if acting.is_empty() {
        say!("\nno forces at the end");
        return;
    }
    say!("\nforces at the end [{}]", first.units.force());
    for (column, value) in acting {
        say!("{column}");
        for (name, outcome) in results.iter().filter(|r| r.1.status == RunStatus::Done) {
            let found = outcome.values.iter().find(|v| v.0 == *column);
            let found = found.map_or(f64::NAN, |v| v.1);
            let off = found / value - 1.0;
            say!("  {name:<32} {found:>18.10e}  {off:>+9.1e}");
        }
    }
}

/// The deck under every algorithm, with nothing written but what is compared.
fn algorithms(deck: &Deck) -> Vec<(String, Deck)> {
    let penalty = match &deck.solver.method {
        given @ (Method::Penalty(..) | Method::Penetration(_)) => given.clone(),
        _ => Method::Penetration(At::new(PENETRATION, 0..0)),
    };
    let springs = match &penalty {
        Method::Penalty(normal, tangent) => format!("{:e}, {:e}", normal.value, tangent.value),
        Method::Penetration(part) => format!("penetration {:e}", part.value),
        _ => String::new(),
    };
    let methods = [
        ("exact".to_owned(), Method::Exact, false),
        ("gauss-seidel".to_owned(), Method::GaussSeidel, false),
        ("uzawa".to_owned(), Method::Uzawa, false),
        (format!("penalty, {springs}"), penalty, false),
        // The paper's own: last, for it takes longest.
        ("uzawa outside".to_owned(), Method::Uzawa, true),
    ];
    let with = |(name, method, outside)| {
        let mut deck = deck.clone();
        deck.solver.method = method;
        deck.solver.outside = outside;
        deck.vtu = Vtu::None;
        deck.points = Vtu::None;
        deck.checkpoint = 0;
        deck.directory = None;
        (name, deck)
    };
    methods.into_iter().map(with).collect()
}
