//! Drucker–Prager plasticity with a dilatancy of its own, as a bipotential; integrated over a
//! step in `elastic_drucker_prager`.

use crate::duality::{Bipotential, at_most, restricted};
use crate::error::{LawError, Parameter, positive};
use crate::friction::coulomb::Coulomb;
use crate::local::Local;
use moreau_mandel::{Sym2, deviator, trace};

/// The non-associated Drucker–Prager law between the plastic strain rate ε̇ and the stress σ.
///
/// Yield ‖s‖ ≤ k_f (c₀ − σ_m), flow e_v = k_t ‖e‖ and e ∥ s with 0 ≤ k_t ≤ k_f; σ_m = ⅓ tr σ
/// (tension positive), e_v = tr ε̇; at the apex σ_m = c₀, s = 0 any e_v ≥ k_t ‖e‖. With k_t = k_f
/// the flow is associated.
///
/// It *is* Coulomb contact of coefficient k_f in 1 + 6 dimensions: force (c₀ − σ_m, s),
/// displacement (e_v − k_t ‖e‖, −e).
///
/// Source: M. Hjiaj, J. Fortin and G. de Saxcé, *International Journal of Engineering Science* 41
/// (2003) 1109-1143.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DruckerPrager {
    cone: Coulomb,
    dilatancy: f64,
    apex: f64,
}

impl DruckerPrager {
    /// From the friction k_f ≥ 0, the dilatancy k_t ∈ [0, k_f] and the mean stress c₀ > 0 of the
    /// apex \[MPa\].
    ///
    /// # Errors
    /// `NegativeFriction`, `DilatancyOutOfRange` or `NotPositive` when these do not hold.
    pub fn new(friction: f64, dilatancy: f64, apex: f64) -> Result<Self, LawError> {
        let cone = Coulomb::new(friction)?;
        if !(0.0..=friction).contains(&dilatancy) {
            return Err(LawError::DilatancyOutOfRange {
                dilatancy,
                friction,
            });
        }
        Ok(Self {
            cone,
            dilatancy,
            apex: positive(Parameter::Apex, apex)?,
        })
    }

    /// The cone through the edges of Mohr and Coulomb's pyramid in triaxial compression, from the
    /// cohesion c > 0 \[MPa\], the friction angle φ ∈ \]0°, 90°\[ and the dilatancy angle
    /// ψ ∈ \[0°, φ\], in degrees:
    ///
    /// k_f = 2√6 sin φ/(3 − sin φ), k_t = 2√6 sin ψ/(3 − sin ψ), c₀ = c cot φ.
    ///
    /// Its strength in uniaxial compression is that of the pyramid, 2 c cos φ/(1 − sin φ); in
    /// triaxial extension and in plane strain it is stronger than the pyramid.
    ///
    /// # Errors
    /// `NotPositive` or `AngleOutOfRange` when these do not hold.
    pub fn mohr_coulomb(
        cohesion: f64,
        friction_angle: f64,
        dilatancy_angle: f64,
    ) -> Result<Self, LawError> {
        let range = |parameter, degrees, range| LawError::AngleOutOfRange {
            parameter,
            degrees,
            range,
        };
        if !(friction_angle > 0.0 && friction_angle < 90.0) {
            return Err(range(Parameter::FrictionAngle, friction_angle, "]0, 90["));
        }
        if !(0.0..=friction_angle).contains(&dilatancy_angle) {
            let most = "[0, friction angle]";
            return Err(range(Parameter::DilatancyAngle, dilatancy_angle, most));
        }
        let slope = |degrees: f64| {
            let sine = degrees.to_radians().sin();
            2.0 * 6f64.sqrt() * sine / (3.0 - sine)
        };
        let apex = positive(Parameter::Cohesion, cohesion)? / friction_angle.to_radians().tan();
        Self::new(slope(friction_angle), slope(dilatancy_angle), apex)
    }

    /// The friction k_f.
    pub fn friction(&self) -> f64 {
        self.cone.friction()
    }

    /// The dilatancy k_t.
    pub fn dilatancy(&self) -> f64 {
        self.dilatancy
    }

    /// The mean stress c₀ of the apex \[MPa\].
    pub fn apex(&self) -> f64 {
        self.apex
    }

    /// c₀ e_v + (k_f − k_t)(c₀ − σ_m) ‖e‖ of a strain rate at a mean stress σ_m, the value of the
    /// bipotential within its domain.
    pub(crate) fn power(&self, mean: f64, rate: &Sym2) -> f64 {
        let above = self.cone.friction() - self.dilatancy;
        self.apex * trace(rate) + above * (self.apex - mean) * deviator(rate).norm()
    }

    /// The natural map of the equivalent contact, \[90′\], with ρ > 0 \[MPa\]: zero exactly when
    /// (ε̇, σ) obeys the law, whatever ρ.
    pub fn natural_map(&self, rate: &Sym2, stress: &Sym2, rho: f64) -> Local<7> {
        let dilation = trace(rate) - self.dilatancy * deviator(rate).norm();
        let u = join(dilation, &-deviator(rate));
        self.cone.natural_map(&u, &self.force(stress), rho)
    }

    /// (c₀ − σ_m, s).
    fn force(&self, stress: &Sym2) -> Local<7> {
        join(self.apex - trace(stress) / 3.0, &deviator(stress))
    }
}

/// b(ε̇, σ) = c₀ e_v + (k_f − k_t)(c₀ − σ_m) ‖e‖ if ‖s‖ ≤ k_f (c₀ − σ_m) and e_v ≥ k_t ‖e‖,
/// else +∞.
impl Bipotential<Sym2> for DruckerPrager {
    fn b(&self, x: &Sym2, y: &Sym2) -> f64 {
        let (e_v, e) = (trace(x), deviator(x).norm());
        let t = self.force(y);
        let admissible = self.cone.admits(&t, y.norm() + self.apex)
            && at_most(self.dilatancy * e, e_v, x.norm());
        restricted(admissible, self.power(self.apex - t[0], x))
    }
}

/// The vector (normal, deviator) of the contact space.
fn join(normal: f64, deviator: &Sym2) -> Local<7> {
    let mut joined = Local::<7>::zeros();
    joined[0] = normal;
    joined.fixed_rows_mut::<6>(1).copy_from(deviator);
    joined
}
