//! Armstrong–Frederick non-linear kinematic hardening as a bipotential; not an integrated bulk law.

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::{LawError, Parameter, positive};
use moreau_mandel::{Sym2, deviator, equivalent_strain, trace, von_mises};
use nalgebra::SVector;

/// Von Mises plasticity whose back stress X = ⅔ C α recalls its past with the rate γ:
///
/// yield (σ − X)_eq ≤ σ_y + R, flow ε̇ᵖ = 3/2 ṗ (s − X)/(s − X)_eq, α̇ = ε̇ᵖ − (3γ/2C) X ṗ, ṙ = ṗ.
///
/// The recall makes α̇ no normal to the yield surface. Fluxes x = (ε̇ᵖ, −α̇, −ṗ), forces
/// y = (σ, X, R), of dual product σ : ε̇ᵖ − X : α̇ − R ṗ. In monotonic tension
/// X_eq = (C/γ)(1 − exp(−γ εᵖ)).
///
/// Source: G. Bodovillé and G. de Saxcé, *European Journal of Mechanics A/Solids* 20 (2001) 99-112.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ArmstrongFrederick {
    yield_stress: f64,
    modulus: f64,
    recall: f64,
}

/// A flux (ε̇ᵖ, −α̇, −ṗ) or a force (σ, X, R), such that the dual product is the dot product.
pub type Generalised = SVector<f64, 13>;

impl ArmstrongFrederick {
    /// From the yield stress σ_y \[MPa\], the kinematic modulus C \[MPa\] and the recall γ.
    ///
    /// # Errors
    /// `NotPositive` unless all are positive and finite.
    pub fn new(yield_stress: f64, modulus: f64, recall: f64) -> Result<Self, LawError> {
        Ok(Self {
            yield_stress: positive(Parameter::YieldStress, yield_stress)?,
            modulus: positive(Parameter::KinematicModulus, modulus)?,
            recall: positive(Parameter::Recall, recall)?,
        })
    }

    /// The flux of the rates ε̇ᵖ, α̇, ṗ.
    pub fn flux(plastic_rate: &Sym2, back_strain_rate: &Sym2, p_rate: f64) -> Generalised {
        Self::force(plastic_rate, &-back_strain_rate, -p_rate)
    }

    /// The force of the stress σ, the back stress X and the isotropic hardening R \[MPa\].
    pub fn force(stress: &Sym2, back_stress: &Sym2, hardening: f64) -> Generalised {
        let mut force = Generalised::zeros();
        force.fixed_rows_mut::<6>(0).copy_from(stress);
        force.fixed_rows_mut::<6>(6).copy_from(back_stress);
        force[12] = hardening;
        force
    }
}

/// b = σ_y ṗ + (γ/2C) X_eq² ṗ + (C/2γṗ) (ε̇ᵖ − α̇)_eq² if (σ − X)_eq ≤ σ_y + R, tr ε̇ᵖ = 0 and
/// ε̇ᵖ_eq ≤ ṗ, else +∞; a_eq = √(3/2 a : a) for forces, √(2/3 a : a) for fluxes.
impl Bipotential<Generalised> for ArmstrongFrederick {
    fn b(&self, x: &Generalised, y: &Generalised) -> f64 {
        let plastic: Sym2 = x.fixed_rows::<6>(0).into();
        let back: Sym2 = -x.fixed_rows::<6>(6);
        // Not −x: at rest the sign of the zero would decide between +∞ and −∞ below.
        let p = 0.0 - x[12];
        let stress: Sym2 = y.fixed_rows::<6>(0).into();
        let back_stress: Sym2 = y.fixed_rows::<6>(6).into();
        let limit = self.yield_stress + y[12];

        let overstress = stress - back_stress;
        let admissible = at_most(von_mises(&overstress), limit, overstress.norm())
            && at_most(trace(&plastic).abs(), 0.0, plastic.norm())
            && at_most(equivalent_strain(&deviator(&plastic)), p, p);

        let ratio = self.recall / self.modulus;
        let recalled = equivalent_strain(&(plastic - back));
        // At rest the last term is the indicator of α̇ = ε̇ᵖ.
        let recall = if recalled == 0.0 {
            0.0
        } else {
            recalled.powi(2) / (2.0 * ratio * p)
        };
        let x_eq_squared = 1.5 * back_stress.norm_squared();
        let driven = (self.yield_stress + 0.5 * ratio * x_eq_squared) * p;
        restricted(admissible, driven + recall)
    }
}
