//! The method that needs no choice: one method after the other, each from the best point so far.

use super::gauss_seidel::sweep;
use super::newton::{NewtonMap, Proximal};
use super::{
    Admm, LocalProblem, LocalSolution, LocalSolver, ProximalNewton, Reason, TOLERANCE,
    TrescaFixedPoint, Unsolved, judge, start,
};
use crate::{GaussSeidel, Tolerance, Uzawa};
use moreau_laws::Local;

/// Sweeps of Gauss–Seidel as long as they converge fast, then the proximal Newton method, then
/// others from elsewhere, until one arrives. There is no number to choose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Auto {
    /// Residual at which it stops.
    pub tolerance: f64,
}

impl Default for Auto {
    fn default() -> Self {
        Self {
            tolerance: TOLERANCE,
        }
    }
}

/// Sweeps between two looks at the residual.
const LOOK: usize = 5;

/// Sweeps that are worth about as much as Newton's method from where they are.
const WORTH: f64 = 40.0;

impl<const D: usize> LocalSolver<D> for Auto {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let mut best = self.sweeps(problem, start(problem, guess));
        let mut attempts = Vec::new();
        let mut iterations = best.iterations;
        let cap = |iterations| Tolerance {
            relative: self.tolerance,
            iterations,
        };
        let newton = |map, iterations| ProximalNewton {
            map,
            tolerance: cap(iterations),
        };
        let (alart, jean, natural) = (
            newton(NewtonMap::AlartCurnier, 3_000),
            newton(NewtonMap::JeanMoreau, 500),
            newton(NewtonMap::Natural, 500),
        );
        let admm = Admm {
            tolerance: cap(3_000),
        };
        let seidel = GaussSeidel {
            tolerance: cap(3_000),
        };
        let tresca = TrescaFixedPoint {
            tolerance: cap(5_000),
        };
        let uzawa = Uzawa {
            tolerance: cap(3_000),
        };
        // From the best point, or where that has led nowhere from nothing.
        let methods: [(&dyn LocalSolver<D>, bool); 8] = [
            (&alart, true),
            (&jean, true),
            (&natural, true),
            (&admm, false),
            (&alart, true),
            (&seidel, true),
            (&tresca, false),
            (&uzawa, true),
        ];
        let mut last = best.force.clone();
        for (method, warm) in methods {
            if best.residual.size() <= self.tolerance {
                break;
            }
            let (point, reason) = match method.solve(problem, warm.then_some(&last)) {
                Ok(solution) => (solution, None),
                Err(failure) => (*failure.best, Some(failure.reason)),
            };
            iterations += point.iterations;
            if let Some(reason) = reason {
                attempts.push((point.solver, point.residual.size(), reason));
            }
            last.clone_from(&point.force);
            if point.residual.size() < best.residual.size() {
                best = point;
            }
        }
        best.iterations = iterations;
        judge(best, self.tolerance, Reason::All(attempts))
    }
}

impl Auto {
    /// Sweeps until the tolerance is met or Newton's method promises to be faster.
    fn sweeps<const D: usize>(
        &self,
        problem: &LocalProblem<D>,
        mut r: Vec<Local<D>>,
    ) -> LocalSolution<D> {
        let exact = Proximal {
            problem,
            alpha: 0.0,
            centre: &r.clone(),
        };
        let size = |r: &[Local<D>]| problem.size(r, &problem.displacement(r));
        let (mut best, mut least) = (r.clone(), size(&r));
        let (mut sweeps, mut arrived) = (0, 0);
        while least > self.tolerance {
            for _ in 0..LOOK {
                sweeps += 1;
                if sweep(&exact, &mut r) <= 0.1 * self.tolerance {
                    break;
                }
            }
            let now = size(&r);
            let rate = (now / least).powf(1.0 / LOOK as f64);
            let left = (self.tolerance / now).ln() / rate.ln();
            if now < least {
                best.clone_from(&r);
                (least, arrived) = (now, sweeps);
            }
            // The first sweeps find out what is open; they are not typical.
            if sweeps > 2 * LOOK && !(rate < 1.0 && left < WORTH) {
                break;
            }
        }
        LocalSolution::at(problem, best, arrived, "Gauss-Seidel")
    }
}
