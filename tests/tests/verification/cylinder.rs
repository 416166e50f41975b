//! Thick cylinder in plane strain under internal pressure: elastic limits, growth against Hill's
//! solution and collapse by elements of every kind; not a closed vessel.
//!
//! Source: R. Hill, *The Mathematical Theory of Plasticity*, Clarendon Press 1950, chapter V.
//! His growth is exact for Tresca's criterion, and for von Mises' in the limit ν = ½ only; his
//! limit pressure is exact for any ν.

use crate::close;
use moreau::driver::{Driver, Model, Settings};
use moreau::laws::Elastic;
use moreau::mesh::{Axisymmetric, CellKind, Integration, block2, uniform};
use verification::problems::Fallible;
use verification::problems::collapsing::cylinder::{
    A, B, E, HEIGHT, YIELD, body, collapse, held, limit,
};
use verification::problems::limit::collapse_of;

/// Twice the shear yield stress.
fn y() -> f64 {
    2.0 * YIELD / 3f64.sqrt()
}

fn pressure(c: f64) -> f64 {
    y() * ((c / A).ln() + 0.5 * (1.0 - (c / B).powi(2)))
}

fn growth(c: f64, nu: f64) -> f64 {
    y() * c * c * (1.0 - nu * nu) / (E * B)
}

fn outer_growth(driver: &Driver<2>) -> Fallible<f64> {
    let nodes = driver.mesh().node_group("body.right")?;
    Ok(nodes
        .iter()
        .map(|&n| driver.displacement(n)[0])
        .sum::<f64>()
        / nodes.len() as f64)
}

#[test]
fn lame_cylinder_is_elastic_up_to_its_yield_pressure() -> Fallible {
    let p_e = 0.5 * y() * (1.0 - (A / B).powi(2));
    close("yield pressure", p_e, 103.92305, 1e-7);
    let mut driver = body(CellKind::Quad8, Integration::Reduced, 64, 0.3)?;
    let reports = driver.run(&held("load").pressure("body.left", 100.0), 1, |_, _| {})?;
    assert_eq!(reports[0].plastic_fraction, 0.0);
    // u_b = 2 p a² b (1 − ν²) / (E (b² − a²)).
    let exact = 2.0 * 100.0 * A * A * B * (1.0 - 0.09) / (E * (B * B - A * A));
    close("Lamé's growth", exact, 0.0577778, 1e-6);
    close("growth", outer_growth(&driver)?, exact, 1e-6);
    // Yielding starts at the bore at p_e, between 0.99 and 1.01 of it.
    let below = driver.run(
        &held("load").pressure("body.left", 0.99 * p_e),
        1,
        |_, _| {},
    )?;
    assert_eq!(below[0].plastic_fraction, 0.0);
    let above = driver.run(
        &held("load").pressure("body.left", 1.01 * p_e),
        1,
        |_, _| {},
    )?;
    assert!(above[0].plastic_fraction > 0.0 && above[0].plastic_fraction < 0.05);
    Ok(())
}

#[test]
fn hill_cylinder_grows_as_von_mises_demands() -> Fallible {
    let table: [(f64, &[(f64, f64)]); 2] = [
        (
            0.3,
            &[
                (100.0, 0.060044),
                (120.0, 0.086509),
                (140.0, 0.117881),
                (160.0, 0.154463),
            ],
        ),
        (
            0.4999,
            &[
                (100.0, 0.049494),
                (120.0, 0.071270),
                (140.0, 0.097009),
                (160.0, 0.126706),
                (180.0, 0.160355),
            ],
        ),
    ];
    for (nu, rows) in table {
        for &(c, expected) in rows {
            let mut driver = body(CellKind::Quad8, Integration::Reduced, 64, nu)?;
            driver.run(
                &held("load").pressure("body.left", pressure(c)),
                5,
                |_, _| {},
            )?;
            let grown = outer_growth(&driver)?;
            close(
                &format!("growth, nu = {nu}, c = {c}"),
                grown,
                expected,
                1e-4,
            );
            // At ν = ½ von Mises' cylinder is Tresca's.
            if nu > 0.49 {
                close(
                    &format!("Hill's growth, c = {c}"),
                    grown,
                    growth(c, nu),
                    1e-4,
                );
            } else if c > 100.0 {
                assert!(
                    grown > growth(c, nu),
                    "Hill's growth is less than von Mises' at nu = 0.3"
                );
            }
        }
    }
    Ok(())
}

/// At ν = 0.3 and c = 180 mm the growth depends on the number of steps.
#[test]
fn hill_cylinder_close_to_collapse_needs_steps() -> Fallible {
    for (steps, expected) in [(5, 0.198200), (20, 0.198111), (80, 0.197973)] {
        let mut driver = body(CellKind::Quad8, Integration::Reduced, 64, 0.3)?;
        driver.run(
            &held("load").pressure("body.left", pressure(180.0)),
            steps,
            |_, _| {},
        )?;
        close(
            &format!("{steps} steps"),
            outer_growth(&driver)?,
            expected,
            1e-5,
        );
    }
    Ok(())
}

