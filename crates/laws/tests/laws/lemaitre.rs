//! Plasticity with Lemaitre's damage; not the growth of damage over finite steps.

use crate::contract::{Samples, check};
use crate::samples::{spherical, unit_deviator};
use moreau_laws::LawError;
use moreau_laws::textbook::{Damaging, Lemaitre};
use moreau_mandel::Sym2;
use proptest::prelude::*;

const YIELD: f64 = 2.0;
const STRENGTH: f64 = 0.8;

fn samples(m: f64, damage: f64) -> Samples<Damaging> {
    let sound = 1.0 - damage;
    // The stress with a share of the equivalent stress allowed, in the direction n.
    let force = move |n: Sym2, share: f64, hardening: f64, release: f64| {
        let s = share * (2.0f64 / 3.0).sqrt() * sound * (YIELD + hardening) * n;
        Lemaitre::force(&(s + spherical(1.7)), hardening, release)
    };
    let forces = move |share: std::ops::Range<f64>| {
        (unit_deviator(), share, 0.0..2.0f64, -0.5..2.0f64)
            .prop_map(move |(n, share, r, y)| force(n, share, r, y))
    };
    let rates = move |share: std::ops::Range<f64>, trace: f64| {
        (unit_deviator(), share, 0.1..2.0f64, 0.0..2.0f64).prop_map(move |(n, share, p, d)| {
            let plastic = share * 1.5f64.sqrt() * p * n + spherical(trace);
            Lemaitre::flux(&plastic, sound * p, d)
        })
    };
    let flow = move |n: Sym2, p: f64, release: f64| {
        let growth = (release.max(0.0) / STRENGTH).powf(m) * p;
        Lemaitre::flux(&(1.5f64.sqrt() * p * n), sound * p, growth)
    };
    let yielding = (unit_deviator(), 0.1..2.0f64, 0.0..2.0f64, 0.3..2.0f64);
    Samples {
        flux: rates(0.0..1.0, 0.0).boxed(),
        force: forces(0.0..1.0).boxed(),
        flux_outside: Some(
            prop_oneof![
                rates(1.001..5.0, 0.0),
                rates(0.0..1.0, 0.01),
                // Damage that heals, damage without flow, and flow backwards.
                rates(0.0..1.0, 0.0).prop_map(|mut x| {
                    x[7] = -0.1 - x[7];
                    x
                }),
                (0.1..2.0f64).prop_map(|d| Lemaitre::flux(&Sym2::zeros(), 0.0, d)),
                (0.1..2.0f64).prop_map(|d| Lemaitre::flux(&Sym2::zeros(), -0.0, d)),
                (0.1..2.0f64).prop_map(|r| Lemaitre::flux(&Sym2::zeros(), -r, 0.0)),
            ]
            .boxed(),
        ),
        force_outside: forces(1.001..5.0).boxed(),
        law: prop_oneof![
            yielding
                .clone()
                .prop_map(move |(n, p, r, y)| (flow(n, p, y), force(n, 1.0, r, y))),
            (unit_deviator(), 0.1..2.0f64, -2.0..0.0f64)
                .prop_map(move |(n, p, y)| (flow(n, p, y), force(n, 1.0, 0.5, y))),
            forces(0.0..1.0).prop_map(|y| (Damaging::zeros(), y)),
        ]
        .boxed(),
        departure: yielding
            .prop_flat_map(move |(n, p, r, y)| {
                let (flux, edge) = (flow(n, p, y), force(n, 1.0, r, y));
                let (zero, none) = (Sym2::zeros(), Damaging::zeros());
                let mut inwards = -0.5 * edge;
                inwards.fixed_rows_mut::<2>(6).fill(0.0);
                prop_oneof![
                    Just((flux, edge, none, inwards)),
                    Just((flux, edge, none, Lemaitre::force(&zero, 0.0, 1.0))),
                    Just((flux, edge, Lemaitre::flux(&zero, 0.0, flux[7]), none)),
                    Just((flux, edge, Lemaitre::flux(&zero, 1.0, 0.0), none)),
                ]
            })
            .boxed(),
    }
}

#[test]
fn bipotential_of_damage() -> Result<(), LawError> {
    for (m, damage) in [(1.0, 0.0), (1.0, 0.3), (2.5, 0.3), (0.5, 0.8)] {
        check(
            &Lemaitre::new(YIELD, STRENGTH, m, damage)?,
            &samples(m, damage),
        );
    }
    Ok(())
}
