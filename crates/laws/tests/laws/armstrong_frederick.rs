//! Armstrong–Frederick hardening; not its integration over finite steps.

use crate::contract::{Samples, check};
use crate::samples::{any_deviator, spherical, unit_deviator};
use approx::assert_relative_eq;
use moreau_laws::textbook::{ArmstrongFrederick, Generalised};
use moreau_laws::{Bipotential, LawError};
use moreau_mandel::{Sym2, equivalent_strain, von_mises};
use proptest::prelude::*;

const YIELD: f64 = 2.0;
const MODULUS: f64 = 5.0;
const RECALL: f64 = 3.0;

/// The rates (ε̇ᵖ, α̇) of flow at the rate ṗ in the direction n = (s − X)/‖s − X‖.
fn flow(n: Sym2, back_stress: Sym2, p: f64) -> (Sym2, Sym2) {
    let plastic = 1.5f64.sqrt() * p * n;
    (plastic, plastic - 1.5 * RECALL / MODULUS * p * back_stress)
}

/// The force with a share of the overstress allowed, in the direction n.
fn force(n: Sym2, share: f64, back_stress: Sym2, hardening: f64, mean: f64) -> Generalised {
    let overstress = share * (2.0f64 / 3.0).sqrt() * (YIELD + hardening) * n;
    ArmstrongFrederick::force(
        &(overstress + back_stress + spherical(mean)),
        &back_stress,
        hardening,
    )
}

#[test]
fn bipotential_of_kinematic_hardening() -> Result<(), LawError> {
    let forces = |share: std::ops::Range<f64>| {
        let parts = (
            unit_deviator(),
            share,
            any_deviator(2.0),
            0.0..2.0f64,
            -5.0..5.0f64,
        );
        parts.prop_map(|(n, share, x, r, mean)| force(n, share, x, r, mean))
    };
    let rates = |share: std::ops::Range<f64>, trace: f64| {
        let parts = (unit_deviator(), share, any_deviator(2.0), 0.1..2.0f64);
        parts.prop_map(move |(n, share, back, p)| {
            let plastic = share * 1.5f64.sqrt() * p * n + spherical(trace);
            ArmstrongFrederick::flux(&plastic, &back, p)
        })
    };
    let yielding = (
        unit_deviator(),
        0.1..2.0f64,
        any_deviator(2.0),
        0.0..2.0f64,
        -5.0..5.0f64,
    );
    let samples = Samples {
        flux: rates(0.0..1.0, 0.0).boxed(),
        force: forces(0.0..1.0).boxed(),
        flux_outside: Some(
            prop_oneof![
                rates(1.001..5.0, 0.0),
                rates(0.0..1.0, 0.01),
                // Recall without flow, and flow backwards.
                (any_deviator(2.0), prop_oneof![Just(0.0), Just(-0.0)])
                    .prop_map(|(back, p)| ArmstrongFrederick::flux(&Sym2::zeros(), &back, p)),
                (0.1..2.0f64).prop_map(|p| ArmstrongFrederick::flux(
                    &Sym2::zeros(),
                    &Sym2::zeros(),
                    -p
                )),
            ]
            .boxed(),
        ),
        force_outside: forces(1.001..5.0).boxed(),
        law: prop_oneof![
            yielding.clone().prop_map(|(n, p, x, r, mean)| {
                let (plastic, back) = flow(n, x, p);
                (
                    ArmstrongFrederick::flux(&plastic, &back, p),
                    force(n, 1.0, x, r, mean),
                )
            }),
            forces(0.0..1.0).prop_map(|y| (Generalised::zeros(), y)),
            forces(0.0..1.0).prop_map(|y| (-Generalised::zeros(), y)),
        ]
        .boxed(),
        departure: (yielding, unit_deviator())
            .prop_flat_map(|((n, p, x, r, mean), d)| {
                let (plastic, back) = flow(n, x, p);
                let flux = ArmstrongFrederick::flux(&plastic, &back, p);
                let edge = force(n, 1.0, x, r, mean);
                let (zero, none) = (Sym2::zeros(), Generalised::zeros());
                let inwards = force(n, 0.5, zero, 0.0, 0.0);
                prop_oneof![
                    Just((flux, edge, none, -inwards)),
                    Just((flux, edge, none, ArmstrongFrederick::force(&d, &d, 0.0))),
                    Just((flux, edge, ArmstrongFrederick::flux(&zero, &d, 0.0), none)),
                    Just((
                        flux,
                        edge,
                        ArmstrongFrederick::flux(&zero, &zero, 1.0),
                        none
                    )),
                ]
            })
            .boxed(),
    };
    check(&ArmstrongFrederick::new(YIELD, MODULUS, RECALL)?, &samples);
    Ok(())
}

/// Monotonic tension: X_eq = (C/γ)(1 − exp(−γ εᵖ)), extremal all the way, where
/// b = (σ_y + (γ/C) X_eq²) ṗ.
#[test]
fn back_stress_saturates_in_tension() -> Result<(), LawError> {
    let law = ArmstrongFrederick::new(YIELD, MODULUS, RECALL)?;
    let n = Sym2::from([2.0, -1.0, -1.0, 0.0, 0.0, 0.0]) / 6f64.sqrt();
    let back_stress = |alpha: &Sym2| 2.0 / 3.0 * MODULUS * alpha;
    let rate = |alpha: &Sym2| flow(n, back_stress(alpha), 1.0).1;

    let (steps, end) = (400, 2.0);
    let h = end / f64::from(steps);
    let mut alpha = Sym2::zeros();
    for step in 0..steps {
        let x = back_stress(&alpha);
        let x_eq = von_mises(&x);
        let exact = MODULUS / RECALL * (1.0 - (-RECALL * h * f64::from(step)).exp());
        assert_relative_eq!(x_eq, exact, epsilon = 1e-9);

        let (plastic, back) = flow(n, x, 1.0);
        assert_relative_eq!(equivalent_strain(&plastic), 1.0, epsilon = 1e-14);
        let flux = ArmstrongFrederick::flux(&plastic, &back, 1.0);
        let force = force(n, 1.0, x, 0.0, 0.0);
        let value = law.b(&flux, &force);
        assert_relative_eq!(value, flux.dot(&force), epsilon = 1e-12);
        assert_relative_eq!(
            value,
            YIELD + RECALL / MODULUS * x_eq.powi(2),
            epsilon = 1e-12
        );

        let k1 = rate(&alpha);
        let k2 = rate(&(alpha + 0.5 * h * k1));
        let k3 = rate(&(alpha + 0.5 * h * k2));
        let k4 = rate(&(alpha + h * k3));
        alpha += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    assert_relative_eq!(
        von_mises(&back_stress(&alpha)),
        MODULUS / RECALL,
        max_relative = 3e-3
    );
    Ok(())
}
