//! An elastic body with Drucker–Prager plasticity, integrated over a step; its plastic part is the
//! bipotential of `drucker_prager`.

use crate::bulk::{BulkLaw, FlowPower, Numbers, ON_SURFACE, Response};
use crate::drucker_prager::DruckerPrager;
use crate::elastic::Elastic;
use crate::error::{LawError, Parameter, positive};
use moreau_mandel::{Sym2, Sym4, deviator, deviatoric_projector, identity, trace};

/// What a Drucker–Prager material remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DruckerPragerState {
    /// Elastic strain εᵉ.
    pub elastic_strain: Sym2,
    /// Plastic strain εᵖ, with its dilation.
    pub plastic_strain: Sym2,
    /// Accumulated plastic strain p = ∫ √(2/3) ‖ε̇ᵖ‖, which grows at the apex too.
    pub p: f64,
}

impl Numbers for DruckerPragerState {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.elastic_strain.visit(each);
        self.plastic_strain.visit(each);
        each(&mut self.p);
    }
}

/// Part of the elastic stiffness in the tangent of a flow that is not associated.
const ELASTIC: f64 = 1e-2;

/// Where a trial stress returns to.
enum Return {
    /// Nowhere: it is admissible.
    Elastic,
    /// The cone, along n, by λ; with the norm of the trial deviator.
    Cone { n: Sym2, lambda: f64, norm: f64 },
    /// The apex.
    Apex,
}

/// Isotropic elasticity with the plastic flow of [`DruckerPrager`]: perfectly plastic, in general not
/// associated.
///
/// Backward Euler in closed form. On the cone the trial stress returns by λ = ‖Δeᵖ‖,
///
/// λ = (‖s_trial‖ − k_f (c₀ − σ_m,trial)) / (2G + K_c k_f k_t),
///
/// s = s_trial − 2G λ n and σ_m = σ_m,trial − K_c k_t λ; where that would turn s around, it returns
/// to the apex s = 0, σ_m = c₀. Either way (Δεᵖ, σ₁) is extremal for the bipotential.
///
/// With k_t < k_f there is no potential, and with a = 2G n + K k 1 on the cone
///
/// ∂σ₁/∂Δε = C − a_t ⊗ a_f / (2G + K k_f k_t) − (2G)² λ/‖s_trial‖ (P − n ⊗ n)
///
/// is not symmetric; its symmetric part is indefinite. The tangent of the response is that of associated
/// flow with the friction k_t, a_t in place of a_f, and a hundredth of it is replaced by the elastic
/// stiffness: symmetric and positive definite, also at the apex and on the plateau of a load, where
/// ∂σ₁/∂Δε is a mechanism. What it lacks is [`BulkLaw::lacking`]: without it Newton's method converges
/// linearly, at a rate that grows with k_f − k_t, or not at all.
///
/// Source: M. Hjiaj, J. Fortin and G. de Saxcé, *International Journal of Engineering Science* 41
/// (2003) 1109-1143.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElasticDruckerPrager {
    elastic: Elastic,
    plastic: DruckerPrager,
}

impl ElasticDruckerPrager {
    /// From E \[MPa\], ν and the plastic law.
    ///
    /// # Errors
    /// Those of [`Elastic::new`]; `NotPositive` without friction, which would leave a line of pressures.
    pub fn new(young: f64, poisson: f64, plastic: DruckerPrager) -> Result<Self, LawError> {
        positive(Parameter::MaterialFriction, plastic.friction())?;
        Ok(Self {
            elastic: Elastic::new(young, poisson)?,
            plastic,
        })
    }

    /// The elastic part of the law.
    pub fn elastic(&self) -> &Elastic {
        &self.elastic
    }

    /// The plastic part of the law.
    pub fn plastic(&self) -> &DruckerPrager {
        &self.plastic
    }

