//! The alternating direction method of multipliers on the local form; not a descent method: it needs
//! no good start.

use super::blocks::{BlockMatrix, Factor};
use super::{LocalProblem, LocalSolution, LocalSolver, Reason, TOLERANCE, Unsolved, judge, start};
use crate::Tolerance;
use moreau_laws::Local;
use nalgebra::SMatrix;

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
            tolerance: Tolerance {
                relative: TOLERANCE,
                iterations: 20_000,
            },
        }
    }
}

/// Iterations between two looks at the residual and at the balance of ρ.
const LOOK: usize = 20;

/// Over-relaxation.
const RELAXATION: f64 = 1.5;

impl<const D: usize> LocalSolver<D> for Admm {
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let Tolerance {
            relative,
            iterations: limit,
        } = self.tolerance;
        let contacts = problem.contacts();
        let mut z = start(problem, guess);
        let mut best = LocalSolution::at(problem, z.clone(), 0, NAME);
        // The multiplier in units of force: ũ = −ρ |W_ii| ξ.
        let mut rho = 0.1;
        let mut xi = vec![Local::<D>::zeros(); contacts];
        if guess.is_some() {
            for (i, law) in problem.friction().iter().enumerate() {
                let shifted = law.shifted(&best.displacement[i]);
                xi[i] = -shifted / (rho * problem.compliance(i));
            }
        }
        let mut factor = factorise(problem, rho);
        let mut balanced = 0;
        for iterations in 1..=limit {
            if best.residual.size() <= relative {
                break;
            }
            let rhs: Vec<Local<D>> = (0..contacts)
                .map(|i| {
                    let weight = rho * problem.compliance(i);
                    let law = &problem.friction()[i];
                    // ũ − u = μ|u_t| n, and u_t = ũ_t.
                    let mut q = law.shifted(&(-weight * xi[i])) + weight * xi[i];
                    q += problem.free()[i];
                    (z[i] - xi[i]) * weight - q
                })
                .collect();
            let Some(r) = factor.as_mut().and_then(|f| f.solve(&rhs)) else {
                return judge(best, relative, Reason::Singular);
            };
            let (mut primal, mut dual) = (0.0, 0.0);
            for (i, law) in problem.friction().iter().enumerate() {
                let relaxed = r[i] * RELAXATION + z[i] * (1.0 - RELAXATION);
                let projected = law.project(&(relaxed + xi[i]));
                xi[i] += relaxed - projected;
                primal += (r[i] - projected).norm_squared();
                dual += (projected - z[i]).norm_squared();
                z[i] = projected;
            }
            if iterations % LOOK == 0 {
                let now = LocalSolution::at(problem, z.clone(), iterations, NAME);
                if now.residual.size() < best.residual.size() {
                    best = now;
                }
                let ratio = (primal / dual).sqrt() / rho;
                if !(0.1..=10.0).contains(&ratio) && ratio > 0.0 && balanced < 20 {
                    balanced += 1;
                    let scale = ratio.sqrt().clamp(0.1, 10.0);
                    rho *= scale;
                    xi.iter_mut().for_each(|xi| *xi /= scale);
                    factor = factorise(problem, rho);
                }
            }
        }
        judge(best, relative, Reason::Iterations)
    }
}

/// W + ρ |W_ii|.
fn factorise<const D: usize>(problem: &LocalProblem<D>, rho: f64) -> Option<Factor> {
    let mut matrix = BlockMatrix::empty();
    for i in 0..problem.contacts() {
        let spring = SMatrix::<f64, D, D>::identity() * (rho * problem.compliance(i));
        let row = problem.operator().row(i);
        matrix.push_row(row.map(|(j, w)| (j, if i == j { w + spring } else { *w })));
    }
    Factor::new(&matrix)
}
