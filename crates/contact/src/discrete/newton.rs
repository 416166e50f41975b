//! Semismooth Newton method on the local form, regularised by a proximal point; not the method on the
//! condensed stiffness, see `SemismoothNewton`.

use super::blocks::{BlockMatrix, Factor};
use super::elimination::Elimination;
use super::problem::LocalProblem;
use moreau_laws::{Coulomb, Local};
use nalgebra::SMatrix;

/// The equation F(r, u) = 0 that Newton's method solves in place of the contact law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum NewtonMap {
    /// P. Alart and A. Curnier's augmented Lagrangian: r_n = (r_n − ρ_n u_n)⁺, and r_t the
    /// projection of r_t − ρ_t u_t on the disc of radius μ (r_n − ρ_n u_n)⁺ (*Comput. Methods Appl.
    /// Mech. Engrg.* 92 (1991) 353-375).
    #[default]
    AlartCurnier,
    /// The same with the disc of radius μ r_n⁺, after M. Jean and J. J. Moreau.
    JeanMoreau,
    /// The natural map r − proj(r − ρ ũ, K_μ) of \[90′\].
    Natural,
}

/// F of a contact with its derivatives: dF = A dr + B du.
struct Linearised<const D: usize> {
    map: Local<D>,
    force: SMatrix<f64, D, D>,
    displacement: SMatrix<f64, D, D>,
}

impl NewtonMap {
    fn linearise<const D: usize>(
        self,
        law: &Coulomb,
        rho: &Local<D>,
        r: &Local<D>,
        u: &Local<D>,
    ) -> Linearised<D> {
        let mut at = Linearised {
            map: Local::zeros(),
            force: SMatrix::zeros(),
            displacement: SMatrix::zeros(),
        };
        if self == Self::Natural {
            let rho = rho.mean();
            let prediction = r - rho * law.shifted(u);
            let projector = law.project_jacobian(&prediction);
            at.map = r - law.project(&prediction);
            at.force = SMatrix::identity() - projector;
            at.displacement = rho * projector * law.shifted_jacobian(u);
            return at;
        }
        let mu = law.friction();
        let prediction = r - rho.component_mul(u);
        let closed = prediction[0] > 0.0;
        if closed {
            at.map[0] = rho[0] * u[0];
            at.displacement[(0, 0)] = rho[0];
        } else {
            at.map[0] = r[0];
            at.force[(0, 0)] = 1.0;
        }
        let pressure = if self == Self::AlartCurnier {
            prediction[0]
        } else {
            r[0]
        };
        let radius = mu * pressure.max(0.0);
        let size = (1..D)
            .map(|k| prediction[k] * prediction[k])
            .sum::<f64>()
            .sqrt();
        if size <= radius && radius > 0.0 {
            for k in 1..D {
                at.map[k] = rho[k] * u[k];
                at.displacement[(k, k)] = rho[k];
            }
            return at;
        }
        for k in 1..D {
            at.map[k] = r[k];
            at.force[(k, k)] = 1.0;
        }
        if radius > 0.0 {
            let shrunk = radius / size;
            for k in 1..D {
                let d_k = prediction[k] / size;
                at.map[k] -= radius * d_k;
                for l in 1..D {
                    let turned = if k == l { 1.0 } else { 0.0 } - d_k * prediction[l] / size;
                    at.force[(k, l)] -= shrunk * turned;
                    at.displacement[(k, l)] += shrunk * rho[l] * turned;
                }
                at.force[(k, 0)] -= mu * d_k;
                if self == Self::AlartCurnier {
                    at.displacement[(k, 0)] += mu * rho[0] * d_k;
                }
            }
        }
        at
    }
}

/// u = W r + q + α |W_ii| (r − c): the problem with a compliance about the forces c at every
/// contact. It has the same solution as the problem itself where c is one, and a regular operator
/// whatever the rank of W.
pub(super) struct Proximal<'a, const D: usize> {
    pub(super) problem: &'a LocalProblem<D>,
    pub(super) alpha: f64,
    pub(super) centre: &'a [Local<D>],
}

impl<const D: usize> Proximal<'_, D> {
    /// Compliance added at contact i.
    #[inline]
    pub(super) fn spring(&self, i: usize) -> f64 {
        self.alpha * self.problem.compliance(i)
    }

    #[inline]
    pub(super) fn displacement_at(&self, i: usize, r: &[Local<D>]) -> Local<D> {
        self.problem.operator().row_times(i, r)
            + self.problem.free()[i]
            + (r[i] - self.centre[i]) * self.spring(i)
    }

    pub(super) fn displacement(&self, r: &[Local<D>]) -> Vec<Local<D>> {
        (0..r.len()).map(|i| self.displacement_at(i, r)).collect()
    }
}

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
    problem: &Proximal<D>,
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

