//! Hill's plasticity of orthotropic metals with isotropic hardening; not their elasticity.

use crate::bulk::{BulkLaw, FlowPower, Numbers, ON_SURFACE, Response};
use crate::error::{LawError, Parameter, non_negative, positive};
use crate::isotropic::Isotropic;
use crate::orthotropic::{Orthotropic, turned};
use moreau_mandel::{Sym2, Sym4, deviator, equivalent_strain, identity, trace};
use nalgebra::Matrix3;

/// Hill's coefficients: σ_eq² = F (σ₂₂ − σ₃₃)² + G (σ₃₃ − σ₁₁)² + H (σ₁₁ − σ₂₂)² + 2 L σ₂₃² + 2 M σ₁₃² + 2 N σ₁₂²
/// along the axes of the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HillCoefficients {
    /// The map P of σ_eq² = σ·P·σ.
    map: Sym4,
}

impl HillCoefficients {
    /// From (F, G, H, L, M, N), numbers without unit. With ½ and 3⁄2 it is von Mises' criterion; the stress under which
    /// tension along the first axis yields is the yield stress over √(G + H).
    ///
    /// # Errors
    /// `NotDefinite` unless every stress but a pressure has a positive σ_eq: L, M, N > 0, F + G + H > 0 and
    /// FG + GH + HF > 0.
    pub fn new([f, g, h, l, m, n]: [f64; 6]) -> Result<Self, LawError> {
        let shears = l > 0.0 && m > 0.0 && n > 0.0;
        let definite = f + g + h > 0.0 && f * g + g * h + h * f > 0.0;
        let finite = [f, g, h, l, m, n].iter().all(|c| c.is_finite());
        if !(shears && definite && finite) {
            let of = "Hill's criterion";
            return Err(LawError::NotDefinite { of });
        }
        let mut map = Sym4::from_diagonal(&Sym2::from([g + h, f + h, f + g, l, m, n]));
        for (i, j, c) in [(1, 2, f), (0, 2, g), (0, 1, h)] {
            (map[(i, j)], map[(j, i)]) = (-c, -c);
        }
        Ok(Self { map })
    }

    /// From Lankford's ratios of a sheet, strain of the width over that of the thickness in tension along its first axis,
    /// at 45° to it and across it: G = 1/(1 + r₀), H = r₀/(1 + r₀), F = r₀/(r₉₀ (1 + r₀)),
    /// N = (r₀ + r₉₀)(1 + 2 r₄₅)/(2 r₉₀ (1 + r₀)), and L = M = 3⁄2. The yield stress is that along the first axis.
    ///
    /// # Errors
    /// `NotPositive` unless r₀ and r₉₀ are positive and finite, `Negative` unless r₄₅ ≥ 0 is finite.
    pub fn lankford(r0: f64, r45: f64, r90: f64) -> Result<Self, LawError> {
        positive("Lankford's ratio r0", r0)?;
        non_negative("Lankford's ratio r45", r45)?;
        positive("Lankford's ratio r90", r90)?;
        let whole = 1.0 + r0;
        let n = (r0 + r90) * (1.0 + 2.0 * r45) / (2.0 * r90 * whole);
        Self::new([r0 / (r90 * whole), 1.0 / whole, r0 / whole, 1.5, 1.5, n])
    }

    /// The same with the axes of the material in the columns of a rotation.
    #[must_use]
    pub fn along(self, axes: &Matrix3<f64>) -> Self {
        let map = turned(&self.map, axes);
        Self { map }
    }
}

/// What a material of Hill remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HillState {
    /// Elastic strain εᵉ.
    pub elastic_strain: Sym2,
    /// Strain α of the hardening, conjugate to σ_eq: σ : ε̇ᵖ = σ_eq α̇.
    pub hardening_strain: f64,
    /// Equivalent plastic strain p = ∫ √(2/3) ‖ε̇ᵖ‖.
    pub p: f64,
}

impl Numbers for HillState {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.elastic_strain.visit(each);
        each(&mut self.hardening_strain);
        each(&mut self.p);
    }
}

/// Hill's criterion with associated flow and isotropic hardening: σ_eq = √(σ·P·σ) ≤ σ_y + R(α), ε̇ᵖ = α̇ P σ/σ_eq.
///
/// Backward Euler is σ = (C⁻¹ + μ P)⁻¹ ε_trial with μ = Δα/(σ_y + R(α + Δα)). In the directions that make C and P diagonal
/// at once, C = M Mᵀ and Mᵀ P M = Λ, it is one equation for Δα,
///
/// Σ λᵢ yᵢ²/(1 + μ λᵢ)² = (σ_y + R(α + Δα))², y = Mᵀ ε_trial,
///
/// whose left side falls with μ: a Newton iteration between bounds cannot miss the root.
///
/// Source: R. Hill, *Proceedings of the Royal Society A* 193 (1948) 281-297; for the return J. C. Simo and T. J. R. Hughes,
/// *Computational Inelasticity* (1998), section 3.4.
#[derive(Debug, Clone, PartialEq)]
pub struct Hill {
    elastic: Sym4,
    map: Sym4,
    /// The inverse of P between deviators.
    inverse: Sym4,
    /// M, and the diagonal of Λ.
    directions: Sym4,
    weights: Sym2,
    yield_stress: f64,
    isotropic: Isotropic,
}

