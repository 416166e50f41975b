//! Superpotentials and bipotentials, the two languages of the laws, \[24\]-\[34\]; not a minimiser.

/// A Fenchel pair: two convex functions, each the conjugate of the other, with
/// V(x) + W(y) ≥ x·y for all x, y, \[26\].
///
/// The law is the set of *extremal* pairs, where equality holds, \[24\]; equivalently y ∈ ∂V(x)
/// and x ∈ ∂W(y), \[28\]. Outside their domains the functions are `f64::INFINITY`; x is a flux (a
/// rate or an increment), y the force conjugate to it, and the values are densities of power.
///
/// Boundaries of domains are thick by a relative 10⁻¹²: a force that rounding has put just outside
/// its yield surface is on it. Conditions of sign alone, such as u_n ≥ 0, have no scale and are
/// exact.
pub trait Superpotential<X> {
    /// V(x); convex.
    fn v(&self, x: &X) -> f64;
    /// W(y), the conjugate of V; convex.
    fn w(&self, y: &X) -> f64;
}

/// A function convex in x, convex in y, with b(x, y) ≥ x·y for all x, y, \[32\].
///
/// The law is the set of extremal pairs, b(x, y) = x·y, \[29\]; equivalently y ∈ ∂ₓb(x, y) and
/// x ∈ ∂ᵧb(x, y), \[34\]: a normality rule that is implicit, whence laws without associated flow.
/// `f64::INFINITY` outside the domain.
///
/// Source: G. de Saxcé and Z.-Q. Feng, *Mathematical and Computer Modelling* 28 (1998) 225-245.
pub trait Bipotential<X> {
    /// b(x, y) ≥ x·y.
    fn b(&self, x: &X, y: &X) -> f64;
}

/// The separable bipotential V(x) + W(y) of a standard law, \[31\].
impl<X, P: Superpotential<X>> Bipotential<X> for P {
    fn b(&self, x: &X, y: &X) -> f64 {
        self.v(x) + self.w(y)
    }
}

/// Relative thickness of the boundaries of domains.
const ROUND_OFF: f64 = 1e-12;

/// `value ≤ limit`, up to round-off in quantities of the size `scale`; false for NaN.
#[inline]
pub(crate) fn at_most(value: f64, limit: f64, scale: f64) -> bool {
    value <= limit + ROUND_OFF * scale
}

/// `value` inside a domain, +∞ outside, whatever `value` is there.
#[inline]
pub(crate) fn restricted(inside: bool, value: f64) -> f64 {
    if inside { value } else { f64::INFINITY }
}

/// ψ of a set: 0 inside, +∞ outside.
#[inline]
pub(crate) fn indicator(inside: bool) -> f64 {
    restricted(inside, 0.0)
}
