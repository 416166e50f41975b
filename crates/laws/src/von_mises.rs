//! Von Mises plasticity with linear hardening, \[5\]-\[9\] and \[57\]-\[65\]; not a law of finite
//! strain, though logarithmic strains may be fed to it.

use crate::bulk::{BulkLaw, IncrementalPotential, Numbers, Response};
use crate::duality::{Superpotential, at_most, indicator, restricted};
use crate::elastic::Elastic;
use crate::error::{LawError, non_negative, positive};
use moreau_mandel::{
    Sym2, Sym4, deviator, deviatoric_projector, equivalent_strain, identity, trace, von_mises,
};

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
            yield_stress: positive("yield stress", yield_stress)?,
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

/// What a von Mises material remembers; the stress is recovered from the elastic strain.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VonMisesState {
    /// Elastic strain εᵉ.
    pub elastic_strain: Sym2,
    /// Plastic strain eᵖ, a deviator; the back stress is ⅔ H_k eᵖ.
    pub plastic_strain: Sym2,
    /// Equivalent plastic strain p ≥ 0, \[60\].
    pub p: f64,
}

impl Numbers for VonMisesState {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.elastic_strain.visit(each);
        self.plastic_strain.visit(each);
        each(&mut self.p);
    }
}

/// Isotropic elasticity with the yield criterion of von Mises, associated flow, and linear
/// hardening, isotropic (modulus H) and kinematic (Prager, modulus H_k):
///
/// f = √(3/2) ‖s − X‖ − (σ_y + H p) ≤ 0, X = ⅔ H_k eᵖ, Δeᵖ = √(3/2) Δp n, n = (s − X)/‖s − X‖.
///
/// Backward Euler makes the step a convex minimisation over Δeᵖ, \[62\], solved in closed form by
/// the radial return Δp = ⟨f_trial⟩₊ / (3G + H + H_k).
///
/// Source of the consistent tangent: J. C. Simo and R. L. Taylor, *Computer Methods in Applied
/// Mechanics and Engineering* 48 (1985) 101-118.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VonMises {
    elastic: Elastic,
    yield_stress: f64,
    isotropic: f64,
    kinematic: f64,
}

/// A step that yields.
struct Return {
    /// Δp > 0.
    d_p: f64,
    /// Flow direction n, a deviator of unit norm.
    n: Sym2,
    /// Equivalent stress √(3/2) ‖s − X‖ of the elastic trial \[MPa\].
    trial: f64,
}

impl VonMises {
    /// Perfect plasticity, from E \[MPa\], ν and the yield stress σ_y \[MPa\].
    ///
    /// # Errors
    /// Those of [`Elastic::new`]; `NotPositive` unless σ_y > 0 is finite.
    pub fn new(young: f64, poisson: f64, yield_stress: f64) -> Result<Self, LawError> {
        Ok(Self {
            elastic: Elastic::new(young, poisson)?,
            yield_stress: positive("yield stress", yield_stress)?,
            isotropic: 0.0,
            kinematic: 0.0,
        })
    }

    /// The same law with the isotropic hardening modulus H = dσ_y/dp \[MPa\].
    ///
    /// # Errors
    /// `Negative` unless H ≥ 0 is finite: softening has no convex potential.
    pub fn with_isotropic(self, modulus: f64) -> Result<Self, LawError> {
        Ok(Self {
            isotropic: non_negative("isotropic hardening modulus", modulus)?,
            ..self
        })
    }

    /// The same law with Prager's kinematic hardening modulus H_k \[MPa\], X = ⅔ H_k eᵖ.
    ///
    /// # Errors
    /// `Negative` unless H_k ≥ 0 is finite.
    pub fn with_kinematic(self, modulus: f64) -> Result<Self, LawError> {
        Ok(Self {
            kinematic: non_negative("kinematic hardening modulus", modulus)?,
            ..self
        })
    }

    /// The elastic part of the law.
    pub fn elastic(&self) -> &Elastic {
        &self.elastic
    }

    /// Initial yield stress σ_y \[MPa\].
    pub fn yield_stress(&self) -> f64 {
        self.yield_stress
    }

    /// Isotropic hardening modulus H \[MPa\].
    pub fn isotropic_modulus(&self) -> f64 {
        self.isotropic
    }

    /// Kinematic hardening modulus H_k \[MPa\].
    pub fn kinematic_modulus(&self) -> f64 {
        self.kinematic
    }

    /// Back stress X = ⅔ H_k eᵖ of a state \[MPa\], a deviator.
    #[inline]
    pub fn back_stress(&self, state: &VonMisesState) -> Sym2 {
        2.0 / 3.0 * self.kinematic * state.plastic_strain
    }

    /// Yield function f of a state \[MPa\]; f ≤ 0 in every admissible state.
    #[inline]
    pub fn yield_function(&self, state: &VonMisesState) -> f64 {
        self.overstress(state, &self.stress(state))
    }

