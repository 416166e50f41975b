//! Semismooth Newton method on the local form, regularised by a proximal point; not the method on the
//! condensed stiffness, see `SemismoothNewton`.

use super::blocks::{BlockMatrix, Factor};
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
        let size = (1..D).fold(0.0, |norm: f64, k| norm.hypot(prediction[k]));
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
    start: &[Local<D>],
    target: f64,
    limit: usize,
) -> Run<D> {
    let method = Method::new(problem, map);
    let mut now = method.iterate(start.to_vec());
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
            let moved = |(r, d): (&Local<D>, &Local<D>)| r + d * length;
            let next = method.iterate(now.r.iter().zip(&step).map(moved).collect());
            if next.merit < (1.0 - 1e-4 * length) * reference {
                break Some(next);
            }
            length *= 0.5;
            if length < 1e-3 {
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
    merit: f64,
    residual: f64,
}

struct Method<'a, 'b, const D: usize> {
    problem: &'a Proximal<'b, D>,
    map: NewtonMap,
    /// ρ of every component.
    rho: Vec<Local<D>>,
}

impl<'a, 'b, const D: usize> Method<'a, 'b, D> {
    fn new(problem: &'a Proximal<'b, D>, map: NewtonMap) -> Self {
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
            rho: (0..problem.problem.contacts()).map(rho).collect(),
        }
    }

    fn iterate(&self, r: Vec<Local<D>>) -> Iterate<D> {
        let p = self.problem.problem;
        let u = self.problem.displacement(&r);
        // Multiplied by a compliance a square is an energy: unlike contacts weigh alike.
        let merit = (0..r.len())
            .map(|i| {
                let at = self
                    .map
                    .linearise(&p.friction()[i], &self.rho[i], &r[i], &u[i]);
                at.map.norm_squared() * p.compliance(i)
            })
            .sum();
        let residual = p.residual(&r, &u).size();
        Iterate {
            r,
            u,
            merit,
            residual,
        }
    }

    /// Newton step; `None` if the matrix is singular.
    fn step(&self, now: &Iterate<D>) -> Option<Vec<Local<D>>> {
        let p = self.problem.problem;
        let contacts = p.contacts();
        let mut step = vec![Local::<D>::zeros(); contacts];
        // Where F does not see displacements its step is known: contacts that open.
        let mut place = vec![usize::MAX; contacts];
        let mut active = Vec::new();
        for i in 0..contacts {
            let (r, u) = (&now.r[i], &now.u[i]);
            let at = self.map.linearise(&p.friction()[i], &self.rho[i], r, u);
            if at.displacement.iter().all(|b| *b == 0.0) {
                step[i] = -(at.force.try_inverse()? * at.map);
            } else {
                place[i] = active.len();
                active.push((i, at));
            }
        }
        let mut matrix = BlockMatrix::empty();
        let mut rhs = Vec::with_capacity(active.len());
        for (i, at) in &active {
            let mut known = Local::<D>::zeros();
            for (j, block) in p.operator().row(*i) {
                if place[j] == usize::MAX {
                    known += block * step[j];
                }
            }
            rhs.push(-at.map - at.displacement * known);
            let own = at.force + at.displacement * self.problem.spring(*i);
            let row = p
                .operator()
                .row(*i)
                .filter(|(j, _)| place[*j] != usize::MAX);
            matrix.push_row(row.map(|(j, block)| {
                let spread = at.displacement * block;
                (place[j], if j == *i { spread + own } else { spread })
            }));
        }
        let solved = Factor::new(&matrix)?.solve(&rhs)?;
        for ((i, _), solved) in active.iter().zip(solved) {
            step[*i] = solved;
        }
        Some(step)
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
