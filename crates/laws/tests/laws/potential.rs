//! The incremental potentials of the bulk, [48]-[65]; not paths with known answers.

use crate::contract::for_all;
use crate::samples::{unit_deviator, vector};
use approx::assert_relative_eq;
use moreau_laws::textbook::{Uniaxial, VonMisesDissipation};
use moreau_laws::{BulkLaw, Elastic, Isotropic, LawError, Superpotential, contract};
use moreau_laws::{DruckerPrager, ElasticDruckerPrager, VonMises, VonMisesState};
use moreau_mandel::{Sym2, deviator, equivalent_strain, identity, trace, von_mises};
use proptest::prelude::*;

const YOUNG: f64 = 210e3;
const POISSON: f64 = 0.3;
const YIELD: f64 = 300.0;
/// Strain at yield, the size of the steps.
const STRAIN: f64 = YIELD / YOUNG;
/// Round-off of an energy density, relative to that at yield.
const ENERGY: f64 = 1e-11 * YIELD * STRAIN;

/// Perfect, isotropic, kinematic and combined hardening.
fn von_mises_laws() -> Result<Vec<VonMises>, LawError> {
    let perfect = VonMises::new(YOUNG, POISSON, YIELD)?;
    let table = [[0.0, YIELD], [2e-3, 340.0], [6e-3, 340.0], [0.02, 420.0]];
    Ok(vec![
        perfect.clone(),
        perfect.clone().with_isotropic(5e3)?,
        perfect.clone().with_kinematic(20e3)?,
        perfect.clone().with_isotropic(2e3)?.with_kinematic(70e3)?,
        perfect
            .clone()
            .with_hardening(Isotropic::voce(150.0, 200.0)?),
        perfect
            .clone()
            .with_hardening(Isotropic::swift(700.0, 0.01, 0.2)?)
            .with_kinematic(3e3)?,
        perfect.with_hardening(Isotropic::table(&table)?),
    ])
}

/// Strains at which the table above bends: no derivative to compare with.
fn bends(law: &VonMises, p: f64) -> bool {
    let modulus = |p: f64| law.isotropic().modulus(p.max(0.0));
    let near = 2e-3 * STRAIN;
    (modulus(p + near) - modulus(p - near)).abs() > 1e3
}

/// ΔV of a law that has one.
fn potential<L: BulkLaw>(law: &L, old: &L::State, d_eps: &Sym2) -> f64 {
    law.potential(old, d_eps).expect("a potential")
}

/// The state after a path of steps from the virgin state.
fn after<L: BulkLaw>(law: &L, path: &[Sym2]) -> L::State {
    let virgin = law.initial();
    path.iter()
        .fold(virgin, |state, d_eps| law.respond(&state, d_eps).state)
}

fn path() -> BoxedStrategy<Vec<Sym2>> {
    prop::collection::vec(vector::<6>(3.0 * STRAIN), 0..4).boxed()
}

fn step() -> BoxedStrategy<Sym2> {
    prop_oneof![vector::<6>(0.3 * STRAIN), vector::<6>(5.0 * STRAIN)].boxed()
}

/// What every isotropic law of the bulk must show that derives from a potential.
fn contract<L: BulkLaw>(law: &L) {
    let report = contract::bulk(law).unwrap_or_else(|violation| panic!("{violation}"));
    assert!(report.count("the gradient of the potential is Δσ") > 100);
    contract::isotropy(law).unwrap_or_else(|violation| panic!("{violation}"));
}

#[test]
fn elasticity_obeys_the_contract() -> Result<(), LawError> {
    for poisson in [-0.5, 0.0, POISSON, 0.49] {
        contract(&Elastic::new(YOUNG, poisson)?);
    }
    Ok(())
}

#[test]
fn von_mises_obeys_the_contract() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        contract(&law);
    }
    Ok(())
}

/// Drucker–Prager with associated flow, of strength and stiffness like the others.
#[test]
fn associated_soils_obey_the_contract() -> Result<(), LawError> {
    for friction in [0.1, 0.6] {
        let plastic = DruckerPrager::new(friction, friction, YIELD)?;
        contract(&ElasticDruckerPrager::new(YOUNG, POISSON, plastic)?);
    }
    Ok(())
}