struct Method<'a, 'b, const D: usize> {
    problem: &'a Proximal<'b, D>,
    map: NewtonMap,
    elimination: &'a mut Option<Elimination<D>>,
    /// ρ of every component.
    rho: Vec<Local<D>>,
}

/// Errors of a solution of Newton's equation, relative to F, above which it is refined, and above
/// which it is solved again with an exchange of pivots.
const REFINE: f64 = 1e-6;
const REFUSE: f64 = 1e-3;

impl<'a, 'b, const D: usize> Method<'a, 'b, D> {
    fn new(
        problem: &'a Proximal<'b, D>,
        map: NewtonMap,
        elimination: &'a mut Option<Elimination<D>>,
    ) -> Self {
        let rho = |i: usize| {
            let own = problem.problem.own(i);
            let tangential = (1..D).map(|k| own[(k, k)]).sum::<f64>() / (D.max(2) - 1) as f64;
            let mut rho = Local::repeat(1.0 / tangential.max(1e-3 * own[(0, 0)]));
            rho[0] = 1.0 / own[(0, 0)];
            rho
        };
        Self {
            problem,
            map,
            elimination,
            rho: (0..problem.problem.contacts()).map(rho).collect(),
        }
    }

    fn iterate(&self, r: Vec<Local<D>>, u: Vec<Local<D>>) -> Iterate<D> {
        let p = self.problem.problem;
        let linearise = |i| {
            let law: &Coulomb = &p.friction()[i];
            self.map.linearise(law, &self.rho[i], &r[i], &u[i])
        };
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
        let operator = self.problem.problem.operator();
        elimination.factorise(|i, add| {
            let at = &now.at[i];
            if opens[i] {
                return false;
            }
            for (j, block) in operator.row(i).filter(|(j, _)| !opens[*j]) {
                let spread = at.displacement * block;
                add(
                    j,
                    if j == i {
                        spread + self.own(i, at)
                    } else {
                        spread
                    },
                );
            }
            true
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

    /// A + s B of a contact.
    fn own(&self, i: usize, at: &Linearised<D>) -> SMatrix<f64, D, D> {
        at.force + at.displacement * self.problem.spring(i)
    }

    /// A step with its change of u, what it leaves of Newton's equation, and the square of that.
    fn check(
        &self,
        now: &Iterate<D>,
        opens: &[bool],
        force: Vec<Local<D>>,
    ) -> (Step<D>, Vec<Local<D>>, f64) {
        let operator = self.problem.problem.operator();
        let change = |i| operator.row_times(i, &force) + force[i] * self.problem.spring(i);
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
        let operator = self.problem.problem.operator();
        let mut place = vec![usize::MAX; force.len()];
        let active: Vec<usize> = (0..force.len()).filter(|i| !opens[*i]).collect();
        for (at, &i) in active.iter().enumerate() {
            place[i] = at;
        }
        let mut matrix = BlockMatrix::empty();
        for &i in &active {
            let at = &now.at[i];
            let row = operator.row(i).filter(|(j, _)| !opens[*j]);
            matrix.push_row(row.map(|(j, block)| {
                let spread = at.displacement * block;
                (
                    place[j],
                    if j == i {
                        spread + self.own(i, at)
                    } else {
                        spread
                    },
                )
            }));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A and B are the derivatives of F, in every branch of every map.
    #[test]
    fn derivatives_are_those_of_the_map() {
        let law = Coulomb::new(0.6).expect("valid");
        let rho = Local::<3>::new(1.3, 0.7, 0.7);
        let points = [
            ([1.0, 0.2, 0.1], [0.1, 0.05, -0.1]),
            ([1.0, 0.9, -0.5], [0.1, -0.8, 0.3]),
            ([0.1, 0.2, 0.1], [0.9, -0.8, 0.3]),
            ([-0.4, 0.2, 0.1], [-0.9, -0.8, 0.3]),
        ];
        for map in [
            NewtonMap::AlartCurnier,
            NewtonMap::JeanMoreau,
            NewtonMap::Natural,
        ] {
            let rho = if map == NewtonMap::Natural {
                Local::repeat(rho.mean())
            } else {
                rho
            };
            for (r, u) in points {
                let (r, u) = (Local::<3>::from(r), Local::<3>::from(u));
                let at = map.linearise(&law, &rho, &r, &u);
                for k in 0..3 {
                    let mut d = Local::<3>::zeros();
                    d[k] = 1e-6;
                    let f = |r: &Local<3>, u: &Local<3>| map.linearise(&law, &rho, r, u).map;
                    let by_force = (f(&(r + d), &u) - f(&(r - d), &u)) / 2e-6;
                    let by_displacement = (f(&r, &(u + d)) - f(&r, &(u - d))) / 2e-6;
                    assert!(
                        (by_force - at.force.column(k)).norm() < 1e-8,
                        "{map:?} {r} {u}"
                    );
                    assert!((by_displacement - at.displacement.column(k)).norm() < 1e-8);
                }
            }
        }
    }
}
