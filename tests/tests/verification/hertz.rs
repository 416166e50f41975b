//! Rigid cylinder, sphere and flat punch on an elastic block much larger than the contact: pressure
//! and stress beneath it against the closed forms; not contact of two elastic bodies.
//!
//! Source: K. L. Johnson, *Contact Mechanics*, Cambridge University Press 1985, chapters 2 to 4.

use crate::close;
use moreau::contact::{Ball, Plane};
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{Axisymmetric, CellKind, Integration, NodeKind, PlaneStrain, block2, uniform};
use std::f64::consts::PI;
use verification::problems::Fallible;
use verification::problems::shapes::graded;

/// Half width of the contact [mm]. The answer is linear in a/R, which is chosen small enough for
/// the circle to be its osculating parabola and for normals not to turn.
const A: f64 = 1.0;
const RADIUS: f64 = 1000.0;
const E: f64 = 210e3;
const NU: f64 = 0.3;

/// The load for this half width, P = π a² E* / 4R [N/mm].
fn load() -> f64 {
    PI * A * A * E / (1.0 - NU * NU) / (4.0 * RADIUS)
}

/// Half of a block of half width `size` under its cylinder, with cells of size a/n under the contact.
fn block(n: usize, size: f64) -> Fallible<Driver<2>> {
    let h = A / n as f64;
    let mut x = uniform(0.0, 1.5 * A, 3 * n / 2);
    x.extend_from_slice(&graded(1.5 * A, size, h, 1.3)[1..]);
    let mut depth = uniform(0.0, A, n);
    depth.extend_from_slice(&graded(A, size, h, 1.3)[1..]);
    let y: Vec<f64> = depth.iter().rev().map(|d| -d).collect();
    let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
    mesh.facet_group_where("zone", "block.top", |x| x[0] <= 1.5 * A * (1.0 + 1e-12))?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material("block", Elastic::new(E, NU)?, Integration::Reduced)?
        .tool("cylinder", Ball::new([0.0, RADIUS], RADIUS)?)?
        .contact("zone", "cylinder", Coulomb::new(0.0)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Presses the cylinder with half the load.
fn press(driver: &mut Driver<2>, load: f64) -> Fallible<()> {
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .push("cylinder", Axis::Y, -load);
    driver.run(&step, 1, |_, _| {})?;
    Ok(())
}

#[test]
fn hertz_line_contact_pressure() -> Fallible {
    let p0 = 2.0 * load() / (PI * A);
    // Cells in a; errors of the pressure at the first mid-side node, and up to 0.9 a.
    for (n, first, all) in [(4, 3e-3, 1.6e-2), (8, 1e-3, 0.96e-2), (16, 5e-4, 0.13e-2)] {
        let mut driver = block(n, 40.0 * A)?;
        press(&mut driver, 0.5 * load())?;
        let resultant: f64 = driver.contacts().iter().map(|c| c.t[0]).sum();
        close("resultant", resultant, 0.5 * load(), 1e-6);
        let exact = |x: f64| p0 * (1.0 - (x / A).powi(2)).max(0.0).sqrt();
        let pressure = |c: &moreau::driver::ContactRecord<2>| c.t[0] / c.area;
        let mid = driver
            .contacts()
            .iter()
            .filter(|c| c.kind == NodeKind::Midside);
        let mid = mid
            .min_by(|a, b| a.position[0].total_cmp(&b.position[0]))
            .ok_or("no node")?;
        close(
            &format!("n = {n}: first node"),
            pressure(mid),
            exact(mid.position[0]),
            first,
        );
        // Mid-side nodes, over the largest pressure.
        for contact in driver
            .contacts()
            .iter()
            .filter(|c| c.kind == NodeKind::Midside)
        {
            let x = contact.position[0];
            let error = (pressure(contact) - exact(x)).abs() / p0;
            assert!(
                x > 0.9 * A || error <= all,
                "n = {n}: off by {error:.2e} at {x} mm"
            );
        }
        // The edge of the contact, to the size of a cell.
        let closed = driver
            .contacts()
            .iter()
            .filter(|c| c.status != Status::Open);
        let edge = closed.map(|c| c.position[0]).fold(0.0, f64::max);
        assert!((edge - A).abs() <= A / n as f64, "n = {n}: edge at {edge}");
    }
    Ok(())
}

/// Beneath the centre the largest shear stress is 0.300 p0 at a depth of 0.786 a.
#[test]
fn hertz_line_contact_stress_in_the_depth() -> Fallible {
    let p0 = 2.0 * load() / (PI * A);
    let mut driver = block(8, 400.0 * A)?;
    press(&mut driver, 0.5 * load())?;
    // On the axis: σ_x = −p0 ((a² + 2z²)/(a √(a² + z²)) − 2z/a), σ_y = −p0 a/√(a² + z²).
    let shear = |z: f64| {
        let s = A.hypot(z);
        0.5 * (A / s - (A * A + 2.0 * z * z) / (A * s) + 2.0 * z / A)
    };
    let mut largest = (0.0, 0.0);
    for point in driver.points() {
        let (x, z) = (point.position[0], -point.position[1]);
        if x < 0.1 * A && z < 2.0 * A {
            let found = 0.5 * (point.stress[0] - point.stress[1]) / p0;
            assert!(
                (found - shear(z)).abs() < 5e-3,
                "shear {found} at depth {z}, not {}",
                shear(z)
            );
            if found > largest.1 {
                largest = (z, found);
            }
        }
    }
    close("largest shear stress", largest.1, 0.300, 1e-2);
    assert!(
        (largest.0 - 0.786 * A).abs() < A / 8.0,
        "at depth {}",
        largest.0
    );
    Ok(())
}

/// A rigid sphere on a half-space: a³ = 3PR/4E*, p0 = 3P/2πa², approach a²/R.
#[test]
fn hertz_point_contact_in_axial_symmetry() -> Fallible {
    const R: f64 = 10.0;
    const LOAD: f64 = 1000.0;
    let e_star = E / (1.0 - NU * NU);
    let a = (0.75 * LOAD * R / e_star).cbrt();
    let p0 = 1.5 * LOAD / (PI * a * a);
    close("half width", a, 0.3191252, 1e-6);
    close("largest pressure", p0, 4688.34, 1e-6);
    let n = 10;
    let h = a / n as f64;
    let size = 100.0 * a;
    let mut r = uniform(0.0, 1.5 * a, 3 * n / 2);
    r.extend_from_slice(&graded(1.5 * a, size, h, 1.3)[1..]);
    let mut depth = uniform(0.0, a, n);
    depth.extend_from_slice(&graded(a, size, h, 1.3)[1..]);
    let z: Vec<f64> = depth.iter().rev().map(|d| -d).collect();
    let mut mesh = block2("block", CellKind::Quad8, &r, &z)?;
    mesh.facet_group_where("zone", "block.top", |x| x[0] <= 1.5 * a * (1.0 + 1e-12))?;
    let model = Model::new(mesh, Axisymmetric)
        .material("block", Elastic::new(E, NU)?, Integration::Full)?
        .tool("sphere", Ball::new([0.0, R], R)?)?
        .contact("zone", "sphere", Coulomb::new(0.0)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .push("sphere", Axis::Y, -LOAD);
    driver.run(&step, 2, |_, _| {})?;
    // The block is deep, not infinitely so.
    let approach = -driver.tool_displacement("sphere")?[1];
    close("approach under the load", approach, a * a / R, 2e-2);
    for contact in driver.contacts() {
        let x = contact.position[0];
        let exact = p0 * (1.0 - (x / a).powi(2)).max(0.0).sqrt();
        if x < 0.9 * a {
            let error = (contact.traction()[0] - exact).abs() / p0;
            // On the axis as elsewhere: its node has the pressure of the surface there.
            let most = if x == 0.0 { 1e-3 } else { 8e-3 };
            assert!(error <= most, "pressure off by {error:.2e} at {x} mm");
        }
    }
    let closed = driver
        .contacts()
        .iter()
        .filter(|c| c.status != Status::Open);
    let edge = closed.map(|c| c.position[0]).fold(0.0, f64::max);
    assert!((edge - a).abs() <= h, "edge at {edge}, not {a}");
    Ok(())
}

/// A flat rigid punch: p = P/(π √(a² − x²)), singular at its edge.
#[test]
fn flat_punch_pressure_at_its_centre() -> Fallible {
    let n = 16;
    let mut x = uniform(0.0, A, n);
    x.extend_from_slice(&graded(A, 400.0 * A, A / n as f64, 1.3)[1..]);
    let mut depth = uniform(0.0, A, n);
    depth.extend_from_slice(&graded(A, 400.0 * A, A / n as f64, 1.3)[1..]);
    let y: Vec<f64> = depth.iter().rev().map(|d| -d).collect();
    let mut mesh = block2("block", CellKind::Quad8, &x, &y)?;
    mesh.facet_group_where("face", "block.top", |x| x[0] <= A)?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material("block", Elastic::new(E, NU)?, Integration::Reduced)?
        .tool("punch", Plane::new([0.0, 0.0], [0.0, -1.0])?)?
        .contact("face", "punch", Coulomb::new(0.0)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::X, Axis::Y])
        .tool("punch", [0.0, -1e-3]);
    driver.run(&step, 1, |_, _| {})?;
    let load = -2.0 * driver.tool_force("punch")?[1];
    for contact in driver
        .contacts()
        .iter()
        .filter(|c| c.position[0] <= 0.5 * A)
    {
        let x = contact.position[0];
        let exact = load / (PI * (A * A - x * x).sqrt());
        close(
            &format!("pressure at {x}"),
            contact.t[0] / contact.area,
            exact,
            1e-2,
        );
    }
    Ok(())
}
