//! Temperatures that a step gives, at the quadrature points; not the strains that they cause.

use std::fmt;
use std::sync::Arc;

type Function<const D: usize> = dyn Fn(&[f64; D]) -> f64 + Send + Sync;

/// A number by position in the undeformed body \[mm\].
#[derive(Clone)]
pub struct Field<const D: usize>(Arc<Function<D>>);

impl<const D: usize> Field<D> {
    /// From a function of the position.
    pub fn new(of: impl Fn(&[f64; D]) -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(of))
    }

    /// The number at a position.
    pub fn at(&self, position: &[f64; D]) -> f64 {
        (self.0)(position)
    }
}

impl<const D: usize> fmt::Debug for Field<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Field")
    }
}

/// Whether both are one function, not whether two functions have the same values.
impl<const D: usize> PartialEq for Field<D> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Changes of the temperature since the body was free of stress \[K\], at the quadrature points in the order of
/// [`Driver::points`](crate::Driver::points); none where nothing has been heated or cooled.
#[derive(Debug, Clone, Default)]
pub struct Temperature(pub(crate) Vec<f64>);

/// Whether both are the same at every point: what was heated and has cooled is where it was.
impl PartialEq for Temperature {
    fn eq(&self, other: &Self) -> bool {
        let count = self.0.len().max(other.0.len());
        (0..count).all(|k| self.at(k) == other.at(k))
    }
}

impl Temperature {
    /// The change at a point.
    pub fn at(&self, point: usize) -> f64 {
        self.0.get(point).copied().unwrap_or(0.0)
    }

    /// The changes at all points; empty where nothing has been heated or cooled.
    pub fn values(&self) -> &[f64] {
        &self.0
    }

    /// What a function makes of the numbers of both, point by point; of zeros it makes zero.
    pub(crate) fn with(&self, b: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let count = self.0.len().max(b.0.len());
        Self((0..count).map(|k| f(self.at(k), b.at(k))).collect())
    }

    /// Σ a b.
    pub(crate) fn inner(&self, b: &Self) -> f64 {
        self.0.iter().zip(&b.0).map(|(a, b)| a * b).sum()
    }
}
