//! Block Gauss–Seidel with an exact local solver; not a relaxation that needs a parameter.

use super::{ContactSolution, ContactSolver, Tolerance, fixed_point};
use crate::problem::{split, stack};
use crate::{ContactError, ContactProblem, Delassus};
use moreau_laws::{Friction, Local};
use nalgebra::{DVector, SMatrix};

/// One contact at a time, on u = W t + q: the forces of all others are frozen, the local law is
/// solved exactly, sweep after sweep (the non-smooth contact dynamics method of Jean and Moreau),
/// with Anderson's extrapolation between the sweeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussSeidel {
    /// When to stop; an iteration is a sweep over all contacts.
    pub tolerance: Tolerance,
}

impl Default for GaussSeidel {
    fn default() -> Self {
        Self {
            tolerance: Tolerance {
                relative: 1e-10,
                iterations: 200_000,
            },
        }
    }
}

impl<const D: usize> ContactSolver<D> for GaussSeidel {
    fn approach(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let form = problem.delassus("Gauss-Seidel")?;
        let start = guess.map_or_else(|| DVector::zeros(form.free.len()), |g| stack(&g.force));
        self.sweeps(problem, &form, start, enough)
    }
}

impl GaussSeidel {
    /// Solves u = W t + q for a form that need not be that of the problem.
    pub(super) fn sweeps<const D: usize>(
        &self,
        problem: &ContactProblem<D>,
        form: &Delassus<D>,
        start: DVector<f64>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let swept = |t: &DVector<f64>| sweep(problem, form, t);
        fixed_point(
            "Gauss-Seidel",
            problem,
            form,
            start,
            (self.tolerance, enough),
            swept,
        )
    }
}

/// One sweep over all contacts.
fn sweep<const D: usize>(
    problem: &ContactProblem<D>,
    Delassus { operator, free }: &Delassus<D>,
    start: &DVector<f64>,
) -> Vec<Local<D>> {
    let mut t: Vec<Local<D>> = split(start);
    let mut u = operator * start + free;
    for (i, law) in problem.friction().iter().enumerate() {
        let own = operator.fixed_view::<D, D>(D * i, D * i).into_owned();
        let q = Local::<D>::from_fn(|k, _| u[D * i + k]) - own * t[i];
        let updated = local(&own, &q, law);
        let change = updated - t[i];
        if change.norm() > 0.0 {
            u += operator.fixed_columns::<D>(D * i) * change;
            t[i] = updated;
        }
    }
    t
}

/// Exact force of a single contact u = W t + q: opens if it may, else sticks if the bound of the
/// shear allows, else slips. Slip −u_t = λ t_t leaves one monotone scalar equation in λ ≥ 0.
fn local<const D: usize>(w: &SMatrix<f64, D, D>, q: &Local<D>, law: &Friction) -> Local<D> {
    // Between stretched vectors the law is isotropic.
    let (m, law): (Local<D>, _) = (law.stretch(), law.isotropic());
    let w = SMatrix::<f64, D, D>::from_fn(|k, l| m[k] * w[(k, l)] * m[l]);
    let q = q.component_mul(&m);
    // Eliminate t_n from u_n = 0; what is left of W on the tangent is its Schur complement.
    let mut schur = SMatrix::<f64, D, D>::identity();
    let mut rhs = Local::<D>::zeros();
    for k in 1..D {
        for l in 1..D {
            schur[(k, l)] = w[(k, l)] - w[(k, 0)] * w[(0, l)] / w[(0, 0)];
        }
        rhs[k] = -q[k] + w[(k, 0)] * q[0] / w[(0, 0)];
    }
    let pressed = |t: &mut Local<D>| {
        t[0] = -(q[0] + (1..D).map(|k| w[(0, k)] * t[k]).sum::<f64>()) / w[(0, 0)];
    };
    let mut t = Local::zeros();
    if law.bound(0.0) > 0.0 {
        // Slip is resisted without pressure: open, unless friction closes the gap.
        let mut free = w;
        let mut pull = -q;
        free.fill_row(0, 0.0);
        free.fill_column(0, 0.0);
        free[(0, 0)] = 1.0;
        pull[0] = 0.0;
        t = bounded((&free, &pull), (&w, &q), &law, |t| t[0] = 0.0);
        if q[0] + (1..D).map(|k| w[(0, k)] * t[k]).sum::<f64>() < 0.0 {
            t = bounded((&schur, &rhs), (&w, &q), &law, pressed);
        }
    } else if q[0] < 0.0 && law.resists_slip() {
        t = bounded((&schur, &rhs), (&w, &q), &law, pressed);
    } else if q[0] < 0.0 {
        t[0] = -q[0] / w[(0, 0)];
    }
    t.component_mul(&m)
}

