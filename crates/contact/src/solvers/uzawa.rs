//! Uzawa's projection on the Coulomb cone, [85]–[90′]; not the nesting around the bulk solve.

use super::{ContactSolution, ContactSolver, Tolerance};
use crate::problem::split;
use crate::{ContactError, ContactProblem, Delassus};
use moreau_laws::Local;
use nalgebra::{DMatrix, DVector};

/// Prediction t̂ = t − α ũ and correction t = proj(t̂) on u = W t + q, accelerated.
///
/// α is the inverse of the largest eigenvalue of W in the scaling that gives every contact a unit
/// diagonal, so there is no number to choose; Nesterov's extrapolation, restarted whenever it
/// points uphill, takes the square root of the number of iterations of the plain scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uzawa {
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Default for Uzawa {
    fn default() -> Self {
        Self { tolerance: Tolerance { relative: 1e-11, iterations: 200_000 } }
    }
}

impl<const D: usize> ContactSolver<D> for Uzawa {
    fn solve(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
    ) -> Result<ContactSolution<D>, ContactError> {
        let Delassus { operator, free } = problem.delassus("Uzawa")?;
        let contacts = problem.contacts();
        let alpha = steps::<D>(problem, &operator);
        let mut t: Vec<Local<D>> = match guess {
            Some(g) => g.force.clone(),
            None => vec![Local::zeros(); contacts],
        };
        let mut extrapolated = t.clone();
        let mut momentum = 1.0f64;
        let mut residual = f64::INFINITY;
        for iteration in 0..self.tolerance.iterations {
            let u = displacement(&operator, &free, &extrapolated);
            let mut corrected = Vec::with_capacity(contacts);
            for i in 0..contacts {
                let law = &problem.friction()[i];
                let predicted = extrapolated[i] - law.shifted(&u[i]) * alpha[i];
                corrected.push(law.project(&predicted));
            }
            // Every so often judge the corrected forces by the residual common to all methods.
            if iteration % 10 == 0 {
                let u = displacement(&operator, &free, &corrected);
                residual = problem.residual(&u, &corrected);
                if residual <= self.tolerance.relative * problem.force_scale(&corrected) {
                    let status = problem.statuses(&u, &corrected);
                    return Ok(ContactSolution {
                        irreversible: u.clone(),
                        displacement: u,
                        force: corrected,
                        status,
                        iterations: iteration + 1,
                        residual,
                    });
                }
            }
            // Restart where the step and the momentum disagree (O'Donoghue and Candès, 2015).
            let uphill: f64 = (0..contacts)
                .map(|i| (extrapolated[i] - corrected[i]).dot(&(corrected[i] - t[i])) / alpha[i])
                .sum();
            let next = if uphill > 0.0 { 1.0 } else { 0.5 * (1.0 + (1.0 + 4.0 * momentum * momentum).sqrt()) };
            let weight = if uphill > 0.0 { 0.0 } else { (momentum - 1.0) / next };
            for i in 0..contacts {
                extrapolated[i] = corrected[i] + (corrected[i] - t[i]) * weight;
            }
            momentum = next;
            t = corrected;
        }
        Err(ContactError::NotConverged {
            solver: "Uzawa",
            iterations: self.tolerance.iterations,
            residual,
            tolerance: self.tolerance.relative * problem.force_scale(&t),
        })
    }
}

/// u = W t + q.
fn displacement<const D: usize>(
    operator: &DMatrix<f64>,
    free: &DVector<f64>,
    t: &[Local<D>],
) -> Vec<Local<D>> {
    let forces = DVector::from_iterator(free.len(), t.iter().flat_map(|t| (0..D).map(|k| t[k])));
    split(&(operator * forces + free))
}

/// Steps α of Uzawa's correction for a problem, one per contact [N/mm].
///
/// # Errors
/// [`ContactError::Floating`] if the stiffness is singular.
pub fn uzawa_steps<const D: usize>(problem: &ContactProblem<D>) -> Result<Vec<f64>, ContactError> {
    Ok(steps(problem, &problem.delassus("Uzawa")?.operator))
}

/// α per contact: 1/W̄_ii over the largest eigenvalue of the scaled operator, by power iteration.
fn steps<const D: usize>(problem: &ContactProblem<D>, operator: &DMatrix<f64>) -> Vec<f64> {
    let scale: Vec<f64> = (0..problem.contacts())
        .map(|i| D as f64 / (0..D).map(|k| operator[(D * i + k, D * i + k)]).sum::<f64>())
        .collect();
    let n = operator.nrows();
    // Not symmetric about anything a structure would be symmetric about.
    let mut v = DVector::from_fn(n, |i, _| 1.0 + 0.3 * ((i * i) as f64 * 0.7).sin());
    let mut largest = 1.0;
    for _ in 0..60 {
        let mut w = operator * &v;
        for i in 0..n {
            w[i] *= scale[i / D];
        }
        largest = w.norm() / v.norm();
        v = w / largest;
    }
    // Friction adds μ‖u_t‖ to the normal displacement: its slope enters the Lipschitz constant.
    scale
        .iter()
        .enumerate()
        .map(|(i, s)| s / (1.05 * largest * (1.0 + problem.friction()[i].friction().powi(2)).sqrt()))
        .collect()
}
