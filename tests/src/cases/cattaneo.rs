//! Two elastic bodies pressed on each other and dragged, forth and back: stick, slip, reverse slip.

use super::pictures::tractions;
use crate::problems::shapes::graded;
use crate::{Case, Chapter, Check, Figure, Options, Outcome};
use moreau::driver::{Axis, ContactRecord, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{CellKind, Integration, Mesh, MeshError, PlaneStrain, block2, uniform};
use moreau::plot::{Chart, Style};
use std::error::Error;
use std::f64::consts::PI;

/// The case.
pub(super) const CASE: Case = Case {
    name: "cattaneo",
    long: false,
    alone: false,
    chapter: Chapter::Beyond,
    title: "Two elastic bodies pressed and dragged (Hertz, Cattaneo, Mindlin)",
    description: "A body with a round side is pressed on a flat one of the same steel, with a mesh \
        that does not match, then dragged along it until the outer part of the contact slips, and \
        back until the drag is nil: the edge slips back, and shear tractions that balance each \
        other remain. Between like materials pressure and drag are uncoupled and all tractions \
        are known in closed form.",
    decks: &[
        "examples/block-dragged-on-block.toml",
        "gallery/hertz-cattaneo-mindlin.py",
    ],
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

/// What is exact for the forces that the bodies bear.
#[derive(Clone, Copy)]
struct Exact {
    /// Pressing force \[N/mm\].
    p: f64,
    /// Half width of the contact \[mm\].
    a: f64,
    /// Largest pressure \[MPa\].
    p0: f64,
}

impl Exact {
    fn new(p: f64) -> Self {
        let e_star = 0.5 * E / (1.0 - NU * NU);
        let a = (4.0 * p * RADIUS / (PI * e_star)).sqrt();
        let p0 = 2.0 * p / (PI * a);
        Self { p, a, p0 }
    }

    fn pressure(self, x: f64) -> f64 {
        self.p0 * ellipse(x, self.a)
    }

    /// Half width that sticks when the drag has changed by q, its bound `full` in full slip.
    fn stick(self, q: f64, full: f64) -> f64 {
        self.a * (1.0 - q / full).sqrt()
    }

    /// Half width that sticks under the drag `q`.
    fn stick_forth(self, q: f64) -> f64 {
        self.stick(q, MU * self.p)
    }

    /// Half width without reverse slip after the drag has come back by `q`.
    fn stick_back(self, q: f64) -> f64 {
        self.stick(q, 2.0 * MU * self.p)
    }

    /// Shear of slip outside of `c`.
    fn shear(self, x: f64, c: f64) -> f64 {
        MU * self.p0 * (ellipse(x, self.a) - c / self.a * ellipse(x, c))
    }

    /// Shear after reverse slip outside of `b`.
    fn shear_back(self, x: f64, c: f64, b: f64) -> f64 {
        self.shear(x, c) - 2.0 * self.shear(x, b)
    }
}

/// Two bodies on their way: pressed, dragged forth, dragged back.
struct Path {
    driver: Driver<2>,
    drag: f64,
}

/// Forces at the end of a stage, and the contact then.
struct Stage {
    /// Pressing force and drag \[N/mm\].
    p: f64,
    q: f64,
    /// Half width that sticks \[mm\].
    stuck: f64,
    /// Positions and traction \[MPa\].
    tractions: Vec<[f64; 2]>,
}

impl Path {
    /// How deep the upper body is pressed \[mm\].
    const DEPTH: f64 = 2.3e-3;
    /// Drag in an increment \[mm\].
    const DRAG: f64 = 1e-4;

    fn new(n: usize) -> Result<Self, Box<dyn Error>> {
        let driver = bodies(n)?;
        Ok(Self { driver, drag: 0.0 })
    }

    fn stage(&self, (p, q): (f64, f64), traction: fn(&ContactRecord<2>) -> f64) -> Stage {
        let contacts = self.driver.contacts().iter();
        let stuck = contacts.filter(|c| c.status == Status::Stick);
        Stage {
            p,
            q,
            stuck: stuck.map(|c| c.position[0].abs()).fold(0.0, f64::max),
            tractions: tractions(&self.driver, traction),
        }
    }

    fn press(&mut self) -> Result<Stage, Box<dyn Error>> {
        let forces = moved(&mut self.driver, [0.0, -Self::DEPTH], 4)?;
        Ok(self.stage(forces, |c| c.t[0]))
    }

    /// Forces after one increment more of the drag.
    fn drag(&mut self, by: f64) -> Result<(f64, f64), Box<dyn Error>> {
        self.drag += by;
        moved(&mut self.driver, [self.drag, -Self::DEPTH], 1)
    }

    /// Until the drag is as large as `most`.
    fn forth(&mut self, most: f64) -> Result<Stage, Box<dyn Error>> {
        let mut forces = (0.0, 0.0);
        while forces.1 < most {
            forces = self.drag(Self::DRAG)?;
        }
        Ok(self.stage(forces, |c| c.force[0].abs()))
    }

    /// Until the drag is nil.
    fn back(&mut self) -> Result<Stage, Box<dyn Error>> {
        let mut forces = (0.0, f64::INFINITY);
        while forces.1 > 0.0 {
            forces = self.drag(-Self::DRAG)?;
        }
        Ok(self.stage(forces, |c| -c.force[0]))
    }
}

fn run(options: &Options<'_>) -> Result<Outcome, Box<dyn Error>> {
    let n = if options.quick { 10 } else { 20 };
    let mut path = Path::new(n)?;
    (options.progress)("pressed");
    let pressed = path.press()?;
    let exact = Exact::new(pressed.p);
    (options.progress)("dragged forth");
    let forth = path.forth(0.6 * MU * pressed.p)?;
    let c = exact.stick_forth(forth.q);
    (options.progress)("dragged back");
    let back = path.back()?;
    let b = exact.stick_back(forth.q - back.q);

    let pressure = distance(&pressed.tractions, exact.a, |x| exact.pressure(x), exact.p0);
    let mut checks = vec![Check::at_most(
        "pressed: distance from Hertz' pressure over its largest",
        (pressure, "1"),
        1e-2,
        SOURCE,
    )];
    let h = 1.2 * A / n as f64;
    let shear = |x| exact.shear(x, c);
    let name = "forth: distance from Mindlin's shear over its largest";
    checks.extend(dragged("forth", name, &forth, exact, (c, h), shear));
    let shear = |x| exact.shear_back(x, c, b);
    let name = "back: distance from the exact shear over μ p0";
    checks.extend(dragged("back", name, &back, exact, (b, h), shear));
    let remains = back.tractions.iter().map(|t| t[1].abs());
    checks.push(Check::at_least(
        "back: largest shear that remains over μ p0",
        (remains.fold(0.0, f64::max) / (MU * exact.p0), "1"),
        0.1,
        SOURCE,
    ));
    let figure = figure(exact, (c, b), [pressed, forth, back], n)?;
    Ok(Outcome {
        checks,
        figures: vec![figure],
        ..Outcome::default()
    })
}

/// Checks of a stage of the drag: pressing force, half width that sticks within a cell, shear.
fn dragged(
    what: &str,
    distance_name: &str,
    stage: &Stage,
    exact: Exact,
    stick: (f64, f64),
    shear: impl Fn(f64) -> f64,
) -> [Check; 3] {
    let worst = distance(&stage.tractions, exact.a, shear, MU * exact.p0);
    [
        Check::relative(
            format!("{what}: pressing force"),
            (stage.p, "N/mm"),
            (exact.p, 2e-3),
            SOURCE,
        ),
        Check::absolute(
            format!("{what}: half width that sticks"),
            (stage.stuck, "mm"),
            stick,
            SOURCE,
        ),
        Check::at_most(distance_name, (worst, "1"), 3e-2, SOURCE),
    ]
}

/// Tractions at the end of the three stages beside the exact ones.
fn figure(
    exact: Exact,
    (c, b): (f64, f64),
    [pressed, forth, back]: [Stage; 3],
    n: usize,
) -> Result<Figure, Box<dyn Error>> {
    let x = uniform(-1.2 * A, 1.2 * A, 240);
    let curve = |f: &dyn Fn(f64) -> f64| x.iter().map(|x| [*x, f(*x)]).collect::<Vec<_>>();
    let bound = pressed.tractions.iter().map(|t| [t[0], MU * t[1]]);
    let bound: Vec<[f64; 2]> = bound.collect();
    let mut chart = Chart::new(
        "Tractions on the contact",
        "position [mm]",
        "traction [MPa]",
    );
    for (name, line, points) in [
        ("μ p", curve(&|x| MU * exact.pressure(x)), bound),
        (
            "shear at the largest drag",
            curve(&|x| exact.shear(x, c)),
            forth.tractions,
        ),
        (
            "shear after it",
            curve(&|x| exact.shear_back(x, c, b)),
            back.tractions,
        ),
    ] {
        chart = chart
            .with(format!("{name}, exact"), Style::Line, line)
            .with(name, Style::Points, points);
    }
    let caption = format!(
        "Tractions along the contact, {n} cells in 1.2 mm; the meshes of the two bodies do not \
         match."
    );
    Ok(Figure::new("cattaneo-tractions", caption, chart.to_svg()?))
}
