//! Semismooth Newton method on the local form; not the method on the condensed stiffness, see
//! `SemismoothNewton`, nor what makes a singular W regular, see `ProximalNewton`.

pub(super) mod map;

use super::elimination::Elimination;
use crate::problem::{BlockMatrix, Factor, LocalProblem};
use map::{Linearised, NewtonMap};
use moreau_laws::Local;
use nalgebra::SMatrix;

/// Earlier merits among which the largest must decrease: full steps past a kink are let through.
const MEMORY: usize = 5;

/// Steps over which the residual must halve.
const PATIENCE: usize = 10;

/// Shortest step that is tried: who needs a shorter one fares better with a softer problem.
const SHORTEST: f64 = 0.1;

/// What a run of Newton's method came to.
pub(super) struct Run<const D: usize> {
    pub(super) force: Vec<Local<D>>,
    pub(super) iterations: usize,
    /// Natural-map residual of the regularised problem at `force`, by the first measure.
    pub(super) residual: f64,
    /// Whether it ended at a singular matrix.
    pub(super) singular: bool,
}

/// Newton's method with a nonmonotone line search, from r until the residual is at most `target` or
/// the iteration stalls; the best iterate met.
pub(super) fn newton<const D: usize>(
    problem: &LocalProblem<D>,
    map: NewtonMap,
    elimination: &mut Option<Elimination<D>>,
    start: &[Local<D>],
    target: f64,
    limit: usize,
) -> Run<D> {
    let mut method = Method::new(problem, map, elimination);
    let mut now = method.iterate(start.to_vec(), problem.displacement(start));
    let mut best = Run {
        force: now.r.clone(),
        iterations: 0,
        residual: now.residual,
        singular: false,
    };
    let mut merits = vec![now.merit];
    let mut iterations = 0;
    let mut milestone = (0, best.residual);
    while best.residual > target && iterations < limit {
        if best.residual < 0.5 * milestone.1 {
            milestone = (iterations, best.residual);
        } else if iterations >= milestone.0 + PATIENCE {
            break;
        }
        iterations += 1;
        let Some(step) = method.step(&now) else {
            best.singular = true;
            break;
        };
        let reference = merits
            .iter()
            .rev()
            .take(MEMORY)
            .fold(0.0, |m: f64, v| m.max(*v));
        let mut length = 1.0;
        let next = loop {
            let moved = |(a, d): (&Local<D>, &Local<D>)| a + d * length;
            let r = now.r.iter().zip(&step.force).map(moved).collect();
            let u = now.u.iter().zip(&step.displacement).map(moved).collect();
            let next = method.iterate(r, u);
            if next.merit < (1.0 - 1e-4 * length) * reference {
                break Some(next);
            }
            length *= 0.5;
            if length < SHORTEST {
                break None;
            }
        };
        let Some(next) = next else { break };
        now = next;
        merits.push(now.merit);
        if now.residual < best.residual {
            best.force.clone_from(&now.r);
            best.residual = now.residual;
        }
    }
    best.iterations = iterations;
    best
}

struct Iterate<const D: usize> {
    r: Vec<Local<D>>,
    u: Vec<Local<D>>,
    /// F and its derivatives.
    at: Vec<Linearised<D>>,
    merit: f64,
    residual: f64,
}

/// A Newton step, and the change of u that it makes.
struct Step<const D: usize> {
    force: Vec<Local<D>>,
    displacement: Vec<Local<D>>,
}

struct Method<'a, const D: usize> {
    problem: &'a LocalProblem<D>,
    map: NewtonMap,
    elimination: &'a mut Option<Elimination<D>>,
    /// ρ of every component.
    rho: Vec<Local<D>>,
}

/// Errors of a solution of Newton's equation, relative to F, above which it is refined, and above
/// which it is solved again with an exchange of pivots.
const REFINE: f64 = 1e-6;
const REFUSE: f64 = 1e-3;

impl<'a, const D: usize> Method<'a, D> {
    fn new(
        problem: &'a LocalProblem<D>,
        map: NewtonMap,
        elimination: &'a mut Option<Elimination<D>>,
    ) -> Self {
        let rho = |i: usize| {
            let own = problem.own(i);
            let tangential = (1..D).map(|k| own[(k, k)]).sum::<f64>() / (D.max(2) - 1) as f64;
            let mut rho = Local::repeat(1.0 / tangential.max(1e-3 * own[(0, 0)]));
            rho[0] = 1.0 / own[(0, 0)];
            rho
        };
        Self {
            problem,
            map,
            elimination,
            rho: (0..problem.contacts()).map(rho).collect(),
        }
    }