/// A step that yields.
struct Return {
    /// Δα > 0.
    d_alpha: f64,
    /// μ.
    mu: f64,
    /// σ_eq at the end \[MPa\].
    size: f64,
    /// y of the trial.
    trial: Sym2,
}

impl Hill {
    /// Perfect plasticity, from elasticity and criterion, each with its axes in space, and the yield stress σ_y \[MPa\].
    ///
    /// # Errors
    /// `NotPositive` unless σ_y > 0 is finite; `NotDefinite` of an elasticity that numbers cannot take the root of.
    pub fn new(
        elastic: impl Into<Orthotropic>,
        criterion: HillCoefficients,
        yield_stress: f64,
    ) -> Result<Self, LawError> {
        let elastic = elastic.into().tangent();
        let of = "orthotropic elasticity";
        let Some(root) = elastic.cholesky() else {
            return Err(LawError::NotDefinite { of });
        };
        let map = criterion.map;
        let root = root.l();
        let both = root.transpose() * map * root;
        let eigen = (0.5 * (both + both.transpose())).symmetric_eigen();
        // P does not see pressures: between deviators it is inverted with a stiffness put there.
        let pressure = identity() * identity().transpose() / 3.0;
        let size = trace_of(&map);
        let Some(inverse) = (map + size * pressure).try_inverse() else {
            return Err(LawError::NotDefinite {
                of: "Hill's criterion",
            });
        };
        Ok(Self {
            elastic,
            map,
            inverse: inverse - pressure / size,
            directions: root * eigen.eigenvectors,
            weights: eigen.eigenvalues.map(|w| w.max(0.0)),
            yield_stress: positive(Parameter::YieldStress, yield_stress)?,
            isotropic: Isotropic::linear(0.0)?,
        })
    }

    /// The same law with this isotropic hardening R(α).
    pub fn with_hardening(self, isotropic: Isotropic) -> Self {
        Self { isotropic, ..self }
    }

    /// Equivalent stress σ_eq of a stress \[MPa\].
    pub fn equivalent_stress(&self, stress: &Sym2) -> f64 {
        stress.dot(&(self.map * stress)).max(0.0).sqrt()
    }

    /// Return onto the yield surface; `None` when the step is elastic.
    #[inline]
    fn returned(&self, old: &HillState, d_eps: &Sym2) -> Option<Return> {
        let trial = self.directions.transpose() * (old.elastic_strain + d_eps);
        let alpha = old.hardening_strain;
        let strength = |d: f64| self.yield_stress + self.isotropic.stress(alpha + d);
        // σ_eq and −∂σ_eq/∂μ.
        let size = |mu: f64| {
            let (mut square, mut slope) = (0.0, 0.0);
            for (w, y) in self.weights.iter().zip(&trial) {
                let softer = 1.0 + mu * w;
                let part = w * y * y / (softer * softer);
                square += part;
                slope += w * part / softer;
            }
            let size = square.sqrt();
            (size, slope / size)
        };
        let at = |d: f64| {
            let y = strength(d);
            let mu = d / y;
            let (size, fall) = size(mu);
            let hardening = self.isotropic.modulus(alpha + d);
            let slope = fall * (1.0 - mu * hardening) / y + hardening;
            (size - y, slope, mu, size)
        };
        let (f, slope, _, whole) = at(0.0);
        if f <= ON_SURFACE * whole {
            return None;
        }
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let (mut d_alpha, mut left) = (f / slope, f);
        let mut found = at(d_alpha);
        for _ in 0..400 {
            let (excess, slope, ..) = found;
            let is_settled = excess.abs() <= 2.0 * f64::EPSILON * whole;
            if is_settled || excess.is_nan() {
                break;
            }
            match excess > 0.0 {
                true => low = d_alpha,
                false => high = d_alpha,
            }
            let newton = d_alpha + excess / slope;
            let inside = low < newton && newton < high;
            // A step of Newton's, but for a kink that it cannot pass.
            let next = match high.is_finite() {
                true if inside && excess.abs() <= 0.5 * left => newton,
                true => 0.5 * (low + high),
                false if inside => newton.min(4.0 * d_alpha),
                false => 4.0 * d_alpha,
            };
            if next == d_alpha {
                break;
            }
            (d_alpha, left) = (next, excess.abs());
            found = at(d_alpha);
        }
        let (_, _, mu, size) = found;
        Some(Return {
            d_alpha,
            mu,
            size,
            trial,
        })
    }

    /// Plastic strain of a step that yields, μ P σ.
    fn flow(&self, step: &Return) -> Sym2 {
        step.mu * (self.map * self.stress_of(step))
    }

