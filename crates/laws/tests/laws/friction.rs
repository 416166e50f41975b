//! The laws of friction as one type: each an equation equivalent to its potential; the limited law,
//! which has no bipotential; not their solution in a structure.

use crate::contract::for_all;
use crate::coulomb::flux;
use crate::samples::{normal, unit_tangent, vector};
use approx::assert_relative_eq;
use moreau_laws::{
    AnisotropicCoulomb, Coulomb, Friction, LawError, LimitedCoulomb, Local, Status, Tie, Tresca,
};
use nalgebra::Vector3;
use proptest::prelude::*;

const MU: f64 = 0.4;
/// Reached at the pressure 2.5.
const LIMIT: f64 = 1.0;

fn laws() -> Result<[Friction; 4], LawError> {
    Ok([
        Coulomb::new(MU)?.into(),
        Tresca::new(LIMIT)?.into(),
        LimitedCoulomb::new(MU, LIMIT)?.into(),
        AnisotropicCoulomb::new(0.2, 0.6)?.into(),
    ])
}

fn alpha() -> BoxedStrategy<f64> {
    (-3.0..3.0f64).prop_map(|power| 10f64.powf(power)).boxed()
}

fn tangent<const D: usize>(v: &Local<D>) -> Local<D> {
    v - v[0] * normal::<D>()
}

/// g(t_n), written out.
fn bound(t_n: f64) -> f64 {
    (MU * t_n).min(LIMIT)
}

/// Pairs (−u, t) of the limited law: open, stick, slip on the cone, slip at the limit.
fn limited_pair<const D: usize>() -> BoxedStrategy<(Local<D>, Local<D>)> {
    let n = normal::<D>();
    prop_oneof![
        flux::<D>().prop_map(|x| (x, Local::zeros())),
        (unit_tangent::<D>(), 0.0..=1.0f64, 0.0..=5.0f64).prop_map(move |(tau, share, t_n)| (
            Local::zeros(),
            t_n * n + share * bound(t_n) * tau
        )),
        (unit_tangent::<D>(), 0.0..3.0f64, 0.0..5.0f64)
            .prop_map(move |(tau, slip, t_n)| (slip * tau, t_n * n + bound(t_n) * tau)),
    ]
    .boxed()
}

/// b ≥ x·y on admissible pairs, with equality on the law and nowhere else: what is lost is
/// t_n u_n + (g ‖u_t‖ + t_t·u_t).
fn limited<const D: usize>() -> Result<(), LawError> {
    let law = LimitedCoulomb::new(MU, LIMIT)?;
    let n = normal::<D>();
    let force = (unit_tangent::<D>(), 0.0..=1.0f64, 0.0..=5.0f64)
        .prop_map(move |(tau, share, t_n)| t_n * n + share * bound(t_n) * tau);
    for_all(&(flux::<D>(), force.clone()), |(x, t)| {
        let lost = -t[0] * x[0] + bound(t[0]) * tangent(&x).norm() - tangent(&t).dot(&tangent(&x));
        let gap = law.b(&x, &t) - t.dot(&x);
        prop_assert!((gap - lost).abs() <= 1e-12 && lost >= -1e-12, "gap {gap:e}");
        Ok(())
    });
    for_all(&limited_pair::<D>(), |(x, t)| {
        prop_assert!((law.b(&x, &t) - t.dot(&x)).abs() <= 1e-12);
        Ok(())
    });
    // Convex in the displacement.
    let chord = (flux::<D>(), flux::<D>(), force, 0.0..=1.0f64);
    for_all(&chord, |(x0, x1, t, s)| {
        let along = (1.0 - s) * law.b(&x0, &t) + s * law.b(&x1, &t);
        prop_assert!(law.b(&x0.lerp(&x1, s), &t) <= along + 1e-12);
        Ok(())
    });
    // Too little shear, in either part; too much pressure at a gap; a force outside.
    for t_n in [1.0, 4.0] {
        for_all(&(unit_tangent::<D>(), 0.1..3.0f64), |(tau, slip)| {
            let short = t_n * n + 0.9 * bound(t_n) * tau;
            let gap = law.b(&(slip * tau), &short) - short.dot(&(slip * tau));
            prop_assert!((gap - 0.1 * bound(t_n) * slip).abs() <= 1e-12);
            let lifted = -0.5 * n;
            prop_assert!((law.b(&lifted, &short) - short.dot(&lifted) - 0.5 * t_n).abs() <= 1e-12);
            let beyond = t_n * n + 1.001 * bound(t_n) * tau;
            prop_assert_eq!(law.b(&(slip * tau), &beyond), f64::INFINITY);
            prop_assert_eq!(law.b(&(1e-9 * n), &short), f64::INFINITY);
            prop_assert_eq!(law.b(&(slip * tau), &(-1e-3 * n)), f64::INFINITY);
            Ok(())
        });
    }
    Ok(())
}

