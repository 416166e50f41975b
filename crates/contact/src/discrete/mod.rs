//! The discrete frictional contact problem u = W r + q and the methods that solve it; not the
//! condensed problem t = S (u − g) − f of the driver, whose S need not be invertible.
//!
//! Every method is judged by the same residual, whichever map it iterates on.

mod admm;
mod auto;
mod blocks;
mod elimination;
mod gauss_seidel;
mod global;
mod newton;
mod one_contact;
mod problem;
mod projection;
mod proximal;
#[cfg(test)]
mod tests;
mod tresca;

pub use admm::Admm;
pub use auto::Auto;
pub use blocks::BlockMatrix;
pub use global::{GlobalProblem, GlobalSolution};
pub use newton::NewtonMap;
pub use problem::{LocalProblem, Residual};
pub use proximal::{Newton, ProximalNewton};
pub use tresca::TrescaFixedPoint;

use moreau_laws::Local;

/// Residual at which the methods stop when nothing else is asked for: small enough that measures in
/// other units, which may be some ten times larger, are met as well.
const TOLERANCE: f64 = 1e-10;

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
    fn at(
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
    /// Solves a problem, starting from the forces `guess` if there are any.
    ///
    /// # Errors
    /// [`Unsolved`] with the best point met and the reason for the end.
    fn solve(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
    ) -> Result<LocalSolution<D>, Unsolved<D>>;
}

/// The forces to start from.
fn start<const D: usize>(problem: &LocalProblem<D>, guess: Option<&[Local<D>]>) -> Vec<Local<D>> {
    match guess {
        Some(guess) if guess.len() == problem.contacts() => guess.to_vec(),
        _ => vec![Local::zeros(); problem.contacts()],
    }
}

/// A solution if it is within the tolerance, else the failure.
fn judge<const D: usize>(
    best: LocalSolution<D>,
    tolerance: f64,
    reason: Reason,
) -> Result<LocalSolution<D>, Unsolved<D>> {
    if best.residual.size() <= tolerance {
        Ok(best)
    } else {
        Err(Unsolved {
            best: Box::new(best),
            tolerance,
            reason,
        })
    }
}
