//! How near a structure is to buckling under its stresses, which small displacements do not see; not
//! what it does then.

use crate::assembly::cell_law::Stiffness;
use crate::driver::Driver;
use crate::interface::condensation::Condensation;
use crate::interface::tied::{Held, Tied};
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::vector::SparseVector;
use moreau_algebra::Interface;
use moreau_laws::{Local, Status};
use nalgebra::{DMatrix, DVector, SVector};

/// The nearest elastic instability of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Buckling<const D: usize> {
    /// λ: in the stiffness K of the elastic bodies, with what touches held to its surface and what sticks in
    /// its place, the stresses of now times λ make (K + λ K_σ) v = 0. Found from above: the least λ is
    /// at most this.
    pub load_factor: f64,
    /// The node that v moves most.
    pub node: usize,
    /// Where that is in the undeformed body \[mm\].
    pub position: [f64; D],
    /// Direction in which v moves it.
    pub direction: [f64; D],
}

impl<const D: usize> Buckling<D> {
    /// Load factor below which second-order effects count, as in EN 1993-1-1, 5.2.1 (3): displacements
    /// grow by 1/(1 − 1/λ), more than a tenth.
    pub const NEAR: f64 = 10.0;
}

/// Directions of Lanczos' method at most: 1/λ of slender structures stands apart from the others.
const MOST: usize = 24;
/// Directions after which it ends where 1/λ is far below what counts.
const FEW: usize = 6;
/// Part of 1 / [`Buckling::NEAR`] that is far below.
const FAR: f64 = 0.1;
/// Relative change of 1/λ at which it has settled.
const SETTLED: f64 = 1e-3;

/// (K + closed contacts)⁻¹, applied to forces at all degrees of freedom.
type Compliance<'a> = dyn FnMut(&mut System, Vec<f64>) -> Option<Vec<f64>> + 'a;

impl<const D: usize> Driver<D> {
    /// The nearest elastic instability under the stresses of now. `None` where these have none, before
    /// the first increment, where contacts leave a body free to move, as one that slides or topples, and where conjugate
    /// gradients stand for the factor.
    ///
    /// K is that of the elastic bodies: flow lowers it, and makes the structure buckle earlier.
    pub fn buckling(&mut self) -> Option<Buckling<D>> {
        let loading = self.state.loading.clone();
        let kept = self.footing.clone();
        let found = self.instability_under(&loading);
        self.footing = kept;
        found
    }

    fn instability_under(&mut self, loading: &Loading<D>) -> Option<Buckling<D>> {
        // What nothing resists has no stiffness that stresses could take away.
        if self.state.increment == 0 || !self.free_motions().is_empty() {
            return None;
        }
        // Where contact points stand is that of now, also in a run that was just resumed.
        self.pair(loading).ok()?;
        let mut system = self.prepare(loading, None).ok()?;
        let elastic = system.holds_elastic_factor();
        let found = match system.is_direct() {
            true => self.nearest_instability(&mut system),
            false => None,
        };
        // As it was found: the next increment does the same, buckling asked for or not. The pivot of a collapse is chosen
        // anew in any case.
        if !elastic {
            system.forget_factor();
        }
        self.system = Some(system);
        found
    }

