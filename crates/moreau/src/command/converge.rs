//! `moreau converge`: a deck on finer meshes and with shorter increments, and what its results tend to.

use super::{INPUT_ERROR, NOT_CONVERGED, run, say, tell};
use crate::deck::{Deck, Given, Grid};
use crate::driver::Collapse;
use crate::numbers::shown;
use crate::simulation::{Outcome, RunStatus, Simulation};
use std::ops::ControlFlow;
use std::path::Path;

/// Part of the largest value of its kind below which a difference is rounding.
const ROUNDING: f64 = 1e-9;
/// Significant digits.
const DIGITS: usize = 7;

/// What is made finer.
#[derive(Clone, Copy)]
enum Finer {
    Mesh,
    Increments,
}

impl Finer {
    fn name(self) -> &'static str {
        match self {
            Self::Mesh => "cells",
            Self::Increments => "increments",
        }
    }

    /// The deck with so many times as many.
    fn of(self, deck: &Deck, times: usize) -> Deck {
        let mut deck = deck.clone();
        match self {
            Self::Mesh => {
                for axis in deck.blocks.iter_mut().flat_map(|block| &mut block.grid) {
                    axis.value = divided(&axis.value, times);
                }
            }
            Self::Increments => {
                for step in &mut deck.steps {
                    let own = &mut step.increments;
                    let part = 1.0 / times as f64;
                    // A number of equal ones stays one, to the bit.
                    let equal = own.start == own.max && own.min.is_none();
                    *own = match equal {
                        true => crate::driver::Increments::equal(own.count() * times),
                        false => crate::driver::Increments {
                            start: own.start * part,
                            min: own.min.map(|min| min * part),
                            max: own.max * part,
                        },
                    };
                }
            }
        }
        deck
    }
}

/// Grid lines with every cell divided into so many.
fn divided(grid: &Grid, times: usize) -> Grid {
    match grid {
        Grid::Range(ends, cells) => Grid::Range(*ends, cells * times),
        Grid::Lines(lines) => {
            let between = |pair: &[f64]| {
                let [from, to] = [pair[0], pair[1]];
                let part = move |k: usize| from + (to - from) * k as f64 / times as f64;
                (0..times).map(part).collect::<Vec<_>>()
            };
            let mut all: Vec<f64> = lines.windows(2).flat_map(between).collect();
            all.extend(lines.last());
            Grid::Lines(all)
        }
    }
}

/// What three values at h, h/2 and h/4 tend to: the order that is seen, and the value at h → 0 by it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Limit {
    /// All are alike.
    Reached,
    /// f(h) ≈ f(0) + C hᵖ.
    Seen { order: f64, value: f64 },
    /// The differences do not shrink, or change their sign.
    Unseen,
}

impl Limit {
    fn new([coarse, middle, fine]: [f64; 3], rounding: f64) -> Self {
        let (first, last) = (middle - coarse, fine - middle);
        if first.abs() <= rounding && last.abs() <= rounding {
            return Self::Reached;
        }
        let ratio = first / last;
        match ratio > 1.0 && ratio.is_finite() {
            true => Self::Seen {
                order: ratio.log2(),
                value: fine + last / (ratio - 1.0),
            },
            false => Self::Unseen,
        }
    }
}

/// Runs a deck on three meshes and with three lengths of the increments; the exit status.
pub(super) fn converge(path: &Path, given: &Given) -> u8 {
    let Some(simulation) = run::simulation(path, given) else {
        return INPUT_ERROR;
    };
    let deck = simulation.deck().clone();
    drop(simulation);
    let Some(pool) = run::pool(deck.solver.threads) else {
        return INPUT_ERROR;
    };
    if !deck.title.is_empty() {
        say!("{}", deck.title);
    }
    let Some(own) = pool.install(|| outcome(&deck, "the deck")) else {
        return NOT_CONVERGED;
    };
    let mut all: Vec<(Finer, [Outcome; 3])> = Vec::new();
    for finer in [Finer::Mesh, Finer::Increments] {
        if matches!(finer, Finer::Mesh) && !deck.mesh_files.is_empty() {
            say!("the mesh is a file: refine it where it was made");
            continue;
        }
        let more = |times: usize| {
            let deck = finer.of(&deck, times);
            let what = format!("{times} times as many {}", finer.name());
            pool.install(|| outcome(&deck, &what))
        };
        let (Some(middle), Some(fine)) = (more(2), more(4)) else {
            return NOT_CONVERGED;
        };
        all.push((finer, [own.clone(), middle, fine]));
    }
    table(&deck, &own, &all);
    0
}

