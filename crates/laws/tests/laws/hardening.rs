//! Hardening: curves with known answers, recall, and what it must obey on any path; not the
//! potentials, which recall has none of.

use crate::contract::for_all;
use crate::material_point::Point;
use crate::samples::vector;
use approx::assert_relative_eq;
use moreau_laws::textbook::ArmstrongFrederick;
use moreau_laws::{Bipotential, BulkLaw, Isotropic, LawError, VonMises, VonMisesState};
use moreau_mandel::{Sym2, Sym4, deviator, von_mises};
use proptest::prelude::*;

const YOUNG: f64 = 210e3;
const YIELD: f64 = 300.0;
const STRAIN: f64 = YIELD / YOUNG;

fn perfect() -> Result<VonMises, LawError> {
    VonMises::new(YOUNG, 0.3, YIELD)
}

/// A Chaboche law of two terms with recall, one without, and Voce's isotropic hardening.
fn chaboche() -> Result<VonMises<2>, LawError> {
    perfect()?
        .with_hardening(Isotropic::voce(60.0, 30.0)?)
        .with_kinematic(2e3)?
        .with_recall([(60e3, 400.0), (15e3, 80.0)])
}

/// R and ψ' are the same, R' its slope, and none falls.
#[test]
fn stored_energies() -> Result<(), LawError> {
    let table = [[0.0, 300.0], [0.01, 350.0], [0.04, 350.0], [0.1, 380.0]];
    let laws = [
        Isotropic::linear(1e3)?,
        Isotropic::voce(150.0, 20.0)?,
        Isotropic::voce(150.0, 0.0)?,
        Isotropic::swift(700.0, 0.01, 0.2)?,
        Isotropic::swift(700.0, 0.01, 1.0)?,
        Isotropic::table(&table)?,
    ];
    for law in laws {
        assert_eq!((law.stress(0.0), law.energy(0.0)), (0.0, 0.0));
        for_all(&(1e-3..0.3f64), |p| {
            let h = 1e-7;
            prop_assume!(table.iter().all(|[knot, _]| (knot - p).abs() > 2.0 * h));
            let slope = |f: &dyn Fn(f64) -> f64| (f(p + h) - f(p - h)) / (2.0 * h);
            let energy = slope(&|p| law.energy(p));
            prop_assert!((energy - law.stress(p)).abs() <= 1e-6 * (1.0 + law.stress(p)));
            let modulus = slope(&|p| law.stress(p));
            prop_assert!((modulus - law.modulus(p)).abs() <= 1e-4 * (1.0 + law.modulus(p)));
            prop_assert!(law.modulus(p) >= 0.0);
            Ok(())
        });
    }
    Ok(())
}

