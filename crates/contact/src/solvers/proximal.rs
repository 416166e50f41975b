//! The proximal point method around semismooth Newton, and Newton's method alone; not the maps that
//! Newton's method solves.

use super::elimination::Elimination;
use super::gauss_seidel::sweep;
use super::local::{Best, TOLERANCE, start};
use super::newton::{Run, newton};
use super::{LocalSolution, LocalSolver, NewtonMap, Reason, Tolerance, Unsolved};
use crate::{LocalProblem, Springs};
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
            tolerance: Tolerance::new(TOLERANCE, 200),
        }
    }
}

impl<const D: usize> LocalSolver<D> for Newton {
    fn tolerance(&self) -> f64 {
        self.tolerance.relative
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let from = start(problem, guess);
        let mut elimination = Elimination::new(problem.operator());
        let limit = self.tolerance.iterations;
        let run = newton(problem, self.map, &mut elimination, &from, tolerance, limit);
        let reason = if run.iterations == limit {
            Reason::Iterations
        } else if run.singular {
            Reason::Singular
        } else {
            Reason::Stalled
        };
        let best = LocalSolution::at(problem, run.force, run.iterations, "Newton");
        Best::new(best).judge(tolerance, reason)
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
            tolerance: Tolerance::new(TOLERANCE, 5_000),
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
    fn tolerance(&self) -> f64 {
        self.tolerance.relative
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        const NAME: &str = "proximal Newton";
        let limit = self.tolerance.iterations;
        let mut now = LocalSolution::at(problem, start(problem, guess), 0, NAME);
        let mut best = Best::new(now.clone());
        let mut path = Path {
            map: self.map,
            elimination: Elimination::new(problem.operator()),
            centre: now.force.clone(),
            factor: 1.0,
            stride: 1.0,
        };
        let (mut iterations, mut problems, mut idle) = (0, 0, 0);
        while best.size() > tolerance && iterations < limit && idle < PATIENCE {
            let size = now.residual.size();
            let target = (TARGET * size).min(1.0).max(0.3 * tolerance);
            let run = path.softened(problem, size, target);
            iterations += run.iterations.max(1);
            let reached = run.residual <= target;
            let next = LocalSolution::at(problem, run.force, iterations, NAME);
            path.advance(reached, &mut now, next);
            problems += 1;
            idle = best.take(now.clone(), problems);
        }
        best.point.iterations = iterations;
        let reason = if iterations >= limit {
            Reason::Iterations
        } else {
            Reason::Stalled
        };
        best.judge(tolerance, reason)
    }
}

/// The sequence of softened problems: where the next one is, and how soft.
struct Path<const D: usize> {
    map: NewtonMap,
    elimination: Option<Elimination<D>>,
    centre: Vec<Local<D>>,
    /// α over what follows from the residual.
    factor: f64,
    /// How far the centre runs ahead, in steps.
    stride: f64,
}

impl<const D: usize> Path<D> {
    /// Solves the problem softened about the centre to a target, or as well as may be.
    fn softened(&mut self, problem: &LocalProblem<D>, size: f64, target: f64) -> Run<D> {
        let Self {
            map,
            elimination,
            centre,
            factor,
            ..
        } = self;
        let alpha = (*factor * size.powf(SOFTNESS)).clamp(ALPHA[0], ALPHA[1]);
        let softened = problem.in_series(|i| Springs {
            compliance: Local::repeat(alpha * problem.compliance(i)),
            force: centre[i],
        });
        let mut run = newton(&softened, *map, elimination, centre, target, STEPS);
        if run.residual > target {
            for _ in 0..SWEEPS {
                if sweep(&softened, &mut run.force) < 0.01 * target {
                    break;
                }
            }
            *factor = (SOFTER * *factor).min(1.0 / f64::EPSILON);
        } else if run.iterations <= EASY {
            *factor = (HARDER * *factor).max(1.0);
        }
        run
    }

    /// Goes on from the solution of a softened problem, its target reached or not.
    fn advance(&mut self, reached: bool, now: &mut LocalSolution<D>, next: LocalSolution<D>) {
        let size = now.residual.size();
        let change = next.residual.size() / size;
        self.stride = if reached && size < NEAR && (0.5..2.0).contains(&change) {
            (STRIDE * self.stride).min(LONGEST)
        } else {
            1.0
        };
        // What is worse is kept only as the exact answer of a softened problem.
        if reached || change < 1.0 {
            let stride = self.stride;
            let ahead = |(r, before): (&Local<D>, &Local<D>)| r + (r - before) * (stride - 1.0);
            self.centre = next.force.iter().zip(&now.force).map(ahead).collect();
            *now = next;
        } else {
            self.centre.clone_from(&now.force);
        }
    }
}
