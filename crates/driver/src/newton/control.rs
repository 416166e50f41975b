//! Loads in proportion whose factor is an unknown of the increment; not the decision when it is.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::model::load::Loading;
use crate::report::counts::Counts;
use crate::report::{IncrementReport, Iteration};
use crate::vector::SparseVector;
use crate::vector::largest;
use std::ops::ControlFlow;

/// An increment along the path of equilibria under F₀ + λ q, with λ unknown and
///
/// ```text
/// q·Δu + c Δλ = s
/// ```
///
/// instead: the loads are applied through a spring of compliance c > 0, whose far end moves on by s.
/// Any c gives the same path; a small one stays on it where a structure softens. The problem is the
/// minimisation of a potential as before, and its tangent K + q qᵀ/c symmetric. K alone is singular
/// at collapse: a node of the mechanism, the pivot, joins the interface, which holds it there.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Control<'a, const D: usize> {
    /// λ, at the end of the increment once that has converged.
    pub(crate) factor: f64,
    /// What λ = 1 adds to the loading.
    pub(crate) grows: &'a Loading<D>,
    /// q \[N\], on the surface at the start of the increment where pressures follow it.
    pub(crate) load: &'a SparseVector,
    /// λ at the start of the increment.
    pub(crate) start: f64,
    /// Δλ of the increment before.
    pub(crate) last: f64,
    /// c \[N·mm\].
    pub(crate) compliance: f64,
    /// s \[N·mm\].
    pub(crate) length: f64,
}

impl<const D: usize> Control<'_, D> {
    /// Work of the loads at λ = 1 on a displacement, q·u \[N·mm\].
    pub(crate) fn work(&self, u: &[f64]) -> f64 {
        self.load.dot(u)
    }

    /// What of s a displacement increment and λ leave undone \[N·mm\].
    pub(crate) fn missing(&self, d_u: &[f64]) -> f64 {
        self.length - self.work(d_u) - self.compliance * (self.factor - self.start)
    }

    /// How many times the increment before makes this one.
    fn ratio(&self, last: &[f64]) -> f64 {
        self.length / (self.work(last) + self.compliance * self.last)
    }

    /// The loading at λ, from that at the start.
    pub(crate) fn loading(&self, start: &Loading<D>) -> Loading<D> {
        let grown = |f, q| f + (self.factor - self.start) * q;
        Loading {
            pressure: start.pressure.with(&self.grows.pressure, grown),
            temperature: start.temperature.clone(),
            turn: start.turn.clone(),
            axle: start.axle.clone(),
            displacement: start.displacement.clone(),
            directions: start.directions.clone(),
            force: start.force.with(&self.grows.force, grown),
        }
    }
}

/// Least motion of the pivot, over the largest of the body, at which it is kept.
const MOVING: f64 = 0.2;

impl<const D: usize> Driver<D> {
    /// Applies an increment of unknown load factor, and commits it unless the factor passes 1:
    /// `None` then. Nothing is prescribed to move, and the last increment was one under these loads.
    ///
    /// # Errors
    /// See [`IncrementError`].
    pub(crate) fn advance_along(
        &mut self,
        control: &mut Control<'_, D>,
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Option<IncrementReport>, IncrementError> {
        self.guessed = None;
        self.spent = Counts::default();
        let start = self.state.loading.clone();
        let last = self.state.last.as_ref();
        let guess: Vec<f64> = last.map_or_else(Vec::new, |(last, _)| {
            let ratio = control.ratio(last);
            control.factor = control.start + ratio * control.last;
            last.iter().map(|u| ratio * u).collect()
        });
        self.pair(&start)?;
        let pivot = self.pivot();
        let mut system = self.prepare(&start, pivot)?;
        let watch = &mut |_: &Self, now: &Iteration<'_>| watch(now);
        let first = control.loading(&start);
        let ends = (&start, &first);
        let increment = self.begin_increment(&mut system, ends, guess, Some(control));
        let outcome = self.balance(&mut system, increment, watch);
        self.system = Some(system);
        let candidate = outcome.map_err(|error| self.or_fault(error))?;
        self.check_passage(&candidate.d_u, &start)?;
        self.check_bodies(&candidate.d_u)?;
        (control.factor <= 1.0)
            .then(|| self.commit(&start, &control.loading(&start), candidate))
            .transpose()
    }

    /// Forces \[N\] of all that a loading applies, on the surface as it is after displacement increments.
    pub(crate) fn nodal_forces(&self, loading: &Loading<D>, d_u: &[f64]) -> SparseVector {
        let pressed = self.pressure_force(loading, d_u);
        loading.force.with(&pressed, |f, p| f + p)
    }

    /// The node that moved most in the last increment; the pivot at hand, if it moved too.
    fn pivot(&self) -> Option<usize> {
        let (last, _) = self.state.last.as_ref()?;
        let motion = |node: usize| largest(last[D * node..D * node + D].iter().copied());
        let most = |a: &usize, b: &usize| motion(*a).total_cmp(&motion(*b)).then(b.cmp(a));
        let fastest = (0..self.mesh.nodes().len()).max_by(most)?;
        let kept = self.system.as_ref().and_then(|s| s.pivot);
        Some(match kept {
            Some(pivot) if motion(pivot) >= MOVING * motion(fastest) => pivot,
            _ => fastest,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The increment before, as many times as the far end of the spring moves on, is a guess that leaves nothing
    /// undone; and one that falls short of it leaves that.
    #[test]
    fn the_increment_before_is_repeated_as_far_as_the_spring_is_pulled() {
        let mut load = SparseVector::default();
        load.add(0, 2.0);
        load.add(2, -1.0);
        let last = [0.3, 5.0, 0.1];
        let mut control = Control {
            factor: 0.4,
            grows: &Loading::<2>::default(),
            load: &load,
            start: 0.4,
            last: 0.05,
            compliance: 3.0,
            length: 1.3,
        };
        let ratio = control.ratio(&last);
        let guess = last.map(|u| ratio * u);
        assert!((control.missing(&guess) - 3.0 * ratio * 0.05).abs() < 1e-14);
        control.factor += ratio * control.last;
        assert!(control.missing(&guess).abs() < 1e-14);
        assert!((control.missing(&[0.0; 3]) - (1.3 - 3.0 * ratio * 0.05)).abs() < 1e-14);
    }
}
