//! The laws of an interface as one type, and each as an equation; what they say is in the
//! laws themselves.

pub(crate) mod anisotropic;
pub(crate) mod bounded;
pub(crate) mod coulomb;
pub(crate) mod limited;
pub(crate) mod table;
pub(crate) mod tie;
pub(crate) mod tresca;

use crate::duality::Bipotential;
use crate::local::{Local, Status, direction, tangential_norm};
use anisotropic::AnisotropicCoulomb;
use bounded::{Bounded, ShearBound};
use coulomb::Coulomb;
use limited::LimitedCoulomb;
use nalgebra::SMatrix;
use tie::Tie;
use tresca::{Tresca, clipped};

/// Unilateral contact with friction, or a tie.
///
/// All are solved in one form, t = T(u, t; α) for any α > 0 \[N/mm\]: the prediction from the
/// displacement and its correction, [`Self::correct`]. Coulomb's law projects t − αũ on its cone,
/// \[90′\]. Where the bound g(t_n) of the shear is no cone, ũ would jump with its slope; there the
/// correction of q = t − αu is that of Alart and Curnier,
///
/// t_n = ⟨q_n⟩₊, t_t = proj(q_t, ‖·‖ ≤ g(t_n)),
///
/// continuous, and with the same fixed points whatever g.
///
/// Source: P. Alart and A. Curnier, *Computer Methods in Applied Mechanics and Engineering* 92
/// (1991) 353-375.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// ‖t_t‖ ≤ μ t_n.
    Coulomb(Coulomb),
    /// ‖t_t‖ ≤ g.
    Tresca(Tresca),
    /// ‖t_t‖ ≤ min(μ t_n, g₀).
    Limited(LimitedCoulomb),
    /// √((t_x/μ_x)² + (t_y/μ_y)²) ≤ t_n.
    Anisotropic(AnisotropicCoulomb),
    /// ‖t_t‖ ≤ g(t_n), of users too.
    Bounded(Bounded),
    /// u = 0.
    Tie(Tie),
}

/// Part of the force below which α‖u_t‖ is no slip but the rounding of one: its direction is noise,
/// and Newton's method would take as many iterations as that happens to be good or bad.
const NO_SLIP: f64 = 1e-11;

/// Largest angle of friction \[rad\]: nothing slips out of a corner that is as sharp.
const STEEPEST: f64 = 1.56;

impl From<Coulomb> for Friction {
    fn from(law: Coulomb) -> Self {
        Self::Coulomb(law)
    }
}

impl From<Tresca> for Friction {
    fn from(law: Tresca) -> Self {
        Self::Tresca(law)
    }
}

impl From<LimitedCoulomb> for Friction {
    fn from(law: LimitedCoulomb) -> Self {
        Self::Limited(law)
    }
}

impl From<AnisotropicCoulomb> for Friction {
    fn from(law: AnisotropicCoulomb) -> Self {
        Self::Anisotropic(law)
    }
}

impl From<Tie> for Friction {
    fn from(law: Tie) -> Self {
        Self::Tie(law)
    }
}

/// A law lives as long as the program: a `static`, or what `Box::leak` leaves of one whose parameters
/// are read.
impl<L: ShearBound> From<&'static L> for Friction {
    fn from(law: &'static L) -> Self {
        Self::Bounded(Bounded::new(law))
    }
}

impl Friction {
    /// The law between forces \[N\] of a law between tractions \[MPa\], on an area ≥ 0 \[mm²\]: a
    /// limit of the shear is multiplied by it, a coefficient is not. A negative area is none.
    pub fn scaled(self, area: f64) -> Self {
        // Not `f64::max`, which would turn NaN into no area.
        let area = if area <= 0.0 { 0.0 } else { area };
        match self {
            Self::Coulomb(_) | Self::Anisotropic(_) | Self::Tie(_) => self,
            Self::Tresca(law) => Self::Tresca(law.scaled(area)),
            Self::Limited(law) => Self::Limited(law.scaled(area)),
            Self::Bounded(law) => Self::Bounded(law.scaled(area)),
        }
    }

    /// The law at a sharp corner, whose normals fill a cone of this half angle \[rad\]: the forces of all
    /// of them fill Coulomb's cone of the angle of friction and that one together. Of a law that limits
    /// the shear only the coefficient counts. A corner of a negative angle is none.
    pub fn at_corner(self, half_angle: f64) -> Self {
        let half_angle = if half_angle <= 0.0 { 0.0 } else { half_angle };
        let angle = self.coefficient().atan() + half_angle;
        let angle = if angle >= STEEPEST { STEEPEST } else { angle };
        Self::Coulomb(Coulomb::of(angle.tan()))
    }

    /// Whether the law is a tie: linear, and without a sign of the pressure.
    #[inline]
    pub fn is_tie(&self) -> bool {
        matches!(self, Self::Tie(_))
    }

