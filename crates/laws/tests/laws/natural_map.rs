//! The shifted displacement and the equations equivalent to Coulomb's law; not their solution in
//! a structure.

use crate::contract::for_all;
use crate::coulomb::{departure, flux, force_in_cone, law_pair};
use crate::samples::{normal, unit_tangent, vector};
use approx::assert_relative_eq;
use moreau_laws::{Bipotential, Coulomb, LawError, Local, Status};
use nalgebra::{Matrix3, SMatrix, Vector3};
use proptest::prelude::*;

const MU: f64 = 0.4;

/// Augmentation parameters over eight decades.
fn alpha() -> BoxedStrategy<f64> {
    (-4.0..4.0f64).prop_map(|power| 10f64.powf(power)).boxed()
}

fn shifted<const D: usize>() -> Result<(), LawError> {
    let law = Coulomb::new(MU)?;
    let away_from_rest = (unit_tangent::<D>(), 0.1..3.0f64, -3.0..3.0f64)
        .prop_map(|(tau, slip, u_n)| slip * tau + u_n * normal::<D>());
    for_all(&(away_from_rest, vector::<D>(1.0)), |(u, d)| {
        let shift = law.shifted(&u) - u;
        let slip = (u - u[0] * normal::<D>()).norm();
        prop_assert!((shift - MU * slip * normal::<D>()).norm() <= 1e-14);

        let h = 1e-6;
        let difference = (law.shifted(&(u + h * d)) - law.shifted(&(u - h * d))) / (2.0 * h);
        prop_assert!((law.shifted_jacobian(&u) * d - difference).norm() <= 1e-8);
        Ok(())
    });
    let rest = 2.0 * normal::<D>();
    assert_eq!(law.shifted(&rest), rest);
    assert_eq!(
        law.shifted_jacobian(&rest),
        SMatrix::<f64, D, D>::identity()
    );
    Ok(())
}

#[test]
fn shifted_displacement() -> Result<(), LawError> {
    shifted::<2>()?;
    shifted::<3>()
}

fn zero_iff_law<const D: usize>() -> Result<(), LawError> {
    let law = Coulomb::new(MU)?;
    for_all(&(law_pair::<D>(MU), alpha()), |((x, t), alpha)| {
        let residual = law.natural_map(&-x, &t, alpha).norm();
        prop_assert!(residual <= 1e-13 * (1.0 + t.norm() + alpha * x.norm()));
        Ok(())
    });
    for_all(&(departure::<D>(MU), alpha()), |((x, t, dx, dt), alpha)| {
        // Relative to the length that α gives to the departure.
        let residual = law.natural_map(&-(x + dx), &(t + dt), alpha).norm();
        prop_assert!(residual >= 1e-3 * alpha.min(1.0), "residual {residual:e}");
        Ok(())
    });
    Ok(())
}

#[test]
fn natural_map_vanishes_on_the_law_alone() -> Result<(), LawError> {
    zero_iff_law::<2>()?;
    zero_iff_law::<3>()
}

/// The bipotential is extremal where the natural map vanishes, on pairs that are in general
/// neither: one projection from a random prediction puts t on the law of the displacement
/// (q − t)/α shifted back.
fn projection_solves_the_law<const D: usize>() -> Result<(), LawError> {
    let law = Coulomb::new(MU)?;
    for_all(&(vector::<D>(3.0), alpha()), |(q, alpha)| {
        let t = law.project(&q);
        let shifted = (t - q) / alpha;
        let tangential = shifted - shifted[0] * normal::<D>();
        // The lateral branch has u_n = 0 up to the rounding of the shift.
        let u_n = shifted[0] - MU * tangential.norm();
        let u_n = if u_n.abs() <= 1e-13 * (1.0 + 1.0 / alpha) {
            0.0
        } else {
            u_n
        };
        let u = tangential + u_n * normal::<D>();
        prop_assert!(law.natural_map(&u, &t, alpha).norm() <= 1e-12 * (1.0 + alpha));
        let gap = law.b(&-u, &t) + t.dot(&u);
        prop_assert!(gap.abs() <= 1e-12 * (1.0 + 1.0 / alpha), "gap {gap:e}");
        Ok(())
    });
    Ok(())
}

#[test]
fn every_prediction_belongs_to_one_law_pair() -> Result<(), LawError> {
    projection_solves_the_law::<2>()?;
    projection_solves_the_law::<3>()
}

