//! Uzawa's projection on the admissible forces, \[85\]–\[90′\]; not the nesting around the bulk solve.

use super::fixed_point::fixed_point;
use super::local::{Best, LocalSolver, Reason, Unsolved, start};
use super::{
    ContactSolution, ContactSolver, Goal, LocalSolution, Tolerance, expect_enough, forces,
};
use crate::problem::{split, stack};
use crate::{CondensedProblem, ContactError, LocalProblem};
use moreau_laws::Local;
use nalgebra::DVector;

const NAME: &str = "Uzawa";

/// Prediction t̂ = t − α ũ and correction t = proj(t̂) on u = W t + q, accelerated.
///
/// α is the inverse of the largest eigenvalue of W in the scaling that gives every contact a unit
/// diagonal, over √(1 + μ²) for the slope of ũ: there is no number to choose. Near a limit load W has
/// eigenvalues of very unlike size, on which the plain scheme takes 10⁵ corrections and more;
/// Anderson's extrapolation brings them down to some hundreds and leaves the fixed point what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uzawa {
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Default for Uzawa {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::new(1e-10, 200_000),
        }
    }
}

impl<const D: usize> ContactSolver<D> for Uzawa {
    fn approach(
        &self,
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let enough = expect_enough(enough)?;
        let form = problem.delassus()?;
        let mut goal = Goal::new(problem, self.tolerance, enough);
        Self::corrections(&form, forces(&form, guess)?, |k, t, u| {
            goal.judge(NAME, k, t, u)
        })
    }
}

impl Uzawa {
    /// Corrections on u = W t + q until `judge` ends them.
    pub(super) fn corrections<const D: usize, E>(
        form: &LocalProblem<D>,
        start: Vec<Local<D>>,
        judge: impl FnMut(usize, &[Local<D>], &[Local<D>]) -> Option<E>,
    ) -> E {
        let alpha = steps(form);
        let correct = |t: Vec<Local<D>>| -> Vec<Local<D>> {
            let u = form.displacement(&t);
            let corrected = |i: usize| form.laws()[i].correct(&u[i], &t[i], alpha[i]);
            (0..t.len()).map(corrected).collect()
        };
        fixed_point(form, start, correct, judge)
    }
}

/// Corrections over which the residual must fall by a tenth.
const PATIENCE: usize = 5_000;

impl<const D: usize> LocalSolver<D> for Uzawa {
    fn tolerance(&self) -> f64 {
        self.tolerance.relative
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let start = start(problem, guess);
        let mut best = Best::new(LocalSolution::at(problem, start.clone(), 0, NAME));
        let limit = self.tolerance.iterations;
        if best.size() <= tolerance || limit == 0 {
            return best.judge(tolerance, Reason::Iterations);
        }
        let reason = Self::corrections(problem, start, |before, t, _| {
            let iterations = before + 1;
            let now = LocalSolution::at(problem, t.to_vec(), iterations, NAME);
            let idle = best.take(now, iterations);
            if idle > PATIENCE {
                return Some(Reason::Stalled);
            }
            (best.size() <= tolerance || iterations == limit).then_some(Reason::Iterations)
        });
        best.judge(tolerance, reason)
    }
}

/// Steps α of Uzawa's correction for a problem, one per contact \[N/mm\].
///
/// # Errors
/// [`ContactError::Floating`] if the stiffness is singular.
pub fn uzawa_steps<const D: usize>(
    problem: &CondensedProblem<D>,
) -> Result<Vec<f64>, ContactError> {
    Ok(steps(&problem.delassus()?))
}

/// α per contact: the inverse of the mean diagonal of W_ii over the largest eigenvalue of the operator so
/// scaled, by power iteration.
fn steps<const D: usize>(problem: &LocalProblem<D>) -> Vec<f64> {
    let contacts = problem.contacts();
    let scale: Vec<f64> = (0..contacts)
        .map(|i| D as f64 / problem.own(i).trace())
        .collect();
    // Not symmetric about anything a structure would be symmetric about.
    let entry = |i: usize, _| 1.0 + 0.3 * ((i * i) as f64 * 0.7).sin();
    let mut v = DVector::from_fn(D * contacts, entry);
    let mut largest = 1.0;
    for _ in 0..60 {
        let seen = split(&v);
        let scaled = |i: usize| problem.operator().row_times(i, &seen) * scale[i];
        let w = stack(&(0..contacts).map(scaled).collect::<Vec<_>>());
        largest = w.norm() / v.norm();
        v = w / largest;
    }
    // Friction adds μ‖u_t‖ to the normal displacement: its slope enters the Lipschitz constant.
    let slope = |i: usize| (1.0 + problem.laws()[i].coefficient().powi(2)).sqrt();
    (0..contacts)
        .map(|i| scale[i] / (1.05 * largest * slope(i)))
        .collect()
}