    /// The displacement nearest to u at which the law has forces, where b is finite: no penetration, or none at all.
    pub fn admissible<const D: usize>(&self, u: &Local<D>) -> Local<D> {
        if self.is_tie() {
            return u.map(|u| if u.is_nan() { u } else { 0.0 });
        }
        let mut open = *u;
        // Not `f64::max`, which would turn NaN into contact.
        open[0] = if u[0] <= 0.0 { 0.0 } else { u[0] };
        open
    }

    /// Whether the law can resist slip at all.
    pub fn resists_slip(&self) -> bool {
        self.bound(1.0) > 0.0
    }

    /// b(−u, t) \[N·mm\], x = −u: the bipotential of the law, or for [`LimitedCoulomb`], which has
    /// none, and for other bounds, the function that takes its place. b(x, t) ≥ x·t, with equality exactly at the law.
    pub fn b<const D: usize>(&self, x: &Local<D>, t: &Local<D>) -> f64 {
        match self {
            Self::Coulomb(law) => law.b(x, t),
            Self::Tresca(law) => law.b(x, t),
            Self::Limited(law) => law.b(x, t),
            Self::Bounded(law) => law.b(x, t),
            Self::Anisotropic(law) => law.b(x, t),
            Self::Tie(law) => law.b(x, t),
        }
    }

    /// The projection of a force on the admissible ones: orthogonal; of an anisotropic law so
    /// between stretched forces.
    #[inline]
    pub fn project<const D: usize>(&self, q: &Local<D>) -> Local<D> {
        match self {
            Self::Coulomb(law) => law.project(q),
            Self::Tresca(law) => law.project(q),
            Self::Limited(law) => law.project(q),
            Self::Bounded(law) => law.project(q),
            Self::Tie(_) => *q,
            Self::Anisotropic(law) => {
                let m = law.stretch();
                let stretched = q.component_div(&m);
                law.isotropic().project(&stretched).component_mul(&m)
            }
        }
    }

    /// The correction T(u, t; α) \[N\], always an admissible force; its fixed points t are the
    /// forces of the law at u, whatever α > 0.
    #[inline]
    pub fn correct<const D: usize>(&self, u: &Local<D>, t: &Local<D>, alpha: f64) -> Local<D> {
        match self {
            Self::Coulomb(law) => law.project(&(t - alpha * law.shifted(u))),
            Self::Tresca(_) | Self::Limited(_) | Self::Bounded(_) => {
                let q = t - alpha * u;
                clipped(&q, self.bound(pressure(&q)))
            }
            Self::Tie(_) => t - alpha * u,
            Self::Anisotropic(law) => {
                let m = law.stretch();
                let (u, t) = (u.component_mul(&m), t.component_div(&m));
                Self::Coulomb(law.isotropic())
                    .correct(&u, &t, alpha)
                    .component_mul(&m)
            }
        }
    }

    /// ∂T/∂t and −∂T/∂u of [`Self::correct`]; at its kinks elements of the generalised Jacobian.
    #[inline]
    pub fn correct_jacobian<const D: usize>(
        &self,
        u: &Local<D>,
        t: &Local<D>,
        alpha: f64,
    ) -> (SMatrix<f64, D, D>, SMatrix<f64, D, D>) {
        match self {
            Self::Coulomb(law) => {
                let projector = law.project_jacobian(&(t - law.shifted(u) * alpha));
                let slips = alpha * tangential_norm(u) > NO_SLIP * t.norm();
                let shifted = match slips {
                    true => law.shifted_jacobian(u),
                    false => SMatrix::identity(),
                };
                (projector, projector * shifted * alpha)
            }
            Self::Tresca(_) | Self::Limited(_) | Self::Bounded(_) => {
                let derivative = self.clipped_jacobian(&(t - alpha * u));
                (derivative, derivative * alpha)
            }
            Self::Tie(_) => (SMatrix::identity(), SMatrix::identity() * alpha),
            Self::Anisotropic(law) => {
                let m: Local<D> = law.stretch();
                let (u, t) = (u.component_mul(&m), t.component_div(&m));
                let isotropic = Self::Coulomb(law.isotropic());
                let (force, displacement) = isotropic.correct_jacobian(&u, &t, alpha);
                (
                    SMatrix::from_fn(|i, j| m[i] * force[(i, j)] / m[j]),
                    SMatrix::from_fn(|i, j| m[i] * displacement[(i, j)] * m[j]),
                )
            }
        }
    }

    /// The natural map t − T(u, t; α) \[N\]; zero exactly when (−u, t) obeys the law.
    #[inline]
    pub fn natural_map<const D: usize>(&self, u: &Local<D>, t: &Local<D>, alpha: f64) -> Local<D> {
        t - self.correct(u, t, alpha)
    }

