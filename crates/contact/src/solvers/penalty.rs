//! The penalty method, \[81\]–\[82\]: Coulomb's law in series with springs; not the exact law.

use super::{ContactSolution, ContactSolver, Tolerance, semismooth};
use crate::{CondensedProblem, ContactError};
use moreau_laws::Local;

/// Contact regularised by springs k_n on the penetration and k_t on the elastic slip.
///
/// The inf-convolution \[82\] puts the springs in series with the exact law, which then holds
/// between the force and the irreversible displacement Δuᶠ = Δu + C (t − t₀*). The unknowns are
/// solved for in this form, with a status prediction scaled by the structure and not by k: it
/// converges for every k, where the return mapping of a force predicted as k·u multiplies
/// rounding by k. The error against the exact law falls as 1/k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty {
    normal: f64,
    tangent: f64,
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Penalty {
    /// Springs k_n and k_t per contact node \[N/mm\].
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] unless both are positive and finite.
    pub fn new(normal: f64, tangent: f64) -> Result<Self, ContactError> {
        for (what, value) in [("normal penalty", normal), ("tangent penalty", tangent)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ContactError::OutOfRange {
                    what,
                    value,
                    expected: "a positive number",
                });
            }
        }
        Ok(Self {
            normal,
            tangent,
            tolerance: Tolerance::new(1e-12, 300),
        })
    }

    fn compliance<const D: usize>(&self) -> Local<D> {
        let mut compliance = Local::repeat(1.0 / self.tangent);
        compliance[0] = 1.0 / self.normal;
        compliance
    }
}

impl<const D: usize> ContactSolver<D> for Penalty {
    fn approach(
        &self,
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        semismooth::newton(problem, self.compliance(), guess, (self.tolerance, enough))
    }

    fn springs(&self) -> Option<(Local<D>, Tolerance)> {
        Some((self.compliance(), self.tolerance))
    }
}
