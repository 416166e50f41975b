//! Laws under plane stress: the contract of each, and yield surfaces and paths with known answers.

use moreau_laws::contract::{Violation, bulk};
use moreau_laws::{
    BulkLaw, DruckerPrager, Elastic, ElasticDruckerPrager, InPlaneStress, Isotropic, LawError,
    VonMises,
};
use moreau_mandel::{Sym2, von_mises};

const YOUNG: f64 = 210e3;
const POISSON: f64 = 0.3;
const YIELD: f64 = 300.0;
const STRAIN: f64 = YIELD / YOUNG;

fn perfect() -> Result<VonMises, LawError> {
    VonMises::new(YOUNG, POISSON, YIELD)
}

#[test]
fn every_law_under_plane_stress_obeys_the_contract() -> Result<(), Box<dyn std::error::Error>> {
    bulk(&InPlaneStress(Elastic::new(YOUNG, POISSON)?))?;
    bulk(&InPlaneStress(perfect()?))?;
    let swift = Isotropic::swift(700.0, 0.0145, 0.2)?;
    bulk(&InPlaneStress(perfect()?.with_hardening(swift)))?;
    let table = Isotropic::table(&[[0.0, 300.0], [0.001, 350.0], [0.01, 380.0]])?;
    bulk(&InPlaneStress(perfect()?.with_hardening(table)))?;
    bulk(&InPlaneStress(
        perfect()?.with_isotropic(2e3)?.with_kinematic(5e3)?,
    ))?;
    let recalled = perfect()?.with_recall([(6e4, 400.0), (5e3, 40.0)])?;
    bulk(&recalled)?;
    bulk(&InPlaneStress(recalled))?;
    for poisson in [-0.5, 0.0, 0.4999] {
        bulk(&InPlaneStress(VonMises::new(YOUNG, poisson, YIELD)?))?;
    }
    Ok(())
}

/// Soils, whose flow dilates: of associated flow and of one that is not.
#[test]
fn soils_under_plane_stress_obey_the_contract() -> Result<(), Box<dyn std::error::Error>> {
    for dilatancy in [30.0, 10.0, 0.0] {
        let plastic = DruckerPrager::mohr_coulomb(0.1, 30.0, dilatancy)?;
        bulk(&InPlaneStress(ElasticDruckerPrager::new(
            1e3, 0.3, plastic,
        )?))?;
    }
    Ok(())
}

/// A point that is strained in its plane in steps.
struct Point<L: BulkLaw> {
    law: InPlaneStress<L>,
    state: <InPlaneStress<L> as BulkLaw>::State,
    strain: Sym2,
}

impl<L: BulkLaw> Point<L> {
    fn new(law: L) -> Self {
        let law = InPlaneStress(law);
        Self {
            state: law.initial(),
            strain: Sym2::zeros(),
            law,
        }
    }

    fn strain_to(&mut self, strain: Sym2) -> Sym2 {
        let response = self.law.respond(&self.state, &(strain - self.strain));
        (self.state, self.strain) = (response.state, strain);
        let normal = response.stress[2].abs();
        assert!(normal <= 1e-12 * YIELD, "{normal}");
        response.stress
    }

    /// To a strain along x under no stress along y; the stress along x.
    fn pull_to(&mut self, eps: f64) -> f64 {
        let mut strain = self.strain;
        strain[0] = eps;
        for _ in 0..60 {
            let d_eps = strain - self.strain;
            let response = self.law.respond(&self.state, &d_eps);
            if response.stress[1].abs() <= 1e-12 * YIELD {
                break;
            }
            strain[1] -= response.stress[1] / response.tangent[(1, 1)];
        }
        self.strain_to(strain)[0]
    }
}

/// E ε to yield, then with the slope E H/(E + H); unloaded by E, and yield again where it left with isotropic hardening,
/// 2 σ_Y below with kinematic hardening. The thickness shrinks by ν σ/E and half of the plastic strain.
#[test]
fn a_bar_in_plane_stress_hardens_and_unloads() -> Result<(), LawError> {
    let modulus = 10e3;
    let slope = YOUNG * modulus / (YOUNG + modulus);
    for kinematic in [false, true] {
        let law = match kinematic {
            true => perfect()?.with_kinematic(modulus)?,
            false => perfect()?.with_isotropic(modulus)?,
        };
        let mut bar = Point::new(law);
        let close = |found: f64, expected: f64| {
            assert!(
                (found - expected).abs() <= 1e-9 * YIELD,
                "{found} {expected}"
            );
        };
        close(bar.pull_to(0.6 * STRAIN), 0.6 * YIELD);
        let top = YIELD + slope * 4.0 * STRAIN;
        close(bar.pull_to(5.0 * STRAIN), top);
        let plastic = 5.0 * STRAIN - top / YOUNG;
        let thickness = -POISSON * top / YOUNG - 0.5 * plastic;
        assert!((bar.state.thickness_strain - thickness).abs() <= 1e-12);
        assert!((bar.strain[1] - thickness).abs() <= 1e-12);
        close(bar.pull_to(4.0 * STRAIN), top - YIELD);
        // Elastic as far as the surface reaches, then plastic again.
        let reach = if kinematic { 2.0 * YIELD } else { 2.0 * top };
        let reversed = 5.0 * STRAIN - reach / YOUNG;
        close(bar.pull_to(reversed - STRAIN), top - reach - slope * STRAIN);
    }
    Ok(())
}