/// Yield, incompressible flow, the decomposition of strain, and flow along the stress.
#[test]
fn admissible_states() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        let rigid = VonMisesDissipation::new(YIELD)?;
        for_all(&(path(), step()), |(path, d_eps)| {
            let old = after(&law, &path);
            let new = law.respond(&old, &d_eps).state;
            let size = YIELD + law.stress(&new).norm();
            prop_assert!(law.yield_function(&new) <= 1e-12 * size);
            prop_assert!(trace(&new.plastic_strain).abs() <= 1e-15 * (1.0 + new.p));

            let d_e_p = new.plastic_strain - old.plastic_strain;
            prop_assert!((new.p - old.p - equivalent_strain(&d_e_p)).abs() <= 1e-15);
            let strain = new.elastic_strain - old.elastic_strain + d_e_p;
            prop_assert!((strain - d_eps).norm() <= 1e-15);

            // [61]: the dissipation is V_p of the increment; σ − X − (Hp) n does that power.
            let dissipation = law.dissipation(&old, &new);
            prop_assert!((dissipation - rigid.v(&deviator(&d_e_p))).abs() <= ENERGY);
            let power = (law.stress(&new) - law.back_stress(&new)).dot(&d_e_p)
                - law.isotropic().stress(new.p) * (new.p - old.p);
            prop_assert!((dissipation - power).abs() <= 10.0 * ENERGY);
            Ok(())
        });
    }
    Ok(())
}

/// The closed form [63] is the infimum [62], hardening included.
#[test]
fn potential_is_the_infimum() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        let (hardening, h_k) = (law.isotropic(), law.kinematic_modulus());
        let g = law.elastic().shear_modulus();
        let bracket = |old: &VonMisesState, d_eps: &Sym2, d_e_p: &Sym2| {
            let d_p = equivalent_strain(d_e_p);
            let plastic = old.plastic_strain;
            0.5 * law.elastic().bulk_modulus() * trace(d_eps).powi(2)
                + g * (deviator(d_eps) - d_e_p).norm_squared()
                + YIELD * d_p
                + hardening.energy(old.p + d_p)
                - hardening.energy(old.p)
                + h_k / 3.0 * ((plastic + d_e_p).norm_squared() - plastic.norm_squared())
                - law.stress(old).dot(d_e_p)
        };
        for_all(&(path(), step(), vector::<6>(1.0)), |(path, d_eps, d)| {
            let old = after(&law, &path);
            let new = law.respond(&old, &d_eps).state;
            let (value, reached) = (
                potential(&law, &old, &d_eps),
                new.plastic_strain - old.plastic_strain,
            );
            let size = 1.0 + value.abs() / (YIELD * STRAIN);
            prop_assert!((value - bracket(&old, &d_eps, &reached)).abs() <= ENERGY * size);
            for scale in [1e-3, 1e-1, 1.0, 10.0] {
                let other = reached + scale * STRAIN * deviator(&d);
                prop_assert!(value <= bracket(&old, &d_eps, &other) + ENERGY * size);
            }
            Ok(())
        });
    }
    Ok(())
}