/// What a deck comes to, in memory; `None` where it does not end.
fn outcome(deck: &Deck, what: &str) -> Option<Outcome> {
    let text = deck.resolved();
    let (simulation, findings) = Simulation::open(&text, Path::new(""), &Given::default());
    let Some(mut simulation) = simulation else {
        tell!("{}", findings.render(what, &text, false));
        return None;
    };
    while let Ok(Some(_)) = simulation.advance(&mut |_, _| ControlFlow::Continue(())) {}
    let outcome = simulation.outcome();
    match (&outcome.status, outcome.error()) {
        (RunStatus::Done, _) => {
            say!("{what}: {:.1} s", outcome.seconds);
            Some(outcome)
        }
        (status, error) => {
            let why = error.unwrap_or_default();
            tell!("{what}: {}: {why}", status.name());
            None
        }
    }
}

/// The limit load of a run that ends in collapse, with its name.
fn limit(outcome: &Outcome) -> Option<(String, f64)> {
    let (step, collapse) = outcome.collapse.as_ref()?;
    let name = format!("load factor of step \"{step}\"");
    Some((name, collapse.load_factor))
}

/// The results of interest by name: the limit load, and those of which something is expected, or all. Displacements of a
/// mechanism have no size, and tend to nothing.
fn names(deck: &Deck, own: &Outcome) -> Vec<String> {
    let expected = deck.expectations.iter().map(|e| &e.column.value);
    let mut names: Vec<String> = expected.cloned().collect();
    if names.is_empty() {
        names = own.values.iter().map(|v| v.0.clone()).collect();
    }
    if let Some((name, _)) = limit(own) {
        names.retain(|name| !name.starts_with("u."));
        names.insert(0, name);
    }
    names
}

/// A result of a run by its name.
fn value(outcome: &Outcome, name: &str) -> Option<f64> {
    let limit = limit(outcome).filter(|limit| limit.0 == name);
    let verdict = outcome.verdicts.iter().find(|v| v.column == name);
    let listed = outcome.values.iter().find(|v| v.0 == name);
    let told = verdict.map(|v| v.found).or(listed.map(|v| v.1));
    limit.map(|limit| limit.1).or(told)
}

/// The results of interest, and what they tend to.
fn table(deck: &Deck, own: &Outcome, all: &[(Finer, [Outcome; 3])]) {
    let kind = |name: &str| name.split('.').next().map(str::to_owned);
    let load_factor = limit(own).map(|limit| limit.0);
    for name in &names(deck, own) {
        // A plateau is followed until so much is left to be gained.
        let rounding = match load_factor.as_ref() == Some(name) {
            true => Collapse::FLAT,
            false => ROUNDING,
        };
        let alike = own.values.iter().filter(|v| kind(&v.0) == kind(name));
        let of = |outcome: &Outcome| value(outcome, name).unwrap_or(f64::NAN);
        let largest = alike.fold(of(own).abs(), |m, v| m.max(v.1.abs()));
        say!("\n{name}");
        say!(
            "  {:<12} {:>15} {:>15} {:>15} {:>7} {:>15}",
            "more",
            "1 ×",
            "2 ×",
            "4 ×",
            "order",
            "tends to"
        );
        let (mut sum, mut known) = (of(own), true);
        for (finer, outcomes) in all {
            let values = outcomes.each_ref().map(of);
            let limit = Limit::new(values, rounding * largest);
            let (order, end) = match limit {
                Limit::Reached => ("–".into(), shown(values[2], DIGITS)),
                Limit::Seen { order, value } => {
                    sum += value - values[0];
                    (format!("{order:.2}"), shown(value, DIGITS))
                }
                Limit::Unseen => {
                    known = false;
                    ("none".into(), "–".into())
                }
            };
            let [a, b, c] = values.map(|v| shown(v, DIGITS));
            say!(
                "  {:<12} {a:>15} {b:>15} {c:>15} {order:>7} {end:>15}",
                finer.name()
            );
        }
        let of = match all {
            [_] => "on this mesh",
            _ => "of both",
        };
        match known {
            true => say!("  {of:<12} {}", shown(sum, DIGITS)),
            false => say!("  {of:<12} not seen: differences do not shrink steadily"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_seen() {
        let f = |h: f64| 3.0 - 0.5 * h.powf(1.5);
        match Limit::new([f(0.4), f(0.2), f(0.1)], 1e-12) {
            Limit::Seen { order, value } => {
                assert!((order - 1.5).abs() < 1e-9 && (value - 3.0).abs() < 1e-12);
            }
            other => panic!("{other:?}"),
        }
        assert_eq!(Limit::new([1.0, 1.0, 1.0], 1e-12), Limit::Reached);
        for unsteady in [[1.0, 1.1, 1.3], [1.0, 1.1, 1.05], [1.0, 1.0, 1.1]] {
            assert_eq!(Limit::new(unsteady, 1e-12), Limit::Unseen);
        }
    }

    #[test]
    fn cells_are_divided() {
        let lines = divided(&Grid::Lines(vec![0.0, 1.0, 4.0]), 2);
        assert_eq!(lines, Grid::Lines(vec![0.0, 0.5, 1.0, 2.5, 4.0]));
        assert_eq!(divided(&Grid::Range([0.0, 1.0], 3), 4).cells(), 12);
    }
}
