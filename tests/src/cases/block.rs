//! Paper 8.2: the punched block on a rigid foundation with friction, by the exact method; figures
//! 9 to 11, and two variants in which points stick, slip back and open.

use super::compare::{
    History, INDEPENDENT, along, digits, final_state_checks, largest_difference, record, scientific,
};
use crate::paper::{
    BLOCK_INCREMENTS, BLOCK_TRAVEL, block, block_punch_load, block_step, reference,
};
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
use moreau::driver::{Driver, Settings};
use moreau::laws::Status;
use moreau::mesh::{Integration, NodeKind};
use moreau::plot::{Chart, MeshPicture, Style, nodal_average};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "block",
    chapter: Chapter::Paper,
    title: "Punched block with Coulomb friction (paper 8.2, figures 9–11)",
    description: "Half of a steel block, 50 mm × 20 mm, on a rigid foundation with Coulomb \
        friction, punched by 0.2 mm over half of its top in 20 increments; elastic perfectly \
        plastic, plane strain. Loads, nodal reactions, slips and statuses of the exact method are \
        compared with an independent implementation digit by digit. With the paper's friction \
        nearly all points slip forward, so two variants follow: a friction of 0.3, where points \
        stick, and a withdrawal of the punch, where they stick, slip back and open.",
    run,
};

const COARSE: [usize; 2] = [10, 2];

/// A run over the whole travel.
fn press(
    cells: [usize; 2],
    friction: f64,
    integration: Integration,
) -> Result<(Driver<2>, History), Box<dyn Error>> {
    let mut driver = block(cells, friction, integration, Settings::default())?;
    let mut history = History::default();
    let step = block_step(BLOCK_TRAVEL);
    record(
        &mut driver,
        &step,
        BLOCK_INCREMENTS,
        block_punch_load,
        &mut history,
    )?;
    Ok((driver, history))
}

