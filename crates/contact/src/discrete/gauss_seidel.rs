//! Block Gauss–Seidel on the local form; not on the condensed problem of the driver.

use super::newton::Proximal;
use super::one_contact;
use super::{LocalProblem, LocalSolution, LocalSolver, Reason, Unsolved, judge, start};
use crate::GaussSeidel;
use moreau_laws::Local;

const NAME: &str = "Gauss-Seidel";

/// Sweeps between two looks at the residual, which costs as much as a sweep.
const LOOK: usize = 8;

/// Sweeps over which the residual must fall by a tenth.
const PATIENCE: usize = 2_000;

impl<const D: usize> LocalSolver<D> for GaussSeidel {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let mut r = start(problem, guess);
        let (tolerance, limit) = (self.tolerance.relative, self.tolerance.iterations);
        let mut best = LocalSolution::at(problem, r.clone(), 0, NAME);
        let exact = Proximal {
            problem,
            alpha: 0.0,
            centre: &r.clone(),
        };
        let mut milestone = (0, best.residual.size());
        // R. P. Brent's search for a cycle: iterates against one of the past.
        let (mut past, mut since, mut span) = (r.clone(), 0, 1);
        let mut reason = Reason::Iterations;
        for sweeps in 1..=limit {
            if best.residual.size() <= tolerance {
                break;
            }
            let change = sweep(&exact, &mut r);
            since += 1;
            if sweeps % LOOK == 0 || change <= tolerance {
                let now = LocalSolution::at(problem, r.clone(), sweeps, NAME);
                if now.residual.size() < best.residual.size() {
                    best = now;
                }
                if best.residual.size() < 0.9 * milestone.1 {
                    milestone = (sweeps, best.residual.size());
                } else if sweeps > milestone.0 + PATIENCE {
                    reason = Reason::Stalled;
                    break;
                }
            }
            let size: f64 = r.iter().map(|r| r.norm_squared()).sum();
            let far: f64 = r
                .iter()
                .zip(&past)
                .map(|(r, p)| (r - p).norm_squared())
                .sum();
            if far <= (f64::EPSILON * f64::EPSILON) * size && best.residual.size() > tolerance {
                reason = if since == 1 {
                    Reason::Stalled
                } else {
                    Reason::Cycling { period: since }
                };
                break;
            }
            if since == span {
                past.clone_from(&r);
                (since, span) = (0, 2 * span);
            }
        }
        judge(best, tolerance, reason)
    }
}

/// One sweep over all contacts, the forces of all others frozen; the relative change of the forces.
pub(super) fn sweep<const D: usize>(problem: &Proximal<D>, r: &mut [Local<D>]) -> f64 {
    let p = problem.problem;
    let (mut change, mut size) = (0.0, 0.0);
    for i in 0..r.len() {
        let mut own = *p.own(i);
        for k in 0..D {
            own[(k, k)] += problem.spring(i);
        }
        let q = problem.displacement_at(i, r) - own * r[i];
        let updated = one_contact::solve(&own, &q, &p.friction()[i], &r[i]);
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