/// K* ∋ ũ ⊥ t ∈ K, and the equations of Alart and Curnier.
#[test]
fn equivalent_forms() -> Result<(), LawError> {
    let law = Coulomb::new(MU)?;
    let tangential = |v: &Local<3>| v - v[0] * normal::<3>();
    let clip = |v: Local<3>, radius: f64| match v.norm() {
        norm if norm <= radius => v,
        norm => radius / norm * v,
    };
    let alart_curnier = |u: &Local<3>, t: &Local<3>, alpha: f64| {
        let predicted = t - alpha * u;
        let pressure = predicted[0].max(0.0);
        t - pressure * normal::<3>() - clip(tangential(&predicted), MU * pressure)
    };
    for_all(&(law_pair::<3>(MU), 0.01..100.0f64), |((x, t), alpha)| {
        let u = -x;
        let shifted = law.shifted(&u);
        prop_assert!(
            shifted[0] >= MU * tangential(&shifted).norm() - 1e-14,
            "ũ is not in K*"
        );
        prop_assert!(shifted.dot(&t).abs() <= 1e-13 * (1.0 + u.norm() * t.norm()));
        let residual = alart_curnier(&u, &t, alpha).norm();
        prop_assert!(
            residual <= 1e-12 * (1.0 + alpha),
            "Alart–Curnier {residual:e}"
        );
        Ok(())
    });
    for_all(
        &(departure::<3>(MU), 0.01..100.0f64),
        |((x, t, dx, dt), alpha)| {
            prop_assert!(alart_curnier(&-(x + dx), &(t + dt), alpha).norm() > 1e-5);
            Ok(())
        },
    );
    Ok(())
}

#[test]
fn statuses() -> Result<(), LawError> {
    let tau = Vector3::new(0.0, 0.6, 0.8);
    let n = normal::<3>();
    let zero = Vector3::zeros();
    for alpha in [1e-3, 1.0, 1e3] {
        let law = Coulomb::new(MU)?;
        assert_eq!(law.status(&(n + tau), &zero, alpha), Status::Open);
        assert_eq!(
            law.status(&zero, &(n + 0.5 * MU * tau), alpha),
            Status::Stick
        );
        assert_eq!(
            law.status(&(-2.0 * tau), &(n + MU * tau), alpha),
            Status::Slip
        );
        // Grazing: closed without force counts as open.
        assert_eq!(law.status(&zero, &zero, alpha), Status::Open);

        let frictionless = Coulomb::new(0.0)?;
        assert_eq!(frictionless.status(&zero, &n, alpha), Status::Slip);
        assert_eq!(frictionless.status(&tau, &n, alpha), Status::Slip);
        assert_eq!(frictionless.status(&(n + tau), &zero, alpha), Status::Open);
    }
    Ok(())
}

/// A single contact u = W t + q solved by the prediction and correction of [89]-[90′], against
/// values found by an independent program.
#[test]
fn one_contact_by_uzawa() -> Result<(), LawError> {
    let w = Matrix3::new(1.0, 0.2, -0.1, 0.2, 0.8, 0.05, -0.1, 0.05, 0.6);
    let cases = [
        (
            0.3,
            [-1.0, 0.5, -0.3],
            [1.0715348565, -0.2720533, 0.1712420],
            Status::Slip,
        ),
        (
            0.3,
            [-1.0, 0.05, -0.03],
            [1.0711995704, -0.2653838, 0.1812280],
            Status::Slip,
        ),
        (0.3, [0.2, 0.5, -0.3], [0.0, 0.0, 0.0], Status::Open),
        (
            0.9,
            [-1.0, 2.0, 1.0],
            [1.1518289669, -0.9576284, -0.3969671],
            Status::Slip,
        ),
    ];
    for (mu, q, expected, status) in cases {
        let law = Coulomb::new(mu)?;
        let alpha = 1.0 / (w.symmetric_eigenvalues().max() * (1.0 + mu));
        let mut t = Vector3::zeros();
        let displacement = |t: &Vector3<f64>| w * t + Vector3::from(q);
        let mut iterations = 0;
        while iterations == 0 || law.natural_map(&displacement(&t), &t, alpha).norm() > 1e-14 {
            t = law.project(&(t - alpha * law.shifted(&displacement(&t))));
            iterations += 1;
            assert!(iterations < 5000, "no convergence for μ = {mu}");
        }
        assert_relative_eq!(t, Vector3::from(expected), epsilon = 1e-7);
        assert_eq!(law.status(&displacement(&t), &t, alpha), status);
    }
    Ok(())
}

/// Without friction the natural map is Signorini's, and tangential forces vanish.
#[test]
fn frictionless_natural_map() -> Result<(), LawError> {
    let law = Coulomb::new(0.0)?;
    for_all(
        &(flux::<3>(), force_in_cone::<3>(MU), 0.1..10.0f64),
        |(x, t, alpha)| {
            let residual = law.natural_map(&-x, &t, alpha);
            prop_assert!((residual[0] - (t[0] - (t[0] + alpha * x[0]).max(0.0))).abs() <= 1e-13);
            prop_assert_eq!(residual.fixed_rows::<2>(1), t.fixed_rows::<2>(1));
            Ok(())
        },
    );
    Ok(())
}