/// Withdraws the punch by 0.005 mm per increment.
fn withdraw(
    driver: &mut Driver<2>,
    increments: usize,
    history: &mut History,
) -> Result<(), Box<dyn Error>> {
    let step = block_step(BLOCK_TRAVEL - 0.005 * increments as f64);
    record(driver, &step, increments, block_punch_load, history)?;
    Ok(())
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut rows = Vec::new();
    let runs: [(f64, Integration, Option<&str>); 4] = [
        (0.05, Integration::Reduced, Some("B_mesh20_g2_mu0.05_exact")),
        (0.1, Integration::Reduced, Some("B_mesh20_g2_mu0.1_exact")),
        (0.1, Integration::Full, Some("B_mesh20_g3_mu0.1_exact")),
        (0.05, Integration::Full, None),
    ];
    let mut chart = Chart::new(
        "Load of the punch",
        "travel of the punch [mm]",
        "load on the half [N per mm]",
    );
    for (friction, integration, file) in runs {
        let rule = if integration == Integration::Reduced {
            "2×2"
        } else {
            "3×3"
        };
        let what = format!("20 cells, {rule}, μ = {friction}");
        (options.progress)(&what);
        let (driver, history) = press(COARSE, friction, integration)?;
        match file {
            Some(file) => {
                let loads = reference::column(&format!("{file}_load"), "P_half_N");
                let tangential = reference::column(&format!("{file}_load"), "sum_tt_N");
                let sums: Vec<f64> = history
                    .contacts
                    .iter()
                    .map(|c| c.iter().map(|c| c.force[0]).sum::<f64>())
                    .collect();
                for (name, computed, expected) in [
                    ("load after every increment", &history.loads, &loads),
                    (
                        "sum of friction forces after every increment",
                        &sums,
                        &tangential,
                    ),
                ] {
                    outcome.checks.push(Check::new(
                        format!("{what}: {name}, largest relative difference"),
                        (largest_difference(computed, expected), "1"),
                        Kind::AtMost,
                        (1e-8, 0.0),
                        INDEPENDENT,
                    ));
                }
                let open = reference::column(&format!("{file}_load"), "n_open");
                let stick = reference::column(&format!("{file}_load"), "n_stick");
                let slip = reference::column(&format!("{file}_load"), "n_slip");
                let counts = |f: fn(&moreau::driver::StepReport) -> usize, expected: &[f64]| {
                    let pairs = history.reports.iter().zip(expected);
                    pairs.filter(|(r, e)| f(r) as f64 != **e).count()
                };
                let wrong = counts(|r| r.open, &open)
                    + counts(|r| r.stick, &stick)
                    + counts(|r| r.slip, &slip);
                outcome.checks.push(Check::new(
                    format!("{what}: increments whose numbers of open, stick, slip differ"),
                    (wrong as f64, "increments"),
                    Kind::AtMost,
                    (0.0, 0.0),
                    INDEPENDENT,
                ));
                outcome.checks.extend(final_state_checks(
                    &what,
                    &driver,
                    &format!("{file}_contact_final"),
                ));
            }
            None => {
                let expected = [3413.817975, 9522.655431, 10227.39011, 10321.20061];
                let computed = [1, 3, 10, 20].map(|i| history.loads[i - 1]);
                outcome.checks.push(Check::new(
                    format!("{what}: load at 0.01, 0.03, 0.10, 0.20 mm, largest difference"),
                    (largest_difference(&computed, &expected), "1"),
                    Kind::AtMost,
                    (1e-8, 0.0),
                    INDEPENDENT,
                ));
            }
        }
        outcome.checks.extend(consistency(&what, &driver, &history));
        rows.push(row(&what, &driver, &history));
        let travel = |i: usize| (i + 1) as f64 * BLOCK_TRAVEL / BLOCK_INCREMENTS as f64;
        let points = history
            .loads
            .iter()
            .enumerate()
            .map(|(i, &p)| [travel(i), p]);
        let style = if integration == Integration::Full {
            Style::Dashed
        } else {
            Style::Line
        };
        let curve: Vec<[f64; 2]> = std::iter::once([0.0, 0.0]).chain(points).collect();
        chart = chart.with(&what, style, curve);
        if friction == 0.1 && integration == Integration::Reduced {
            outcome.figures.extend(pictures(&driver)?);
        }
    }
    outcome.figures.insert(
        1,
        Figure {
            name: "block-load".into(),
            caption: "Load against travel of the punch, half of the block.".into(),
            svg: chart.to_svg()?,
        },
    );
    for (cells, integration, expected) in [
        ([10, 4], Integration::Reduced, 10445.77305),
        ([10, 4], Integration::Full, 10702.96046),
    ] {
        let rule = if integration == Integration::Reduced {
            "2×2"
        } else {
            "3×3"
        };
        let what = format!("40 cells, {rule}, μ = 0.1");
        (options.progress)(&what);
        let (driver, history) = press(cells, 0.1, integration)?;
        outcome.checks.push(Check::new(
            format!("{what}: load at 0.2 mm"),
            (history.last_load(), "N/mm"),
            Kind::Relative,
            (expected, 1e-8),
            INDEPENDENT,
        ));
        rows.push(row(&what, &driver, &history));
    }
    rows.push(stick(options, &mut outcome)?);
    unload(options, &mut outcome, &mut rows)?;
    outcome.tables.push(Table {
        name: "block-runs".into(),
        title: "Runs of the exact method".into(),
        header: [
            "run",
            "load at the end [N/mm]",
            "Σ t_n [N/mm]",
            "Σ t_t [N/mm]",
            "open",
            "stick",
            "slip",
            "Newton iterations",
            "largest gap over work",
        ]
        .map(Into::into)
        .to_vec(),
        rows,
    });
    Ok(outcome)
}

