//! Non-associated Drucker–Prager plasticity; not associated only: k_t runs from 0 to k_f.

use crate::contract::{Samples, check, for_all};
use crate::samples::{any_deviator, spherical, unit_deviator};
use moreau_laws::{Bipotential, DruckerPrager, LawError};
use moreau_mandel::{Sym2, deviator, trace};
use proptest::prelude::*;

const FRICTION: f64 = 0.7;
const APEX: f64 = 1.3;

/// The stress at the distance t_n below the apex, a share of the way to the yield surface along n.
fn stress(n: Sym2, share: f64, t_n: f64) -> Sym2 {
    share * FRICTION * t_n * n + spherical(APEX - t_n)
}

/// The rate of deviator e and of dilation e_v.
fn rate(e: Sym2, e_v: f64) -> Sym2 {
    e + spherical(e_v / 3.0)
}

fn law_pair(dilatancy: f64) -> BoxedStrategy<(Sym2, Sym2)> {
    prop_oneof![
        // On the lateral surface, at the apex, inside.
        (unit_deviator(), 0.0..3.0f64, 0.0..5.0f64).prop_map(move |(n, size, t_n)| {
            (rate(size * n, dilatancy * size), stress(n, 1.0, t_n))
        }),
        (any_deviator(3.0), 0.0..3.0f64)
            .prop_map(move |(e, more)| { (rate(e, dilatancy * e.norm() + more), spherical(APEX)) }),
        (unit_deviator(), 0.0..1.0f64, 0.0..5.0f64)
            .prop_map(|(n, share, t_n)| (Sym2::zeros(), stress(n, share, t_n))),
    ]
    .boxed()
}

fn samples(dilatancy: f64) -> Samples<Sym2> {
    let flux = (any_deviator(3.0), 0.0..3.0f64)
        .prop_map(move |(e, more)| rate(e, dilatancy * e.norm() + more));
    let force = |share: std::ops::Range<f64>| {
        (unit_deviator(), share, 0.1..5.0f64).prop_map(|(n, share, t_n)| stress(n, share, t_n))
    };
    Samples {
        flux: flux.clone().boxed(),
        force: force(0.0..1.0).boxed(),
        flux_outside: Some(
            (any_deviator(3.0), 1e-6..3.0f64)
                .prop_map(move |(e, less)| rate(e, dilatancy * e.norm() - less))
                .boxed(),
        ),
        force_outside: prop_oneof![
            force(1.001..9.0),
            (any_deviator(1.0), 1e-6..5.0f64).prop_map(|(s, above)| s + spherical(APEX + above)),
        ]
        .boxed(),
        law: law_pair(dilatancy),
        departure: (unit_deviator(), 0.1..3.0f64, 0.1..5.0f64)
            .prop_flat_map(move |(n, size, t_n)| {
                let zero = Sym2::zeros();
                let flow = rate(size * n, dilatancy * size);
                let edge = stress(n, 1.0, t_n);
                prop_oneof![
                    Just((flow, edge, zero, -0.5 * deviator(&edge))),
                    Just((flow, edge, rate(zero, 1.0), zero)),
                    Just((flow, spherical(APEX), zero, spherical(-1.0))),
                    Just((zero, stress(n, 0.5, t_n), flow, zero)),
                ]
            })
            .boxed(),
    }
}

#[test]
fn bipotential_of_soils() -> Result<(), LawError> {
    for dilatancy in [0.0, 0.25, FRICTION] {
        check(
            &DruckerPrager::new(FRICTION, dilatancy, APEX)?,
            &samples(dilatancy),
        );
    }
    Ok(())
}

#[test]
fn associated_flow_has_the_support_function() -> Result<(), LawError> {
    let law = DruckerPrager::new(FRICTION, FRICTION, APEX)?;
    let samples = samples(FRICTION);
    for_all(&(samples.flux, samples.force), |(x, y)| {
        prop_assert!((law.b(&x, &y) - APEX * trace(&x)).abs() <= 1e-12);
        Ok(())
    });
    Ok(())
}

/// The Coulomb cone serves: its natural map vanishes on the law and only there.
#[test]
fn natural_map_of_the_equivalent_contact() -> Result<(), LawError> {
    for dilatancy in [0.0, 0.25, FRICTION] {
        let law = DruckerPrager::new(FRICTION, dilatancy, APEX)?;
        let samples = samples(dilatancy);
        for_all(&(samples.law, 0.01..100.0f64), |((x, y), rho)| {
            prop_assert!(law.natural_map(&x, &y, rho).norm() <= 1e-12 * (10.0 + rho * x.norm()));
            Ok(())
        });
        for_all(
            &(samples.departure, 0.01..100.0f64),
            |((x, y, dx, dy), rho)| {
                prop_assert!(law.natural_map(&(x + dx), &(y + dy), rho).norm() > 1e-4);
                Ok(())
            },
        );
    }
    Ok(())
}