/// Unloaded elastically, the bore keeps the hoop stress of the load less that of Lamé's solution.
#[test]
fn hill_cylinder_unloads_to_a_bore_in_compression() -> Fallible {
    let p = pressure(180.0);
    let mut driver = body(CellKind::Quad8, Integration::Reduced, 64, 0.4999)?;
    driver.run(&held("load").pressure("body.left", p), 20, |_, _| {})?;
    let loaded = driver.points();
    let reports = driver.run(&held("unload"), 1, |_, _| {})?;
    assert_eq!(reports[0].plastic_fraction, 0.0, "no reverse yielding");
    for (before, after) in loaded.iter().zip(driver.points()) {
        let hoop = p * (B * B / before.position[0].powi(2) + 1.0) / (B * B / (A * A) - 1.0);
        close(
            "Lamé's hoop stress",
            before.stress[2] - after.stress[2],
            hoop,
            1e-3,
        );
    }
    // Hill: Y − p − p (b² + a²)/(b² − a²) at the bore, −200 MPa and a little.
    let exact = y() - p - p * (B * B + A * A) / (B * B - A * A);
    close(
        "residual hoop stress",
        driver.points()[0].stress[2],
        exact,
        2e-2,
    );
    Ok(())
}

#[test]
fn hill_cylinder_collapses_at_the_limit_pressure() -> Fallible {
    use CellKind::{Quad4, Quad8, Tri6};
    use Integration::{BBar, Full, Reduced};
    close("limit pressure", limit(), 192.0905814, 1e-9);
    let table = [
        (Quad4, Full, [1.3427, 1.0921, 1.0235, 1.0059], 1e-4),
        (Quad4, BBar, [1.0237, 1.0061, 1.0015, 1.0004], 1e-4),
        (Quad8, Full, [1.0074, 1.00056, 1.00004, 1.000001], 5e-5),
        (Quad8, Reduced, [1.00015, 1.00001, 1.0, 0.999999], 1e-5),
        // These depend on the diagonals on coarse meshes.
        (Tri6, Reduced, [1.0010, 1.00005, 1.000002, 0.999999], 1.5e-4),
    ];
    for (kind, rule, row, tolerance) in table {
        let mut before = f64::INFINITY;
        for (n, expected) in [2, 4, 8, 16].into_iter().zip(row) {
            let (ratio, slope) = collapse(kind, rule, n)?;
            close(
                &format!("{kind} {rule:?} n = {n}"),
                ratio,
                expected,
                tolerance,
            );
            assert!(
                ratio < before + 1e-6,
                "the limit load does not rise under refinement"
            );
            // Elements that lock creep up for long.
            let flat = slope.abs() < 1e-3;
            assert!(
                flat || kind.locks(rule),
                "{kind} n = {n}: no plateau, slope {slope:.1e}"
            );
            before = ratio;
        }
        if kind != Quad4 {
            close(&format!("{kind} {rule:?} limit"), before, 1.0, 1e-5);
        }
    }
    Ok(())
}

/// Under a pressure beyond collapse the step ends at the limit pressure, with a kinematic bound
/// that is as close.
#[test]
fn pressure_beyond_collapse_ends_at_the_limit_pressure() -> Fallible {
    for (kind, rule, n, expected) in [
        (CellKind::Quad8, Integration::Reduced, 8, 1.0),
        (CellKind::Quad8, Integration::Reduced, 4, 1.00001),
        (CellKind::Tri6, Integration::Reduced, 8, 1.000002),
    ] {
        let mut driver = body(kind, rule, n, 0.3)?;
        let step = held("too much").pressure("body.left", 1.25 * limit());
        let found = collapse_of(&mut driver, &step, 25)?;
        let name = format!("{kind} {rule:?} n = {n}");
        close(&name, 1.25 * found.load_factor, expected, 1e-5);
        let bound = found.upper_bound.ok_or("von Mises has a bound")?;
        close(&name, bound.load_factor, found.load_factor, 1e-5);
        assert!(bound.load_factor >= found.load_factor * (1.0 - 1e-9));
        assert!(!bound.coulomb && bound.elastic_share < 2e-5, "{bound:?}");
    }
    Ok(())
}

/// The elastic law alone never yields: the same cylinder takes any pressure.
#[test]
fn elastic_cylinder_takes_any_pressure_in_one_iteration() -> Fallible {
    let mesh = block2(
        "body",
        CellKind::Quad9,
        &uniform(A, B, 16),
        &uniform(0.0, HEIGHT, 1),
    )?;
    let model = Model::new(mesh, Axisymmetric).material(
        "body",
        Elastic::new(E, 0.3)?,
        Integration::Full,
    )?;
    let mut driver = Driver::new(model, Settings::default())?;
    let reports = driver.run(
        &held("load").pressure("body.left", 10.0 * limit()),
        1,
        |_, _| {},
    )?;
    assert_eq!(reports[0].newton_iterations, 1);
    let exact = 2.0 * 10.0 * limit() * A * A * B * (1.0 - 0.09) / (E * (B * B - A * A));
    close("growth", outer_growth(&driver)?, exact, 1e-5);
    Ok(())
}
