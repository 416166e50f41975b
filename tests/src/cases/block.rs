//! Paper 8.2: the punched block on a rigid foundation with friction, by the exact method; figures
//! 9 to 11, and two variants in which points stick, slip back and open.

use super::compare::{
    History, INDEPENDENT, column_check, digits, final_state_checks, gap_check, press_block,
    quadrature, record, scientific,
};
use super::pictures::{along, deformed};
use crate::paper::{BLOCK_INCREMENTS, BLOCK_TRAVEL, block_punch_load, block_step, reference};
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::driver::{ContactRecord, Driver, IncrementReport, Settings};
use moreau::laws::Status;
use moreau::mesh::{Integration, NodeKind};
use moreau::plot::{Chart, MeshPicture, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "block",
    long: false,
    alone: false,
    chapter: Chapter::Paper,
    title: "Punched block with Coulomb friction (paper 8.2, figures 9–11)",
    description: "Half of a steel block, 50 mm × 20 mm, on a rigid foundation with Coulomb \
        friction, punched by 0.2 mm over half of its top in 20 increments; elastic perfectly \
        plastic, plane strain. Loads, nodal reactions, slips and statuses of the exact method are \
        compared with an independent implementation digit by digit. With the paper's friction \
        nearly all points slip forward, so two variants follow: a friction of 0.3, where points \
        stick, and a withdrawal of the punch, where they stick, slip back and open.",
    decks: &["examples/punched-block.toml", "gallery/punched-block.py"],
    run,
};

const COARSE: [usize; 2] = [10, 2];
const MADE_FOR: &str = "the variant was made for it";

/// One press of the block; withdrawn afterwards or not.
struct Press {
    what: String,
    driver: Driver<2>,
    history: History,
}

impl Press {
    /// Presses over the whole travel, and withdraws the punch by `withdrawn` times 0.005 mm.
    fn run(
        options: &Options<'_>,
        cells: [usize; 2],
        friction: f64,
        integration: Integration,
        withdrawn: usize,
    ) -> Result<Self, Box<dyn Error>> {
        let count = cells[0] * cells[1];
        let mut what = format!("{count} cells, {}, μ = {friction}", quadrature(integration));
        let back = 0.005 * withdrawn as f64;
        if withdrawn > 0 {
            what = format!("{what}, withdrawn {back} mm");
        }
        (options.progress)(&what);
        let (mut driver, mut history) =
            press_block(cells, friction, integration, Settings::default())?;
        if withdrawn > 0 {
            let step = block_step(BLOCK_TRAVEL - back);
            record(
                &mut driver,
                &step,
                withdrawn,
                block_punch_load,
                &mut history,
            )?;
        }
        Ok(Self {
            what,
            driver,
            history,
        })
    }

    /// Row of the table of all runs.
    fn row(&self) -> [String; 9] {
        let sum = |k: usize| self.driver.contacts().iter().map(|c| c.t[k]).sum::<f64>();
        let (open, stick, slip) = self
            .history
            .reports
            .last()
            .map_or((0, 0, 0), |r| (r.open, r.stick, r.slip));
        [
            self.what.clone(),
            digits(self.history.last_load(), 4),
            digits(sum(0), 4),
            digits(sum(1), 4),
            open.to_string(),
            stick.to_string(),
            slip.to_string(),
            self.history.newton_iterations().to_string(),
            scientific(self.history.largest_gap()),
        ]
    }

    /// Check of the load at the end.
    fn load(&self, expected: f64) -> Check {
        Check::relative(
            format!("{}: load at 0.2 mm", self.what),
            (self.history.last_load(), "N/mm"),
            (expected, 1e-8),
            INDEPENDENT,
        )
    }

    /// Checks of every increment, and of the final state, against files of the independent
    /// implementation.
    fn against_files(&self, file: &str) -> Vec<Check> {
        let (what, history) = (&self.what, &self.history);
        let column = |name: &str| reference::column(&format!("{file}_load"), name);
        let friction = history.contacts.iter();
        let friction: Vec<f64> = friction
            .map(|c| c.iter().map(|c| c.force[0]).sum())
            .collect();
        let wrong = |name: &str, count: fn(&IncrementReport) -> usize| {
            let expected = column(name);
            let pairs = history.reports.iter().zip(&expected);
            pairs.filter(|(r, e)| count(r) as f64 != **e).count()
        };
        let wrong = wrong("n_open", |r| r.open)
            + wrong("n_stick", |r| r.stick)
            + wrong("n_slip", |r| r.slip);
        let each = "after every increment, largest relative difference";
        let mut checks = vec![
            column_check(
                format!("{what}: load {each}"),
                &history.loads,
                &column("P_half_N"),
            ),
            column_check(
                format!("{what}: sum of friction forces {each}"),
                &friction,
                &column("sum_tt_N"),
            ),
            Check::at_most(
                format!("{what}: increments whose numbers of open, stick, slip differ"),
                (wrong as f64, "increments"),
                0.0,
                INDEPENDENT,
            ),
        ];
        checks.extend(self.final_state(file));
        checks
    }

