//! The fixed point on Tresca's problem: friction of a given threshold, again and again; each of these
//! problems is convex.

use super::{
    LocalProblem, LocalSolution, LocalSolver, Reason, TOLERANCE, Unsolved, judge, one_contact,
    start,
};
use crate::Tolerance;
use moreau_laws::Local;

const NAME: &str = "Tresca fixed point";

/// Solves the problem with the thresholds g = μ r_n of the forces found last, then updates them
/// (P. D. Panagiotopoulos, *Ingenieur-Archiv* 44 (1975) 421-432). With g given the law is normal,
/// the problem a convex quadratic one that sweeps of Gauss–Seidel solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrescaFixedPoint {
    /// When to stop; iterations are sweeps.
    pub tolerance: Tolerance,
}

impl Default for TrescaFixedPoint {
    fn default() -> Self {
        Self {
            tolerance: Tolerance {
                relative: TOLERANCE,
                iterations: 100_000,
            },
        }
    }
}

/// Sweeps over one convex problem.
const SWEEPS: usize = 500;

/// Updates of the thresholds over which the residual must fall by a tenth.
const PATIENCE: usize = 200;

impl<const D: usize> LocalSolver<D> for TrescaFixedPoint {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let Tolerance {
            relative,
            iterations: limit,
        } = self.tolerance;
        let mut r = start(problem, guess);
        let mut best = LocalSolution::at(problem, r.clone(), 0, NAME);
        let (mut sweeps, mut idle) = (0, 0);
        let mut milestone = best.residual.size();
        let mut reason = Reason::Iterations;
        let mut size = best.residual.size();
        while best.residual.size() > relative && sweeps < limit {
            let thresholds: Vec<f64> = (problem.friction().iter().zip(&r))
                .map(|(law, r)| law.friction() * r[0].max(0.0))
                .collect();
            for _ in 0..SWEEPS {
                sweeps += 1;
                if sweep(problem, &thresholds, &mut r) <= 0.01 * size.max(relative) {
                    break;
                }
            }
            let now = LocalSolution::at(problem, r.clone(), sweeps, NAME);
            size = now.residual.size();
            if size < best.residual.size() {
                best = now;
            }
            idle += 1;
            if best.residual.size() < 0.9 * milestone {
                milestone = best.residual.size();
                idle = 0;
            } else if idle > PATIENCE {
                reason = Reason::Stalled;
                break;
            }
        }
        judge(best, relative, reason)
    }
}

/// One sweep with given thresholds; the relative change of the forces.
fn sweep<const D: usize>(problem: &LocalProblem<D>, thresholds: &[f64], r: &mut [Local<D>]) -> f64 {
    let (mut change, mut size) = (0.0, 0.0);
    for i in 0..r.len() {
        let own = problem.own(i);
        let q = problem.operator().row_times(i, r) + problem.free()[i] - own * r[i];
        let updated = one_contact::tresca(own, &q, thresholds[i]);
        change += (updated - r[i]).norm_squared();
        size += updated.norm_squared();
        r[i] = updated;
    }
    if change == 0.0 {
        0.0
    } else {
        (change / size).sqrt()
    }
}