/// ΔV and ΔW are a Fenchel pair, extremal at the response, [24], [26], [64].
#[test]
fn potentials_are_conjugate() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        for_all(&(path(), step(), step()), |(path, d_eps, other)| {
            let old = after(&law, &path);
            let d_sigma = law.respond(&old, &d_eps).stress - law.stress(&old);
            let value = potential(&law, &old, &d_eps);
            let complementary = |d| law.complementary(&old, d).expect("a potential");
            let size = 1.0 + value.abs() / (YIELD * STRAIN);
            let gap = value + complementary(&d_sigma) - d_sigma.dot(&d_eps);
            prop_assert!(gap.abs() <= 10.0 * ENERGY * size, "gap {gap:e}");

            let off = law.respond(&old, &other).stress - law.stress(&old);
            let gap = value + complementary(&off) - off.dot(&d_eps);
            prop_assert!(gap >= -10.0 * ENERGY * size, "gap {gap:e}");
            let far = 10.0 * YOUNG * deviator(&other);
            let gap = value + complementary(&far) - far.dot(&d_eps);
            prop_assert!(gap >= -10.0 * ENERGY * size, "gap {gap:e}");
            Ok(())
        });
    }
    let perfect = VonMises::new(YOUNG, POISSON, YIELD)?;
    let beyond = Sym2::from([1.001 * YIELD, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let virgin = VonMisesState::default();
    assert_eq!(perfect.complementary(&virgin, &beyond), Some(f64::INFINITY));
    Ok(())
}

/// A state, and a strain increment whose elastic trial has `share` of the equivalent stress at
/// which the state yields, in the direction n.
fn aimed(law: &VonMises, old: &VonMisesState, n: &Sym2, share: f64, dilation: f64) -> Sym2 {
    let limit = YIELD + law.isotropic().stress(old.p);
    let trial = law.back_stress(old) + share * (2.0f64 / 3.0).sqrt() * limit * n;
    (trial - deviator(&law.stress(old))) / (2.0 * law.elastic().shear_modulus())
        + dilation * identity()
}

/// The consistent tangent by central differences, off the kink, from states that include some
/// 10⁻⁹ from the yield surface.
#[test]
fn consistent_tangent() -> Result<(), LawError> {
    let share = || prop_oneof![0.0..0.99f64, 1.01..5.0f64];
    let start = prop_oneof![Just(1.0 - 1e-9), Just(1.0 + 1e-9), 0.0..3.0f64];
    for law in von_mises_laws()? {
        let aims = (unit_deviator(), share(), -STRAIN..STRAIN);
        let samples = (
            path(),
            (unit_deviator(), start.clone()),
            aims,
            vector::<6>(1.0),
        );
        for_all(&samples, |(path, (m, start), (n, share, dilation), d)| {
            let old = after(&law, &path);
            let old = law.respond(&old, &aimed(&law, &old, &m, start, 0.0)).state;
            let d_eps = aimed(&law, &old, &n, share, dilation);
            let response = law.respond(&old, &d_eps);
            prop_assert_eq!(share > 1.0, response.state.p > old.p);
            prop_assume!(!bends(&law, response.state.p));

            let h = 1e-4 * STRAIN;
            let stress = |eps: f64| law.respond(&old, &(d_eps + eps * d)).stress;
            // Fourth order, for the curvature of the surface.
            let difference = (8.0 * (stress(h) - stress(-h))
                - (stress(2.0 * h) - stress(-2.0 * h)))
                / (12.0 * h);
            let error = (response.tangent * d - difference).norm() / (YOUNG * d.norm());
            prop_assert!(error <= 1e-7, "relative error {error:e}");
            Ok(())
        });
    }
    Ok(())
}

/// 10⁻⁹ beyond the yield surface the tangent is that of plastic flow, by one-sided differences
/// outwards; 10⁻⁹ within it is elastic.
#[test]
fn consistent_tangent_at_the_yield_surface() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        for_all(
            &(path(), unit_deviator(), unit_deviator()),
            |(path, n, side)| {
                let old = after(&law, &path);
                let inside = law.respond(&old, &aimed(&law, &old, &n, 1.0 - 1e-9, 0.0));
                prop_assert_eq!(inside.tangent, law.elastic_tangent());

                let d_eps = aimed(&law, &old, &n, 1.0 + 1e-9, 0.0);
                let tangent = law.respond(&old, &d_eps).tangent;
                prop_assume!(!bends(&law, old.p));
                let outwards = n + 0.5 * side;
                let h = 1e-5 * STRAIN;
                let stress = |eps: f64| law.respond(&old, &(d_eps + eps * outwards)).stress;
                let difference =
                    (4.0 * stress(h) - 3.0 * stress(0.0) - stress(2.0 * h)) / (2.0 * h);
                let error = (tangent * outwards - difference).norm() / YOUNG;
                prop_assert!(error <= 1e-7, "relative error {error:e}");
                Ok(())
            },
        );
    }
    Ok(())
}

/// Without hardening the tangent resists no strain along the flow.
#[test]
fn perfect_plasticity_flows_freely() -> Result<(), LawError> {
    let law = VonMises::new(YOUNG, POISSON, YIELD)?;
    for_all(
        &(path(), unit_deviator(), 1.01..5.0f64),
        |(path, n, share)| {
            let old = after(&law, &path);
            let tangent = law
                .respond(&old, &aimed(&law, &old, &n, share, 0.0))
                .tangent;
            prop_assert!((tangent * n).norm() <= 1e-12 * YOUNG);
            Ok(())
        },
    );
    Ok(())
}

