//! Block Gauss–Seidel with an exact local solver; not a relaxation that needs a parameter.

use super::{ContactSolution, ContactSolver, Tolerance, fixed_point};
use crate::problem::{split, stack};
use crate::{ContactError, ContactProblem, Delassus};
use moreau_laws::{Coulomb, Local};
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
    fn solve(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
    ) -> Result<ContactSolution<D>, ContactError> {
        let form = problem.delassus("Gauss-Seidel")?;
        let start = guess.map_or_else(|| DVector::zeros(form.free.len()), |g| stack(&g.force));
        self.sweeps(problem, &form, start)
    }
}

impl GaussSeidel {
    /// Solves u = W t + q for a form that need not be that of the problem.
    pub(super) fn sweeps<const D: usize>(
        &self,
        problem: &ContactProblem<D>,
        form: &Delassus<D>,
        start: DVector<f64>,
    ) -> Result<ContactSolution<D>, ContactError> {
        let swept = |t: &DVector<f64>| sweep(problem, form, t);
        fixed_point("Gauss-Seidel", problem, form, start, self.tolerance, swept)
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

/// Exact force of a single contact u = W t + q: opens if it may, else sticks if the cone allows,
/// else slips. Slip −u_t = λ t_t leaves one monotone scalar equation in λ ≥ 0.
fn local<const D: usize>(w: &SMatrix<f64, D, D>, q: &Local<D>, law: &Coulomb) -> Local<D> {
    if q[0] >= 0.0 {
        return Local::zeros();
    }
    let mu = law.friction();
    if mu == 0.0 {
        let mut t = Local::zeros();
        t[0] = -q[0] / w[(0, 0)];
        return t;
    }
    // Eliminate t_n from u_n = 0; what is left of W on the tangent is its Schur complement.
    let mut schur = SMatrix::<f64, D, D>::identity();
    let mut rhs = Local::<D>::zeros();
    for k in 1..D {
        for l in 1..D {
            schur[(k, l)] = w[(k, l)] - w[(k, 0)] * w[(0, l)] / w[(0, 0)];
        }
        rhs[k] = -q[k] + w[(k, 0)] * q[0] / w[(0, 0)];
    }
    let force = |lambda: f64| -> Option<Local<D>> {
        let mut a = schur;
        for k in 1..D {
            a[(k, k)] += lambda;
        }
        let mut t = a.try_inverse()? * rhs;
        t[0] = -(q[0] + (1..D).map(|k| w[(0, k)] * t[k]).sum::<f64>()) / w[(0, 0)];
        Some(t)
    };
    if D == 2 {
        let Some(stick) = force(0.0) else {
            return Local::zeros();
        };
        if stick[1].abs() <= mu * stick[0] {
            return stick;
        }
        // On the edge t_t = σ μ t_n of the cone the equation u_n = 0 is linear.
        let side = rhs[1].signum();
        let stiffness = w[(0, 0)] + side * mu * w[(0, 1)];
        let mut slip = Local::zeros();
        // Without a positive stiffness the contact wedges: no slipping force exists.
        if stiffness > 0.0 {
            slip[0] = -q[0] / stiffness;
            slip[1] = side * mu * slip[0];
        }
        return slip;
    }
    let excess = |t: &Local<D>| (1..D).map(|k| t[k] * t[k]).sum::<f64>().sqrt() - mu * t[0];
    let Some(stick) = force(0.0) else {
        return Local::zeros();
    };
    if excess(&stick) <= 0.0 {
        return stick;
    }
    // excess > 0 at λ = 0 and → μ q_n / W_nn ≤ 0 at λ = ∞: bracket the root, then bisect on a
    // logarithmic scale with secant steps where they stay inside.
    let mean = (1..D).map(|k| schur[(k, k)]).sum::<f64>() / (D.max(2) - 1) as f64;
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
        if f.abs() <= 4.0 * f64::EPSILON * mu * t[0].abs() {
            break;
        }
        if f > 0.0 {
            (low, f_low) = (lambda, f)
        } else {
            (high, f_high) = (lambda, f)
        }
    }
    // The root is found to rounding; the cone is met exactly.
    law.project(&t)
}
