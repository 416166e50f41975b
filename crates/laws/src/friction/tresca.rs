//! Unilateral contact with Tresca friction, a shear bounded by a constant; not Coulomb friction,
//! whose bound follows the pressure.

use crate::duality::{Superpotential, at_most, indicator, restricted};
use crate::error::{LawError, Parameter, non_negative};
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
    /// From the limit g ≥ 0 of the shear: a force \[N\], or a traction \[MPa\] for
    /// [`Friction::scaled`](crate::Friction::scaled).
    ///
    /// # Errors
    /// `Negative` unless g ≥ 0 is finite.
    pub fn new(limit: f64) -> Result<Self, LawError> {
        Ok(Self {
            limit: non_negative(Parameter::FrictionLimit, limit)?,
        })
    }

    /// The limit g \[N\].
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// The orthogonal projection on the admissible forces.
    #[inline]
    pub fn project<const D: usize>(&self, q: &Local<D>) -> Local<D> {
        clipped(q, self.limit)
    }

    /// The same law for forces multiplied by a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            limit: self.limit * factor,
        }
    }
}

/// (⟨q_n⟩₊, q_t clipped to the disc of that radius).
#[inline]
pub(crate) fn clipped<const D: usize>(q: &Local<D>, radius: f64) -> Local<D> {
    let norm = tangential_norm(q);
    let mut clipped = if norm <= radius {
        *q
    } else {
        q * (radius / norm)
    };
    // Not `f64::max`, which would turn NaN into contact lost.
    clipped[0] = if q[0] <= 0.0 { 0.0 } else { q[0] };
    clipped
}

impl<const D: usize> Superpotential<Local<D>> for Tresca {
    fn v(&self, x: &Local<D>) -> f64 {
        restricted(x[0] <= 0.0, self.limit * tangential_norm(x))
    }

    fn w(&self, y: &Local<D>) -> f64 {
        indicator(y[0] >= 0.0 && at_most(tangential_norm(y), self.limit, self.limit))
    }
}
