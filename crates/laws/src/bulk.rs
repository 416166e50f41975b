//! What a body asks of the law of its material; not a law.

use moreau_mandel::{Sym2, Sym4};

/// Part of the trial stress below which an overstress is the rounding of a state on the yield surface:
/// unloading from there is elastic, and rounding does not choose the tangent it begins with. A law flows
/// where f > `ON_SURFACE` times the size of the terms of f.
pub const ON_SURFACE: f64 = 1e-12;

/// Names of the fields that results have whatever the law.
pub const COMMON_FIELDS: [&str; 8] = [
    "stress",
    "von_mises",
    "equivalent_plastic_strain",
    "displacement",
    "out_of_balance",
    "cell",
    "point",
    "volume",
];

/// The numbers that a state consists of, always the same count in the same order: enough to write
/// the state to a file and to read it back to the bit. Tensors, numbers, arrays and tuples of such have
/// them.
pub trait Numbers {
    /// Hands every number on, to be read or replaced.
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64));
}

impl Numbers for Sym2 {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.iter_mut().for_each(each);
    }
}

impl Numbers for f64 {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        each(self);
    }
}

impl<T: Numbers, const N: usize> Numbers for [T; N] {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.iter_mut().for_each(|part| part.visit(each));
    }
}

impl<A: Numbers, B: Numbers> Numbers for (A, B) {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.0.visit(each);
        self.1.visit(each);
    }
}

impl<A: Numbers, B: Numbers, C: Numbers> Numbers for (A, B, C) {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.0.visit(each);
        self.1.visit(each);
        self.2.visit(each);
    }
}

/// Outcome of a step at a material point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<S> {
    /// Stress at the end of the step, σ₁ \[MPa\].
    pub stress: Sym2,
    /// Consistent tangent ∂σ₁/∂Δε \[MPa\], 6×6 and symmetric; where that is not, a symmetric matrix
    /// near it, which lacks [`BulkLaw::lacking`].
    pub tangent: Sym4,
    /// Whether plastic strain grows; the tangent is the elastic one otherwise.
    pub flows: bool,
    /// State at the end of the step.
    pub state: S,
}

/// Greatest power that admissible stresses have on a strain rate, D(ε̇) = sup σ : ε̇ over the stresses
/// on the yield surface as it is \[N·mm/mm³ per unit of time; N·mm when summed over a body\].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FlowPower {
    /// D(ε̇), with what is said of `elastic`.
    pub total: f64,
    /// The part of the strain rate that no stress on the yield surface bounds, a change of volume or
    /// all of it where a law is elastic, counts in `total` with the present stress; this is the
    /// absolute value of what it counts.
    pub elastic: f64,
    /// By how much D rises while the strain grows at this rate for a unit of time, because the yield surface grows or
    /// moves along: none of perfect plasticity.
    pub hardening: f64,
}

impl FlowPower {
    /// The sum with a part of a body of this volume \[mm³\].
    #[must_use]
    pub fn with(self, volume: f64, part: Self) -> Self {
        Self {
            total: self.total + volume * part.total,
            elastic: self.elastic + volume * part.elastic,
            hardening: self.hardening + volume * part.hardening,
        }
    }
}

