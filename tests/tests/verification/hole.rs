//! Strip with a central hole in plane strain tension: the exact limit load is that of the net
//! section, whether the hole is round or square; not a stress concentration.
//!
//! Exact since the lines of slip at 45° from the edge of the hole carry the load that the stress
//! 2k in the net section does.

use crate::close;
use moreau::driver::{Axis, Driver, Model, Settings, Step, StepError};
use moreau::laws::VonMises;
use moreau::mesh::{CellKind, Integration, PlaneStrain};
use verification::problems::Fallible;
use verification::problems::limit::{final_slope, load_curve};
use verification::problems::shapes::{Hole, holed_plate};

const WIDTH: f64 = 10.0;
const YIELD: f64 = 300.0;
const E: f64 = 210e3;
/// Remote stress at collapse over the yield stress: (1 − ½) 2/√3.
const EXACT: f64 = 0.577_350_269_189_625_8;

fn strip(
    hole: Hole,
    length: f64,
    kind: CellKind,
    rule: Integration,
    n: usize,
) -> Fallible<Driver<2>> {
    let mesh = holed_plate(kind, hole, (WIDTH, length, 0.5 * WIDTH), n)?;
    let model = Model::new(mesh, PlaneStrain::default()).material(
        "body",
        VonMises::new(E, 0.3, YIELD)?,
        rule,
    )?;
    Ok(Driver::new(model, Settings::default())?)
}

fn symmetric(name: &str) -> Step<2> {
    Step::new(name)
        .fix("body.top", &[Axis::X])
        .fix("body.bottom", &[Axis::Y])
}

/// Remote stress at collapse over the yield stress, and the final slope.
fn collapse(hole: Hole, kind: CellKind, rule: Integration, n: usize) -> Fallible<(f64, f64)> {
    let mut driver = strip(hole, 0.9 * WIDTH, kind, rule, n)?;
    let step = symmetric("pull").displace("plate.top", Axis::Y, 20.0 * YIELD / E * WIDTH);
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

/// A traction 20 % beyond collapse: the step stops near the limit load.
#[test]
fn traction_beyond_collapse_stops_at_the_limit_load() -> Fallible {
    // Long enough for the bridge above the hole to hold.
    let mut driver = strip(
        Hole::Round,
        3.0 * WIDTH,
        CellKind::Quad8,
        Integration::Reduced,
        8,
    )?;
    let step = symmetric("too much").pressure("plate.top", -1.2 * EXACT * YIELD);
    match driver.run(&step, 12, |_, _| {}) {
        Err(StepError::Stopped {
            reached,
            plastic_fraction,
            ..
        }) => {
            close("load reached", 1.2 * reached, 1.0, 2e-2);
            assert!(plastic_fraction > 0.02, "{plastic_fraction}");
        }
        other => panic!("expected a stop, found {other:?}"),
    }
    Ok(())
}
