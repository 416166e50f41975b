//! Large strains through a law of small ones: logarithmic strains in a frame that turns with the point; not
//! a law.

use crate::bulk::{BulkLaw, Numbers};
use moreau_mandel::{
    GradientTangent, Spectrum, Sym2, Sym4, from_matrix, logarithmic_slope, of_gradients, product,
    rotation, to_matrix, trace, turned,
};
use nalgebra::{Matrix3, SVector};

/// What a point remembers under large strains: the state of its material, with all tensors in the frame that
/// has turned with the point, and that frame.
///
/// A law that remembers tensors, or has axes, then needs not know that it turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned<S> {
    /// State of the material, in the frame.
    pub material: S,
    /// The frame Q, a rotation: a tensor a in it is Q a Qᵀ in space.
    pub frame: Matrix3<f64>,
}

impl<S> Turned<S> {
    /// A state of a point that has not turned.
    pub fn upright(material: S) -> Self {
        let frame = Matrix3::identity();
        Self { material, frame }
    }

    /// A tensor of the frame, in space.
    pub fn in_space(&self, tensor: &Sym2) -> Sym2 {
        from_matrix(&turned(&self.frame, &to_matrix(tensor)))
    }
}

impl<S: Numbers> Numbers for Turned<S> {
    fn visit(&mut self, each: &mut dyn FnMut(&mut f64)) {
        self.material.visit(each);
        self.frame.iter_mut().for_each(each);
    }
}

/// A step at a point under large strains, whatever the law: what there is to strain, and how its frame turns.
#[derive(Debug, Clone)]
struct LargeStep {
    /// The frame at the end of the step.
    frame: Matrix3<f64>,
    /// Elastic strain of the trial, in space.
    strain: Matrix3<f64>,
    /// Of b − 1 of the trial.
    trial: Spectrum,
    /// V² − 1 of the step, f = V R.
    stretch: Matrix3<f64>,
}

impl LargeStep {
    /// Of the elastic strain before it, in the frame then, and of the displacement gradient h; see [`respond_large`].
    fn new(
        elastic: &Sym2,
        frame: &Matrix3<f64>,
        h: &Matrix3<f64>,
        dilatation: Option<f64>,
    ) -> Option<Self> {
        let f = Matrix3::identity() + h;
        let jacobian = 1.0 + volume_change(h);
        if !(jacobian > 0.0 && jacobian.is_finite()) {
            return None;
        }
        let before = from_matrix(&turned(frame, &to_matrix(elastic)));
        let stretched = Spectrum::new(&to_matrix(&before)).map(|e| (2.0 * e).exp_m1());
        let stretch = symmetric(&(h + h.transpose() + product(h, &h.transpose())));
        let trial = Spectrum::new(&symmetric(&(stretch + turned(&f, &stretched))));
        let mut strain = trial.map(|b| 0.5 * b.ln_1p());
        if let Some(dilatation) = dilatation {
            let missing = (trace(elastic) + dilatation - strain.trace()) / 3.0;
            (0..3).for_each(|i| strain[(i, i)] += missing);
        }
        Some(Self {
            frame: product(&rotation_of(&f, &stretch), frame),
            strain,
            trial,
            stretch,
        })
    }

    /// The strain increment that a law sees, in the frame of the end of the step.
    fn increment(&self, elastic: &Sym2) -> Sym2 {
        from_matrix(&turned(&self.frame.transpose(), &self.strain)) - elastic
    }

    /// ∂τ/∂l at the end of the step \[MPa\] by an isotropic law, for which the frame does not matter: of the strain as
    /// space sees it. In its directions ėᵢⱼ = ½ (lᵢⱼ bⱼ + lⱼᵢ bᵢ) (ln bᵢ − ln bⱼ)/(bᵢ − bⱼ).
    fn isotropic_tangent(&self, of_law: &Sym4) -> GradientTangent {
        let q = &self.trial.directions;
        let r = rotation(&product(&q.transpose(), &self.frame));
        let mut own = of_gradients(&turned(&r, of_law));
        let b = self.trial.values.map(|b| 1.0 + b);
        for (k, m) in [(0, 1), (0, 2), (1, 2)] {
            let slope = logarithmic_slope(b[k], b[m]);
            own.column_mut(3 * k + m).scale_mut(slope * b[m]);
            own.column_mut(3 * m + k).scale_mut(slope * b[k]);
        }
        in_space(&own, q)
    }

