//! Materials with axes: elasticity and Hill's criterion against closed forms in every direction; not bodies.

use moreau_laws::contract::{bulk, isotropy};
use moreau_laws::{
    BulkLaw, Elastic, Hill, HillCoefficients, InPlaneStress, Isotropic, LawError, Orthotropic,
    VonMises,
};
use moreau_mandel::{Sym2, Sym4, from_matrix, rotation, to_matrix};
use nalgebra::{Matrix3, Rotation3, Vector3};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

const YOUNG: f64 = 210e3;
const YIELD: f64 = 300.0;
/// A sheet: F, G, H, L, M, N with G + H = 1.
const SHEET: [f64; 6] = [0.3, 0.4, 0.6, 1.5, 1.7, 1.2];

/// A composite whose moduli differ by tens.
fn wood() -> Result<Orthotropic, LawError> {
    Orthotropic::new([12e3, 900.0, 500.0], [0.4, 0.45, 0.6], [800.0, 700.0, 60.0])
}

fn turn(angle: f64) -> Matrix3<f64> {
    Rotation3::from_axis_angle(&Vector3::z_axis(), angle).into_inner()
}

#[test]
fn laws_with_axes_obey_the_contract() -> Fallible<()> {
    let axes = Rotation3::new(Vector3::new(0.4, -1.1, 0.7)).into_inner();
    bulk(&wood()?)?;
    bulk(&wood()?.along(&axes))?;
    bulk(&InPlaneStress(wood()?.along(&turn(0.5))))?;
    let sheet = HillCoefficients::new(SHEET)?;
    let steel = Elastic::new(YOUNG, 0.3)?;
    bulk(&Hill::new(steel, sheet, YIELD)?)?;
    bulk(&Hill::new(steel, sheet.along(&axes), YIELD)?)?;
    for hardening in [
        Isotropic::linear(2e3)?,
        Isotropic::voce(150.0, 20.0)?,
        Isotropic::swift(700.0, 0.0145, 0.2)?,
        Isotropic::table(&[[0.0, 300.0], [0.002, 310.0], [0.004, 360.0], [0.1, 380.0]])?,
    ] {
        let own = wood()?.along(&axes);
        bulk(&Hill::new(own, sheet.along(&axes), 20.0)?.with_hardening(hardening.clone()))?;
        let flat = Hill::new(steel, sheet.along(&turn(0.5)), YIELD)?.with_hardening(hardening);
        bulk(&InPlaneStress(flat))?;
    }
    Ok(())
}

/// Tension at an angle to the axes: 1/E = c⁴/E₁ + s⁴/E₂ + c²s² (1/G₁₂ − 2 ν₁₂/E₁).
#[test]
fn a_board_is_as_stiff_as_its_compliance_says() -> Fallible<()> {
    for degrees in [0.0f64, 20.0, 45.0, 77.0, 90.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let law = wood()?.along(&turn(degrees.to_radians()));
        let compliance = law.tangent().try_inverse().ok_or("singular")?;
        let tension = Sym2::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let found = (compliance * tension)[0];
        let shear = 1.0 / 800.0 - 2.0 * 0.4 / 12e3;
        let expected = c.powi(4) / 12e3 + s.powi(4) / 900.0 + (c * s).powi(2) * shear;
        assert!(
            (found / expected - 1.0).abs() < 1e-12,
            "{degrees}: {found} {expected}"
        );
    }
    // Contraction along each axis under tension along another, and shears of each pair.
    let compliance = wood()?.tangent().try_inverse().ok_or("singular")?;
    for ((i, j), expected) in [
        ((0, 1), -0.4 / 12e3),
        ((0, 2), -0.45 / 12e3),
        ((1, 2), -0.6 / 900.0),
        ((5, 5), 0.5 / 800.0),
        ((4, 4), 0.5 / 700.0),
        ((3, 3), 0.5 / 60.0),
    ] {
        for found in [compliance[(i, j)], compliance[(j, i)]] {
            assert!((found / expected - 1.0).abs() < 1e-12, "{i}{j}: {found}");
        }
    }
    Ok(())
}

/// Stress at which tension along a direction flows, and the plastic strain there.
fn tension(law: &Hill, direction: &Vector3<f64>) -> (f64, Sym2) {
    let unit = from_matrix(&(direction * direction.transpose()));
    let compliance = law.elastic_tangent().try_inverse().expect("regular");
    let mut stress = 3.0 * YIELD;
    let mut flow = Sym2::zeros();
    // Uniaxial stress by driving the strain along the flow of the last iterate.
    for _ in 0..3 {
        let response = law.respond(&law.initial(), &(compliance * (stress * unit)));
        flow = response.state.p * Sym2::zeros();
        stress = YIELD / law.equivalent_stress(&unit);
        let past = 1e-9;
        let n = normal(law, &(stress * unit));
        let d_eps = compliance * (stress * unit) + past * n;
        let at = law.respond(&law.initial(), &d_eps);
        flow += d_eps - compliance * at.stress;
        assert!(
            (at.stress - stress * unit).norm() < 1e-6 * YIELD,
            "{}",
            at.stress
        );
    }
    (stress, flow)
}

