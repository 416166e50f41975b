//! The power of flow D(ε̇): the support function of the stresses that a law admits; not what a body
//! makes of it.

use crate::contract::for_all;
use crate::samples::{unit_deviator, vector};
use moreau_laws::{
    BulkLaw, DruckerPrager, Elastic, ElasticDruckerPrager, FlowPower, Hill, HillCoefficients,
    Isotropic, LawError, VonMises,
};
use moreau_mandel::{Sym2, deviator, identity, trace};
use proptest::prelude::*;

const YOUNG: f64 = 210e3;
const POISSON: f64 = 0.3;
const YIELD: f64 = 300.0;
const STRAIN: f64 = YIELD / YOUNG;
/// Round-off of a power, relative to that at yield.
const POWER: f64 = 1e-10 * YIELD * STRAIN;

/// With a yield surface that grows, moves, and does both, with recall or without.
fn von_mises_laws() -> Result<Vec<VonMises<1>>, LawError> {
    let perfect = |term| VonMises::new(YOUNG, POISSON, YIELD)?.with_recall([term]);
    let bare = perfect((0.0, 0.0))?;
    Ok(vec![
        bare.clone(),
        bare.clone().with_isotropic(5e3)?,
        bare.with_kinematic(20e3)?,
        perfect((40e3, 300.0))?.with_hardening(Isotropic::voce(150.0, 200.0)?),
    ])
}

fn soil(friction: f64, dilatancy: f64) -> Result<ElasticDruckerPrager, LawError> {
    let cone = DruckerPrager::new(friction, dilatancy, 200.0)?;
    ElasticDruckerPrager::new(YOUNG, POISSON, cone)
}

fn after<L: BulkLaw>(law: &L, path: &[Sym2]) -> L::State {
    path.iter().fold(law.initial(), |state, d_eps| {
        law.respond(&state, d_eps).state
    })
}

fn path() -> BoxedStrategy<Vec<Sym2>> {
    prop::collection::vec(vector::<6>(3.0 * STRAIN), 0..4).boxed()
}

fn rate() -> BoxedStrategy<Sym2> {
    vector::<6>(STRAIN)
}

/// What holds of every D: at least the power of the present stress, homogeneous, convex, and a
/// share of what counts as elastic that is none of a rate at rest.
fn contract<L: BulkLaw>(law: &L) {
    for_all(
        &(path(), rate(), rate(), 0.1..10.0),
        |(path, a, b, c): (Vec<Sym2>, Sym2, Sym2, f64)| {
            let state = after(law, &path);
            let power = |rate: &Sym2| law.flow_power(&state, rate).expect("associated");
            let size = 1.0 + law.stress(&state).norm() / YIELD;
            let more = power(&a).total - law.stress(&state).dot(&a);
            prop_assert!(more >= -POWER * size, "below the present stress: {more:e}");
            let scaled = power(&(c * a));
            prop_assert!((scaled.total - c * power(&a).total).abs() <= 10.0 * POWER * size);
            prop_assert!((scaled.elastic - c * power(&a).elastic).abs() <= 10.0 * POWER * size);
            let chord = power(&a).total + power(&b).total - power(&(a + b)).total;
            prop_assert!(chord >= -POWER * size, "not convex: {chord:e}");
            prop_assert!(power(&a).elastic >= 0.0);
            prop_assert_eq!(power(&Sym2::zeros()), FlowPower::default());
            Ok(())
        },
    );
}

#[test]
fn power_is_convex_and_no_less_than_that_of_the_stress() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        contract(&law);
    }
    contract(&Elastic::new(YOUNG, POISSON)?);
    contract(&soil(0.4, 0.4)?);
    Ok(())
}

/// D(ė) = sup σ : ė without change of volume, over all σ within the present surface: attained by the
/// stress whose normal is ė.
#[test]
fn von_mises_power_is_the_largest_of_the_admissible_stresses() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        let samples = (path(), unit_deviator(), unit_deviator(), 0.0..1.0, rate());
        for_all(&samples, |(path, n, other, part, any)| {
            let state = after(&law, &path);
            let radius = (2.0f64 / 3.0).sqrt() * (YIELD + law.isotropic().stress(state.p));
            let center = law.back_stress(&state);
            let power = law.flow_power(&state, &(STRAIN * n)).expect("von Mises");
            prop_assert!(power.elastic <= POWER, "no volume, nothing elastic");
            // Any admissible stress, with any mean.
            let sigma: Sym2 = center + part * radius * other + trace(&any) * YOUNG * identity();
            prop_assert!(power.total >= STRAIN * sigma.dot(&n) - POWER);
            // The one on the rule of flow.
            let sigma: Sym2 = center + radius * n;
            prop_assert!((power.total - STRAIN * sigma.dot(&n)).abs() <= POWER);
            // A change of volume is told, with the present mean stress.
            let volume = trace(&law.stress(&state)) * trace(&any) / 3.0;
            let whole = law.flow_power(&state, &any).expect("von Mises");
            let flow = law.flow_power(&state, &deviator(&any)).expect("von Mises");
            let size = 1.0 + volume.abs() / (YIELD * STRAIN);
            prop_assert!((whole.elastic - volume.abs()).abs() <= POWER * size);
            prop_assert!((whole.total - flow.total - volume).abs() <= POWER * size);
            Ok(())
        });
    }
    Ok(())
}

