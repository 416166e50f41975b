//! Semismooth Newton method on the natural map; not a regularisation: its zeros are the law.

mod linearised;

use self::linearised::Row;
use super::{
    Auto, ContactSolution, ContactSolver, GaussSeidel, Goal, LocalSolver, Tolerance, Uzawa,
    expect_enough, expect_guess, is_within,
};
use crate::problem::{size_of_map, statuses};
use crate::{CondensedProblem, ContactError, Springs};
use moreau_laws::{Friction, Local};
use nalgebra::{DVector, SMatrix};

/// Newton's method on t − proj(t − α ũ) = 0, \[90′\], with t = S (u − g) − f.
///
/// It works on S, not on its inverse, so that it also treats bodies which only contact holds.
/// The map is piecewise smooth and, once the statuses are right, almost linear: it ends after a
/// handful of iterations. Steps are damped on the norm of the map; where that stalls, another α
/// is tried, which moves the kinks and not the zeros, and then sweeps of the other methods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SemismoothNewton {
    /// When to stop.
    pub tolerance: Tolerance,
}

impl Default for SemismoothNewton {
    fn default() -> Self {
        Self {
            tolerance: Tolerance::new(1e-12, 300),
        }
    }
}

impl<const D: usize> ContactSolver<D> for SemismoothNewton {
    fn approach(
        &self,
        problem: &CondensedProblem<D>,
        guess: Option<&ContactSolution<D>>,
        enough: f64,
    ) -> Result<ContactSolution<D>, ContactError> {
        newton(problem, Local::zeros(), guess, (self.tolerance, enough))
    }

    fn step(
        &self,
        problem: &CondensedProblem<D>,
        force: &[Local<D>],
    ) -> Option<ContactSolution<D>> {
        let springs = vec![Springs::default(); problem.contacts()];
        let newton = Newton {
            problem,
            springs: &springs,
            part: PARTS[0],
        };
        let here = vec![Local::zeros(); problem.contacts()];
        let now = newton.iterate(here.clone());
        let row = |(i, t): (usize, &Local<D>)| {
            let (law, alpha) = (&problem.laws()[i], newton.alpha(i));
            let (projector, shift) = law.correct_jacobian(&now.u[i], t, alpha);
            let elastic = SMatrix::identity() - projector;
            // Forces are unknowns of their own: they change from t to those of the displacements.
            let value = -law.natural_map(&now.u[i], t, alpha) - elastic * (now.t[i] - t);
            Row {
                elastic,
                shift,
                value,
            }
        };
        let rows = force.iter().enumerate().map(row).collect();
        let next = newton.iterate(add(&here, &linearised::solve(problem, rows)?, 1.0));
        let forces = next.t.clone();
        let target = newton.part * self.tolerance.relative * problem.force_scale(&next.t);
        let exact = is_within(next.residual, target.max(problem.rounding(&next.x)));
        let mut solution = newton.solution(next, 1, exact);
        if !exact {
            // In balance, as those of the law are not.
            solution.force = forces;
        }
        Some(solution)
    }

    fn springs(&self) -> Option<(Local<D>, Tolerance)> {
        Some((Local::zeros(), self.tolerance))
    }
}

/// α of the map, in parts of the stiffness of the contact's own components, and the parts to try
/// where Newton stalls. A tenth is about the inverse of a diagonal of W on a structure; there
/// damped Newton solved all of 1 000 random problems with μ < 0.35, at ten times the value nine
/// of ten.
const PARTS: [f64; 3] = [0.1, 1.0, 0.01];

/// How far the nearest contacts are beyond the first, in parts of how far the last is.
const NEAREST: f64 = 1e-3;

/// Iterations for one of the parts.
const ATTEMPT: usize = 30;

/// The state of the iteration: displacements x = u − g and all that follows from them. Gaps far
/// from contact are large; their differences from the origin keep the forces free of rounding.
struct Iterate<const D: usize> {
    x: Vec<Local<D>>,
    u: Vec<Local<D>>,
    t: Vec<Local<D>>,
    /// u + C (t − t₀*): the part that obeys the law.
    irreversible: Vec<Local<D>>,
    map: Vec<Local<D>>,
    residual: f64,
    merit: f64,
}

