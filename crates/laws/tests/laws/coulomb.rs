//! The bipotential of contact with Coulomb friction and its incremental form; not the projection.

use crate::contract::{Departure, Samples, check, for_all};
use crate::samples::{normal, unit_tangent, vector};
use approx::assert_relative_eq;
use moreau_laws::{Bipotential, Coulomb, LawError, Local};
use nalgebra::Vector2;
use proptest::prelude::*;

/// A force of the cone: a share 0..1 of the friction available at a pressure.
pub(crate) fn force_in_cone<const D: usize>(mu: f64) -> BoxedStrategy<Local<D>> {
    (unit_tangent::<D>(), 0.0..=1.0f64, 0.0..=5.0f64)
        .prop_map(move |(tau, share, t_n)| t_n * normal::<D>() + share * mu * t_n * tau)
        .boxed()
}

/// x = −u of a contact that does not penetrate.
pub(crate) fn flux<const D: usize>() -> BoxedStrategy<Local<D>> {
    vector::<D>(3.0)
        .prop_map(|mut x| {
            x[0] = -x[0].abs();
            x
        })
        .boxed()
}

/// Pairs (−u, t) of the law: open, stick, slip, [35].
pub(crate) fn law_pair<const D: usize>(mu: f64) -> BoxedStrategy<(Local<D>, Local<D>)> {
    prop_oneof![
        flux::<D>().prop_map(|x| (x, Local::zeros())),
        force_in_cone::<D>(mu).prop_map(|t| (Local::zeros(), t)),
        (unit_tangent::<D>(), 0.0..3.0f64, 0.0..5.0f64)
            .prop_map(move |(tau, slip, t_n)| (slip * tau, t_n * (normal::<D>() + mu * tau))),
    ]
    .boxed()
}

/// Departures from the law, from each status; μ > 0.
pub(crate) fn departure<const D: usize>(mu: f64) -> BoxedStrategy<Departure<Local<D>>> {
    (unit_tangent::<D>(), 0.1..3.0f64, 0.1..5.0f64)
        .prop_flat_map(move |(tau, slip, t_n)| {
            let (n, zero) = (normal::<D>(), Local::zeros());
            let edge = t_n * (n + mu * tau);
            prop_oneof![
                Just((slip * tau, edge, zero, -0.5 * t_n * mu * tau)),
                Just((slip * tau, edge, -n, zero)),
                Just((zero, t_n * (n + 0.5 * mu * tau), tau, zero)),
                Just((zero, edge, -tau, zero)),
                Just((slip * tau - n, zero, zero, n)),
            ]
        })
        .boxed()
}

fn coulomb<const D: usize>(mu: f64) -> Result<(), LawError> {
    let samples = Samples {
        flux: flux::<D>(),
        force: force_in_cone::<D>(mu),
        flux_outside: Some(
            flux::<D>()
                .prop_map(|x| x + (1e-6 - x[0]) * normal::<D>())
                .boxed(),
        ),
        force_outside: prop_oneof![
            (unit_tangent::<D>(), 1.001..9.0f64, 0.1..5.0f64).prop_map(move |(tau, share, t_n)| {
                t_n * (normal::<D>() + share * mu.max(1e-3) * tau)
            }),
            (-5.0..-1e-6f64).prop_map(|t_n| t_n * normal::<D>()),
        ]
        .boxed(),
        law: law_pair::<D>(mu),
        departure: if mu > 0.0 {
            departure::<D>(mu)
        } else {
            // Without friction only the normal part can leave the law.
            (unit_tangent::<D>(), 0.1..3.0f64, 0.1..5.0f64)
                .prop_flat_map(|(tau, slip, t_n)| {
                    let (n, zero) = (normal::<D>(), Local::zeros());
                    prop_oneof![
                        Just((slip * tau, t_n * n, -n, zero)),
                        Just((slip * tau - n, zero, zero, n)),
                    ]
                })
                .boxed()
        },
    };
    check(&Coulomb::new(mu)?, &samples);
    Ok(())
}

