//! Paper 8.2.2: regularisation against Uzawa, and against exact methods that the paper did not
//! have; figures 15 to 17.

use super::compare::{
    History, certificate_row, certificate_table, digits, gap_check, record, scientific,
};
use super::pictures::along;
use crate::paper::{BLOCK_INCREMENTS, BLOCK_TRAVEL, block, block_punch_load, block_step};
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::contact::{ContactSolver, GaussSeidel, Penalty, SemismoothNewton, Uzawa};
use moreau::driver::{Driver, Nesting, Settings};
use moreau::mesh::{Integration, NodeKind};
use moreau::plot::{Chart, Style};
use std::error::Error;
use std::time::Instant;

/// The case.
pub(super) const CASE: Case = Case {
    name: "algorithms",
    long: false,
    alone: false,
    chapter: Chapter::Paper,
    title: "Comparison of the algorithms (paper 8.2.2, figures 15 and 16)",
    description: "The punched block with a friction of 0.1, 20 cells, 2×2 quadrature, under the \
        penalty method (k = 10⁸ N/mm), under three exact methods inside Newton's iteration \
        (semismooth Newton, Uzawa, Gauss–Seidel) and under the paper's own nesting, Uzawa around \
        the nonlinear solve.",
    decks: &["examples/punched-block.toml"],
    run: agreement,
};

/// What the methods cost.
pub(super) const TIMES: Case = Case {
    name: "times",
    long: false,
    alone: true,
    chapter: Chapter::Paper,
    title: "Times of the algorithms (paper 8.2.2, figure 17)",
    description: "The punched block with a friction of 0.1 and 2×2 quadrature. The paper's \
        regularisation took 25 s and its Uzawa 30 min, a ratio of 72; the ratios here are measured \
        in one run, on the fastest of several repetitions each.",
    decks: &["examples/punched-block.toml"],
    run: times,
};

const FRICTION: f64 = 0.1;
const PENALTY: f64 = 1e8;

/// Natural-map residual over the largest force at which the paper's nesting accepts an increment.
const OUTER_TOLERANCE: f64 = 1e-6;

/// Runs of every method of which the fastest counts, the others met another program; in a quick run, which does not
/// judge times, fewer.
const REPETITIONS: [usize; 2] = [15, 2];

/// A method under comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Method {
    Penalty,
    Newton,
    Uzawa,
    GaussSeidel,
}

impl Method {
    const ALL: [Self; 4] = [Self::Penalty, Self::Newton, Self::Uzawa, Self::GaussSeidel];

    fn name(self) -> &'static str {
        match self {
            Self::Penalty => "regularisation, k = 1e8 N/mm",
            Self::Newton => "semismooth Newton",
            Self::Uzawa => "Uzawa inside Newton",
            Self::GaussSeidel => "Gauss–Seidel",
        }
    }

    fn solver(self) -> Result<Box<dyn ContactSolver<2>>, Box<dyn Error>> {
        Ok(match self {
            Self::Penalty => Box::new(Penalty::new(PENALTY, PENALTY)?),
            Self::Newton => Box::new(SemismoothNewton::default()),
            Self::Uzawa => Box::new(Uzawa::default()),
            Self::GaussSeidel => Box::new(GaussSeidel::default()),
        })
    }
}

/// Presses by the first `increments` of the usual increments; returns the seconds that it took.
fn press(
    cells: [usize; 2],
    settings: Settings<2>,
    increments: usize,
) -> Result<(Driver<2>, History, f64), Box<dyn Error>> {
    let mut driver = block(cells, FRICTION, Integration::Reduced, settings)?;
    let mut history = History::default();
    let travel = BLOCK_TRAVEL * increments as f64 / BLOCK_INCREMENTS as f64;
    let start = Instant::now();
    record(
        &mut driver,
        &block_step(travel),
        increments,
        block_punch_load,
        &mut history,
    )?;
    let seconds = start.elapsed().as_secs_f64();
    Ok((driver, history, seconds))
}

/// Shortest time of a method over some repetitions, in turn with the others so that all meet the
/// same machine.
fn fastest(cells: [usize; 2], increments: usize, quick: bool) -> Result<[f64; 4], Box<dyn Error>> {
    let mut best = [f64::INFINITY; 4];
    for _ in 0..REPETITIONS[usize::from(quick)] {
        for (method, best) in Method::ALL.into_iter().zip(&mut best) {
            let settings = Settings {
                contact: method.solver()?,
                ..Settings::default()
            };
            *best = best.min(press(cells, settings, increments)?.2);
        }
    }
    Ok(best)
}

