//! The proximal point method around semismooth Newton, and Newton's method alone; not the maps that
//! Newton's method solves.

use super::gauss_seidel::sweep;
use super::newton::{NewtonMap, Proximal, newton};
use super::{LocalProblem, LocalSolution, LocalSolver, Reason, TOLERANCE, Unsolved, judge, start};
use crate::Tolerance;
use moreau_laws::Local;

/// Semismooth Newton on u = W r + q with a nonmonotone line search; it needs a W that is regular on
/// the contacts that stick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// The equation that is solved.
    pub map: NewtonMap,
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Default for Newton {
    fn default() -> Self {
        Self {
            map: NewtonMap::default(),
            tolerance: Tolerance {
                relative: TOLERANCE,
                iterations: 200,
            },
        }
    }
}

impl<const D: usize> LocalSolver<D> for Newton {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let Tolerance {
            relative,
            iterations,
        } = self.tolerance;
        let from = start(problem, guess);
        let exact = Proximal {
            problem,
            alpha: 0.0,
            centre: &from,
        };
        let run = newton(&exact, self.map, &from, relative, iterations);
        let reason = if run.iterations == iterations {
            Reason::Iterations
        } else if run.singular {
            Reason::Singular
        } else {
            Reason::Stalled
        };
        let best = LocalSolution::at(problem, run.force, run.iterations, "Newton");
        judge(best, relative, reason)
    }
}

/// The proximal point method: a sequence of problems whose contacts are softened about the forces
/// found last, each solved by Newton's method and, where that fails, by sweeps of Gauss–Seidel.
///
/// The added compliance α |W_ii| makes the operator regular whatever the rank of W; it follows the
/// residual, so that the convergence remains faster than linear, and grows where Newton's method
/// fails, until sweeps contract.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProximalNewton {
    /// The equation that Newton's method solves.
    pub map: NewtonMap,
    /// When to stop; iterations are Newton steps.
    pub tolerance: Tolerance,
}

impl Default for ProximalNewton {
    fn default() -> Self {
        Self {
            map: NewtonMap::default(),
            tolerance: Tolerance {
                relative: TOLERANCE,
                iterations: 2_000,
            },
        }
    }
}

/// α over the residual.
const SOFTNESS: f64 = 5.0;

/// Bounds of α; below the least, rounding of W spoils the forces that W does not see.
const ALPHA: [f64; 2] = [1e-10, 10.0];

/// Newton steps of one softened problem.
const STEPS: usize = 20;

/// Sweeps where Newton's method fails.
const SWEEPS: usize = 50;

/// Softened problems in a row that may leave the residual where it is.
const PATIENCE: usize = 30;

impl<const D: usize> LocalSolver<D> for ProximalNewton {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let Tolerance {
            relative,
            iterations: limit,
        } = self.tolerance;
        let from = start(problem, guess);
        let mut now = LocalSolution::at(problem, from, 0, "proximal Newton");
        let mut best = now.clone();
        let (mut iterations, mut idle) = (0, 0);
        let mut growth = 1.0;
        while best.residual.scaled > relative && iterations < limit && idle < PATIENCE {
            let size = now.residual.scaled;
            let alpha = (growth * SOFTNESS * size).clamp(ALPHA[0], ALPHA[1]);
            let softened = Proximal {
                problem,
                alpha,
                centre: &now.force,
            };
            let target = (0.1 * size).min(1.0).max(0.3 * relative);
            let mut run = newton(&softened, self.map, &now.force, target, STEPS);
            iterations += run.iterations.max(1);
            let reached = run.residual <= target;
            if !reached {
                for _ in 0..SWEEPS {
                    if sweep(&softened, &mut run.force) < 0.01 * target {
                        break;
                    }
                }
            }
            now = LocalSolution::at(problem, run.force, iterations, "proximal Newton");
            growth = if reached {
                (0.2 * growth).max(1.0)
            } else {
                (4.0 * growth).min(1e8)
            };
            idle += 1;
            if now.residual.scaled < 0.9 * best.residual.scaled {
                idle = 0;
            }
            if now.residual.scaled < best.residual.scaled {
                best = now.clone();
            }
        }
        best.iterations = iterations;
        let reason = if iterations >= limit {
            Reason::Iterations
        } else {
            Reason::Stalled
        };
        judge(best, relative, reason)
    }
}
