//! Unilateral contact with Coulomb friction, \[35\]-\[43\] and \[66\]-\[69\], with the projection
//! of \[90′\]; not the clipping of a tangential force at a given pressure, see
//! [`RegularisedCoulomb`](crate::textbook::RegularisedCoulomb).

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::LawError;
use crate::local::{Local, Status, direction, hypotenuse, tangential_norm};
use nalgebra::SMatrix;

/// Unilateral contact with Coulomb friction of coefficient μ; μ = 0 is frictionless.
///
/// The forces fill the cone K_μ = {t_n ≥ 0, ‖t_t‖ ≤ μ t_n}, \[36\]. Slip is tangential, not normal
/// to the cone: the law has no superpotential, but the bipotential b_c, \[38\]. It is also the
/// complementarity K_μ* ∋ ũ ⊥ t ∈ K_μ of the force and de Saxcé's shifted displacement
/// ũ = u + μ‖u_t‖ n, so that t = proj(t − αũ, K_μ) for every α > 0, \[90′\].
///
/// With D = 2 the contact is a plane one, with D = 3 a spatial one.
///
/// Source: G. de Saxcé and Z.-Q. Feng, *Mathematical and Computer Modelling* 28 (1998) 225-245.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    friction: f64,
}

impl Coulomb {
    /// From the coefficient of friction μ ≥ 0.
    ///
    /// # Errors
    /// `NegativeFriction` unless μ ≥ 0 is finite.
    pub fn new(friction: f64) -> Result<Self, LawError> {
        if friction >= 0.0 && friction.is_finite() {
            Ok(Self { friction })
        } else {
            Err(LawError::NegativeFriction { friction })
        }
    }

    /// From a coefficient that is known to be valid.
    pub(crate) fn of(friction: f64) -> Self {
        Self { friction }
    }

    /// The coefficient of friction μ.
    #[inline]
    pub fn friction(&self) -> f64 {
        self.friction
    }

    /// t ∈ K_μ, \[36\], up to a relative round-off of 10⁻¹².
    pub fn contains<const D: usize>(&self, t: &Local<D>) -> bool {
        self.admits(t, t[0].abs().hypot(tangential_norm(t)))
    }

    /// t ∈ K_μ, up to round-off in forces of the size `scale`.
    pub(crate) fn admits<const D: usize>(&self, t: &Local<D>, scale: f64) -> bool {
        // When μ = 0 the inequality of [36] alone would admit tension.
        at_most(-t[0], 0.0, scale) && at_most(tangential_norm(t), self.friction * t[0], scale)
    }

    /// The orthogonal projection of q on K_μ, \[90′\]; 1-Lipschitz, positively homogeneous.
    #[inline]
    pub fn project<const D: usize>(&self, q: &Local<D>) -> Local<D> {
        match self.branch(q) {
            Status::Open => Local::zeros(),
            Status::Stick | Status::Tied => *q,
            Status::Slip => {
                let generator = self.generator(q);
                generator * self.along(q)
            }
        }
    }

    /// The derivative of [`Self::project`]; symmetric, positive semi-definite, of norm ≤ 1.
    ///
    /// At a kink, an element of the B-differential: of the polar cone on its boundary, of the
    /// interior of K_μ on its own.
    #[inline]
    pub fn project_jacobian<const D: usize>(&self, q: &Local<D>) -> SMatrix<f64, D, D> {
        match self.branch(q) {
            Status::Open => SMatrix::zeros(),
            Status::Stick | Status::Tied => SMatrix::identity(),
            Status::Slip => {
                let (_, sin) = self.half_angle();
                let tau = direction(q);
                let generator = self.generator(q);
                let mut jacobian = generator * generator.transpose();
                let norm = tangential_norm(q);
                if norm > 0.0 {
                    // Turning q_t turns the generator, by a circle that has shrunk from ‖q_t‖.
                    let shrunk = sin * self.along(q) / norm;
                    jacobian -= shrunk * tau * tau.transpose();
                    for i in 1..D {
                        jacobian[(i, i)] += shrunk;
                    }
                }
                jacobian
            }
        }
    }

