//! Contact with friction of any bound that follows from the pressure, of users too; not friction that
//! has a direction, or a memory.

use crate::duality::{at_most, restricted};
use crate::local::{Local, tangential_norm};
use std::fmt;

/// The bound of the shear in a contact by its pressure: ‖t_t‖ ≤ g(t_n), slip opposed to t_t, \[17\] with
/// g(t_n) for μ t_n.
///
/// A law of friction outside this crate is a bound: the statuses, the equation with its derivatives, the
/// projection and the certificate follow from it. `&'static` of one becomes a [`Friction`](crate::Friction)
/// by `into()`; [`contract::friction`](crate::contract::friction) tests it.
pub trait ShearBound: fmt::Debug + Send + Sync {
    /// g(t_n) \[MPa\] at a pressure t_n ≥ 0 \[MPa\]: not negative, never falling, concave.
    fn bound(&self, t_n: f64) -> f64;

    /// g'(t_n) \[–\], finite at t_n = 0 too; at a kink that of either side.
    fn slope(&self, t_n: f64) -> f64;
}

/// The law of friction of a [`ShearBound`], between forces on an area.
#[derive(Debug, Clone, Copy)]
pub struct Bounded {
    law: &'static dyn ShearBound,
    area: f64,
}

/// The same bound, by its place in memory, on the same area.
impl PartialEq for Bounded {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::addr_eq(self.law, other.law) && self.area == other.area
    }
}

impl Bounded {
    /// The law between tractions.
    pub(crate) fn new(law: &'static dyn ShearBound) -> Self {
        Self { law, area: 1.0 }
    }

    /// The law between forces on this area times that of the present law \[mm²\].
    pub(crate) fn scaled(self, area: f64) -> Self {
        Self {
            area: self.area * area,
            ..self
        }
    }

    /// g(t_n) \[N\]; below no pressure its tangent at none.
    #[inline]
    pub fn bound(&self, t_n: f64) -> f64 {
        if self.area <= 0.0 {
            return 0.0;
        }
        let traction = t_n / self.area;
        if traction < 0.0 {
            return self.area * (self.law.bound(0.0) + self.law.slope(0.0) * traction);
        }
        self.area * self.law.bound(traction)
    }

    /// g'(t_n).
    #[inline]
    pub fn slope(&self, t_n: f64) -> f64 {
        if self.area <= 0.0 {
            return 0.0;
        }
        // Not `f64::max`, which would turn NaN into no pressure.
        let traction = if t_n <= 0.0 { 0.0 } else { t_n / self.area };
        self.law.slope(traction)
    }

    /// g(t_n) ‖u_t‖ if u_n ≥ 0, t_n ≥ 0 and ‖t_t‖ ≤ g(t_n), else +∞, for x = −u and y = t: what
    /// [`LimitedCoulomb::b`](crate::LimitedCoulomb::b) is of its bound.
    pub fn b<const D: usize>(&self, x: &Local<D>, y: &Local<D>) -> f64 {
        let (shear, bound) = (tangential_norm(y), self.bound(y[0]));
        restricted(
            x[0] <= 0.0 && y[0] >= 0.0 && at_most(shear, bound, shear.max(y[0])),
            bound * tangential_norm(x),
        )
    }

    /// The orthogonal projection on the admissible forces, which are convex: the pressure t_n at which
    /// q − t is normal to the bound, (t_n − q_n) = (‖q_t‖ − g(t_n)) g'(t_n), by bisection.
    pub fn project<const D: usize>(&self, q: &Local<D>) -> Local<D> {
        let norm = tangential_norm(q);
        let least = if q[0] <= 0.0 { 0.0 } else { q[0] };
        let excess = |t_n: f64| norm - self.bound(t_n);
        let mut low = least;
        if excess(low) > 0.0 {
            let short = |t_n: f64| excess(t_n) * self.slope(t_n) > t_n - q[0];
            let mut high = low + excess(low) * self.slope(low);
            while short(low) {
                let middle = 0.5 * (low + high);
                if middle <= low || middle >= high {
                    break;
                }
                if short(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
        }
        let radius = self.bound(low);
        let mut projected = if norm <= radius {
            *q
        } else {
            q * (radius / norm)
        };
        projected[0] = low;
        projected
    }
}
