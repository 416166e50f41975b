//! The method that needs no choice: one method after the other, each from the best point so far.

use super::gauss_seidel::sweep;
use super::local::{Best, TOLERANCE, start};
use super::{
    Admm, GaussSeidel, LocalSolution, LocalSolver, NewtonMap, ProximalNewton, Reason, Tolerance,
    TrescaFixedPoint, Unsolved, Uzawa,
};
use crate::LocalProblem;
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
    fn tolerance(&self) -> f64 {
        self.tolerance
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let mut best = Best::new(sweeps(problem, start(problem, guess), tolerance));
        let mut attempts = Vec::new();
        let mut iterations = best.point.iterations;
        let mut last = best.point.force.clone();
        for (method, warm) in methods::<D>() {
            if best.size() <= tolerance {
                break;
            }
            let (point, reason) = match method.solve_to(problem, warm.then_some(&last), tolerance) {
                Ok(solution) => (solution, None),
                Err(failure) => (*failure.best, Some(failure.reason)),
            };
            iterations += point.iterations;
            if let Some(reason) = reason {
                attempts.push((point.solver, point.residual.size(), reason));
            }
            last.clone_from(&point.force);
            best.take(point, 0);
        }
        best.point.iterations = iterations;
        best.judge(tolerance, Reason::All(attempts))
    }
}

/// The methods after the sweeps, each from the point that the last one left, or where that has led nowhere
/// from nothing.
fn methods<const D: usize>() -> [(Box<dyn LocalSolver<D>>, bool); 8] {
    let cap = |iterations| Tolerance::new(TOLERANCE, iterations);
    let newton = |map, iterations| -> Box<dyn LocalSolver<D>> {
        Box::new(ProximalNewton {
            map,
            tolerance: cap(iterations),
        })
    };
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
    [
        (newton(NewtonMap::AlartCurnier, 3_000), true),
        (newton(NewtonMap::JeanMoreau, 500), true),
        (newton(NewtonMap::Natural, 500), true),
        (Box::new(admm), false),
        (newton(NewtonMap::AlartCurnier, 3_000), true),
        (Box::new(seidel), true),
        (Box::new(tresca), false),
        (Box::new(uzawa), true),
    ]
}

/// Sweeps until the tolerance is met or Newton's method promises to be faster.
fn sweeps<const D: usize>(
    problem: &LocalProblem<D>,
    mut r: Vec<Local<D>>,
    tolerance: f64,
) -> LocalSolution<D> {
    let size = |r: &[Local<D>]| problem.size(r, &problem.displacement(r));
    let (mut best, mut least) = (r.clone(), size(&r));
    let (mut sweeps, mut arrived) = (0, 0);
    while least > tolerance {
        for _ in 0..LOOK {
            sweeps += 1;
            if sweep(problem, &mut r) <= 0.1 * tolerance {
                break;
            }
        }
        let now = size(&r);
        let rate = (now / least).powf(1.0 / LOOK as f64);
        let left = (tolerance / now).ln() / rate.ln();
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
