//! How increments are solved; no number here decides the answer.

use crate::error::ModelError;
use moreau_contact::{ContactSolver, SemismoothNewton};

/// Where the contact problem is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nesting {
    /// Inside every Newton iteration on the bulk, condensed on the interface.
    Inside,
    /// Around the nonlinear solve, as in the paper: Uzawa's prediction and correction \[90′\] with
    /// one nonlinear problem under frozen contact forces per iteration. The contact method of the
    /// settings is not used. Bodies must be held without contact.
    Outside {
        /// Natural-map residual at which the increment is accepted, over the largest force.
        tolerance: f64,
        /// Outer iterations after which an increment fails; sooner where they do not get on.
        iterations: usize,
        /// Whether each correction is extrapolated from those before, which takes a small part of the iterations; without
        /// it is the paper's own method.
        extrapolated: bool,
    },
}

/// How the contacts of a linearised increment are seen: as their laws and their unknowns are the same, so
/// is the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Seam {
    /// As takes fewer operations, which are counted before anything is solved.
    Cheaper,
    /// On the stiffness condensed on all nodes that may touch, a dense matrix.
    Condensed,
    /// Through a factor of the stiffness with the contacts tied in it, see
    /// [`solve_tied`](moreau_contact::solve_tied): where much touches.
    Tied,
}

/// How increments are solved. The defaults need no change: no number here decides the answer.
#[derive(Debug)]
pub struct Settings<const D: usize> {
    /// Method for the contact problem.
    pub contact: Box<dyn ContactSolver<D>>,
    /// Where the contact problem is solved.
    pub nesting: Nesting,
    /// How contacts are seen. Only Newton's methods work on tied ones; the others condense.
    pub seam: Seam,
    /// Out-of-balance force at which an increment is accepted, over the largest nodal force.
    pub tolerance: f64,
    /// Newton iterations after which an increment is cut.
    pub iterations: usize,
    /// Times an increment may be halved before the step stops.
    pub cuts: usize,
    /// What the factor of the stiffness, by far the largest, may take \[bytes\]; `None` for anything.
    /// Where it takes more, conjugate gradients with the factor of a coarse space replace it.
    pub memory: Option<u64>,
}

impl<const D: usize> Default for Settings<D> {
    fn default() -> Self {
        Self {
            contact: Box::new(SemismoothNewton::default()),
            nesting: Nesting::Inside,
            seam: Seam::Cheaper,
            tolerance: 1e-10,
            iterations: 40,
            cuts: 10,
            memory: None,
        }
    }
}

impl<const D: usize> Settings<D> {
    /// Whether tolerances are positive numbers, and iterations are allowed.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let nested = match self.nesting {
            Nesting::Inside => None,
            Nesting::Outside {
                tolerance,
                iterations,
                ..
            } => Some((
                ("the tolerance of the outer iterations", tolerance),
                ("outer iterations", iterations),
            )),
        };
        let own = (
            ("the tolerance of increments", self.tolerance),
            ("iterations of an increment", self.iterations),
        );
        for ((what, tolerance), (counted, iterations)) in [Some(own), nested].into_iter().flatten()
        {
            if !(tolerance > 0.0 && tolerance.is_finite()) {
                return Err(refused(what, tolerance, "a positive number"));
            }
            if iterations == 0 {
                return Err(refused(counted, 0.0, "at least one"));
            }
        }
        Ok(())
    }
}

fn refused(what: &str, value: f64, expected: &'static str) -> ModelError {
    ModelError::OutOfRange {
        what: what.into(),
        value,
        expected,
    }
}
