//! The standard laws, through the blanket bipotential of a superpotential [31]; not their
//! incremental forms.

use crate::contract::{Departure, Samples, check, for_all};
use crate::samples::{any_deviator, normal, spherical, unit_deviator, unit_tangent, vector};
use moreau_laws::LawError;
use moreau_laws::textbook::{Signorini, Uniaxial, VonMisesDissipation};
use moreau_laws::{Bipotential, Local, Superpotential, Tresca};
use moreau_mandel::Sym2;
use proptest::prelude::*;

const YIELD: f64 = 2.0;

#[test]
fn uniaxial_plasticity() -> Result<(), LawError> {
    let samples = Samples {
        flux: (-3.0..3.0f64).boxed(),
        force: (-YIELD..=YIELD).boxed(),
        flux_outside: None,
        force_outside: prop_oneof![-9.0 * YIELD..-1.001 * YIELD, 1.001 * YIELD..9.0 * YIELD]
            .boxed(),
        law: prop_oneof![
            (-YIELD..=YIELD).prop_map(|y| (0.0, y)),
            (-3.0..3.0f64).prop_map(|x: f64| (x, YIELD * x.signum())),
        ]
        .boxed(),
        departure: prop_oneof![
            (-0.9 * YIELD..0.9 * YIELD).prop_map(|y| (0.0, y, 1.0, 0.0)),
            (0.1..3.0f64).prop_map(|x| (x, YIELD, 0.0, -YIELD)),
        ]
        .boxed(),
    };
    check(&Uniaxial::new(100.0, YIELD)?, &samples);
    Ok(())
}

#[test]
fn von_mises_dissipation() -> Result<(), LawError> {
    // On the yield surface at the flow direction n, under any pressure.
    let radius = (2.0f64 / 3.0).sqrt() * YIELD;
    let at = move |n: Sym2, share: f64, mean: f64| share * radius * n + spherical(mean);
    let samples = Samples {
        flux: any_deviator(3.0),
        force: (unit_deviator(), 0.0..=1.0f64, -9.0..9.0f64)
            .prop_map(move |(n, share, mean)| at(n, share, mean))
            .boxed(),
        flux_outside: Some(
            (any_deviator(3.0), 0.01..1.0f64)
                .prop_map(|(e, mean)| e + spherical(mean))
                .boxed(),
        ),
        force_outside: (unit_deviator(), 1.001..9.0f64, -9.0..9.0f64)
            .prop_map(move |(n, share, mean)| at(n, share, mean))
            .boxed(),
        law: prop_oneof![
            (unit_deviator(), 0.0..3.0f64, -9.0..9.0f64)
                .prop_map(move |(n, rate, mean)| (rate * n, at(n, 1.0, mean))),
            (unit_deviator(), 0.0..=1.0f64, -9.0..9.0f64)
                .prop_map(move |(n, share, mean)| (Sym2::zeros(), at(n, share, mean))),
        ]
        .boxed(),
        departure: (unit_deviator(), 0.1..3.0f64, -9.0..9.0f64)
            .prop_map(move |(n, rate, mean)| {
                (rate * n, at(n, 1.0, mean), Sym2::zeros(), -at(n, 0.5, 0.0))
            })
            .boxed(),
    };
    check(&VonMisesDissipation::new(YIELD)?, &samples);
    Ok(())
}

#[test]
fn unilateral_contact() {
    let samples = Samples {
        flux: (-9.0..=0.0f64).boxed(),
        force: (0.0..=9.0f64).boxed(),
        flux_outside: Some((1e-6..9.0f64).boxed()),
        force_outside: (-9.0..-1e-6f64).boxed(),
        law: prop_oneof![
            (0.0..9.0f64).prop_map(|t_n| (0.0, t_n)),
            (-9.0..0.0f64).prop_map(|x| (x, 0.0)),
        ]
        .boxed(),
        departure: prop_oneof![
            (0.1..9.0f64).prop_map(|t_n| (0.0, t_n, -1.0, 0.0)),
            (-9.0..-0.1f64).prop_map(|x| (x, 0.0, 0.0, 1.0)),
        ]
        .boxed(),
    };
    check(&Signorini, &samples);
}

#[test]
fn signorini_holds_where_its_bipotential_vanishes() {
    let pair = (
        prop_oneof![Just(0.0), -2.0..2.0f64],
        prop_oneof![Just(0.0), -2.0..2.0f64],
    );
    for_all(&pair, |(u_n, t_n)| {
        let extremal = Signorini.v(&-u_n) + Signorini.w(&t_n) + u_n * t_n == 0.0;
        prop_assert_eq!(Signorini.holds(u_n, t_n), extremal);
        Ok(())
    });
    assert!(!Signorini.holds(f64::NAN, 0.0) && !Signorini.holds(0.0, f64::NAN));
}

const LIMIT: f64 = 1.5;

fn tresca_departure<const D: usize>() -> BoxedStrategy<Departure<Local<D>>> {
    (unit_tangent::<D>(), 0.1..3.0f64, 0.1..3.0f64)
        .prop_flat_map(|(tau, slip, t_n)| {
            let (n, zero) = (normal::<D>(), Local::zeros());
            prop_oneof![
                Just((slip * tau, t_n * n + LIMIT * tau, zero, -LIMIT * tau)),
                Just((slip * tau, t_n * n + LIMIT * tau, -n, zero)),
                Just((zero, t_n * n + 0.5 * LIMIT * tau, tau, zero)),
                Just((-n, LIMIT * tau, zero, n)),
            ]
        })
        .boxed()
}

fn tresca<const D: usize>() -> Result<(), LawError> {
    let force = |share: std::ops::RangeInclusive<f64>| {
        (unit_tangent::<D>(), share, 0.0..=5.0f64)
            .prop_map(|(tau, share, t_n)| t_n * normal::<D>() + share * LIMIT * tau)
    };
    let flux = vector::<D>(3.0).prop_map(|x| {
        let mut x = x;
        x[0] = -x[0].abs();
        x
    });
    let samples = Samples {
        flux: flux.clone().boxed(),
        force: force(0.0..=1.0).boxed(),
        flux_outside: Some(flux.prop_map(|x| x + (1e-6 - x[0]) * normal::<D>()).boxed()),
        force_outside: prop_oneof![
            force(1.001..=9.0),
            force(0.0..=1.0).prop_map(|t| t - (1e-6 + t[0]) * normal::<D>()),
        ]
        .boxed(),
        law: (unit_tangent::<D>(), 0.0..3.0f64, 0.0..3.0f64)
            .prop_flat_map(|(tau, slip, value)| {
                let n = normal::<D>();
                prop_oneof![
                    Just((slip * tau, value * n + LIMIT * tau)),
                    Just((slip * tau - value * n, LIMIT * tau)),
                    Just((Local::zeros(), value * n + 0.3 * LIMIT * tau)),
                ]
            })
            .boxed(),
        departure: tresca_departure::<D>(),
    };
    check(&Tresca::new(LIMIT)?, &samples);
    Ok(())
}

#[test]
fn tresca_friction() -> Result<(), LawError> {
    tresca::<2>()?;
    tresca::<3>()
}

#[test]
fn a_superpotential_is_a_separable_bipotential() -> Result<(), LawError> {
    let law = Uniaxial::new(100.0, YIELD)?;
    assert_eq!(law.b(&-0.25, &1.0), law.v(&-0.25) + law.w(&1.0));
    assert_eq!(law.b(&-0.25, &1.0), 0.25 * YIELD);
    Ok(())
}
