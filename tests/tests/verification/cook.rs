//! Cook's membrane: elastic in plane stress, nearly incompressible, and elastoplastic close to
//! collapse; not a proof of convergence, which is measured on smooth solutions.
//!
//! Source: R. D. Cook, *Journal of the Structural Division ASCE* 100 (1974) 1851-1863; the
//! numbers were computed independently.

use crate::close;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{BulkLaw, Elastic, VonMises};
use moreau::mesh::{CellKind, Integration, PlaneStrain};
use verification::problems::Fallible;
use verification::problems::shapes::cook;

use CellKind::{Quad4, Quad8, Tri6};
use Integration::{BBar, Full, Reduced};

/// Upward displacement of the point (48, y) of the loaded side.
fn deflection(
    (kind, rule): (CellKind, Integration),
    n: usize,
    law: impl BulkLaw,
    (force, steps): (f64, usize),
    y: f64,
) -> Fallible<f64> {
    let mesh = cook(kind, n)?;
    let model = Model::new(mesh, PlaneStrain::default()).material("body", law, rule)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("shear")
        .fix("body.left", &[Axis::X, Axis::Y])
        .traction("body.right", [0.0, force / 16.0]);
    driver.run(&step, steps, |_, _| {})?;
    let at = |x: &[f64; 2]| (x[0] - 48.0).abs() < 1e-9 && (x[1] - y).abs() < 1e-9;
    let node = driver
        .mesh()
        .nodes()
        .iter()
        .position(at)
        .ok_or("no node there")?;
    Ok(driver.displacement(node)[1])
}

#[test]
fn cook_membrane_elastic_in_plane_stress() -> Fallible {
    // Plane stress is plane strain with other constants: E(1 + 2ν)/(1 + ν)² and ν/(1 + ν).
    let nu: f64 = 1.0 / 3.0;
    let law = Elastic::new((1.0 + 2.0 * nu) / (1.0 + nu).powi(2), nu / (1.0 + nu))?;
    let table = [
        (Quad4, Full, [11.845, 18.299, 22.079, 23.430, 23.818]),
        (Quad8, Full, [22.718, 23.708, 23.884, 23.935, 23.955]),
        (Quad8, Reduced, [23.171, 23.726, 23.888, 23.939, 23.956]),
    ];
    for (kind, rule, row) in table {
        let mut before = 0.0;
        for (n, expected) in [2, 4, 8, 16, 32].into_iter().zip(row) {
            let v = deflection((kind, rule), n, law, (1.0, 1), 52.0)?;
            close(
                &format!("{kind} {rule:?} n = {n}"),
                v,
                expected,
                5e-4 / expected,
            );
            assert!(v > before && v < 23.965, "from below, to 23.965: {v}");
            before = v;
        }
    }
    // Triangles depend on the diagonals: the limit and its side, not the table.
    for rule in [Reduced, Full] {
        let mut before = 0.0;
        for n in [2, 4, 8, 16, 32] {
            let v = deflection((Tri6, rule), n, law, (1.0, 1), 52.0)?;
            assert!(v > before && v < 23.965, "from below, to 23.965: {v}");
            before = v;
        }
        close("tri6 n = 32", before, 23.965, 1e-3);
    }
    Ok(())
}

#[test]
fn cook_membrane_nearly_incompressible_shows_who_locks() -> Fallible {
    let law = Elastic::new(240.565, 0.4999)?;
    let table = [
        (Quad4, Full, [2.11, 2.16, 2.22, 2.40]),
        (Quad4, BBar, [4.94, 6.80, 7.60, 7.89]),
        (Quad8, Full, [4.60, 6.86, 7.57, 7.84]),
        (Quad8, Reduced, [6.56, 7.38, 7.77, 7.95]),
    ];
    for (kind, rule, row) in table {
        for (n, expected) in [2, 4, 8, 16].into_iter().zip(row) {
            let v = deflection((kind, rule), n, law, (100.0, 1), 60.0)?;
            close(
                &format!("{kind} {rule:?} n = {n}"),
                v,
                expected,
                5.1e-3 / expected,
            );
        }
    }
    Ok(())
}

/// The load is close to collapse: the hardest of the three.
#[test]
fn cook_membrane_elastoplastic_close_to_collapse() -> Fallible {
    let law = VonMises::new(70.0, 1.0 / 3.0, 0.243)?.with_isotropic(0.135)?;
    let table = [
        (Quad4, Full, [0.445, 0.643, 0.906, 1.272]),
        (Quad4, BBar, [0.631, 0.997, 1.510, 2.004]),
        (Quad8, Full, [1.222, 1.880, 2.238, 2.305]),
        (Quad8, Reduced, [1.466, 2.263, 2.346, 2.322]),
    ];
    for (kind, rule, row) in table {
        for (n, expected) in [4, 8, 16, 32].into_iter().zip(row) {
            if n == 32 && kind == Quad8 && rule == Full {
                continue;
            }
            let v = deflection((kind, rule), n, law.clone(), (1.8, 20), 60.0)?;
            close(&format!("{kind} {rule:?} n = {n}"), v, expected, 1e-2);
            if n == 32 && kind == Quad8 {
                close("limit", v, 2.32, 1e-2);
            }
        }
    }
    Ok(())
}
