//! Modified Cam-Clay; not its integration over finite steps.

use crate::contract::{Samples, check, for_all};
use moreau_laws::textbook::CamClay;
use moreau_laws::{Bipotential, LawError};
use nalgebra::Vector3;
use proptest::prelude::*;
use std::f64::consts::PI;

const SLOPE: f64 = 1.2;

/// The force at a share of the half-axis c of the ellipse, at the angle θ.
fn force(c: f64, share: f64, theta: f64) -> Vector3<f64> {
    let (sin, cos) = theta.sin_cos();
    Vector3::new(c + share * c * cos, share * c * SLOPE * sin, c)
}

/// The flux of rates e_v, e_q with ȧ = e_v.
fn flux(e_v: f64, e_q: f64) -> Vector3<f64> {
    Vector3::new(e_v, e_q, -e_v)
}

/// The flux of size λ normal to the ellipse at the angle θ, in the (p, q) plane.
fn flow(size: f64, theta: f64) -> Vector3<f64> {
    let (sin, cos) = theta.sin_cos();
    flux(size * cos, size * sin / SLOPE)
}

fn samples() -> Samples<Vector3<f64>> {
    let sampled = |share: std::ops::Range<f64>| {
        (0.1..3.0f64, share, -PI..PI).prop_map(|(c, share, theta)| force(c, share, theta))
    };
    let rates = (-3.0..3.0f64, -3.0..3.0f64).prop_map(|(e_v, e_q)| flux(e_v, e_q));
    Samples {
        flux: rates.clone().boxed(),
        force: sampled(0.0..1.0).boxed(),
        flux_outside: Some(
            (rates, 1e-3..1.0f64)
                .prop_map(|(x, more)| x + Vector3::new(0.0, 0.0, more))
                .boxed(),
        ),
        force_outside: sampled(1.001..5.0).boxed(),
        law: prop_oneof![
            (0.0..3.0f64, 0.0..3.0f64, -PI..PI)
                .prop_map(|(size, c, theta)| (flow(size, theta), force(c, 1.0, theta))),
            sampled(0.0..1.0).prop_map(|y| (Vector3::zeros(), y)),
        ]
        .boxed(),
        departure: (0.1..3.0f64, 0.1..3.0f64, -PI..PI)
            .prop_flat_map(|(size, c, theta)| {
                let (x, y, zero) = (flow(size, theta), force(c, 1.0, theta), Vector3::zeros());
                prop_oneof![
                    Just((x, y, zero, force(c, 0.0, theta) - y)),
                    Just((x, y, flow(size, theta + 0.5 * PI), zero)),
                    Just((zero, force(c, 0.5, theta), x, zero)),
                ]
            })
            .boxed(),
    }
}

#[test]
fn bipotential_of_clays() -> Result<(), LawError> {
    check(&CamClay::new(SLOPE)?, &samples());
    Ok(())
}

/// The plastic power p e_v + q e_q = c (e_v + √(e_v² + M² e_q²)) is non-negative.
#[test]
fn flow_dissipates() -> Result<(), LawError> {
    let law = CamClay::new(SLOPE)?;
    for_all(&samples().law, |(x, y)| {
        let power = y[0] * x[0] + y[1] * x[1];
        prop_assert!(power >= -1e-12);
        prop_assert!((law.b(&x, &y) + y[2] * x[0] - power).abs() <= 1e-12 * (1.0 + power));
        Ok(())
    });
    Ok(())
}
