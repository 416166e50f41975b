//! Who locks in plastic flow: limit loads of every element under every rule, in the plane and in
//! space; not the benchmarks themselves, which are in files of their own.

use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::VonMises;
use moreau::mesh::{CellKind, Integration, Solid};
use verification::problems::Fallible;
use verification::problems::collapsing::{cylinder, notch};
use verification::problems::limit::{final_slope, load_curve};
use verification::problems::shapes::{Hole, holed_slab};

use CellKind::{Hex8, Hex20, Hex27, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6};
use Integration::{BBar, Full, Reduced};

/// Limit loads over the exact ones: of the thick cylinder with four cells, and of the notch with two
/// in half its ligament and its final slope. Whoever locks is far above and still rising there.
#[test]
fn plane_elements_lock_as_they_are_said_to() -> Fallible {
    for (kind, rule) in [
        (Tri6, Reduced),
        (Tri6, Full),
        (Quad4, Full),
        (Quad4, BBar),
        (Quad8, Reduced),
        (Quad8, Full),
        (Quad9, Reduced),
        (Quad9, Full),
    ] {
        let name = format!("{kind} {rule:?}");
        let (cylinder, _) = cylinder::collapse(kind, rule, 4)?;
        let (notch, slope) = notch::net_stress(kind, rule, 2)?;
        if kind.locks(rule) {
            assert!(cylinder > 1.05 && notch > 1.2 && slope > 1e-3, "{name}");
        } else {
            assert!(cylinder > 1.0 && cylinder < 1.0065, "{name}: {cylinder}");
            assert!(notch > 1.0 && notch < 1.12, "{name}: {notch}");
            assert!(slope.abs() < 1e-3, "{name}: no plateau, {slope:e}");
        }
        if rule == kind.integration() {
            assert!(!kind.locks(rule), "{name}");
        }
    }
    Ok(())
}

/// A mean over nine nodes is none too few: limit loads come out below the exact one. That is why
/// biquadratic cells have the full rule by default, though it is a little stiff; two by two points
/// leave them mechanisms.
#[test]
fn the_mean_dilatation_of_quadratic_cells_errs_below() -> Fallible {
    let (mean, _) = cylinder::collapse(Quad9, BBar, 4)?;
    let (full, _) = cylinder::collapse(Quad9, Full, 4)?;
    assert!(mean < 0.99 && full > 1.0 && full < 1.001, "{mean} {full}");
    Ok(())
}

/// Linear triangles in pairs along alternating diagonals flow; along parallel ones they do not.
#[test]
fn linear_triangles_are_the_worse_of_the_plane() -> Fallible {
    let (linear, _) = notch::net_stress(Tri3, Full, 2)?;
    let (quadratic, _) = notch::net_stress(Tri6, Tri6.integration(), 2)?;
    assert!(linear > 1.2 && quadratic < 1.07, "{linear} {quadratic}");
    Ok(())
}

/// The strip with a hole in one layer of solid cells, four from the hole to the edge.
#[test]
fn solid_elements_lock_as_they_are_said_to() -> Fallible {
    for (kind, rule) in [
        (Tet4, Full),
        (Tet10, Reduced),
        (Hex8, Full),
        (Hex8, BBar),
        (Hex20, Reduced),
        (Hex27, Full),
    ] {
        let name = format!("{kind} {rule:?}");
        let (load, slope) = slab(kind, rule, 4)?;
        if kind.locks(rule) {
            assert!(load > 1.15, "{name}: {load}");
        } else {
            assert!(load > 1.0 && load < 1.04, "{name}: {load}");
            assert!(slope.abs() < 1e-3, "{name}: no plateau, {slope:e}");
            assert_eq!(rule, kind.integration());
        }
    }
    Ok(())
}

/// The rule makes cells stiff, not the nodes that quad9 and hex27 have more of: under the full rule
/// they err as quad8 and hex20 do, to 2 % of that error and a little less, and twice as much as those
/// under the reduced rule. All errors are above the exact load, and fade as meshes are refined.
#[test]
fn the_full_rule_is_stiff_whatever_the_nodes() -> Fallible {
    type Load = fn(CellKind, Integration, usize) -> Fallible<(f64, f64)>;
    let cases: [(CellKind, CellKind, Load); 2] =
        [(Quad8, Quad9, notch::net_stress), (Hex20, Hex27, slab)];
    for (serendipity, complete, load) in cases {
        let errors = |n: usize| -> Fallible<[f64; 3]> {
            let error = |kind, rule| load(kind, rule, n).map(|(load, _)| load - 1.0);
            Ok([
                error(serendipity, Reduced)?,
                error(serendipity, Full)?,
                error(complete, Full)?,
            ])
        };
        let (coarse, fine) = (errors(2)?, errors(4)?);
        for [reduced, full, more] in [coarse, fine] {
            assert!(reduced > 0.0 && reduced < 0.65 * full, "{reduced} {full}");
            assert!(more < full && more > 0.98 * full, "{more} {full}");
        }
        assert!(coarse.iter().zip(fine).all(|(c, f)| f < 0.55 * c));
        let apart = |[reduced, _, more]: [f64; 3]| more - reduced;
        assert!(apart(fine) < 0.5 * apart(coarse), "{coarse:?} {fine:?}");
    }
    Ok(())
}

/// Remote stress at collapse over the exact one, (1 − d/W) 2/√3 σ_y, of a strip with a round hole in
/// plane strain, as one layer of solid cells; and the final slope.
fn slab(kind: CellKind, rule: Integration, n: usize) -> Fallible<(f64, f64)> {
    const E: f64 = 210e3;
    const YIELD: f64 = 300.0;
    let mesh = holed_slab(kind, Hole::Round, (10.0, 9.0, 5.0), 1.0, n)?;
    let model = Model::new(mesh, Solid).material("body", VonMises::new(E, 0.3, YIELD)?, rule)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("pull")
        .fix("body.top", &[Axis::X])
        .fix("body.bottom", &[Axis::Y])
        .fix("body", &[Axis::Z])
        .displace("plate.top", Axis::Y, 200.0 * YIELD / E);
    let curve = load_curve(&mut driver, &step, 16, |driver| {
        driver.reaction("plate.top").map_or(f64::NAN, |f| f[1]) / (5.0 * YIELD)
    })?;
    Ok((curve[15] * 3f64.sqrt(), final_slope(&curve)))
}
