//! The contract of bipotentials, on samples of their domain; not a search for counterexamples
//! outside it.

use super::random::Random;
use super::{Report, Violation};
use crate::duality::Bipotential;
use nalgebra::SVector;
use std::fmt::Debug;

/// Round-off allowed, relative to the size of the terms.
const ROUND_OFF: f64 = 1e-11;

/// A space of fluxes and forces with its dual product.
pub trait Space: Copy + Debug {
    /// x·y.
    fn dot(&self, other: &Self) -> f64;
    /// x + factor y.
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

/// A pair (x, y) of the law and a direction (dx, dy) in which it ceases to be one: one of dx, dy is
/// zero, and (x + ε dx, y + ε dy) is admissible for 0 ≤ ε ≤ 1.
pub type Departure<X> = (X, X, X, X);

/// Samples of a bipotential.
#[derive(Debug, Clone, Default)]
pub struct Samples<X> {
    /// Admissible fluxes.
    pub flux: Vec<X>,
    /// Admissible forces.
    pub force: Vec<X>,
    /// Fluxes that are not admissible; none if all are.
    pub flux_outside: Vec<X>,
    /// Forces that are not admissible.
    pub force_outside: Vec<X>,
    /// Pairs (x, y) that obey the law.
    pub law: Vec<(X, X)>,
    /// Ways to leave it.
    pub departure: Vec<Departure<X>>,
}

/// b − x·y, and the round-off to expect in it.
fn gap<X: Space>(b: &impl Bipotential<X>, x: &X, y: &X) -> (f64, f64) {
    let value = b.b(x, y);
    let size = x.dot(x).sqrt() * y.dot(y).sqrt() + value.abs();
    (value - x.dot(y), ROUND_OFF * (1.0 + size))
}

/// Checks a bipotential and its law on samples, which it pairs in many ways: b ≥ x·y, finite within
/// the domain and infinite outside, \[26\], \[32\]; equality on the law, \[24\], \[29\], and nowhere
/// else; convexity in each argument; implicit normality, \[27\], \[33\].
///
/// # Errors
/// The first [`Violation`], or that there are no samples of some kind.
pub fn bipotential<X: Space>(
    b: &impl Bipotential<X>,
    samples: &Samples<X>,
) -> Result<Report, Violation> {
    let mut report = Report::default();
    let Samples {
        flux, force, law, ..
    } = samples;
    let given = [flux.len(), force.len(), law.len(), samples.departure.len()];
    let all = !given.contains(&0) && !samples.force_outside.is_empty();
    report.holds("there are samples of every kind", all, || {
        format!("of {given:?}")
    })?;
    let mut random = Random::new();
    let count = flux.len().max(force.len()).max(law.len());
    for _ in 0..2 * count {
        let mut pair = || {
            (
                flux[random.below(flux.len())],
                force[random.below(force.len())],
            )
        };
        let (first, second) = (pair(), pair());
        within(b, first, &mut report)?;
        convex(b, (first, second), random.between(0.0, 1.0), &mut report)?;
        on_the_law(b, law[random.below(law.len())], first, &mut report)?;
        let outside = (
            first.0,
            samples.force_outside[random.below(samples.force_outside.len())],
        );
        infinite(b, outside, &mut report)?;
        if !samples.flux_outside.is_empty() {
            let x = samples.flux_outside[random.below(samples.flux_outside.len())];
            infinite(b, (x, first.1), &mut report)?;
        }
    }
    for departure in &samples.departure {
        off_the_law(b, departure, &mut report)?;
    }
    Ok(report)
}

fn within<X: Space>(
    b: &impl Bipotential<X>,
    (x, y): (X, X),
    report: &mut Report,
) -> Result<(), Violation> {
    let at = || format!("at {x:?}, {y:?}");
    let (gap, tolerance) = gap(b, &x, &y);
    report.holds("b is finite within its domain", gap.is_finite(), at)?;
    report.at_most("b(x, y) ≥ x·y", (-gap, tolerance), at)
}

fn infinite<X: Space>(
    b: &impl Bipotential<X>,
    (x, y): (X, X),
    report: &mut Report,
) -> Result<(), Violation> {
    let at = || format!("at {x:?}, {y:?}");
    report.holds(
        "b is infinite outside its domain",
        b.b(&x, &y) == f64::INFINITY,
        at,
    )
}

/// On chords.
fn convex<X: Space>(
    b: &impl Bipotential<X>,
    ((x0, y0), (x1, y1)): ((X, X), (X, X)),
    s: f64,
    report: &mut Report,
) -> Result<(), Violation> {
    let at = || format!("at {s} from {x0:?}, {y0:?} to {x1:?}, {y1:?}");
    let between = |a: &X, b: &X| a.plus(-s, a).plus(s, b);
    let along_x = (1.0 - s) * b.b(&x0, &y0) + s * b.b(&x1, &y0);
    let along_y = (1.0 - s) * b.b(&x0, &y0) + s * b.b(&x0, &y1);
    let above_x = b.b(&between(&x0, &x1), &y0) - along_x;
    let above_y = b.b(&x0, &between(&y0, &y1)) - along_y;
    let allowed = |along: f64| ROUND_OFF * (1.0 + along.abs());
    report.at_most("b is convex in x", (above_x, allowed(along_x)), at)?;
    report.at_most("b is convex in y", (above_y, allowed(along_y)), at)
}

/// Equality, and y a subgradient of b(·, y) at x, x one of b(x, ·) at y.
fn on_the_law<X: Space>(
    b: &impl Bipotential<X>,
    (x, y): (X, X),
    (x1, y1): (X, X),
    report: &mut Report,
) -> Result<(), Violation> {
    let at = || format!("at {x:?}, {y:?}, from {x1:?}, {y1:?}");
    let (own, round_off) = gap(b, &x, &y);
    report.at_most("b(x, y) = x·y on the law", (own.abs(), round_off), at)?;
    let base = b.b(&x, &y);
    let tolerance = round_off + gap(b, &x1, &y).1 + gap(b, &x, &y1).1;
    let below_x = y.dot(&x1.plus(-1.0, &x)) - (b.b(&x1, &y) - base);
    let below_y = x.dot(&y1.plus(-1.0, &y)) - (b.b(&x, &y1) - base);
    report.at_most("y ∈ ∂ₓb(x, y) on the law", (below_x, tolerance), at)?;
    report.at_most("x ∈ ∂ᵧb(x, y) on the law", (below_y, tolerance), at)
}

/// The gap is positive, grows at least like ε² and, being convex, at most like ε.
fn off_the_law<X: Space>(
    b: &impl Bipotential<X>,
    departure: &Departure<X>,
    report: &mut Report,
) -> Result<(), Violation> {
    let (x, y, dx, dy) = departure;
    let at = || format!("on leaving {x:?}, {y:?} by {dx:?}, {dy:?}");
    let gap = |eps: f64| gap(b, &x.plus(eps, dx), &y.plus(eps, dy));
    let (full, tolerance) = gap(1.0);
    report.at_most("b(x, y) > x·y off the law", (1e3 * tolerance, full), at)?;
    for eps in [1e-1, 1e-2, 1e-3] {
        let gap = gap(eps).0;
        let short = 1e-2 * eps * eps * full - gap;
        report.at_most("the gap grows at least like ε²", (short, tolerance), at)?;
        report.at_most(
            "the gap grows at most like ε",
            (gap - eps * full, tolerance),
            at,
        )?;
    }
    Ok(())
}