    /// The same by any law, under the stress τ.
    fn turning_tangent(&self, of_law: &Sym4, stress: &Matrix3<f64>) -> GradientTangent {
        let q = rotation(&self.frame);
        let c = turned(&q, of_law);
        let turning = Turning::new(&self.stretch);
        let mut tangent = GradientTangent::zeros();
        for (k, m) in (0..3).flat_map(|k| (0..3).map(move |m| (k, m))) {
            // As the frame turns by Ω, what the law sees of the strain turns back, and the stress with the frame.
            let spin = turning.spin(k, m);
            let commutator = |a: &Matrix3<f64>| product(&spin, a) - product(a, &spin);
            let strain_rate = logarithmic_rate(&self.trial, k, m) - commutator(&self.strain);
            let rate = to_matrix(&(c * from_matrix(&strain_rate))) + commutator(stress);
            let column = SVector::<f64, 9>::from_fn(|ij, _| rate[(ij / 3, ij % 3)]);
            tangent.set_column(3 * k + m, &column);
        }
        tangent
    }
}

/// Outcome of a step at a point under large strains.
#[derive(Debug, Clone)]
pub struct LargeResponse {
    /// Kirchhoff stress τ = J σ at the end of the step \[MPa\].
    pub stress: Matrix3<f64>,
    /// Strain increment that the law has seen, in the frame of the end of the step.
    pub d_eps: Sym2,
    /// Its tangent, in that frame \[MPa\].
    pub law_tangent: Sym4,
    /// Whether plastic strain grows.
    pub flows: bool,
    step: LargeStep,
    is_isotropic: bool,
}

impl LargeResponse {
    /// ∂τ/∂l at the end of the step \[MPa\], of the gradient l = ∂v/∂x there, with a tangent of the law in the
    /// frame; where a dilatation was given, of a gradient whose trace is its rate.
    pub fn tangent(&self, of_law: &Sym4) -> GradientTangent {
        match self.is_isotropic {
            true => self.step.isotropic_tangent(of_law),
            false => self.step.turning_tangent(of_law, &self.stress),
        }
    }
}

/// Response of a law of small strain to a step of large ones, from the displacement gradient h = f − 1 of the
/// step with respect to the body at its start, and the state at its end.
///
/// The law sees logarithmic strains, and its stress is that of Kirchhoff. With the elastic strain e of the
/// state,
///
/// b = f exp(2e) fᵀ, e_trial = ½ ln b, f = V R,
///
/// the strain increment of the step is e_trial − R e Rᵀ, in the frame that turns by R. For an isotropic
/// law backward Euler is then exact in rotations, plastic flow keeps the volume if the law says so, and the
/// stress has the potential of the law, ΔV of the logarithmic strain. `dilatation` is ln(J₁/J₀) of the step
/// where the trace of the strain is not that of the point but a mean over its cell.
///
/// `None` where the step turns the point inside out, or is no number.
///
/// Nothing here subtracts numbers of order one: b − 1 and f − 1 are formed as such, and strains of 10⁻¹² keep
/// twelve digits.
///
/// Sources: J. C. Simo, *Computer Methods in Applied Mechanics and Engineering* 99 (1992) 61-112; G. Weber and
/// L. Anand, the same journal 79 (1990) 173-202; E. A. de Souza Neto, D. Perić and D. R. J. Owen,
/// *Computational Methods for Plasticity* (2008), chapter 14.
pub fn respond_large<L: BulkLaw>(
    law: &L,
    old: &Turned<L::State>,
    h: &Matrix3<f64>,
    dilatation: Option<f64>,
) -> Option<(LargeResponse, Turned<L::State>)> {
    let elastic = law.elastic_strain(&old.material);
    let step = LargeStep::new(&elastic, &old.frame, h, dilatation)?;
    let d_eps = step.increment(&elastic);
    let response = law.respond(&old.material, &d_eps);
    let state = Turned {
        material: response.state,
        frame: step.frame,
    };
    let response = LargeResponse {
        stress: to_matrix(&state.in_space(&response.stress)),
        d_eps,
        law_tangent: response.tangent,
        flows: response.flows,
        step,
        is_isotropic: law.is_isotropic(),
    };
    Some((response, state))
}