/// The force of shear (A + λ)⁻¹ b with the least λ ≥ 0 for which the law admits it, and of the
/// pressure that follows from the shear.
fn bounded<const D: usize>(
    (a, b): (&SMatrix<f64, D, D>, &Local<D>),
    (w, q): (&SMatrix<f64, D, D>, &Local<D>),
    law: &Friction,
    pressed: impl Fn(&mut Local<D>),
) -> Local<D> {
    let force = |lambda: f64| -> Option<Local<D>> {
        let mut a = *a;
        for k in 1..D {
            a[(k, k)] += lambda;
        }
        let mut t = a.try_inverse()? * b;
        pressed(&mut t);
        Some(t)
    };
    let excess = |t: &Local<D>| (1..D).map(|k| t[k] * t[k]).sum::<f64>().sqrt() - law.bound(t[0]);
    let Some(stick) = force(0.0) else {
        return Local::zeros();
    };
    if excess(&stick) <= 0.0 {
        return stick;
    }
    if D == 2 {
        return edge(b[1].signum(), w, q, law, pressed);
    }
    // excess > 0 at λ = 0 and ≤ 0 at λ = ∞: bracket the root, then bisect with secant steps where
    // they stay inside.
    let mean = (1..D).map(|k| a[(k, k)]).sum::<f64>() / (D.max(2) - 1) as f64;
    let (mut low, mut high) = (0.0, mean);
    let mut t = stick;
    for _ in 0..200 {
        match force(high) {
            Some(at) if excess(&at) > 0.0 => (low, high) = (high, 4.0 * high),
            Some(at) => {
                t = at;
                break;
            }
            None => break,
        }
    }
    let (mut f_low, mut f_high) = (force(low).map_or(0.0, |t| excess(&t)), excess(&t));
    for _ in 0..200 {
        let secant = high - f_high * (high - low) / (f_high - f_low);
        let margin = 1e-3 * (high - low);
        let lambda = if secant > low + margin && secant < high - margin {
            secant
        } else {
            0.5 * (low + high)
        };
        if lambda <= low || lambda >= high {
            break;
        }
        let Some(at) = force(lambda) else { break };
        t = at;
        let f = excess(&t);
        if f.abs() <= 4.0 * f64::EPSILON * law.bound(t[0]).abs() {
            break;
        }
        if f > 0.0 {
            (low, f_low) = (lambda, f)
        } else {
            (high, f_high) = (lambda, f)
        }
    }
    // The root is found to rounding; the bound is met exactly.
    law.project(&t)
}

/// The force on the edge t_t = σ g(t_n) of a plane law of any bound. There u_n is convex or concave in
/// t_n: Newton's method from where it is positive converges from one side. Where it never is, the contact
/// wedges, and there is no such force.
fn curved_edge<const D: usize>(
    side: f64,
    w: &SMatrix<f64, D, D>,
    q: &Local<D>,
    law: &Friction,
    pressed: impl Fn(&mut Local<D>),
) -> Local<D> {
    let mut slip = Local::zeros();
    slip[1] = side * law.bound(0.0);
    pressed(&mut slip);
    if slip[0] <= 0.0 {
        slip[0] = 0.0;
        return slip;
    }
    let normal = |t_n: f64| q[0] + w[(0, 0)] * t_n + side * w[(0, 1)] * law.bound(t_n);
    let mut t_n = slip[0];
    for _ in 0..100 {
        if normal(t_n) > 0.0 {
            break;
        }
        t_n *= 2.0;
    }
    for _ in 0..100 {
        let stiffness = w[(0, 0)] + side * w[(0, 1)] * law.slope(t_n);
        let next = (t_n - normal(t_n) / stiffness).max(0.0);
        if stiffness <= 0.0 || !next.is_finite() {
            return Local::zeros();
        }
        let moved = (next - t_n).abs();
        t_n = next;
        if moved <= f64::EPSILON * next {
            break;
        }
    }
    slip[0] = t_n;
    slip[1] = side * law.bound(t_n);
    slip
}

/// The force on the edge t_t = σ g(t_n) of a plane law, where u_n = 0 is linear.
fn edge<const D: usize>(
    side: f64,
    w: &SMatrix<f64, D, D>,
    q: &Local<D>,
    law: &Friction,
    pressed: impl Fn(&mut Local<D>),
) -> Local<D> {
    if let Friction::Bounded(_) = law {
        return curved_edge(side, w, q, law, pressed);
    }
    let (mu, limit) = (law.friction(), law.bound(f64::INFINITY));
    let mut slip = Local::zeros();
    let stiffness = w[(0, 0)] + side * mu * w[(0, 1)];
    // Without a positive stiffness the contact wedges: no slipping force exists on the cone.
    let cone = mu > 0.0 && stiffness > 0.0;
    if cone {
        slip[0] = -q[0] / stiffness;
        slip[1] = side * mu * slip[0];
    }
    if limit.is_finite() && (!cone || slip[1].abs() > limit) {
        slip[1] = side * limit;
        pressed(&mut slip);
    }
    slip
}
