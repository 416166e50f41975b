//! Paper 8.2.1: the range of penalty factors; figures 12 to 14.

use super::compare::{History, digits, press_block, scientific};
use super::pictures::along;
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::contact::{ContactSolver, Penalty, SemismoothNewton};
use moreau::driver::Settings;
use moreau::mesh::{Integration, NodeKind};
use moreau::plot::{Chart, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "penalty",
    long: false,
    alone: false,
    chapter: Chapter::Paper,
    title: "Convergence of the penalty method (paper 8.2.1, figures 12–14)",
    description: "The punched block with a friction of 0.05 under the penalty method, equal \
        factors normal and tangential, from 10² to 10¹⁶ N/mm, on meshes of 20, 40 and 60 cells. \
        The paper's method converged in a window that narrowed with the mesh (10⁸–10¹⁵, 10⁶–10¹², \
        10⁵–10⁸). Here every factor converges, on every mesh, because the penalty is a spring in \
        series with the exact law and not a stiffness that multiplies rounding; a small factor \
        converges to a useless answer. The error against exact contact falls as 1/k.",
    decks: &["examples/punched-block.toml"],
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

/// Factors at which the reactions are drawn.
const DRAWN: [i32; 5] = [3, 4, 5, 6, 8];

/// A pressed block of some rows of ten cells.
struct Pressed {
    /// Displacements of the contact points along the foundation \[mm\].
    slips: Vec<f64>,
    history: History,
}

impl Pressed {
    fn new(
        rows: usize,
        friction: f64,
        contact: Box<dyn ContactSolver<2>>,
    ) -> Result<Self, Box<dyn Error>> {
        let settings = Settings {
            contact,
            ..Settings::default()
        };
        let (driver, history) = press_block([10, rows], friction, Integration::Reduced, settings)?;
        let contacts = driver.contacts().iter();
        let slips = contacts.map(|c| driver.displacement(c.node)[0]).collect();
        Ok(Self { slips, history })
    }

    /// By the exact method.
    fn exact(rows: usize) -> Result<Self, Box<dyn Error>> {
        Self::new(rows, FRICTION, Box::new(SemismoothNewton::default()))
    }

    /// By a penalty of 10 to some power, normal and tangential.
    fn penalty(rows: usize, friction: f64, power: i32) -> Result<Self, Box<dyn Error>> {
        let k = 10f64.powi(power);
        Self::new(rows, friction, Box::new(Penalty::new(k, k)?))
    }

    fn reactions(&self) -> Vec<f64> {
        let contacts = self.history.last_contacts().iter();
        contacts.map(|c| c.t[0]).collect()
    }
}

/// Largest difference over the largest value.
fn error(computed: &[f64], exact: &[f64]) -> f64 {
    let largest = exact.iter().map(|v| v.abs()).fold(0.0, f64::max);
    let pairs = computed.iter().zip(exact);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

/// The penalty method with one factor, against the exact one.
struct Trial {
    power: i32,
    run: Pressed,
    /// Error of the normal forces.
    force: f64,
    /// Error of the slips.
    slip: f64,
}

/// A mesh under all factors.
struct Sweep {
    rows: usize,
    exact: Pressed,
    /// Those that converged.
    trials: Vec<Trial>,
}

impl Sweep {
    fn run(options: &Options<'_>, rows: usize) -> Result<Self, Box<dyn Error>> {
        let exact = Pressed::exact(rows)?;
        let mut trials = Vec::new();
        for power in POWERS {
            (options.progress)(&format!("{} cells, k = 1e{power} N/mm", 10 * rows));
            if let Ok(run) = Pressed::penalty(rows, FRICTION, power) {
                let force = error(&run.reactions(), &exact.reactions());
                let slip = error(&run.slips, &exact.slips);
                trials.push(Trial {
                    power,
                    run,
                    force,
                    slip,
                });
            }
        }
        Ok(Self {
            rows,
            exact,
            trials,
        })
    }

    fn cells(&self) -> String {
        format!("{} cells", 10 * self.rows)
    }

    /// Error of the normal forces over the factor.
    fn curve(&self) -> Vec<[f64; 2]> {
        let trials = self.trials.iter();
        trials.map(|t| [10f64.powi(t.power), t.force]).collect()
    }

    /// Against the independent implementation, which has the mesh of 20 cells.
    fn against_values(&self) -> Vec<Check> {
        let mut checks = Vec::new();
        for &(power, force, slip) in EXPECTED.iter().filter(|_| self.rows == 2) {
            let Some(trial) = self.trials.iter().find(|t| t.power == power) else {
                continue;
            };
            for (what, value, expected) in [
                ("normal force", trial.force, force),
                ("slip", trial.slip, slip),
            ] {
                checks.push(Check::relative(
                    format!("{}, k = 1e{power}: error of the {what}", self.cells()),
                    (value, "1"),
                    (expected, 1e-5),
                    "independent implementation of the penalty law",
                ));
            }
        }
        checks
    }

    /// Every factor converges, and the error falls as 1/k.
    fn convergence(&self) -> Vec<Check> {
        let mut checks = vec![all_converge(&self.cells(), self.trials.len())];
        // Between 1e7 and 1e12 neither the nonlinearity nor rounding disturbs the rate.
        let at = |power| self.trials.iter().find(|t| t.power == power);
        if let (Some(low), Some(high)) = (at(7), at(12)) {
            checks.push(Check::absolute(
                format!(
                    "{}: order of the error in 1/k, from 1e7 to 1e12",
                    self.cells()
                ),
                ((low.force / high.force).log10() / 5.0, "1"),
                (1.0, 0.02),
                "inf-convolution [82]: the springs are in series with the exact law",
            ));
        }
        checks
    }

    /// Factors that converge, in the paper and here, and those that are good for anything.
    fn range(&self, paper: &str) -> [String; 4] {
        let range = |list: Vec<i32>| match (list.first(), list.last()) {
            (Some(a), Some(b)) => format!("1e{a} to 1e{b}"),
            _ => "none".into(),
        };
        let good = self.trials.iter().filter(|t| t.force < 1e-2);
        [
            self.cells(),
            paper.into(),
            range(self.trials.iter().map(|t| t.power).collect()),
            range(good.map(|t| t.power).collect()),
        ]
    }

    /// Rows of the table of all factors.
    fn table(&self) -> impl Iterator<Item = [String; 8]> {
        self.trials.iter().map(|trial| {
            let history = &trial.run.history;
            let load = history.last_load();
            [
                (10 * self.rows).to_string(),
                format!("1e{}", trial.power),
                digits(load, 5),
                scientific(load / self.exact.history.last_load() - 1.0),
                scientific(trial.force),
                scientific(trial.slip),
                scientific(history.largest_penetration()),
                history.newton_iterations().to_string(),
            ]
        })
    }

    /// Reactions of nodes of one kind under some factors.
    fn reactions(&self, kind: NodeKind, title: &str) -> Chart {
        let points = |run: &Pressed| along(run.history.last_contacts(), kind, |c| c.t[0]);
        let mut chart = Chart::new(
            title,
            "position along the foundation [mm]",
            "normal reaction [N per mm]",
        );
        for trial in self.trials.iter().filter(|t| DRAWN.contains(&t.power)) {
            let name = format!("k = 1e{} N/mm", trial.power);
            chart = chart.with(name, Style::LinePoints, points(&trial.run));
        }
        chart.with("exact", Style::Dashed, points(&self.exact))
    }

    /// Figures 12 and 13.
    fn figures(&self) -> Result<Vec<Figure>, Box<dyn Error>> {
        let mut figures = Vec::new();
        for (name, kind, figure, nodes) in [
            ("penalty-corners", NodeKind::Corner, 12, "corner"),
            ("penalty-midsides", NodeKind::Midside, 13, "mid-side"),
        ] {
            let chart = self.reactions(kind, &format!("Normal reactions at {nodes} nodes"));
            let caption = format!(
                "Normal reactions at {nodes} nodes for several penalty factors, 20 cells, for the \
                 paper's figure {figure}. At 10⁶ N/mm the largest error is 2 %, at 10⁸ the curve \
                 lies on the exact one."
            );
            figures.push(Figure::new(name, caption, chart.to_svg()?));
        }
        Ok(figures)
    }
}

fn all_converge(what: &str, converged: usize) -> Check {
    Check::at_least(
        format!("{what}: penalty factors from 1e2 to 1e16 that converge"),
        (converged as f64, "factors"),
        POWERS.count() as f64,
        "the law holds for every k",
    )
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
    let (mut ranges, mut factors) = (Vec::new(), Vec::new());
    for &(rows, paper) in meshes {
        let sweep = Sweep::run(options, rows)?;
        outcome.checks.extend(sweep.against_values());
        outcome.checks.extend(sweep.convergence());
        if rows == 2 {
            outcome.figures.extend(sweep.figures()?);
        }
        errors = errors.with(sweep.cells(), Style::LinePoints, sweep.curve());
        ranges.push(sweep.range(paper));
        factors.extend(sweep.table());
    }
    outcome.figures.push(Figure::new(
        "penalty-error",
        "Error of the normal forces against exact contact, at the end of the press: it falls as \
            1/k down to rounding, on every mesh.",
        errors.to_svg()?,
    ));
    outcome.tables = tables(ranges, factors).into();
    more_friction(options, &mut outcome);
    Ok(outcome)
}

fn tables(ranges: Vec<[String; 4]>, factors: Vec<[String; 8]>) -> [Table; 2] {
    [
        Table::new(
            "penalty-range",
            "Penalty factors that converge [N/mm], for the paper's figure 14",
            ["mesh", "paper", "here", "here with an error below 1 %"],
            ranges,
        ),
        Table::new(
            "penalty-sweep",
            "Penalty against exact contact, μ = 0.05",
            [
                "cells",
                "k [N/mm]",
                "load [N/mm]",
                "relative error of the load",
                "of the normal forces",
                "of the slips",
                "largest penetration [mm]",
                "Newton iterations",
            ],
            factors,
        ),
    ]
}

/// A friction of 0.05 flatters a code, because hardly a point sticks: the range again with more.
fn more_friction(options: &Options<'_>, outcome: &mut Outcome) {
    for friction in [0.1, 0.3] {
        let what = format!("20 cells, μ = {friction}");
        let converges = |power: &i32| {
            (options.progress)(&format!("{what}, k = 1e{power} N/mm"));
            Pressed::penalty(2, friction, *power).is_ok()
        };
        let converged = POWERS.filter(converges).count();
        outcome.checks.push(all_converge(&what, converged));
    }
}
