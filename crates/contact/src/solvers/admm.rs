//! The alternating direction method of multipliers on the local form; not a descent method: it needs
//! no good start.

use super::local::{Best, TOLERANCE, start};
use super::{LocalSolution, LocalSolver, Reason, Tolerance, Unsolved};
use crate::Springs;
use crate::problem::{Factor, LocalProblem};
use moreau_laws::{Friction, Local};

const NAME: &str = "ADMM";

/// ADMM on min ½ r·W r + r·(q + s) over the cones, s_n = μ|u_t| following the iterates: the fixed
/// point of V. Acary, F. Cadoux, C. Lemaréchal and J. Malick (*ZAMM* 91 (2011) 155-175) with its
/// convex problems cut short after one step.
///
/// One factorisation of W + ρ|W_ii| serves until ρ has to be rebalanced. W may have any rank.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Admm {
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Default for Admm {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::new(TOLERANCE, 20_000),
        }
    }
}

/// Iterations between two looks at the residual and at the balance of ρ.
const LOOK: usize = 20;

/// Over-relaxation.
const RELAXATION: f64 = 1.5;

impl<const D: usize> LocalSolver<D> for Admm {
    fn tolerance(&self) -> f64 {
        self.tolerance.relative
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let z = start(problem, guess);
        let mut best = Best::new(LocalSolution::at(problem, z.clone(), 0, NAME));
        let warm = guess.map(|_| best.point.displacement.as_slice());
        let mut method = Method::new(problem, z, warm);
        for iterations in 1..=self.tolerance.iterations {
            if best.size() <= tolerance {
                break;
            }
            let Some(ratio) = method.iterate() else {
                return best.judge(tolerance, Reason::Singular);
            };
            if iterations % LOOK == 0 {
                let now = LocalSolution::at(problem, method.z.clone(), iterations, NAME);
                best.take(now, iterations);
                method.balance(ratio);
            }
        }
        best.judge(tolerance, Reason::Iterations)
    }
}

/// Times that ρ is rebalanced at most.
const BALANCED: usize = 20;

/// The iteration on forces z within the law and multipliers ξ, with forces r of the equation between.
struct Method<'a, const D: usize> {
    problem: &'a LocalProblem<D>,
    rho: f64,
    z: Vec<Local<D>>,
    /// The multiplier in units of force: ũ = −w ξ with the weights w.
    xi: Vec<Local<D>>,
    factor: Option<Factor>,
    balanced: usize,
}

impl<'a, const D: usize> Method<'a, D> {
    fn new(problem: &'a LocalProblem<D>, z: Vec<Local<D>>, warm: Option<&[Local<D>]>) -> Self {
        let rho = 0.1;
        let xi = |i: usize| match warm {
            Some(u) => {
                let law = &problem.laws()[i];
                -(u[i] + shift(law, &u[i])).component_div(&weight(problem, rho, i))
            }
            None => Local::zeros(),
        };
        Self {
            problem,
            rho,
            xi: (0..z.len()).map(xi).collect(),
            z,
            factor: factorise(problem, rho),
            balanced: 0,
        }
    }

    /// One iteration; the ratio of what the forces r and z differ to what ũ lacks, in units of ρ. `None`
    /// if the matrix is singular.
    fn iterate(&mut self) -> Option<f64> {
        let Self {
            problem,
            rho,
            z,
            xi,
            ..
        } = self;
        let rhs = |i: usize| {
            let weight = weight(problem, *rho, i);
            // u_t = ũ_t.
            let shifted = shift(&problem.laws()[i], &-weight.component_mul(&xi[i]));
            (z[i] - xi[i]).component_mul(&weight) - shifted - problem.free()[i]
        };
        let rhs: Vec<Local<D>> = (0..z.len()).map(rhs).collect();
        let r = self.factor.as_mut()?.solve(&rhs)?;
        let (mut primal, mut dual) = (0.0, 0.0);
        for (i, law) in problem.laws().iter().enumerate() {
            let relaxed = r[i] * RELAXATION + z[i] * (1.0 - RELAXATION);
            // The prediction is what it is, whatever α: nothing has moved.
            let corrected = law.correct(&Local::zeros(), &(relaxed + xi[i]), 1.0);
            xi[i] += relaxed - corrected;
            primal += (r[i] - corrected).norm_squared();
            dual += (corrected - z[i]).norm_squared();
            z[i] = corrected;
        }
        Some((primal / dual).sqrt() / *rho)
    }

    /// Another ρ where one of the two falls much faster than the other.
    fn balance(&mut self, ratio: f64) {
        if (0.1..=10.0).contains(&ratio) || ratio <= 0.0 || self.balanced == BALANCED {
            return;
        }
        self.balanced += 1;
        let scale = ratio.sqrt().clamp(0.1, 10.0);
        self.rho *= scale;
        self.xi.iter_mut().for_each(|xi| *xi /= scale);
        self.factor = factorise(self.problem, self.rho);
    }
}

/// ũ − u, μ|u_t| along the normal where the forces fill a cone.
fn shift<const D: usize>(law: &Friction, u: &Local<D>) -> Local<D> {
    let mut shift = Local::zeros();
    shift[0] = law.shifted(u)[0] - u[0];
    shift
}

/// ρ |W_ii| between stretched vectors: the admissible forces of an anisotropic law are projected on in
/// their metric.
fn weight<const D: usize>(problem: &LocalProblem<D>, rho: f64, i: usize) -> Local<D> {
    let m: Local<D> = problem.laws()[i].stretch();
    m.map(|m| rho * problem.compliance(i) / (m * m))
}

/// W and the weights.
fn factorise<const D: usize>(problem: &LocalProblem<D>, rho: f64) -> Option<Factor> {
    let weighted = problem.in_series(|i| Springs {
        compliance: weight(problem, rho, i),
        force: Local::zeros(),
    });
    Factor::new(weighted.operator())
}