    /// The displacement that [`Self::correct`] moves the force against: ũ of \[90′\] where the
    /// bound is a cone, else u.
    #[inline]
    pub fn shifted<const D: usize>(&self, u: &Local<D>) -> Local<D> {
        match self {
            Self::Coulomb(law) => law.shifted(u),
            Self::Tresca(_) | Self::Limited(_) | Self::Bounded(_) | Self::Tie(_) => *u,
            Self::Anisotropic(law) => {
                let m = law.stretch();
                let stretched = law.isotropic().shifted(&u.component_mul(&m));
                stretched.component_mul(&m)
            }
        }
    }

    /// The status that the prediction falls in, \[35\]: open without pressure, stick below the
    /// bound, else slip. Without friction a closed contact slips. A tie is always tied.
    #[inline]
    pub fn status<const D: usize>(&self, u: &Local<D>, t: &Local<D>, alpha: f64) -> Status {
        match self {
            Self::Coulomb(law) => law.status(u, t, alpha),
            Self::Tresca(_) | Self::Limited(_) | Self::Bounded(_) => {
                let q = t - alpha * u;
                let bound = self.bound(pressure(&q));
                if q[0] <= 0.0 {
                    Status::Open
                } else if bound > 0.0 && tangential_norm(&q) <= bound {
                    Status::Stick
                } else {
                    Status::Slip
                }
            }
            Self::Tie(_) => Status::Tied,
            Self::Anisotropic(law) => {
                let m = law.stretch();
                let (u, t) = (u.component_mul(&m), t.component_div(&m));
                law.isotropic().status(&u, &t, alpha)
            }
        }
    }

    /// g(t_n), the largest shear at a pressure \[N\]; of [`Self::isotropic`].
    #[inline]
    pub fn bound(&self, t_n: f64) -> f64 {
        match self.isotropic() {
            Self::Tie(_) => f64::INFINITY,
            Self::Tresca(law) => law.limit(),
            Self::Limited(law) => law.bound(t_n),
            Self::Bounded(law) => law.bound(t_n),
            law => law.coefficient() * t_n,
        }
    }

    /// The coefficient of friction, the slope of [`Self::bound`] at t_n = 0.
    #[inline]
    pub fn coefficient(&self) -> f64 {
        match self {
            Self::Coulomb(law) => law.friction(),
            Self::Tresca(_) | Self::Tie(_) => 0.0,
            Self::Limited(law) => law.friction(),
            Self::Anisotropic(law) => law.isotropic().friction(),
            Self::Bounded(law) => law.slope(0.0),
        }
    }

    /// g'(t_n), of [`Self::isotropic`]; at a kink that of either side.
    #[inline]
    pub fn slope(&self, t_n: f64) -> f64 {
        match self {
            Self::Limited(law) if law.bound(t_n) >= law.limit() => 0.0,
            Self::Bounded(law) => law.slope(t_n),
            law => law.coefficient(),
        }
    }

    /// The law between û = m ∘ u and t̂ = t/m, with the factors m ≤ 1 of [`Self::stretch`], which
    /// is isotropic; every other law is its own.
    #[inline]
    pub fn isotropic(&self) -> Self {
        match self {
            Self::Anisotropic(law) => Self::Coulomb(law.isotropic()),
            _ => *self,
        }
    }

    /// The factors m of [`Self::isotropic`].
    #[inline]
    pub fn stretch<const D: usize>(&self) -> Local<D> {
        match self {
            Self::Anisotropic(law) => law.stretch(),
            _ => Local::repeat(1.0),
        }
    }

    /// The derivative of q ↦ (⟨q_n⟩₊, q_t clipped to g(⟨q_n⟩₊)).
    fn clipped_jacobian<const D: usize>(&self, q: &Local<D>) -> SMatrix<f64, D, D> {
        let closed = q[0] > 0.0;
        let bound = self.bound(pressure(q));
        let norm = tangential_norm(q);
        let mut jacobian = SMatrix::zeros();
        jacobian[(0, 0)] = f64::from(closed);
        let (along, across) = if norm <= bound {
            (1.0, 1.0)
        } else {
            (0.0, bound / norm)
        };
        let tau = direction(q);
        let slope = self.slope(pressure(q));
        for i in 1..D {
            for j in 1..D {
                jacobian[(i, j)] = (along - across) * tau[i] * tau[j];
            }
            jacobian[(i, i)] += across;
            if closed && norm > bound {
                jacobian[(i, 0)] = slope * tau[i];
            }
        }
        jacobian
    }
}

/// ⟨q_n⟩₊; NaN stays.
#[inline]
fn pressure<const D: usize>(q: &Local<D>) -> f64 {
    if q[0] <= 0.0 { 0.0 } else { q[0] }
}