/// Newton on the natural map at u + C (t − t₀*), with a diagonal compliance C \[mm/N\] of every contact
/// (zero: the exact law) and t₀* = (0, t₀ₜ), the penalty of \[81\]–\[82\] as a spring in series. Ties have none.
pub(super) fn newton<const D: usize>(
    problem: &CondensedProblem<D>,
    compliance: Local<D>,
    guess: Option<&ContactSolution<D>>,
    (tolerance, enough): (Tolerance, f64),
) -> Result<ContactSolution<D>, ContactError> {
    expect_guess(problem.contacts(), guess)?;
    let enough = expect_enough(enough)?;
    let springs: Vec<Springs<D>> = (problem.previous().iter().zip(problem.laws()))
        .map(|(previous, law)| Springs::of_penalty(compliance, *previous, law))
        .collect();
    let zero = vec![Local::zeros(); problem.contacts()];
    let mut start = guess.map_or(zero, |g| problem.relative(&g.displacement));
    let mut iterations = 0;
    let (mut part, mut sweeps) = (0, 0);
    // A body that only contact holds has no stiffness against contacts that are open at the start: then start again with
    // all of them closed, and where that leads nowhere with the nearest held.
    let begun = start.clone();
    let (mut may_close, mut floats) = (true, false);
    let mut is_stable = false;
    loop {
        let newton = Newton {
            problem,
            springs: &springs,
            part: PARTS[part % PARTS.len()],
        };
        let mut now = newton.iterate(start.clone());
        if !now.residual.is_finite() {
            return Err(ContactError::NotFinite { what: "solution" });
        }
        for _ in 0..ATTEMPT {
            // The residual grows with α, at most in proportion: this bounds it for the common α.
            let target = newton.part * tolerance.relative * problem.force_scale(&now.t);
            let target = target.max(problem.rounding(&now.x) + newton.rounding_of_sums(&now));
            if is_within(now.residual, target.max(newton.part * enough)) {
                let exact = now.residual <= target;
                return Ok(newton.solution(now, iterations, exact));
            }
            if iterations >= tolerance.iterations {
                return Err(newton.stalled(now, iterations, tolerance));
            }
            iterations += 1;
            let Some(next) = newton.advance(&now) else {
                break;
            };
            now = next;
        }
        if may_close && newton.step(&now).is_none() {
            may_close = false;
            start = all_closed(problem, &begun);
            continue;
        }
        // There may be no solution, and if there is another α hardly finds it.
        is_stable = is_stable || !problem.is_unstable();
        if !is_stable {
            return Err(ContactError::Singular);
        }
        part += 1;
        // When all have stalled, sweeps find the statuses; where no inverse exists, or only a huge one, there are none.
        if part % PARTS.len() == 0 {
            if floats || problem.is_faintly_held() {
                return Err(ContactError::Singular);
            }
            start = loop {
                // From where Newton got to, then from nothing: from there once more would be the same once more.
                sweeps += 1;
                let swept = match sweeps {
                    1 => newton.sweep(&now.t),
                    2 => newton.sweep(&vec![Local::zeros(); now.t.len()]),
                    _ => return Err(newton.stalled(now, iterations, tolerance)),
                };
                match swept {
                    Ok(u) => break problem.relative(&u),
                    Err(ContactError::Singular) => {
                        floats = true;
                        break nearest_held(problem, &begun).ok_or(ContactError::Singular)?;
                    }
                    Err(_) => {}
                }
            };
        }
    }
}

struct Newton<'a, const D: usize> {
    problem: &'a CondensedProblem<D>,
    springs: &'a [Springs<D>],
    part: f64,
}

