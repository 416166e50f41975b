//! The regularised contact law and its limit; not its use in a structure.

use crate::contract::for_all;
use crate::samples::{normal, unit_tangent, vector};
use approx::assert_relative_eq;
use moreau_laws::textbook::RegularisedCoulomb;
use moreau_laws::{Bipotential, Coulomb, LawError, Local, Status};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

const MU: f64 = 0.4;
const K_N: f64 = 50.0;
const K_T: f64 = 20.0;

/// t₀* = (0, t_t0).
fn remembered<const D: usize>(t0: &Local<D>) -> Local<D> {
    t0 - t0[0] * normal::<D>()
}

fn irreversible_part_obeys_coulomb<const D: usize>(mu: f64) -> Result<(), LawError> {
    let law = RegularisedCoulomb::new(mu, K_N, K_T)?;
    let exact = Coulomb::new(mu)?;
    for_all(&(vector::<D>(3.0), vector::<D>(0.2)), |(t0, u)| {
        let response = law.respond(&t0, &u);
        let (t, u_f) = (response.force, response.irreversible);
        let change = t - remembered(&t0);
        let mut expected = u + change / K_T;
        expected[0] = u[0] + change[0] / K_N;
        prop_assert!((u_f - expected).norm() <= 1e-15, "uᶠ = u + C (t − t₀*)");

        let gap = exact.b(&-u_f, &t) + t.dot(&u_f);
        prop_assert!(gap.abs() <= 1e-14 * (1.0 + t.norm()), "gap {gap:e}");
        let open = t == Local::<D>::zeros() && u_f[0] > 0.0;
        prop_assert_eq!(response.status == Status::Open, open);
        if response.status == Status::Stick {
            prop_assert!(u_f.norm() <= 1e-15);
        }
        Ok(())
    });
    Ok(())
}

#[test]
fn irreversible_displacement() -> Result<(), LawError> {
    for mu in [0.0, MU, 2.0] {
        irreversible_part_obeys_coulomb::<2>(mu)?;
        irreversible_part_obeys_coulomb::<3>(mu)?;
    }
    Ok(())
}

/// Displacements and the force at the start, off the kinks: open, stick and slip in turn, the
/// trial being drawn first.
fn smooth<const D: usize>(mu: f64) -> BoxedStrategy<(Status, Local<D>, Local<D>)> {
    let share = prop_oneof![
        (0.0..0.9f64).prop_map(|share| (Status::Stick, share)),
        (1.1..5.0f64).prop_map(|share| (Status::Slip, share)),
        Just((Status::Open, 1.0)),
    ];
    (share, unit_tangent::<D>(), 0.01..0.1f64, vector::<D>(3.0))
        .prop_map(move |((status, share), tau, u_n, t0)| {
            let trial = share * mu * K_N * u_n * tau;
            let sign = if status == Status::Open { 1.0 } else { -1.0 };
            let u = (remembered(&t0) - trial) / K_T + sign * u_n * normal::<D>();
            (status, t0, u)
        })
        .boxed()
}

fn tangent_by_differences<const D: usize>() -> Result<(), LawError> {
    let law = RegularisedCoulomb::new(MU, K_N, K_T)?;
    for_all(
        &(smooth::<D>(MU), vector::<D>(1.0)),
        |((status, t0, u), d)| {
            let h = 1e-6;
            let response = law.respond(&t0, &u);
            prop_assert_eq!(response.status, status);
            let force = |eps: f64| law.respond(&t0, &(u + eps * d)).force;
            let difference = (force(h) - force(-h)) / (2.0 * h);
            prop_assert!((response.tangent * d - difference).norm() <= 1e-6);
            Ok(())
        },
    );
    Ok(())
}

#[test]
fn tangent() -> Result<(), LawError> {
    tangent_by_differences::<2>()?;
    tangent_by_differences::<3>()
}

#[test]
fn frictionless_tangent_is_normal() -> Result<(), LawError> {
    let law = RegularisedCoulomb::new(0.0, K_N, K_T)?;
    for u in [Vector3::new(-0.1, 0.2, 0.3), Vector3::new(-0.1, 0.0, 0.0)] {
        let response = law.respond(&Vector3::zeros(), &u);
        assert_eq!(response.force, 0.1 * K_N * normal::<3>());
        assert_eq!(
            response.tangent,
            -K_N * Matrix3::from_diagonal(&normal::<3>())
        );
        assert_eq!(response.status, Status::Slip);
    }
    Ok(())
}

