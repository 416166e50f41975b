//! The methods that solve contact problems, one file each, behind a trait for each form of the problem:
//! [`ContactSolver`] for the condensed one, [`LocalSolver`] for u = W r + q.

mod admm;
mod anderson;
mod auto;
mod dual;
mod elimination;
mod fixed_point;
mod gauss_seidel;
mod local;
mod newton;
mod one_contact;
mod penalty;
mod proximal;
mod semismooth;
mod tied;
mod tresca;
mod uzawa;

pub use admm::Admm;
pub use anderson::Anderson;
pub use auto::Auto;
pub use dual::Dual;
pub use gauss_seidel::GaussSeidel;
pub use local::{LocalSolution, LocalSolver, Reason, Unsolved};
pub use newton::map::NewtonMap;
pub use penalty::Penalty;
pub use proximal::{Newton, ProximalNewton};
pub use semismooth::SemismoothNewton;
pub use tied::{TiedFactor, solve_tied};
pub use tresca::TrescaFixedPoint;
pub use uzawa::{Uzawa, uzawa_steps};

use crate::error::{expect_finite, expect_sizes};
use crate::{Certificate, CondensedProblem, ContactError, LocalProblem};
use moreau_laws::{Local, Status};

/// When an iterative method stops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Natural-map residual over the size of the forces in play, dimensionless.
    pub relative: f64,
    /// Iterations after which the method gives up.
    pub iterations: usize,
}

impl Tolerance {
    /// From a residual and a number of iterations.
    pub fn new(relative: f64, iterations: usize) -> Self {
        Self {
            relative,
            iterations,
        }
    }
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
    pub fn certificate(&self, problem: &CondensedProblem<D>) -> Certificate {
        Certificate::new(problem.laws(), &self.irreversible, &self.force)
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
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
    ) -> Result<ContactSolution<D>, ContactError> {
        self.approach(problem, guess, 0.0)
    }

    /// Solves a problem until a residual of `enough` \[N\] is left, or to the method's own tolerance
    /// where that is larger; at zero as [`ContactSolver::solve`], and where it is infinite the first point is enough.
    ///
    /// # Errors
    /// [`ContactError::NotConverged`] with the residual left, [`ContactError::Floating`] where
    /// the method needs an invertible stiffness, [`ContactError::Singular`]; [`ContactError::Dimension`] of a guess of
    /// another number of contacts, [`ContactError::NotFinite`] of a guess or of a solution that is none in numbers, and
    /// [`ContactError::OutOfRange`] of an `enough` that is negative or no number.
    fn approach(
        &self,
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError>;

    /// One step of Newton's method on displacements and forces, from where the bodies are and these forces,
    /// wherever that leads: what is left where the structure is unstable and its problem may have no
    /// solution. `None` of other methods, or of a singular step.
    fn step(
        &self,
        _problem: &CondensedProblem<D>,
        _force: &[Local<D>],
    ) -> Option<ContactSolution<D>> {
        None
    }

    /// Springs of compliance C \[mm/N\] in series with the law, and the tolerance, of a method that is
    /// Newton's on the natural map: [`solve_tied`] does the same without a condensed stiffness. `None` of
    /// other methods.
    fn springs(&self) -> Option<(Local<D>, Tolerance)> {
        None
    }
}

/// Whether a guess is one of so many contacts, in numbers.
///
/// # Errors
/// [`ContactError::Dimension`], [`ContactError::NotFinite`].
fn expect_guess<const D: usize>(
    contacts: usize,
    guess: Option<&ContactSolution<D>>,
) -> Result<(), ContactError> {
    let Some(guess) = guess else { return Ok(()) };
    let pairs = [&guess.displacement, &guess.irreversible, &guess.force];
    expect_sizes(pairs.map(|part| ("guess", part.len(), contacts)))?;
    expect_finite("guess", pairs.into_iter().flatten().flatten())
}

/// The residual that is enough \[N\], as a number: all are where it is infinite.
///
/// # Errors
/// [`ContactError::OutOfRange`] if it is negative or no number.
fn expect_enough(enough: f64) -> Result<f64, ContactError> {
    match enough >= 0.0 {
        true => Ok(enough.min(f64::MAX)),
        false => Err(ContactError::OutOfRange {
            what: "residual that is enough",
            value: enough,
            expected: "a number that is not negative",
        }),
    }
}

/// Forces of a guess to start from.
///
/// # Errors
/// As [`expect_guess`].
fn forces<const D: usize>(
    form: &LocalProblem<D>,
    guess: Option<&ContactSolution<D>>,
) -> Result<Vec<Local<D>>, ContactError> {
    expect_guess(form.contacts(), guess)?;
    Ok(local::start(form, guess.map(|g| g.force.as_slice())))
}

/// Whether a residual is within a target; what is no number never is, nor is anything within a target that has overflowed.
fn is_within(residual: f64, target: f64) -> bool {
    target.is_finite() && residual <= target
}

/// When a method on the form u = W t + q of a condensed problem has arrived.
struct Goal<'a, const D: usize> {
    problem: &'a CondensedProblem<D>,
    /// Whether displacements weigh as where solutions are judged, not by the stiffness of the problem alone.
    judged: bool,
    tolerance: Tolerance,
    /// Residual that is enough \[N\].
    enough: f64,
    /// The least residual that counted as progress \[N\], and the iteration in which it was found.
    least: (f64, usize),
}

