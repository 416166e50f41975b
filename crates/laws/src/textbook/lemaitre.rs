//! Plasticity coupled to Lemaitre's damage as a bipotential, the damage frozen in the step; not an
//! integrated bulk law.

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::{LawError, Parameter, positive};
use moreau_mandel::{Sym2, deviator, equivalent_strain, trace, von_mises};
use nalgebra::SVector;

/// Von Mises plasticity of a material of damage D that grows with plastic flow:
///
/// yield σ_eq/(1 − D) ≤ σ_y + R, ε̇ᵖ ∥ s with ε̇ᵖ_eq = ṗ, ṙ = (1 − D) ṗ, Ḋ = (Y/S)ᵐ ṗ.
///
/// Fluxes x = (ε̇ᵖ, −ṙ, Ḋ), forces y = (σ, R, Y) with the energy release rate Y, of dual product
/// σ : ε̇ᵖ − R ṙ + Y Ḋ.
///
/// Source: G. Bodovillé, *Comptes Rendus de l'Académie des Sciences* IIb 327 (1999) 715-720.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lemaitre {
    yield_stress: f64,
    strength: f64,
    exponent: f64,
    damage: f64,
}

/// A flux (ε̇ᵖ, −ṙ, Ḋ) or a force (σ, R, Y), such that the dual product is the dot product.
pub type Damaging = SVector<f64, 8>;

impl Lemaitre {
    /// From the yield stress σ_y \[MPa\], the damage strength S \[MPa\], the exponent m and the
    /// damage D ∈ [0, 1[ of the step.
    ///
    /// # Errors
    /// `NotPositive` unless σ_y, S, m > 0 are finite; `DamageOutOfRange` unless 0 ≤ D < 1.
    pub fn new(
        yield_stress: f64,
        strength: f64,
        exponent: f64,
        damage: f64,
    ) -> Result<Self, LawError> {
        if !(0.0..1.0).contains(&damage) {
            return Err(LawError::DamageOutOfRange { damage });
        }
        Ok(Self {
            yield_stress: positive(Parameter::YieldStress, yield_stress)?,
            strength: positive("damage strength", strength)?,
            exponent: positive("damage exponent", exponent)?,
            damage,
        })
    }

    /// The flux of the rates ε̇ᵖ, ṙ, Ḋ.
    pub fn flux(plastic_rate: &Sym2, hardening_rate: f64, damage_rate: f64) -> Damaging {
        Self::force(plastic_rate, -hardening_rate, damage_rate)
    }

    /// The force of the stress σ, the isotropic hardening R and the energy release rate Y \[MPa\].
    pub fn force(stress: &Sym2, hardening: f64, release_rate: f64) -> Damaging {
        let mut force = Damaging::zeros();
        force.fixed_rows_mut::<6>(0).copy_from(stress);
        force[6] = hardening;
        force[7] = release_rate;
        force
    }
}

/// b = σ_y ṙ + ṗ [S/(m+1) ⟨Y/S⟩₊^(m+1) + Sm/(m+1) (Ḋ/ṗ)^((m+1)/m)] with ṗ = ṙ/(1 − D), if
/// σ_eq ≤ (1 − D)(σ_y + R), tr ε̇ᵖ = 0, (1 − D) ε̇ᵖ_eq ≤ ṙ and Ḋ ≥ 0, else +∞.
impl Bipotential<Damaging> for Lemaitre {
    fn b(&self, x: &Damaging, y: &Damaging) -> f64 {
        let plastic: Sym2 = x.fixed_rows::<6>(0).into();
        // Not −x: at rest the sign of the zero would decide between +∞ and −∞ below.
        let (r, d) = (0.0 - x[6], x[7]);
        let stress: Sym2 = y.fixed_rows::<6>(0).into();
        let (hardening, release) = (y[6], y[7]);
        let sound = 1.0 - self.damage;

        let limit = sound * (self.yield_stress + hardening);
        let admissible = at_most(von_mises(&stress), limit, stress.norm())
            && at_most(trace(&plastic).abs(), 0.0, plastic.norm())
            && at_most(sound * equivalent_strain(&deviator(&plastic)), r, r)
            && d >= 0.0;

        let (s, m, p) = (self.strength, self.exponent, r / sound);
        let force_part = p * s / (m + 1.0) * (release / s).max(0.0).powf(m + 1.0);
        // At rest this term is the indicator of Ḋ = 0.
        let flux_part = if d == 0.0 {
            0.0
        } else {
            s * m / (m + 1.0) * d * (d / p).powf(1.0 / m)
        };
        restricted(admissible, self.yield_stress * r + force_part + flux_part)
    }
}