    /// Where the trial stress of a trial strain returns to.
    #[inline]
    fn returned(&self, trial: &Sym2) -> Return {
        let (k, g) = (self.elastic.bulk_modulus(), self.elastic.shear_modulus());
        let (k_f, k_t) = (self.plastic.friction(), self.plastic.dilatancy());
        let s = 2.0 * g * deviator(trial);
        let (norm, mean) = (s.norm(), k * trace(trial));
        let resisted = k_f * (self.plastic.apex() - mean);
        let f = norm - resisted;
        if f <= ON_SURFACE * (norm + resisted.abs()) {
            return Return::Elastic;
        }
        let lambda = f / (2.0 * g + k * k_f * k_t);
        match norm < 2.0 * g * lambda {
            true => Return::Apex,
            false => Return::Cone {
                n: s / norm,
                lambda,
                norm,
            },
        }
    }

    /// Tangent of associated flow with the friction k_t on the cone, with λ and the norm of the trial deviator.
    fn tangent_on_cone(&self, n: &Sym2, lambda: f64, norm: f64) -> Sym4 {
        let (k, g) = (self.elastic.bulk_modulus(), self.elastic.shear_modulus());
        let k_t = self.plastic.dilatancy();
        // Along n and along the unit pressure d: the elastic stiffness less what flows, a⊗a.
        let (a_n, a_d) = (2.0 * g, 3f64.sqrt() * k * k_t);
        let weight = 1.0 / (2.0 * g + k * k_t * k_t);
        let nn = 2.0 * g - weight * a_n * a_n;
        let nd = -weight * a_n * a_d;
        let dd = 3.0 * k - weight * a_d * a_d;
        let d = identity() / 3f64.sqrt();
        // Across n the deviator turns with the trial.
        let across = 2.0 * g * (1.0 - 2.0 * g * lambda / norm);
        across * (deviatoric_projector() - n * n.transpose())
            + nn * n * n.transpose()
            + nd * (n * d.transpose() + d * n.transpose())
            + dd * d * d.transpose()
    }
}

impl BulkLaw for ElasticDruckerPrager {
    type State = DruckerPragerState;

    fn initial(&self) -> DruckerPragerState {
        DruckerPragerState::default()
    }

    #[inline]
    fn respond(&self, old: &DruckerPragerState, d_eps: &Sym2) -> Response<DruckerPragerState> {
        let (k, k_t) = (self.elastic.bulk_modulus(), self.plastic.dilatancy());
        let mut state = *old;
        let trial = old.elastic_strain + d_eps;
        let (flow, mut tangent) = match self.returned(&trial) {
            Return::Elastic => {
                state.elastic_strain = trial;
                return Response {
                    stress: self.stress(&state),
                    tangent: self.elastic.tangent(),
                    flows: false,
                    state,
                };
            }
            Return::Apex => {
                let left = self.plastic.apex() / (3.0 * k) * identity();
                (trial - left, Sym4::zeros())
            }
            Return::Cone { n, lambda, norm } => (
                lambda * (n + k_t / 3.0 * identity()),
                self.tangent_on_cone(&n, lambda, norm),
            ),
        };
        if !self.is_symmetric() {
            tangent += ELASTIC * (self.elastic.tangent() - tangent);
        }
        state.elastic_strain = trial - flow;
        state.plastic_strain += flow;
        state.p += (2.0f64 / 3.0).sqrt() * flow.norm();
        Response {
            stress: self.stress(&state),
            tangent,
            flows: true,
            state,
        }
    }

    fn is_symmetric(&self) -> bool {
        self.plastic.dilatancy() >= self.plastic.friction()
    }

    fn lacking(&self, old: &DruckerPragerState, d_eps: &Sym2) -> Sym4 {
        if self.is_symmetric() {
            return Sym4::zeros();
        }
        match self.returned(&(old.elastic_strain + d_eps)) {
            Return::Elastic => Sym4::zeros(),
            Return::Apex => -ELASTIC * self.elastic.tangent(),
            Return::Cone { n, lambda, norm } => {
                let (k, g) = (self.elastic.bulk_modulus(), self.elastic.shear_modulus());
                let (k_f, k_t) = (self.plastic.friction(), self.plastic.dilatancy());
                let along = |slope: f64| 2.0 * g * n + k * slope * identity();
                let (a_f, a_t) = (along(k_f), along(k_t));
                let associated = (1.0 - ELASTIC) / (2.0 * g + k * k_t * k_t);
                let yielded = associated * a_t - a_f / (2.0 * g + k * k_f * k_t);
                let turned = ELASTIC * 4.0 * g * g * lambda / norm;
                a_t * yielded.transpose() - turned * (deviatoric_projector() - n * n.transpose())
            }
        }
    }

