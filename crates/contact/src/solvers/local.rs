//! What the methods for the local problem u = W r + q have in common: their trait, their solutions and
//! failures; none of them.
//!
//! Every method is judged by the same residual, whichever map it iterates on.

use crate::LocalProblem;
use crate::problem::Residual;
use moreau_laws::Local;

/// Residual at which the methods stop when nothing else is asked for: small enough that measures in
/// other units, which may be some ten times larger, are met as well.
pub(super) const TOLERANCE: f64 = 1e-10;

/// A solution of the local problem, or the best point that a method met.
#[derive(Debug, Clone, PartialEq)]
pub struct LocalSolution<const D: usize> {
    /// Forces r \[N\].
    pub force: Vec<Local<D>>,
    /// u = W r + q \[mm\].
    pub displacement: Vec<Local<D>>,
    /// Distance from the contact law.
    pub residual: Residual,
    /// Iterations of the method: sweeps, corrections, or Newton steps.
    pub iterations: usize,
    /// The method that arrived.
    pub solver: &'static str,
}

impl<const D: usize> LocalSolution<D> {
    pub(super) fn at(
        problem: &LocalProblem<D>,
        force: Vec<Local<D>>,
        iterations: usize,
        solver: &'static str,
    ) -> Self {
        let displacement = problem.displacement(&force);
        Self {
            residual: problem.residual(&force, &displacement),
            force,
            displacement,
            iterations,
            solver,
        }
    }
}

/// Why a method gave up.
#[derive(Debug, Clone, PartialEq)]
pub enum Reason {
    /// The iterations allowed are used up.
    Iterations,
    /// The residual no longer falls.
    Stalled,
    /// The iterates repeat themselves.
    Cycling {
        /// Iterations after which they do.
        period: usize,
    },
    /// The matrix of a step is singular.
    Singular,
    /// All methods that were tried, each with its residual and reason.
    All(Vec<(&'static str, f64, Reason)>),
}

impl std::fmt::Display for Reason {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Iterations => f.write_str("iterations used up"),
            Self::Stalled => f.write_str("the residual no longer falls"),
            Self::Cycling { period } => write!(f, "cycling with period {period}"),
            Self::Singular => f.write_str("singular matrix"),
            Self::All(attempts) => {
                for (at, (solver, residual, reason)) in attempts.iter().enumerate() {
                    let comma = if at > 0 { "; " } else { "" };
                    write!(f, "{comma}{solver} {residual:.1e}: {reason}")?;
                }
                Ok(())
            }
        }
    }
}

/// A local problem was not solved to the tolerance: the best point and the reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{} left a residual of {:.3e} after {} iterations, expected at most {tolerance:.3e}: {reason}",
    .best.solver, .best.residual.size(), .best.iterations
)]
pub struct Unsolved<const D: usize> {
    /// The best point that the method met.
    pub best: Box<LocalSolution<D>>,
    /// Residual asked for.
    pub tolerance: f64,
    /// Why it ended there.
    pub reason: Reason,
}

/// A method for the local problem. All solve the same problem and report the same residual.
pub trait LocalSolver<const D: usize>: std::fmt::Debug + Send + Sync {
    /// [`Residual::size`] that the method stops at of itself.
    fn tolerance(&self) -> f64;

    /// Solves a problem to a residual of `tolerance`, starting from the forces `guess` if there are any: those of another
    /// number of contacts, or that are no numbers, are none to start from.
    ///
    /// # Errors
    /// [`Unsolved`] with the best point met and the reason for the end.
    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>>;

    /// Solves a problem to the method's own tolerance.
    ///
    /// # Errors
    /// As [`LocalSolver::solve_to`].
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        self.solve_to(problem, guess, self.tolerance())
    }
}

/// The forces to start from.
pub(super) fn start<const D: usize>(
    problem: &LocalProblem<D>,
    guess: Option<&[Local<D>]>,
) -> Vec<Local<D>> {
    let is_a_start = |guess: &[Local<D>]| {
        guess.len() == problem.contacts() && guess.iter().flatten().all(|r| r.is_finite())
    };
    match guess {
        Some(guess) if is_a_start(guess) => guess.to_vec(),
        _ => vec![Local::zeros(); problem.contacts()],
    }
}

/// The best point met, and when the residual last fell by a tenth.
pub(super) struct Best<const D: usize> {
    pub(super) point: LocalSolution<D>,
    milestone: (usize, f64),
}

impl<const D: usize> Best<D> {
    /// The first point.
    pub(super) fn new(point: LocalSolution<D>) -> Self {
        Self {
            milestone: (0, point.residual.size()),
            point,
        }
    }

    /// Its residual.
    pub(super) fn size(&self) -> f64 {
        self.point.residual.size()
    }

    /// Takes note of the point met at a count; for how many counts the residual has not fallen by a tenth.
    pub(super) fn take(&mut self, point: LocalSolution<D>, count: usize) -> usize {
        if point.residual.size() < self.size() {
            self.point = point;
        }
        if self.size() < 0.9 * self.milestone.1 {
            self.milestone = (count, self.size());
        }
        count - self.milestone.0
    }

    /// The solution if it is within the tolerance, else the failure.
    pub(super) fn judge(
        self,
        tolerance: f64,
        reason: Reason,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        if self.size() <= tolerance {
            Ok(self.point)
        } else {
            Err(Unsolved {
                best: Box::new(self.point),
                tolerance,
                reason,
            })
        }
    }
}
