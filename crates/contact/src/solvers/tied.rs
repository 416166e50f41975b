//! Semismooth Newton method through the factor of a structure: its linear steps by a Krylov iteration on
//! vectors of the interface; not the structure.

mod factor;
mod guess;
mod iterate;
mod progress;
mod recycled;
mod step;

use super::{ContactSolution, Tolerance, expect_guess, is_within};
use crate::ContactError;
use crate::problem::split;
use crate::tied::TiedProblem;
pub use factor::TiedFactor;
use guess::Guess;
use moreau_laws::Local;
use nalgebra::DVector;
use progress::Progress;

/// α of the map, in parts of the stiffness of a contact, and the parts to try where Newton stalls.
const PARTS: [f64; 5] = [0.1, 1.0, 0.01, 1e-4, 1e-6];

/// What a residual may be over the tolerance where it is rounding.
const ROUNDED: f64 = 100.0;

/// Iterations of a cold start in which faint forces are none, how faint over the largest in the first, and over
/// the residual in the others.
const COLD: usize = 5;
const FAINT: [f64; 2] = [0.03, 0.1];

/// Solves with the structure, and what factorisations are worth in them, after which an iteration is given up. Those that
/// arrive take tens, and a few hundred at most; where steps go through all that lies between opening and slipping, a dense matrix or a smaller increment costs less.
const MOST: usize = 600;

/// How much larger the merit may be after a step with the statuses of the last solution: where few contacts hold
/// a body it may tip over them into all that it rests on, which then has to be opened again.
const WORSE: f64 = 4.0;

/// Newton's method on the natural map of a tied problem.
///
/// With statuses come ties R: nothing where a contact is open, stiff springs across a closed gap and along
/// what sticks, and the stiffness of friction across the direction of slip. One factorisation of
/// K + BᵀRB answers them; the unknown left is z = t + R v, of which the map has about a unit derivative,
/// and what that lacks a Krylov iteration finds, with a solve for each of its directions. Statuses that have
/// changed since are made up for by the answers to unit forces there, and by a new factor where that costs less.
/// It is the augmented Lagrangian \[83\]–\[90\], its correction solved for instead of repeated: neither the ties
/// nor the accuracy of the iteration enter the result.
///
/// Pressure dies out within a thickness, and beyond it changes its sign from one thickness to the next: from a start
/// at which all touches Newton's method opens one ring after the other. What bears next to nothing after the
/// first step is therefore taken for open, and closed again where it overlaps by more.
struct Tied<'a, 'b, const D: usize> {
    problem: &'a mut TiedProblem<'b, D>,
    /// Which of the parts α is.
    part: usize,
    factor: TiedFactor<D>,
    /// Solves with the structure, and what factorisations are worth in them.
    solves: usize,
}

/// Where the iteration stands.
struct At<const D: usize> {
    z: DVector<f64>,
    v: DVector<f64>,
    u: Vec<Local<D>>,
    t: Vec<Local<D>>,
    /// u + C (t − t*): the part that obeys the law.
    irreversible: Vec<Local<D>>,
    map: Vec<Local<D>>,
    residual: f64,
    merit: f64,
    /// Size of the answers that v is a sum of beside the last that was solved for \[mm\]: where they nearly cancel, v
    /// rounds off in proportion.
    summed: f64,
}

