//! Von Mises plasticity with isotropic and kinematic hardening, \[5\]-\[9\] and \[57\]-\[65\]; not
//! a law of finite strain, though logarithmic strains may be fed to it.

use crate::bulk::{BulkLaw, FlowPower, Numbers, ON_SURFACE, Response};
use crate::duality::{at_most, indicator};
use crate::elastic::Elastic;
use crate::error::{LawError, Parameter, non_negative, positive};
use crate::isotropic::Isotropic;
use moreau_mandel::{
    Sym2, Sym4, add_symmetric_product, deviator, equivalent_strain, isotropic, trace, von_mises,
};

/// What a von Mises material remembers, with so many terms of kinematic hardening with recall; the
/// stress is recovered from the elastic strain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VonMisesState<const TERMS: usize = 0> {
    /// Elastic strain εᵉ.
    pub elastic_strain: Sym2,
    /// Plastic strain eᵖ, a deviator; the back stress without recall is ⅔ H_k eᵖ.
    pub plastic_strain: Sym2,
    /// Equivalent plastic strain p ≥ 0, \[60\].
    pub p: f64,
    /// Back strains αᵢ, deviators, of the terms with recall: their back stresses are ⅔ Cᵢ αᵢ.
    pub back_strain: [Sym2; TERMS],
}

impl<const TERMS: usize> Default for VonMisesState<TERMS> {
    fn default() -> Self {
        Self {
            elastic_strain: Sym2::zeros(),
            plastic_strain: Sym2::zeros(),
            p: 0.0,
            back_strain: [Sym2::zeros(); TERMS],
        }
    }
}

impl<const TERMS: usize> Numbers for VonMisesState<TERMS> {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.elastic_strain.visit(each);
        self.plastic_strain.visit(each);
        each(&mut self.p);
        self.back_strain.iter_mut().for_each(|a| a.visit(each));
    }
}

/// Isotropic elasticity with the yield criterion of von Mises, flow along s − X, isotropic hardening
/// R(p), and kinematic hardening by terms of modulus Cᵢ and recall γᵢ that add up:
///
/// f = √(3/2) ‖s − X‖ − (σ_y + R(p)) ≤ 0, X = Σ ⅔ Cᵢ αᵢ, Δeᵖ = √(3/2) Δp n, n = (s − X)/‖s − X‖,
/// Δαᵢ = Δeᵖ − γᵢ αᵢ Δp.
///
/// A term without recall is Prager's, α = eᵖ; one with recall that of Armstrong and Frederick, which
/// saturates at X_eq = C/γ; a sum of them is Chaboche's law. Backward Euler leaves one equation,
///
/// √(3/2) ‖s_trial − Σ ⅔ Cᵢ θᵢ αᵢ‖ − (3G + Σ Cᵢ θᵢ) Δp = σ_y + R(p + Δp), θᵢ = 1/(1 + γᵢ Δp),
///
/// whose left side less its right falls at a rate of at least 3G, because X_eq ≤ C/γ in every term
/// and always: it has one root in \]0, f_trial/3G\], which a bracketed Newton iteration cannot miss.
/// Without recall the flow is associated, the step is a convex minimisation over Δeᵖ, \[62\], and has
/// a potential; with linear hardening it is the radial return Δp = ⟨f_trial⟩₊ / (3G + H + H_k).
///
/// Sources: J. C. Simo and R. L. Taylor, *Computer Methods in Applied Mechanics and Engineering* 48
/// (1985) 101-118, the consistent tangent; J. L. Chaboche, *International Journal of Plasticity* 5
/// (1989) 247-302, the sum of terms.
#[derive(Debug, Clone, PartialEq)]
pub struct VonMises<const TERMS: usize = 0> {
    elastic: Elastic,
    yield_stress: f64,
    isotropic: Isotropic,
    /// H_k, the sum of the moduli without recall.
    kinematic: f64,
    /// (C, γ) of the terms with recall.
    recalled: [(f64, f64); TERMS],
}

/// A step that yields.
struct Return {
    /// Δp > 0.
    d_p: f64,
    /// Flow direction n, a deviator of unit norm.
    n: Sym2,
    /// Equivalent stress √(3/2) ‖ξ‖, ξ = s_trial − Σ ⅔ Cᵢ θᵢ αᵢ, of the elastic trial \[MPa\].
    trial: f64,
    /// −∂/∂Δp of the equation of the return \[MPa\].
    slope: f64,
    /// ∂ξ/∂Δp \[MPa\].
    recall: Sym2,
}

