//! Block Gauss–Seidel with an exact local solver; not a relaxation that needs a parameter.

use super::fixed_point::fixed_point;
use super::local::{Best, LocalSolver, Reason, Unsolved, start};
use super::one_contact::{self, Bound};
use super::{
    ContactSolution, ContactSolver, Goal, LocalSolution, Tolerance, expect_enough, forces,
};
use crate::{CondensedProblem, ContactError, LocalProblem};
use moreau_laws::Local;

const NAME: &str = "Gauss-Seidel";

/// One contact at a time, on u = W t + q: the forces of all others are frozen, the local law is
/// solved exactly, sweep after sweep (the non-smooth contact dynamics method of Jean and Moreau).
/// On a condensed problem Anderson's method extrapolates between the sweeps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaussSeidel {
    /// When to stop; an iteration is a sweep over all contacts.
    pub tolerance: Tolerance,
}

impl Default for GaussSeidel {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::new(1e-10, 200_000),
        }
    }
}

impl<const D: usize> ContactSolver<D> for GaussSeidel {
    fn approach(
        &self,
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        let enough = expect_enough(enough)?;
        let form = problem.delassus()?;
        let goal = Goal::new(problem, self.tolerance, enough);
        Self::extrapolated(&form, forces(&form, guess)?, goal)
    }
}

impl GaussSeidel {
    /// Extrapolated sweeps over u = W t + q, which need not be the form of the goal's problem.
    pub(super) fn extrapolated<const D: usize>(
        form: &LocalProblem<D>,
        start: Vec<Local<D>>,
        mut goal: Goal<D>,
    ) -> Result<ContactSolution<D>, ContactError> {
        let swept = |mut t: Vec<Local<D>>| {
            sweep(form, &mut t);
            t
        };
        fixed_point(form, start, swept, |k, t, u| goal.judge(NAME, k, t, u))
    }
}

/// Sweeps between two looks at the residual, which costs as much as a sweep.
const LOOK: usize = 8;

/// Sweeps over which the residual must fall by a tenth.
const PATIENCE: usize = 2_000;

impl<const D: usize> LocalSolver<D> for GaussSeidel {
    fn tolerance(&self) -> f64 {
        self.tolerance.relative
    }

    fn solve_to(
        &self,
        problem: &LocalProblem<D>,
        guess: Option<&[Local<D>]>,
        tolerance: f64,
    ) -> Result<LocalSolution<D>, Unsolved<D>> {
        let mut r = start(problem, guess);
        let mut best = Best::new(LocalSolution::at(problem, r.clone(), 0, NAME));
        let mut cycle = Cycle::new(r.clone());
        let mut reason = Reason::Iterations;
        for sweeps in 1..=self.tolerance.iterations {
            if best.size() <= tolerance {
                break;
            }
            let change = sweep(problem, &mut r);
            if sweeps % LOOK == 0 || change <= tolerance {
                let now = LocalSolution::at(problem, r.clone(), sweeps, NAME);
                if best.take(now, sweeps) > PATIENCE {
                    reason = Reason::Stalled;
                    break;
                }
            }
            if let Some(period) = cycle.closed(&r)
                && best.size() > tolerance
            {
                reason = match period {
                    1 => Reason::Stalled,
                    _ => Reason::Cycling { period },
                };
                break;
            }
        }
        best.judge(tolerance, reason)
    }
}

/// R. P. Brent's search for a cycle: iterates against one of the past.
struct Cycle<const D: usize> {
    past: Vec<Local<D>>,
    /// Iterates since, and after how many it is replaced.
    since: usize,
    span: usize,
}

impl<const D: usize> Cycle<D> {
    fn new(past: Vec<Local<D>>) -> Self {
        Self {
            past,
            since: 0,
            span: 1,
        }
    }

    /// The period, if the next iterate closes a cycle.
    fn closed(&mut self, r: &[Local<D>]) -> Option<usize> {
        self.since += 1;
        let size: f64 = r.iter().map(|r| r.norm_squared()).sum();
        let distance = |(r, p): (&Local<D>, &Local<D>)| (r - p).norm_squared();
        let far: f64 = r.iter().zip(&self.past).map(distance).sum();
        if far <= (f64::EPSILON * f64::EPSILON) * size {
            return Some(self.since);
        }
        if self.since == self.span {
            self.past.copy_from_slice(r);
            (self.since, self.span) = (0, 2 * self.span);
        }
        None
    }
}

/// One sweep over all contacts, the forces of all others frozen; the relative change of the forces.
pub(super) fn sweep<const D: usize>(problem: &LocalProblem<D>, r: &mut [Local<D>]) -> f64 {
    let laws = problem.laws();
    sweep_under(problem, |i| Bound::of(&laws[i]), r)
}

/// One sweep with other bounds of the shear than those of the laws.
pub(super) fn sweep_under<const D: usize>(
    problem: &LocalProblem<D>,
    bound: impl Fn(usize) -> Bound,
    r: &mut [Local<D>],
) -> f64 {
    let (mut change, mut size) = (0.0, 0.0);
    for i in 0..r.len() {
        let own = problem.own(i);
        let q = problem.operator().row_times(i, r) + problem.free()[i] - own * r[i];
        let updated = one_contact::solve((own, &q), &problem.laws()[i], bound(i), &r[i]);
        change += (updated - r[i]).norm_squared();
        size += updated.norm_squared();
        r[i] = updated;
    }
    if change == 0.0 {
        0.0
    } else {
        (change / size).sqrt()
    }
}