    #[inline]
    fn stress(&self, state: &DruckerPragerState) -> Sym2 {
        self.elastic.stress(&state.elastic_strain)
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    #[inline]
    fn elastic_strain(&self, state: &DruckerPragerState) -> Sym2 {
        state.elastic_strain
    }

    fn elastic_tangent(&self) -> Sym4 {
        self.elastic.tangent()
    }

    fn stored_energy(&self, state: &DruckerPragerState) -> f64 {
        self.elastic.energy(&state.elastic_strain)
    }

    /// σ₁ : Δεᵖ = c₀ Δe_v + (k_f − k_t)(c₀ − σ_m) ‖Δe‖, the bipotential at the law.
    fn dissipation(&self, old: &DruckerPragerState, new: &DruckerPragerState) -> f64 {
        let flow = new.plastic_strain - old.plastic_strain;
        let mean = trace(&self.stress(new)) / 3.0;
        self.plastic.power(mean, &flow)
    }

    fn equivalent_plastic_strain(&self, state: &DruckerPragerState) -> f64 {
        state.p
    }

    /// The dilation e_v = tr εᵖ of the flow.
    fn fields(&self, state: &DruckerPragerState, each: &mut dyn FnMut(&str, &[f64])) {
        each("plastic_dilation", &[trace(&state.plastic_strain)]);
    }

    /// ψ₁ − ψ₀ + c₀ Δe_v − σ₀ : Δε of associated flow, k_t = k_f; else `None`.
    fn potential(&self, old: &DruckerPragerState, d_eps: &Sym2) -> Option<f64> {
        if self.plastic.dilatancy() < self.plastic.friction() {
            return None;
        }
        let new = self.respond(old, d_eps).state;
        let flow = new.plastic_strain - old.plastic_strain;
        // ψ₁ − ψ₀ − σ₀ : Δεᵉ is the energy of Δεᵉ, free of the rounding of the difference.
        let elastic = self.elastic.energy(&(d_eps - flow)) - self.stress(old).dot(&flow);
        Some(elastic + self.plastic.apex() * trace(&flow))
    }

    /// Where the dilation e_v of the rate is k_f ‖e‖: the least one that stresses bound. At constant volume where
    /// there is none, friction being so large that pressure in the plane never flows.
    fn thickness_rate(&self, rate: &Sym2) -> f64 {
        let square = self.plastic.friction().powi(2);
        let mut given = *rate;
        given[2] = 0.0;
        // ‖e‖² = ‖ε̇‖² − e_v²/3 with ε̇₃₃ = e_v − a: a quadratic equation, of which one root is positive.
        let a = rate[0] + rate[1];
        let (of_square, constant) = (
            1.0 - 2.0 / 3.0 * square,
            square * (given.norm_squared() + a * a),
        );
        if of_square <= 0.0 {
            return -a;
        }
        let half = square * a;
        ((half * half + of_square * constant).sqrt() - half) / of_square - a
    }

    /// c₀ e_v⁺ + σ_m (e_v − e_v⁺) of associated flow, with e_v⁺ = max(e_v, k_f ‖e‖): what a rate
    /// lacks of the dilation of flow is elastic. `None` where k_t < k_f.
    fn flow_power(&self, state: &DruckerPragerState, rate: &Sym2) -> Option<FlowPower> {
        let friction = self.plastic.friction();
        if self.plastic.dilatancy() < friction {
            return None;
        }
        let dilation = trace(rate).max(friction * deviator(rate).norm());
        let lacking = trace(&self.stress(state)) / 3.0 * (trace(rate) - dilation);
        Some(FlowPower {
            total: self.plastic.apex() * dilation + lacking,
            elastic: lacking.abs(),
            hardening: 0.0,
        })
    }
}
