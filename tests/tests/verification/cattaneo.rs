//! A cylinder pressed on a block and then dragged, forth and back: the zones of stick and slip and
//! the traction of Cattaneo and Mindlin; not rolling.
//!
//! The closed form holds where normal and tangential problem are uncoupled: for a rigid cylinder,
//! on an incompressible block. Source: K. L. Johnson, *Contact Mechanics*, Cambridge University
//! Press 1985, chapter 7.

use crate::close;
use moreau::contact::Ball;
use moreau::driver::{Axis, ContactRecord, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{CellKind, Integration, NodeKind, PlaneStrain, block2, uniform};
use std::f64::consts::PI;
use verification::problems::Fallible;
use verification::problems::shapes::graded;

const A: f64 = 1.0;
const RADIUS: f64 = 1000.0;
const E: f64 = 210e3;
const NU: f64 = 0.499;
const MU: f64 = 0.5;
/// Cells in the half width of the contact.
const N: usize = 20;

fn block() -> Fallible<Driver<2>> {
    let (h, size) = (A / N as f64, 40.0 * A);
    let far = graded(1.2 * A, size, h, 1.5);
    let mut x: Vec<f64> = far.iter().rev().map(|x| -x).collect();
    x.extend_from_slice(&uniform(-1.2 * A, 1.2 * A, 12 * N / 5)[1..]);
    x.extend_from_slice(&far[1..]);
    let mut depth = uniform(0.0, 0.5 * A, N / 2);
    depth.extend_from_slice(&graded(0.5 * A, size, h, 1.5)[1..]);
    let y: Vec<f64> = depth.iter().rev().map(|d| -d).collect();
    let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
    mesh.facet_group_where("zone", "block.top", |x| {
        x[0].abs() <= 1.2 * A * (1.0 + 1e-12)
    })?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material("block", Elastic::new(E, NU)?, Integration::Reduced)?
        .tool("cylinder", Ball::new([0.0, RADIUS], RADIUS)?)?
        .contact("zone", "cylinder", Coulomb::new(MU)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Moves the cylinder and returns the forces P and Q that it exerts.
fn moved(driver: &mut Driver<2>, to: [f64; 2], steps: usize) -> Fallible<(f64, f64)> {
    let step = Step::new("move")
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .tool("cylinder", to);
    driver.run(&step, steps, |_, _| {})?;
    let force = driver.tool_force("cylinder")?;
    Ok((-force[1], force[0]))
}

/// Shape of the traction of full slip over a half width.
fn ellipse(x: f64, a: f64) -> f64 {
    (1.0 - (x / a).powi(2)).max(0.0).sqrt()
}

/// Distance of the traction, averaged over every edge with half of its corners, from the exact one,
/// in the mean and over the mean traction of full slip.
///
/// Under stick the tangential reactions of a nearly incompressible body alternate between corners
/// and mid-side nodes; their averages do not.
fn error(driver: &Driver<2>, p0: f64, exact: impl Fn(f64) -> f64) -> f64 {
    let mut contacts = driver.contacts().to_vec();
    contacts.sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
    let mut sum = 0.0;
    for edge in contacts
        .windows(3)
        .filter(|e| e[1].kind == NodeKind::Midside)
    {
        let average = |f: &dyn Fn(&ContactRecord<2>) -> f64| {
            0.5 * f(&edge[0]) + f(&edge[1]) + 0.5 * f(&edge[2])
        };
        let area = average(&|c| c.area);
        let traction = MU * p0 * exact(edge[1].position[0]);
        sum += (average(&|c| c.force[0]) - area * traction).abs();
    }
    sum / (0.5 * PI * A * MU * p0)
}

#[test]
fn cattaneo_mindlin_traction_forth_and_back() -> Fallible {
    let e_star = E / (1.0 - NU * NU);
    let goal = PI * A * A * e_star / (4.0 * RADIUS);
    let mut driver = block()?;
    // Pressed until the load is Hertz' one for the half width A; the grip does not slip sideways.
    let guess = 3.0 * A * A / RADIUS;
    let first = moved(&mut driver, [0.0, -guess], 1)?.0;
    let mut travel = [
        (guess, first),
        (1.1 * guess, moved(&mut driver, [0.0, -1.1 * guess], 1)?.0),
    ];
    while (travel[1].1 / goal - 1.0).abs() > 1e-6 {
        let [a, b] = travel;
        let next = b.0 + (goal - b.1) * (b.0 - a.0) / (b.1 - a.1);
        travel = [b, (next, moved(&mut driver, [0.0, -next], 1)?.0)];
    }
    let depth = -travel[1].0;
    let p0 = 2.0 * goal / (PI * A);

    // Dragged by steps until Q is past half of μP; stuck within c = a √(1 − Q/μP).
    let mut drag = 0.0;
    let (mut p, mut q) = (goal, 0.0);
    while q < 0.6 * MU * p {
        drag += 1e-4;
        (p, q) = moved(&mut driver, [drag, depth], 1)?;
    }
    close("P while dragged", p, goal, 1e-2);
    let a = (p / goal).sqrt() * A;
    let ratio = q / (MU * p);
    let c = a * (1.0 - ratio).sqrt();
    let stuck = driver
        .contacts()
        .iter()
        .filter(|c| c.status == Status::Stick);
    let zone = stuck.map(|c| c.position[0].abs()).fold(0.0, f64::max);
    assert!(
        (zone - c).abs() <= A / N as f64,
        "stuck to {zone}, expected {c}"
    );
    let forth = |x: f64| ellipse(x, a) - c / a * ellipse(x, c);
    let worst = error(&driver, p0, forth);
    assert!(worst <= 3e-2, "traction off by {worst:.2e}");

    // Back to Q = 0: reverse slip outside b, and a traction that remains.
    let most = q;
    while q > 0.0 {
        drag -= 2e-5;
        (p, q) = moved(&mut driver, [drag, depth], 1)?;
    }
    let b = a * (1.0 - (most - q) / (2.0 * MU * p)).sqrt();
    let back = |x: f64| forth(x) - 2.0 * (ellipse(x, a) - b / a * ellipse(x, b));
    let worst = error(&driver, p0, back);
    assert!(worst <= 3e-2, "traction left off by {worst:.2e}");
    let largest = driver
        .contacts()
        .iter()
        .map(|c| c.force[0].abs() / c.area)
        .fold(0.0, f64::max);
    assert!(largest > 0.1 * MU * p0, "a traction remains");
    Ok(())
}
