//! Deep double-edge notch in plane strain tension: the limit load that locking elements never
//! reach; not a crack.
//!
//! Source: J. C. Nagtegaal, D. M. Parks and J. R. Rice, *Computer Methods in Applied Mechanics and
//! Engineering* 4 (1974) 153-177.

use crate::close;
use moreau::mesh::{CellKind, Integration};
use std::f64::consts::PI;
use verification::problems::Fallible;
use verification::problems::collapsing::notch::{body, exact, held, net_stress};
use verification::problems::limit::{collapse_of, load_at};

#[test]
fn nagtegaal_parks_rice_notch_collapses_from_above() -> Fallible {
    close(
        "limit stress over yield stress",
        (2.0 + PI) / 3f64.sqrt(),
        2.96850,
        1e-5,
    );
    // Net stress over yield stress: no more than an independent code found.
    let table = [
        (CellKind::Quad4, Integration::BBar, [3.67, 3.19, 3.04]),
        (CellKind::Quad8, Integration::Full, [3.57, 3.15, 3.02]),
        (CellKind::Quad8, Integration::Reduced, [3.32, 3.07, 2.999]),
    ];
    for (kind, rule, row) in table {
        let mut before = f64::INFINITY;
        for (n, expected) in [2, 4, 8].into_iter().zip(row) {
            let (ratio, slope) = net_stress(kind, rule, n)?;
            assert!(
                ratio > 1.0 && ratio < before,
                "not from above: {ratio} after {before}"
            );
            assert!(
                ratio * 2.96850 <= expected,
                "error larger than expected: {ratio}"
            );
            assert!(
                slope.abs() < 1e-3,
                "{kind} {rule:?} n = {n}: no plateau, slope {slope:.1e}"
            );
            before = ratio;
        }
    }
    Ok(())
}

/// Fully integrated linear quadrilaterals cannot flow without changing their volume.
#[test]
fn linear_quadrilaterals_lock_in_the_notch() -> Fallible {
    let mut before = f64::INFINITY;
    for n in [2, 4] {
        let (ratio, slope) = net_stress(CellKind::Quad4, Integration::Full, n)?;
        // Above the error of the quadratic elements, and rising still.
        assert!(
            ratio > 3.57 / 2.96850 && slope > 1e-3,
            "they should lock: {ratio}, {slope:e}"
        );
        assert!(ratio < before);
        before = ratio;
    }
    Ok(())
}

/// A load goes along the plateau of the displacements, and the mechanism bounds it.
#[test]
fn a_load_beyond_that_of_the_notch_ends_on_its_plateau() -> Fallible {
    let quad8 = || body(CellKind::Quad8, Integration::Reduced, 4);
    let mut driver = quad8()?;
    // The top stays almost plane: it is far away.
    let step = held("pull").pressure("body.top", -1.5 * exact() / 5.0);
    let found = collapse_of(&mut driver, &step, 10)?;
    // The load still creeps up on the plateau: compared at the same displacement, reached alike.
    let mut moved = quad8()?;
    let plateau = load_at(&driver, &mut moved, "body.top", held)? / exact();
    close("load factor", 1.5 * found.load_factor, plateau, 1e-4);
    let bound = found.upper_bound.ok_or("von Mises has a bound")?;
    assert!(bound.load_factor >= found.load_factor && 1.5 * bound.load_factor > 1.0);
    close("bound", bound.load_factor, found.load_factor, 1e-3);
    Ok(())
}
