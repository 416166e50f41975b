//! Large strains: upsetting, the ring test, the neck, indentation, platens that turn; every increment beside
//! an independent implementation of the same discrete problem.

use super::pictures::deformed;
use crate::problems::large::{
    Billet, CYLINDER, Difference, QUAD4, QUAD8, SQUARE, Tables, bar, indented, turned,
};
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table, problems};
use moreau::driver::{Analysis, Axis, Driver, IncrementReport, Step};
use moreau::mesh::{Axisymmetric, PlaneStrain};
use moreau::plot::{Chart, Style};
use std::error::Error;

const SOURCE: &str = "independent implementation, tests/reference/finite";

/// Upsetting of a block and of a cylinder.
pub(super) const UPSETTING: Case = Case {
    name: "upsetting",
    long: false,
    alone: false,
    chapter: Chapter::Large,
    title: "Upsetting between platens",
    description: "A square block of hardening steel, in plane strain, is pressed to 0.6 of its height, and a \
        cylinder to half of its height, between parallel platens with friction. The sides fold onto the \
        platens. Loads, positions, contact forces and statuses are compared with an independent \
        implementation in every increment.",
    decks: &["examples/cube-upset.toml"],
    run: upsetting,
};

/// The ring test.
pub(super) const RING: Case = Case {
    name: "ring-squeezed",
    long: false,
    alone: false,
    chapter: Chapter::Large,
    title: "Ring compression to half of the height",
    description: "A ring of the proportions 6:3:2 is squeezed to half of its height between platens with \
        Coulomb friction. Its bore over its height is the chart by which friction is measured.",
    decks: &["examples/ring-squeezed.toml"],
    run: ring,
};

/// The necking bar.
pub(super) const NECK: Case = Case {
    name: "neck",
    long: false,
    alone: false,
    chapter: Chapter::Large,
    title: "Necking of a bar",
    description: "A bar of 53.3 mm with hardening that saturates, two hundredths thinner in its middle, is drawn \
        by 14 mm: beyond the largest load it necks.",
    decks: &["examples/bar-necks.toml"],
    run: neck,
};

/// Indentation by a disc.
pub(super) const INDENTATION: Case = Case {
    name: "indentation",
    long: false,
    alone: false,
    chapter: Chapter::Large,
    title: "Indentation by a disc",
    description: "A disc of radius 10 mm is pressed by 3 mm into a block of 40 mm × 20 mm: contact spreads, and \
        normals turn as points slide along the disc.",
    decks: &["examples/ball-pressed-into-plate.toml"],
    run: indentation,
};

/// Platens that turn.
pub(super) const TURNING: Case = Case {
    name: "turning",
    long: false,
    alone: false,
    chapter: Chapter::Large,
    title: "A block squeezed between platens that turn by a right angle",
    description: "The block between two platens with friction 0.3, which come together by 6 mm, straight or \
        while they turn by 90° about its middle: contact is found where the bodies are, slips are those along the \
        platens, and both runs end in the same load.",
    decks: &["examples/cube-upset.toml", "examples/strip-rolled.toml"],
    run: turning,
};

/// A run, and what it is off by.
struct Compared {
    driver: Driver<2>,
    difference: Difference,
    /// The motion that drives it and the load \[mm, N\], increment by increment.
    path: Vec<[f64; 2]>,
}

impl Compared {
    fn checks(&self, what: &str) -> [Check; 3] {
        let off = &self.difference;
        let most = |name: &str, value: f64, bound: f64| {
            Check::at_most(format!("{what}: {name}"), (value, "1"), bound, SOURCE)
        };
        let position = off.position.max(off.plastic_strain);
        [
            most("loads, in parts, off by", off.load, 1e-9),
            most("positions and plastic strain off by", position, 1e-9),
            most(
                "contact forces over the largest off by, one more for every status",
                off.force + off.statuses as f64,
                1e-8,
            ),
        ]
    }
}

