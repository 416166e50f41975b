//! The modified Cam-Clay law of clays as a bipotential; not an integrated bulk law.

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::{LawError, positive};
use nalgebra::Vector3;

/// Modified Cam-Clay of slope M of the critical state, in the variables of the triaxial test.
///
/// Yield √((p − c)² + q²/M²) ≤ c, an ellipse of half-axis c through the origin; compaction is
/// positive. The hardening variable follows the volume, ȧ = e_v: not the normality rule, which
/// the factor ∂f/∂c would also move. Fluxes x = (e_v, e_q, −ȧ), forces y = (p, q, c) \[MPa\], of
/// dual product p e_v + q e_q − c ȧ.
///
/// Source: N. Zouain, I. Pontes Filho and J. Vaunat, *European Journal of Mechanics A/Solids* 29
/// (2010) 327-336.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CamClay {
    slope: f64,
}

impl CamClay {
    /// From the slope M of the critical state line in the (p, q) plane.
    ///
    /// # Errors
    /// `NotPositive` unless M > 0 is finite.
    pub fn new(slope: f64) -> Result<Self, LawError> {
        Ok(Self {
            slope: positive("slope of the critical state line", slope)?,
        })
    }
}

/// b = c √(e_v² + M² e_q²) if √((p − c)² + q²/M²) ≤ c and ȧ = e_v, else +∞.
impl Bipotential<Vector3<f64>> for CamClay {
    fn b(&self, x: &Vector3<f64>, y: &Vector3<f64>) -> f64 {
        let (e_v, e_q, a) = (x[0], x[1], -x[2]);
        let (p, q, c) = (y[0], y[1], y[2]);
        let admissible = at_most((p - c).hypot(q / self.slope), c, c.abs())
            && at_most((a - e_v).abs(), 0.0, x.norm());
        restricted(admissible, c * e_v.hypot(self.slope * e_q))
    }
}
