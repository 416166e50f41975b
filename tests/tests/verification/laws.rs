//! Laws beside the paper's in bodies: friction with a limited shear, non-linear hardening,
//! Drucker–Prager's soil; not their unit tests.

use crate::close;
use moreau::contact::{ContactSolver, GaussSeidel, Penalty, Plane, SemismoothNewton, Uzawa};
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{
    BulkLaw, Coulomb, DruckerPrager, Elastic, ElasticDruckerPrager, Friction, Isotropic,
    LimitedCoulomb, Tresca, VonMises,
};
use moreau::mesh::{
    Axisymmetric, CellKind, Integration, PlaneStrain, Solid, block2, block3, uniform,
};
use verification::problems::Fallible;

/// Length and height of the pad [mm], and the pressure upon it [MPa].
const LENGTH: f64 = 10.0;
const HEIGHT: f64 = 2.0;
const PRESSURE: f64 = 100.0;

/// A pad pressed on a floor that moves until all of it slides; the mean shear.
fn rubbed(law: impl Into<Friction>, contact: Box<dyn ContactSolver<2>>) -> Fallible<f64> {
    let (x, y) = (uniform(0.0, LENGTH, 5), uniform(0.0, HEIGHT, 1));
    let model = Model::new(
        block2("pad", CellKind::Quad8, &x, &y)?,
        PlaneStrain::default(),
    )
    .material("pad", Elastic::new(1e3, 0.0)?, Integration::Full)?
    .tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
    .contact("pad.bottom", "floor", law)?;
    let settings = Settings {
        contact,
        ..Settings::default()
    };
    let mut driver = Driver::new(model, settings)?;
    let squeeze = -PRESSURE / 1e3 * HEIGHT;
    let press = Step::new("press")
        .fix("pad.top", &[Axis::X])
        .displace("pad.top", Axis::Y, squeeze);
    driver.run(&press, 1, |_, _| {})?;
    let rub = press.tool("floor", [5.0, 0.0]);
    let reports = driver.run(&rub, 4, |_, _| {})?;
    let last = &reports[reports.len() - 1];
    assert_eq!(last.stick, 0, "all of it slides");
    assert!(last.relative_gap() < 1e-10);
    assert!(last.certificate.excess_force < 1e-8);
    let force = driver.tool_force("floor")?;
    Ok(force[0].abs() / LENGTH)
}

fn methods() -> Fallible<[Box<dyn ContactSolver<2>>; 4]> {
    Ok([
        Box::new(SemismoothNewton::default()),
        Box::new(Uzawa::default()),
        Box::new(GaussSeidel::default()),
        Box::new(Penalty::new(1e9, 1e9)?),
    ])
}

/// The limit is a traction: the shear of a quadratic edge, whose nodes share it 1 : 4 : 1.
#[test]
fn limited_shear_slides_at_its_limit() -> Fallible {
    for method in methods()? {
        let shear = rubbed(Tresca::new(15.0)?, method)?;
        close("Tresca", shear, 15.0, 1e-9);
    }
    for method in methods()? {
        // Tilting redistributes the pressure, about 100, but nowhere down to 50.
        let shear = rubbed(LimitedCoulomb::new(0.3, 15.0)?, method)?;
        close("limited", shear, 15.0, 1e-9);
    }
    let free = rubbed(Coulomb::new(0.3)?, Box::new(SemismoothNewton::default()))?;
    let far = rubbed(
        LimitedCoulomb::new(0.3, 1e3)?,
        Box::new(SemismoothNewton::default()),
    )?;
    close("a limit out of reach", far, free, 1e-9);
    assert!(free > 25.0);
    Ok(())
}