/// Runs a driver through equal increments of a step, by a motion \[mm\], and compares the load of each.
fn compared(
    mut driver: Driver<2>,
    step: &Step<2>,
    (motion, count): (f64, usize),
    load: impl Fn(&Driver<2>) -> (f64, &'static str),
    name: &str,
) -> Result<Compared, Box<dyn Error>> {
    let tables = Tables::read(name)?;
    let (mut difference, mut path) = (Difference::default(), vec![[0.0, 0.0]]);
    driver.run(step, count, |driver, report| {
        let load = load(driver);
        difference.compare((driver, report), load, &tables);
        path.push([motion * report.increment as f64 / count as f64, load.0]);
    })?;
    Ok(Compared {
        driver,
        difference,
        path,
    })
}

/// The force of a tool on the body along y \[N\].
fn along_y(driver: &Driver<2>, tool: &str) -> f64 {
    driver.tool_force(tool).map_or(f64::NAN, |f| f[1])
}

fn squeezed<H: Analysis<2>>(
    billet: Billet<'_>,
    hypothesis: H,
    friction: f64,
    (travel, count): (f64, usize),
    name: &str,
) -> Result<Compared, Box<dyn Error>> {
    let driver = billet.driver(hypothesis, 500.0, friction)?;
    let step = billet.held("squeeze").tool("platen", [0.0, -travel]);
    let load = |driver: &Driver<2>| (along_y(driver, "platen"), "tool0_Fy");
    compared(driver, &step, (travel, count), load, name)
}

/// The deformed body and its plastic strain.
fn strained(driver: &Driver<2>, name: &str, caption: &str) -> Result<Figure, Box<dyn Error>> {
    let label = "equivalent plastic strain p [–]";
    let picture = deformed(driver, "", 1.0, label, |s| s.plastic_strain);
    Ok(Figure::new(name, caption, picture.to_svg()?))
}

/// Loads over motions \[mm, kN\].
fn loads(
    title: &str,
    motion: &str,
    runs: &[(String, &Compared)],
    name: &str,
) -> Result<Figure, Box<dyn Error>> {
    let mut chart = Chart::new(title, motion, "load [kN]");
    for (label, run) in runs {
        let kilonewtons = run.path.iter().map(|[u, f]| [*u, f.abs() / 1e3]);
        let kilonewtons: Vec<[f64; 2]> = kilonewtons.collect();
        chart = chart.with(label.clone(), Style::Line, kilonewtons);
    }
    let caption = format!("{title}: load over {motion}.");
    Ok(Figure::new(name, caption, chart.to_svg()?))
}

fn upsetting(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let all = [0.0, 0.1, 0.3, 1.0];
    let mut runs = Vec::new();
    for &mu in if options.quick { &all[2..3] } else { &all[..] } {
        (options.progress)(&format!("block, μ = {mu}"));
        let name = format!("F2_Q8_8x8_mu{mu}_H500");
        let run = squeezed(SQUARE, PlaneStrain::default(), mu, (4.0, 40), &name)?;
        outcome
            .checks
            .extend(run.checks(&format!("block, μ = {mu}")));
        runs.push((format!("μ = {mu}"), run));
    }
    if !options.quick {
        (options.progress)("block of linear cells");
        let linear = Billet {
            kind: QUAD4,
            ..SQUARE
        };
        let name = "F2_Q4md_8x8_mu0.3_H500";
        let run = squeezed(linear, PlaneStrain::default(), 0.3, (4.0, 40), name)?;
        outcome.checks.extend(run.checks("block of quad4, μ = 0.3"));
    }
    let all: Vec<_> = runs
        .iter()
        .map(|(label, run)| (label.clone(), run))
        .collect();
    let title = "Block upset to 0.6 of its height";
    let motion = "travel of the platen [mm]";
    outcome
        .figures
        .push(loads(title, motion, &all, "upsetting-load")?);
    if let Some((_, run)) = runs.iter().find(|(label, _)| label == "μ = 0.3") {
        let caption = "A quarter of the block after upsetting with μ = 0.3: the side has folded onto the platen.";
        outcome
            .figures
            .push(strained(&run.driver, "upsetting-strain", caption)?);
    }
    if !options.quick {
        for mu in [0.1, 0.3] {
            (options.progress)(&format!("cylinder, μ = {mu}"));
            let name = format!("F3cyl_Q8_8x12_mu{mu}");
            let run = squeezed(CYLINDER, Axisymmetric, mu, (7.5, 50), &name)?;
            outcome
                .checks
                .extend(run.checks(&format!("cylinder, μ = {mu}")));
        }
    }
    Ok(outcome)
}

fn ring(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let all = [0.0, 0.05, 0.1, 0.2, 0.4];
    let mut chart = Chart::new(
        "Ring 6:3:2",
        "reduction of the height [%]",
        "reduction of the bore in its middle [%]",
    );
    let mut rows = Vec::new();
    for &mu in if options.quick { &all[3..4] } else { &all[..] } {
        (options.progress)(&format!("μ = {mu}"));
        let name = format!("F3ring_Q8_12x8_mu{mu}_H500");
        let billet = problems::large::RING;
        let mut driver = billet.driver(Axisymmetric, 500.0, mu)?;
        let middle = driver.mesh().nodes().iter().position(|x| *x == [4.5, 0.0]);
        let middle = middle.ok_or("no node in the middle of the bore")?;
        let (tables, mut difference) = (Tables::read(&name)?, Difference::default());
        let mut curve = vec![[0.0, 0.0]];
        let step = billet.held("squeeze").tool("platen", [0.0, -1.5]);
        driver.run(&step, 50, |driver, report| {
            let load = (along_y(driver, "platen"), "tool0_Fy");
            difference.compare((driver, report), load, &tables);
            let bore = driver.displacement(middle)[0] / 4.5;
            curve.push([report.increment as f64, -100.0 * bore]);
        })?;
        let load = along_y(&driver, "platen");
        let bore = 4.5 + driver.displacement(middle)[0];
        rows.push([format!("{mu}"), format!("{bore:.9}"), format!("{load:.6}")]);
        chart = chart.with(format!("μ = {mu}"), Style::Line, curve);
        let run = Compared {
            driver,
            difference,
            path: Vec::new(),
        };
        outcome.checks.extend(run.checks(&format!("μ = {mu}")));
        if mu == 0.2 {
            let caption = "A quarter of the section of the ring at half of its height, μ = 0.2.";
            outcome
                .figures
                .push(strained(&run.driver, "ring-squeezed-strain", caption)?);
        }
    }
    let header = ["μ", "radius of the bore in its middle [mm]", "load [N]"];
    let title = "The ring at half of its height";
    outcome
        .tables
        .push(Table::new("ring-squeezed", title, header, rows));
    let caption = "The chart by which friction is measured: the bore of the ring over its height.";
    outcome
        .figures
        .push(Figure::new("ring-chart", caption, chart.to_svg()?));
    outcome.notes.push(
        "At small reductions the slopes are those of the ring at collapse under small strains, of the chapter \
         before; beyond, hardening and bulging bend the curves."
            .into(),
    );
    Ok(outcome)
}

fn neck(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let kinds = [QUAD8, QUAD4];
    for kind in if options.quick {
        &kinds[..1]
    } else {
        &kinds[..]
    } {
        (options.progress)(kind.2);
        let step = Step::new("draw")
            .fix("bar.left", &[Axis::X])
            .fix("bar.bottom", &[Axis::Y])
            .displace("bar.top", Axis::Y, 7.0);
        let load = |driver: &Driver<2>| {
            let force = driver.reaction("bar.top").map_or(f64::NAN, |f| f[1]);
            (force, "driven_force")
        };
        let name = format!("F4_{}_4x15_n140", kind.2);
        let run = compared(bar(*kind)?, &step, (7.0, 140), load, &name)?;
        outcome.checks.extend(run.checks(&format!("{}", kind.0)));
        if *kind == QUAD8 {
            // The tables are in kN.
            let mut drawn = Chart::new("Necking bar", "elongation [mm]", "load [kN]");
            let path: Vec<[f64; 2]> = run.path.iter().map(|[u, f]| [2.0 * u, *f]).collect();
            drawn = drawn.with("60 cells", Style::Line, path);
            let caption = "Load of the bar over its elongation.";
            outcome
                .figures
                .push(Figure::new("neck-load", caption, drawn.to_svg()?));
            let caption = "Half of the bar, elongated by 14 mm, from its middle upwards.";
            outcome
                .figures
                .push(strained(&run.driver, "neck-strain", caption)?);
        }
    }
    Ok(outcome)
}

fn indentation(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut runs = Vec::new();
    for &mu in if options.quick {
        &[0.2][..]
    } else {
        &[0.0, 0.2]
    } {
        (options.progress)(&format!("μ = {mu}"));
        let step = Step::new("indent")
            .fix("block.bottom", &[Axis::X, Axis::Y])
            .fix("block.left", &[Axis::X])
            .tool("disc", [0.0, -3.0]);
        let load = |driver: &Driver<2>| (along_y(driver, "disc"), "tool0_Fy");
        let name = format!("F5_Q8_lev1_mu{mu}");
        let run = compared(indented(mu)?, &step, (3.0, 60), load, &name)?;
        outcome.checks.extend(run.checks(&format!("μ = {mu}")));
        runs.push((format!("μ = {mu}"), run));
    }
    let all: Vec<_> = runs
        .iter()
        .map(|(label, run)| (label.clone(), run))
        .collect();
    let motion = "depth [mm]";
    outcome
        .figures
        .push(loads("Indentation", motion, &all, "indentation-load")?);
    if let Some((_, run)) = runs.last() {
        let caption = "Half of the block, indented by 3 mm with μ = 0.2.";
        outcome
            .figures
            .push(strained(&run.driver, "indentation-strain", caption)?);
    }
    Ok(outcome)
}

fn turning(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let mut ends = Vec::new();
    for (name, quarter) in [("straight", 0.0), ("rot90", std::f64::consts::FRAC_PI_2)] {
        (options.progress)(name);
        let (driver, difference) = squeezed_while_turning(quarter, name)?;
        let force = driver.tool_force("top")?;
        ends.push(force.norm());
        let run = Compared {
            driver,
            difference,
            path: Vec::new(),
        };
        outcome.checks.extend(run.checks(name));
        if quarter > 0.0 {
            let caption =
                "The block after a right angle: its loaded sides are on the left and on the right.";
            outcome
                .figures
                .push(strained(&run.driver, "turning-strain", caption)?);
        }
    }
    outcome.checks.push(Check::relative(
        "load after the turn over that without",
        (ends[1] / ends[0], "1"),
        (1.0, 1e-10),
        "objectivity",
    ));
    Ok(outcome)
}

/// Both platens come together by 6 mm in 40 increments while they turn by an angle.
fn squeezed_while_turning(
    angle: f64,
    name: &str,
) -> Result<(Driver<2>, Difference), Box<dyn Error>> {
    let (mut driver, mut difference) = (turned()?, Difference::default());
    let tables = Tables::read(&format!("F6_Q8_8x8_mu0.3_{name}"))?;
    for k in 1..=40 {
        let (turn, closed) = (angle * f64::from(k) / 40.0, 3.0 * f64::from(k) / 40.0);
        let (s, c) = turn.sin_cos();
        let axis = [0.0, 0.0, 1.0];
        let step = Step::new("squeeze")
            .fix("pin", &[Axis::X, Axis::Y])
            .tool("top", [s * closed, -c * closed])
            .turn("top", axis, turn)
            .tool("bottom", [-s * closed, c * closed])
            .turn("bottom", axis, turn);
        let compare = |driver: &Driver<2>, report: &IncrementReport| {
            let force = driver.tool_force("top").unwrap_or_default();
            let load = (c * force[1] - s * force[0], "tool0_Fy_body");
            difference.compare((driver, report), load, &tables);
        };
        driver.run(&step, 1, compare)?;
    }
    Ok((driver, difference))
}
