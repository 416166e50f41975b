//! Paper 8.2.1: the range of penalty factors; figures 12 to 14.

use super::compare::{History, along, digits, record, scientific};
use crate::paper::{BLOCK_INCREMENTS, BLOCK_TRAVEL, block, block_punch_load, block_step};
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
use moreau::contact::{ContactSolver, Penalty, SemismoothNewton};
use moreau::driver::Settings;
use moreau::mesh::{Integration, NodeKind};
use moreau::plot::{Chart, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "penalty",
    chapter: Chapter::Paper,
    title: "Convergence of the penalty method (paper 8.2.1, figures 12–14)",
    description: "The punched block with a friction of 0.05 under the penalty method, equal \
        factors normal and tangential, from 10² to 10¹⁶ N/mm, on meshes of 20, 40 and 60 cells. \
        The paper's method converged in a window that narrowed with the mesh (10⁸–10¹⁵, 10⁶–10¹², \
        10⁵–10⁸). Here every factor converges, on every mesh, because the penalty is a spring in \
        series with the exact law and not a stiffness that multiplies rounding; a small factor \
        converges to a useless answer. The error against exact contact falls as 1/k.",
    run,
};

const FRICTION: f64 = 0.05;

/// Powers of ten of the penalty factors \[N/mm\].
const POWERS: std::ops::RangeInclusive<i32> = 2..=16;

/// Relative error of the largest normal force and of the largest slip at some factors, 20 cells,
/// from the independent implementation.
const EXPECTED: [(i32, f64, f64); 4] = [
    (4, 0.3004197921, 0.2967087658),
    (6, 0.02036686046, 0.004628655431),
    (8, 2.298100178e-4, 4.498070281e-5),
    (10, 2.300837976e-6, 4.499446628e-7),
];

/// Displacements of the contact points, and the history.
type Pressed = (Vec<[f64; 2]>, History);

fn press(
    cells: [usize; 2],
    friction: f64,
    contact: Box<dyn ContactSolver<2>>,
) -> Result<Pressed, Box<dyn Error>> {
    let settings = Settings {
        contact,
        ..Settings::default()
    };
    let mut driver = block(cells, friction, Integration::Reduced, settings)?;
    let mut history = History::default();
    let step = block_step(BLOCK_TRAVEL);
    record(
        &mut driver,
        &step,
        BLOCK_INCREMENTS,
        block_punch_load,
        &mut history,
    )?;
    let slips = driver
        .contacts()
        .iter()
        .map(|c| driver.displacement(c.node).into())
        .collect();
    Ok((slips, history))
}

