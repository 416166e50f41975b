//! The elastic, perfectly plastic bar of figure 1, \[1\]-\[4\] and \[50\]-\[56\]; not a law of the
//! bulk: it is the scalar on which the inf-convolution is learnt.

use crate::duality::{Superpotential, at_most, indicator};
use crate::error::{LawError, Parameter, positive};

/// A bar of Young's modulus E and yield stress σ_y, without hardening.
///
/// As a superpotential it is the rigid plastic law: V_p(ε̇ᵖ) = σ_y |ε̇ᵖ|, convex and homogeneous of
/// degree 1, \[4\], and its conjugate, the indicator of I_y = [−σ_y, σ_y], \[3\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uniaxial {
    young: f64,
    yield_stress: f64,
}

/// Outcome of a step of the bar.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniaxialResponse {
    /// Stress at the end of the step \[MPa\].
    pub stress: f64,
    /// ∂σ₁/∂Δε \[MPa\]: E, or 0 when the bar yields.
    pub tangent: f64,
    /// Increment of plastic strain Δεᵖ, the minimiser of \[52\].
    pub d_eps_p: f64,
}

impl Uniaxial {
    /// From Young's modulus E and the yield stress σ_y \[MPa\].
    ///
    /// # Errors
    /// `NotPositive` unless both are positive and finite.
    pub fn new(young: f64, yield_stress: f64) -> Result<Self, LawError> {
        Ok(Self {
            young: positive(Parameter::YoungsModulus, young)?,
            yield_stress: positive(Parameter::YieldStress, yield_stress)?,
        })
    }

    /// Backward-Euler response to Δε from the stress σ₀ ∈ I_y \[MPa\], \[53\].
    pub fn respond(&self, stress_0: f64, d_eps: f64) -> UniaxialResponse {
        let trial = stress_0 + self.young * d_eps;
        if trial.abs() <= self.yield_stress {
            UniaxialResponse {
                stress: trial,
                tangent: self.young,
                d_eps_p: 0.0,
            }
        } else {
            let stress = self.yield_stress * trial.signum();
            UniaxialResponse {
                stress,
                tangent: 0.0,
                d_eps_p: (trial - stress) / self.young,
            }
        }
    }

    /// The bracket of \[52\], ½E (Δε − Δεᵖ)² + σ_y |Δεᵖ| − σ₀ Δεᵖ \[N·mm/mm³\]; strictly convex in
    /// Δεᵖ. Its infimum over Δεᵖ, an inf-convolution, is [`Self::potential`].
    pub fn convolved(&self, stress_0: f64, d_eps: f64, d_eps_p: f64) -> f64 {
        0.5 * self.young * (d_eps - d_eps_p).powi(2) + self.v(&d_eps_p) - stress_0 * d_eps_p
    }

    /// ΔV(Δε) = ½E (Δε² − (Δεᵖ)²) \[N·mm/mm³\], \[56\]; convex, with the derivative Δσ, \[65\].
    pub fn potential(&self, stress_0: f64, d_eps: f64) -> f64 {
        let d_eps_p = self.respond(stress_0, d_eps).d_eps_p;
        0.5 * self.young * (d_eps.powi(2) - d_eps_p.powi(2))
    }
}

impl Superpotential<f64> for Uniaxial {
    /// V_p = σ_y |ε̇ᵖ|, \[4\].
    fn v(&self, x: &f64) -> f64 {
        self.yield_stress * x.abs()
    }

    /// The indicator of [−σ_y, σ_y], \[3\].
    fn w(&self, y: &f64) -> f64 {
        indicator(at_most(y.abs(), self.yield_stress, self.yield_stress))
    }
}