    /// Checks of the final state against a file of the independent implementation.
    fn final_state(&self, file: &str) -> Vec<Check> {
        final_state_checks(&self.what, &self.driver, &format!("{file}_contact_final"))
    }

    /// What holds for any code on this problem: sums, cone, slip against friction, certificate.
    fn consistency(&self) -> Vec<Check> {
        let (what, history) = (&self.what, &self.history);
        let sum: f64 = self.driver.contacts().iter().map(|c| c.t[0]).sum();
        let contacts = || history.contacts.iter().flatten();
        let largest = contacts().map(|c| c.t[0]).fold(0.0, f64::max);
        let pull = contacts().map(|c| -c.t[0]).fold(0.0, f64::max);
        // Power of friction on the body, which must not be positive.
        let wrong_way = contacts()
            .filter(|c| c.status == Status::Slip && c.t[1] * c.u[1] > 0.0)
            .count();
        vec![
            Check::relative(
                format!("{what}: Σ t_n against the load of the punch"),
                (sum, "N/mm"),
                (history.last_load(), 1e-8),
                "equilibrium",
            ),
            Check::at_most(
                format!("{what}: largest tension at a contact over the largest pressure"),
                (pull / largest, "1"),
                1e-12,
                "unilateral contact [11]",
            ),
            Check::at_most(
                format!("{what}: slips along their friction force"),
                (wrong_way as f64, "nodes"),
                0.0,
                "Coulomb [35]",
            ),
            gap_check(what, history),
        ]
    }
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut rows = paths(options, &mut outcome)?;
    rows.extend(finer(options, &mut outcome)?);
    rows.push(stick(options, &mut outcome)?);
    rows.extend(unload(options, &mut outcome)?);
    let header = [
        "run",
        "load at the end [N/mm]",
        "Σ t_n [N/mm]",
        "Σ t_t [N/mm]",
        "open",
        "stick",
        "slip",
        "Newton iterations",
        "largest gap over work",
    ];
    let title = "Runs of the exact method";
    outcome
        .tables
        .push(Table::new("block-runs", title, header, rows));
    Ok(outcome)
}

/// The paper's mesh under both frictions and both rules, every increment.
fn paths(options: &Options<'_>, outcome: &mut Outcome) -> Result<Vec<[String; 9]>, Box<dyn Error>> {
    let mut chart = Chart::new(
        "Load of the punch",
        "travel of the punch [mm]",
        "load on the half [N per mm]",
    );
    let mut rows = Vec::new();
    let mut shown = None;
    for (friction, integration, file) in [
        (0.05, Integration::Reduced, Some("B_mesh20_g2_mu0.05_exact")),
        (0.1, Integration::Reduced, Some("B_mesh20_g2_mu0.1_exact")),
        (0.1, Integration::Full, Some("B_mesh20_g3_mu0.1_exact")),
        (0.05, Integration::Full, None),
    ] {
        let press = Press::run(options, COARSE, friction, integration, 0)?;
        match file {
            Some(file) => outcome.checks.extend(press.against_files(file)),
            None => outcome.checks.push(column_check(
                format!(
                    "{}: load at 0.01, 0.03, 0.10, 0.20 mm, largest difference",
                    press.what
                ),
                &[1, 3, 10, 20].map(|i| press.history.loads[i - 1]),
                &[3413.817975, 9522.655431, 10227.39011, 10321.20061],
            )),
        }
        outcome.checks.extend(press.consistency());
        rows.push(press.row());
        let style = if integration == Integration::Full {
            Style::Dashed
        } else {
            Style::Line
        };
        chart = chart.with(&press.what, style, press.history.path(BLOCK_TRAVEL));
        if friction == 0.1 && integration == Integration::Reduced {
            shown = Some(press.driver);
        }
    }
    if let Some(driver) = shown {
        outcome.figures.extend(pictures(&driver, &chart)?);
    }
    Ok(rows)
}

/// Loads on a mesh of smaller cells.
fn finer(options: &Options<'_>, outcome: &mut Outcome) -> Result<Vec<[String; 9]>, Box<dyn Error>> {
    let mut rows = Vec::new();
    for (integration, expected) in [
        (Integration::Reduced, 10445.77305),
        (Integration::Full, 10702.96046),
    ] {
        let press = Press::run(options, [10, 4], 0.1, integration, 0)?;
        outcome.checks.push(press.load(expected));
        rows.push(press.row());
    }
    Ok(rows)
}

/// Friction 0.3: points near the axis stick at every increment.
fn stick(options: &Options<'_>, outcome: &mut Outcome) -> Result<[String; 9], Box<dyn Error>> {
    let press = Press::run(options, COARSE, 0.3, Integration::Reduced, 0)?;
    outcome.checks.push(press.load(12146.47534));
    let all = |r: &&IncrementReport| r.open > 0 && r.stick > 0 && r.slip > 0;
    let seen = press.history.reports.iter().filter(all).count();
    outcome.checks.push(Check::at_least(
        format!(
            "{}: increments with open, sticking and slipping points",
            press.what
        ),
        (seen as f64, "increments"),
        BLOCK_INCREMENTS as f64,
        MADE_FOR,
    ));
    outcome.checks.extend(press.consistency());
    Ok(press.row())
}