impl VonMises {
    /// Perfect plasticity, from E \[MPa\], ν and the yield stress σ_y \[MPa\].
    ///
    /// # Errors
    /// Those of [`Elastic::new`]; `NotPositive` unless σ_y > 0 is finite.
    pub fn new(young: f64, poisson: f64, yield_stress: f64) -> Result<Self, LawError> {
        Ok(Self {
            elastic: Elastic::new(young, poisson)?,
            yield_stress: positive(Parameter::YieldStress, yield_stress)?,
            isotropic: Isotropic::linear(0.0)?,
            kinematic: 0.0,
            recalled: [],
        })
    }

    /// The same law with these terms of kinematic hardening, each of modulus C \[MPa\] and recall γ;
    /// of one without recall, [`Self::with_kinematic`] remembers less.
    ///
    /// # Errors
    /// `Negative` unless every C ≥ 0 and γ ≥ 0 is finite.
    pub fn with_recall<const TERMS: usize>(
        self,
        terms: [(f64, f64); TERMS],
    ) -> Result<VonMises<TERMS>, LawError> {
        for (modulus, recall) in terms {
            non_negative(Parameter::KinematicModulus, modulus)?;
            non_negative(Parameter::Recall, recall)?;
        }
        Ok(VonMises {
            elastic: self.elastic,
            yield_stress: self.yield_stress,
            isotropic: self.isotropic,
            kinematic: self.kinematic,
            recalled: terms,
        })
    }
}

impl<const TERMS: usize> VonMises<TERMS> {
    /// The same law with linear isotropic hardening of modulus H = dσ_y/dp \[MPa\].
    ///
    /// # Errors
    /// Those of [`Isotropic::linear`].
    pub fn with_isotropic(self, modulus: f64) -> Result<Self, LawError> {
        Ok(self.with_hardening(Isotropic::linear(modulus)?))
    }

    /// The same law with this isotropic hardening.
    pub fn with_hardening(self, isotropic: Isotropic) -> Self {
        Self { isotropic, ..self }
    }

    /// The same law with another term of Prager's kinematic hardening, of modulus H_k \[MPa\].
    ///
    /// # Errors
    /// `Negative` unless H_k ≥ 0 is finite.
    pub fn with_kinematic(mut self, modulus: f64) -> Result<Self, LawError> {
        self.kinematic += non_negative(Parameter::KinematicModulus, modulus)?;
        Ok(self)
    }

    /// The elastic part of the law.
    pub fn elastic(&self) -> &Elastic {
        &self.elastic
    }

    /// Initial yield stress σ_y \[MPa\].
    pub fn yield_stress(&self) -> f64 {
        self.yield_stress
    }

    /// The isotropic hardening.
    pub fn isotropic(&self) -> &Isotropic {
        &self.isotropic
    }

    /// Kinematic hardening modulus H_k \[MPa\], the sum over the terms without recall.
    pub fn kinematic_modulus(&self) -> f64 {
        self.kinematic
    }

    /// Modulus C \[MPa\] and recall γ of the terms that have one.
    pub fn recalled(&self) -> &[(f64, f64); TERMS] {
        &self.recalled
    }

    /// Back stress X of a state \[MPa\], a deviator.
    #[inline]
    pub fn back_stress(&self, state: &VonMisesState<TERMS>) -> Sym2 {
        let mut x = 2.0 / 3.0 * self.kinematic * state.plastic_strain;
        for ((modulus, _), back) in self.recalled().iter().zip(&state.back_strain) {
            x += 2.0 / 3.0 * modulus * back;
        }
        x
    }

    /// Yield function f of a state \[MPa\]; f ≤ 0 in every admissible state.
    #[inline]
    pub fn yield_function(&self, state: &VonMisesState<TERMS>) -> f64 {
        self.overstress(state, &self.stress(state))
    }

