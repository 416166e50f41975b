//! Strip with a central hole in plane strain tension: the exact limit load is that of the net
//! section, whether the hole is round or square; not a stress concentration.
//!
//! Exact since the lines of slip at 45° from the edge of the hole carry the load that the stress
//! 2k in the net section does.

use crate::close;
use moreau::driver::Axis;
use moreau::mesh::{CellKind, Integration};
use verification::problems::Fallible;
use verification::problems::collapsing::strip::{E, EXACT, WIDTH, YIELD, body, held};
use verification::problems::limit::{collapse_of, final_slope, load_at, load_curve};
use verification::problems::shapes::Hole;

/// Remote stress at collapse over the yield stress, and the final slope.
fn collapse(hole: Hole, kind: CellKind, rule: Integration, n: usize) -> Fallible<(f64, f64)> {
    let mut driver = body(hole, 0.9 * WIDTH, kind, rule, n)?;
    let step = held("pull").displace("plate.top", Axis::Y, 20.0 * YIELD / E * WIDTH);
    let curve = load_curve(&mut driver, &step, 30, |driver| {
        driver.reaction("plate.top").map_or(f64::NAN, |f| f[1]) / (0.5 * WIDTH * YIELD)
    })?;
    Ok((curve[29], final_slope(&curve)))
}

#[test]
fn strip_with_round_hole_collapses_at_the_net_section_load() -> Fallible {
    close("limit stress over yield stress", EXACT, 0.5773503, 1e-7);
    let table = [
        (Integration::Full, [0.596, 0.585, 0.5808]),
        (Integration::Reduced, [0.584, 0.581, 0.5788]),
    ];
    for (rule, row) in table {
        let mut before = f64::INFINITY;
        for (n, expected) in [4, 8, 16].into_iter().zip(row) {
            let (stress, slope) = collapse(Hole::Round, CellKind::Quad8, rule, n)?;
            assert!(
                stress > EXACT && stress < before,
                "not from above: {stress}, {before}"
            );
            close(&format!("{rule:?} n = {n}"), stress, expected, 3e-3);
            assert!(
                slope.abs() < 1e-3,
                "{rule:?} n = {n}: no plateau, slope {slope:.1e}"
            );
            before = stress;
        }
    }
    Ok(())
}

/// The lines of slip from the corners of a square hole run along the diagonals of the cells.
#[test]
fn strip_with_square_hole_collapses_at_the_net_section_load() -> Fallible {
    for (rule, tolerances) in [
        (Integration::Full, [2e-3, 5e-4, 2e-4]),
        (Integration::Reduced, [2e-4; 3]),
    ] {
        for (n, tolerance) in [4, 8, 16].into_iter().zip(tolerances) {
            let (stress, slope) = collapse(Hole::Square, CellKind::Quad8, rule, n)?;
            close(&format!("{rule:?} n = {n}"), stress, EXACT, tolerance);
            assert!(
                rule == Integration::Reduced || stress > EXACT,
                "not from above: {stress}"
            );
            assert!(
                slope.abs() < 1e-3,
                "{rule:?} n = {n}: no plateau, slope {slope:.1e}"
            );
        }
    }
    Ok(())
}

#[test]
fn linear_quadrilaterals_lock_in_the_holed_strip() -> Fallible {
    let mut before = f64::INFINITY;
    for n in [4, 8, 16] {
        let (stress, slope) = collapse(Hole::Round, CellKind::Quad4, Integration::Full, n)?;
        // Above the quadratic ones on half the cells, and rising still.
        assert!(stress > 1.05 * EXACT && stress < before, "{stress}");
        assert!(slope > 1e-3, "n = {n}: a plateau, slope {slope:.1e}");
        before = stress;
    }
    Ok(())
}

/// A traction beyond collapse ends at the plateau that displacements of the end reach, and the
/// mechanism bounds it.
#[test]
fn traction_beyond_collapse_ends_at_the_limit_load() -> Fallible {
    let rule = Integration::Reduced;
    for (hole, coarse) in [(Hole::Round, 1.5e-2), (Hole::Square, 2e-3)] {
        // Long enough for the bridge above the hole to hold.
        let length = 3.0 * WIDTH;
        let mut driver = body(hole, length, CellKind::Quad8, rule, 8)?;
        let step = held("too much").pressure("plate.top", -1.2 * EXACT * YIELD);
        let found = collapse_of(&mut driver, &step, 12)?;
        let mut moved = body(hole, length, CellKind::Quad8, rule, 8)?;
        let plateau = load_at(&driver, &mut moved, "plate.top", held)?;
        let plateau = plateau / (0.5 * WIDTH * YIELD) / EXACT;
        let reached = 1.2 * found.load_factor;
        close("load factor", reached, plateau, 1e-4);
        // From above, by what the coarse mesh is too stiff.
        assert!(
            (-1e-4..coarse).contains(&(reached - 1.0)),
            "{hole:?} {reached}"
        );
        let bound = found.upper_bound.ok_or("von Mises has a bound")?;
        close("bound", bound.load_factor, found.load_factor, 1e-4);
        assert!(1.2 * bound.load_factor > 1.0 - 1e-4, "{bound:?}");
    }
    Ok(())
}