#[test]
fn limited_law_is_where_its_function_is_extremal() -> Result<(), LawError> {
    limited::<2>()?;
    limited::<3>()
}

/// Two forces of the same slip, whose mean is admissible but not a force of that slip.
#[test]
fn limited_law_has_no_bipotential() -> Result<(), LawError> {
    let law = LimitedCoulomb::new(MU, LIMIT)?;
    let x = Local::<2>::new(0.0, 1.0);
    let (low, high) = (Local::<2>::new(0.5, 0.2), Local::<2>::new(4.5, 1.0));
    for t in [low, high] {
        assert_relative_eq!(law.b(&x, &t), t.dot(&x), epsilon = 1e-15);
    }
    let mean = 0.5 * (low + high);
    assert_relative_eq!(law.b(&x, &mean) - mean.dot(&x), 0.4, epsilon = 1e-15);
    Ok(())
}

/// One correction from a random prediction gives a pair of the law: T(u, t) with the displacement
/// that it leaves; there b is extremal and the natural map vanishes for every α.
fn equation_and_potential<const D: usize>() -> Result<(), LawError> {
    for law in laws()? {
        for_all(
            &(vector::<D>(5.0), alpha(), alpha()),
            |(q, first, second)| {
                let isotropic = law.isotropic();
                let m = law.stretch::<D>();
                // In the stretched frame q = t − α ũ: u_t from the tangent, u_n from what is left.
                let t = isotropic.correct(&Local::zeros(), &q, 1.0);
                let mut u = (t - q) / first;
                if let Friction::Coulomb(cone) = isotropic {
                    u[0] -= cone.friction() * tangent(&u).norm();
                }
                if t[0] > 0.0 {
                    prop_assert!(u[0].abs() <= 1e-12 * (1.0 + 1.0 / first));
                    u[0] = 0.0;
                }
                let (u, t) = (u.component_div(&m), t.component_mul(&m));
                let size = 10.0 + 30.0 / first;
                prop_assert!(
                    law.natural_map(&u, &t, first).norm() <= 1e-13 * first.max(1.0) * size
                );
                prop_assert!(
                    law.natural_map(&u, &t, second).norm() <= 1e-13 * second.max(1.0) * size
                );
                let gap = law.b(&-u, &t) + t.dot(&u);
                prop_assert!(gap.abs() <= 1e-12 * size, "{law:?}: gap {gap:e}");
                Ok(())
            },
        );
        // Away from the law neither vanishes: the map is of the size of the departure.
        for_all(
            &(flux::<D>(), vector::<D>(5.0), 0.1..10.0f64),
            |(x, q, a)| {
                let t = law.project(&q);
                let gap = law.b(&x, &t) - t.dot(&x);
                let residual = law.natural_map(&-x, &t, a).norm();
                prop_assert!(gap.is_finite() && gap >= -1e-12);
                // The gap is at most what the map leaves of the force and of the displacement.
                let size = (1.0 + 1.0 / a) * (x.norm() + t.norm() + 1.0);
                prop_assert!(gap <= 10.0 * residual * size + 1e-12);
                Ok(())
            },
        );
    }
    Ok(())
}

#[test]
fn equations_are_equivalent_to_the_potentials() -> Result<(), LawError> {
    equation_and_potential::<2>()?;
    equation_and_potential::<3>()
}