    /// ΔW(Δσ) \[N·mm/mm³\], the conjugate of ΔV, \[49\], \[64\]; convex, and
    /// ΔV(Δε) + ΔW(Δσ) ≥ Δε·Δσ with equality exactly at the response of the law. `None` with recall.
    ///
    /// The conjugate of an inf-convolution is a sum: ½ Δσ·S⁻¹·Δσ and
    /// sup over Δp ≥ 0 of f Δp − ½ H_k Δp² − (ψ(p + Δp) − ψ(p) − R(p) Δp) at f = f(σ₀ + Δσ), with the
    /// hardening of the start of the step. Of linear hardening that is ⟨f⟩₊² / 2(H + H_k), without
    /// hardening the indicator of f ≤ 0.
    pub fn complementary(&self, old: &VonMisesState<TERMS>, d_sigma: &Sym2) -> Option<f64> {
        if TERMS > 0 {
            return None;
        }
        let stress = self.stress(old) + d_sigma;
        let f = self.overstress(old, &stress);
        let plastic = match self.isotropic.constant_modulus() {
            _ if f <= 0.0 => 0.0,
            Some(isotropic) if isotropic + self.kinematic > 0.0 => {
                f.max(0.0).powi(2) / (2.0 * (isotropic + self.kinematic))
            }
            Some(_) => indicator(at_most(f, 0.0, stress.norm())),
            None => self.conjugate(old.p, f, stress.norm()),
        };
        Some(self.elastic.complementary_energy(d_sigma) + plastic)
    }

    /// The supremum of [`Self::complementary`] for f > 0 by bisection: where the slope of the
    /// bracket vanishes, or as far as hardening that saturates goes, or +∞ beyond.
    fn conjugate(&self, p: f64, f: f64, scale: f64) -> f64 {
        let slope = |d_p: f64| {
            let risen = self.isotropic.stress(p + d_p) - self.isotropic.stress(p);
            f - self.kinematic * d_p - risen
        };
        let (mut low, mut high) = (0.0, 1.0);
        // Yield stresses a hundred orders of strain away count as saturated.
        while slope(high) > 0.0 && high < 1e100 {
            high *= 2.0;
        }
        if !at_most(slope(high), 0.0, scale) {
            return f64::INFINITY;
        }
        for _ in 0..1100 {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if at_most(slope(middle), 0.0, scale) {
                high = middle;
            } else {
                low = middle;
            }
        }
        let stored = self.isotropic.energy(p + high) - self.isotropic.energy(p);
        (f + self.isotropic.stress(p)) * high - 0.5 * self.kinematic * high.powi(2) - stored
    }

    /// f(σ) with the hardening of `state`.
    #[inline]
    fn overstress(&self, state: &VonMisesState<TERMS>, stress: &Sym2) -> f64 {
        von_mises(&(stress - self.back_stress(state)))
            - self.yield_stress
            - self.isotropic.stress(state.p)
    }

    /// Return onto the yield surface; `None` when the step is elastic.
    #[inline]
    fn radial_return(&self, old: &VonMisesState<TERMS>, d_eps: &Sym2) -> Option<Return> {
        let g = self.elastic.shear_modulus();
        let xi = 2.0 * g * deviator(&(old.elastic_strain + d_eps)) - self.back_stress(old);
        let norm = xi.norm();
        let trial = 1.5f64.sqrt() * norm;
        let f = trial - self.yield_stress - self.isotropic.stress(old.p);
        if f <= ON_SURFACE * trial {
            return None;
        }
        if let (Some(isotropic), 0) = (self.isotropic.constant_modulus(), TERMS) {
            let slope = 3.0 * g + isotropic + self.kinematic;
            return Some(Return {
                d_p: f / slope,
                n: xi / norm,
                trial,
                slope,
                recall: Sym2::zeros(),
            });
        }
        let mut step = self.at(old, &xi, 0.0).1;
        // Half as much again: the root of a law that does not harden is the end itself.
        let (mut low, mut high) = (0.0, 1.5 * f / (3.0 * g));
        let mut left = f;
        let mut d_p = f / step.slope;
        for _ in 0..200 {
            if !(d_p > low && d_p < high) {
                d_p = 0.5 * (low + high);
            }
            let (excess, next) = self.at(old, &xi, d_p);
            step = next;
            if excess.abs() <= 2.0 * f64::EPSILON * trial || !(low < d_p && d_p < high) {
                break;
            }
            if excess > 0.0 {
                low = d_p;
            } else {
                high = d_p;
            }
            // A step of Newton's, but for a kink that it cannot pass.
            d_p = if excess.abs() <= 0.5 * left {
                d_p + excess / step.slope
            } else {
                0.5 * (low + high)
            };
            left = excess.abs();
        }
        Some(step)
    }