    fn nearest_instability(&mut self, system: &mut System) -> Option<Buckling<D>> {
        let rest = vec![0.0; self.state.displacement.len()];
        let elastic = Stiffness::Plastic(0.0);
        let none = SparseVector::default();
        let loading = self.state.loading.clone();
        self.assemble(system, &loading, (&rest, &none), elastic);
        let kinematics = self.kinematics(system, &self.state.loading, &rest);
        let status: Vec<Status> = match &self.state.solution {
            Some(solution) => solution.status.clone(),
            None => self.state.contacts.iter().map(|c| c.status).collect(),
        };
        if system.is_tied() {
            let held = !system.floats || self.is_held(&self.state.loading, &status);
            let Held { rows, factor } = &mut Held::default();
            let mut tied = Tied::new(self, system, &kinematics, &rest, None, (rows, factor));
            if !(held && tied.hold_statuses(&status, |_| Local::zeros())) {
                return None;
            }
            drop(tied);
            let spins = self.spins(system, (&kinematics, &status));
            return self.instability(system, spins, &mut |system, force| {
                let mut x = system.at_unknowns(|dof| force[dof]);
                system.solve_tied(&mut x);
                let mut v = vec![0.0; force.len()];
                system.spread(&x, &mut v);
                Some(v)
            });
        }
        system.factorise(true).ok()?;
        let condensed = system.condense(rest.clone());
        let points = (self.points.as_slice(), self.footing.rows.as_slice());
        let seam = (system.schur(), &condensed.load);
        let forces = self.previous_forces(&kinematics);
        let springs = self.compliances(&kinematics);
        let forces = (forces.as_slice(), forces.as_slice(), springs.as_slice());
        let all = (0..kinematics.len()).collect();
        let condensation =
            Condensation::new(system, seam, points, (&kinematics, all), forces).ok()?;
        let interface = condensation.yielding(&status)?;
        let spins = self.spins(system, (&kinematics, &status));
        self.instability(system, spins, &mut |system, force| {
            let mut v = vec![0.0; force.len()];
            let condensed = system.condense(force);
            let x = interface.displacement(&condensed.load);
            let nothing = (&SparseVector::default(), Interface::Held);
            let done = system.expand(condensed, &x, nothing, &mut v);
            done.ok().map(|()| v)
        })
    }

    /// The nearest elastic instability of what gives way as the compliance tells, where none of the spins happens.
    fn instability(
        &self,
        system: &mut System,
        spins: Vec<Vec<f64>>,
        compliance: &mut Compliance<'_>,
    ) -> Option<Buckling<D>> {
        let held = Unspun::new(system, spins, compliance)?;
        let compliance: &mut Compliance<'_> =
            &mut |system, force| compliance(system, force).map(|v| held.without(v));
        let (weights, inverse) = self.lanczos(system, compliance, None)?;
        if inverse * Buckling::<D>::NEAR < 1.0 {
            // No mode is needed of what is far away.
            let (node, zero) = (0, [0.0; D]);
            return (inverse > 0.0).then(|| Buckling {
                load_factor: 1.0 / inverse,
                node,
                position: self.mesh.nodes()[node],
                direction: zero,
            });
        }
        let mut mode = vec![0.0; self.state.displacement.len()];
        self.lanczos(system, compliance, Some((&weights, &mut mode)))?;
        let at = |node: usize| SVector::<f64, D>::from_column_slice(&mode[D * node..D * node + D]);
        let most = |a: &usize, b: &usize| at(*a).norm().total_cmp(&at(*b).norm());
        let node = (0..self.mesh.nodes().len()).max_by(most)?;
        Some(Buckling {
            load_factor: 1.0 / inverse,
            node,
            position: self.mesh.nodes()[node],
            direction: at(node).try_normalize(0.0)?.into(),
        })
    }

    /// The largest 1/λ of −K_σ v = (1/λ) K v by Lanczos' method in the scalar product of K, and the
    /// weights of its directions in v; done once more with them, it adds v up.
    ///
    /// Rounding makes the directions dependent in the end, which repeats values and adds none.
    fn lanczos(
        &self,
        system: &mut System,
        compliance: &mut Compliance<'_>,
        mut sum: Option<(&DVector<f64>, &mut Vec<f64>)>,
    ) -> Option<(DVector<f64>, f64)> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let minus = |a: &mut [f64], s: f64, b: &[f64]| {
            a.iter_mut().zip(b).for_each(|(a, b)| *a -= s * b);
        };
        let mesh = self.mesh_dofs();
        // q, and the force K q that makes it: of the first, noise, which no symmetry keeps from any mode.
        let mut force = noise(self.state.displacement.len(), mesh);
        let mut q = compliance(system, force.clone())?;
        let (mut before, mut before_force) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        let (mut diagonal, mut beside): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let (mut weights, mut largest) = (DVector::zeros(0), 0.0);
        let mut beta = 0.0;
        for k in 0..MOST {
            let norm = dot(&q, &force).sqrt();
            if !norm.is_finite()
                || norm <= f64::EPSILON * diagonal.first().map_or(0.0, |d: &f64| d.abs())
            {
                break;
            }
            if k > 0 {
                beta = norm;
                beside.push(beta);
            }
            q.iter_mut().for_each(|q| *q /= norm);
            force.iter_mut().for_each(|f| *f /= norm);
            if let Some((weights, v)) = &mut sum {
                let weight = weights.get(k).copied().unwrap_or(0.0);
                minus(v, -weight, &q);
                if k + 1 >= weights.len() {
                    break;
                }
            }
            let mut next_force = self.stress_stiffness(&q);
            next_force.iter_mut().for_each(|f| *f = -*f);
            let alpha = dot(&q, &next_force);
            diagonal.push(alpha);
            let mut next = compliance(system, next_force.clone())?;
            for (a, q, before) in [
                (&mut next, &q, &before),
                (&mut next_force, &force, &before_force),
            ] {
                minus(a, alpha, q);
                minus(a, beta, before);
            }
            before = std::mem::replace(&mut q, next);
            before_force = std::mem::replace(&mut force, next_force);
            if sum.is_none() {
                let found;
                (weights, found) = largest_of(&diagonal, &beside)?;
                let settled = (found - largest).abs() <= SETTLED * found.abs();
                largest = found;
                let far = k + 1 >= FEW && largest * Buckling::<D>::NEAR < FAR;
                if far || settled {
                    break;
                }
            }
        }
        Some((weights, largest))
    }
}

