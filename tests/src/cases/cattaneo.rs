//! Two elastic bodies pressed on each other and dragged, forth and back: stick, slip, reverse slip.

use crate::problems::shapes::graded;
use crate::{Case, Chapter, Check, Figure, Kind, Options, Outcome};
use moreau::driver::{Axis, ContactRecord, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{CellKind, Integration, Mesh, MeshError, PlaneStrain, block2, uniform};
use moreau::plot::{Chart, Style};
use std::error::Error;
use std::f64::consts::PI;

/// The case.
pub(super) const CASE: Case = Case {
    name: "cattaneo",
    chapter: Chapter::Beyond,
    title: "Two elastic bodies pressed and dragged (Hertz, Cattaneo, Mindlin)",
    description: "A body with a round side is pressed on a flat one of the same steel, with a mesh \
        that does not match, then dragged along it until the outer part of the contact slips, and \
        back until the drag is nil: the edge slips back, and shear tractions that balance each \
        other remain. Between like materials pressure and drag are uncoupled and all tractions \
        are known in closed form.",
    run,
};

/// Half width of the contact \[mm\], about; the answer depends on a/R, which is small.
const A: f64 = 1.0;
const RADIUS: f64 = 1000.0;
const E: f64 = 210e3;
const NU: f64 = 0.3;
const MU: f64 = 0.5;
const SIZE: f64 = 40.0;
const SOURCE: &str = "closed form (Johnson, Contact Mechanics, chapters 4, 5 and 7)";

/// Two blocks, fine under the contact: `n` cells in its half width in the upper, fewer below.
fn mesh(n: usize) -> Result<Mesh<2>, MeshError> {
    let block = |name, n: usize, up: bool| {
        let h = 1.2 * A / n as f64;
        let far = graded(1.2 * A, SIZE, h, 1.5);
        let mut x: Vec<f64> = far.iter().rev().map(|x| -x).collect();
        x.extend_from_slice(&uniform(-1.2 * A, 1.2 * A, 2 * n)[1..]);
        x.extend_from_slice(&far[1..]);
        let mut y = uniform(0.0, 0.5 * A, n / 2);
        y.extend_from_slice(&graded(0.5 * A, SIZE, h, 1.5)[1..]);
        if !up {
            y = y.iter().rev().map(|y| -y).collect();
        }
        block2(name, CellKind::Quad8, &x, &y)
    };
    let upper = block("upper", n + n / 5, true)?;
    let upper = upper.map(|[x, y]| [x, y + x * x / (2.0 * RADIUS)])?;
    let mut mesh = upper.joined(block("lower", n, false)?)?;
    for (zone, surface) in [("above", "upper.bottom"), ("below", "lower.top")] {
        mesh.facet_group_where(zone, surface, |x| x[0].abs() <= 1.2 * A * (1.0 + 1e-9))?;
    }
    Ok(mesh)
}

fn bodies(n: usize) -> Result<Driver<2>, Box<dyn Error>> {
    let steel = || Elastic::new(E, NU);
    let model = Model::new(mesh(n)?, PlaneStrain::default())
        .material("upper", steel()?, Integration::Reduced)?
        .material("lower", steel()?, Integration::Reduced)?
        .contact("above", "below", Coulomb::new(MU)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Moves the upper side of the upper body, and returns the forces P and Q on it \[N/mm\].
fn moved(
    driver: &mut Driver<2>,
    to: [f64; 2],
    increments: usize,
) -> Result<(f64, f64), Box<dyn Error>> {
    let step = Step::new("move")
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .displace("upper.top", Axis::X, to[0])
        .displace("upper.top", Axis::Y, to[1]);
    driver.run(&step, increments, |_, _| {})?;
    let force = driver.reaction("upper.top")?;
    Ok((-force[1], force[0]))
}

/// √(1 − (x/a)²), the shape of a traction of full slip, nil outside.
fn ellipse(x: f64, a: f64) -> f64 {
    (1.0 - (x / a).powi(2)).max(0.0).sqrt()
}

/// Positions along the contact, sorted, with a component of the traction \[MPa\].
fn tractions(driver: &Driver<2>, of: fn(&ContactRecord<2>) -> f64) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = driver
        .contacts()
        .iter()
        .map(|c| [c.position[0], of(c) / c.area])
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Mean distance of tractions from an exact one over the contact, in parts of `scale`.
fn distance(points: &[[f64; 2]], a: f64, exact: impl Fn(f64) -> f64, scale: f64) -> f64 {
    let (mut sum, mut length) = (0.0, 0.0);
    for pair in points
        .windows(2)
        .filter(|p| p[0][0].abs() < a || p[1][0].abs() < a)
    {
        let h = pair[1][0] - pair[0][0];
        let error = |p: &[f64; 2]| (p[1] - exact(p[0])).abs();
        sum += 0.5 * h * (error(&pair[0]) + error(&pair[1]));
        length += h;
    }
    sum / length / scale
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let mut outcome = Outcome::default();
    let n = if options.quick { 10 } else { 20 };
    let h = 1.2 * A / n as f64;
    let e_star = 0.5 * E / (1.0 - NU * NU);
    let mut driver = bodies(n)?;
    let mut add = |name: &str, value: (f64, &str), kind, reference| {
        let check = Check::new(name, value, kind, reference, SOURCE);
        outcome.checks.push(check);
    };

    (options.progress)("pressed");
    let depth = 2.3e-3;
    let (p, _) = moved(&mut driver, [0.0, -depth], 4)?;
    let a = (4.0 * p * RADIUS / (PI * e_star)).sqrt();
    let p0 = 2.0 * p / (PI * a);
    let pressure = tractions(&driver, |c| c.t[0]);
    let worst = distance(&pressure, a, |x| p0 * ellipse(x, a), p0);
    add(
        "pressed: distance from Hertz' pressure over its largest",
        (worst, "1"),
        Kind::AtMost,
        (1e-2, 0.0),
    );
    let edge = |status: Status, driver: &Driver<2>| {
        let of = |c: &&ContactRecord<2>| c.status == status;
        driver
            .contacts()
            .iter()
            .filter(of)
            .map(|c| c.position[0].abs())
            .fold(0.0, f64::max)
    };

    (options.progress)("dragged forth");
    let (mut drag, mut q, mut now) = (0.0, 0.0, p);
    while q < 0.6 * MU * p {
        drag += 1e-4;
        (now, q) = moved(&mut driver, [drag, -depth], 1)?;
    }
    add(
        "forth: pressing force",
        (now, "N/mm"),
        Kind::Relative,
        (p, 2e-3),
    );
    let c = a * (1.0 - q / (MU * p)).sqrt();
    let stuck = edge(Status::Stick, &driver);
    add(
        "forth: half width that sticks",
        (stuck, "mm"),
        Kind::Absolute,
        (c, h),
    );
    let forth = |x: f64| MU * p0 * (ellipse(x, a) - c / a * ellipse(x, c));
    let shear = tractions(&driver, |c| c.force[0].abs());
    let worst = distance(&shear, a, forth, MU * p0);
    add(
        "forth: distance from Mindlin's shear over its largest",
        (worst, "1"),
        Kind::AtMost,
        (3e-2, 0.0),
    );

    (options.progress)("dragged back");
    let most = q;
    while q > 0.0 {
        drag -= 1e-4;
        (now, q) = moved(&mut driver, [drag, -depth], 1)?;
    }
    // Reverse slip outside b.
    let b = a * (1.0 - (most - q) / (2.0 * MU * p)).sqrt();
    let back = |x: f64| forth(x) - 2.0 * MU * p0 * (ellipse(x, a) - b / a * ellipse(x, b));
    let left = tractions(&driver, |c| -c.force[0]);
    add(
        "back: pressing force",
        (now, "N/mm"),
        Kind::Relative,
        (p, 2e-3),
    );
    add(
        "back: half width that sticks",
        (edge(Status::Stick, &driver), "mm"),
        Kind::Absolute,
        (b, h),
    );
    add(
        "back: distance from the exact shear over μ p0",
        (distance(&left, a, back, MU * p0), "1"),
        Kind::AtMost,
        (3e-2, 0.0),
    );
    let remains = left.iter().map(|t| t[1].abs()).fold(0.0, f64::max);
    add(
        "back: largest shear that remains over μ p0",
        (remains / (MU * p0), "1"),
        Kind::AtLeast,
        (0.1, 0.0),
    );

    let x = uniform(-1.2 * A, 1.2 * A, 240);
    let curve = |f: &dyn Fn(f64) -> f64| x.iter().map(|x| [*x, f(*x)]).collect::<Vec<_>>();
    let chart = Chart::new(
        "Tractions on the contact",
        "position [mm]",
        "traction [MPa]",
    )
    .with(
        "μ p, exact",
        Style::Line,
        curve(&|x| MU * p0 * ellipse(x, a)),
    )
    .with(
        "μ p",
        Style::Points,
        pressure
            .iter()
            .map(|t| [t[0], MU * t[1]])
            .collect::<Vec<_>>(),
    )
    .with(
        "shear at the largest drag, exact",
        Style::Line,
        curve(&forth),
    )
    .with("shear at the largest drag", Style::Points, shear)
    .with("shear after it, exact", Style::Line, curve(&back))
    .with("shear after it", Style::Points, left);
    outcome.figures.push(Figure {
        name: "cattaneo-tractions".into(),
        caption: format!(
            "Tractions along the contact, {n} cells in 1.2 mm; the meshes of the two bodies do not \
             match."
        ),
        svg: chart.to_svg()?,
    });
    Ok(outcome)
}
