//! Isotropic linear elasticity, \[58\]-\[59\]; not a law with memory: its state is its strain.

use crate::bulk::{BulkLaw, FlowPower, Response};
use crate::error::{LawError, Parameter, positive};
use moreau_mandel::{Sym2, Sym4, deviator, identity, isotropic, trace};

/// How near Poisson's ratio may come to −1 and ½: of 1 − 2ν and 1 + ν rounding takes 10⁻⁷ there, and all of what it takes
/// goes into the stresses.
const NEAREST: f64 = 1e-9;

/// Isotropic linear elasticity, σ = K_c tr(ε) δ + 2G e with the deviator e of ε.
///
/// The trace of the strain is conjugate to the mean stress ⅓ tr σ = K_c tr ε.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastic {
    young: f64,
    poisson: f64,
    bulk: f64,
    shear: f64,
}

impl Elastic {
    /// From Young's modulus E \[MPa\] and Poisson's ratio ν.
    ///
    /// # Errors
    /// `NotPositive` unless E > 0 is finite; `PoissonOutOfRange` unless −1 < ν < ½, and neither nearer than 10⁻⁹.
    pub fn new(young: f64, poisson: f64) -> Result<Self, LawError> {
        let young = positive(Parameter::YoungsModulus, young)?;
        if !(NEAREST - 1.0..=0.5 - NEAREST).contains(&poisson) {
            return Err(LawError::PoissonOutOfRange { poisson });
        }
        Ok(Self {
            young,
            poisson,
            bulk: young / (3.0 * (1.0 - 2.0 * poisson)),
            shear: young / (2.0 * (1.0 + poisson)),
        })
    }

    /// Young's modulus E \[MPa\].
    pub fn young(&self) -> f64 {
        self.young
    }

    /// Poisson's ratio ν.
    pub fn poisson(&self) -> f64 {
        self.poisson
    }

    /// Bulk modulus K_c = E / (3(1 − 2ν)) \[MPa\], \[59\].
    #[inline]
    pub fn bulk_modulus(&self) -> f64 {
        self.bulk
    }

    /// Shear modulus G = E / (2(1 + ν)) \[MPa\], \[59\].
    #[inline]
    pub fn shear_modulus(&self) -> f64 {
        self.shear
    }

    /// The tangent S = K_c δ⊗δ + 2G (1 − ⅓ δ⊗δ) \[MPa\]; symmetric positive definite.
    #[inline]
    pub fn tangent(&self) -> Sym4 {
        isotropic(self.bulk, 2.0 * self.shear)
    }

    /// Energy ½ ε·S·ε = ½ K_c (tr ε)² + G ‖e‖² of a strain \[N·mm/mm³\], \[59\]; convex, quadratic.
    #[inline]
    pub fn energy(&self, strain: &Sym2) -> f64 {
        0.5 * self.bulk * trace(strain).powi(2) + self.shear * deviator(strain).norm_squared()
    }

    /// Strain S⁻¹ σ of a stress \[MPa\].
    #[inline]
    pub fn strain(&self, stress: &Sym2) -> Sym2 {
        trace(stress) / (9.0 * self.bulk) * identity() + deviator(stress) / (2.0 * self.shear)
    }

    /// Complementary energy ½ σ·S⁻¹·σ of a stress \[N·mm/mm³\]; the conjugate of `energy`.
    #[inline]
    pub fn complementary_energy(&self, stress: &Sym2) -> f64 {
        trace(stress).powi(2) / (18.0 * self.bulk)
            + deviator(stress).norm_squared() / (4.0 * self.shear)
    }
}

impl BulkLaw for Elastic {
    /// The elastic strain.
    type State = Sym2;

    fn initial(&self) -> Sym2 {
        Sym2::zeros()
    }

    #[inline]
    fn respond(&self, old: &Sym2, d_eps: &Sym2) -> Response<Sym2> {
        let state = old + d_eps;
        Response {
            stress: self.stress(&state),
            tangent: self.tangent(),
            flows: false,
            state,
        }
    }

    #[inline]
    fn stress(&self, state: &Sym2) -> Sym2 {
        self.bulk * trace(state) * identity() + 2.0 * self.shear * deviator(state)
    }

    fn is_isotropic(&self) -> bool {
        true
    }

    #[inline]
    fn elastic_strain(&self, state: &Sym2) -> Sym2 {
        *state
    }

    fn elastic_tangent(&self) -> Sym4 {
        self.tangent()
    }

    fn stored_energy(&self, state: &Sym2) -> f64 {
        self.energy(state)
    }

    fn dissipation(&self, _old: &Sym2, _new: &Sym2) -> f64 {
        0.0
    }

    fn equivalent_plastic_strain(&self, _state: &Sym2) -> f64 {
        0.0
    }

    /// All of it elastic.
    fn flow_power(&self, state: &Sym2, rate: &Sym2) -> Option<FlowPower> {
        let total = self.stress(state).dot(rate);
        let elastic = total.abs();
        Some(FlowPower {
            total,
            elastic,
            hardening: 0.0,
        })
    }

    /// ΔV = ½ Δε·S·Δε, \[58\].
    #[inline]
    fn potential(&self, _old: &Sym2, d_eps: &Sym2) -> Option<f64> {
        Some(self.energy(d_eps))
    }
}