/// Part of the iterations in which the residual must fall by as large a part: a method that is slower falls by a factor
/// of e at most until it has used up all, and one that wanders or has left for good does not even that.
const PATIENCE: f64 = 0.1;

impl<'a, const D: usize> Goal<'a, D> {
    /// Of a solution, which will be judged.
    fn new(problem: &'a CondensedProblem<D>, tolerance: Tolerance, enough: f64) -> Self {
        Self {
            problem,
            judged: true,
            tolerance,
            enough,
            least: (f64::INFINITY, 0),
        }
    }

    /// Of displacements that another method starts from.
    fn of_start(problem: &'a CondensedProblem<D>, tolerance: Tolerance) -> Self {
        Self {
            judged: false,
            ..Self::new(problem, tolerance, 0.0)
        }
    }

    /// By how much forces t and displacements u do not obey the law \[N\].
    fn residual(&self, t: &[Local<D>], u: &[Local<D>]) -> f64 {
        match self.judged {
            true => self.problem.judged_residual(u, t),
            false => self.problem.residual(u, t),
        }
    }

    /// Residual that meets the tolerance at forces t and displacements u, or is rounding \[N\].
    fn target(&self, t: &[Local<D>], u: &[Local<D>]) -> f64 {
        let asked = self.tolerance.relative * self.problem.force_scale(t);
        let problem = self.problem;
        asked.max(problem.rounding(&problem.relative(u)) + problem.rounding_of_origin(t))
    }

    /// The solution at a point that is one, the failure where the iterations are used up or lead nowhere.
    fn judge(
        &mut self,
        solver: &'static str,
        iterations: usize,
        t: &[Local<D>],
        u: &[Local<D>],
    ) -> Option<Result<ContactSolution<D>, ContactError>> {
        let residual = self.residual(t, u);
        let target = self.target(t, u);
        if is_within(residual, target.max(self.enough)) {
            return Some(Ok(ContactSolution {
                displacement: u.to_vec(),
                motion: self.problem.relative(u),
                irreversible: u.to_vec(),
                force: t.to_vec(),
                status: self.problem.statuses(u, t),
                iterations,
                residual: self.problem.residual(u, t),
                exact: is_within(residual, target),
            }));
        }
        if residual < (1.0 - PATIENCE) * self.least.0 {
            self.least = (residual, iterations);
        }
        let idle = (iterations - self.least.1) as f64;
        let limit = self.tolerance.iterations;
        let ends = iterations >= limit || idle > PATIENCE * limit as f64;
        ends.then_some(Err(match residual.is_finite() && target.is_finite() {
            true => ContactError::NotConverged {
                solver,
                iterations,
                residual,
                tolerance: target,
            },
            false => ContactError::NotFinite { what: "solution" },
        }))
    }
}