/// Tension in any number of steps: σ = σ_y + R(p) with p = ε − σ/E, and yield in reverse at −σ.
#[test]
fn tension_follows_the_curve() -> Result<(), LawError> {
    let table = [[0.0, 300.0], [2e-3, 360.0], [5e-3, 360.0], [0.02, 450.0]];
    let table_at = |p: f64| {
        let line = |a: [f64; 2], b: [f64; 2]| a[1] + (b[1] - a[1]) * (p - a[0]) / (b[0] - a[0]);
        match p {
            p if p < 2e-3 => line(table[0], table[1]),
            p if p < 5e-3 => 360.0,
            p if p < 0.02 => line(table[2], table[3]),
            _ => 450.0,
        }
    };
    let offset = (300.0f64 / 700.0).powf(5.0);
    type Curve<'a> = &'a dyn Fn(f64) -> f64;
    let cases: [(Isotropic, Curve<'_>); 3] = [
        (Isotropic::voce(150.0, 60.0)?, &|p| {
            300.0 + 150.0 * (1.0 - (-60.0 * p).exp())
        }),
        // A Swift law that starts at the yield stress is k (e₀ + p)ⁿ itself.
        (Isotropic::swift(700.0, offset, 0.2)?, &|p| {
            700.0 * (offset + p).powf(0.2)
        }),
        (Isotropic::table(&table)?, &table_at),
    ];
    for (hardening, curve) in cases {
        for steps in [1, 3, 40] {
            let mut point = Point::new(perfect()?.with_hardening(hardening.clone()));
            for step in 1..=steps {
                let eps = STRAIN + (0.03 - STRAIN) * f64::from(step) / f64::from(steps);
                let stress = point.pull_to(eps);
                let p = eps - stress / YOUNG;
                assert_relative_eq!(stress, curve(p), max_relative = 1e-11);
                assert_relative_eq!(point.state.p, p, epsilon = 1e-13);
            }
            let (top, p) = (point.stress()[0], point.state.p);
            let reversed = 0.03 - 2.0 * top / YOUNG;
            let bottom = point.pull_to(reversed + 1e-9 * STRAIN);
            assert_relative_eq!(bottom, -top, max_relative = 1e-8);
            assert_eq!(point.state.p, p);
            let further = point.pull_to(reversed - STRAIN);
            assert_relative_eq!(further, -curve(point.state.p), max_relative = 1e-11);
        }
    }
    let swift = Isotropic::swift(700.0, offset, 0.2)?;
    assert_relative_eq!(swift.initial().expect("Swift"), 300.0, max_relative = 1e-14);
    Ok(())
}

/// The axial back stress of a term, 3/2 X₁₁ = X_eq in tension.
fn axial(modulus: f64, back_strain: &Sym2) -> f64 {
    modulus * back_strain[0]
}

/// X = (C/γ)(1 − exp(−γ εᵖ)) in tension, to first order; each step is (X + CΔp)/(1 + γΔp) exactly,
/// and never beyond C/γ. Terms do not know of each other.
#[test]
fn recall_saturates_in_tension() -> Result<(), LawError> {
    let terms: [(f64, f64); 2] = [(60e3, 400.0), (15e3, 80.0)];
    let law = perfect()?.with_recall(terms)?;
    let exact = |p: f64| -> f64 {
        terms
            .iter()
            .map(|(c, g)| c / g * (1.0 - (-g * p).exp()))
            .sum()
    };
    let run = |steps: u32, end: f64| {
        let mut point = Point::new(law.clone());
        let mut x = [0.0; 2];
        let mut stress = point.pull_to(STRAIN);
        for step in 1..=steps {
            let p = point.state.p;
            stress = point.pull_to(STRAIN + end * f64::from(step) / f64::from(steps));
            let d_p = point.state.p - p;
            for (k, (c, g)) in terms.iter().enumerate() {
                x[k] = (x[k] + c * d_p) / (1.0 + g * d_p);
                assert_relative_eq!(axial(*c, &point.state.back_strain[k]), x[k], epsilon = 1e-9);
                assert!(x[k] <= c / g);
            }
            assert_relative_eq!(stress, YIELD + x[0] + x[1], max_relative = 1e-11);
        }
        (point.state.p, stress)
    };
    let error = |steps| {
        let (p, stress) = run(steps, 0.01);
        stress - YIELD - exact(p)
    };
    assert!(error(400).abs() < 1.0);
    assert_relative_eq!(error(400) / error(800), 2.0, max_relative = 0.02);
    // At great strain, in one step: C/γ of each.
    let (_, stress) = run(1, 0.2);
    assert_relative_eq!(stress, YIELD + 150.0 + 187.5, max_relative = 3e-2);
    Ok(())
}

/// A strain cycle: the elastic range of the reversal stays 2σ_y from the saturated stress.
#[test]
fn recall_keeps_the_elastic_range() -> Result<(), LawError> {
    let mut point = Point::new(perfect()?.with_recall([(30e3, 200.0)])?);
    for step in 1..=100 {
        point.pull_to(0.05 * f64::from(step) / 100.0);
    }
    let (top, p) = (point.stress()[0], point.state.p);
    assert_relative_eq!(top, YIELD + 150.0, max_relative = 1e-3);
    let bottom = point.pull_to(0.05 - 2.0 * STRAIN + 1e-9 * STRAIN);
    assert_relative_eq!(bottom, top - 2.0 * YIELD, epsilon = 1e-6);
    assert_eq!(point.state.p, p);
    point.pull_to(0.05 - 3.0 * STRAIN);
    assert!(point.state.p > p);
    Ok(())
}

/// A turn of the strain path: of first order in the step, as the return is for perfect plasticity.
#[test]
fn non_proportional_path() -> Result<(), LawError> {
    let along = Sym2::from([0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let across = Sym2::from([2.0, -1.0, -1.0, 0.0, 0.0, 0.0]) / 6f64.sqrt();
    let run = |steps: u32| -> Result<Sym2, LawError> {
        let mut point = Point::new(chaboche()?);
        for (start, direction) in [(Sym2::zeros(), across), (4.0 * STRAIN * across, along)] {
            for step in 1..=steps {
                let part = f64::from(step) / f64::from(steps);
                point.strain_to(start + 4.0 * STRAIN * part * direction);
            }
        }
        Ok(point.stress())
    };
    let (coarse, middle, fine) = (run(200)?, run(400)?, run(800)?);
    let ratio = (coarse - middle).norm() / (middle - fine).norm();
    assert_relative_eq!(ratio, 2.0, max_relative = 0.02);
    assert!((middle - fine).norm() < 1e-2 * YIELD);
    Ok(())
}

fn path() -> BoxedStrategy<Vec<Sym2>> {
    prop::collection::vec(vector::<6>(3.0 * STRAIN), 0..4).boxed()
}

fn after<const TERMS: usize>(law: &VonMises<TERMS>, path: &[Sym2]) -> VonMisesState<TERMS> {
    path.iter().fold(VonMisesState::default(), |state, d| {
        law.respond(&state, d).state
    })
}

/// On any path: the state is admissible, each back stress below its saturation, dissipation is not
/// negative and is what the stress does less what is stored.
#[test]
fn recall_on_any_path() -> Result<(), LawError> {
    let law = chaboche()?;
    for_all(&(path(), vector::<6>(10.0 * STRAIN)), |(path, d_eps)| {
        let old = after(&law, &path);
        let response = law.respond(&old, &d_eps);
        let new = response.state;
        prop_assert!(law.yield_function(&new) <= 1e-12 * (YIELD + response.stress.norm()));
        for ((c, g), back) in law.recalled().iter().zip(&new.back_strain) {
            prop_assert!(von_mises(&(2.0 / 3.0 * c * back)) <= c / g * (1.0 + 1e-12));
        }
        let dissipation = law.dissipation(&old, &new);
        prop_assert!(dissipation >= 0.0);
        prop_assert!(law.stored_energy(&new) >= 0.0);
        prop_assert_eq!(law.potential(&old, &d_eps), None);
        prop_assert_eq!(law.complementary(&old, &response.stress), None);
        // Backward Euler: σ₁ : Δeᵖ less the rates of storage at the end of the step.
        let d_e_p = new.plastic_strain - old.plastic_strain;
        let mut power = response.stress.dot(&d_e_p)
            - law.isotropic().stress(new.p) * (new.p - old.p)
            - 2.0 / 3.0 * law.kinematic_modulus() * new.plastic_strain.dot(&d_e_p);
        for (k, (c, _)) in law.recalled().iter().enumerate() {
            let rate = new.back_strain[k] - old.back_strain[k];
            power -= 2.0 / 3.0 * c * new.back_strain[k].dot(&rate);
        }
        prop_assert!((power - dissipation).abs() <= 1e-11 * YIELD * (STRAIN + new.p));
        Ok(())
    });
    Ok(())
}

/// Each term is extremal for the bipotential of Armstrong and Frederick under the stress that the
/// others leave it: the sum of their terms of recall is Chaboche's bipotential.
#[test]
fn increments_are_extremal() -> Result<(), LawError> {
    let law = perfect()?
        .with_hardening(Isotropic::voce(60.0, 30.0)?)
        .with_recall([(60e3, 400.0), (15e3, 80.0)])?;
    for_all(&(path(), vector::<6>(5.0 * STRAIN)), |(path, d_eps)| {
        let old = after(&law, &path);
        let new = law.respond(&old, &d_eps).state;
        let d_e_p = new.plastic_strain - old.plastic_strain;
        let d_p = new.p - old.p;
        prop_assume!(d_p > 0.0);
        let back = |k: usize| 2.0 / 3.0 * law.recalled()[k].0 * new.back_strain[k];
        for (k, &(c, g)) in law.recalled().iter().enumerate() {
            let bipotential = ArmstrongFrederick::new(YIELD, c, g).expect("valid");
            let left = law.stress(&new) - back(1 - k);
            let y = ArmstrongFrederick::force(&left, &back(k), law.isotropic().stress(new.p));
            let rate = new.back_strain[k] - old.back_strain[k];
            // The strain of a return is known to rounding of the trial: take that of the flow.
            let n = deviator(&(left - back(k))).normalize();
            let x = ArmstrongFrederick::flux(&(1.5f64.sqrt() * d_p * n), &rate, d_p);
            prop_assert!((1.5f64.sqrt() * d_p * n - d_e_p).norm() <= 1e-13);
            let (b, power) = (bipotential.b(&x, &y), x.dot(&y));
            prop_assert!(
                (b - power).abs() <= 1e-10 * YIELD * (STRAIN + d_p),
                "{b} {power}"
            );
            // Less recall, and it is not.
            let lazy = ArmstrongFrederick::flux(&(1.5f64.sqrt() * d_p * n), &(0.9 * rate), d_p);
            prop_assert!(bipotential.b(&lazy, &y) >= lazy.dot(&y) - 1e-12);
        }
        Ok(())
    });
    Ok(())
}

/// The symmetric part of ∂σ₁/∂Δε by central differences of fourth order.
#[test]
fn consistent_tangent_with_recall() -> Result<(), LawError> {
    let law = chaboche()?;
    let worst = std::cell::Cell::new(0.0f64);
    for_all(&(path(), vector::<6>(5.0 * STRAIN)), |(path, d_eps)| {
        let old = after(&law, &path);
        let response = law.respond(&old, &d_eps);
        let h = 1e-4 * STRAIN;
        prop_assume!(response.state.p - old.p > 1e-2 * STRAIN || response.state.p == old.p);
        let mut difference = Sym4::zeros();
        for k in 0..6 {
            let stress = |eps: f64| {
                let mut moved = d_eps;
                moved[k] += eps;
                law.respond(&old, &moved).stress
            };
            let column = (8.0 * (stress(h) - stress(-h)) - (stress(2.0 * h) - stress(-2.0 * h)))
                / (12.0 * h);
            difference.set_column(k, &column);
        }
        // An elastic step within reach of yield has no derivative.
        let flows = |eps: f64| law.respond(&old, &(d_eps * (1.0 + eps))).state.p > old.p;
        prop_assume!(flows(0.05) == flows(-0.05));
        let symmetric = 0.5 * (difference + difference.transpose());
        let error = (response.tangent - symmetric).norm() / YOUNG;
        prop_assert!(error <= 1e-7, "relative error {error:e}");
        prop_assert!((response.tangent - response.tangent.transpose()).norm() <= 1e-14 * YOUNG);
        worst.set(worst.get().max((difference - symmetric).norm() / YOUNG));
        Ok(())
    });
    assert!(
        worst.get() > 1e-3,
        "the tangent is symmetric: {:e}",
        worst.get()
    );
    Ok(())
}

/// The return cannot fail: steps over twelve decades, from states of every size.
#[test]
fn returns_of_every_size() -> Result<(), LawError> {
    returns(&[chaboche()?])?;
    returns(&[
        perfect()?.with_recall([(1e6, 1e5)])?,
        perfect()?.with_recall([(1.0, 1e-6)])?,
    ])?;
    returns(&[
        perfect()?.with_hardening(Isotropic::voce(1e4, 1e5)?),
        perfect()?.with_hardening(Isotropic::swift(900.0, 1e-9, 0.1)?),
        perfect()?.with_hardening(Isotropic::table(&[[0.0, 1.0], [1e-6, 900.0]])?),
        perfect()?.with_hardening(Isotropic::voce(0.0, 1.0)?),
    ])
}

fn returns<const TERMS: usize>(laws: &[VonMises<TERMS>]) -> Result<(), LawError> {
    let size = (-6.0..6.0f64).prop_map(|power| STRAIN * 10f64.powf(power));
    for law in laws {
        let samples = (
            vector::<6>(1.0),
            size.clone(),
            vector::<6>(1.0),
            size.clone(),
        );
        for_all(&samples, |(first, a, second, b)| {
            let old = law.respond(&VonMisesState::default(), &(a * first)).state;
            let response = law.respond(&old, &(b * second));
            let new = response.state;
            let f = law.yield_function(&new);
            let rounding = 1e-13 * YOUNG * (a + b) + 1e-12 * (YIELD + response.stress.norm());
            prop_assert!(f <= rounding, "f = {f:e}");
            prop_assert!(new.p >= old.p);
            prop_assert!(new.p == old.p || f >= -rounding, "f = {f:e} after flow");
            Ok(())
        });
    }
    Ok(())
}

/// A state that was returned to the yield surface is on one side of it by rounding: without a strain
/// its tangent is elastic, with one outwards it is not.
#[test]
fn on_the_surface_nothing_flows_without_a_strain() -> Result<(), LawError> {
    rests(&[perfect()?, perfect()?.with_isotropic(1e3)?])?;
    rests(&[chaboche()?])
}

fn rests<const TERMS: usize>(laws: &[VonMises<TERMS>]) -> Result<(), LawError> {
    for_all(&vector::<6>(0.1), |d_eps| {
        for law in laws {
            let state = law.respond(&VonMisesState::default(), &d_eps).state;
            prop_assume!(state.p > 0.0);
            let still = law.respond(&state, &Sym2::zeros());
            prop_assert!(!still.flows);
            prop_assert_eq!(still.tangent, law.elastic().tangent());
            prop_assert_eq!(still.state.p, state.p);
            prop_assert!(law.respond(&state, &(1e-9 * d_eps)).state.p > state.p);
        }
        Ok(())
    });
    Ok(())
}