/// In space: the shear along the motion, whichever way the floor goes.
#[test]
fn limited_shear_follows_the_motion_in_space() -> Fallible {
    let mut forces = Vec::new();
    for angle in [0.0f64, 0.3, 0.9] {
        let side = uniform(0.0, 2.0, 2);
        let model = Model::new(
            block3("pad", CellKind::Hex8, &side, &side, &uniform(0.0, 1.0, 1))?,
            Solid,
        )
        .material("pad", Elastic::new(1e3, 0.0)?, Integration::Full)?
        .tool("floor", Plane::new([0.0; 3], [0.0, 0.0, 1.0])?)?
        .contact("pad.back", "floor", LimitedCoulomb::new(0.3, 15.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let press = Step::new("press")
            .fix("pad.front", &[Axis::X, Axis::Y])
            .displace("pad.front", Axis::Z, -0.1);
        driver.run(&press, 1, |_, _| {})?;
        let (sin, cos) = angle.sin_cos();
        driver.run(
            &press.tool("floor", [3.0 * cos, 3.0 * sin, 0.0]),
            3,
            |_, _| {},
        )?;
        let force = driver.tool_force("floor")?;
        close("shear", force[0].hypot(force[1]), 15.0 * 4.0, 1e-9);
        let across = force[1] * cos - force[0] * sin;
        assert!(across.abs() < 1e-2 * 60.0, "{across} across the motion");
        forces.push(force[2].abs());
    }
    assert!(forces.iter().all(|f| (f - 400.0).abs() < 4.0), "{forces:?}");
    Ok(())
}

/// A bar of one law in tension: uniform, so its stress is that of the material point.
fn bar(law: impl BulkLaw) -> Fallible<Driver<2>> {
    let (r, z) = (uniform(0.0, 5.0, 2), uniform(0.0, 10.0, 2));
    let model = Model::new(block2("bar", CellKind::Quad8, &r, &z)?, Axisymmetric).material(
        "bar",
        law,
        Integration::Reduced,
    )?;
    Ok(Driver::new(model, Settings::default())?)
}

fn pulled(strain: f64) -> Step<2> {
    Step::new("pull")
        .fix("bar.left", &[Axis::X])
        .fix("bar.bottom", &[Axis::Y])
        .displace("bar.top", Axis::Y, 10.0 * strain)
}

/// Tension of a bar with Voce's and Chaboche's hardening: σ = σ_y + R(p) + Σ X, p = ε − σ/E.
#[test]
fn hardening_bars_follow_their_curves() -> Fallible {
    let (e, y) = (210e3, 300.0);
    let law = VonMises::new(e, 0.3, y)?
        .with_hardening(Isotropic::voce(60.0, 30.0)?)
        .with_recall([(30e3, 200.0), (5e3, 20.0)])?
        .with_kinematic(500.0)?;
    let curve = |p: f64| {
        let recalled = |c: f64, g: f64| c / g * (1.0 - (-g * p).exp());
        y + 60.0 * (1.0 - (-30.0 * p).exp())
            + recalled(30e3, 200.0)
            + recalled(5e3, 20.0)
            + 500.0 * p
    };
    let mut errors = Vec::new();
    for steps in [20, 40, 80] {
        let mut driver = bar(law.clone())?;
        let reports = driver.run(&pulled(0.02), steps, |_, _| {})?;
        let points = driver.points();
        let (stress, p) = (points[0].stress[1], points[0].plastic_strain);
        for point in &points {
            close("uniform stress", point.stress[1], stress, 1e-9);
            assert!(point.stress[0].abs() < 1e-6 * y);
        }
        close("strain", p + stress / e, 0.02, 1e-9);
        errors.push(stress - curve(p));
        let energies = reports[reports.len() - 1].energies;
        assert!(energies.plastic_dissipation > 0.0);
        assert!(
            energies.imbalance().abs() < 0.5 / f64::from(steps as u32) * energies.external_work
        );
    }
    assert!(errors[2].abs() < 3.0, "{errors:?}");
    close("order", errors[1] / errors[2], 2.0, 0.1);
    Ok(())
}

/// A tube under pressure that reverses: recall turns the back stress out of the direction of flow,
/// the tangent is a symmetric part, and it converges all the same.
#[test]
fn recall_converges_where_stresses_turn() -> Fallible {
    let law = VonMises::new(210e3, 0.3, 240.0)?.with_recall([(60e3, 400.0), (10e3, 50.0)])?;
    let run =
        |steps: usize| -> Fallible<(f64, f64, usize)> {
            let (r, z) = (uniform(100.0, 200.0, 8), uniform(0.0, 10.0, 1));
            let model = Model::new(block2("body", CellKind::Quad8, &r, &z)?, Axisymmetric)
                .material("body", law.clone(), Integration::Reduced)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let mut most = 0;
            let mut imbalance = 0.0;
            for pressure in [180.0, -180.0] {
                let step = Step::new("load")
                    .fix("body", &[Axis::Y])
                    .pressure("body.left", pressure);
                let reports = driver.run(&step, steps, |_, _| {})?;
                for report in &reports {
                    most = most.max(report.newton_iterations);
                    assert_eq!(report.cuts, 0);
                    imbalance = report.energies.imbalance() / report.energies.external_work;
                }
            }
            let bore = driver.mesh().node_group("body.left")?[0];
            Ok((driver.displacement(bore)[0], imbalance, most))
        };
    let (coarse, middle, fine) = (run(5)?, run(10)?, run(20)?);
    let ratio = (coarse.0 - middle.0) / (middle.0 - fine.0);
    assert!((1.5..3.0).contains(&ratio), "not of first order: {ratio}");
    assert!(
        fine.1.abs() < 0.6 * middle.1.abs(),
        "{} {}",
        fine.1,
        middle.1
    );
    assert!(
        coarse.2.max(fine.2) <= 12,
        "{} iterations",
        coarse.2.max(fine.2)
    );
    Ok(())
}

/// Soil of friction k_f and cohesion k_f c₀.
const FRICTION: f64 = 0.5;
const APEX: f64 = 2.0;

fn soil(dilatancy: f64) -> Fallible<ElasticDruckerPrager> {
    let plastic = DruckerPrager::new(FRICTION, dilatancy, APEX)?;
    Ok(ElasticDruckerPrager::new(1e3, 0.3, plastic)?)
}

/// Uniaxial strengths, which the dilatancy does not change, by the driver.
#[test]
fn soil_bars_break_at_their_strengths() -> Fallible {
    for dilatancy in [0.0, 0.2, FRICTION] {
        for (side, strain) in [(1.0, 0.02), (-1.0, -0.02)] {
            let mut driver = bar(soil(dilatancy)?)?;
            driver.run(&pulled(strain), 5, |_, _| {})?;
            let exact = side * FRICTION * APEX / ((2.0f64 / 3.0).sqrt() + side * FRICTION / 3.0);
            for point in driver.points() {
                close("strength", point.stress[1], exact, 1e-9);
            }
        }
    }
    Ok(())
}

/// A block of soil compressed in plane strain by a plate with friction: the mean pressure, and the
/// most iterations of an increment.
fn compressed(dilatancy: f64, mu: f64, cells: [usize; 2]) -> Fallible<(f64, usize)> {
    let (x, y) = (uniform(0.0, 20.0, cells[0]), uniform(0.0, 10.0, cells[1]));
    let model = Model::new(
        block2("soil", CellKind::Quad8, &x, &y)?,
        PlaneStrain::default(),
    )
    .material("soil", soil(dilatancy)?, Integration::Reduced)?
    .tool("plate", Plane::new([0.0, 10.0], [0.0, -1.0])?)?
    .contact("soil.top", "plate", Coulomb::new(mu)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("compress")
        .fix("soil.left", &[Axis::X])
        .fix("soil.bottom", &[Axis::Y])
        .tool("plate", [0.0, -0.6]);
    let reports = driver.run(&step, 20, |_, _| {})?;
    let most = reports.iter().map(|r| r.newton_iterations).max();
    assert!(reports.iter().all(|r| r.cuts == 0), "increments were cut");
    Ok((-driver.tool_force("plate")?[1] / 20.0, most.unwrap_or(0)))
}

/// Limit load between smooth plates, exact: ε̇ᵖ_z = 0 gives n_z = −k_t/3, σ_x = 0 the rest. In one
/// element: more could shear off in a band, which such a soil prefers.
#[test]
fn soil_in_plane_strain_fails_by_its_dilatancy() -> Fallible {
    let mut before = 0.0;
    for dilatancy in [0.0, 0.2, 0.4, FRICTION] {
        let k: f64 = dilatancy;
        let root = (2.0 - k * k / 3.0).sqrt();
        let n_x = k / 6.0 + 0.5 * root;
        let exact = FRICTION * APEX / (1.0 - FRICTION * n_x) * root;
        let (smooth, _) = compressed(dilatancy, 0.0, [1, 1])?;
        close("limit load", smooth, exact, 1e-6);
        assert!(smooth > before, "dilatancy strengthens what is confined");
        before = smooth;
    }
    Ok(())
}

/// Friction on the plate adds to the load, and the stress is not uniform: fast convergence whether
/// the flow is associated or not.
#[test]
fn soil_under_a_rough_plate() -> Fallible {
    let mut before = 0.0;
    for (dilatancy, most) in [(0.0, 10), (0.2, 10), (0.4, 10), (FRICTION, 14)] {
        let (rough, iterations) = compressed(dilatancy, 0.2, [6, 3])?;
        assert!(rough > before, "dilatancy strengthens what is confined");
        assert!(iterations <= most, "{iterations} iterations");
        before = rough;
    }
    // Above the strength between smooth plates by what friction adds, no more than a half.
    let (smooth, _) = compressed(FRICTION, 0.0, [1, 1])?;
    assert!(
        (1.05..1.5).contains(&(before / smooth)),
        "{before} {smooth}"
    );
    Ok(())
}
