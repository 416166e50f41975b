//! The first guess of an increment, from those before it; not how it is solved.

use crate::driver::Driver;
use crate::model::load::Loading;
use crate::vector::largest;

/// Lengths of an increment, over the one before it, at most of which that tells anything.
const FARTHER: f64 = 4.0;

/// Change of an increment from the one before it, over the increment, up to which a path is smooth.
const SMOOTH: f64 = 0.1;

impl<const D: usize> Driver<D> {
    /// First guess of the displacement increments: that of [`Driver::guess`], or the last increment again, as far as the load
    /// goes on in the same direction, and by as much more as the path bends; else nothing, and nothing of a body that was let
    /// go: it stays where it is.
    ///
    /// Through the last three equilibria goes a parabola. With increments Δu₋ and Δu under loadings of the lengths 1 and r,
    /// the next under q r is q (Δu + (1 + q)/(1 + 1/r) (Δu − r Δu₋)).
    pub(crate) fn predictor(&self, start: &Loading<D>, end: &Loading<D>) -> Vec<f64> {
        if let Some(guess) = &self.guessed {
            return guess.clone();
        }
        let zero = || vec![0.0; self.state.displacement.len()];
        let Some((last, before)) = &self.state.last else {
            return zero();
        };
        let ratio = end.increment_from(start).ratio(before);
        let goes_on = end.moves_the_same_as(before) && ratio > 0.0 && ratio <= FARTHER;
        if !goes_on || self.is_let_go() {
            return zero();
        }
        match &self.state.bend {
            Some((bend, before)) => {
                let more = (1.0 + ratio) / (1.0 + 1.0 / before);
                let pairs = last.iter().zip(bend);
                pairs.map(|(u, b)| ratio * (u + more * b)).collect()
            }
            None => last.iter().map(|u| ratio * u).collect(),
        }
    }

    /// Δu − r Δu₋ of an increment under a loading r times that of the increment Δu₋ before it, and r: where strains are
    /// large and the path is smooth. A small strain has kinks, as where it begins to yield, and little else.
    pub(crate) fn bend(&self, d_u: &[f64], loading: &Loading<D>) -> Option<(Vec<f64>, f64)> {
        let (last, before) = self.state.last.as_ref()?;
        let ratio = loading.ratio(before);
        let goes_on = loading.moves_the_same_as(before) && ratio > 0.0 && ratio <= FARTHER;
        if !(goes_on && self.has_large_strains()) {
            return None;
        }
        let bend: Vec<f64> = d_u.iter().zip(last).map(|(u, l)| u - ratio * l).collect();
        let size = |v: &[f64]| largest(v.iter().copied());
        (size(&bend) <= SMOOTH * size(d_u)).then_some((bend, ratio))
    }
}