/// Solves a tied problem to a tolerance, or to a residual that is `enough` \[N\] where that is larger. Returns with the
/// solution z = t + R v of the ties R that were the last, for which (K + BᵀRB) Δu = f + Bᵀ z.
///
/// `held` is the factor at hand, with K and B as they are now, and what was the last at the end.
///
/// Where the statuses leave the structure a rigid motion it is one of the solutions.
///
/// # Errors
/// [`ContactError::NotConverged`], and [`ContactError::Singular`] where nothing holds the structure; those of a guess as
/// [`ContactSolver::approach`](super::ContactSolver::approach).
pub fn solve_tied<const D: usize>(
    problem: &mut TiedProblem<'_, D>,
    guess: Option<&ContactSolution<D>>,
    (tolerance, enough): (Tolerance, f64),
    held: &mut TiedFactor<D>,
) -> Result<(ContactSolution<D>, DVector<f64>), ContactError> {
    expect_guess(problem.friction.len(), guess)?;
    let cold = guess.is_none();
    let mut guess = Guess::new(problem, guess);
    let mut newton = Tied {
        problem,
        part: 0,
        factor: std::mem::take(held),
        solves: 0,
    };
    let mut now = newton.begin(&mut guess)?;
    let mut first = Some(guess);
    // A body that only contact holds has no stiffness against contacts that open on the way: then they are
    // closed once more.
    let mut again = true;
    let mut progress = Progress::default();
    let mut made = 0;
    for iterations in 0..=tolerance.iterations {
        made = iterations;
        let target = newton.target(&now, tolerance, progress.stalls(now.residual));
        if is_within(now.residual, target.max(PARTS[0] * enough)) {
            if newton.part == 0 && newton.rounds_off(&now) > ROUNDED * target {
                now = newton.answered(now.z);
                continue;
            }
            if newton.part == 0 {
                let exact = now.residual <= target;
                let found = newton.solution(now, iterations, exact);
                *held = newton.factor;
                return Ok(found);
            }
            // Residuals are comparable at one α only.
            now = newton.with_part(0, now);
            progress.forget();
            continue;
        }
        if !now.residual.is_finite() || newton.solves > MOST {
            break;
        }
        let faint = if cold {
            newton.faint(&now, iterations)
        } else {
            0.0
        };
        let status = newton.statuses(&now, faint);
        let rows = match first.take() {
            Some(guess) => newton.rows_of_guess(&now, &guess),
            None => {
                now = newton.serve(now, &status)?;
                newton.rows(&now, faint)
            }
        };
        // The first steps are those of guesses, and taken as they come.
        let bounds = match (progress.allowed(now.merit), iterations) {
            (_, 0 | 1) if cold => [f64::INFINITY; 2],
            (_, 0) => [WORSE * now.merit; 2],
            (allowed, _) => [allowed, now.merit],
        };
        now = match newton.step(&rows, &now, bounds) {
            Some(next) => next,
            None if newton.factor.is_used() && newton.stale(&status) > 0 => {
                newton.renew(now, &status)?
            }
            None if again && !newton.factor.propped.is_empty() => {
                again = false;
                progress.forget();
                newton.factor = TiedFactor::default();
                let mut closed = Guess::from(now);
                newton.part = 0;
                let now = newton.begin(&mut closed)?;
                first = Some(closed);
                now
            }
            None if newton.part + 1 < PARTS.len() => {
                progress.forget();
                newton.with_part(newton.part + 1, now)
            }
            None => break,
        };
    }
    // Residuals are told at the α that they are judged at.
    now = newton.with_part(0, now);
    Err(newton.failure(&now, made, tolerance))
}

impl<const D: usize> Tied<'_, '_, D> {
    /// Forces below which a contact counts as open \[N\] in an iteration of a cold start.
    fn faint(&self, now: &At<D>, iterations: usize) -> f64 {
        let pairs = now.t.iter().zip(&self.problem.friction);
        let pressures = pairs.filter(|(_, law)| !law.is_tie()).map(|(t, _)| t[0]);
        match iterations {
            0 => 0.0,
            1 => FAINT[0] * pressures.fold(0.0, f64::max),
            2..=COLD => FAINT[1] * now.residual,
            _ => 0.0,
        }
    }

    /// Another α, at the same place.
    fn with_part(&mut self, part: usize, now: At<D>) -> At<D> {
        self.part = part;
        let summed = now.summed;
        At {
            summed,
            ..self.at(now.z, now.v)
        }
    }

    fn failure(&self, now: &At<D>, iterations: usize, tolerance: Tolerance) -> ContactError {
        if !self.factor.propped.is_empty() {
            return ContactError::Singular;
        }
        if !now.residual.is_finite() {
            return ContactError::NotFinite { what: "solution" };
        }
        ContactError::NotConverged {
            solver: "semismooth Newton through the factor",
            iterations,
            residual: now.residual,
            tolerance: tolerance.relative * self.force_scale(now),
        }
    }

    fn solution(
        &self,
        now: At<D>,
        iterations: usize,
        exact: bool,
    ) -> (ContactSolution<D>, DVector<f64>) {
        let status = self.statuses(&now, 0.0);
        // The projection of the last iterate lies in the cone exactly; it differs from t by less than the
        // residual.
        let force = now.t.iter().zip(&now.map).map(|(t, g)| t - g).collect();
        let solution = ContactSolution {
            residual: now.residual,
            motion: split(&now.v),
            displacement: now.u,
            irreversible: now.irreversible,
            force,
            status,
            iterations,
            exact,
        };
        (solution, now.z)
    }
}
