//! Elastoplastic bars in space: torsion and bending, whose moments are known at every stage; not
//! their ends.
//!
//! Source: R. Hill, *The Mathematical Theory of Plasticity*, Clarendon Press 1950, chapter IV.

use crate::close;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::VonMises;
use moreau::mesh::{CellKind, Mesh, Solid, block3, uniform};
use nalgebra::{SVector, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};
use verification::problems::Fallible;
use verification::problems::fields::prescribed;

const E: f64 = 210e3;
const YIELD: f64 = 300.0;
/// Length of a slice along the axis z.
const LENGTH: f64 = 4.0;

fn driver(mesh: Mesh<3>, nu: f64) -> Fallible<Driver<3>> {
    let rule = mesh.kind(0).integration();
    let model = Model::new(mesh, Solid).material("bar", VonMises::new(E, nu, YIELD)?, rule)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Moment of the reactions of a side about the origin.
fn moment(driver: &Driver<3>, side: &str) -> Fallible<SVector<f64, 3>> {
    let moment =
        |a: usize| Vector3::from(driver.mesh().nodes()[a]).cross(&driver.nodal_reaction(a));
    Ok(driver
        .mesh()
        .node_group(side)?
        .into_iter()
        .map(moment)
        .sum())
}

/// 5.4: T/T_y = 4/3 (1 − (r_p/R)³/4) for a round bar, which yields outside of r_p; and its collapse
/// moment ⅔ π k R³. A quarter of the bar, with a hole of a fiftieth of its radius on its axis, which
/// carries nothing.
#[test]
fn a_round_bar_twists_as_the_exact_solution() -> Fallible {
    const R: f64 = 10.0;
    const HOLE: f64 = 0.2;
    let shear = E / 2.6;
    let k = YIELD / 3f64.sqrt();
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        let (r, angle) = (uniform(HOLE, R, 4), uniform(0.0, FRAC_PI_2, 6));
        let mesh = block3("bar", kind, &r, &angle, &uniform(0.0, LENGTH, 1))?;
        let mesh = mesh.map(|[r, t, z]| match t == FRAC_PI_2 {
            true => [0.0, r, z],
            false => [r * t.cos(), r * t.sin(), z],
        })?;
        let mut driver = driver(mesh, 0.3)?;
        // Points of a plane of antisymmetry move across it.
        let step = Step::new("twist")
            .fix("bar.bottom", &[Axis::X, Axis::Z])
            .fix("bar.top", &[Axis::Y, Axis::Z]);
        let ends = [
            driver.mesh().node_group("bar.back")?,
            driver.mesh().node_group("bar.front")?,
        ]
        .concat();
        let elastic = PI / 2.0 * k * R.powi(3);
        for (front, tolerance) in [
            (1.0, 5e-3),
            (0.75, 5e-3),
            (0.5, 5e-3),
            (0.3, 5e-3),
            (0.02, 5e-3),
        ] {
            let twist = k / (shear * front * R);
            let end = prescribed(&driver, &step, &ends, |&[x, y, z]| {
                [-twist * z * y, twist * z * x, 0.0]
            })?;
            driver.advance(&end)?;
            let exact = 4.0 / 3.0 * (1.0 - f64::powi(front, 3) / 4.0);
            let found = 4.0 * moment(&driver, "bar.front")?[2] / elastic;
            close(
                &format!("{kind}, front at {front} R"),
                found,
                exact,
                tolerance,
            );
            // Nothing but shear across the radius.
            for p in driver.points() {
                let [x, y, _] = p.position;
                let along = (y * p.stress[4] - x * p.stress[3]) / x.hypot(y);
                let other = (p.stress.norm_squared() - along * along).max(0.0).sqrt();
                assert!(
                    other <= 2e-2 * YIELD,
                    "{kind}: {other} MPa beside the shear"
                );
            }
        }
        let limit = 4.0 * moment(&driver, "bar.front")?[2];
        close("collapse", limit, 2.0 / 3.0 * PI * k * R.powi(3), 5e-3);
    }
    Ok(())
}

/// 5.3: M/M_e = 1.5 − ½ (κ_e/κ)² for a strip that is free to narrow, as thin as to be in plane
/// stress; half of it, above the neutral line.
#[test]
fn a_strip_bends_as_the_exact_solution() -> Fallible {
    const HALF: f64 = 4.0;
    const THICK: f64 = 0.2;
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        let (x, y) = (uniform(0.0, HALF, 4), uniform(0.0, THICK, 1));
        let mut mesh = block3("bar", kind, &x, &y, &uniform(0.0, LENGTH, 2))?;
        mesh.node_group_where("foot", "bar.back", |x| x[0] == 0.0)?;
        let mut driver = driver(mesh, 0.3)?;
        // The neutral line bends and is not stretched.
        let step = Step::new("bend")
            .fix("bar.back", &[Axis::Z])
            .fix("bar.left", &[Axis::Z])
            .fix("bar.bottom", &[Axis::Y])
            .fix("foot", &[Axis::X]);
        let front = driver.mesh().node_group("bar.front")?;
        let yields = YIELD / (E * HALF);
        let elastic = YIELD * THICK * HALF * HALF / 3.0;
        for ratio in [1.0, 1.25, 1.5, 2.0, 3.0] {
            let mut end = driver.loading(&step)?;
            for &a in &front {
                let x = driver.mesh().nodes()[a][0];
                end.displacement
                    .insert(3 * a + 2, ratio * yields * x * LENGTH);
            }
            driver.advance(&end)?;
            let exact = 1.5 - 0.5 / (ratio * ratio);
            let found = -moment(&driver, "bar.front")?[1] / elastic;
            close(&format!("{kind}, κ = {ratio} κ_e"), found, exact, 5e-3);
        }
    }
    Ok(())
}