/// A tensor aᵢⱼₖₘ of the directions in the columns of q, in space.
fn in_space(a: &GradientTangent, q: &Matrix3<f64>) -> GradientTangent {
    let mut inner = [[Matrix3::zeros(); 3]; 3];
    for (i, k) in (0..3).flat_map(|i| (0..3).map(move |k| (i, k))) {
        let block: Matrix3<f64> = a.fixed_view::<3, 3>(3 * i, 3 * k).into();
        inner[i][k] = turned(q, &block);
    }
    let mut out = GradientTangent::zeros();
    for i in 0..3 {
        let row: [Matrix3<f64>; 3] = std::array::from_fn(|b| {
            inner[0][b] * q[(i, 0)] + inner[1][b] * q[(i, 1)] + inner[2][b] * q[(i, 2)]
        });
        for k in 0..3 {
            let block = row[0] * q[(k, 0)] + row[1] * q[(k, 1)] + row[2] * q[(k, 2)];
            out.fixed_view_mut::<3, 3>(3 * i, 3 * k).copy_from(&block);
        }
    }
    out
}

/// det(1 + h) − 1, without loss where h is small.
pub fn volume_change(h: &Matrix3<f64>) -> f64 {
    let trace = h.trace();
    let second = 0.5 * (trace * trace - product(h, h).trace());
    trace + second + h.determinant()
}

fn symmetric(a: &Matrix3<f64>) -> Matrix3<f64> {
    0.5 * (a + a.transpose())
}

/// ∂(½ ln b)/∂l for l = e_k ⊗ e_m and ḃ = l b + b lᵀ, from the spectrum of b − 1: in its directions
/// ½ (lᵢⱼ bⱼ + lⱼᵢ bᵢ) (ln bᵢ − ln bⱼ)/(bᵢ − bⱼ).
fn logarithmic_rate(trial: &Spectrum, k: usize, m: usize) -> Matrix3<f64> {
    let q = &trial.directions;
    let b = trial.values.map(|b| 1.0 + b);
    let l = |i: usize, j: usize| q[(k, i)] * q[(m, j)];
    let own = Matrix3::from_fn(|i, j| {
        0.5 * logarithmic_slope(b[i], b[j]) * (l(i, j) * b[j] + l(j, i) * b[i])
    });
    turned(q, &own)
}

/// R of f = V R, from V² − 1. In a plane it needs no V: R turns by the angle of (f₁₁ + f₂₂, f₂₁ − f₁₂).
fn rotation_of(f: &Matrix3<f64>, stretch: &Matrix3<f64>) -> Matrix3<f64> {
    let across = [f[(0, 2)], f[(1, 2)], f[(2, 0)], f[(2, 1)]];
    if across == [0.0; 4] && f[(2, 2)] > 0.0 {
        let (x, y) = (f[(0, 0)] + f[(1, 1)], f[(1, 0)] - f[(0, 1)]);
        let length = (x * x + y * y).sqrt();
        let (c, s) = (x / length, y / length);
        return Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
    }
    let inverse = Spectrum::new(stretch).map(|v| 1.0 / (1.0 + v).sqrt());
    product(&inverse, f)
}

/// How the rotation of a step changes.
#[derive(Debug, Clone)]
struct Turning {
    /// Principal values and directions of V.
    stretches: [f64; 3],
    directions: Matrix3<f64>,
}

impl Turning {
    /// From V² − 1.
    fn new(stretch: &Matrix3<f64>) -> Self {
        let spectrum = Spectrum::new(stretch);
        Self {
            stretches: spectrum.values.map(|v| (1.0 + v).sqrt()),
            directions: spectrum.directions,
        }
    }

    /// Ω = Ṙ Rᵀ for l = e_k ⊗ e_m: in the directions of V, (vⱼ lᵢⱼ − vᵢ lⱼᵢ)/(vᵢ + vⱼ).
    fn spin(&self, k: usize, m: usize) -> Matrix3<f64> {
        let (q, v) = (&self.directions, &self.stretches);
        let l = |i: usize, j: usize| q[(k, i)] * q[(m, j)];
        let own = Matrix3::from_fn(|i, j| (v[j] * l(i, j) - v[i] * l(j, i)) / (v[i] + v[j]));
        turned(q, &own)
    }
}
