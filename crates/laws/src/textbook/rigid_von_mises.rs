//! The rigid, perfectly plastic law of von Mises, \[6\]-\[9\]; with elasticity and hardening it is in
//! `von_mises`.

use crate::duality::{Superpotential, at_most, indicator, restricted};
use crate::error::{LawError, Parameter, positive};
use moreau_mandel::{Sym2, deviator, equivalent_strain, trace, von_mises};

/// The rigid, perfectly plastic law of von Mises as a Fenchel pair, \[6\]-\[9\].
///
/// V_p(ε̇ᵖ) = √(2/3) σ_y ‖ėᵖ‖, convex and homogeneous of degree 1, +∞ when ε̇ᵖ has a trace; its
/// conjugate is the indicator of σ_eq ≤ σ_y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VonMisesDissipation {
    yield_stress: f64,
}

impl VonMisesDissipation {
    /// From the yield stress σ_y \[MPa\].
    ///
    /// # Errors
    /// `NotPositive` unless σ_y > 0 is finite.
    pub fn new(yield_stress: f64) -> Result<Self, LawError> {
        Ok(Self {
            yield_stress: positive(Parameter::YieldStress, yield_stress)?,
        })
    }
}

impl Superpotential<Sym2> for VonMisesDissipation {
    /// σ_y ṗ, \[60\], on rates without trace.
    fn v(&self, x: &Sym2) -> f64 {
        let v = self.yield_stress * equivalent_strain(&deviator(x));
        restricted(at_most(trace(x).abs(), 0.0, x.norm()), v)
    }

    /// The indicator of σ_eq ≤ σ_y.
    fn w(&self, y: &Sym2) -> f64 {
        indicator(at_most(von_mises(y), self.yield_stress, y.norm()))
    }
}
