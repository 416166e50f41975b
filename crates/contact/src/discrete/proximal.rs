//! The proximal point method around semismooth Newton, and Newton's method alone; not the maps that
//! Newton's method solves.

use super::elimination::Elimination;
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
        let mut elimination = Elimination::new(problem.operator());
        let run = newton(
            &exact,
            self.map,
            &mut elimination,
            &from,
            relative,
            iterations,
        );
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
/// The added compliance α |W_ii| makes the operator regular whatever the rank of W. It follows the
/// residual, so that the convergence remains faster than linear, and grows where Newton's method
/// fails. Where forces that W hardly sees have far to go, the centre runs ahead of them.
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
                iterations: 5_000,
            },
        }
    }
}

/// α is the residual to this power: less than one, because the forces of a softened problem move by
/// much more than their residual, more than one half, for α has to vanish fast.
const SOFTNESS: f64 = 0.75;

/// Bounds of α; below the least, rounding of W spoils the forces that W does not see.
const ALPHA: [f64; 2] = [1e-10, 10.0];

/// Newton steps of one softened problem, and how many of them make the next one less soft.
const STEPS: usize = 30;
const EASY: usize = 8;

/// Factors on α after a failure and after an easy problem.
const SOFTER: f64 = 4.0;
const HARDER: f64 = 0.5;

/// Sweeps where Newton's method fails, one of whose steps takes about as long as two of them.
const SWEEPS: usize = 10;

/// Part of the residual that a softened problem may leave.
const TARGET: f64 = 0.3;

/// Residual below which the centre may run ahead, by how much more at each problem that leaves the
/// residual about the same, and how far at most.
const NEAR: f64 = 1e-3;
const STRIDE: f64 = 1.5;
const LONGEST: f64 = 10.0;

/// Softened problems over which the residual must fall by a tenth.
const PATIENCE: usize = 300;

impl<const D: usize> LocalSolver<D> for ProximalNewton {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        const NAME: &str = "proximal Newton";
        let Tolerance {
            relative,
            iterations: limit,
        } = self.tolerance;
        let mut now = LocalSolution::at(problem, start(problem, guess), 0, NAME);
        let mut best = now.clone();
        let mut centre = now.force.clone();
        let (mut iterations, mut idle, mut milestone) = (0, 0, best.residual.size());
        let mut elimination = Elimination::new(problem.operator());
        let (mut factor, mut stride) = (1.0, 1.0);
        while best.residual.size() > relative && iterations < limit && idle < PATIENCE {
            let size = now.residual.size();
            let softened = Proximal {
                problem,
                alpha: (factor * size.powf(SOFTNESS)).clamp(ALPHA[0], ALPHA[1]),
                centre: &centre,
            };
            let target = (TARGET * size).clamp(0.3 * relative, 1.0);
            let mut run = newton(
                &softened,
                self.map,
                &mut elimination,
                &centre,
                target,
                STEPS,
            );
            iterations += run.iterations.max(1);
            let reached = run.residual <= target;
            if !reached {
                for _ in 0..SWEEPS {
                    if sweep(&softened, &mut run.force) < 0.01 * target {
                        break;
                    }
                }
                factor = (SOFTER * factor).min(1.0 / f64::EPSILON);
            } else if run.iterations <= EASY {
                factor = (HARDER * factor).max(1.0);
            }
            let next = LocalSolution::at(problem, run.force, iterations, NAME);
            let change = next.residual.size() / size;
            stride = if reached && size < NEAR && (0.5..2.0).contains(&change) {
                (STRIDE * stride).min(LONGEST)
            } else {
                1.0
            };
            // What is worse is kept only as the exact answer of a softened problem.
            if reached || change < 1.0 {
                let ahead = |(r, before): (&Local<D>, &Local<D>)| r + (r - before) * (stride - 1.0);
                centre = next.force.iter().zip(&now.force).map(ahead).collect();
                now = next;
            } else {
                centre.clone_from(&now.force);
            }
            if now.residual.size() < best.residual.size() {
                best = now.clone();
            }
            idle += 1;
            if best.residual.size() < 0.9 * milestone {
                milestone = best.residual.size();
                idle = 0;
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