/// Largest difference over the largest value.
fn error(computed: impl Iterator<Item = f64>, exact: impl Iterator<Item = f64> + Clone) -> f64 {
    let largest = exact.clone().map(f64::abs).fold(0.0, f64::max);
    computed
        .zip(exact)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
        / largest
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let meshes: &[(usize, &str)] = &[(2, "10⁸ to 10¹⁵"), (4, "10⁶ to 10¹²"), (6, "10⁵ to 10⁸")];
    let meshes = if options.quick { &meshes[..1] } else { meshes };
    let mut errors = Chart::new(
        "Error of the penalty method",
        "penalty factor k [N/mm]",
        "largest error of a normal force, over the largest",
    )
    .log_x()
    .log_y();
    let mut ranges = Vec::new();
    let mut sweep = Vec::new();
    for &(rows, paper) in meshes {
        let cells = [10, rows];
        let count = 10 * rows;
        let (exact_slips, exact) = press(cells, FRICTION, Box::new(SemismoothNewton::default()))?;
        let mut curve = Vec::new();
        let mut converged = Vec::new();
        let mut corners = Chart::new(
            "Normal reactions at corner nodes",
            "position along the foundation [mm]",
            "normal reaction [N per mm]",
        );
        let mut midsides = Chart {
            title: "Normal reactions at mid-side nodes".into(),
            ..corners.clone()
        };
        for power in POWERS {
            (options.progress)(&format!("{count} cells, k = 1e{power} N/mm"));
            let k = 10f64.powi(power);
            let Ok((slips, history)) = press(cells, FRICTION, Box::new(Penalty::new(k, k)?)) else {
                continue;
            };
            converged.push(power);
            let normal = |h: &History| h.last_contacts().iter().map(|c| c.t[0]).collect::<Vec<_>>();
            let force = error(normal(&history).into_iter(), normal(&exact).into_iter());
            let slip = error(slips.iter().map(|u| u[0]), exact_slips.iter().map(|u| u[0]));
            curve.push([k, force]);
            sweep.push(vec![
                count.to_string(),
                format!("1e{power}"),
                digits(history.last_load(), 5),
                scientific(history.last_load() / exact.last_load() - 1.0),
                scientific(force),
                scientific(slip),
                scientific(history.largest_penetration()),
                history.newton_iterations().to_string(),
            ]);
            let expected = EXPECTED.iter().find(|e| e.0 == power && rows == 2);
            if let Some(&(_, expected_force, expected_slip)) = expected {
                for (what, value, reference) in [
                    ("normal force", force, expected_force),
                    ("slip", slip, expected_slip),
                ] {
                    outcome.checks.push(Check::new(
                        format!("{count} cells, k = 1e{power}: error of the {what}"),
                        (value, "1"),
                        Kind::Relative,
                        (reference, 1e-5),
                        "independent implementation of the penalty law",
                    ));
                }
            }
            if [3, 4, 5, 6, 8].contains(&power) {
                let name = format!("k = 1e{power} N/mm");
                let of = |kind| along(history.last_contacts(), kind, |c| c.t[0]);
                corners = corners.with(&name, Style::LinePoints, of(NodeKind::Corner));
                midsides = midsides.with(&name, Style::LinePoints, of(NodeKind::Midside));
            }
        }
        if rows == 2 {
            let of = |kind| along(exact.last_contacts(), kind, |c| c.t[0]);
            corners = corners.with("exact", Style::Dashed, of(NodeKind::Corner));
            midsides = midsides.with("exact", Style::Dashed, of(NodeKind::Midside));
            for (name, chart, figure, where_) in [
                ("penalty-corners", corners, 12, "corner"),
                ("penalty-midsides", midsides, 13, "mid-side"),
            ] {
                outcome.figures.push(Figure {
                    name: name.into(),
                    caption: format!(
                        "Normal reactions at {where_} nodes for several penalty factors, 20 cells, \
                         for the paper's figure {figure}. At 10⁶ N/mm the \
                         largest error is 2 %, at 10⁸ the curve lies on the exact one."
                    ),
                    svg: chart.to_svg()?,
                });
            }
        }
        outcome.checks.push(Check::new(
            format!("{count} cells: penalty factors from 1e2 to 1e16 that converge"),
            (converged.len() as f64, "factors"),
            Kind::AtLeast,
            (POWERS.count() as f64, 0.0),
            "the law holds for every k",
        ));
        // Between 1e7 and 1e12 neither the nonlinearity nor rounding disturbs the rate.
        let at = |power: i32| {
            curve
                .iter()
                .find(|p| p[0] == 10f64.powi(power))
                .map(|p| p[1])
        };
        if let (Some(low), Some(high)) = (at(7), at(12)) {
            outcome.checks.push(Check::new(
                format!("{count} cells: order of the error in 1/k, from 1e7 to 1e12"),
                ((low / high).log10() / 5.0, "1"),
                Kind::Absolute,
                (1.0, 0.02),
                "inf-convolution [82]: the springs are in series with the exact law",
            ));
        }
        let range = |list: &[i32]| match (list.first(), list.last()) {
            (Some(a), Some(b)) => format!("1e{a} to 1e{b}"),
            _ => "none".into(),
        };
        let good: Vec<i32> = POWERS
            .filter(|&p| at(p).is_some_and(|e| e < 1e-2))
            .collect();
        ranges.push(vec![
            format!("{count} cells"),
            paper.into(),
            range(&converged),
            range(&good),
        ]);
        errors = errors.with(format!("{count} cells"), Style::LinePoints, curve);
    }
    outcome.figures.push(Figure {
        name: "penalty-error".into(),
        caption: "Error of the normal forces against exact contact, at the end of the press: it \
            falls as 1/k down to rounding, on every mesh."
            .into(),
        svg: errors.to_svg()?,
    });
    outcome.tables.push(Table {
        name: "penalty-range".into(),
        title: "Penalty factors that converge [N/mm], for the paper's figure 14".into(),
        header: ["mesh", "paper", "here", "here with an error below 1 %"]
            .map(Into::into)
            .to_vec(),
        rows: ranges,
    });
    outcome.tables.push(Table {
        name: "penalty-sweep".into(),
        title: "Penalty against exact contact, μ = 0.05".into(),
        header: [
            "cells",
            "k [N/mm]",
            "load [N/mm]",
            "relative error of the load",
            "of the normal forces",
            "of the slips",
            "largest penetration [mm]",
            "Newton iterations",
        ]
        .map(Into::into)
        .to_vec(),
        rows: sweep,
    });
    more_friction(options, &mut outcome)?;
    Ok(outcome)
}

/// A friction of 0.05 flatters a code, because hardly a point sticks: the range again with more.
fn more_friction(options: &Options<'_>, outcome: &mut Outcome) -> Result<(), Box<dyn Error>> {
    for friction in [0.1, 0.3] {
        let mut converged = 0;
        for power in POWERS {
            (options.progress)(&format!("20 cells, μ = {friction}, k = 1e{power} N/mm"));
            let k = 10f64.powi(power);
            converged +=
                usize::from(press([10, 2], friction, Box::new(Penalty::new(k, k)?)).is_ok());
        }
        outcome.checks.push(Check::new(
            format!("20 cells, μ = {friction}: penalty factors from 1e2 to 1e16 that converge"),
            (converged as f64, "factors"),
            Kind::AtLeast,
            (POWERS.count() as f64, 0.0),
            "the law holds for every k",
        ));
    }
    Ok(())
}
