//! Compression of a ring between plates of constant friction: the test by which friction is
//! measured in forming.

use super::pictures::deformed;
use crate::{Case, Chapter, Check, Figure, Options, Outcome, Table};
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Tresca, VonMises};
use moreau::mesh::{Axisymmetric, CellKind, Integration, block2, uniform};
use moreau::plot::{Chart, Style};
use std::error::Error;

/// The case.
pub(super) const CASE: Case = Case {
    name: "ring",
    long: false,
    alone: false,
    chapter: Chapter::Beyond,
    title: "Ring compression, the calibration of friction (Male and Cockcroft)",
    description: "A ring of the proportions 6:3:2 (outer, inner diameter, height) is compressed \
        between plates whose friction is a constant part m of the yield stress in shear. With \
        little friction the bore opens, with much it closes: its rate at collapse, and the mean \
        pressure, are compared with the upper bound of a velocity field without bulging. The \
        pressure must lie below that bound and above that without friction.",
    decks: &["examples/ring-squeezed.toml", "gallery/ring-test.py"],
    run,
};

const OUTER: f64 = 3.0;
const INNER: f64 = 1.5;
/// Half of the height.
const HALF: f64 = 1.0;
const YIELD: f64 = 300.0;
const SOURCE: &str = "upper bound of the parallel velocity field, minimised numerically";

/// Friction m, (dD_i/D_i)/(dH/H) and mean pressure over yield stress of the upper bound.
const BOUND: [(f64, f64, f64); 9] = [
    (0.0, -0.5, 1.0),
    (0.05, -0.4132, 1.0324),
    (0.1, -0.3253, 1.0623),
    (0.15, -0.2350, 1.0897),
    (0.2, -0.1411, 1.1144),
    (0.3, 0.0279, 1.1555),
    (0.5, 0.1668, 1.2219),
    (0.8, 0.2866, 1.3060),
    (1.0, 0.3371, 1.3572),
];