/// Normal of the yield surface, by differences of σ_eq.
fn normal(law: &Hill, stress: &Sym2) -> Sym2 {
    Sym2::from_fn(|i, _| {
        let mut h = Sym2::zeros();
        h[i] = 1e-3 * YIELD;
        let slope = law.equivalent_stress(&(stress + h)) - law.equivalent_stress(&(stress - h));
        slope / (2e-3 * YIELD)
    })
}

/// Strengths along the axes and at any angle in the sheet, and the ratio of the strains of width and thickness there:
/// r = (H + (2N − F − G − 4H) s²c²)/(F s² + G c²).
#[test]
fn a_sheet_yields_in_every_direction_as_hill_says() -> Fallible<()> {
    let [f, g, h, .., n] = SHEET;
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let law = Hill::new(
        Elastic::new(YOUNG, 0.3)?,
        HillCoefficients::new(SHEET)?,
        YIELD,
    )?;
    for (axis, square) in [(x, g + h), (y, f + h), (z, f + g)] {
        let (found, _) = tension(&law, &axis);
        assert!(
            (found * square.sqrt() / YIELD - 1.0).abs() < 1e-12,
            "{found}"
        );
    }
    for degrees in [0.0f64, 15.0, 45.0, 60.0, 90.0] {
        let (s, c) = degrees.to_radians().sin_cos();
        let (ss, cc) = (s * s, c * c);
        let along = Vector3::new(c, s, 0.0);
        let (stress, flow) = tension(&law, &along);
        let square = f * ss * ss + g * cc * cc + h * (cc - ss) * (cc - ss) + 2.0 * n * ss * cc;
        assert!(
            (stress * square.sqrt() / YIELD - 1.0).abs() < 1e-12,
            "{degrees}: {stress}"
        );
        let across = Vector3::new(-s, c, 0.0);
        let strain = |v: &Vector3<f64>| (v.transpose() * to_matrix(&flow) * v)[0];
        let r = (h + (2.0 * n - f - g - 4.0 * h) * ss * cc) / (f * ss + g * cc);
        let found = strain(&across) / strain(&z);
        assert!((found / r - 1.0).abs() < 1e-5, "{degrees}: {found} {r}");
    }
    Ok(())
}

/// In shear between two of its axes a sheet yields at σ_y/√(2L), σ_y/√(2M) and σ_y/√(2N).
#[test]
fn a_sheet_yields_in_every_shear_as_hill_says() -> Fallible<()> {
    let coefficients = [0.3, 0.4, 0.6, 1.1, 1.7, 2.9];
    let steel = Elastic::new(YOUNG, 0.3)?;
    let law = Hill::new(steel, HillCoefficients::new(coefficients)?, YIELD)?;
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    for ((i, j), c) in [((1, 2), 1.1), ((0, 2), 1.7), ((0, 1), 2.9f64)] {
        let both = axes[i] * axes[j].transpose();
        let response = law.respond(
            &law.initial(),
            &(0.01 * from_matrix(&(both + both.transpose()))),
        );
        let found = to_matrix(&response.stress)[(i, j)];
        let expected = YIELD / (2.0 * c).sqrt();
        assert!(
            (found / expected - 1.0).abs() < 1e-12,
            "{i}{j}: {found} {expected}"
        );
    }
    Ok(())
}

/// Coefficients from Lankford's ratios give these back.
#[test]
fn lankfords_ratios_come_back() -> Fallible<()> {
    let (r0, r45, r90) = (1.8, 1.2, 2.3);
    let law = Hill::new(
        Elastic::new(YOUNG, 0.3)?,
        HillCoefficients::lankford(r0, r45, r90)?,
        YIELD,
    )?;
    for (degrees, r) in [(0.0f64, r0), (45.0, r45), (90.0, r90)] {
        let (s, c) = degrees.to_radians().sin_cos();
        let (stress, flow) = tension(&law, &Vector3::new(c, s, 0.0));
        let across = Vector3::new(-s, c, 0.0);
        let width = (across.transpose() * to_matrix(&flow) * across)[0];
        assert!(
            (width / flow[2] / r - 1.0).abs() < 1e-5,
            "{degrees}: {}",
            width / flow[2]
        );
        if degrees == 0.0 {
            assert!((stress / YIELD - 1.0).abs() < 1e-12);
        }
    }
    Ok(())
}