/// The paper's own nesting, Uzawa around the nonlinear solve.
fn nested() -> Settings<2> {
    Settings {
        nesting: Nesting::Outside {
            tolerance: OUTER_TOLERANCE,
            iterations: 200_000,
            extrapolated: false,
        },
        cuts: 0,
        ..Settings::default()
    }
}

fn agreement(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let coarse = [10, 2];
    let mut runs = Vec::new();
    for method in Method::ALL {
        (options.progress)(method.name());
        let settings = Settings {
            contact: method.solver()?,
            ..Settings::default()
        };
        let (driver, history, _) = press(coarse, settings, BLOCK_INCREMENTS)?;
        runs.push((method, driver, history));
    }
    inside(&runs, &mut outcome);
    let outer = if options.quick { 3 } else { 6 };
    (options.progress)(&format!(
        "Uzawa around the nonlinear solve, {outer} increments"
    ));
    let (around_driver, around, _) = press(coarse, nested(), outer)?;
    let (same_driver, same, _) = press(coarse, Settings::default(), outer)?;
    outcome.checks.push(Check::at_most(
        format!(
            "Uzawa around the nonlinear solve: forces against the exact ones, {outer} increments"
        ),
        (same.force_difference(&around), "1"),
        1e-4,
        "same law; accepted at a residual of 1e-6 of the largest force",
    ));
    figures(&runs, (&around_driver, &same_driver, outer), &mut outcome)?;
    certificates(&runs, &around, outer, &mut outcome);
    Ok(outcome)
}

/// The exact methods among themselves, and the regularisation against them.
fn inside(runs: &[(Method, Driver<2>, History)], outcome: &mut Outcome) {
    let Some((_, _, newton)) = runs.iter().find(|r| r.0 == Method::Newton) else {
        return;
    };
    for (method, _, history) in runs {
        let name = method.name();
        if *method == Method::Penalty {
            let last = |h: &History| History {
                contacts: h.contacts.last().cloned().into_iter().collect(),
                ..History::default()
            };
            outcome.checks.push(Check::at_most(
                format!("{name}: contact forces at 0.2 mm against the exact ones"),
                (last(newton).force_difference(&last(history)), "1"),
                1.1e-3,
                "an independent implementation saw at most 0.11 % at this factor",
            ));
            continue;
        }
        outcome.checks.push(gap_check(name, history));
        if *method == Method::Newton {
            continue;
        }
        outcome.checks.push(Check::at_most(
            format!("{name}: contact forces against semismooth Newton, all increments"),
            (newton.force_difference(history), "1"),
            1e-7,
            "the solution is unique at this friction",
        ));
        outcome.checks.push(Check::at_most(
            format!("{name}: statuses that differ from semismooth Newton, all increments"),
            (newton.status_differences(history) as f64, "nodes"),
            0.0,
            "the solution is unique at this friction",
        ));
    }
}

/// Figures 15 and 16, and their largest differences as numbers.
fn figures(
    runs: &[(Method, Driver<2>, History)],
    (nested, exact, outer): (&Driver<2>, &Driver<2>, usize),
    outcome: &mut Outcome,
) -> Result<(), Box<dyn Error>> {
    let slips = |driver: &Driver<2>| -> Vec<[f64; 2]> {
        let slip =
            |c: &moreau::driver::ContactRecord<2>| [c.position[0], driver.displacement(c.node)[0]];
        driver.contacts().iter().map(slip).collect()
    };
    let reactions = |driver: &Driver<2>| along(driver.contacts(), NodeKind::Midside, |c| c.t[0]);
    let travel = digits(BLOCK_TRAVEL * outer as f64 / BLOCK_INCREMENTS as f64, 2);
    let style = |method| match method {
        Method::Newton => Style::Line,
        _ => Style::Points,
    };
    for (name, title, label, value) in [
        (
            "algorithms-slip",
            "Slip along the foundation",
            "slip [mm]",
            &slips as &dyn Fn(&Driver<2>) -> Vec<[f64; 2]>,
        ),
        (
            "algorithms-reactions",
            "Normal reactions at mid-side nodes",
            "normal reaction [N per mm]",
            &reactions,
        ),
    ] {
        let mut chart = Chart::new(title, "position along the foundation [mm]", label);
        for (method, driver, _) in runs {
            let name = format!("{}, 0.2 mm", method.name());
            chart = chart.with(name, style(*method), value(driver));
        }
        chart = chart
            .with(
                format!("semismooth Newton, {travel} mm"),
                Style::Line,
                value(exact),
            )
            .with(
                format!("Uzawa around, {travel} mm"),
                Style::Points,
                value(nested),
            );
        let figure = if name == "algorithms-slip" { 15 } else { 16 };
        let caption = format!(
            "{title}, μ = 0.1, for the paper's figure {figure}: all methods at 0.2 mm, and the \
             paper's nesting at {travel} mm, as far as it was run."
        );
        outcome
            .figures
            .push(Figure::new(name, caption, chart.to_svg()?));
    }
    let value = |method: Method| runs.iter().find(|r| r.0 == method).map(|r| &r.1);
    if let (Some(penalty), Some(uzawa)) = (value(Method::Penalty), value(Method::Uzawa)) {
        for (what, unit, a, b) in [
            ("slip", "mm", slips(penalty), slips(uzawa)),
            (
                "normal reaction at a mid-side node",
                "N/mm",
                reactions(penalty),
                reactions(uzawa),
            ),
        ] {
            let difference = a
                .iter()
                .zip(&b)
                .map(|(a, b)| (a[1] - b[1]).abs())
                .fold(0.0, f64::max);
            let largest = b.iter().map(|b| b[1].abs()).fold(0.0, f64::max);
            outcome.notes.push(format!(
                "Regularisation against Uzawa at 0.2 mm: largest difference of a {what} \
                 {difference:.3e} {unit}, of at most {largest:.6} {unit}."
            ));
        }
    }
    Ok(())
}