/// Equal strains: σ₁₁ = σ₂₂ = E/(1 − ν) ε as far as σ_Y, and there it stays; sheared, at σ_Y/√3.
#[test]
fn sheets_yield_on_the_ellipse_of_von_mises() -> Result<(), LawError> {
    let yields = |direction: [f64; 3]| -> Result<(Sym2, Sym2), LawError> {
        let strain = Sym2::from([direction[0], direction[1], 0.0, 0.0, 0.0, direction[2]]);
        let mut sheet = Point::new(perfect()?);
        let elastic = sheet.strain_to(0.5 * STRAIN * strain);
        Ok((elastic, sheet.strain_to(20.0 * STRAIN * strain)))
    };
    let (elastic, flowing) = yields([1.0, 1.0, 0.0])?;
    assert!((elastic[0] - 0.5 * YIELD / (1.0 - POISSON)).abs() <= 1e-9 * YIELD);
    for i in [0, 1] {
        assert!((flowing[i] - YIELD).abs() <= 1e-9 * YIELD);
    }
    let (_, flowing) = yields([0.0, 0.0, 1.0])?;
    let shear = flowing[5] / 2f64.sqrt();
    assert!((shear - YIELD / 3f64.sqrt()).abs() <= 1e-9 * YIELD);
    // A hundred directions, all on the surface: σ₁² − σ₁σ₂ + σ₂² + 3τ² = σ_Y².
    for k in 0..100 {
        let (a, b) = (0.0628 * f64::from(k), 0.37 * f64::from(k));
        let (_, s) = yields([a.cos() * b.cos(), a.sin() * b.cos(), b.sin()])?;
        let squared = s[0] * s[0] - s[0] * s[1] + s[1] * s[1] + 1.5 * s[5] * s[5];
        assert!((squared.sqrt() - YIELD).abs() <= 1e-8 * YIELD, "{k}: {s}");
        assert!((von_mises(&s) - YIELD).abs() <= 1e-8 * YIELD);
    }
    Ok(())
}

/// σ_Y ε̇_eq of a sheet, with ε̇₃₃ = −(ε̇₁₁ + ε̇₂₂): D = 2 σ_Y/√3 √(ε̇₁₁² + ε̇₁₁ ε̇₂₂ + ε̇₂₂² + ε̇₁₂²), whatever ε̇₃₃ is given.
#[test]
fn the_power_of_flow_is_that_of_a_sheet() -> Result<(), LawError> {
    let law = InPlaneStress(perfect()?);
    for k in 0..50 {
        let (a, b) = (0.13 * f64::from(k), 0.37 * f64::from(k));
        let [x, y, xy] = [a.cos() * b.cos(), a.sin() * b.cos(), b.sin()];
        let expected = 2.0 * YIELD / 3f64.sqrt() * (x * x + x * y + y * y + xy * xy).sqrt();
        for given in [0.0, 0.7, -(x + y)] {
            let rate = Sym2::from([x, y, given, 0.0, 0.0, 2f64.sqrt() * xy]);
            let power = law.flow_power(&law.initial(), &rate);
            let found = power.map_or(f64::NAN, |power| power.total);
            assert!(
                (found / expected - 1.0).abs() <= 1e-12,
                "{k}: {found} {expected}"
            );
        }
    }
    Ok(())
}

/// Recall makes the tangent unsymmetric: with the part that it does without it is the derivative of the stress.
#[test]
fn the_skew_part_of_a_condensed_tangent_is_all_that_it_leaves_out() -> Result<(), LawError> {
    let law = InPlaneStress(perfect()?.with_recall([(6e4, 400.0), (5e3, 40.0)])?);
    let strained = |strain: [f64; 3]| {
        let [x, y, xy] = strain.map(|e| e * STRAIN);
        Sym2::from([x, y, 0.0, 0.0, 0.0, xy])
    };
    let old = law.respond(&law.initial(), &strained([3.0, -1.0, 2.0]));
    let d_eps = strained([-1.0, 4.0, 3.0]);
    let stress = |d_eps: Sym2| law.respond(&old.state, &d_eps).stress;
    let response = law.respond(&old.state, &d_eps);
    let skew = law.skew(&old.state, &d_eps);
    assert!(response.flows && skew.norm() > 1e-3 * YOUNG, "{skew}");
    for k in [0, 1, 5] {
        let mut step = Sym2::zeros();
        step[k] = 1e-4 * STRAIN;
        let slope = (stress(d_eps + step) - stress(d_eps - step)) / (2e-4 * STRAIN);
        let column = (response.tangent + skew).column(k) - slope;
        assert!(column.norm() <= 1e-6 * YOUNG, "{k}: {column}");
    }
    Ok(())
}

/// Steps of a hundred thousand strains at yield, and none, and what is no number.
#[test]
fn no_strain_leaves_a_stress_through_the_thickness() -> Result<(), Violation> {
    let laws = || -> Result<_, LawError> {
        let plastic = DruckerPrager::mohr_coulomb(0.1, 45.0, 0.0)?;
        let soil = ElasticDruckerPrager::new(1e3, 0.3, plastic)?;
        Ok((InPlaneStress(perfect()?), InPlaneStress(soil)))
    };
    let (metal, soil) = laws().expect("laws");
    for size in [1e-12, 1e-3, 1.0, 100.0] {
        for k in 0..200 {
            let (a, b) = (0.0314 * f64::from(k), 0.7 * f64::from(k));
            let strain = [a.cos() * b.cos(), a.sin() * b.cos(), 0.0, 0.0, 0.0, b.sin()];
            let d_eps = size * Sym2::from(strain);
            let of_metal = metal.respond(&metal.initial(), &d_eps).stress;
            assert!(
                of_metal[2].abs() <= 1e-13 * (YIELD + YOUNG * size),
                "{size} {k} {of_metal}"
            );
            let of_soil = soil.respond(&soil.initial(), &d_eps).stress;
            assert!(
                of_soil[2].abs() <= 1e-13 * (1.0 + 1e3 * size),
                "{size} {k} {of_soil}"
            );
        }
    }
    Ok(())
}