    fn stress_of(&self, step: &Return) -> Sym2 {
        let y = step.trial.component_div(&self.softer(step.mu));
        self.directions * y
    }

    /// 1 + μ Λ.
    fn softer(&self, mu: f64) -> Sym2 {
        self.weights.map(|w| 1.0 + mu * w)
    }

    /// ∂σ₁/∂Δε = A − A n ⊗ A n h/(R' + h n·A n) with A = (C⁻¹ + μ P)⁻¹, n = P σ/σ_eq and h = 1 − μ R'.
    fn tangent(&self, old: &HillState, step: &Return) -> Sym4 {
        let softer = self.softer(step.mu);
        let m = &self.directions;
        let stiff = Sym4::from_diagonal(&softer.map(|s| 1.0 / s));
        let a = m * stiff * m.transpose();
        let weighted = step.trial.component_mul(&self.weights);
        let of_n = weighted.component_div(&softer.component_mul(&softer)) / step.size;
        let along = m * of_n;
        let n_a_n = of_n.dot(&softer.component_mul(&of_n));
        let modulus = self.isotropic.modulus(old.hardening_strain + step.d_alpha);
        let h = 1.0 - step.mu * modulus;
        let tangent = a - along * along.transpose() * (h / (modulus + h * n_a_n));
        0.5 * (tangent + tangent.transpose())
    }
}

fn trace_of(map: &Sym4) -> f64 {
    map.diagonal().sum()
}

impl BulkLaw for Hill {
    type State = HillState;

    fn initial(&self) -> HillState {
        HillState::default()
    }

    #[inline]
    fn respond(&self, old: &HillState, d_eps: &Sym2) -> Response<HillState> {
        let mut state = *old;
        state.elastic_strain += d_eps;
        let Some(step) = self.returned(old, d_eps) else {
            return Response {
                stress: self.stress(&state),
                tangent: self.elastic,
                flows: false,
                state,
            };
        };
        let flow = self.flow(&step);
        state.elastic_strain -= flow;
        state.hardening_strain += step.d_alpha;
        state.p += equivalent_strain(&flow);
        Response {
            stress: self.stress(&state),
            tangent: self.tangent(old, &step),
            flows: true,
            state,
        }
    }

    #[inline]
    fn stress(&self, state: &HillState) -> Sym2 {
        self.elastic * state.elastic_strain
    }

    #[inline]
    fn elastic_strain(&self, state: &HillState) -> Sym2 {
        state.elastic_strain
    }

    fn elastic_tangent(&self) -> Sym4 {
        self.elastic
    }

    /// ½ εᵉ·C·εᵉ + ψ(α).
    fn stored_energy(&self, state: &HillState) -> f64 {
        let elastic = state.elastic_strain;
        0.5 * elastic.dot(&(self.elastic * elastic)) + self.isotropic.energy(state.hardening_strain)
    }

    /// σ_y Δα; the rest of the plastic work is stored by the hardening.
    fn dissipation(&self, old: &HillState, new: &HillState) -> f64 {
        self.yield_stress * (new.hardening_strain - old.hardening_strain)
    }

    fn equivalent_plastic_strain(&self, state: &HillState) -> f64 {
        state.p
    }

    /// The strain α of the hardening.
    fn fields(&self, state: &HillState, each: &mut dyn FnMut(&str, &[f64])) {
        each("hill_strain", &[state.hardening_strain]);
    }

    /// (σ_y + R(α)) √(ė·P⁻¹·ė); a change of volume is elastic, σ_m tr ε̇.
    fn flow_power(&self, state: &HillState, rate: &Sym2) -> Option<FlowPower> {
        let e = deviator(rate);
        let strength = self.yield_stress + self.isotropic.stress(state.hardening_strain);
        let d_alpha = e.dot(&(self.inverse * e)).max(0.0).sqrt();
        let volume = trace(&self.stress(state)) * trace(rate) / 3.0;
        Some(FlowPower {
            total: strength * d_alpha + volume,
            elastic: volume.abs(),
            hardening: self.isotropic.modulus(state.hardening_strain) * d_alpha * d_alpha,
        })
    }

    /// ½ Δεᵉ·C·Δεᵉ − σ₀ : Δεᵖ + σ_y Δα + ψ(α + Δα) − ψ(α).
    #[inline]
    fn potential(&self, old: &HillState, d_eps: &Sym2) -> Option<f64> {
        let Some(step) = self.returned(old, d_eps) else {
            return Some(0.5 * d_eps.dot(&(self.elastic * d_eps)));
        };
        let flow = self.flow(&step);
        let elastic = d_eps - flow;
        let alpha = old.hardening_strain;
        let stored = self.isotropic.energy(alpha + step.d_alpha) - self.isotropic.energy(alpha);
        let work = 0.5 * elastic.dot(&(self.elastic * elastic)) - self.stress(old).dot(&flow);
        Some(work + self.yield_stress * step.d_alpha + stored)
    }
}