/// After a step of flow the rate of the plastic strain costs what the stress does on it.
#[test]
fn flow_costs_the_work_of_its_stress() -> Result<(), LawError> {
    let (steel, soil) = (VonMises::new(YOUNG, POISSON, YIELD)?, soil(0.4, 0.4)?);
    for_all(&(path(), rate()), |(path, d_eps)| {
        let (old, virgin) = (after(&steel, &path), after(&soil, &path));
        let new = steel.respond(&old, &(5.0 * d_eps)).state;
        let flow = new.plastic_strain - old.plastic_strain;
        let power = steel.flow_power(&new, &flow).expect("von Mises");
        let work = steel.stress(&new).dot(&flow);
        prop_assert!((power.total - work).abs() <= 10.0 * POWER, "von Mises");
        let new = soil.respond(&virgin, &(5.0 * d_eps)).state;
        let flow = new.plastic_strain - virgin.plastic_strain;
        let power = soil.flow_power(&new, &flow).expect("associated");
        let work = soil.stress(&new).dot(&flow);
        prop_assert!((power.total - work).abs() <= 10.0 * POWER, "soil");
        prop_assert!(power.elastic <= 100.0 * POWER, "{}", power.elastic);
        Ok(())
    });
    Ok(())
}

/// D = c₀ e_v of rates that dilate at least k ‖ė‖, over all stresses of the cone; of others what is
/// missing of the dilation is told. None where flow is not associated.
#[test]
fn drucker_prager_power_is_the_largest_of_the_cone() -> Result<(), LawError> {
    const K: f64 = 0.4;
    const APEX: f64 = 200.0;
    let law = soil(K, K)?;
    let samples = (path(), unit_deviator(), unit_deviator(), 0.0..1.0);
    for_all(
        &(samples, 0.0..3.0f64, 0.0..5.0f64),
        |((path, n, other, part), more, below)| {
            let state = after(&law, &path);
            let rate = STRAIN * (n + (K + more) / 3.0 * identity());
            let power = law.flow_power(&state, &rate).expect("associated");
            prop_assert!((power.total - APEX * STRAIN * (K + more)).abs() <= POWER);
            prop_assert!(power.elastic <= POWER);
            // Any stress of the cone.
            let depth = below * APEX;
            let sigma: Sym2 = (APEX - depth) * identity() + part * K * depth * other;
            prop_assert!(power.total >= sigma.dot(&rate) - 10.0 * POWER);
            // On the rule of flow, where the rate is normal to the cone.
            let normal = STRAIN * (n + K / 3.0 * identity());
            let power = law.flow_power(&state, &normal).expect("associated");
            let sigma: Sym2 = (APEX - depth) * identity() + K * depth * n;
            prop_assert!((power.total - sigma.dot(&normal)).abs() <= 10.0 * POWER);
            // Without dilation, K ‖ė‖ of volume is missing.
            let mean = trace(&law.stress(&state)) / 3.0;
            let power = law.flow_power(&state, &(STRAIN * n)).expect("associated");
            let missing = (mean * K * STRAIN).abs();
            prop_assert!((power.elastic - missing).abs() <= POWER * (1.0 + mean.abs() / YIELD));
            Ok(())
        },
    );
    let loose = soil(K, 0.1)?;
    assert_eq!(loose.flow_power(&Default::default(), &identity()), None);
    Ok(())
}

/// Along plastic flow D rises by its hardening: of Δεᵖ alone, the rest of the strain leaves the surface where it is.
fn rises<L: BulkLaw>(law: &L) {
    for_all(&(unit_deviator(), 2.0..6.0), |(n, far): (Sym2, f64)| {
        let before = after(law, &[n * (far * STRAIN)]);
        let step = n * (1e-4 * STRAIN);
        let now = law.respond(&before, &step).state;
        let shear = YOUNG / (2.0 * (1.0 + POISSON));
        let flown = step - (law.stress(&now) - law.stress(&before)) / (2.0 * shear);
        let power = |s| law.flow_power(s, &flown).expect("associated");
        let [start, end] = [&before, &now].map(power);
        let (rise, told) = (end.total - start.total, start.hardening);
        let same = (rise - told).abs() <= 1e-3 * told + 1e-14 * start.total;
        prop_assert!(same, "{rise:e} {told:e}");
        Ok(())
    });
}

#[test]
fn hardening_is_the_rise_of_power_along_flow() -> Result<(), LawError> {
    for law in von_mises_laws()? {
        rises(&law);
    }
    let sheet = HillCoefficients::lankford(1.8, 1.3, 2.2)?;
    let hill = Hill::new(Elastic::new(YOUNG, POISSON)?, sheet, YIELD)?;
    rises(&hill.with_hardening(Isotropic::voce(150.0, 200.0)?));
    Ok(())
}
