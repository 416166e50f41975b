//! Uzawa's projection on the local form; not on the condensed problem of the driver.

use super::{LocalProblem, LocalSolution, LocalSolver, Reason, Unsolved, judge, start};
use crate::Uzawa;
use crate::problem::{split, stack};
use crate::solvers::Anderson;
use moreau_laws::Local;

const NAME: &str = "Uzawa";

/// Corrections over which the residual must fall by a tenth.
const PATIENCE: usize = 5_000;

impl<const D: usize> LocalSolver<D> for Uzawa {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let alpha = steps(problem);
        let mut anderson = Anderson::default();
        let mut t = start(problem, guess);
        let mut best = LocalSolution::at(problem, t.clone(), 0, NAME);
        let mut milestone = (0, best.residual.size());
        let mut u = best.displacement.clone();
        let mut reason = Reason::Iterations;
        for iterations in 1..=self.tolerance.iterations {
            if best.residual.size() <= self.tolerance.relative {
                break;
            }
            let image: Vec<Local<D>> = (0..t.len())
                .map(|i| {
                    let law = &problem.friction()[i];
                    law.project(&(t[i] - law.shifted(&u[i]) * alpha[i]))
                })
                .collect();
            let now = LocalSolution::at(problem, image, iterations, NAME);
            t = split(&anderson.next(&stack(&t), stack(&now.force)));
            u = problem.displacement(&t);
            if now.residual.size() < best.residual.size() {
                best = now;
            }
            if best.residual.size() < 0.9 * milestone.1 {
                milestone = (iterations, best.residual.size());
            } else if iterations > milestone.0 + PATIENCE {
                reason = Reason::Stalled;
                break;
            }
        }
        judge(best, self.tolerance.relative, reason)
    }
}

/// Steps per contact: 1/|W_ii| over the largest eigenvalue of the operator so scaled, by power
/// iteration, and over the slope √(1 + μ²) of ũ.
fn steps<const D: usize>(problem: &LocalProblem<D>) -> Vec<f64> {
    // Not symmetric about anything a structure would be symmetric about.
    let value = |i: usize, k: usize| 1.0 + 0.3 * (((D * i + k).pow(2)) as f64 * 0.7).sin();
    let contacts = problem.contacts();
    let mut v: Vec<Local<D>> = (0..contacts)
        .map(|i| Local::from_fn(|k, _| value(i, k)))
        .collect();
    let norm = |v: &[Local<D>]| v.iter().map(|v| v.norm_squared()).sum::<f64>().sqrt();
    let mut largest = 1.0;
    for _ in 0..60 {
        let times: Vec<Local<D>> = (0..contacts)
            .map(|i| problem.operator().row_times(i, &v) / problem.compliance(i))
            .collect();
        largest = norm(&times) / norm(&v);
        v = times.iter().map(|t| t / largest).collect();
    }
    let slope = |i: usize| 1f64.hypot(problem.friction()[i].friction());
    (0..contacts)
        .map(|i| 1.0 / (1.05 * largest * slope(i) * problem.compliance(i)))
        .collect()
}
