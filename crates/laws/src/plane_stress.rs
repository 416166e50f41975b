//! A law of R³ under plane stress, σ₃₃ = 0: the strain of the thickness is found point by point; not kinematics,
//! which are those of plane strain.

use crate::bulk::{BulkLaw, FlowPower, Numbers, Response};
use moreau_mandel::{Sym2, Sym4};

/// Place of the strain of the thickness in a tensor.
const THICKNESS: usize = 2;

/// Residual σ₃₃ that counts as nothing, in the rounding of the stress.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// What a point remembers: the state of its material, and what the thickness has done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneStressState<S> {
    /// State of the material.
    pub material: S,
    /// Strain ε₃₃ of the thickness since the start.
    pub thickness_strain: f64,
}

impl<S> From<S> for PlaneStressState<S> {
    fn from(material: S) -> Self {
        let thickness_strain = 0.0;
        Self {
            material,
            thickness_strain,
        }
    }
}

impl<S: Numbers> Numbers for PlaneStressState<S> {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.material.visit(each);
        each(&mut self.thickness_strain);
    }
}

/// A law whose strain increment Δε₃₃ is the one under which σ₃₃ = 0 at the end of the step. The one that it is given is
/// by how much it would exceed that of the thickness, nothing or, less what heat expands, below it: it does not count
/// but for [`PlaneStressState::thickness_strain`].
///
/// A step of a law with a potential is ΔV(Δε) = min over Δε₃₃ of that of the law: convex again, with the same
/// gradient, because σ₃₃ = 0 before and after. Its tangent is the condensed one,
/// Cᵢⱼ − Cᵢ₃ C₃ⱼ / C₃₃. Δε₃₃ is the root of a function that rises; a Newton iteration between bounds cannot miss it.
///
/// Shears through the thickness are not condensed: the kinematics of the plane have none, and stresses none either
/// where 3 is an axis of the material.
///
/// Source: J. C. Simo and T. J. R. Hughes, *Computational Inelasticity* (1998), section 3.4; E. A. de Souza Neto,
/// D. Perić and D. R. J. Owen, *Computational Methods for Plasticity* (2008), section 9.2.2.
#[derive(Debug, Clone, PartialEq)]
pub struct InPlaneStress<L>(pub L);

impl<L: BulkLaw> InPlaneStress<L> {
    /// The strain increment with that of the thickness, and the response to it.
    #[inline]
    fn completed(&self, old: &L::State, d_eps: &Sym2) -> (Sym2, Response<L::State>) {
        let law = &self.0;
        let elastic = law.elastic_tangent();
        let stiffness = elastic[(THICKNESS, THICKNESS)];
        let before = law.stress(old);
        let mut d_eps = *d_eps;
        d_eps[THICKNESS] = 0.0;
        // Where nothing flows this is the answer.
        let normal = before[THICKNESS] + elastic.row(THICKNESS).transpose().dot(&d_eps);
        d_eps[THICKNESS] = -normal / stiffness;
        let nothing = ROUNDING * (stiffness * d_eps.norm() + before.norm());

        let mut response = law.respond(old, &d_eps);
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        let (mut left, mut reach) = (f64::INFINITY, 16.0);
        for _ in 0..200 {
            let (x, excess) = (d_eps[THICKNESS], response.stress[THICKNESS]);
            let is_settled = excess.abs() <= nothing;
            if is_settled || excess.is_nan() {
                break;
            }
            match excess > 0.0 {
                true => high = x,
                false => low = x,
            }
            let step = excess / self.slope(old, &d_eps, &response);
            let next = if low.is_finite() && high.is_finite() {
                let newton = x - step;
                // A step of Newton's, but for a kink that it cannot pass.
                match excess.abs() <= 0.5 * left && low < newton && newton < high {
                    true => newton,
                    false => 0.5 * (low + high),
                }
            } else {
                // No further than some elastic steps as long as one side is open.
                let farthest = reach * excess.abs() / stiffness;
                reach *= 4.0;
                let length = step.abs().min(farthest);
                let forward = step * excess > 0.0 && length.is_finite();
                x - excess.signum() * if forward { length } else { farthest }
            };
            if next == x {
                break;
            }
            left = excess.abs();
            d_eps[THICKNESS] = next;
            response = law.respond(old, &d_eps);
        }
        (d_eps, response)
    }

    /// ∂σ₃₃/∂Δε₃₃ \[MPa\].
    fn slope(&self, old: &L::State, d_eps: &Sym2, response: &Response<L::State>) -> f64 {
        let at = (THICKNESS, THICKNESS);
        match self.0.is_symmetric() {
            true => response.tangent[at],
            false => response.tangent[at] + self.0.lacking(old, d_eps)[at],
        }
    }

