//! Hollow sphere under internal pressure: the elastoplastic solution that is exact for any
//! Poisson's ratio, loaded, unloaded and up to its limit pressure; not a thin shell.
//!
//! Source: R. Hill, *The Mathematical Theory of Plasticity*, Clarendon Press 1950, chapter V.

use crate::close;
use moreau::driver::Driver;
use moreau::laws::{Elastic, VonMises};
use moreau::mandel::Sym2;
use nalgebra::Vector2;
use std::f64::consts::PI;
use verification::problems::Fallible;
use verification::problems::collapsing::sphere::{A, B, E, NU, YIELD, body, held, limit};
use verification::problems::fields::prescribed;
use verification::problems::limit::{collapse_of, final_slope};

/// Pressure at which the elastic-plastic front is at radius c [MPa].
fn pressure(c: f64) -> f64 {
    2.0 * YIELD * ((c / A).ln() + (1.0 - (c / B).powi(3)) / 3.0)
}

/// Displacement of the outer surface at that pressure [mm].
fn growth(c: f64) -> f64 {
    YIELD * c.powi(3) * (1.0 - NU) / (E * B * B)
}

fn steel() -> Fallible<VonMises> {
    Ok(VonMises::new(E, NU, YIELD)?)
}

/// Mean radial displacement of the outer surface.
fn outer_growth(driver: &Driver<2>) -> Fallible<f64> {
    let nodes = driver.mesh().node_group("body.right")?;
    let radial = |node: &usize| {
        driver
            .displacement(*node)
            .dot(&Vector2::from(driver.mesh().nodes()[*node]))
            / B
    };
    Ok(nodes.iter().map(radial).sum::<f64>() / nodes.len() as f64)
}

#[test]
fn hollow_sphere_grows_as_the_exact_solution() -> Fallible {
    // The formulas against the numbers of the table.
    for (c, p, u) in [
        (120.0, 212.95435, 0.03456),
        (150.0, 287.12325, 0.0675),
        (180.0, 325.49760, 0.11664),
    ] {
        close("pressure", pressure(c), p, 1e-7);
        close("growth", growth(c), u, 1e-7);
    }
    let mut driver = body(steel()?)?;
    // Elastic up to p_e = 140 MPa: u_b = 3 p a³ b (1 − ν) / (2 E (b³ − a³)) by Lamé.
    driver.run(&held("elastic").pressure("body.left", 139.0), 1, |_, _| {})?;
    let (a3, b3) = (A.powi(3), B.powi(3));
    let elastic = 3.0 * 139.0 * a3 * B * (1.0 - NU) / (2.0 * E * (b3 - a3));
    close("elastic growth", outer_growth(&driver)?, elastic, 2e-3);
    for c in [120.0, 150.0, 180.0] {
        driver.run(
            &held("load").pressure("body.left", pressure(c)),
            10,
            |_, _| {},
        )?;
        close(
            &format!("growth at c = {c}"),
            outer_growth(&driver)?,
            growth(c),
            2e-3,
        );
        // Every point of the surface by itself, too.
        for node in driver.mesh().node_group("body.right")? {
            let x = Vector2::from(driver.mesh().nodes()[node]);
            close(
                "growth of a node",
                driver.displacement(node).dot(&x) / B,
                growth(c),
                5e-3,
            );
        }
    }
    Ok(())
}