fn jacobian<const D: usize>() -> Result<(), LawError> {
    for law in laws()? {
        let sample = (vector::<D>(3.0), vector::<D>(5.0), 0.2..3.0f64);
        for_all(&(sample, vector::<D>(1.0)), |((u, t, alpha), d)| {
            let h = 1e-6;
            let central = |f: &dyn Fn(f64) -> Local<D>| (f(h) - f(-h)) / (2.0 * h);
            let by_t = central(&|h| law.correct(&u, &(t + h * d), alpha));
            let by_u = central(&|h| law.correct(&(u + h * d), &t, alpha));
            // Central differences across a kink are those of neither side.
            let one_sided =
                |f: &dyn Fn(f64) -> Local<D>| ((f(h) - f(0.0)) - (f(0.0) - f(-h))).norm() / h;
            prop_assume!(one_sided(&|h| law.correct(&u, &(t + h * d), alpha)) < 1e-3);
            prop_assume!(one_sided(&|h| law.correct(&(u + h * d), &t, alpha)) < 1e-3);
            let (force, displacement) = law.correct_jacobian(&u, &t, alpha);
            prop_assert!((force * d - by_t).norm() <= 1e-6, "{law:?}");
            prop_assert!((displacement * d + by_u).norm() <= 1e-6, "{law:?}");
            Ok(())
        });
    }
    Ok(())
}

#[test]
fn derivatives_of_the_correction() -> Result<(), LawError> {
    jacobian::<2>()?;
    jacobian::<3>()
}

/// The projection is the nearest admissible force; of the anisotropic law the nearest stretched.
fn projection<const D: usize>() -> Result<(), LawError> {
    for law in laws()? {
        let m = law.stretch::<D>();
        for_all(&(vector::<D>(5.0), vector::<D>(5.0)), |(q, other)| {
            let (p, other) = (law.project(&q), law.project(&other));
            prop_assert!(law.b(&Local::zeros(), &p) == 0.0, "{law:?}: not admissible");
            prop_assert!((law.project(&p) - p).norm() <= 1e-14);
            let away = |t: &Local<D>| (q - t).component_div(&m).norm();
            prop_assert!(away(&p) <= away(&other) + 1e-13, "{law:?}: not nearest");
            Ok(())
        });
    }
    Ok(())
}

#[test]
fn projections_are_nearest() -> Result<(), LawError> {
    projection::<2>()?;
    projection::<3>()
}

/// A limit that is never reached, equal coefficients: Coulomb's law itself.
#[test]
fn special_cases_are_coulombs_law() -> Result<(), LawError> {
    let coulomb: Friction = Coulomb::new(MU)?.into();
    let far: Friction = LimitedCoulomb::new(MU, 1e9)?.into();
    let equal: Friction = AnisotropicCoulomb::new(MU, MU)?.into();
    for_all(
        &(flux::<3>(), vector::<3>(5.0), alpha()),
        |(x, q, alpha)| {
            let t = coulomb.project(&q);
            for other in [far, equal] {
                prop_assert!((other.project(&q) - t).norm() <= 1e-14);
                prop_assert!((other.b(&x, &t) - coulomb.b(&x, &t)).abs() <= 1e-12);
            }
            prop_assert_eq!(
                equal.correct(&-x, &t, alpha),
                coulomb.correct(&-x, &t, alpha)
            );
            Ok(())
        },
    );
    Ok(())
}

#[test]
fn statuses_of_the_limited_law() -> Result<(), LawError> {
    let law: Friction = LimitedCoulomb::new(MU, LIMIT)?.into();
    let tau = Vector3::new(0.0, 0.6, 0.8);
    let (n, zero) = (normal::<3>(), Vector3::zeros());
    for alpha in [1e-3, 1.0, 1e3] {
        assert_eq!(law.status(&(n + tau), &zero, alpha), Status::Open);
        // The same shear sticks or slips by the pressure, until the limit.
        assert_eq!(
            law.status(&zero, &(2.5 * n + 0.9 * tau), alpha),
            Status::Stick
        );
        assert_eq!(
            law.status(&zero, &(2.0 * n + 0.9 * tau), alpha),
            Status::Slip
        );
        assert_eq!(
            law.status(&-tau, &(9.0 * n + LIMIT * tau), alpha),
            Status::Slip
        );
        let frictionless: Friction = LimitedCoulomb::new(0.0, LIMIT)?.into();
        assert_eq!(frictionless.status(&zero, &n, alpha), Status::Slip);
        assert!(!frictionless.resists_slip());
    }
    Ok(())
}

/// Limits are tractions times an area; coefficients have no size.
#[test]
fn scaled_by_an_area() -> Result<(), LawError> {
    let t = Vector3::new(1.0, 4.0, 3.0);
    for law in laws()? {
        for area in [0.5, 4.0] {
            let scaled = law.scaled(area).project(&(area * t)) / area;
            assert_relative_eq!(scaled, law.project(&t), epsilon = 1e-14);
        }
        assert_eq!(
            law.scaled(0.0).project(&Vector3::new(1.0, 0.0, 0.0))[0],
            1.0
        );
    }
    Ok(())
}

