//! Forming of metals beside the theories of it: rolling and slabs, drawing and lines of slip, the hardness of a ball
//! and Tabor.

use super::pictures::deformed;
use crate::problems::forming::slab::Slab;
use crate::problems::forming::{PASS, ball_on_plate, drawn, hardened};
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::driver::{Axis, Driver, Step};
use moreau::laws::Status;
use moreau::plot::{Chart, Style};
use std::error::Error;

/// Rolling of a strip.
pub(super) const ROLLING: Case = Case {
    name: "rolling",
    long: true,
    alone: false,
    chapter: Chapter::Large,
    title: "Rolling of a strip",
    description: "A strip of 2 mm is rolled to 1.6 mm by rolls of radius 60 mm with friction 0.15, which turn by 15°. \
        Force and moment of the steady state are compared with the theories of slabs of von Kármán and Orowan, \
        which know of no elastic zones at the ends of the contact: the stiffer the strip, the nearer the force.",
    decks: &["examples/strip-rolled.toml"],
    run: rolling,
};

/// Drawing of a strip.
pub(super) const DRAWING: Case = Case {
    name: "drawing",
    long: true,
    alone: false,
    chapter: Chapter::Large,
    title: "Drawing of a strip through a smooth die",
    description: "A strip of perfectly plastic metal is drawn through a die of half angle α = 7.2° without friction, which \
        takes a fifth of its thickness: r = 2 sin α / (1 + 2 sin α), for which the lines of slip are a fan, and the \
        stress of drawing is 2k (1 + α) r.",
    decks: &["examples/strip-drawn.toml"],
    run: drawing,
};

/// Hardness.
pub(super) const HARDNESS: Case = Case {
    name: "hardness",
    long: true,
    alone: false,
    chapter: Chapter::Large,
    title: "Brinell's ball and Tabor's rule",
    description: "A ball of 10 mm is pressed by 0.3 mm into a plate of steel that hardens by a power of 0.2. The mean \
        pressure over the yield stress at a plastic strain of 0.2 a/R is between 2.8 and 3 for all metals.",
    decks: &["examples/ball-pressed-into-plate.toml"],
    run: hardness,
};

