//! Contact with Coulomb friction whose shear is limited, as by the yielding of the softer surface.

use crate::duality::{at_most, restricted};
use crate::error::{LawError, Parameter, non_negative};
use crate::friction::coulomb::Coulomb;
use crate::local::{Local, tangential_norm};

/// Unilateral contact with friction ‖t_t‖ ≤ g(t_n) = min(μ t_n, g₀), slip opposed to t_t, \[17\]
/// with g(t_n) for μ t_n: Coulomb's law up to the pressure g₀/μ, Tresca's beyond it.
///
/// It has no bipotential. A bipotential is convex in the force, so that the forces which go with one
/// displacement would fill a convex set, \[34\]; those which go with a slip u_t ≠ 0 are
/// (t_n, −g(t_n) u_t/‖u_t‖), t_n ≥ 0, a line with a kink. What [`Self::b`] keeps is all that a
/// certificate needs: the inequality \[32\], and equality exactly at the law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedCoulomb {
    coulomb: Coulomb,
    limit: f64,
}

impl LimitedCoulomb {
    /// From the coefficient of friction μ ≥ 0 and the limit g₀ ≥ 0 of the shear: a force \[N\], or
    /// a traction \[MPa\] for [`Friction::scaled`](crate::Friction::scaled).
    ///
    /// # Errors
    /// `NegativeFriction` unless μ ≥ 0 is finite; `Negative` unless g₀ ≥ 0 is finite.
    pub fn new(friction: f64, limit: f64) -> Result<Self, LawError> {
        Ok(Self {
            coulomb: Coulomb::new(friction)?,
            limit: non_negative(Parameter::FrictionLimit, limit)?,
        })
    }

    /// The coefficient of friction μ.
    pub fn friction(&self) -> f64 {
        self.coulomb.friction()
    }

    /// The limit g₀ \[N\].
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// g(t_n) = min(μ t_n, g₀) \[N\].
    #[inline]
    pub fn bound(&self, t_n: f64) -> f64 {
        let cone = self.coulomb.friction() * t_n;
        // Not `f64::min`, which would turn NaN into the limit.
        if cone > self.limit { self.limit } else { cone }
    }

    /// g(t_n) ‖u_t‖ if u_n ≥ 0, t_n ≥ 0 and ‖t_t‖ ≤ g(t_n), else +∞, for x = −u and y = t.
    ///
    /// b − t·(−u) = t_n u_n + (g(t_n) ‖u_t‖ + t_t·u_t) is a sum of two terms that are not negative;
    /// both vanish exactly at the law. Convex in x; in y *concave*, as g is, and no bipotential.
    pub fn b<const D: usize>(&self, x: &Local<D>, y: &Local<D>) -> f64 {
        let shear = tangential_norm(y);
        restricted(
            x[0] <= 0.0 && self.coulomb.contains(y) && at_most(shear, self.limit, self.limit),
            self.bound(y[0]) * tangential_norm(x),
        )
    }

    /// The orthogonal projection on the admissible forces, which are convex.
    #[inline]
    pub fn project<const D: usize>(&self, q: &Local<D>) -> Local<D> {
        let cone = self.coulomb.project(q);
        let norm = tangential_norm(&cone);
        if norm <= self.limit {
            return cone;
        }
        // Beyond the cylinder, and if beside the cone too then nearest to their common circle.
        let mut clipped = cone * (self.limit / norm);
        clipped[0] = q[0].max(self.limit / self.coulomb.friction());
        clipped
    }

    /// The same law for forces multiplied by a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            limit: self.limit * factor,
            ..self
        }
    }
}
