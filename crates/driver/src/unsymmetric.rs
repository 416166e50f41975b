//! The step of a tangent that is not symmetric, by steps of the symmetric one that is factorised; not
//! the steps themselves.

use crate::driver::Driver;
use crate::iterate::Iterate;
use crate::norm::largest;
use crate::system::System;
use moreau_contact::Anderson;
use nalgebra::DVector;

/// Steps of the symmetric tangent after which the last is taken as it is.
const LIMIT: usize = 50;

/// Part of the imbalance that a step leaves where each of those it is made of is itself found by an
/// iteration, to a hundredth.
const COARSE: f64 = 0.1;

/// Part of the imbalance at which an increment is accepted that a step may leave.
const EXACT: f64 = 0.1;

/// Iterates of which the worst bounds what the next step may leave.
const MEMORY: usize = 5;

/// What the factorised stiffness K lacks of the tangent K + A.
///
/// (K + A) v = f + t, with contact forces t that obey their law under v, is K v = (f − d) + t with
/// d = A v. The forces d are a fixed point, d ← A v(d), in which v(d) is a step of the symmetric
/// tangent with its contact problem solved as ever. Extrapolated by Anderson's method that is, as long
/// as no status changes, the method of generalised minimal residuals preconditioned by K: it needs no
/// second factor, takes an indefinite K + A, and leaves alone what no force excites, as the modes of
/// a plateau that have hardly any stiffness. What v(d) leaves out of balance is A v(d) − d.
pub(crate) struct Unsymmetric {
    /// d at every degree of freedom \[N\].
    forces: DVector<f64>,
    anderson: Anderson,
    /// What a step may leave out of balance \[N\].
    enough: f64,
    /// Steps done.
    pub(crate) steps: usize,
}

impl Unsymmetric {
    /// Of a step that makes up for an imbalance, of which it is to leave no more than `expected`, in an
    /// increment that is accepted at `target` \[N\]; `direct` tells whether the factor is one of K itself.
    pub(crate) fn new(
        size: usize,
        imbalance: f64,
        (expected, target): (f64, f64),
        direct: bool,
    ) -> Self {
        let coarse = if direct { 0.0 } else { COARSE * imbalance };
        Self {
            forces: DVector::zeros(size),
            anderson: Anderson::default(),
            enough: expected.max(EXACT * target).max(coarse),
            steps: 0,
        }
    }

    /// f − d.
    pub(crate) fn load(&self, load: &[f64]) -> Vec<f64> {
        load.iter()
            .zip(self.forces.iter())
            .map(|(f, d)| f - d)
            .collect()
    }

    /// Takes note of A v of the step v under the last load; whether that step will do.
    pub(crate) fn settles(&mut self, lacking: Vec<f64>) -> bool {
        self.steps += 1;
        let lacking = DVector::from_vec(lacking);
        let left = (&lacking - &self.forces).amax();
        if left <= self.enough || !left.is_finite() || self.steps >= LIMIT {
            return true;
        }
        self.forces = self.anderson.next(&self.forces, lacking);
        false
    }
}

impl<const D: usize> Driver<D> {
    /// What the tangent at an iterate asks of a step beyond its symmetric part: nothing where it is
    /// symmetric, or nothing flows.
    pub(crate) fn unsymmetric(
        &self,
        system: &System,
        now: &Iterate,
        imbalance: f64,
        accuracy: (f64, f64),
    ) -> Option<Unsymmetric> {
        let asks = now.assembly.flows && !self.is_symmetric();
        asks.then(|| Unsymmetric::new(now.d_u.len(), imbalance, accuracy, system.is_direct()))
    }

    /// Whether a step from an iterate will do; else what it is made of has changed.
    pub(crate) fn settles(
        &self,
        unsymmetric: &mut Option<Unsymmetric>,
        now: &Iterate,
        step: &[f64],
        held: &[usize],
    ) -> bool {
        let settled = |u: &mut Unsymmetric| u.settles(self.lacking(&now.d_u, step, held));
        unsymmetric.as_mut().is_none_or(settled)
    }

    /// Imbalance that a step of an unsymmetric tangent may leave \[N\], after the imbalances of the
    /// iterates so far: the largest of the last few; `None` where the tangent is symmetric.
    pub(crate) fn allowed(&self, imbalances: &[f64]) -> Option<f64> {
        let last = &imbalances[imbalances.len().saturating_sub(MEMORY)..];
        (!self.is_symmetric()).then(|| largest(last.iter().copied()))
    }

    /// Whether the stiffness of all blocks is that of their forces.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.blocks.iter().all(|b| b.is_symmetric())
    }

    /// A v at the displacement increments `d_u`, at every degree of freedom \[N\]; zero at those held.
    fn lacking(&self, d_u: &[f64], v: &[f64], held: &[usize]) -> Vec<f64> {
        let mut forces = vec![0.0; v.len()];
        for block in &self.blocks {
            block.lacking(d_u, v, &mut |nodes, force| {
                for (&a, force) in nodes.iter().zip(force.chunks_exact(D)) {
                    let at = forces[D * a..D * a + D].iter_mut();
                    at.zip(force).for_each(|(sum, f)| *sum += f);
                }
            });
        }
        held.iter().for_each(|&dof| forces[dof] = 0.0);
        forces
    }
}