    /// All of ∂σ₁/∂Δε, condensed.
    fn complete(&self, old: &L::State, d_eps: &Sym2, tangent: &Sym4) -> Sym4 {
        let law = &self.0;
        condensed(&(tangent + law.lacking(old, d_eps) + law.skew(old, d_eps)))
    }
}

/// Cᵢⱼ − Cᵢ₃ C₃ⱼ / C₃₃; without the row and the column of the thickness where that has no stiffness.
fn condensed(c: &Sym4) -> Sym4 {
    let stiffness = c[(THICKNESS, THICKNESS)];
    let mut out = *c;
    if stiffness > 0.0 || stiffness.is_nan() {
        out -= c.column(THICKNESS) * c.row(THICKNESS) / stiffness;
    }
    out.row_mut(THICKNESS).fill(0.0);
    out.column_mut(THICKNESS).fill(0.0);
    out
}

fn symmetric(c: &Sym4) -> Sym4 {
    0.5 * (c + c.transpose())
}

impl<L: BulkLaw> BulkLaw for InPlaneStress<L> {
    type State = PlaneStressState<L::State>;

    fn initial(&self) -> Self::State {
        self.0.initial().into()
    }

    #[inline]
    fn respond(&self, old: &Self::State, d_eps: &Sym2) -> Response<Self::State> {
        let given = d_eps[THICKNESS];
        let (d_eps, response) = self.completed(&old.material, d_eps);
        let tangent = match response.flows && self.0.is_symmetric() {
            true => symmetric(&self.complete(&old.material, &d_eps, &response.tangent)),
            false => condensed(&response.tangent),
        };
        Response {
            stress: response.stress,
            tangent,
            flows: response.flows,
            state: PlaneStressState {
                material: response.state,
                thickness_strain: old.thickness_strain + (d_eps[THICKNESS] - given),
            },
        }
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric()
    }

    fn lacking(&self, old: &Self::State, d_eps: &Sym2) -> Sym4 {
        if self.is_symmetric() {
            return Sym4::zeros();
        }
        let (d_eps, response) = self.completed(&old.material, d_eps);
        let tangent = &response.tangent;
        self.complete(&old.material, &d_eps, tangent) - condensed(tangent)
    }

    fn skew(&self, old: &Self::State, d_eps: &Sym2) -> Sym4 {
        if !self.is_symmetric() {
            return Sym4::zeros();
        }
        let (d_eps, response) = self.completed(&old.material, d_eps);
        let complete = self.complete(&old.material, &d_eps, &response.tangent);
        0.5 * (complete - complete.transpose())
    }

    #[inline]
    fn stress(&self, state: &Self::State) -> Sym2 {
        self.0.stress(&state.material)
    }

    fn is_isotropic(&self) -> bool {
        false
    }

    fn elastic_strain(&self, state: &Self::State) -> Sym2 {
        self.0.elastic_strain(&state.material)
    }

    /// The condensed one: nothing resists a strain of the thickness.
    fn elastic_tangent(&self) -> Sym4 {
        condensed(&self.0.elastic_tangent())
    }

    fn thickness_strain(&self, state: &Self::State) -> Option<f64> {
        Some(state.thickness_strain)
    }

    fn stored_energy(&self, state: &Self::State) -> f64 {
        self.0.stored_energy(&state.material)
    }

    fn dissipation(&self, old: &Self::State, new: &Self::State) -> f64 {
        self.0.dissipation(&old.material, &new.material)
    }

    fn equivalent_plastic_strain(&self, state: &Self::State) -> f64 {
        self.0.equivalent_plastic_strain(&state.material)
    }

    /// The strain of the thickness, beside the fields of the law.
    fn fields(&self, state: &Self::State, each: &mut dyn FnMut(&str, &[f64])) {
        self.0.fields(&state.material, each);
        each("thickness_strain", &[state.thickness_strain]);
    }

    #[inline]
    fn potential(&self, old: &Self::State, d_eps: &Sym2) -> Option<f64> {
        let (d_eps, _) = self.completed(&old.material, d_eps);
        self.0.potential(&old.material, &d_eps)
    }

    /// That of the law at the ε̇₃₃ of its flow.
    fn flow_power(&self, state: &Self::State, rate: &Sym2) -> Option<FlowPower> {
        let mut rate = *rate;
        rate[THICKNESS] = self.0.thickness_rate(&rate);
        self.0.flow_power(&state.material, &rate)
    }
}