/// What holds for any code on this problem: sums, cone, slip against friction, certificate.
fn consistency(what: &str, driver: &Driver<2>, history: &History) -> Vec<Check> {
    let sum: f64 = driver.contacts().iter().map(|c| c.t[0]).sum();
    let load = history.last_load();
    let contacts = || history.contacts.iter().flatten();
    let largest = contacts().map(|c| c.t[0]).fold(0.0, f64::max);
    let pull = contacts().map(|c| -c.t[0]).fold(0.0, f64::max);
    // Power of friction on the body, which must not be positive.
    let wrong_way = contacts()
        .filter(|c| c.status == Status::Slip && c.t[1] * c.u[1] > 0.0)
        .count();
    vec![
        Check::new(
            format!("{what}: Σ t_n against the load of the punch"),
            (sum, "N/mm"),
            Kind::Relative,
            (load, 1e-8),
            "equilibrium",
        ),
        Check::new(
            format!("{what}: largest tension at a contact over the largest pressure"),
            (pull / largest, "1"),
            Kind::AtMost,
            (1e-12, 0.0),
            "unilateral contact [11]",
        ),
        Check::new(
            format!("{what}: slips along their friction force"),
            (wrong_way as f64, "nodes"),
            Kind::AtMost,
            (0.0, 0.0),
            "Coulomb [35]",
        ),
        Check::new(
            format!("{what}: largest bipotential gap over the external work"),
            (history.largest_gap(), "1"),
            Kind::AtMost,
            (1e-10, 0.0),
            "zero exactly at the law, [39]",
        ),
    ]
}

fn row(what: &str, driver: &Driver<2>, history: &History) -> Vec<String> {
    let sum = |k: usize| driver.contacts().iter().map(|c| c.t[k]).sum::<f64>();
    let (open, stick, slip) = history
        .reports
        .last()
        .map_or((0, 0, 0), |r| (r.open, r.stick, r.slip));
    vec![
        what.into(),
        digits(history.last_load(), 4),
        digits(sum(0), 4),
        digits(sum(1), 4),
        open.to_string(),
        stick.to_string(),
        slip.to_string(),
        history.newton_iterations().to_string(),
        scientific(history.largest_gap()),
    ]
}

/// Friction 0.3: points near the axis stick at every increment.
fn stick(options: &Options<'_>, outcome: &mut Outcome) -> Result<Vec<String>, Box<dyn Error>> {
    let what = "20 cells, 2×2, μ = 0.3";
    (options.progress)(what);
    let (driver, history) = press(COARSE, 0.3, Integration::Reduced)?;
    outcome.checks.push(Check::new(
        format!("{what}: load at 0.2 mm"),
        (history.last_load(), "N/mm"),
        Kind::Relative,
        (12146.47534, 1e-8),
        INDEPENDENT,
    ));
    let all = |r: &&moreau::driver::StepReport| r.open > 0 && r.stick > 0 && r.slip > 0;
    outcome.checks.push(Check::new(
        format!("{what}: increments with open, sticking and slipping points"),
        (
            history.reports.iter().filter(all).count() as f64,
            "increments",
        ),
        Kind::AtLeast,
        (BLOCK_INCREMENTS as f64, 0.0),
        "the variant was made for it",
    ));
    outcome.checks.extend(consistency(what, &driver, &history));
    Ok(row(what, &driver, &history))
}

