//! Unilateral contact without friction, \[11\]-\[16\]; not contact with friction, which no
//! superpotential describes.

use crate::duality::{Superpotential, indicator};

/// Signorini's law u_n ≥ 0, t_n ≥ 0, u_n t_n = 0, \[11\].
///
/// The superpotential of x = −u_n is the indicator of R₋, \[13\]; its conjugate, of y = t_n, the
/// indicator of R₊, \[16\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Signorini;

impl Signorini {
    /// Whether the pair obeys \[11\], exactly.
    pub fn holds(&self, u_n: f64, t_n: f64) -> bool {
        u_n >= 0.0 && t_n >= 0.0 && (u_n == 0.0 || t_n == 0.0)
    }
}

impl Superpotential<f64> for Signorini {
    /// φ_n(−u_n) = ψ(−u_n ≤ 0), \[13\].
    fn v(&self, x: &f64) -> f64 {
        indicator(*x <= 0.0)
    }

    /// χ_n(t_n) = ψ(t_n ≥ 0), \[16\].
    fn w(&self, y: &f64) -> f64 {
        indicator(*y >= 0.0)
    }
}
