//! Orthotropic Coulomb friction; not friction with a slip rule of its own: slip is normal to the
//! elliptic section of the cone.

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::{LawError, Parameter, positive};
use crate::friction::coulomb::Coulomb;
use crate::local::{Local, tangential_norm};

/// Unilateral contact with friction of coefficients μ_x, μ_y along the two tangents of the frame;
/// in the plane μ_x alone counts.
///
/// ‖t_t‖_μ = √((t_x/μ_x)² + (t_y/μ_y)²) ≤ t_n; slip obeys −u_t ∥ (t_x/μ_x², t_y/μ_y²), which is
/// parallel to t_t only along the axes. It is [`Coulomb`] contact of the larger coefficient μ between
/// the stretched t̂_i = t_i μ/μ_i and û_i = u_i μ_i/μ, whose product is that of t and u.
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
                positive(Parameter::FrictionAlong, friction_x)?,
                positive(Parameter::FrictionAcross, friction_y)?,
            ],
        })
    }

    /// The coefficients μ_x, μ_y.
    pub fn friction(&self) -> [f64; 2] {
        self.friction
    }

    /// The law of forces along one tangent alone, which has the components c, s (not both zero) along
    /// the two of the frame: 1/μ² = (c/μ_x)² + (s/μ_y)², c² + s² = 1.
    pub fn along(&self, [c, s]: [f64; 2]) -> Coulomb {
        let [x, y] = self.friction;
        Coulomb::of(c.hypot(s) / (c / x).hypot(s / y))
    }

    /// The isotropic law between the stretched force and displacement.
    #[inline]
    pub fn isotropic(&self) -> Coulomb {
        Coulomb::of(self.friction[0].max(self.friction[1]))
    }

    /// (1, μ_x/μ, μ_y/μ) ≤ 1 with the larger coefficient μ: û = m ∘ u and t = m ∘ t̂.
    #[inline]
    pub fn stretch<const D: usize>(&self) -> Local<D> {
        let larger = self.friction[0].max(self.friction[1]);
        Local::from_fn(|k, _| match k {
            0 => 1.0,
            1 => self.friction[0] / larger,
            _ => self.friction[1] / larger,
        })
    }
}

/// b(−u, t) = t_n √((μ_x u_x)² + (μ_y u_y)²) if u_n ≥ 0 and ‖t_t‖_μ ≤ t_n, else +∞.
impl<const D: usize> Bipotential<Local<D>> for AnisotropicCoulomb {
    fn b(&self, x: &Local<D>, y: &Local<D>) -> f64 {
        let mu = self.isotropic().friction() * self.stretch::<D>();
        let (resisted, t_t) = (x.component_mul(&mu), y.component_div(&mu));
        restricted(
            x[0] <= 0.0 && at_most(tangential_norm(&t_t), y[0], y[0].abs()),
            y[0] * tangential_norm(&resisted),
        )
    }
}