/// The deformed body and its plastic strain.
fn strained(driver: &Driver<2>, name: &str, caption: &str) -> Result<Figure, Box<dyn Error>> {
    let label = "equivalent plastic strain p [–]";
    let picture = deformed(driver, "", 1.0, label, |s| s.plastic_strain);
    Ok(Figure::new(name, caption, picture.to_svg()?))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The steady state of a pass, from 8 mm of rolling to 16.
struct Steady {
    driver: Driver<2>,
    /// Force of the roll after each increment \[N/mm\].
    forces: Vec<f64>,
    /// Mean moment \[N·mm/mm\].
    moment: f64,
    /// Largest force along the strip over that across it.
    drift: f64,
}

impl Steady {
    const ANGLE: f64 = 15.0;
    const INCREMENTS: usize = 80;

    fn of(young: f64) -> Result<Self, Box<dyn Error>> {
        let mut driver = PASS.driver(young)?;
        driver.run(&PASS.bite(), 8, |_, _| {})?;
        let (mut forces, mut moments, mut drift) = (Vec::new(), Vec::new(), 0.0f64);
        let step = PASS.roll(Self::ANGLE.to_radians());
        driver.run(&step, Self::INCREMENTS, |driver, _| {
            let force = driver.tool_force("roll").unwrap_or_default();
            let moment = driver.tool_moment("roll").map_or(f64::NAN, |m| m.z);
            drift = drift.max(force[0].abs() / force[1].abs());
            forces.push(-force[1]);
            moments.push(moment);
        })?;
        Ok(Self {
            driver,
            moment: mean(&moments[Self::INCREMENTS / 2..]).abs(),
            forces,
            drift,
        })
    }

    fn force(&self) -> f64 {
        mean(&self.forces[Self::INCREMENTS / 2..])
    }

    /// Change of the force from one quarter to the next, in parts.
    fn change(&self) -> f64 {
        let quarter = Self::INCREMENTS / 4;
        let [first, second] = [2, 3].map(|k| mean(&self.forces[k * quarter..(k + 1) * quarter]));
        (second / first - 1.0).abs()
    }

    /// Force over the way of the roll \[mm\].
    fn course(&self) -> Vec<[f64; 2]> {
        let each = PASS.radius * Self::ANGLE.to_radians() / Self::INCREMENTS as f64;
        let forces = self.forces.iter().enumerate();
        forces.map(|(k, f)| [each * (k + 1) as f64, *f]).collect()
    }
}

fn rolling(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    const KARMAN: &str = "theory of slabs, von Kármán 1925";
    const OROWAN: &str = "theory of slabs, Orowan 1943";
    let mut outcome = Outcome::default();
    let [karman, orowan] = [Slab::VonKarman, Slab::Orowan].map(|slab| slab.rolled(&PASS));
    let row = |what: &str, force: f64, moment: f64| {
        [
            what.to_owned(),
            format!("{force:.2}"),
            format!("{moment:.2}"),
        ]
    };
    let mut rows = vec![
        row("von Kármán", karman.force, karman.moment),
        row("Orowan", orowan.force, orowan.moment),
    ];
    let mut chart = Chart::new("Rolling", "way of the roll [mm]", "force [N/mm]");
    let mut more = Vec::new();
    // Four times as stiff, elastic zones are half as long.
    let all = [(70e3, 0.07), (280e3, 0.035)];
    for &(young, part) in if options.quick { &all[..1] } else { &all[..] } {
        let name = format!("E = {} GPa", young / 1e3);
        (options.progress)(&name);
        let steady = Steady::of(young)?;
        let (force, moment) = (steady.force(), steady.moment);
        chart = chart.with(name.clone(), Style::Line, steady.course());
        rows.push(row(&format!("here, {name}"), force, moment));
        more.push(force / karman.force - 1.0);
        let what = |of: &str| format!("{name}: {of}");
        let (f, m) = ((force, "N/mm"), (moment, "N·mm/mm"));
        outcome.checks.extend([
            Check::relative(what("force"), f, (karman.force, part), KARMAN),
            Check::relative(what("moment"), m, (karman.moment, 0.02), KARMAN),
            Check::relative(what("moment"), m, (orowan.moment, 0.02), OROWAN),
            Check::at_most(
                what("force along the strip, in parts"),
                (steady.drift, "1"),
                1e-9,
                "balance",
            ),
            Check::at_most(
                what("change of the force from 4 mm to the next, in parts"),
                (steady.change(), "1"),
                3e-3,
                "steady state",
            ),
        ]);
        if outcome.figures.is_empty() {
            let caption = "Half of the strip, drawn in from the left.";
            let figure = strained(&steady.driver, "rolling-strain", caption)?;
            outcome.figures.push(figure);
        }
    }
    if let [soft, stiff] = more[..] {
        outcome.checks.push(Check::relative(
            "what elastic zones add to the force, 280 over 70 GPa",
            (stiff / soft, "1"),
            (0.5, 0.2),
            "zones half as long, Bland and Ford 1952",
        ));
    }
    let header = ["", "force [N/mm]", "moment of a roll [N·mm/mm]"];
    let table = Table::new("rolling", "Rolling to 0.8 of the thickness", header, rows);
    outcome.tables.push(table);
    let caption = "Force of a roll: steady after a millimetre.";
    let figure = Figure::new("rolling-force", caption, chart.to_svg()?);
    outcome.figures.push(figure);
    Ok(outcome)
}

fn drawing(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    const SOURCE: &str = "lines of slip, Hill, The Mathematical Theory of Plasticity, 1950";
    let mut outcome = Outcome::default();
    (options.progress)("closing and drawing");
    let angle = 0.125f64.asin();
    let mut driver = drawn(angle)?;
    let held = |name: &str| {
        Step::new(name)
            .fix("strip.bottom", &[Axis::Y])
            .tool("die", [0.0, -0.4])
    };
    driver.run(&held("close").fix("strip.right", &[Axis::X]), 8, |_, _| {})?;
    let (way, increments) = (7.0, 56);
    let mut forces = Vec::new();
    let step = held("draw").displace("strip.right", Axis::X, way);
    driver.run(&step, increments, |driver, _| {
        forces.push(driver.reaction("strip.right").map_or(f64::NAN, |f| f[0]));
    })?;
    // 2k (1 + α) r on what leaves the die.
    let exact = 200.0 / 3f64.sqrt() * (1.0 + angle) * 0.2 * 1.6;
    let force = mean(&forces[16..]);
    outcome.checks.push(Check::relative(
        "force of drawing, half of the strip",
        (force, "N/mm"),
        (exact, 0.03),
        SOURCE,
    ));
    let course = forces
        .iter()
        .enumerate()
        .map(|(k, f)| [way * (k + 1) as f64 / increments as f64, *f]);
    let chart = Chart::new("Drawing", "way of the front [mm]", "force [N/mm]")
        .with("computed", Style::Line, course.collect::<Vec<_>>())
        .with(
            "lines of slip",
            Style::Line,
            vec![[0.0, exact], [way, exact]],
        );
    let caption = "Force of drawing; nodes that come into the die and leave it are its waves.";
    outcome
        .figures
        .push(Figure::new("drawing-force", caption, chart.to_svg()?));
    let caption = "Half of the strip, drawn to the right.";
    outcome
        .figures
        .push(strained(&driver, "drawing-strain", caption)?);
    Ok(outcome)
}

fn hardness(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    const SOURCE: &str = "D. Tabor, The Hardness of Metals, 1951";
    let mut outcome = Outcome::default();
    (options.progress)("pressing");
    let mut driver = ball_on_plate()?;
    let step = Step::new("press")
        .fix("plate.bottom", &[Axis::Y])
        .tool("ball", [0.0, -0.3]);
    let mut course = Vec::new();
    driver.run(&step, 40, |driver, _| {
        // The edge of the contact is between its last node and the next.
        let place = |node: usize| driver.mesh().nodes()[node][0] + driver.displacement(node)[0];
        let radii = |open: bool| {
            let of = driver
                .contacts()
                .iter()
                .filter(move |c| (c.status == Status::Open) == open);
            of.map(|c| place(c.node))
        };
        let last = radii(false).fold(0.0, f64::max);
        let next = radii(true)
            .filter(|r| *r > last)
            .fold(f64::INFINITY, f64::min);
        let radius = 0.5 * (last + next);
        let force = driver.tool_force("ball").map_or(f64::NAN, |f| -f[1]);
        let pressure = force / (std::f64::consts::PI * radius * radius);
        course.push([radius / 5.0, pressure / hardened(0.2 * radius / 5.0)]);
    })?;
    let late: Vec<f64> = course[20..].iter().map(|c| c[1]).collect();
    let found = mean(&late);
    outcome.checks.extend([
        Check::at_least(
            "mean pressure over yield stress, a/R from 0.24 to 0.35",
            (found, "1"),
            2.8,
            SOURCE,
        ),
        Check::at_most(
            "mean pressure over yield stress, a/R from 0.24 to 0.35",
            (found, "1"),
            3.0,
            SOURCE,
        ),
    ]);
    let chart = Chart::new(
        "Hardness",
        "radius of the contact over that of the ball",
        "mean pressure over yield stress",
    )
    .with("computed", Style::Line, course);
    let caption = "Mean pressure under the ball over the yield stress at a strain of 0.2 a/R; the waves are nodes that come \
        into contact one by one.";
    outcome
        .figures
        .push(Figure::new("hardness-ratio", caption, chart.to_svg()?));
    Ok(outcome)
}