fn certificates(
    runs: &[(Method, Driver<2>, History)],
    nested: &History,
    outer: usize,
    outcome: &mut Outcome,
) {
    let mut rows: Vec<[String; 5]> = runs
        .iter()
        .map(|(method, _, history)| certificate_row(method.name(), history))
        .collect();
    let name = format!("Uzawa around the nonlinear solve, {outer} increments");
    rows.push(certificate_row(&name, nested));
    outcome
        .tables
        .push(certificate_table("algorithms-certificate", rows));
}

/// Figure 17.
fn times(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let outer = 3;
    (options.progress)("Uzawa around the nonlinear solve");
    let (_, nested, nested_seconds) = press([10, 2], nested(), outer)?;
    let mut rows = Vec::new();
    let mut ratios = Vec::new();
    for (cells, increments) in [
        ([10, 2], BLOCK_INCREMENTS),
        ([10, 2], outer),
        ([10, 6], BLOCK_INCREMENTS),
    ] {
        let count = cells[0] * cells[1];
        (options.progress)(&format!("times, {count} cells, {increments} increments"));
        let seconds = fastest(cells, increments, options.quick)?;
        for (method, time) in Method::ALL.into_iter().zip(seconds) {
            rows.push([
                method.name().into(),
                count.to_string(),
                increments.to_string(),
                scientific(time),
                digits(time / seconds[0], 2),
            ]);
        }
        if increments == BLOCK_INCREMENTS {
            ratios.push((count, seconds[1] / seconds[0]));
        } else {
            rows.push([
                "Uzawa around the nonlinear solve".into(),
                count.to_string(),
                increments.to_string(),
                scientific(nested_seconds),
                digits(nested_seconds / seconds[0], 0),
            ]);
            let solves: usize = nested.reports.iter().map(|r| r.nonlinear_solves).sum();
            outcome.notes.push(format!(
                "The paper's nesting was run over the first {outer} increments, to a travel of {} \
                 mm, at a residual of {OUTER_TOLERANCE:.0e} of the largest force: {solves} \
                 nonlinear solves, {:.0} times the time of regularisation over the same increments \
                 (the paper: 72 times over all). Beyond, near the limit load, the block answers a \
                 change of the contact forces ever more softly, and the number of solves per \
                 increment grows: {} in this order.",
                digits(BLOCK_TRAVEL * outer as f64 / BLOCK_INCREMENTS as f64, 2),
                nested_seconds / seconds[0],
                nested
                    .reports
                    .iter()
                    .map(|r| r.nonlinear_solves.to_string())
                    .collect::<Vec<_>>()
                    .join(", "),
            ));
        }
    }
    // A quick run is one of tests, with whatever else the processors do then: its times are shown, not judged.
    for (count, ratio) in ratios.into_iter().filter(|_| !options.quick) {
        let check = Check::at_most(
            format!("time of exact contact over that of the penalty, {count} cells"),
            (ratio, "1"),
            1.1,
            "exact contact at the price of penalty; fastest of several runs of both in turn",
        );
        outcome.checks.push(check.timed());
    }
    let header = [
        "method",
        "cells",
        "increments",
        "time [s]",
        "over regularisation",
    ];
    outcome.tables.push(Table::new(
        "algorithms-time",
        "Time, for the paper's figure 17 (regularisation 25 s, Uzawa 30 min: ratio 72)",
        header,
        rows,
    ));
    Ok(outcome)
}
