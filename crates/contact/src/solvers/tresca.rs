//! The fixed point on Tresca's problem: friction of a given threshold, again and again; each of these
//! problems is convex.

use super::gauss_seidel::sweep_under;
use super::local::{Best, TOLERANCE, start};
use super::one_contact::Bound;
use super::{LocalSolution, LocalSolver, Reason, Tolerance, Unsolved};
use crate::LocalProblem;
use moreau_laws::{Friction, Local};

const NAME: &str = "Tresca fixed point";

/// Solves the problem with the thresholds g(r_n) of the forces found last, then updates them
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
            tolerance: Tolerance::new(TOLERANCE, 100_000),
        }
    }
}

/// Sweeps over one convex problem.
const SWEEPS: usize = 500;

/// Updates of the thresholds over which the residual must fall by a tenth.
const PATIENCE: usize = 200;

impl<const D: usize> LocalSolver<D> for TrescaFixedPoint {
    fn tolerance(&self) -> f64 {
        self.tolerance.relative
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let mut r = start(problem, guess);
        let mut best = Best::new(LocalSolution::at(problem, r.clone(), 0, NAME));
        let (mut sweeps, mut updates) = (0, 0);
        let mut reason = Reason::Iterations;
        let mut size = best.size();
        while best.size() > tolerance && sweeps < self.tolerance.iterations {
            let bound = |(law, r): (&Friction, &Local<D>)| {
                let (limit, _) = Bound::of(law).at(r[0].max(0.0));
                Bound::given(limit)
            };
            let bounds: Vec<Bound> = problem.laws().iter().zip(&r).map(bound).collect();
            for _ in 0..SWEEPS {
                sweeps += 1;
                if sweep_under(problem, |i| bounds[i], &mut r) <= 0.01 * size.max(tolerance) {
                    break;
                }
            }
            updates += 1;
            let now = LocalSolution::at(problem, r.clone(), sweeps, NAME);
            size = now.residual.size();
            if best.take(now, updates) > PATIENCE {
                reason = Reason::Stalled;
                break;
            }
        }
        best.judge(tolerance, reason)
    }
}