fn potential<const D: usize>() -> Result<(), LawError> {
    let law = RegularisedCoulomb::new(MU, K_N, K_T)?;
    let steps = (
        vector::<D>(3.0),
        vector::<D>(0.2),
        vector::<D>(0.3),
        vector::<D>(1.0),
    );
    for_all(
        &(steps, 0.0..5.0f64),
        |((t0, u, other, d), any_pressure)| {
            let response = law.respond(&t0, &u);
            let pressure = response.force[0];

            // The infimum of [82], reached at the irreversible displacement.
            let value = law.potential(&t0, &u, pressure);
            let reached = law.convolved(&t0, &u, pressure, &response.irreversible);
            prop_assert!((value - reached).abs() <= 1e-13);
            let mut admissible = other;
            admissible[0] = other[0].max(0.0);
            for pressure in [pressure, any_pressure] {
                let infimum = law.potential(&t0, &u, pressure);
                prop_assert!(infimum <= law.convolved(&t0, &u, pressure, &admissible) + 1e-13);

                let chord = 0.5 * infimum + 0.5 * law.potential(&t0, &(u + d), pressure);
                prop_assert!(law.potential(&t0, &(u + 0.5 * d), pressure) <= chord + 1e-12);
            }

            // Its gradient at the frozen pressure is t₀* − t.
            let h = 1e-6;
            let at = |eps: f64| law.potential(&t0, &(u + eps * d), pressure);
            let difference = (at(h) - at(-h)) / (2.0 * h);
            let gradient = (remembered(&t0) - response.force).dot(&d);
            prop_assert!((gradient - difference).abs() <= 2.0 * K_N * h * (1.0 + d.norm_squared()));
            Ok(())
        },
    );
    Ok(())
}

#[test]
fn inf_convolution() -> Result<(), LawError> {
    potential::<2>()?;
    potential::<3>()
}

/// Large penalties lose t·(uᶠ − u) = t_n²/k_n + (t_t − t_t0)·t_t/k_t of the exact power.
#[test]
fn power_lost_to_the_springs() -> Result<(), LawError> {
    let law = RegularisedCoulomb::new(MU, K_N, K_T)?;
    for_all(&(vector::<3>(3.0), vector::<3>(0.2)), |(t0, u)| {
        let response = law.respond(&t0, &u);
        let t = response.force;
        let t_t = t - t[0] * normal::<3>();
        let lost = t[0].powi(2) / K_N + (t_t - remembered(&t0)).dot(&t_t) / K_T;
        prop_assert!((t.dot(&(response.irreversible - u)) - lost).abs() <= 1e-13);
        Ok(())
    });
    Ok(())
}

/// One contact u = W t + q by Newton on the regularised law.
fn penalised(law: &RegularisedCoulomb, w: &Matrix3<f64>, q: &Vector3<f64>) -> Vector3<f64> {
    let t0 = Vector3::zeros();
    let mut u = *q;
    for _ in 0..100 {
        let response = law.respond(&t0, &u);
        let residual = u - w * response.force - q;
        if residual.norm() <= 1e-14 {
            return response.force;
        }
        let jacobian = Matrix3::identity() - w * response.tangent;
        u -= jacobian.lu().solve(&residual).unwrap_or(residual);
    }
    panic!("no convergence for q = {q}");
}

#[test]
fn tends_to_coulomb_as_the_stiffness_grows() -> Result<(), LawError> {
    let w = Matrix3::new(1.0, 0.2, -0.1, 0.2, 0.8, 0.05, -0.1, 0.05, 0.6);
    let cases = [
        (0.3, Vector3::new(-1.0, 0.5, -0.3), Status::Slip),
        (0.9, Vector3::new(-1.0, 2.0, 1.0), Status::Slip),
        (0.9, Vector3::new(-1.0, 0.05, -0.03), Status::Stick),
    ];
    for (mu, q, status) in cases {
        let exact_law = Coulomb::new(mu)?;
        let mut exact = Vector3::zeros();
        for _ in 0..5000 {
            exact = exact_law.project(&(exact - 0.4 * exact_law.shifted(&(w * exact + q))));
        }
        let u = w * exact + q;
        assert!(exact_law.natural_map(&u, &exact, 0.4).norm() <= 1e-13);
        assert_eq!(exact_law.status(&u, &exact, 0.4), status);

        let error = |k: f64| -> Result<f64, LawError> {
            let law = RegularisedCoulomb::new(mu, k, k)?;
            Ok((penalised(&law, &w, &q) - exact).norm())
        };
        for k in [1e3, 1e4, 1e5] {
            assert_relative_eq!(error(k)? / error(2.0 * k)?, 2.0, max_relative = 1e-2);
        }
        assert!(error(1e6)? <= 1e-5);
    }
    Ok(())
}

#[test]
fn not_a_number_comes_out() -> Result<(), LawError> {
    let law = RegularisedCoulomb::new(MU, K_N, K_T)?;
    let closed = Vector3::new(-0.1, 0.2, 0.3);
    for i in 0..3 {
        let mut u = closed;
        u[i] = f64::NAN;
        let response = law.respond(&Vector3::zeros(), &u);
        assert!(response.force.iter().any(|c| c.is_nan()), "component {i}");
    }
    Ok(())
}
