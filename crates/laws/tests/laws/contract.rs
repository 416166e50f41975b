//! What every bipotential must show, on samples drawn inside its domain; not a search for
//! counterexamples outside it.

use moreau_laws::Bipotential;
use nalgebra::SVector;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::fmt::Debug;

/// Round-off allowed, relative to the size of the terms.
const ROUND_OFF: f64 = 1e-11;

/// A space of fluxes and forces with its dual product.
pub(crate) trait Space: Copy + Debug + 'static {
    fn dot(&self, other: &Self) -> f64;
    /// self + factor · other.
    fn plus(&self, factor: f64, other: &Self) -> Self;
}

impl Space for f64 {
    fn dot(&self, other: &Self) -> f64 {
        self * other
    }
    fn plus(&self, factor: f64, other: &Self) -> Self {
        self + factor * other
    }
}

impl<const N: usize> Space for SVector<f64, N> {
    fn dot(&self, other: &Self) -> f64 {
        SVector::dot(self, other)
    }
    fn plus(&self, factor: f64, other: &Self) -> Self {
        self + factor * other
    }
}

/// A law pair and a direction (x, y, dx, dy) in which it ceases to be one.
///
/// One of dx, dy is zero; (x + ε dx, y + ε dy) is admissible for 0 ≤ ε ≤ 1.
pub(crate) type Departure<X> = (X, X, X, X);

/// Samples of a law.
pub(crate) struct Samples<X> {
    /// Admissible fluxes.
    pub flux: BoxedStrategy<X>,
    /// Admissible forces.
    pub force: BoxedStrategy<X>,
    /// Fluxes that are not admissible; `None` if all are.
    pub flux_outside: Option<BoxedStrategy<X>>,
    /// Forces that are not admissible.
    pub force_outside: BoxedStrategy<X>,
    /// Pairs (x, y) that obey the law.
    pub law: BoxedStrategy<(X, X)>,
    /// Ways to leave it.
    pub departure: BoxedStrategy<Departure<X>>,
}

/// Runs a property on samples.
pub(crate) fn for_all<S: Strategy>(
    samples: &S,
    property: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    let config = Config {
        cases: 512,
        failure_persistence: None,
        ..Config::default()
    };
    if let Err(failure) = TestRunner::new(config).run(samples, property) {
        panic!("{failure}");
    }
}

/// b − x·y, and the round-off to expect in it.
fn gap<X: Space>(b: &impl Bipotential<X>, x: &X, y: &X) -> (f64, f64) {
    let value = b.b(x, y);
    let size = x.dot(x).sqrt() * y.dot(y).sqrt() + value.abs();
    (value - x.dot(y), ROUND_OFF * (1.0 + size))
}

/// The contract of a bipotential and its law.
pub(crate) fn check<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    inequality(b, samples);
    equality_on_the_law(b, samples);
    infinite_outside(b, samples);
    convex_in_each_argument(b, samples);
    implicit_normality(b, samples);
    positive_off_the_law(b, samples);
}

/// (i) b(x, y) ≥ x·y, [26], [32], and b is finite, on admissible pairs.
fn inequality<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    for_all(&(samples.flux.clone(), samples.force.clone()), |(x, y)| {
        let (gap, tolerance) = gap(b, &x, &y);
        prop_assert!(gap.is_finite(), "b is not finite inside its domain");
        prop_assert!(gap >= -tolerance, "gap {gap:e}");
        Ok(())
    });
}

/// (ii) b(x, y) = x·y on the law, [24], [29].
fn equality_on_the_law<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    for_all(&samples.law, |(x, y)| {
        let (gap, tolerance) = gap(b, &x, &y);
        prop_assert!(gap.abs() <= tolerance, "gap {gap:e} on the law");
        Ok(())
    });
}

/// (iii) b = +∞ outside the domain.
fn infinite_outside<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    let infinite = |(x, y): (X, X)| {
        prop_assert_eq!(b.b(&x, &y), f64::INFINITY);
        Ok(())
    };
    for_all(
        &(samples.flux.clone(), samples.force_outside.clone()),
        infinite,
    );
    if let Some(flux_outside) = &samples.flux_outside {
        for_all(&(flux_outside.clone(), samples.force.clone()), infinite);
    }
}

/// (iv) b is convex in x at fixed y, and in y at fixed x, on chords.
fn convex_in_each_argument<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    let (flux, force) = (samples.flux.clone(), samples.force.clone());
    let chord = (flux.clone(), flux, force.clone(), force, 0.0..=1.0f64);
    for_all(&chord, |(x0, x1, y0, y1, s)| {
        let between = |a: &X, b: &X| a.plus(-s, a).plus(s, b);
        let along_x = (1.0 - s) * b.b(&x0, &y0) + s * b.b(&x1, &y0);
        let along_y = (1.0 - s) * b.b(&x0, &y0) + s * b.b(&x0, &y1);
        prop_assert!(b.b(&between(&x0, &x1), &y0) <= along_x + ROUND_OFF * (1.0 + along_x.abs()));
        prop_assert!(b.b(&x0, &between(&y0, &y1)) <= along_y + ROUND_OFF * (1.0 + along_y.abs()));
        Ok(())
    });
}

/// [27], [33]: y is a subgradient of b(·, y) at x, and x one of b(x, ·) at y, on the law.
fn implicit_normality<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    let pairs = (
        samples.law.clone(),
        samples.flux.clone(),
        samples.force.clone(),
    );
    for_all(&pairs, |((x, y), x1, y1)| {
        let (base, round_off) = (b.b(&x, &y), gap(b, &x, &y).1);
        let tolerance = round_off + gap(b, &x1, &y).1 + gap(b, &x, &y1).1;
        prop_assert!(b.b(&x1, &y) - base >= y.dot(&x1.plus(-1.0, &x)) - tolerance);
        prop_assert!(b.b(&x, &y1) - base >= x.dot(&y1.plus(-1.0, &y)) - tolerance);
        Ok(())
    });
}

/// (v) Off the law the gap is positive, and grows at least like ε² and, being convex, at most
/// like ε.
fn positive_off_the_law<X: Space>(b: &impl Bipotential<X>, samples: &Samples<X>) {
    for_all(&samples.departure, |(x, y, dx, dy)| {
        let at = |eps: f64| gap(b, &x.plus(eps, &dx), &y.plus(eps, &dy));
        let (full, tolerance) = at(1.0);
        prop_assert!(full > 1e3 * tolerance, "gap {full:e} after the departure");
        for eps in [1e-1, 1e-2, 1e-3] {
            let gap = at(eps).0;
            prop_assert!(
                gap >= 1e-2 * eps * eps * full - tolerance,
                "gap {gap:e} at {eps:e}"
            );
            prop_assert!(gap <= eps * full + tolerance, "gap {gap:e} at {eps:e}");
        }
        Ok(())
    });
}
