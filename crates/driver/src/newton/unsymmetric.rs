//! The step of a tangent that is not symmetric, by steps of the symmetric one that is factorised; not
//! the steps themselves.

use crate::assembly::block::points_of;
use crate::assembly::cell_law::Motion;
use crate::driver::Driver;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::newton::iterate::Iterate;
use crate::vector::largest;
use crate::vector::prescribed::Prescribed;
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
    steps: usize,
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
        let left = largest((&lacking - &self.forces).iter().copied());
        if left <= self.enough || !left.is_finite() || self.steps >= LIMIT {
            return true;
        }
        self.forces = self.anderson.next(&self.forces, lacking);
        false
    }
}

impl<const D: usize> Driver<D> {
    /// What the tangent at an iterate asks of a step beyond its symmetric part: nothing where it is
    /// symmetric, or nothing flows. Pressures that follow their surface ask for what belongs to its edge.
    pub(crate) fn unsymmetric(
        &self,
        system: &System,
        (now, loading): (&Iterate, &Loading<D>),
        imbalance: f64,
        accuracy: (f64, f64),
    ) -> Option<Unsymmetric> {
        let flows = now.assembly.flows && !self.is_symmetric();
        let asks = flows || !loading.pressure.is_zero();
        asks.then(|| Unsymmetric::new(now.d_u.len(), imbalance, accuracy, system.is_direct()))
    }

    /// Whether a step from an iterate will do; else what it is made of has changed.
    pub(crate) fn settles(
        &self,
        unsymmetric: &mut Option<Unsymmetric>,
        at: (&Iterate, &Loading<D>),
        step: &[f64],
        held: &Prescribed,
    ) -> bool {
        let settled = |u: &mut Unsymmetric| u.settles(self.lacking(at, step, held));
        unsymmetric.as_mut().is_none_or(settled)
    }

    /// Imbalance that a step of an unsymmetric tangent may leave \[N\], after the imbalances of the
    /// iterates so far: the largest of the last few; `None` where a potential tells how far to go.
    pub(crate) fn allowed(&self, imbalances: &[f64]) -> Option<f64> {
        let last = &imbalances[imbalances.len().saturating_sub(MEMORY)..];
        (!self.blocks.iter().all(|b| b.has_potential())).then(|| largest(last.iter().copied()))
    }

    /// Whether the stiffness of all blocks is that of their forces.
    pub(crate) fn is_symmetric(&self) -> bool {
        self.blocks.iter().all(|b| b.is_symmetric())
    }

    /// A v at an iterate, at every degree of freedom \[N\]; zero at those held.
    fn lacking(
        &self,
        (now, loading): (&Iterate, &Loading<D>),
        v: &[f64],
        held: &Prescribed,
    ) -> Vec<f64> {
        let mut forces = vec![0.0; v.len()];
        let mut motion = Motion {
            from: &self.state.displacement,
            by: &now.d_u,
            free: &now.assembly.free,
        };
        for block in &self.blocks {
            let own = motion.split_off(points_of(block.as_ref()));
            block.lacking(own, v, &mut |nodes, force| {
                for (&a, force) in nodes.iter().zip(force.chunks_exact(D)) {
                    let at = forces[D * a..D * a + D].iter_mut();
                    at.zip(force).for_each(|(sum, f)| *sum += f);
                }
            });
        }
        self.add_turning_pressures(&loading.pressure, (&now.d_u, v), &mut forces);
        held.clear(&mut forces);
        forces
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    /// K + A with eigenvalues on both sides of zero, and parts that turn.
    fn sample(n: usize) -> (DMatrix<f64>, DMatrix<f64>) {
        let k = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.5,
            1 => -1.0,
            _ => 0.0,
        });
        let a = DMatrix::from_fn(n, n, |i, j| {
            let turned = 0.8 * ((3 * i + 5 * j) as f64).sin();
            turned - if i == j && i < 2 { 5.0 } else { 0.0 }
        });
        (k, a)
    }

    #[test]
    fn steps_of_the_symmetric_part_solve_what_is_neither_symmetric_nor_definite() {
        let n = 12;
        let (k, a) = sample(n);
        let tangent = &k + &a;
        let eigenvalues = tangent.complex_eigenvalues();
        assert!(eigenvalues.iter().any(|e| e.re < 0.0) && eigenvalues.iter().any(|e| e.re > 0.0));
        let load = DVector::from_fn(n, |i, _| 1.0 + (i as f64).cos());
        let factor = k.cholesky().expect("definite");
        let mut unsymmetric = Unsymmetric::new(n, load.amax(), (1e-9, 0.0), true);
        let step = loop {
            let given = DVector::from_vec(unsymmetric.load(load.as_slice()));
            let step = factor.solve(&given);
            if unsymmetric.settles((&a * &step).as_slice().to_vec()) {
                break step;
            }
        };
        assert!(unsymmetric.steps <= n + 3, "{} steps", unsymmetric.steps);
        let left = (&load - &tangent * &step).amax();
        assert!(left <= 1.01e-9, "{left:e}");
        // What a step leaves is told in newtons: less is asked for, less is done.
        let mut coarse = Unsymmetric::new(n, load.amax(), (0.0, 0.0), false);
        let first = factor.solve(&load);
        let settled = coarse.settles((&a * &first).as_slice().to_vec());
        assert_eq!(settled, (&a * &first).amax() <= COARSE * load.amax());
    }

    #[test]
    fn what_lacks_nothing_takes_one_step() {
        let mut unsymmetric = Unsymmetric::new(3, 1.0, (0.0, 0.0), true);
        assert_eq!(unsymmetric.load(&[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert!(unsymmetric.settles(vec![0.0; 3]));
        assert_eq!(unsymmetric.steps, 1);
    }

    #[test]
    fn what_is_no_number_does_not_go_on() {
        let mut unsymmetric = Unsymmetric::new(2, 1.0, (0.0, 0.0), true);
        assert!(unsymmetric.settles(vec![f64::NAN, 1.0]));
    }
}
