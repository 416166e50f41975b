//! Non-associated Drucker–Prager plasticity; not associated only: k_t runs from 0 to k_f.

use crate::contract::{Samples, check, for_all};
use crate::samples::{any_deviator, spherical, unit_deviator, vector};
use moreau_laws::{
    Bipotential, BulkLaw, DruckerPrager, DruckerPragerState, ElasticDruckerPrager, LawError,
};
use moreau_mandel::{Sym2, Sym4, deviator, trace};
use proptest::prelude::*;
use std::cell::Cell;

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

const YOUNG: f64 = 50.0;

fn soil(dilatancy: f64) -> Result<ElasticDruckerPrager, LawError> {
    ElasticDruckerPrager::new(YOUNG, 0.3, DruckerPrager::new(FRICTION, dilatancy, APEX)?)
}

/// Steps from states on paths that reach the cone and its apex.
fn path() -> BoxedStrategy<(Vec<Sym2>, Sym2)> {
    let step = (vector::<6>(0.1), -0.1..0.1f64).prop_map(|(e, mean)| e + spherical(mean));
    (prop::collection::vec(step.clone(), 0..3), step).boxed()
}

fn after(law: &ElasticDruckerPrager, path: &[Sym2]) -> DruckerPragerState {
    let virgin = DruckerPragerState::default();
    path.iter()
        .fold(virgin, |state, d| law.respond(&state, d).state)
}

/// Every increment is extremal for the bipotential, on the cone and at the apex, and both are met.
#[test]
fn increments_are_extremal() -> Result<(), LawError> {
    for dilatancy in [0.0, 0.25, FRICTION] {
        let law = soil(dilatancy)?;
        let (cone, apex) = (Cell::new(0), Cell::new(0));
        for_all(&path(), |(path, d_eps)| {
            let old = after(&law, &path);
            let response = law.respond(&old, &d_eps);
            let new = response.state;
            let flow = new.plastic_strain - old.plastic_strain;
            let strain = new.elastic_strain - old.elastic_strain + flow;
            prop_assert!((strain - d_eps).norm() <= 1e-15);
            if new.p == old.p {
                return Ok(());
            }
            let n = deviator(&response.stress).norm();
            let counter = if n > 1e-12 * YOUNG { &cone } else { &apex };
            counter.set(counter.get() + 1);
            let power = response.stress.dot(&flow);
            let dissipation = law.dissipation(&old, &new);
            prop_assert!((dissipation - power).abs() <= 1e-14 * YOUNG);
            prop_assert!(dissipation >= 0.0);
            // Both ends are known to rounding of the strains: the domain is thick by that.
            let overstress = n - FRICTION * (APEX - trace(&response.stress) / 3.0);
            prop_assert!(overstress.abs() <= 1e-14 * YOUNG);
            let dilation = trace(&flow) - dilatancy * deviator(&flow).norm();
            prop_assert!(dilation >= -1e-15);
            let b = law.plastic().b(
                &(flow + spherical(1e-15)),
                &(response.stress - spherical(1e-13)),
            );
            prop_assert!((b - power).abs() <= 1e-11, "gap {:e}", b - power);
            Ok(())
        });
        assert!(cone.get() > 50 && apex.get() > 20, "{cone:?} {apex:?}");
    }
    Ok(())
}

/// The tangent and what it lacks are ∂σ₁/∂Δε by differences: inside, on the cone, at the apex. The tangent is
/// symmetric, and where the flow is not associated it is no mechanism, however much flows.
#[test]
fn tangent_of_soils() -> Result<(), LawError> {
    for dilatancy in [0.0, 0.25, FRICTION] {
        let law = soil(dilatancy)?;
        assert_eq!(law.is_symmetric(), dilatancy == FRICTION);
        let (cone, apex) = (Cell::new(0), Cell::new(0));
        for_all(&path(), |(path, d_eps)| {
            let old = after(&law, &path);
            let response = law.respond(&old, &d_eps);
            let h = 1e-6;
            let branch = |d_eps: &Sym2| {
                let new = law.respond(&old, d_eps).state;
                (
                    new.p > old.p,
                    deviator(&law.stress(&new)).norm() > 1e-12 * YOUNG,
                )
            };
            let mut difference = Sym4::zeros();
            for k in 0..6 {
                let moved = |eps: f64| {
                    let mut moved = d_eps;
                    moved[k] += eps;
                    moved
                };
                let stress = |eps: f64| law.respond(&old, &moved(eps)).stress;
                for eps in [-1e-3, 1e-3] {
                    prop_assume!(branch(&moved(eps)) == branch(&d_eps));
                }
                let column = (stress(h) - stress(-h)) / (2.0 * h);
                difference.set_column(k, &column);
            }
            let tangent = response.tangent;
            let lacking = law.lacking(&old, &d_eps);
            let error = (tangent + lacking - difference).norm() / YOUNG;
            prop_assert!(error <= 1e-7, "relative error {error:e}");
            prop_assert!((tangent - tangent.transpose()).norm() <= 1e-14 * YOUNG);
            let least = tangent.symmetric_eigenvalues().min();
            let elastic = law.elastic().tangent().symmetric_eigenvalues().min();
            if law.is_symmetric() {
                prop_assert_eq!(lacking, Sym4::zeros());
                prop_assert!(least >= -1e-12 * YOUNG);
            } else {
                prop_assert!(least >= (1e-2 - 1e-12) * elastic);
            }
            if response.state.p == old.p {
                prop_assert_eq!(lacking, Sym4::zeros());
            } else {
                let met = if branch(&d_eps).1 { &cone } else { &apex };
                met.set(met.get() + 1);
            }
            Ok(())
        });
        assert!(cone.get() > 20 && apex.get() > 5, "{cone:?} {apex:?}");
    }
    Ok(())
}

