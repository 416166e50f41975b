//! Where the iteration stands: the natural map at an iterate, its statuses and its derivatives; not how it
//! goes on.

use super::{At, Guess, PARTS, ROUNDED, Tied};
use crate::problem::{size_of_map, stack};
use crate::solvers::Tolerance;
use moreau_laws::{Local, Status};
use nalgebra::{DVector, SMatrix};

/// The linearised map of a contact: E dt + A du = −G.
pub(super) struct Row<const D: usize> {
    pub(super) elastic: SMatrix<f64, D, D>,
    pub(super) shift: SMatrix<f64, D, D>,
    pub(super) value: Local<D>,
}

impl<const D: usize> Tied<'_, '_, D> {
    /// α of a contact \[N/mm\]. A component that alone hangs on a spring turns friction by as much as that gives way, and
    /// with another α the first steps would miss by the ratio of both.
    pub(super) fn alpha(&self, i: usize) -> f64 {
        let part = PARTS[self.part];
        let compliance = &self.problem.springs[i].compliance;
        let (least, most) = (compliance.min(), compliance.max());
        if least == 0.0 && most > 0.0 {
            return part / PARTS[0] / most;
        }
        let alpha = part * self.problem.structure.stiffness(i);
        alpha / (1.0 + alpha * compliance.mean())
    }

    /// The map at z, of which v is the answer.
    pub(super) fn at(&self, z: DVector<f64>, v: DVector<f64>) -> At<D> {
        let p = &*self.problem;
        let count = p.friction.len();
        let local =
            |all: &DVector<f64>, i: usize| -> Local<D> { all.fixed_rows::<D>(D * i).into() };
        let mut at = At {
            u: Vec::with_capacity(count),
            t: Vec::with_capacity(count),
            irreversible: Vec::with_capacity(count),
            map: Vec::with_capacity(count),
            residual: 0.0,
            merit: 0.0,
            summed: 0.0,
            z,
            v,
        };
        for i in 0..count {
            let v = local(&at.v, i);
            let t = local(&at.z, i) - self.factor.ties[i] * v;
            let u = p.origin[i] + v;
            let springs = &p.springs[i];
            let irreversible = u + springs.elongation(&t);
            let map = p.friction[i].natural_map(&irreversible, &t, self.alpha(i));
            at.residual = at.residual.max(size_of_map(&map, &irreversible, &t));
            let weight = PARTS[0] * p.weight;
            if weight > self.alpha(i) {
                let map = p.friction[i].natural_map(&irreversible, &t, weight);
                at.residual = at.residual.max(size_of_map(&map, &irreversible, &t));
            }
            at.merit += map.norm_squared() / self.alpha(i);
            at.u.push(u);
            at.t.push(t);
            at.irreversible.push(irreversible);
            at.map.push(map);
        }
        at
    }

    /// Whether the law cannot yet tell if a contact is open: its force is within `faint` \[N\] of the kink, which a tie
    /// has not.
    fn is_undecided(&self, now: &At<D>, i: usize, faint: f64) -> bool {
        !self.problem.friction[i].is_tie()
            && (now.t[i][0] - self.alpha(i) * now.irreversible[i][0]).abs() < faint
    }

    /// The statuses, with what is undecided open.
    pub(super) fn statuses(&self, now: &At<D>, faint: f64) -> Vec<Status> {
        let of = |i: usize| match self.is_undecided(now, i, faint) {
            true => Status::Open,
            false => {
                self.problem.friction[i].status(&now.irreversible[i], &now.t[i], self.alpha(i))
            }
        };
        (0..now.u.len()).map(of).collect()
    }

    /// Derivatives E and A of the map of a contact at (u, t).
    fn derivatives(&self, i: usize, u: &Local<D>, t: &Local<D>) -> [SMatrix<f64, D, D>; 2] {
        let law = &self.problem.friction[i];
        let (projector, shift) = law.correct_jacobian(u, t, self.alpha(i));
        let springs = SMatrix::from_diagonal(&self.problem.springs[i].compliance);
        [SMatrix::identity() - projector + shift * springs, shift]
    }

    /// The map linearised at an iterate, with what is undecided open.
    pub(super) fn rows(&self, now: &At<D>, faint: f64) -> Vec<Row<D>> {
        let row = |i: usize| {
            if self.is_undecided(now, i, faint) {
                return Row {
                    elastic: SMatrix::identity(),
                    shift: SMatrix::zeros(),
                    value: -now.t[i],
                };
            }
            let [elastic, shift] = self.derivatives(i, &now.irreversible[i], &now.t[i]);
            Row {
                elastic,
                shift,
                value: -now.map[i],
            }
        };
        (0..now.u.len()).map(row).collect()
    }

    /// The map linearised where the last solution was, on the same side of its kinks.
    pub(super) fn rows_of_guess(&self, now: &At<D>, guess: &Guess<D>) -> Vec<Row<D>> {
        let row = |i: usize| {
            let [elastic, shift] = self.derivatives(i, &guess.irreversible[i], &guess.t[i]);
            let (force, moved) = (now.t[i] - guess.t[i], now.u[i] - guess.u[i]);
            Row {
                value: -(elastic * force + shift * moved),
                elastic,
                shift,
            }
        };
        (0..now.u.len()).map(row).collect()
    }

    /// Residual at which the law holds \[N\]. Where the iteration stalls solves round off, by what the structure is
    /// softer than its contacts are stiff.
    pub(super) fn target(&self, now: &At<D>, tolerance: Tolerance, stalls: bool) -> f64 {
        let full = tolerance.relative * self.force_scale(now);
        let part = if stalls { ROUNDED } else { PARTS[0] };
        (part * full).max(self.rounding(now))
    }

    /// Size of the forces in play \[N\].
    pub(super) fn force_scale(&self, at: &At<D>) -> f64 {
        let forces = at.t.iter().chain(&self.problem.previous);
        let load = self.problem.load.max(f64::MIN_POSITIVE);
        forces.map(|t| t.norm()).fold(load, f64::max)
    }

    /// By how much forces t = z − R v are out of balance where the answers that v is a sum of nearly cancel \[N\].
    pub(super) fn rounds_off(&self, at: &At<D>) -> f64 {
        let tightest = self.factor.ties.iter().map(|tie| tie.amax());
        f64::EPSILON * tightest.fold(0.0, f64::max) * at.summed
    }

    /// Rounding of the map \[N\]: of displacements in the stiffness of a contact, and of what ties hold, which
    /// forces are differences from; and of the load.
    fn rounding(&self, at: &At<D>) -> f64 {
        let count = at.u.len();
        let stiffest = (0..count).map(|i| self.problem.structure.stiffness(i));
        let stiffest = stiffest.fold(0.0, f64::max);
        let held = stack(&at.t) - &at.z;
        let terms = ((D * count) as f64).sqrt();
        4.0 * f64::EPSILON * (terms * stiffest * at.v.amax() + held.amax()) + self.problem.rounding
    }
}