/// The punch is withdrawn by three times 0.005 mm.
fn unload(
    options: &Options<'_>,
    outcome: &mut Outcome,
    rows: &mut Vec<Vec<String>>,
) -> Result<(), Box<dyn Error>> {
    let expected = [
        (0.05, Integration::Reduced, None),
        (
            0.1,
            Integration::Reduced,
            Some([8673.464198, 6829.878162, 5070.747493]),
        ),
        (
            0.1,
            Integration::Full,
            Some([8852.84126, 6993.521185, 5245.092925]),
        ),
    ];
    let mut chart = Chart::new(
        "Slip of the last increment",
        "position along the foundation [mm]",
        "slip increment [mm]",
    );
    for (friction, integration, loads) in expected {
        let rule = if integration == Integration::Reduced {
            "2×2"
        } else {
            "3×3"
        };
        let what = format!("20 cells, {rule}, μ = {friction}, withdrawn 0.015 mm");
        (options.progress)(&what);
        let (mut driver, mut history) = press(COARSE, friction, integration)?;
        withdraw(&mut driver, 3, &mut history)?;
        if let Some(loads) = loads {
            outcome.checks.push(Check::new(
                format!("{what}: loads while withdrawn, largest relative difference"),
                (
                    largest_difference(&history.loads[BLOCK_INCREMENTS..], &loads),
                    "1",
                ),
                Kind::AtMost,
                (1e-8, 0.0),
                INDEPENDENT,
            ));
        }
        if friction == 0.1 && integration == Integration::Reduced {
            let file = "B_mesh20_g2_mu0.1_unload_exact";
            let expected = reference::column(&format!("{file}_load"), "P_half_N");
            outcome.checks.push(Check::new(
                format!("{what}: loads of all increments, largest relative difference"),
                (largest_difference(&history.loads, &expected), "1"),
                Kind::AtMost,
                (1e-8, 0.0),
                INDEPENDENT,
            ));
            let file = format!("{file}_contact_final");
            outcome
                .checks
                .extend(final_state_checks(&what, &driver, &file));
        }
        let last = &history.contacts[BLOCK_INCREMENTS..];
        let seen = |wanted: &dyn Fn(&moreau::driver::ContactRecord<2>) -> bool| {
            last.iter()
                .flatten()
                .filter(|c| !c.held && wanted(c))
                .count() as f64
        };
        for (name, count) in [
            (
                "forward slip",
                seen(&|c| c.status == Status::Slip && c.u[1] > 0.0),
            ),
            (
                "reverse slip",
                seen(&|c| c.status == Status::Slip && c.u[1] < 0.0),
            ),
            ("stick", seen(&|c| c.status == Status::Stick)),
            ("release", seen(&|c| c.status == Status::Open)),
        ] {
            outcome.checks.push(Check::new(
                format!("{what}: points and increments with {name}"),
                (count, "points"),
                Kind::AtLeast,
                (1.0, 0.0),
                "the variant was made for it",
            ));
        }
        if integration == Integration::Reduced {
            let points: Vec<[f64; 2]> = history
                .last_contacts()
                .iter()
                .map(|c| [c.position[0], c.u[1]])
                .collect();
            chart = chart.with(format!("μ = {friction}"), Style::LinePoints, points);
        }
        outcome.checks.extend(consistency(&what, &driver, &history));
        rows.push(row(&what, &driver, &history));
    }
    outcome.figures.push(Figure {
        name: "block-unload-slip".into(),
        caption: "Slip along the foundation in the last of three increments in which the punch is \
            withdrawn: points near the axis stick, those further out slip back, with less \
            friction sooner; beyond 32 mm the block hangs free."
            .into(),
        svg: chart.to_svg()?,
    });
    Ok(())
}

fn pictures(driver: &Driver<2>) -> Result<Vec<Figure>, Box<dyn Error>> {
    let nodes = 0..driver.mesh().nodes().len();
    let displacement = nodes.map(|a| driver.displacement(a).into()).collect();
    let p = nodal_average(driver.mesh(), &driver.points(), |s| s.plastic_strain);
    let deformed = MeshPicture::new(
        driver.mesh(),
        "Equivalent plastic strain at 0.2 mm, μ = 0.1",
    )
    .deformed(displacement, 10.0)
    .field("equivalent plastic strain p [–]", p)
    .outline();
    let reactions = |kind| along(driver.contacts(), kind, |c| c.t[0]);
    let chart = Chart::new(
        "Nodal reactions, μ = 0.1",
        "position along the foundation [mm]",
        "normal reaction [N per mm]",
    )
    .with(
        "corner nodes",
        Style::LinePoints,
        reactions(NodeKind::Corner),
    )
    .with(
        "mid-side nodes",
        Style::LinePoints,
        reactions(NodeKind::Midside),
    );
    Ok(vec![
        Figure {
            name: "block-mesh".into(),
            caption: "The mesh of 20 eight-node cells, for the paper's figure 11.".into(),
            svg: MeshPicture::new(driver.mesh(), "20 eight-node cells").to_svg()?,
        },
        Figure {
            name: "block-plastic-strain".into(),
            caption: "Deformed block (displacements ten times enlarged) with the equivalent \
                plastic strain."
                .into(),
            svg: deformed.to_svg()?,
        },
        Figure {
            name: "block-reactions".into(),
            caption: "Normal reactions at 0.2 mm, corner and mid-side nodes apart: a uniform \
                pressure on a quadratic edge gives them in the ratio of one to two, so the zig-zag \
                of the nodes taken together is no oscillation of the pressure."
                .into(),
            svg: chart.to_svg()?,
        },
    ])
}
