//! Orthotropic linear elasticity, of a material with three axes across each other; not the directions of a cell, which
//! are given to it.

pub(crate) mod hill;

use crate::bulk::{BulkLaw, FlowPower, Response};
use crate::elastic::Elastic;
use crate::error::{LawError, positive};
use moreau_mandel::{Sym2, Sym4, rotation};
use nalgebra::Matrix3;

/// Orthotropic linear elasticity, σ = C ε: along its axes ε₁ = σ₁/E₁ − ν₁₂ σ₂/E₁ − ν₁₃ σ₃/E₁ and so on with
/// νᵢⱼ/Eᵢ = νⱼᵢ/Eⱼ, γᵢⱼ = τᵢⱼ/Gᵢⱼ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orthotropic {
    tangent: Sym4,
}

impl Orthotropic {
    /// From Young's moduli (E₁, E₂, E₃) \[MPa\], Poisson's ratios (ν₁₂, ν₁₃, ν₂₃), of which νᵢⱼ is the contraction
    /// along j under tension along i, and shear moduli (G₁₂, G₁₃, G₂₃) \[MPa\]; the axes are those of space.
    ///
    /// # Errors
    /// `NotPositive` unless every modulus is positive and finite; `NotDefinite` where some strain would have no energy.
    pub fn new(young: [f64; 3], poisson: [f64; 3], shear: [f64; 3]) -> Result<Self, LawError> {
        for e in young {
            positive("Young's modulus along an axis", e)?;
        }
        for g in shear {
            positive("shear modulus between two axes", g)?;
        }
        let mut compliance = Sym4::zeros();
        for i in 0..3 {
            compliance[(i, i)] = 1.0 / young[i];
        }
        for ((i, j), nu) in [(0, 1), (0, 2), (1, 2)].into_iter().zip(poisson) {
            let across = -nu / young[i];
            (compliance[(i, j)], compliance[(j, i)]) = (across, across);
        }
        // In Mandel's notation 2 G, of the shears 23, 13 and 12.
        for (k, g) in [(5, shear[0]), (4, shear[1]), (3, shear[2])] {
            compliance[(k, k)] = 0.5 / g;
        }
        // Of numbers without units: the definiteness of a matrix does not depend on its scale.
        let scaled = compliance
            .map_with_location(|i, j, c| c / (compliance[(i, i)] * compliance[(j, j)]).sqrt());
        let least = scaled.symmetric_eigenvalues().min();
        let inverse = compliance.try_inverse().filter(|_| least > 1e-12);
        let Some(tangent) = inverse else {
            let of = "orthotropic elasticity";
            return Err(LawError::NotDefinite { of });
        };
        let tangent = 0.5 * (tangent + tangent.transpose());
        Ok(Self { tangent })
    }

    /// The same with its axes in the columns of a rotation.
    #[must_use]
    pub fn along(self, axes: &Matrix3<f64>) -> Self {
        let tangent = turned(&self.tangent, axes);
        Self { tangent }
    }

    /// The tangent C \[MPa\]; symmetric positive definite.
    pub fn tangent(&self) -> Sym4 {
        self.tangent
    }
}

impl From<Elastic> for Orthotropic {
    fn from(elastic: Elastic) -> Self {
        let tangent = elastic.tangent();
        Self { tangent }
    }
}

/// A map of tensors along axes, in space.
pub(crate) fn turned(map: &Sym4, axes: &Matrix3<f64>) -> Sym4 {
    let q = rotation(axes);
    let turned = q * map * q.transpose();
    0.5 * (turned + turned.transpose())
}

impl BulkLaw for Orthotropic {
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
            tangent: self.tangent,
            flows: false,
            state,
        }
    }

    #[inline]
    fn stress(&self, state: &Sym2) -> Sym2 {
        self.tangent * state
    }

    #[inline]
    fn elastic_strain(&self, state: &Sym2) -> Sym2 {
        *state
    }

    fn elastic_tangent(&self) -> Sym4 {
        self.tangent
    }

    fn stored_energy(&self, state: &Sym2) -> f64 {
        0.5 * state.dot(&(self.tangent * state))
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

    /// ½ Δε·C·Δε.
    fn potential(&self, _old: &Sym2, d_eps: &Sym2) -> Option<f64> {
        Some(self.stored_energy(d_eps))
    }
}