/// The ring compressed until its bore moves steadily, and what it says: the rate of the bore and
/// the mean pressure over the yield stress.
fn compressed(m: f64, n: usize) -> Result<(Driver<2>, f64, f64), Box<dyn Error>> {
    let (r, z) = (uniform(INNER, OUTER, 3 * n / 2), uniform(0.0, HALF, n));
    let mesh = block2("ring", CellKind::Quad8, &r, &z)?;
    let bore = mesh.node_group("ring.left")?;
    let model = Model::new(mesh, Axisymmetric)
        .material(
            "ring",
            VonMises::new(210e3, 0.3, YIELD)?,
            Integration::Reduced,
        )?
        .tool("plate", Plane::new([0.0, HALF], [0.0, -1.0])?)?
        .contact("ring.top", "plate", Tresca::new(m * YIELD / 3f64.sqrt())?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let mean = |driver: &Driver<2>| {
        bore.iter().map(|a| driver.displacement(*a)[0]).sum::<f64>() / bore.len() as f64
    };
    let mut travelled = 0.0;
    let mut rate = f64::NAN;
    for travel in [0.015, 0.02] {
        let before = mean(&driver);
        let step = Step::new("compress")
            .fix("ring.bottom", &[Axis::Y])
            .tool("plate", [0.0, -travel * HALF]);
        driver.run(&step, 20, |_, _| {})?;
        rate = (mean(&driver) - before) / INNER / (travelled - travel);
        travelled = travel;
    }
    let area = std::f64::consts::PI * (OUTER * OUTER - INNER * INNER);
    let pressure = -driver.tool_force("plate")?[1] / area / YIELD;
    Ok((driver, rate, pressure))
}

/// Rates of the bore and mean pressures over the friction.
#[derive(Default)]
struct Curves {
    rates: Vec<[f64; 2]>,
    pressures: Vec<[f64; 2]>,
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let n = if options.quick { 6 } else { 12 };
    let mut curves = Curves::default();
    let mut rows = Vec::new();
    for bound in BOUND {
        let m = bound.0;
        (options.progress)(&format!("m = {m}"));
        let (driver, rate, pressure) = compressed(m, n)?;
        let least = curves.pressures.last().map_or(1.0, |p| p[1]);
        outcome
            .checks
            .extend(against_bound(bound, rate, pressure, least));
        rows.push([m, rate, bound.1, pressure, bound.2].map(|v| format!("{v:.4}")));
        curves.rates.push([m, rate]);
        curves.pressures.push([m, pressure]);
        if m == 1.0 {
            outcome.figures.push(field(&driver)?);
        }
    }
    outcome.checks.push(Check::relative(
        "friction at which the bore keeps its diameter",
        (root(&curves.rates), "1"),
        (0.2703, 0.1),
        SOURCE,
    ));
    outcome.figures.extend(charts(curves, n)?);
    let header = [
        "m",
        "rate of the bore",
        "upper bound's",
        "pressure over yield stress",
        "upper bound's",
    ];
    let title = "Ring compression at collapse";
    outcome.tables.push(Table::new("ring", title, header, rows));
    outcome.notes.push(
        "Beyond m = 0.2 the wall of the ring bulges and its points at the plates stick: the load \
         stays further below the bound, whose velocity field cannot bulge, and the bore closes \
         faster."
            .into(),
    );
    Ok(outcome)
}

/// Checks of a ring against the upper bound, and against the pressure of the ring with less
/// friction.
fn against_bound(bound: (f64, f64, f64), rate: f64, pressure: f64, least: f64) -> Vec<Check> {
    let (m, bound_rate, bound) = bound;
    let bore = format!("m = {m}: rate of the bore");
    let mean = format!("m = {m}: mean pressure over yield stress");
    if m == 0.0 {
        // Without friction the velocity field of the bound is exact.
        return vec![
            Check::relative(bore, (rate, "1"), (bound_rate, 1e-10), SOURCE),
            Check::relative(mean, (pressure, "1"), (bound, 1e-10), SOURCE),
        ];
    }
    let (most, more) = (
        format!("{mean}, upper bound"),
        format!("{mean}, that of less friction"),
    );
    let mut checks = vec![
        Check::at_most(most, (pressure, "1"), bound, SOURCE),
        Check::at_least(more, (pressure, "1"), least, SOURCE),
    ];
    if (0.05..=0.15).contains(&m) {
        checks.push(Check::relative(
            bore,
            (rate, "1"),
            (bound_rate, 5e-2),
            SOURCE,
        ));
    }
    checks
}

/// Where a curve crosses zero upwards; NaN if it does not.
fn root(curve: &[[f64; 2]]) -> f64 {
    let ends = curve.windows(2).find(|w| w[0][1] < 0.0 && w[1][1] >= 0.0);
    ends.map_or(f64::NAN, |w| {
        w[0][0] + (w[1][0] - w[0][0]) * w[0][1] / (w[0][1] - w[1][1])
    })
}

/// Both curves beside those of the upper bound.
fn charts(computed: Curves, n: usize) -> Result<[Figure; 2], Box<dyn Error>> {
    let chart = |name, label: &str, bound: [[f64; 2]; 9], computed| -> Result<_, Box<dyn Error>> {
        let chart = Chart::new("Ring 6:3:2 at collapse", "friction m [–]", label)
            .with("upper bound without bulging", Style::Line, bound)
            .with(
                format!("{n} cells in half the height"),
                Style::Points,
                computed,
            );
        let caption = format!("{label}, over the friction of the plates.");
        Ok(Figure::new(name, caption, chart.to_svg()?))
    };
    Ok([
        chart(
            "ring-bore",
            "(dD/D)/(dH/H) of the bore [–]",
            BOUND.map(|(m, rate, _)| [m, rate]),
            computed.rates,
        )?,
        chart(
            "ring-pressure",
            "mean pressure over yield stress [–]",
            BOUND.map(|(m, _, pressure)| [m, pressure]),
            computed.pressures,
        )?,
    ])
}

fn field(driver: &Driver<2>) -> Result<Figure, Box<dyn Error>> {
    let picture = deformed(
        driver,
        "Equivalent plastic strain, m = 1",
        5.0,
        "equivalent plastic strain p, cut at 0.06 [–]",
        |s| s.plastic_strain.min(0.06),
    );
    Ok(Figure::new(
        "ring-plastic-strain",
        "A quarter of the ring's section after 2 % of compression between rough plates, \
            displacements five times enlarged: it bulges on both sides.",
        picture.to_svg()?,
    ))
}
