//! Unilateral contact with Tresca friction, a shear bounded by a constant; not Coulomb friction,
//! whose bound follows the pressure.

use crate::duality::{Superpotential, at_most, indicator, restricted};
use crate::error::{LawError, non_negative};
use crate::local::{Local, tangential_norm};

/// Unilateral contact, \[11\], and friction of given limit g: ‖t_t‖ ≤ g, slip opposed to t_t,
/// \[17\] with the constant g for μ t_n.
///
/// The bound does not depend on the flux or the pressure, so the law is standard: it has the
/// superpotential V(−u) = ψ(u_n ≥ 0) + g ‖u_t‖ and the conjugate W(t) = ψ(t_n ≥ 0) + ψ(‖t_t‖ ≤ g).
/// It resists slip even without pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tresca {
    limit: f64,
}

impl Tresca {
    /// From the limit g ≥ 0 of the tangential force \[N\].
    ///
    /// # Errors
    /// `Negative` unless g ≥ 0 is finite.
    pub fn new(limit: f64) -> Result<Self, LawError> {
        Ok(Self {
            limit: non_negative("friction limit", limit)?,
        })
    }
}

impl<const D: usize> Superpotential<Local<D>> for Tresca {
    fn v(&self, x: &Local<D>) -> f64 {
        restricted(x[0] <= 0.0, self.limit * tangential_norm(x))
    }

    fn w(&self, y: &Local<D>) -> f64 {
        indicator(y[0] >= 0.0 && at_most(tangential_norm(y), self.limit, self.limit))
    }
}
