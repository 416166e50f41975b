//! Uzawa's projection on the Coulomb cone, \[85\]–\[90′\]; not the nesting around the bulk solve.

use super::{ContactSolution, ContactSolver, Tolerance, fixed_point};
use crate::problem::{split, stack};
use crate::{ContactError, ContactProblem, Delassus};
use moreau_laws::Local;
use nalgebra::{DMatrix, DVector};

/// Prediction t̂ = t − α ũ and correction t = proj(t̂) on u = W t + q, accelerated.
///
/// α is the inverse of the largest eigenvalue of W in the scaling that gives every contact a unit
/// diagonal, over √(1 + μ²) for the slope of ũ: there is no number to choose. Near a limit load W has eigenvalues of very unlike
/// size, on which the plain scheme takes 10⁵ corrections and more; Anderson's extrapolation brings
/// them down to some hundreds and leaves the fixed point what it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uzawa {
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Default for Uzawa {
    fn default() -> Self {
        Self {
            tolerance: Tolerance {
                relative: 1e-10,
                iterations: 200_000,
            },
        }
    }
}

impl<const D: usize> ContactSolver<D> for Uzawa {
    fn approach(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let form = problem.delassus("Uzawa")?;
        let start = guess.map_or_else(|| DVector::zeros(form.free.len()), |g| stack(&g.force));
        self.corrections(problem, &form, start, enough)
    }
}

impl Uzawa {
    /// Solves u = W t + q for a form that need not be that of the problem.
    pub(super) fn corrections<const D: usize>(
        &self,
        problem: &ContactProblem<D>,
        form: &Delassus<D>,
        start: DVector<f64>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let alpha = steps::<D>(problem, &form.operator);
        let correct = |t: &DVector<f64>| -> Vec<Local<D>> {
            let u = split::<D>(&(&form.operator * t + &form.free));
            let t = split::<D>(t);
            let corrected = |i: usize| {
                let law = &problem.friction()[i];
                law.correct(&u[i], &t[i], alpha[i])
            };
            (0..t.len()).map(corrected).collect()
        };
        fixed_point(
            "Uzawa",
            problem,
            form,
            start,
            (self.tolerance, enough),
            correct,
        )
    }
}

/// Steps α of Uzawa's correction for a problem, one per contact \[N/mm\].
///
/// # Errors
/// [`ContactError::Floating`] if the stiffness is singular.
pub fn uzawa_steps<const D: usize>(problem: &ContactProblem<D>) -> Result<Vec<f64>, ContactError> {
    Ok(steps(problem, &problem.delassus("Uzawa")?.operator))
}

/// α per contact: 1/W̄_ii over the largest eigenvalue of the scaled operator, by power iteration.
fn steps<const D: usize>(problem: &ContactProblem<D>, operator: &DMatrix<f64>) -> Vec<f64> {
    let scale: Vec<f64> = (0..problem.contacts())
        .map(|i| {
            D as f64
                / (0..D)
                    .map(|k| operator[(D * i + k, D * i + k)])
                    .sum::<f64>()
        })
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
        .map(|(i, s)| {
            s / (1.05 * largest * (1.0 + problem.friction()[i].friction().powi(2)).sqrt())
        })
        .collect()
}
