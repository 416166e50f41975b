//! Block Gauss–Seidel with an exact local solver; not a relaxation that needs a parameter.

use super::{ContactSolution, ContactSolver, Tolerance};
use crate::{ContactError, ContactProblem, Delassus};
use moreau_laws::{Coulomb, Local};
use nalgebra::{DVector, SMatrix};

/// One contact at a time, on u = W t + q: the forces of all others are frozen, the local law is
/// solved exactly, sweep after sweep (the non-smooth contact dynamics method of Jean and Moreau).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussSeidel {
    /// When to stop; an iteration is a sweep over all contacts.
    pub tolerance: Tolerance,
}

impl Default for GaussSeidel {
    fn default() -> Self {
        Self { tolerance: Tolerance { relative: 1e-11, iterations: 200_000 } }
    }
}

impl<const D: usize> ContactSolver<D> for GaussSeidel {
    fn solve(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
    ) -> Result<ContactSolution<D>, ContactError> {
        let zero = vec![Local::zeros(); problem.contacts()];
        let start = guess.map_or(&zero, |g| &g.force);
        let solution = Self::run(problem, start, self.tolerance)?;
        let target = self.tolerance.relative * problem.force_scale(&solution.force);
        if solution.residual <= target {
            return Ok(solution);
        }
        Err(ContactError::NotConverged {
            solver: "Gauss-Seidel",
            iterations: solution.iterations,
            residual: solution.residual,
            tolerance: target,
        })
    }
}

impl GaussSeidel {
    /// A fixed number of sweeps, for a method that only wants to be near the solution.
    pub(super) fn sweeps<const D: usize>(
        problem: &ContactProblem<D>,
        start: &[Local<D>],
        sweeps: usize,
    ) -> Result<ContactSolution<D>, ContactError> {
        Self::run(problem, start, Tolerance { relative: 1e-12, iterations: sweeps })
    }

    fn run<const D: usize>(
        problem: &ContactProblem<D>,
        start: &[Local<D>],
        tolerance: Tolerance,
    ) -> Result<ContactSolution<D>, ContactError> {
        let Delassus { operator, free } = problem.delassus("Gauss-Seidel")?;
        let contacts = problem.contacts();
        let mut t: Vec<Local<D>> =
            start.iter().zip(problem.friction()).map(|(t, law)| law.project(t)).collect();
        let as_vector = |t: &[Local<D>]| {
            DVector::from_iterator(free.len(), t.iter().flat_map(|t| (0..D).map(|k| t[k])))
        };
        let mut u = &operator * as_vector(&t) + &free;
        let mut iterations = 0;
        loop {
            // Recompute: the updates below accumulate rounding over thousands of sweeps.
            if iterations % 20 == 0 {
                u = &operator * as_vector(&t) + &free;
            }
            let displacement = crate::problem::split(&u);
            let residual = problem.residual(&displacement, &t);
            if residual <= tolerance.relative * problem.force_scale(&t)
                || iterations >= tolerance.iterations
            {
                let status = problem.statuses(&displacement, &t);
                return Ok(ContactSolution {
                    irreversible: displacement.clone(),
                    displacement,
                    force: t,
                    status,
                    iterations,
                    residual,
                });
            }
            for i in 0..contacts {
                let own = operator.fixed_view::<D, D>(D * i, D * i).into_owned();
                let q = Local::<D>::from_fn(|k, _| u[D * i + k]) - own * t[i];
                let updated = local(&own, &q, &problem.friction()[i]);
                let change = updated - t[i];
                if change.norm() > 0.0 {
                    u += operator.fixed_columns::<D>(D * i) * change;
                    t[i] = updated;
                }
            }
            iterations += 1;
        }
    }
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
    let excess = |t: &Local<D>| (1..D).map(|k| t[k] * t[k]).sum::<f64>().sqrt() - mu * t[0];
    let Some(stick) = force(0.0) else { return Local::zeros() };
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
        let lambda =
            if secant > low + margin && secant < high - margin { secant } else { 0.5 * (low + high) };
        if lambda <= low || lambda >= high {
            break;
        }
        let Some(at) = force(lambda) else { break };
        t = at;
        let f = excess(&t);
        if f.abs() <= 4.0 * f64::EPSILON * mu * t[0].abs() {
            break;
        }
        if f > 0.0 { (low, f_low) = (lambda, f) } else { (high, f_high) = (lambda, f) }
    }
    // The root is found to rounding; the cone is met exactly.
    law.project(&t)
}
