//! The orthogonal projection on the Coulomb cone and its derivative; not the contact law.

use crate::contract::for_all;
use crate::coulomb::force_in_cone;
use crate::samples::{normal, unit_tangent, vector};
use approx::assert_relative_eq;
use moreau_laws::textbook::RegularisedCoulomb;
use moreau_laws::{Coulomb, LawError, Local, Status};
use nalgebra::{Matrix3, Vector2, Vector3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

const FRICTIONS: [f64; 5] = [0.0, 0.1, 0.5, 1.0, 4.0];

/// q, its projection, and the branch, for μ = 0.5.
const TABLE: [([f64; 2], [f64; 2], Status); 8] = [
    ([2.0, 0.5], [2.0, 0.5], Status::Stick),
    ([2.0, 1.0], [2.0, 1.0], Status::Stick),
    ([1.0, 2.0], [1.6, 0.8], Status::Slip),
    ([-1.0, 1.9], [0.0, 0.0], Status::Open),
    ([-1.0, 2.0], [0.0, 0.0], Status::Open),
    ([-1.0, 2.1], [0.04, 0.02], Status::Slip),
    ([-1.0, 4.0], [0.8, 0.4], Status::Slip),
    ([0.0, 3.0], [1.2, 0.6], Status::Slip),
];

#[test]
fn exact_values() -> Result<(), LawError> {
    let law = Coulomb::new(0.5)?;
    for (q, p, branch) in TABLE {
        let (q, p) = (Vector2::from(q), Vector2::from(p));
        assert_relative_eq!(law.project(&q), p, epsilon = 1e-15);
        // With α = 0 the prediction is q itself.
        assert_eq!(law.status(&Vector2::zeros(), &q, 0.0), branch);
        let turned = |v: &Vector2<f64>| Vector3::new(v[0], 0.6 * v[1], -0.8 * v[1]);
        assert_relative_eq!(law.project(&turned(&q)), turned(&p), epsilon = 1e-15);
    }
    Ok(())
}

/// Clipping at the given pressure is the return of the regularised law, not the projection.
#[test]
fn clipping_is_not_projecting() -> Result<(), LawError> {
    let (mu, trial) = (0.5, Vector2::new(1.0, 2.0));
    let projected = Coulomb::new(mu)?.project(&trial);
    let clipped = RegularisedCoulomb::new(mu, 1.0, 1.0)?
        .respond(&Vector2::zeros(), &-trial)
        .force;
    assert_relative_eq!(projected, Vector2::new(1.6, 0.8), epsilon = 1e-15);
    assert_relative_eq!(clipped, Vector2::new(1.0, 0.5), epsilon = 1e-15);
    Ok(())
}

fn is_a_projection<const D: usize>(mu: f64) -> Result<(), LawError> {
    let law = Coulomb::new(mu)?;
    for_all(&vector::<D>(3.0), |q| {
        let p = law.project(&q);
        prop_assert!(law.contains(&p), "p = {p} is not in the cone");
        prop_assert!((law.project(&p) - p).norm() <= 1e-14, "not idempotent");
        // Moreau's decomposition q = p + r, p ∈ K, r ∈ K°, p·r = 0.
        let r = q - p;
        prop_assert!(p.dot(&r).abs() <= 1e-13);
        let r_t = r.rows(1, D - 1).norm();
        prop_assert!(mu * r_t <= -r[0] + 1e-13, "q − p is not in the polar cone");
        Ok(())
    });
    for_all(&(vector::<D>(3.0), force_in_cone::<D>(mu)), |(q, other)| {
        let p = law.project(&q);
        prop_assert!((q - p).norm() <= (q - other).norm() + 1e-13, "not nearest");
        Ok(())
    });
    for_all(&(vector::<D>(3.0), vector::<D>(3.0)), |(a, b)| {
        let lipschitz = (law.project(&a) - law.project(&b)).norm() <= (a - b).norm() + 1e-14;
        prop_assert!(lipschitz, "not 1-Lipschitz");
        Ok(())
    });
    for_all(&(vector::<D>(3.0), -250.0..250.0f64), |(q, power)| {
        let factor = 10f64.powf(power);
        let scaled = law.project(&(factor * q)) / factor;
        prop_assert!(
            (scaled - law.project(&q)).norm() <= 1e-13,
            "not homogeneous"
        );
        Ok(())
    });
    Ok(())
}

#[test]
fn projection_properties() -> Result<(), LawError> {
    for mu in FRICTIONS {
        is_a_projection::<2>(mu)?;
        is_a_projection::<3>(mu)?;
    }
    Ok(())
}

#[test]
fn without_friction_the_cone_is_a_half_line() -> Result<(), LawError> {
    let law = Coulomb::new(0.0)?;
    for_all(&vector::<3>(3.0), |q| {
        prop_assert_eq!(law.project(&q), q[0].max(0.0) * normal::<3>());
        Ok(())
    });
    // The axis itself, where the interior of the cone is empty.
    let axis = 2.0 * normal::<3>();
    assert_eq!(law.project(&axis), axis);
    assert_eq!(
        law.project_jacobian(&axis),
        Matrix3::from_diagonal(&normal::<3>())
    );
    assert_eq!(law.status(&Local::<3>::zeros(), &axis, 1.0), Status::Slip);
    Ok(())
}

#[test]
fn extreme_magnitudes() -> Result<(), LawError> {
    let magnitudes = [0.0, 5e-324, 1e-300, 1e-160, 1.0, 1e160, 1e300];
    for mu in [0.0, 1e-300, 0.5, 1e160, 1e300] {
        let law = Coulomb::new(mu)?;
        for q_n in magnitudes.into_iter().flat_map(|q_n| [q_n, -q_n]) {
            for q_t in magnitudes {
                let q = Vector3::new(q_n, 0.6 * q_t, 0.8 * q_t);
                let p = law.project(&q);
                assert!(p.iter().all(|c| c.is_finite()), "μ {mu:e} q {q} p {p}");
                let larger = 2.0 * q.amax();
                assert!(p.iter().all(|c| c.abs() <= larger), "μ {mu:e} q {q} p {p}");
                let jacobian = law.project_jacobian(&q);
                assert!(jacobian.iter().all(|c| c.is_finite()), "μ {mu:e} q {q}");
            }
        }
    }
    // An immense friction keeps the tangential force.
    for mu in [1e160, 1e300] {
        let p = Coulomb::new(mu)?.project(&Vector2::new(-1.0, 3.0));
        assert_relative_eq!(p, Vector2::new(0.0, 3.0), epsilon = 1e-15);
    }
    // The lateral branch at both ends of the range.
    let law = Coulomb::new(0.5)?;
    for size in [1e-300, 1e300] {
        let p = law.project(&Vector2::new(size, 2.0 * size)) / size;
        assert_relative_eq!(p, Vector2::new(1.6, 0.8), epsilon = 1e-14);
    }
    Ok(())
}

#[test]
fn not_a_number_comes_out() -> Result<(), LawError> {
    let law = Coulomb::new(0.5)?;
    for q in [Vector2::new(f64::NAN, 1.0), Vector2::new(1.0, f64::NAN)] {
        assert!(law.project(&q).iter().any(|c| c.is_nan()));
        assert!(law.project_jacobian(&q).iter().any(|c| c.is_nan()));
    }
    Ok(())
}

/// Points at a distance from the kinks, in every branch: the angle from the axis of the cone is
/// drawn inside, beside, and in the polar cone.
fn smooth_point<const D: usize>(mu: f64) -> BoxedStrategy<Local<D>> {
    let (margin, edge) = (0.03, mu.atan());
    let angle = prop_oneof![
        0.0..edge - margin,
        edge + margin..edge + FRAC_PI_2 - margin,
        edge + FRAC_PI_2 + margin..PI,
    ];
    (unit_tangent::<D>(), angle, 0.5..3.0f64)
        .prop_map(|(tau, angle, size)| size * (angle.cos() * normal::<D>() + angle.sin() * tau))
        .boxed()
}

fn jacobian<const D: usize>(mu: f64) -> Result<(), LawError> {
    let law = Coulomb::new(mu)?;
    if mu > 0.0 {
        for_all(&(smooth_point::<D>(mu), vector::<D>(1.0)), |(q, d)| {
            // Beside the axis the cone bends within the distance of that.
            let h = 3e-6;
            let difference = (law.project(&(q + h * d)) - law.project(&(q - h * d))) / (2.0 * h);
            prop_assert!((law.project_jacobian(&q) * d - difference).norm() <= 1e-8);
            Ok(())
        });
    }
    let kinks = (unit_tangent::<D>(), 0.0..3.0f64).prop_flat_map(move |(tau, size)| {
        let n = normal::<D>();
        prop_oneof![
            Just(Local::zeros()),
            Just(size * (n + mu * tau)),
            Just(size * (tau - mu * n)),
            Just(size * n),
            Just(-size * n),
        ]
    });
    for_all(&prop_oneof![vector::<D>(3.0), kinks], |q| {
        let jacobian = law.project_jacobian(&q);
        prop_assert!((jacobian - jacobian.transpose()).norm() <= 1e-15);
        // Padded with zeros: a plane cone in space.
        let padded = Matrix3::from_fn(|i, j| if i.max(j) < D { jacobian[(i, j)] } else { 0.0 });
        let eigenvalues = padded.symmetric_eigenvalues();
        prop_assert!(eigenvalues.min() >= -1e-14 && eigenvalues.max() <= 1.0 + 1e-14);
        // A homogeneous map is its derivative applied to its argument, in every piece.
        prop_assert!((jacobian * q - law.project(&q)).norm() <= 1e-14 * (1.0 + q.norm()));
        Ok(())
    });
    Ok(())
}

#[test]
fn projection_jacobian() -> Result<(), LawError> {
    for mu in FRICTIONS {
        jacobian::<2>(mu)?;
        jacobian::<3>(mu)?;
    }
    Ok(())
}
