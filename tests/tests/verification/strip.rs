//! Strip compressed between parallel rough plates: mean pressure from sliding to sticking, and the
//! core that sticks; not upsetting at large strain.
//!
//! Sources: the slab method, which is an estimate that is good for small friction, and Hill's
//! solution for perfectly rough plates (*The Mathematical Theory of Plasticity*, Clarendon Press
//! 1950, chapter VIII); mean pressures in between were computed independently.

use crate::close;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, VonMises};
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use verification::problems::Fallible;

/// Half width and half height [mm].
const A: f64 = 40.0;
const H: f64 = 10.0;
const YIELD: f64 = 300.0;

/// A quarter of the strip under its plate.
fn strip(mu: f64, cells: (usize, usize), hardening: f64) -> Fallible<Driver<2>> {
    let (x, y) = (uniform(0.0, A, cells.0), uniform(0.0, H, cells.1));
    let law = VonMises::new(210e3, 0.3, YIELD)?.with_isotropic(hardening)?;
    let model = Model::new(
        block2("strip", CellKind::Quad8, &x, &y)?,
        PlaneStrain::default(),
    )
    .material("strip", law, Integration::Reduced)?
    .tool("plate", Plane::new([0.0, H], [0.0, -1.0])?)?
    .contact("strip.top", "plate", Coulomb::new(mu)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Mean pressure over 2k, and the number of contact points that do not slide.
fn compressed(mu: f64, cells: (usize, usize), steps: usize) -> Fallible<(f64, usize)> {
    let mut driver = strip(mu, cells, 0.0)?;
    let step = Step::new("compress")
        .fix("strip.left", &[Axis::X])
        .fix("strip.bottom", &[Axis::Y])
        .tool("plate", [0.0, -0.2]);
    let reports = driver.run(&step, steps, |_, _| {})?;
    let force = -driver.tool_force("plate")?[1];
    let last = &reports[reports.len() - 1];
    assert_eq!(last.open, 0, "no point leaves the plate");
    Ok((
        force / A / (2.0 * YIELD / 3f64.sqrt()),
        driver.contacts().len() - last.slip,
    ))
}

#[test]
fn hill_strip_between_rough_plates() -> Fallible {
    let table = [
        (0.05, 1.1048, 2),
        (0.1, 1.2177, 3),
        (0.2, 1.446, 10),
        (0.3, 1.647, 19),
        (0.5, 1.780, 37),
        (5.0, 1.7965, 49),
    ];
    let mut before = 1.0;
    for (mu, expected, core) in table {
        let (mean, stuck) = compressed(mu, (24, 6), 20)?;
        close(&format!("mean pressure, mu = {mu}"), mean, expected, 5e-4);
        assert_eq!(stuck, core, "points that stick, mu = {mu}");
        if mu <= 0.1 {
            let z = 2.0 * mu * A / (2.0 * H);
            close("slab method", mean, (z.exp() - 1.0) / z, 1.5e-2);
        }
        if mu == 5.0 {
            close("Hill's rough plates", mean, 1.75, 3e-2);
            assert!(mean > 1.75, "from above");
        }
        assert!(mean >= before, "friction only adds");
        before = mean;
    }
    Ok(())
}

#[test]
fn hill_strip_perfectly_rough_on_a_fine_mesh() -> Fallible {
    let (mean, _) = compressed(5.0, (48, 12), 20)?;
    close("Hill's rough plates", mean, 1.75, 1.6e-2);
    assert!(mean > 1.75, "from above");
    Ok(())
}

/// Without friction the stress is uniform and the velocity is not unique: the load is.
#[test]
fn smooth_plates_compress_uniformly() -> Fallible {
    for hardening in [0.0, 21.0] {
        let mut driver = strip(0.0, (24, 6), hardening)?;
        let step = Step::new("compress")
            .fix("strip.left", &[Axis::X])
            .fix("strip.bottom", &[Axis::Y])
            .tool("plate", [0.0, -0.2]);
        driver.run(&step, 20, |_, _| {})?;
        let mean = -driver.tool_force("plate")?[1] / A;
        let limit = 2.0 / 3f64.sqrt() * YIELD;
        // With hardening: p = 2/√3 ε_y at most, so H p adds no more than this.
        let more = 4.0 / 3.0 * hardening * 0.2 / H;
        assert!(mean <= limit + more + 1e-6 * limit, "{mean} above {limit}");
        close("load", mean, limit + 0.5 * more, 2e-3);
        for point in driver.points() {
            let worst = (point.stress[1] + mean).abs().max(point.stress[0].abs()) / limit;
            assert!(
                worst < 1e-6,
                "stress not uniform: {worst:.1e} at {:?}",
                point.position
            );
        }
    }
    Ok(())
}