    /// De Saxcé's shifted displacement ũ = u + μ‖u_t‖ n, \[90′\].
    #[inline]
    pub fn shifted<const D: usize>(&self, u: &Local<D>) -> Local<D> {
        let mut shifted = *u;
        shifted[0] += self.friction * tangential_norm(u);
        shifted
    }

    /// The derivative of [`Self::shifted`]; the identity, an element of the generalised Jacobian,
    /// where u_t = 0.
    #[inline]
    pub fn shifted_jacobian<const D: usize>(&self, u: &Local<D>) -> SMatrix<f64, D, D> {
        let tau = direction(u);
        SMatrix::from_fn(|i, j| match (i, j) {
            (0, 1..) => self.friction * tau[j],
            _ if i == j => 1.0,
            _ => 0.0,
        })
    }

    /// The natural map t − proj(t − αũ, K_μ) \[N\], with α > 0 \[N/mm\]; zero exactly when (−u, t)
    /// obeys the law, whatever α, \[90′\].
    #[inline]
    pub fn natural_map<const D: usize>(&self, u: &Local<D>, t: &Local<D>, alpha: f64) -> Local<D> {
        t - self.project(&(t - alpha * self.shifted(u)))
    }

    /// The status that the prediction t − αũ falls in, \[35\]: in the polar cone open, in K_μ
    /// stick, else slip. Without friction a closed contact slips.
    #[inline]
    pub fn status<const D: usize>(&self, u: &Local<D>, t: &Local<D>, alpha: f64) -> Status {
        self.branch(&(t - alpha * self.shifted(u)))
    }

    /// The incremental bipotential Δb_c(x, Δt) = b_c(x, t₀ + Δt) − t₀·x of x = −Δu, \[68\].
    pub fn incremental<const D: usize>(&self, x: &Local<D>, t0: &Local<D>, d_t: &Local<D>) -> f64 {
        self.b(x, &(t0 + d_t)) - t0.dot(x)
    }

    /// Where q lies: in the polar cone, in K_μ, or beside it. NaN lies beside and so propagates.
    #[inline]
    fn branch<const D: usize>(&self, q: &Local<D>) -> Status {
        let norm = tangential_norm(q);
        if self.friction * norm <= -q[0] {
            Status::Open
        } else if self.friction > 0.0 && norm <= self.friction * q[0] {
            Status::Stick
        } else {
            Status::Slip
        }
    }

    /// Cosine and sine of the half-angle of K_μ; (1, μ)/√(1 + μ²) without overflow.
    #[inline]
    fn half_angle(&self) -> (f64, f64) {
        let cos = 1.0 / hypotenuse(1.0, self.friction);
        (cos, self.friction * cos)
    }

    /// The unit generator of K_μ nearest to q.
    #[inline]
    fn generator<const D: usize>(&self, q: &Local<D>) -> Local<D> {
        let (cos, sin) = self.half_angle();
        let mut generator = sin * direction(q);
        generator[0] = cos;
        generator
    }

    /// The component of q along that generator.
    #[inline]
    fn along<const D: usize>(&self, q: &Local<D>) -> f64 {
        let (cos, sin) = self.half_angle();
        cos * q[0] + sin * tangential_norm(q)
    }
}

/// b_c(−u, t) = μ t_n ‖u_t‖ if u_n ≥ 0 and t ∈ K_μ, else +∞: \[38\] with the indicators that its
/// proof \[39\]-\[41\] uses. Homogeneous of degree 1 in u.
impl<const D: usize> Bipotential<Local<D>> for Coulomb {
    fn b(&self, x: &Local<D>, y: &Local<D>) -> f64 {
        restricted(
            x[0] <= 0.0 && self.contains(y),
            self.friction * y[0] * tangential_norm(x),
        )
    }
}