    fn iterate(&self, r: Vec<Local<D>>, u: Vec<Local<D>>) -> Iterate<D> {
        let p = self.problem;
        let linearise = |i| self.map.linearise(&p.laws()[i], &self.rho[i], &r[i], &u[i]);
        let at: Vec<Linearised<D>> = (0..r.len()).map(linearise).collect();
        // Multiplied by a compliance a square is an energy: unlike contacts weigh alike.
        let energy = |(i, at): (usize, &Linearised<D>)| at.map.norm_squared() * p.compliance(i);
        Iterate {
            merit: at.iter().enumerate().map(energy).sum(),
            residual: p.size(&r, &u),
            r,
            u,
            at,
        }
    }

    /// Newton step; `None` if the matrix is singular.
    fn step(&mut self, now: &Iterate<D>) -> Option<Step<D>> {
        let contacts = now.r.len();
        let mut force = vec![Local::<D>::zeros(); contacts];
        // Where F does not see displacements its step is known: contacts that open.
        let mut opens = vec![false; contacts];
        for (i, at) in now.at.iter().enumerate() {
            opens[i] = at.displacement.iter().all(|b| *b == 0.0);
            if opens[i] {
                force[i] = -(at.force.try_inverse()? * at.map);
            }
        }
        if let Some(mut elimination) = self.elimination.take() {
            let step = self.eliminate(&mut elimination, now, &opens, force.clone());
            *self.elimination = Some(elimination);
            if step.is_some() {
                return step;
            }
        }
        self.exchange(now, &opens, force)
    }

    /// The step by elimination of the contacts that do not open; `None` if it is not good enough.
    fn eliminate(
        &self,
        elimination: &mut Elimination<D>,
        now: &Iterate<D>,
        opens: &[bool],
        force: Vec<Local<D>>,
    ) -> Option<Step<D>> {
        elimination.factorise(|i, add| {
            if !opens[i] {
                self.row(i, now, opens).for_each(|(j, block)| add(j, block));
            }
            !opens[i]
        })?;
        let size: f64 = now.at.iter().map(|at| at.map.norm_squared()).sum();
        let (mut step, mut left, _) = self.check(now, opens, force);
        let mut correction = left.clone();
        for bound in [REFINE, REFUSE] {
            elimination.solve(&left, &mut correction);
            for (i, d) in correction.iter().enumerate() {
                step.force[i] += d;
            }
            let error;
            (step, left, error) = self.check(now, opens, step.force);
            if error <= bound * bound * size {
                return Some(step);
            }
        }
        None
    }

    /// The blocks A + B W of a contact's row of the matrix, at contacts that do not open.
    fn row(
        &self,
        i: usize,
        now: &Iterate<D>,
        opens: &[bool],
    ) -> impl Iterator<Item = (usize, SMatrix<f64, D, D>)> {
        let at = &now.at[i];
        let active = self.problem.operator().row(i).filter(|(j, _)| !opens[*j]);
        active.map(move |(j, block)| {
            let spread = at.displacement * block;
            (j, if j == i { spread + at.force } else { spread })
        })
    }

    /// A step with its change of u, what it leaves of Newton's equation, and the square of that.
    fn check(
        &self,
        now: &Iterate<D>,
        opens: &[bool],
        force: Vec<Local<D>>,
    ) -> (Step<D>, Vec<Local<D>>, f64) {
        let operator = self.problem.operator();
        let change = |i| operator.row_times(i, &force);
        let displacement: Vec<Local<D>> = (0..force.len()).map(change).collect();
        let left = |(i, at): (usize, &Linearised<D>)| match opens[i] {
            true => Local::zeros(),
            false => -at.map - at.force * force[i] - at.displacement * displacement[i],
        };
        let left: Vec<Local<D>> = now.at.iter().enumerate().map(left).collect();
        let error = left.iter().map(|left| left.norm_squared()).sum();
        let step = Step {
            force,
            displacement,
        };
        (step, left, error)
    }

    /// The step by a factorisation with pivoting; `None` if the matrix is singular.
    fn exchange(
        &self,
        now: &Iterate<D>,
        opens: &[bool],
        mut force: Vec<Local<D>>,
    ) -> Option<Step<D>> {
        let mut place = vec![usize::MAX; force.len()];
        let active: Vec<usize> = (0..force.len()).filter(|i| !opens[*i]).collect();
        for (at, &i) in active.iter().enumerate() {
            place[i] = at;
        }
        let mut matrix = BlockMatrix::empty();
        for &i in &active {
            let row = self.row(i, now, opens);
            matrix.push_row(row.map(|(j, block)| (place[j], block)));
        }
        let (_, left, _) = self.check(now, opens, force.clone());
        let rhs: Vec<Local<D>> = active.iter().map(|&i| left[i]).collect();
        let solved = Factor::new(&matrix)?.solve(&rhs)?;
        for (&i, solved) in active.iter().zip(solved) {
            force[i] = solved;
        }
        Some(self.check(now, opens, force).0)
    }
}