    /// ΔW(Δσ) \[N·mm/mm³\], the conjugate of ΔV, \[49\], \[64\]; convex, and
    /// ΔV(Δε) + ΔW(Δσ) ≥ Δε·Δσ with equality exactly at the response of the law.
    ///
    /// The conjugate of an inf-convolution is a sum: ½ Δσ·S⁻¹·Δσ + ⟨f(σ₀ + Δσ)⟩₊² / 2(H + H_k),
    /// f with the hardening of the start of the step; without hardening the indicator of f ≤ 0.
    pub fn complementary(&self, old: &VonMisesState, d_sigma: &Sym2) -> f64 {
        let stress = self.stress(old) + d_sigma;
        let f = self.overstress(old, &stress);
        let hardening = self.isotropic + self.kinematic;
        let plastic = if hardening > 0.0 {
            f.max(0.0).powi(2) / (2.0 * hardening)
        } else {
            indicator(at_most(f, 0.0, stress.norm()))
        };
        self.elastic.complementary_energy(d_sigma) + plastic
    }

    /// f(σ) with the hardening of `state`.
    #[inline]
    fn overstress(&self, state: &VonMisesState, stress: &Sym2) -> f64 {
        von_mises(&(stress - self.back_stress(state)))
            - self.yield_stress
            - self.isotropic * state.p
    }

    /// Radial return onto the yield surface; `None` when the step is elastic.
    #[inline]
    fn radial_return(&self, old: &VonMisesState, d_eps: &Sym2) -> Option<Return> {
        let g = self.elastic.shear_modulus();
        let xi = 2.0 * g * deviator(&(old.elastic_strain + d_eps)) - self.back_stress(old);
        let norm = xi.norm();
        let trial = 1.5f64.sqrt() * norm;
        let f = trial - self.yield_stress - self.isotropic * old.p;
        if f <= 0.0 {
            return None;
        }
        Some(Return {
            d_p: f / (3.0 * g + self.isotropic + self.kinematic),
            n: xi / norm,
            trial,
        })
    }
}

impl BulkLaw for VonMises {
    type State = VonMisesState;

    #[inline]
    fn respond(&self, old: &VonMisesState, d_eps: &Sym2) -> Response<VonMisesState> {
        let mut state = *old;
        state.elastic_strain += d_eps;
        let Some(Return { d_p, n, trial }) = self.radial_return(old, d_eps) else {
            return Response {
                stress: self.stress(&state),
                tangent: self.elastic.tangent(),
                state,
            };
        };
        let d_e_p = 1.5f64.sqrt() * d_p * n;
        state.elastic_strain -= d_e_p;
        state.plastic_strain += d_e_p;
        state.p += d_p;

        // ∂Δeᵖ/∂Δε = β (1 − ⅓ δ⊗δ) + (γ − β) n⊗n: the part along n shrinks with the hardening,
        // the part across it with the distance of the trial from the surface.
        let (k, g) = (self.elastic.bulk_modulus(), self.elastic.shear_modulus());
        let beta = 3.0 * g * d_p / trial;
        let gamma = 3.0 * g / (3.0 * g + self.isotropic + self.kinematic);
        let delta = identity();
        Response {
            stress: self.stress(&state),
            tangent: k * delta * delta.transpose()
                + 2.0
                    * g
                    * ((1.0 - beta) * deviatoric_projector() + (beta - gamma) * n * n.transpose()),
            state,
        }
    }

    #[inline]
    fn stress(&self, state: &VonMisesState) -> Sym2 {
        self.elastic.stress(&state.elastic_strain)
    }

    fn elastic_tangent(&self) -> Sym4 {
        self.elastic.tangent()
    }

    /// ½ εᵉ·S·εᵉ + ½ H p² + ⅓ H_k ‖eᵖ‖².
    fn stored_energy(&self, state: &VonMisesState) -> f64 {
        self.elastic.energy(&state.elastic_strain)
            + 0.5 * self.isotropic * state.p.powi(2)
            + self.kinematic / 3.0 * state.plastic_strain.norm_squared()
    }

    /// σ_y Δp, \[61\]: the rest of the plastic work is stored by the hardening.
    fn dissipation(&self, old: &VonMisesState, new: &VonMisesState) -> f64 {
        self.yield_stress * (new.p - old.p)
    }

    fn equivalent_plastic_strain(&self, state: &VonMisesState) -> f64 {
        state.p
    }
}

impl IncrementalPotential for VonMises {
    /// ΔV = ½ K_c (Δe_m)² + G (‖Δe‖² − ‖Δeᵖ‖²) − ½ (H + H_k) Δp², \[63\] with hardening: the
    /// value of the infimum \[62\], whose bracket then also holds the energy stored by hardening.
    #[inline]
    fn potential(&self, old: &VonMisesState, d_eps: &Sym2) -> f64 {
        let d_p = self.radial_return(old, d_eps).map_or(0.0, |r| r.d_p);
        // ‖Δeᵖ‖² = 3/2 Δp², [60].
        let plastic = 3.0 * self.elastic.shear_modulus() + self.isotropic + self.kinematic;
        self.elastic.energy(d_eps) - 0.5 * plastic * d_p.powi(2)
    }
}
