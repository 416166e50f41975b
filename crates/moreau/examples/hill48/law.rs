//! Hill's orthotropic plasticity of sheets, as a law from outside; not `moreau::laws::Hill`, which decks have.

use moreau::laws::{BulkLaw, Elastic, LawError, ON_SURFACE, Response, positive};
use moreau::mandel::{Sym2, Sym4, equivalent_strain};

/// σ_eq = √(σ·P·σ) ≤ σ_y + H α, Δεᵖ = Δα P σ/σ_eq: elasticity, P, σ_y and H.
#[derive(Debug, Clone)]
pub(crate) struct Hill48(Elastic, Sym4, f64, f64);

/// Elastic strain, α and p.
type State = (Sym2, f64, f64);

impl Hill48 {
    /// From elasticity, (F, G, H, L, M, N), the yield stress and the modulus of hardening \[MPa\].
    pub(crate) fn new(e: Elastic, c: [f64; 6], y: f64, hardening: f64) -> Result<Self, LawError> {
        let [f, g, h, l, m, n] = c;
        let mut p = Sym4::from_diagonal(&Sym2::from([g + h, f + h, f + g, l, m, n]));
        for (i, j, c) in [(1, 2, f), (0, 2, g), (0, 1, h)] {
            (p[(i, j)], p[(j, i)]) = (-c, -c);
        }
        Ok(Self(e, p, positive("Hill's yield stress", y)?, hardening))
    }
}

impl BulkLaw for Hill48 {
    type State = State;
    fn initial(&self) -> State {
        (Sym2::zeros(), 0.0, 0.0)
    }
    /// σ = A ε_trial with A = (C⁻¹ + μ P)⁻¹ and μ = Δα/σ_eq, where 1/σ_eq = (1 − H μ)/(σ_y + H α): the
    /// left side is concave in μ, and Newton's method converges from 0 on.
    fn respond(&self, old: &State, d_eps: &Sym2) -> Response<State> {
        let Self(elastic, p, y, h) = self;
        let (mut a, trial, y) = (elastic.tangent(), old.0 + d_eps, y + h * old.1);
        let (soft, mut mu, mut tangent) = (a.try_inverse().unwrap_or_default(), 0.0, a);
        let size = |s: &Sym2| s.dot(&(p * s)).sqrt();
        let flows = size(&(a * trial)) > (1.0 + ON_SURFACE) * y;
        for _ in 0..if flows { 50 } else { 0 } {
            let stress = a * trial;
            let n = p * stress / size(&stress);
            let (an, lacking) = (a * n, (1.0 - h * mu) / y - 1.0 / size(&stress));
            tangent = a - an * an.transpose() / (n.dot(&an) + h / (1.0 - h * mu));
            if lacking.abs() * y <= 1e-15 {
                break;
            }
            mu += lacking / (n.dot(&an) / size(&stress) + h / y);
            a = (soft + mu * p).try_inverse().unwrap_or_default();
        }
        let stress = a * trial;
        let (flow, d_alpha) = (mu * p * stress, mu * size(&stress));
        let p = old.2 + equivalent_strain(&flow);
        let state = (trial - flow, old.1 + d_alpha, p);
        Response {
            stress,
            tangent,
            flows,
            state,
        }
    }
    fn stress(&self, state: &State) -> Sym2 {
        self.0.stress(&state.0)
    }
    fn elastic_tangent(&self) -> Sym4 {
        self.0.tangent()
    }
    fn stored_energy(&self, state: &State) -> f64 {
        self.0.energy(&state.0) + 0.5 * self.3 * state.1.powi(2)
    }
    fn dissipation(&self, old: &State, new: &State) -> f64 {
        self.2 * (new.1 - old.1)
    }
    fn equivalent_plastic_strain(&self, state: &State) -> f64 {
        state.2
    }
    fn fields(&self, state: &State, each: &mut dyn FnMut(&str, &[f64])) {
        each("hill_strain", &[state.1]);
    }
}