#[test]
fn not_a_number_comes_out() -> Result<(), LawError> {
    for law in laws()? {
        let t = law.correct(&Vector3::new(f64::NAN, 0.0, 0.0), &normal::<3>(), 1.0);
        assert!(t.iter().any(|c| c.is_nan()), "{law:?}");
    }
    Ok(())
}

/// What a solve leaves as slip where a contact sticks has a direction by chance, which no iteration
/// may follow; a slip that is small but real has its own.
#[test]
fn a_slip_that_is_rounding_has_no_direction() -> Result<(), LawError> {
    let law = Friction::from(Coulomb::new(MU)?);
    for_all(&(unit_tangent::<3>(), alpha()), |(tau, alpha)| {
        // Pushed beyond the cone: a contact that is about to slip.
        let t = Local::<3>::new(2.0, 1.5, 0.0);
        let derivative = |slip: f64| law.correct_jacobian(&(slip / alpha * tau), &t, alpha).1;
        prop_assert!((derivative(1e-14) - derivative(0.0)).norm() < 1e-12 * alpha);
        prop_assert!((derivative(1e-6) - derivative(0.0)).norm() > 1e-3 * alpha);
        Ok(())
    });
    Ok(())
}

/// Of a tie: the natural map vanishes where u = 0, under any force, and is linear; nothing else has a finite b.
fn tied<const D: usize>() {
    let law = Friction::from(Tie);
    let samples = (vector::<D>(1.0), vector::<D>(3.0), alpha());
    for_all(&samples, |(u, t, alpha)| {
        prop_assert_eq!(law.correct(&Local::<D>::zeros(), &t, alpha), t);
        prop_assert_eq!(law.project(&t), t);
        prop_assert_eq!(law.b(&Local::<D>::zeros(), &t), 0.0);
        prop_assert_eq!(law.b(&u, &t), f64::INFINITY);
        prop_assert_eq!(law.admissible(&u), Local::<D>::zeros());
        prop_assert_eq!(law.status(&u, &t, alpha), Status::Tied);
        let (force, displacement) = law.correct_jacobian(&u, &t, alpha);
        let linear = force * t - displacement * u;
        let left = (law.correct(&u, &t, alpha) - linear).norm();
        prop_assert!(left <= 1e-14 * (t.norm() + alpha * u.norm()), "{}", left);
        prop_assert!((t - linear).norm() >= 0.999 * alpha * u.norm() - 1e-14 * t.norm());
        Ok(())
    });
}

#[test]
fn a_tie_holds_under_any_force() {
    tied::<2>();
    tied::<3>();
}

/// What is not a number is neither contact nor a corner nor an area; what is negative is no corner and no area.
#[test]
fn what_is_no_number_comes_out_of_every_law() {
    let coulomb: Friction = Coulomb::new(0.3).expect("valid").into();
    let tresca: Friction = Tresca::new(0.5).expect("valid").into();
    let nan = Local::<2>::new(f64::NAN, 0.0);
    let none = Local::<2>::zeros();
    for law in [coulomb, tresca, Tie.into()] {
        assert!(law.admissible(&nan)[0].is_nan(), "{law:?}");
        assert_eq!(law.admissible(&none), none);
        assert_eq!(law.b(&none, &nan), f64::INFINITY, "{law:?}");
        assert_eq!(law.b(&nan, &none), f64::INFINITY, "{law:?}");
    }
    assert_eq!(
        Friction::from(Tie).admissible(&Local::<2>::new(-1.0, 2.0)),
        none
    );
    assert_eq!(
        coulomb.admissible(&Local::<2>::new(-1.0, 2.0)),
        Local::<2>::new(0.0, 2.0)
    );
    let Friction::Coulomb(corner) = coulomb.at_corner(f64::NAN) else {
        panic!("a corner is Coulomb's");
    };
    assert!(corner.friction().is_nan());
    assert_eq!(coulomb.at_corner(-1.0), coulomb.at_corner(0.0));
    assert_eq!(tresca.scaled(-1.0), tresca.scaled(0.0));
    assert!(tresca.scaled(f64::NAN).bound(1.0).is_nan());
}