/// A law of the bulk in R³, integrated by backward Euler over the step.
///
/// A law is pure: it maps the state at the start of the step and the strain increment of the
/// *whole* step to the end of the step, and remembers nothing. Plane strain and axisymmetry are
/// kinematics, not laws. A strain that is not a number gives a stress that is not a number.
pub trait BulkLaw: 'static + Clone + Send + Sync {
    /// What the material remembers, what varies from point to point (the axes of a material, say)
    /// included.
    type State: Copy + Send + Sync + PartialEq + std::fmt::Debug + Numbers;

    /// The state that a body starts from where no other is given, the virgin one.
    fn initial(&self) -> Self::State;

    /// Response to the strain increment Δε of the whole step, from the state at its start.
    fn respond(&self, old: &Self::State, d_eps: &Sym2) -> Response<Self::State>;

    /// Whether ∂σ₁/∂Δε is symmetric, or the tangent does for it.
    fn is_symmetric(&self) -> bool {
        true
    }

    /// What [`Response::tangent`] lacks of ∂σ₁/∂Δε at the response to Δε \[MPa\], 6×6; zero of a law
    /// that is symmetric.
    fn lacking(&self, _old: &Self::State, _d_eps: &Sym2) -> Sym4 {
        Sym4::zeros()
    }

    /// The part of ∂σ₁/∂Δε that is not symmetric, of a law that calls itself symmetric because its tangent does
    /// without it \[MPa\], 6×6.
    fn skew(&self, _old: &Self::State, _d_eps: &Sym2) -> Sym4 {
        Sym4::zeros()
    }

    /// Stress in a state \[MPa\].
    fn stress(&self, state: &Self::State) -> Sym2;

    /// Whether nothing but stress and strain has a direction: the material has no axes and remembers no
    /// tensor that acts, as a back stress does. Under large strains its tangent is then as symmetric as
    /// under small ones.
    fn is_isotropic(&self) -> bool {
        false
    }

    /// Elastic strain of a state, under which its stress is what it is: what large strains start from. That
    /// of linear elasticity, unless the law says otherwise.
    fn elastic_strain(&self, state: &Self::State) -> Sym2 {
        let compliance = self.elastic_tangent().try_inverse();
        compliance.map_or_else(Sym2::zeros, |s| s * self.stress(state))
    }

    /// The elastic tangent \[MPa\], 6×6, symmetric positive definite; under plane stress without the row and the
    /// column of ε₃₃.
    fn elastic_tangent(&self) -> Sym4;

    /// ε₃₃ of a state since the start, of a law that finds it in place of the one that it is given: one under plane
    /// stress, [`InPlaneStress`](crate::InPlaneStress). `None` of the others.
    fn thickness_strain(&self, _state: &Self::State) -> Option<f64> {
        None
    }

    /// ε̇₃₃ of the plastic flow that has the other components of this rate under plane stress, σ₃₃ = 0: what makes
    /// [`BulkLaw::flow_power`] least. That of flow at constant volume, unless the law says otherwise.
    fn thickness_rate(&self, rate: &Sym2) -> f64 {
        -(rate[0] + rate[1])
    }

    /// Energy stored in a state, elastic and by hardening \[N·mm/mm³\]; non-negative.
    fn stored_energy(&self, state: &Self::State) -> f64;

    /// Energy dissipated by a step between two states \[N·mm/mm³\]; non-negative.
    fn dissipation(&self, old: &Self::State, new: &Self::State) -> f64;

    /// Equivalent plastic strain p = ∫ √(2/3) ‖ε̇ᵖ‖ of a state, \[60\]; never decreases along a path.
    fn equivalent_plastic_strain(&self, state: &Self::State) -> f64;

    /// Hands on the fields of a state that are worth seeing beside stress and p, each a name and its
    /// components: one of a scalar, three of a vector, six of a symmetric tensor as in [`Sym2`]. The
    /// same names and counts in every state. Names are words joined by underscores, `"back_stress"`, and
    /// none of [`COMMON_FIELDS`].
    fn fields(&self, _state: &Self::State, _each: &mut dyn FnMut(&str, &[f64])) {}

    /// ΔV(Δε) \[N·mm/mm³\], with ∂ΔV/∂Δε = Δσ = σ₁ − σ₀, \[65\]; convex, continuously
    /// differentiable, zero with its gradient at Δε = 0 when the state at the start is admissible.
    /// `None` of a law without one, whose flow is not associated.
    ///
    /// It is the work done beyond σ₀ : Δε, stored and dissipated, \[48\]:
    /// ΔV = ψ₁ − ψ₀ + D − σ₀ : Δε with the stored energy ψ and the dissipation D of the step.
    fn potential(&self, _old: &Self::State, _d_eps: &Sym2) -> Option<f64> {
        None
    }

    /// D(ε̇) in a state: convex and homogeneous of degree 1 in the strain rate, up to what counts as
    /// elastic, and at least σ : ε̇ with the present stress σ; equal to it where ε̇ is the flow of σ.
    /// `None` of a law whose flow is not associated: it has no such function.
    fn flow_power(&self, _state: &Self::State, _rate: &Sym2) -> Option<FlowPower> {
        None
    }
}