    /// a of the part 2 a⊗n of ∂σ₁/∂Δε by which recall turns n \[MPa\].
    #[inline]
    fn turned(&self, step: &Return) -> Sym2 {
        let g = self.elastic.shear_modulus();
        let beta = 3.0 * g * step.d_p / step.trial;
        let across = step.recall - step.n * step.n.dot(&step.recall);
        -(1.5f64.sqrt() * g * beta / step.slope) * across
    }

    /// What the return lacks at Δp \[MPa\], and the step if that is nothing; ξ without recall.
    #[inline]
    fn at(&self, old: &VonMisesState<TERMS>, xi: &Sym2, d_p: f64) -> (f64, Return) {
        let g = self.elastic.shear_modulus();
        let mut xi = *xi;
        let mut recall = Sym2::zeros();
        let p = old.p + d_p;
        let mut slope = 3.0 * g + self.isotropic.modulus(p) + self.kinematic;
        let mut resisted = (3.0 * g + self.kinematic) * d_p;
        for ((modulus, gamma), back) in self.recalled().iter().zip(&old.back_strain) {
            let theta = 1.0 / (1.0 + gamma * d_p);
            xi += 2.0 / 3.0 * modulus * (gamma * d_p * theta) * back;
            recall += 2.0 / 3.0 * modulus * gamma * theta * theta * back;
            slope += modulus * theta * theta;
            resisted += modulus * theta * d_p;
        }
        let norm = xi.norm();
        let (n, trial) = (xi / norm, 1.5f64.sqrt() * norm);
        slope -= 1.5f64.sqrt() * n.dot(&recall);
        let excess = trial - resisted - self.yield_stress - self.isotropic.stress(p);
        let step = Return {
            d_p,
            n,
            trial,
            slope,
            recall,
        };
        (excess, step)
    }
}

impl<const TERMS: usize> BulkLaw for VonMises<TERMS> {
    type State = VonMisesState<TERMS>;

    fn initial(&self) -> VonMisesState<TERMS> {
        VonMisesState::default()
    }

    #[inline]
    fn respond(&self, old: &VonMisesState<TERMS>, d_eps: &Sym2) -> Response<VonMisesState<TERMS>> {
        let mut state = *old;
        state.elastic_strain += d_eps;
        let Some(step) = self.radial_return(old, d_eps) else {
            return Response {
                stress: self.stress(&state),
                tangent: self.elastic.tangent(),
                flows: false,
                state,
            };
        };
        let Return { d_p, n, trial, .. } = step;
        let d_e_p = 1.5f64.sqrt() * d_p * n;
        state.elastic_strain -= d_e_p;
        state.plastic_strain += d_e_p;
        state.p += d_p;
        for ((_, gamma), back) in self.recalled().iter().zip(&mut state.back_strain) {
            *back = (*back + d_e_p) / (1.0 + gamma * d_p);
        }

        // ∂Δeᵖ/∂Δε = β (1 − ⅓ δ⊗δ) + (γ − β) n⊗n: the part along n shrinks with the hardening,
        // the part across it with the distance of the trial from the surface.
        let (k, g) = (self.elastic.bulk_modulus(), self.elastic.shear_modulus());
        let beta = 3.0 * g * d_p / trial;
        let gamma = 3.0 * g / step.slope;
        let mut tangent = isotropic(k, 2.0 * g * (1.0 - beta));
        add_symmetric_product(&mut tangent, g * (beta - gamma), &n, &n);
        if TERMS > 0 {
            // Recall turns n: a part 2 a⊗n that is not symmetric, of which the symmetric is kept.
            add_symmetric_product(&mut tangent, 1.0, &self.turned(&step), &n);
        }
        Response {
            stress: self.stress(&state),
            tangent,
            flows: true,
            state,
        }
    }

    /// That by which recall turns the flow.
    fn skew(&self, old: &VonMisesState<TERMS>, d_eps: &Sym2) -> Sym4 {
        match self.radial_return(old, d_eps) {
            Some(step) if TERMS > 0 => {
                let turned = self.turned(&step) * step.n.transpose();
                turned - turned.transpose()
            }
            _ => Sym4::zeros(),
        }
    }

    #[inline]
    fn stress(&self, state: &VonMisesState<TERMS>) -> Sym2 {
        self.elastic.stress(&state.elastic_strain)
    }

    fn is_isotropic(&self) -> bool {
        TERMS == 0 && self.kinematic == 0.0
    }