/// F = G = H = ½ and L = M = N = 3⁄2 are von Mises, stress, tangent and energies; and a law without axes.
#[test]
fn without_axes_it_is_von_mises() -> Fallible<()> {
    let elastic = Elastic::new(YOUNG, 0.3)?;
    let equal = HillCoefficients::new([0.5, 0.5, 0.5, 1.5, 1.5, 1.5])?;
    assert_eq!(equal, HillCoefficients::lankford(1.0, 1.0, 1.0)?);
    for hardening in [Isotropic::linear(1e3)?, Isotropic::voce(150.0, 20.0)?] {
        let hill = Hill::new(elastic, equal, YIELD)?.with_hardening(hardening.clone());
        isotropy(&hill)?;
        let mises = VonMises::new(YOUNG, 0.3, YIELD)?.with_hardening(hardening);
        let (mut a, mut b) = (hill.initial(), mises.initial());
        for step in [
            [4e-3, -1e-3, 0.0, 1e-3, 0.0, 2e-3],
            [-2e-3, 0.0, 3e-3, 0.0, -4e-3, 1e-3],
            [0.1, 0.2, -0.1, 0.0, 0.0, 0.3],
        ] {
            let d_eps = Sym2::from(step);
            let (one, other) = (hill.respond(&a, &d_eps), mises.respond(&b, &d_eps));
            assert!(one.flows && (one.stress - other.stress).norm() < 1e-10 * YIELD);
            assert!((one.tangent - other.tangent).norm() < 1e-10 * YOUNG);
            assert!((one.state.p - other.state.p).abs() < 1e-12);
            let [p, q] = [hill.potential(&a, &d_eps), mises.potential(&b, &d_eps)];
            let [p, q] = [p.ok_or("none")?, q.ok_or("none")?];
            assert!((p - q).abs() < 1e-9 * q.abs(), "{p} {q}");
            (a, b) = (one.state, other.state);
        }
    }
    Ok(())
}

/// A material and its path turned together have the turned stress.
#[test]
fn axes_turn_with_the_material() -> Fallible<()> {
    let sheet = HillCoefficients::new(SHEET)?;
    let turn = Rotation3::new(Vector3::new(0.3, 1.2, -0.8)).into_inner();
    let q: Sym4 = rotation(&turn);
    let law = |axes: &Matrix3<f64>| -> Result<Hill, LawError> {
        let law = Hill::new(wood()?.along(axes), sheet.along(axes), 20.0)?;
        Ok(law.with_hardening(Isotropic::linear(100.0)?))
    };
    let (still, turned) = (law(&Matrix3::identity())?, law(&turn)?);
    let (mut a, mut b) = (still.initial(), turned.initial());
    for step in [
        [4e-2, -1e-2, 0.0, 1e-2, 0.0, 2e-2],
        [-2e-2, 0.0, 3e-2, 0.0, -4e-2, 1e-2],
    ] {
        let d_eps = Sym2::from(step);
        let (one, other) = (still.respond(&a, &d_eps), turned.respond(&b, &(q * d_eps)));
        assert!(one.flows && (q * one.stress - other.stress).norm() < 1e-11 * one.stress.norm());
        let apart = q * one.tangent * q.transpose() - other.tangent;
        assert!(apart.norm() < 1e-11 * 12e3);
        (a, b) = (one.state, other.state);
    }
    Ok(())
}

#[test]
fn data_that_define_no_material_with_axes_are_refused() {
    let young = [12e3, 900.0, 500.0];
    let shear = [800.0, 700.0, 60.0];
    for (poisson, refused) in [
        ([0.4, 0.45, 0.6], false),
        ([4.0, 0.45, 0.6], true),
        ([0.4, 0.45, 1.4], true),
        ([f64::NAN, 0.45, 0.6], true),
    ] {
        let error = Orthotropic::new(young, poisson, shear).err();
        assert_eq!(error.is_some(), refused, "{poisson:?}");
        let is_told = error.is_none_or(|e| matches!(e, LawError::NotDefinite { .. }));
        assert!(is_told, "{poisson:?}");
    }
    let flat = Orthotropic::new([12e3, 0.0, 500.0], [0.4, 0.45, 0.6], shear);
    assert!(matches!(flat, Err(LawError::NotPositive { .. })));
    for coefficients in [
        [0.3, 0.4, 0.6, 0.0, 1.5, 1.5],
        [0.0, 0.0, 1.0, 1.5, 1.5, 1.5],
        [-0.5, 0.4, 0.6, 1.5, 1.5, 1.5],
        [-1.0, -1.0, -1.0, 1.5, 1.5, 1.5],
        [f64::INFINITY, 0.4, 0.6, 1.5, 1.5, 1.5],
    ] {
        let error = HillCoefficients::new(coefficients);
        assert!(
            matches!(error, Err(LawError::NotDefinite { .. })),
            "{coefficients:?}"
        );
    }
    assert!(HillCoefficients::lankford(0.0, 1.0, 1.0).is_err());
    assert!(HillCoefficients::lankford(1.0, -1.0, 1.0).is_err());
}