impl<const D: usize> Newton<'_, D> {
    /// α of \[90′\]: the stiffness of the structure and of the penalty spring in series.
    fn alpha(&self, i: usize) -> f64 {
        let alpha = self.part * self.problem.alpha(i);
        let compliance = self.springs[i].compliance.mean();
        alpha / (1.0 + alpha * compliance)
    }

    fn iterate(&self, x: Vec<Local<D>>) -> Iterate<D> {
        let t = self.problem.force_of(&x);
        self.at(x, t)
    }

    /// The iterate at displacements with their forces.
    fn at(&self, x: Vec<Local<D>>, t: Vec<Local<D>>) -> Iterate<D> {
        let p = self.problem;
        let u: Vec<Local<D>> = x.iter().zip(p.origin()).map(|(x, g)| x + g).collect();
        let irreversible: Vec<Local<D>> = (0..u.len())
            .map(|i| u[i] + self.springs[i].elongation(&t[i]))
            .collect();
        let map: Vec<Local<D>> = (0..u.len())
            .map(|i| p.laws()[i].natural_map(&irreversible[i], &t[i], self.alpha(i)))
            .collect();
        let size = |i: usize| size_of_map(&map[i], &irreversible[i], &t[i]);
        let residual = (0..map.len()).map(size).fold(0.0, f64::max);
        // Divided by α a square is an energy: contacts of unlike stiffness weigh alike.
        let energy = |(i, g): (usize, &Local<D>)| g.norm_squared() / self.alpha(i);
        let merit = map.iter().enumerate().map(energy).sum();
        Iterate {
            x,
            u,
            t,
            irreversible,
            map,
            residual,
            merit,
        }
    }

    /// Displacements after sweeps of another method, with the springs in series with the structure.
    fn sweep(&self, t: &[Local<D>]) -> Result<Vec<Local<D>>, ContactError> {
        let p = self.problem;
        let form = p.local()?.in_series(|i| self.springs[i]);
        // A sweep costs 2 n² operations and a step up to ⅔ n³: no more of them than the attempts
        // with all parts may have taken, or a problem that neither solves takes a hundred times as
        // long as to cut the increment. What takes a tenth of a second is never too much.
        let size = D * p.contacts();
        let quick = 50_000_000 / (size * size).max(1);
        let tolerance = Tolerance {
            relative: 1e-8,
            iterations: (ATTEMPT * size).max(quick).min(20_000),
        };
        let goal = || Goal::of_start(p, tolerance);
        // Where sweeps cycle, which takes a large friction, corrections may not, and conversely; and
        // the methods for the local form arrive where neither does.
        let swept = GaussSeidel::extrapolated(&form, t.to_vec(), goal()).or_else(|_| {
            let mut goal = goal();
            let judge = |k, t: &[Local<D>], u: &[Local<D>]| goal.judge("Uzawa", k, t, u);
            Uzawa::corrections(&form, t.to_vec(), judge)
        });
        let (force, displacement) = match swept {
            Ok(swept) => (swept.force, swept.displacement),
            Err(error) => {
                let found = Auto::default().solve(&form, Some(t)).map_err(|_| error)?;
                (found.force, found.displacement)
            }
        };
        let own = |(i, v): (usize, &Local<D>)| v - self.springs[i].elongation(&force[i]);
        Ok(displacement.iter().enumerate().map(own).collect())
    }

    /// The next iterate: a Newton step, halved until the map decreases; `None` if it does not or
    /// if the matrix is singular.
    fn advance(&self, now: &Iterate<D>) -> Option<Iterate<D>> {
        let step = self.step(now)?;
        let whole = self.iterate(add(&now.x, &step, 1.0));
        let descends = |next: &Iterate<D>, s: f64| next.merit < (1.0 - 1e-4 * s) * now.merit;
        if descends(&whole, 1.0) {
            return Some(whole);
        }
        let mut s = 0.5;
        while s > 1e-4 {
            // Forces are linear in displacements.
            let between = |(t, after): (&Local<D>, &Local<D>)| t + (after - t) * s;
            let forces = now.t.iter().zip(&whole.t).map(between).collect();
            let next = self.at(add(&now.x, &step, s), forces);
            if descends(&next, s) {
                return Some(next);
            }
            s *= 0.5;
        }
        None
    }

    /// Newton step of the map; `None` if its matrix is singular.
    fn step(&self, now: &Iterate<D>) -> Option<DVector<f64>> {
        let row = |(i, law): (usize, &Friction)| {
            let (v, t) = (&now.irreversible[i], &now.t[i]);
            // dT = P dt − A du, with P the projector and A = α P ∂ũ/∂u under Coulomb's law:
            // dG = [(1 − P) + A C] S du + A du
            let (projector, shift) = law.correct_jacobian(v, t, self.alpha(i));
            let compliance = SMatrix::from_diagonal(&self.springs[i].compliance);
            Row {
                elastic: SMatrix::identity() - projector + shift * compliance,
                shift,
                value: -now.map[i],
            }
        };
        let laws = self.problem.laws().iter().enumerate();
        // A rigid motion that no contact stops leaves the matrix singular.
        linearised::solve(self.problem, laws.map(row).collect())
    }

    /// The error of an iteration that leads nowhere.
    fn stalled(&self, now: Iterate<D>, iterations: usize, tolerance: Tolerance) -> ContactError {
        let solution = self.solution(now, iterations, false);
        ContactError::NotConverged {
            solver: "semismooth Newton",
            iterations,
            residual: solution.residual,
            tolerance: tolerance.relative * self.problem.force_scale(&solution.force),
        }
    }

    /// The projections of the forces of an iterate, which lie in the cone exactly; those of the last differ from its t by less
    /// than the residual.
    fn projected(now: &Iterate<D>) -> Vec<Local<D>> {
        now.t.iter().zip(&now.map).map(|(t, map)| t - map).collect()
    }

    /// [`CondensedProblem::rounding_of_origin`] of what presses.
    fn rounding_of_sums(&self, now: &Iterate<D>) -> f64 {
        self.problem.rounding_of_origin(&Self::projected(now))
    }

    fn solution(&self, now: Iterate<D>, iterations: usize, exact: bool) -> ContactSolution<D> {
        let p = self.problem;
        let force = Self::projected(&now);
        let status = statuses(p.laws(), &now.irreversible, &now.t, |i| self.alpha(i));
        ContactSolution {
            residual: p.residual(&now.irreversible, &force),
            displacement: now.u,
            motion: now.x,
            irreversible: now.irreversible,
            force,
            status,
            iterations,
            exact,
        }
    }
}