/// ΔV tends to the elastic energy when the step is too small to yield, and is it within.
#[test]
fn elastic_limit() -> Result<(), LawError> {
    let law = VonMises::new(YOUNG, POISSON, YIELD)?;
    let virgin = VonMisesState::default();
    for_all(&vector::<6>(0.2 * STRAIN), |d_eps| {
        prop_assert!(von_mises(&law.elastic().stress(&d_eps)) < YIELD);
        prop_assert_eq!(
            law.potential(&virgin, &d_eps),
            Some(law.elastic().energy(&d_eps))
        );
        prop_assert_eq!(
            law.respond(&virgin, &d_eps).stress,
            law.elastic().stress(&d_eps)
        );
        Ok(())
    });
    Ok(())
}

#[test]
fn elastic_moduli() -> Result<(), LawError> {
    let law = Elastic::new(YOUNG, POISSON)?;
    assert_relative_eq!(law.bulk_modulus(), 175e3, max_relative = 1e-15);
    assert_relative_eq!(
        law.shear_modulus(),
        80_769.230_769_230_77,
        max_relative = 1e-15
    );
    for_all(&vector::<6>(STRAIN), |strain| {
        let stress = law.stress(&strain);
        prop_assert!((law.tangent() * strain - stress).norm() <= 1e-12 * YIELD);
        let (energy, complementary) = (law.energy(&strain), law.complementary_energy(&stress));
        prop_assert!((2.0 * energy - stress.dot(&strain)).abs() <= ENERGY);
        prop_assert!((complementary - energy).abs() <= ENERGY);
        Ok(())
    });
    // Uniaxial stress strains by E and contracts by ν.
    let strain = Sym2::from([1.0, -POISSON, -POISSON, 0.0, 0.0, 0.0]) / YOUNG;
    let expected = Sym2::from([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_relative_eq!(law.stress(&strain), expected, epsilon = 1e-15);
    Ok(())
}

/// The bar: [56] is the infimum [52], found by golden sections, and its derivative is Δσ.
#[test]
fn uniaxial_potential() -> Result<(), LawError> {
    let law = Uniaxial::new(YOUNG, YIELD)?;
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for_all(
        &(-YIELD..=YIELD, -5.0 * STRAIN..5.0 * STRAIN),
        |(stress_0, d_eps)| {
            let response = law.respond(stress_0, d_eps);
            let value = law.potential(stress_0, d_eps);
            let bracket = |d_eps_p: f64| law.convolved(stress_0, d_eps, d_eps_p);

            let (mut low, mut high) = (-10.0 * STRAIN, 10.0 * STRAIN);
            while high - low > 1e-9 * STRAIN {
                let (a, b) = (high - golden * (high - low), low + golden * (high - low));
                if bracket(a) < bracket(b) {
                    high = b;
                } else {
                    low = a;
                }
            }
            prop_assert!((bracket(0.5 * (low + high)) - value).abs() <= 1e-8 * YIELD * STRAIN);
            prop_assert!((bracket(response.d_eps_p) - value).abs() <= ENERGY);

            let h = 1e-6 * STRAIN;
            let at = |eps: f64| law.potential(stress_0, d_eps + eps);
            let difference = (at(h) - at(-h)) / (2.0 * h);
            prop_assert!((difference - (response.stress - stress_0)).abs() <= YOUNG * h);
            prop_assert!(response.stress.abs() <= YIELD);
            let elastic = stress_0 + YOUNG * (d_eps - response.d_eps_p);
            prop_assert!((response.stress - elastic).abs() <= 1e-12 * YIELD);
            // [9]: the stress at the end is a subgradient of V_p at the flow.
            let extremal = law.v(&response.d_eps_p) + law.w(&response.stress);
            prop_assert!((extremal - response.stress * response.d_eps_p).abs() <= ENERGY);
            let tangent = if response.d_eps_p == 0.0 { YOUNG } else { 0.0 };
            prop_assert_eq!(response.tangent, tangent);
            Ok(())
        },
    );
    assert!(law.respond(0.0, f64::NAN).stress.is_nan());
    Ok(())
}