#[test]
fn bipotential_of_contact() -> Result<(), LawError> {
    for mu in [0.0, 0.05, 0.3, 1.0, 3.0] {
        coulomb::<2>(mu)?;
        coulomb::<3>(mu)?;
    }
    Ok(())
}

/// The chain of [39]-[41], link by link.
#[test]
fn proof_of_the_bipotential() -> Result<(), LawError> {
    let mu = 0.4;
    let law = Coulomb::new(mu)?;
    for_all(&(flux::<3>(), force_in_cone::<3>(mu)), |(x, t)| {
        let u_t = x.fixed_rows::<2>(1).norm();
        let t_t = t.fixed_rows::<2>(1).norm();
        let chain = [
            law.b(&x, &t),
            t_t * u_t,
            t.fixed_rows::<2>(1).dot(&x.fixed_rows::<2>(1)),
            t.dot(&x),
        ];
        prop_assert!(
            chain.windows(2).all(|link| link[0] >= link[1] - 1e-12),
            "{chain:?}"
        );
        Ok(())
    });
    Ok(())
}

/// On the law the power dissipated is non-negative, [37].
#[test]
fn friction_dissipates() {
    for_all(&law_pair::<3>(0.4), |(x, t)| {
        prop_assert!(t.dot(&x) >= -1e-12);
        Ok(())
    });
}

#[test]
fn incremental_bipotential() -> Result<(), LawError> {
    let mu = 0.4;
    let law = Coulomb::new(mu)?;
    let forces = (force_in_cone::<3>(mu), force_in_cone::<3>(mu));
    for_all(&(flux::<3>(), forces.clone()), |(x, (t0, t1))| {
        let (d_u, d_t) = (-x, t1 - t0);
        let value = law.incremental(&x, &t0, &d_t);
        let written_out = t0[0] * d_u[0]
            + t0.fixed_rows::<2>(1).dot(&d_u.fixed_rows::<2>(1))
            + mu * (t0[0] + d_t[0]) * d_u.fixed_rows::<2>(1).norm();
        prop_assert!((value - written_out).abs() <= 1e-11, "[68]");
        prop_assert!(value >= -d_t.dot(&d_u) - 1e-11, "the inequality of [68]");
        Ok(())
    });
    // Extremal for the whole force is extremal for its increment.
    for_all(
        &(law_pair::<3>(mu), force_in_cone::<3>(mu)),
        |((x, t), t0)| {
            let d_t = t - t0;
            prop_assert!((law.incremental(&x, &t0, &d_t) - d_t.dot(&x)).abs() <= 1e-11);
            Ok(())
        },
    );
    let penetrating = Local::<3>::new(1e-3, 0.0, 0.0);
    let t0 = normal::<3>();
    assert_eq!(law.incremental(&penetrating, &t0, &t0), f64::INFINITY);
    assert_eq!(
        law.incremental(&-penetrating, &t0, &(-2.0 * t0)),
        f64::INFINITY
    );
    Ok(())
}

#[test]
fn the_cone_has_no_tension_even_without_friction() -> Result<(), LawError> {
    let law = Coulomb::new(0.0)?;
    assert!(law.contains(&Vector2::new(1.0, 0.0)));
    assert!(law.contains(&Vector2::new(0.0, 0.0)));
    assert!(!law.contains(&Vector2::new(-1e-300, 0.0)));
    assert!(!law.contains(&Vector2::new(1.0, 1e-9)));
    assert!(!law.contains(&Vector2::new(f64::NAN, 0.0)));
    assert!(!law.contains(&Vector2::new(1.0, f64::NAN)));
    assert_relative_eq!(law.b(&Vector2::new(0.0, 3.0), &Vector2::new(7.0, 0.0)), 0.0);
    Ok(())
}