/// What holds surfaces that slip under friction against spins s about their normals: that resists them, see
/// [`Driver::spins`], and no elastic stiffness does where a body may turn about one node that sticks.
struct Unspun {
    rows: Vec<DVector<f64>>,
    /// C s of every row.
    answers: Vec<DVector<f64>>,
    /// (s·C s)⁻¹.
    inverse: DMatrix<f64>,
}

impl Unspun {
    /// Of spins s under a compliance C; `None` where that is no number.
    fn new(
        system: &mut System,
        rows: Vec<Vec<f64>>,
        compliance: &mut Compliance<'_>,
    ) -> Option<Self> {
        let answers = rows
            .iter()
            .map(|row| compliance(system, row.clone()).map(DVector::from_vec));
        let answers = answers.collect::<Option<Vec<_>>>()?;
        let rows: Vec<_> = rows.into_iter().map(DVector::from_vec).collect();
        let entry = |i: usize, j: usize| rows[i].dot(&answers[j]);
        let both = DMatrix::from_fn(rows.len(), rows.len(), entry);
        let rounding = f64::EPSILON * both.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let inverse = match rows.is_empty() {
            true => both,
            false => both.pseudo_inverse(rounding).ok()?,
        };
        Some(Self {
            rows,
            answers,
            inverse,
        })
    }

    /// Displacements v under forces, with those of the moments that keep s·v = 0. What nearly nothing resists is large in v,
    /// and its rounding as well: it is taken off twice.
    fn without(&self, v: Vec<f64>) -> Vec<f64> {
        let mut v = DVector::from_vec(v);
        for _ in 0..2 {
            let spun = DVector::from_iterator(self.rows.len(), self.rows.iter().map(|s| s.dot(&v)));
            let moments = &self.inverse * spun;
            for (answer, moment) in self.answers.iter().zip(moments.iter()) {
                v.axpy(-moment, answer, 1.0);
            }
        }
        v.as_slice().to_vec()
    }
}

/// Largest eigenvalue of a symmetric tridiagonal matrix, with its vector.
fn largest_of(diagonal: &[f64], beside: &[f64]) -> Option<(DVector<f64>, f64)> {
    let n = diagonal.len();
    let matrix = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => diagonal[i],
        1 => beside[i.min(j)],
        _ => 0.0,
    });
    let eigen = matrix.symmetric_eigen();
    let order = |a: &usize, b: &usize| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]);
    let k = (0..n).max_by(order)?;
    Some((
        eigen.eigenvectors.column(k).into_owned(),
        eigen.eigenvalues[k],
    ))
}

/// Forces in no order on the first of some degrees of freedom, always the same.
pub(super) fn noise(dofs: usize, first: usize) -> Vec<f64> {
    let mut bits = 0x9e37_79b9_7f4a_7c15u64;
    let mut next = || {
        // Xorshift of G. Marsaglia, J. Stat. Softw. 8 (2003).
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        (bits >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    (0..dofs)
        .map(|dof| if dof < first { next() } else { 0.0 })
        .collect()
}
