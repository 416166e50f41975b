//! The methods that solve a contact problem, one file each, behind one trait.

mod anderson;
mod gauss_seidel;
mod linearised;
mod penalty;
mod recycled;
mod semismooth;
mod tied;
mod uzawa;

pub use anderson::Anderson;
pub use gauss_seidel::GaussSeidel;
pub use penalty::Penalty;
pub use semismooth::SemismoothNewton;
pub use tied::solve_tied;
pub use uzawa::{Uzawa, uzawa_steps};

use crate::problem::{split, stack};
use crate::{Certificate, ContactError, ContactProblem, Delassus};
use moreau_laws::{Local, Status};
use nalgebra::DVector;

/// When an iterative method stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Natural-map residual over the size of the forces in play, dimensionless.
    pub relative: f64,
    /// Iterations after which the method gives up.
    pub iterations: usize,
}

/// Solution of a contact problem.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSolution<const D: usize> {
    /// Gap and slip u of every contact \[mm\].
    pub displacement: Vec<Local<D>>,
    /// u − g, the displacement from where the structure was linearised, without the rounding of gaps that
    /// are large \[mm\].
    pub motion: Vec<Local<D>>,
    /// The part of u that obeys Coulomb's law exactly: u itself, or under the penalty its
    /// irreversible part Δuᶠ of \[81\] \[mm\].
    pub irreversible: Vec<Local<D>>,
    /// Force t of every contact on the body \[N\].
    pub force: Vec<Local<D>>,
    /// Status of every contact, \[35\].
    pub status: Vec<Status>,
    /// Iterations of the method.
    pub iterations: usize,
    /// Largest natural-map residual of a contact \[N\].
    pub residual: f64,
    /// Whether the method's own tolerance is met, not only the residual that was enough.
    pub exact: bool,
}

impl<const D: usize> ContactSolution<D> {
    /// Bipotential gap, penetration and excess force of the solution under the exact law, taken
    /// at the irreversible displacement.
    pub fn certificate(&self, problem: &ContactProblem<D>) -> Certificate {
        Certificate::new(problem.friction(), &self.irreversible, &self.force)
    }
}

/// A method for contact problems. All solve the same problem and report the same residual.
pub trait ContactSolver<const D: usize>: std::fmt::Debug + Send + Sync {
    /// Solves a problem to the method's own tolerance, starting from `guess` if there is one.
    ///
    /// # Errors
    /// As [`ContactSolver::approach`].
    fn solve(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
    ) -> Result<ContactSolution<D>, ContactError> {
        self.approach(problem, guess, 0.0)
    }

    /// Solves a problem until a residual of `enough` \[N\] is left, or to the method's own tolerance
    /// where that is larger; at zero as [`ContactSolver::solve`].
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] with the residual left, [`ContactError::Floating`] where
    /// the method needs an invertible stiffness, [`ContactError::Singular`].
    fn approach(
        &self,
        problem: &ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError>;

    /// Springs of compliance C \[mm/N\] in series with the law, and the tolerance, of a method that is
    /// Newton's on the natural map: [`solve_tied`] does the same without a condensed stiffness. `None` of
    /// other methods.
    fn springs(&self) -> Option<(Local<D>, Tolerance)> {
        None
    }
}

/// Iterates t ← T(t), extrapolated, on u = W t + q until the residual common to all methods is met.
fn fixed_point<const D: usize>(
    solver: &'static str,
    problem: &ContactProblem<D>,
    form: &Delassus<D>,
    start: DVector<f64>,
    (tolerance, enough): (Tolerance, f64),
    map: impl Fn(&DVector<f64>) -> Vec<Local<D>>,
) -> Result<ContactSolution<D>, ContactError> {
    let mut anderson = Anderson::default();
    let mut t = start;
    let mut iterations = 0;
    loop {
        let image = map(&t);
        let stacked = stack(&image);
        let u = split::<D>(&(&form.operator * &stacked + &form.free));
        let residual = problem.residual(&u, &image);
        let target = tolerance.relative * problem.force_scale(&image);
        let target = target.max(problem.rounding(&problem.relative(&u)));
        if residual <= target.max(enough) {
            let status = problem.statuses(&u, &image);
            return Ok(ContactSolution {
                irreversible: u.clone(),
                motion: problem.relative(&u),
                displacement: u,
                force: image,
                status,
                iterations,
                residual,
                exact: residual <= target,
            });
        }
        if iterations >= tolerance.iterations {
            return Err(ContactError::NotConverged {
                solver,
                iterations,
                residual,
                tolerance: target,
            });
        }
        iterations += 1;
        t = anderson.next(&t, stacked);
    }
}
