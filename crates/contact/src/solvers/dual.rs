//! Any method for u = W r + q on a condensed problem; not a method.

use super::{ContactSolution, ContactSolver, Goal, LocalSolver, Tolerance, expect_enough, forces};
use crate::{CondensedProblem, ContactError};

/// A method for local problems on the dual form of condensed ones, u = W t + q with W = S⁻¹, whose
/// unknowns are the forces.
///
/// ```
/// use moreau_contact::{Admm, CondensedProblem, ContactSolver, Dual};
/// use moreau_laws::{Local, Tresca};
/// use nalgebra::DMatrix;
///
/// // Pressed by q_n < 0, and dragged by more than the shear that Tresca's law allows.
/// let w = DMatrix::identity(2, 2);
/// let laws = vec![Tresca::new(0.1)?];
/// let problem = CondensedProblem::<2>::from_delassus(w, &[Local::<2>::new(-1.0, 0.5)], laws)?;
/// let solution = Dual(Admm::default()).solve(&problem, None)?;
/// assert!((solution.force[0] - Local::<2>::new(1.0, -0.1)).norm() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<S>(pub S);

/// How often the method is asked for more: the two forms of a problem measure residuals with unlike weights.
const ROUNDS: usize = 6;

/// Part of the residual that is missing which the method is asked for.
const MARGIN: f64 = 0.3;

/// Least residual that a method can be asked for.
const LEAST: f64 = 1e-15;

impl<const D: usize, S: LocalSolver<D>> ContactSolver<D> for Dual<S> {
    fn approach(
        &self,
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let enough = expect_enough(enough)?;
        let form = problem.delassus()?;
        let own = Tolerance {
            relative: self.0.tolerance(),
            iterations: usize::MAX,
        };
        let mut goal = Goal::new(problem, own, enough);
        let mut start = forces(&form, guess)?;
        let mut asked = own
            .relative
            .max(MARGIN * enough / problem.force_scale(&start));
        let mut iterations = 0;
        let mut rounds = 0;
        loop {
            rounds += 1;
            let (point, failed) = match self.0.solve_to(&form, Some(&start), asked) {
                Ok(point) => (point, false),
                Err(failure) => (*failure.best, true),
            };
            iterations += point.iterations;
            let (t, u) = (&point.force, &point.displacement);
            if let Some(end) = goal.judge(point.solver, iterations, t, u) {
                return end;
            }
            let (residual, target) = (goal.residual(t, u), goal.target(t, u).max(enough));
            if !(residual.is_finite() && target.is_finite()) {
                return Err(ContactError::NotFinite { what: "solution" });
            }
            if failed || rounds == ROUNDS {
                return Err(ContactError::NotConverged {
                    solver: point.solver,
                    iterations,
                    residual,
                    tolerance: target,
                });
            }
            asked = MARGIN * point.residual.size().min(asked) * (target / residual);
            asked = asked.max(LEAST);
            start = point.force;
        }
    }
}
