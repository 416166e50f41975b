//! A tie, which holds two surfaces together; not contact, which opens and slips.

use crate::duality::{Superpotential, indicator};
use crate::local::Local;

/// A bilateral constraint: u = 0 under any force, tension and compression alike.
///
/// It has the superpotential V(−u) = ψ(u = 0), with the conjugate W(t) = 0; the natural map is α u, linear and without
/// a kink.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tie;

impl<const D: usize> Superpotential<Local<D>> for Tie {
    fn v(&self, x: &Local<D>) -> f64 {
        indicator(x.iter().all(|x| *x == 0.0))
    }

    fn w(&self, y: &Local<D>) -> f64 {
        indicator(!y.iter().any(|y| y.is_nan()))
    }
}
