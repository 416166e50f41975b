//! What an iteration begins with: the last solution, or what is closed before anything has moved.

use super::At;
use crate::solvers::ContactSolution;
use crate::tied::TiedProblem;
use moreau_laws::Local;

/// Force of a contact of which nothing is known but that it is closed \[N\]: it vanishes beside any other, and tells on
/// which side of its kink the law is.
const VANISHING: f64 = 1e-100;

/// A pair (u, t) that obeys the law, of which the statuses are expected.
pub(super) struct Guess<const D: usize> {
    pub(super) u: Vec<Local<D>>,
    pub(super) irreversible: Vec<Local<D>>,
    pub(super) t: Vec<Local<D>>,
}

impl<const D: usize> Guess<D> {
    /// The last solution; without one, what is closed before anything has moved sticks.
    pub(super) fn new(problem: &TiedProblem<'_, D>, solution: Option<&ContactSolution<D>>) -> Self {
        if let Some(s) = solution {
            return Self {
                u: s.displacement.clone(),
                irreversible: s.irreversible.clone(),
                t: s.force.clone(),
            };
        }
        let closed = |(i, g): (usize, &Local<D>)| {
            let mut pair = (Local::zeros(), Local::zeros());
            match g[0] <= 0.0 {
                _ if problem.friction[i].is_tie() => {}
                true => pair.1[0] = VANISHING,
                false => pair.0[0] = g[0],
            }
            pair
        };
        let pairs = problem.origin.iter().enumerate().map(closed);
        let (u, t): (Vec<Local<D>>, Vec<Local<D>>) = pairs.unzip();
        Self {
            irreversible: u.clone(),
            u,
            t,
        }
    }

    /// Takes a contact as closed.
    pub(super) fn close(&mut self, i: usize) {
        self.u[i] = Local::zeros();
        self.irreversible[i] = Local::zeros();
        self.t[i] = Local::zeros();
        self.t[i][0] = VANISHING;
    }
}

impl<const D: usize> From<At<D>> for Guess<D> {
    fn from(at: At<D>) -> Self {
        Self {
            u: at.u,
            irreversible: at.irreversible,
            t: at.t,
        }
    }
}
