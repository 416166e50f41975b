//! Orthotropic friction; not the isotropic cone, with which it is compared.

use crate::contract::{Samples, check, for_all};
use crate::coulomb::{flux, force_in_cone};
use crate::samples::{normal, unit_tangent, vector};
use moreau_laws::{AnisotropicCoulomb, Bipotential, Coulomb, Friction, LawError, Local};
use proptest::prelude::*;

const MU: [f64; 2] = [0.2, 0.6];

/// The force of pressure t_n and of a share of the friction available in the stretched direction τ.
fn force(tau: Local<3>, share: f64, t_n: f64) -> Local<3> {
    Local::<3>::new(
        t_n,
        share * t_n * MU[0] * tau[1],
        share * t_n * MU[1] * tau[2],
    )
}

/// The slip −u_t ∥ (t_x/μ_x², t_y/μ_y²) of that force.
fn slip(tau: Local<3>, size: f64) -> Local<3> {
    Local::<3>::new(0.0, size * tau[1] / MU[0], size * tau[2] / MU[1])
}

#[test]
fn bipotential_of_orthotropic_contact() -> Result<(), LawError> {
    let sampled = |share: std::ops::Range<f64>| {
        (unit_tangent::<3>(), share, 0.1..5.0f64)
            .prop_map(|(tau, share, t_n)| force(tau, share, t_n))
    };
    let samples = Samples {
        flux: flux::<3>(),
        force: sampled(0.0..1.0).boxed(),
        flux_outside: Some(
            flux::<3>()
                .prop_map(|x| x + (1e-6 - x[0]) * normal())
                .boxed(),
        ),
        force_outside: prop_oneof![
            sampled(1.001..9.0),
            (-5.0..-1e-6f64).prop_map(|t_n| t_n * normal::<3>()),
        ]
        .boxed(),
        law: prop_oneof![
            flux::<3>().prop_map(|x| (x, Local::zeros())),
            sampled(0.0..1.0).prop_map(|t| (Local::zeros(), t)),
            (unit_tangent::<3>(), 0.0..3.0f64, 0.0..5.0f64)
                .prop_map(|(tau, size, t_n)| (slip(tau, size), force(tau, 1.0, t_n))),
        ]
        .boxed(),
        departure: (unit_tangent::<3>(), 0.1..3.0f64, 0.1..5.0f64)
            .prop_flat_map(|(tau, size, t_n)| {
                let (x, t, zero) = (slip(tau, size), force(tau, 1.0, t_n), Local::zeros());
                prop_oneof![
                    Just((x, t, zero, t_n * normal::<3>() - t)),
                    Just((x, t, -normal::<3>(), zero)),
                    // Slip turned away from the normal of the ellipse.
                    Just((
                        x,
                        t,
                        slip(Local::<3>::new(0.0, -tau[2], tau[1]), size),
                        zero
                    )),
                ]
            })
            .boxed(),
    };
    check(&AnisotropicCoulomb::new(MU[0], MU[1])?, &samples);
    Ok(())
}

#[test]
fn slip_parallel_to_the_force_is_not_the_law() -> Result<(), LawError> {
    let law = AnisotropicCoulomb::new(MU[0], MU[1])?;
    let tau = Local::<3>::new(0.0, 0.6, 0.8);
    let t = force(tau, 1.0, 1.0);
    let parallel = t - t[0] * normal::<3>();
    assert!(law.b(&parallel, &t) - parallel.dot(&t) > 1e-3);
    Ok(())
}

#[test]
fn equal_coefficients_are_isotropic() -> Result<(), LawError> {
    let (isotropic, orthotropic) = (Coulomb::new(0.4)?, AnisotropicCoulomb::new(0.4, 0.4)?);
    let force = prop_oneof![force_in_cone::<3>(0.4), vector::<3>(5.0)];
    for_all(&(vector::<3>(3.0), force), |(x, t)| {
        let (a, b) = (isotropic.b(&x, &t), orthotropic.b(&x, &t));
        prop_assert!(a == b || (a - b).abs() <= 1e-12 * (1.0 + a.abs()));
        Ok(())
    });
    Ok(())
}

/// A body in a plane sees the cone cut along one tangent: a force on its border there is on the border
/// of the cone itself, whatever the length of the direction.
#[test]
fn along_one_tangent_it_is_coulombs_law() -> Result<(), LawError> {
    let law = AnisotropicCoulomb::new(0.4, 0.15)?;
    assert!((law.along([1.0, 0.0]).friction() - 0.4).abs() < 1e-15);
    assert!((law.along([0.0, -2.0]).friction() - 0.15).abs() < 1e-15);
    for [c, s] in [[0.3, 0.4], [-3.0, 4.0], [5.0, 1e-3]] {
        let mu = law.along([c, s]).friction();
        let moved = |share: f64| {
            let tangential = 2.0 * share * mu / f64::hypot(c, s);
            let t = Local::<3>::new(2.0, tangential * c, tangential * s);
            (Friction::from(law).project(&t) - t).norm()
        };
        assert!(
            moved(1.0 - 1e-9) < 1e-15 && moved(1.0 + 1e-6) > 1e-8,
            "{c} {s}"
        );
    }
    Ok(())
}