    #[inline]
    fn elastic_strain(&self, state: &VonMisesState<TERMS>) -> Sym2 {
        state.elastic_strain
    }

    fn elastic_tangent(&self) -> Sym4 {
        self.elastic.tangent()
    }

    /// ½ εᵉ·S·εᵉ + ψ(p) + ⅓ H_k ‖eᵖ‖² + Σ ⅓ Cᵢ ‖αᵢ‖².
    fn stored_energy(&self, state: &VonMisesState<TERMS>) -> f64 {
        let mut energy = self.elastic.energy(&state.elastic_strain)
            + self.isotropic.energy(state.p)
            + self.kinematic / 3.0 * state.plastic_strain.norm_squared();
        for ((modulus, _), back) in self.recalled().iter().zip(&state.back_strain) {
            energy += modulus / 3.0 * back.norm_squared();
        }
        energy
    }

    /// σ_y Δp, \[61\], and Σ ⅔ γᵢ Cᵢ ‖αᵢ‖² Δp lost to recall: the rest of the plastic work is stored
    /// by the hardening.
    fn dissipation(&self, old: &VonMisesState<TERMS>, new: &VonMisesState<TERMS>) -> f64 {
        let d_p = new.p - old.p;
        let mut dissipation = self.yield_stress * d_p;
        for ((modulus, gamma), back) in self.recalled().iter().zip(&new.back_strain) {
            dissipation += 2.0 / 3.0 * gamma * modulus * back.norm_squared() * d_p;
        }
        dissipation
    }

    fn equivalent_plastic_strain(&self, state: &VonMisesState<TERMS>) -> f64 {
        state.p
    }

    /// The back stress X \[MPa\], of a law with kinematic hardening.
    fn fields(&self, state: &VonMisesState<TERMS>, each: &mut dyn FnMut(&str, &[f64])) {
        if TERMS > 0 || self.kinematic > 0.0 {
            each("back_stress", self.back_stress(state).as_slice());
        }
    }

    /// √(2/3) (σ_y + R(p)) ‖ė‖ + X : ė; a change of volume is elastic, σ_m tr ε̇.
    fn flow_power(&self, state: &VonMisesState<TERMS>, rate: &Sym2) -> Option<FlowPower> {
        let e = deviator(rate);
        let yield_stress = self.yield_stress + self.isotropic.stress(state.p);
        let flow = yield_stress * equivalent_strain(&e) + self.back_stress(state).dot(&e);
        let volume = trace(&self.stress(state)) * trace(rate) / 3.0;
        let d_p = equivalent_strain(&e);
        let mut back_rate = self.kinematic * e;
        for ((modulus, recall), back) in self.recalled().iter().zip(&state.back_strain) {
            back_rate += *modulus * (e - *recall * d_p * back);
        }
        Some(FlowPower {
            total: flow + volume,
            elastic: volume.abs(),
            hardening: self.isotropic.modulus(state.p) * d_p * d_p + 2.0 / 3.0 * back_rate.dot(&e),
        })
    }

    /// ΔV = ½ K_c (Δe_m)² + G ‖Δe‖² − (f_trial + R(p)) Δp + ½ (3G + H_k) Δp² + ψ(p + Δp) − ψ(p): the
    /// value of the infimum \[62\], whose bracket then also holds the energy stored by hardening; with
    /// linear hardening \[63\] less ½ (H + H_k) Δp². `None` with recall.
    #[inline]
    fn potential(&self, old: &VonMisesState<TERMS>, d_eps: &Sym2) -> Option<f64> {
        if TERMS > 0 {
            return None;
        }
        let elastic = self.elastic.energy(d_eps);
        let Some(Return {
            d_p, trial, slope, ..
        }) = self.radial_return(old, d_eps)
        else {
            return Some(elastic);
        };
        // ‖Δeᵖ‖² = 3/2 Δp², [60].
        if self.isotropic.constant_modulus().is_some() {
            return Some(elastic - 0.5 * slope * d_p.powi(2));
        }
        let linear = 3.0 * self.elastic.shear_modulus() + self.kinematic;
        let stored = self.isotropic.energy(old.p + d_p) - self.isotropic.energy(old.p);
        let driven = (trial - self.yield_stress) * d_p;
        Some(elastic - driven + 0.5 * linear * d_p.powi(2) + stored)
    }
}
