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
    /// goes on in the same direction, and by as much more as the path bends; else nothing.
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
        if !(end.moves_the_same_as(before) && ratio > 0.0 && ratio <= FARTHER) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Model, Settings, Step};
    use moreau_laws::Elastic;
    use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

    /// How far the guess of an increment is from what it becomes, after increments to some parts of a way \[mm\].
    fn off(large: bool, ends: &[f64], way: f64) -> f64 {
        let (x, y) = (uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 1));
        let mesh = block2("bar", CellKind::Quad8, &x, &y).expect("valid");
        let start = match large {
            true => Model::with_large_strains,
            false => Model::new,
        };
        let elastic = Elastic::new(1000.0, 0.3).expect("valid");
        let model = start(mesh, PlaneStrain::default())
            .material("bar", elastic, Integration::Reduced)
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let pull = |end: f64| {
            Step::new("pull")
                .fix("bar.left", &[Axis::X, Axis::Y])
                .displace("bar.right", Axis::X, end * way)
                .displace("bar.right", Axis::Y, 0.5 * end * way)
        };
        let (last, before) = ends.split_last().expect("some");
        for &end in before {
            driver.run(&pull(end), 1, |_, _| ()).expect("converges");
        }
        let (from, to) = (
            driver.state.loading.clone(),
            driver.loading(&pull(*last)).expect("valid"),
        );
        let guess = driver.predictor(&from, &to);
        let here = driver.displacements().to_vec();
        driver.run(&pull(*last), 1, |_, _| ()).expect("converges");
        let moved = driver.displacements().iter().zip(&here);
        largest(moved.zip(&guess).map(|((u, from), guess)| u - from - guess))
    }

    /// Of third order, where increments are equal and where they are not; with two equilibria known of second.
    #[test]
    fn a_smooth_path_is_foreseen() {
        for (ends, order) in [
            (&[1.0, 2.0, 3.0, 4.0][..], 3),
            (&[1.0, 2.0, 3.0, 3.7], 3),
            (&[1.0, 1.5, 2.5, 4.0], 3),
            (&[1.0, 2.0], 2),
        ] {
            let [coarse, fine] = [0.04, 0.02].map(|way| off(true, ends, way));
            let found = (coarse / fine).log2();
            assert!((found - f64::from(order)).abs() < 0.2, "{ends:?}: {found}");
        }
        // Of small strains the elastic path is straight.
        assert!(off(false, &[1.0, 2.0, 3.5], 0.04) < 1e-12);
    }

    /// What turns back, or comes from far shorter increments, tells nothing.
    #[test]
    fn a_path_that_turns_back_is_not_foreseen() {
        let moved = off(true, &[1.0, 2.0, 1.5], 0.04);
        assert!((moved - 0.02).abs() < 1e-6, "{moved}");
        assert!(off(true, &[1.0, 1.1, 2.0], 0.04) > 0.03);
    }
}