/// The punch is withdrawn by three times 0.005 mm.
fn unload(
    options: &Options<'_>,
    outcome: &mut Outcome,
) -> Result<Vec<[String; 9]>, Box<dyn Error>> {
    let mut chart = Chart::new(
        "Slip of the last increment",
        "position along the foundation [mm]",
        "slip increment [mm]",
    );
    let mut rows = Vec::new();
    let reduced = [8673.464198, 6829.878162, 5070.747493];
    let full = [8852.84126, 6993.521185, 5245.092925];
    for (friction, integration, loads) in [
        (0.05, Integration::Reduced, None),
        (0.1, Integration::Reduced, Some(reduced)),
        (0.1, Integration::Full, Some(full)),
    ] {
        let press = Press::run(options, COARSE, friction, integration, 3)?;
        if let Some(loads) = loads {
            outcome.checks.push(column_check(
                format!(
                    "{}: loads while withdrawn, largest relative difference",
                    press.what
                ),
                &press.history.loads[BLOCK_INCREMENTS..],
                &loads,
            ));
        }
        if friction == 0.1 && integration == Integration::Reduced {
            let file = "B_mesh20_g2_mu0.1_unload_exact";
            outcome.checks.push(column_check(
                format!(
                    "{}: loads of all increments, largest relative difference",
                    press.what
                ),
                &press.history.loads,
                &reference::column(&format!("{file}_load"), "P_half_N"),
            ));
            outcome.checks.extend(press.final_state(file));
        }
        outcome.checks.extend(statuses_met(&press));
        if integration == Integration::Reduced {
            let contacts = press.history.last_contacts().iter();
            let slips: Vec<[f64; 2]> = contacts.map(|c| [c.position[0], c.u[1]]).collect();
            chart = chart.with(format!("μ = {friction}"), Style::LinePoints, slips);
        }
        outcome.checks.extend(press.consistency());
        rows.push(press.row());
    }
    outcome.figures.push(Figure::new(
        "block-unload-slip",
        "Slip along the foundation in the last of three increments in which the punch is \
            withdrawn: points near the axis stick, those further out slip back, with less \
            friction sooner; beyond 32 mm the block hangs free.",
        chart.to_svg()?,
    ));
    Ok(rows)
}

/// Checks that every status and both directions of slip are met while the punch is withdrawn.
fn statuses_met(press: &Press) -> [Check; 4] {
    let last = &press.history.contacts[BLOCK_INCREMENTS..];
    let met = |name: &str, wanted: fn(&ContactRecord<2>) -> bool| {
        let contacts = last.iter().flatten();
        let count = contacts.filter(|c| !c.held && wanted(c)).count();
        Check::at_least(
            format!("{}: points and increments with {name}", press.what),
            (count as f64, "points"),
            1.0,
            MADE_FOR,
        )
    };
    [
        met("forward slip", |c| c.status == Status::Slip && c.u[1] > 0.0),
        met("reverse slip", |c| c.status == Status::Slip && c.u[1] < 0.0),
        met("stick", |c| c.status == Status::Stick),
        met("release", |c| c.status == Status::Open),
    ]
}

/// Mesh, loads of all runs, plastic strain and nodal reactions of one.
fn pictures(driver: &Driver<2>, loads: &Chart) -> Result<[Figure; 4], Box<dyn Error>> {
    let mesh = MeshPicture::new(driver.mesh(), "20 eight-node cells");
    let strain = deformed(
        driver,
        "Equivalent plastic strain at 0.2 mm, μ = 0.1",
        10.0,
        "equivalent plastic strain p [–]",
        |s| s.plastic_strain,
    );
    let mut reactions = Chart::new(
        "Nodal reactions, μ = 0.1",
        "position along the foundation [mm]",
        "normal reaction [N per mm]",
    );
    for (name, kind) in [
        ("corner nodes", NodeKind::Corner),
        ("mid-side nodes", NodeKind::Midside),
    ] {
        let points = along(driver.contacts(), kind, |c| c.t[0]);
        reactions = reactions.with(name, Style::LinePoints, points);
    }
    Ok([
        Figure::new(
            "block-mesh",
            "The mesh of 20 eight-node cells, for the paper's figure 11.",
            mesh.to_svg()?,
        ),
        Figure::new(
            "block-load",
            "Load against travel of the punch, half of the block.",
            loads.to_svg()?,
        ),
        Figure::new(
            "block-plastic-strain",
            "Deformed block (displacements ten times enlarged) with the equivalent plastic strain.",
            strain.to_svg()?,
        ),
        Figure::new(
            "block-reactions",
            "Normal reactions at 0.2 mm, corner and mid-side nodes apart: a uniform \
                pressure on a quadratic edge gives them in the ratio of one to two, so the zig-zag \
                of the nodes taken together is no oscillation of the pressure.",
            reactions.to_svg()?,
        ),
    ])
}
