//! Orthotropic Coulomb friction; not friction with a slip rule of its own: slip is normal to the
//! elliptic section of the cone.

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::{LawError, positive};
use crate::local::Local;

/// Unilateral contact with friction of coefficients μ_x, μ_y along the two tangents of the frame.
///
/// ‖t_t‖_μ = √((t_x/μ_x)² + (t_y/μ_y)²) ≤ t_n; slip obeys −u_t ∥ (t_x/μ_x², t_y/μ_y²), which is
/// parallel to t_t only along the axes. With μ_x = μ_y it is [`Coulomb`](crate::Coulomb).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropicCoulomb {
    friction: [f64; 2],
}

impl AnisotropicCoulomb {
    /// From the coefficients of friction μ_x, μ_y > 0 along the tangents 1 and 2.
    ///
    /// # Errors
    /// `NotPositive` unless both are positive and finite.
    pub fn new(friction_x: f64, friction_y: f64) -> Result<Self, LawError> {
        Ok(Self {
            friction: [
                positive("friction along the first tangent", friction_x)?,
                positive("friction along the second tangent", friction_y)?,
            ],
        })
    }
}

/// b(−u, t) = t_n √((μ_x u_x)² + (μ_y u_y)²) if u_n ≥ 0 and ‖t_t‖_μ ≤ t_n, else +∞.
impl Bipotential<Local<3>> for AnisotropicCoulomb {
    fn b(&self, x: &Local<3>, y: &Local<3>) -> f64 {
        let [mu_x, mu_y] = self.friction;
        let t_t = (y[1] / mu_x).hypot(y[2] / mu_y);
        restricted(
            x[0] <= 0.0 && at_most(t_t, y[0], y[0].abs()),
            y[0] * (mu_x * x[1]).hypot(mu_y * x[2]),
        )
    }
}