/// The same slips at closed gaps.
fn all_closed<const D: usize>(problem: &CondensedProblem<D>, x: &[Local<D>]) -> Vec<Local<D>> {
    let closed =
        |(x, g): (&Local<D>, &Local<D>)| Local::from_fn(|k, _| if k == 0 { -g[0] } else { x[k] });
    x.iter().zip(problem.origin()).map(closed).collect()
}

/// Where the contacts with next to the smallest gap stick and the others are without force; `None` if that does not hold
/// the bodies.
fn nearest_held<const D: usize>(
    problem: &CondensedProblem<D>,
    x: &[Local<D>],
) -> Option<Vec<Local<D>>> {
    let gaps = || problem.origin().iter().map(|g| g[0]);
    let least = gaps().fold(f64::INFINITY, f64::min);
    let most = gaps().fold(f64::NEG_INFINITY, f64::max);
    let forces = problem.force_of(x);
    let row = |(x, (g, t)): (&Local<D>, (&Local<D>, Local<D>))| {
        let holds = g[0] - least <= NEAREST * (most - least);
        let one = SMatrix::identity();
        match holds {
            true => Row {
                elastic: one * 0.0,
                shift: one,
                value: -(x + g),
            },
            false => Row {
                elastic: one,
                shift: one * 0.0,
                value: -t,
            },
        }
    };
    let rows = x.iter().zip(problem.origin().iter().zip(forces)).map(row);
    let step = linearised::solve(problem, rows.collect())?;
    Some(add(x, &step, 1.0))
}

fn add<const D: usize>(u: &[Local<D>], step: &DVector<f64>, s: f64) -> Vec<Local<D>> {
    u.iter()
        .enumerate()
        .map(|(i, u)| Local::from_fn(|k, _| u[k] + s * step[D * i + k]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::{AnisotropicCoulomb, Coulomb, LimitedCoulomb, Tresca};
    use nalgebra::DMatrix;

    /// Where Newton's method stalls, sweeps lead to a displacement at which its map vanishes: under every law,
    /// with springs in series and without.
    #[test]
    fn sweeps_end_where_the_map_vanishes() {
        let laws: [Friction; 4] = [
            Coulomb::new(0.3).expect("valid").into(),
            Tresca::new(0.2).expect("valid").into(),
            LimitedCoulomb::new(0.3, 0.2).expect("valid").into(),
            AnisotropicCoulomb::new(0.3, 0.1).expect("valid").into(),
        ];
        let n = 12;
        let a = DMatrix::from_fn(n, n, |i, j| ((7 * i * i + 3 * j * j + i * j) as f64).sin());
        let w = &a * a.transpose() + DMatrix::identity(n, n) * 0.05;
        let q = |i: usize| Local::<3>::new(-0.4 + (i as f64 * 1.7).sin(), 0.3, -0.2);
        let free: Vec<_> = (0..4).map(q).collect();
        for (law, compliance) in laws.iter().flat_map(|l| [0.0, 0.5, 20.0].map(|c| (*l, c))) {
            let problem = CondensedProblem::from_delassus(w.clone(), &free, vec![law; 4]);
            let problem = problem.expect("definite");
            let springs = vec![
                Springs {
                    compliance: Local::<3>::new(compliance, 0.3 * compliance, 0.3 * compliance),
                    force: Local::<3>::new(0.0, 0.1, -0.2),
                };
                4
            ];
            let newton = Newton {
                problem: &problem,
                springs: &springs,
                part: PARTS[0],
            };
            let u = newton.sweep(&[Local::zeros(); 4]).expect("solvable");
            let at = newton.iterate(problem.relative(&u));
            assert!(at.t.iter().any(|t| t[0] > 1e-3), "nothing touches");
            assert!(at.residual < 1e-7, "{law:?}, {compliance}: {}", at.residual);
        }
    }
}
