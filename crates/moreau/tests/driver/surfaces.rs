//! Contact of two bodies under large strains: between tools that turn, and in increments that are too large for it.

use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, IncrementError, Model, ModelError, Settings, Step};
use moreau_laws::{Coulomb, VonMises};
use moreau_mesh::{CellKind, Mesh, PlaneStrain, block2, uniform};
use std::f64::consts::FRAC_PI_2;

fn steel() -> VonMises {
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    steel.with_isotropic(500.0).expect("valid")
}

fn block(name: &str, x: [f64; 2], y: [f64; 2], cells: [usize; 2]) -> Mesh<2> {
    let (x, y) = (uniform(x[0], x[1], cells[0]), uniform(y[0], y[1], cells[1]));
    block2(name, CellKind::Quad8, &x, &y).expect("valid")
}

fn pair(mesh: Mesh<2>, law: VonMises) -> Result<Model<2, PlaneStrain>, ModelError> {
    let rule = CellKind::Quad8.integration();
    Model::with_large_strains(mesh, PlaneStrain::default())
        .material("lower", law.clone(), rule)?
        .material("upper", law, rule)?
        .contact(
            "upper.bottom",
            "lower.top",
            Coulomb::new(0.3).expect("valid"),
        )
}

/// Two blocks between platens without friction, about the middle of the lower one.
fn squeezed() -> Result<Driver<2>, ModelError> {
    let lower = block("lower", [-10.0, 10.0], [-10.0, 2.0], [6, 6]);
    let upper = block("upper", [-10.0, 10.0], [2.0, 10.0], [5, 3]);
    let mut mesh = lower.joined(upper).expect("valid");
    let pin = mesh.node_group_where("pin", "lower", |x| x[0].hypot(x[1]) < 1e-9);
    pin.expect("not empty");
    let plane = |y: f64| Plane::new([0.0, y], [0.0, -y.signum()]).expect("valid");
    let smooth = || Coulomb::new(0.0).expect("valid");
    let model = pair(mesh, steel())?
        .tool("top", plane(10.0))?
        .reference([0.0, 0.0])?
        .contact("upper.top", "top", smooth())?
        .tool("bottom", plane(-10.0))?
        .reference([0.0, 0.0])?
        .contact("lower.bottom", "bottom", smooth())?;
    Driver::new(model, Settings::default())
}

/// Platens that are closed by a distance each and turned by an angle.
fn platens(closed: f64, angle: f64) -> Step<2> {
    let (s, c) = angle.sin_cos();
    let axis = [0.0, 0.0, 1.0];
    Step::new("platens")
        .fix("pin", &[Axis::X, Axis::Y])
        .tool("top", [s * closed, -c * closed])
        .turn("top", axis, angle)
        .tool("bottom", [-s * closed, c * closed])
        .turn("bottom", axis, angle)
}

/// The pressure between the bodies, the same everywhere to 1e-9 of it.
fn pressure(driver: &Driver<2>) -> f64 {
    let between = driver.contacts().iter().filter(|c| c.contact == 0);
    let pressures: Vec<f64> = between.map(|c| c.t[0] / c.area).collect();
    let mean = pressures.iter().sum::<f64>() / pressures.len() as f64;
    for p in pressures {
        assert!((p - mean).abs() <= 1e-9 * mean, "{p} beside {mean}");
    }
    mean
}

#[test]
fn platens_that_turn_take_both_bodies_with_them() -> Result<(), IncrementError> {
    let mut driver = squeezed()?;
    driver.run(&platens(2.0, 0.0), 5, |_, _| {})?;
    let straight = pressure(&driver);
    for k in 1..=10 {
        driver.run(&platens(2.0, FRAC_PI_2 * f64::from(k) / 10.0), 1, |_, _| {})?;
        let turned = pressure(&driver);
        assert!(
            (turned - straight).abs() <= 1e-9 * straight,
            "{turned} {straight}"
        );
    }
    Ok(())
}

/// A block that comes from the side, where it has nothing opposite, and would be too deep within the other one at the
/// end for contact to be found: increments are halved until it is.
#[test]
fn no_body_is_taken_into_another() -> Result<(), IncrementError> {
    let lower = block("lower", [-4.0, 4.0], [-2.0, 0.0], [32, 2]);
    let upper = block("upper", [6.0, 8.0], [1.0, 2.0], [20, 2]);
    let elastic = VonMises::new(1e4, 0.3, 1e9).expect("valid");
    let model = pair(lower.joined(upper).expect("valid"), elastic)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("press")
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .displace("upper.top", Axis::X, -7.0)
        .displace("upper.top", Axis::Y, -1.15);
    let reports = driver.run(&step, 1, |_, _| {})?;
    assert!(reports.len() > 1);
    assert!(reports[0].open == driver.contacts().len());
    let force = driver.contact_force("upper.bottom")?;
    assert!(force[1] > 500.0, "{force}");
    let least = driver.least_gaps()[0].gap;
    assert!(least > -0.05, "{least}");
    Ok(())
}