#[test]
fn hollow_sphere_unloads_elastically_below_twice_the_yield_pressure() -> Fallible {
    let c = 120.0;
    let p = pressure(c);
    assert!(p < 2.0 * 140.0);
    let mut driver = body(steel()?)?;
    driver.run(&held("load").pressure("body.left", p), 10, |_, _| {})?;
    let loaded = driver.points();
    let grown = outer_growth(&driver)?;
    let report = driver.run(&held("unload"), 1, |_, _| {})?;
    assert_eq!(report[0].plastic_fraction, 0.0, "no reverse yielding");
    let unloaded = driver.points();
    // Elastic superposition: the change is the elastic solution under −p, and Lamé's to the error
    // of the mesh.
    let mut elastic = body(Elastic::new(E, NU)?)?;
    elastic.run(&held("load").pressure("body.left", p), 1, |_, _| {})?;
    for ((before, after), exact) in loaded.iter().zip(&unloaded).zip(elastic.points()) {
        let error = (before.stress - after.stress - exact.stress).norm();
        assert!(error <= 1e-9 * YIELD, "superposition off by {error:e} MPa");
    }
    let (a3, b3) = (A.powi(3), B.powi(3));
    let lame = |x: &[f64; 2]| {
        let r = x[0].hypot(x[1]);
        let k = p / (b3 / a3 - 1.0);
        let (radial, hoop) = (
            -k * (b3 / r.powi(3) - 1.0),
            k * (0.5 * b3 / r.powi(3) + 1.0),
        );
        let (cos, sin) = (x[0] / r, x[1] / r);
        let d = radial - hoop;
        Sym2::from_column_slice(&[
            hoop + d * cos * cos,
            hoop + d * sin * sin,
            hoop,
            0.0,
            0.0,
            2f64.sqrt() * d * cos * sin,
        ])
    };
    let mut sum = (0.0, 0.0);
    for (before, after) in loaded.iter().zip(&unloaded) {
        assert_eq!(before.plastic_strain, after.plastic_strain);
        let change = before.stress - after.stress;
        let exact = lame(&before.position);
        sum.0 += before.weight * (change - exact).norm_squared();
        sum.1 += before.weight * exact.norm_squared();
    }
    let error = f64::sqrt(sum.0 / sum.1);
    assert!(error < 5e-3, "change of stress off Lamé's by {error:.2e}");
    let back = 3.0 * p * a3 * B * (1.0 - NU) / (2.0 * E * (b3 - a3));
    close("spring-back", grown - outer_growth(&driver)?, back, 2e-3);
    close(
        "residual growth",
        outer_growth(&driver)?,
        growth(c) - back,
        2e-2,
    );
    // Residual stress at the bore: hoop stress in compression.
    let inner = unloaded.iter().min_by(|a, b| {
        a.position[0]
            .hypot(a.position[1])
            .total_cmp(&b.position[0].hypot(b.position[1]))
    });
    assert!(inner.is_some_and(|p| p.stress[2] < -50.0));
    Ok(())
}

#[test]
fn hollow_sphere_yields_in_reverse_above_twice_the_yield_pressure() -> Fallible {
    let mut driver = body(steel()?)?;
    driver.run(
        &held("load").pressure("body.left", pressure(180.0)),
        20,
        |_, _| {},
    )?;
    let reports = driver.run(&held("unload"), 10, |_, _| {})?;
    assert_eq!(reports[0].plastic_fraction, 0.0);
    assert!(
        reports[9].plastic_fraction > 0.0,
        "the bore yields in reverse"
    );
    Ok(())
}

#[test]
fn hollow_sphere_reaches_its_limit_pressure() -> Fallible {
    let exact = limit();
    close("limit pressure", exact, 332.7106467, 1e-9);
    let mut driver = body(steel()?)?;
    let bore = driver.mesh().node_group("body.left")?;
    let mut curve = Vec::new();
    for step in 1..=20 {
        let u = 0.1 * f64::from(step);
        let loading = prescribed(&driver, &held("grow"), &bore, |x| x.map(|v| v * u / A))?;
        driver.advance(&loading)?;
        // The work of the pressure over that of the radial motion of a half sphere.
        let work: f64 = bore
            .iter()
            .map(|&n| {
                driver
                    .nodal_reaction(n)
                    .dot(&Vector2::from(driver.mesh().nodes()[n]))
                    / A
            })
            .sum();
        curve.push(work / (2.0 * PI * A * A));
    }
    close("limit pressure", curve[19], exact, 2e-3);
    assert!(
        final_slope(&curve).abs() < 1e-3,
        "no plateau: {}",
        final_slope(&curve)
    );
    Ok(())
}

/// Pressed beyond its limit: the exact limit pressure, from the path and from the mechanism.
#[test]
fn hollow_sphere_collapses_at_its_limit_pressure_under_load_control() -> Fallible {
    let exact = limit();
    close("limit pressure", exact, 332.7106467, 1e-9);
    let mut driver = body(steel()?)?;
    let step = held("too much").pressure("body.left", 2.0 * exact);
    let found = collapse_of(&mut driver, &step, 10)?;
    close("limit pressure", 2.0 * found.load_factor, 1.0, 2e-4);
    let bound = found
        .upper_bound
        .ok_or("von Mises has a bound")?
        .load_factor;
    close("bound", bound, found.load_factor, 1e-5);
    assert!(2.0 * bound > 1.0 - 2e-4);
    Ok(())
}