/// Strength in tension, compression and shear does not depend on the dilatancy; the dilation does.
#[test]
fn strengths_of_soils() -> Result<(), LawError> {
    let (tension, compression) = (
        FRICTION * APEX / ((2.0f64 / 3.0).sqrt() + FRICTION / 3.0),
        -FRICTION * APEX / ((2.0f64 / 3.0).sqrt() - FRICTION / 3.0),
    );
    for dilatancy in [0.0, 0.25, FRICTION] {
        let law = soil(dilatancy)?;
        for strength in [tension, compression] {
            // Proportional in stress up to yield, and then along the flow.
            let mut state = DruckerPragerState::default();
            let axial = Sym2::from([1.0, -0.3, -0.3, 0.0, 0.0, 0.0]) / YOUNG;
            let n = strength.signum() * Sym2::from([2.0, -1.0, -1.0, 0.0, 0.0, 0.0]) / 6f64.sqrt();
            let flow = n + dilatancy / 3.0 * spherical(1.0);
            for d_eps in [strength * axial, 0.01 * flow, 0.02 * flow] {
                state = law.respond(&state, &d_eps).state;
                let stress = law.stress(&state);
                let expected = Sym2::from([strength, 0.0, 0.0, 0.0, 0.0, 0.0]);
                assert!((stress - expected).norm() <= 1e-13 * YOUNG, "{stress}");
            }
            let dilation = trace(&state.plastic_strain);
            assert!((dilation - dilatancy * 0.03).abs() <= 1e-14);
        }
        let shear = law.respond(
            &DruckerPragerState::default(),
            &Sym2::from([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
        );
        // Dilation is held: the pressure rises with it.
        let mean = trace(&shear.stress) / 3.0;
        assert!((deviator(&shear.stress).norm() - FRICTION * (APEX - mean)).abs() <= 1e-12 * YOUNG);
        assert!((mean < -1e-3) == (dilatancy > 0.0));
    }
    Ok(())
}

#[test]
fn soils_without_friction_are_refused() -> Result<(), LawError> {
    let refused = ElasticDruckerPrager::new(YOUNG, 0.3, DruckerPrager::new(0.0, 0.0, APEX)?);
    assert!(matches!(refused, Err(LawError::NotPositive { .. })));
    let mut d_eps = Sym2::zeros();
    d_eps[3] = f64::NAN;
    let response = soil(0.1)?.respond(&DruckerPragerState::default(), &d_eps);
    assert!(response.stress.iter().any(|c| c.is_nan()));
    Ok(())
}

/// The cone touches Mohr and Coulomb's pyramid in triaxial compression: under a lateral pressure p the
/// axial one is N p + 2 c √N, N = (1 + sin φ)/(1 − sin φ).
#[test]
fn a_soil_of_mohr_and_coulomb_has_its_strength_in_triaxial_compression() -> Result<(), LawError> {
    for (cohesion, angle) in [(1.0f64, 30.0f64), (20.0, 5.0), (0.1, 45.0)] {
        let law = DruckerPrager::mohr_coulomb(cohesion, angle, 0.5 * angle)?;
        let sine = angle.to_radians().sin();
        let n = (1.0 + sine) / (1.0 - sine);
        for lateral in [0.0, cohesion, 30.0 * cohesion] {
            let axial = n * lateral + 2.0 * cohesion * n.sqrt();
            let stress = Sym2::from_column_slice(&[-lateral, -lateral, -axial, 0.0, 0.0, 0.0]);
            let bound = law.friction() * (law.apex() - trace(&stress) / 3.0);
            let found = deviator(&stress).norm();
            assert!((found / bound - 1.0).abs() < 1e-13, "{found} {bound}");
        }
        assert!(law.dilatancy() > 0.0 && law.dilatancy() < law.friction());
    }
    let of = DruckerPrager::mohr_coulomb;
    assert!(matches!(
        of(0.0, 30.0, 0.0),
        Err(LawError::NotPositive { .. })
    ));
    for (friction, dilatancy) in [
        (0.0, 0.0),
        (90.0, 0.0),
        (f64::NAN, 0.0),
        (30.0, 31.0),
        (30.0, -1.0),
    ] {
        let error = of(1.0, friction, dilatancy);
        assert!(
            matches!(error, Err(LawError::AngleOutOfRange { .. })),
            "{error:?}"
        );
    }
    Ok(())
}

/// p = ∫ √(2/3) ‖ε̇ᵖ‖ dt; under axial load and without dilation it is the axial plastic strain.
#[test]
fn the_equivalent_plastic_strain_is_the_length_of_the_plastic_path() -> Result<(), LawError> {
    for dilatancy in [0.0, 0.25, FRICTION] {
        let law = soil(dilatancy)?;
        for_all(&path(), |(path, d_eps)| {
            let (mut state, mut length) = (DruckerPragerState::default(), 0.0);
            for step in path.iter().chain([&d_eps]) {
                let new = law.respond(&state, step).state;
                let flow = new.plastic_strain - state.plastic_strain;
                length += (2.0f64 / 3.0).sqrt() * flow.norm();
                state = new;
                prop_assert!((law.equivalent_plastic_strain(&state) - length).abs() <= 1e-14);
            }
            Ok(())
        });
    }
    let pressed = Sym2::from([-0.5, 0.25, 0.25, 0.0, 0.0, 0.0]);
    let state = soil(0.0)?
        .respond(&DruckerPragerState::default(), &pressed)
        .state;
    assert!(state.plastic_strain[0] < -0.1);
    assert!(
        (state.p + state.plastic_strain[0]).abs() < 1e-15,
        "{state:?}"
    );
    Ok(())
}
