//! Modelling hypotheses: how a displacement of R^D strains a body of R³; not constitutive laws,
//! which see six components always.

use crate::MeshError;
use nalgebra::SMatrix;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// An entry of what a displacement of a node does to a point: a field times a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Component of the strain, in Mandel's order; or of the gradient, 3i + j of ∂uᵢ/∂xⱼ.
    pub row: usize,
    /// Which of [`Hypothesis::fields`].
    pub field: usize,
    /// Its factor: 1, or 1/√2 in a shear.
    pub factor: f64,
}

const fn plain(row: usize, field: usize) -> Entry {
    let factor = 1.0;
    Entry { row, field, factor }
}

const fn shear(row: usize, field: usize) -> Entry {
    let factor = FRAC_1_SQRT_2;
    Entry { row, field, factor }
}

/// Modelling hypothesis: how a displacement of R^D strains a body of R³.
pub trait Hypothesis<const D: usize>: 'static + Copy + Send + Sync {
    /// Whether the thickness strains as σ₃₃ = 0 asks, which the material finds and not the displacement.
    const IS_PLANE_STRESS: bool = false;

    /// Number of fields of a node that strains are made of.
    const FIELDS: usize;

    /// The fields of a node \[1/mm\], of which the first [`Hypothesis::FIELDS`] count, from its
    /// shape value `n` \[–\] and gradient `grad` \[1/mm\] at the point `x` \[mm\]: the gradient, and
    /// what else strains.
    fn fields(n: f64, grad: &[f64; D], x: &[f64; D]) -> [f64; 3];

    /// The entries of B_a that are not zero, column by column; no field twice in a column.
    const OPERATOR: [&'static [Entry]; D];

    /// The entries of the displacement gradient ∂uᵢ/∂xⱼ in R³ that are not zero, by the components of the
    /// displacement.
    const GRADIENT: [&'static [Entry]; D];

    /// Block B_a of \[77\], 6×D: the Mandel strain \[–\] by a unit displacement \[mm\] of one node,
    /// with shape value `n` \[–\] and gradient `grad` \[1/mm\], at the point `x` \[mm\].
    ///
    /// Summed over the nodes, ε = Σ_a B_a U_a.
    fn strain_operator(n: f64, grad: &[f64; D], x: &[f64; D]) -> SMatrix<f64, 6, D> {
        let fields = Self::fields(n, grad, x);
        let mut b = SMatrix::zeros();
        for j in 0..D {
            for entry in Self::OPERATOR[j] {
                b[(entry.row, j)] = entry.factor * fields[entry.field];
            }
        }
        b
    }

    /// Factor from dx to the volume, and of a facet to its area, at the point `x` \[mm\]:
    /// thickness \[mm\], 2πr \[mm\] or 1.
    fn measure(&self, x: &[f64; D]) -> f64;

    /// The gradient of that factor, which is linear in x.
    fn measure_gradient(&self) -> [f64; D] {
        [0.0; D]
    }

    /// A basis of the rigid motions that the hypothesis allows, as displacements at `x` \[mm\];
    /// their strain is zero, and those of the rotations are not of unit length.
    fn rigid_modes(x: &[f64; D]) -> Vec<[f64; D]>;
}

/// Plane strain in the plane (1, 2): ε₃₃ = ε₁₃ = ε₂₃ = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneStrain {
    thickness: f64,
}

impl PlaneStrain {
    /// A slice of the given thickness \[mm\].
    ///
    /// # Errors
    ///
    /// [`MeshError::Thickness`] unless it is positive and finite.
    pub fn new(thickness: f64) -> Result<Self, MeshError> {
        if thickness > 0.0 && thickness.is_finite() {
            Ok(Self { thickness })
        } else {
            Err(MeshError::Thickness { value: thickness })
        }
    }

    /// The thickness \[mm\].
    pub fn thickness(&self) -> f64 {
        self.thickness
    }
}

impl Default for PlaneStrain {
    /// A slice 1 mm thick.
    fn default() -> Self {
        Self { thickness: 1.0 }
    }
}

impl Hypothesis<2> for PlaneStrain {
    const FIELDS: usize = 2;

    fn fields(_: f64, &[x, y]: &[f64; 2], _: &[f64; 2]) -> [f64; 3] {
        [x, y, 0.0]
    }

    const OPERATOR: [&'static [Entry]; 2] =
        [&[plain(0, 0), shear(5, 1)], &[plain(1, 1), shear(5, 0)]];

    const GRADIENT: [&'static [Entry]; 2] =
        [&[plain(0, 0), plain(1, 1)], &[plain(3, 0), plain(4, 1)]];

    fn measure(&self, _: &[f64; 2]) -> f64 {
        self.thickness
    }

    /// Two translations and the rotation (−y, x).
    fn rigid_modes(&[x, y]: &[f64; 2]) -> Vec<[f64; 2]> {
        vec![[1.0, 0.0], [0.0, 1.0], [-y, x]]
    }
}

/// Plane stress in the plane (1, 2): σ₃₃ = σ₁₃ = σ₂₃ = 0. Displacements strain it as in plane strain, and the
/// material its thickness.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneStress(PlaneStrain);

impl PlaneStress {
    /// A plate of the given thickness \[mm\].
    ///
    /// # Errors
    ///
    /// [`MeshError::Thickness`] unless it is positive and finite.
    pub fn new(thickness: f64) -> Result<Self, MeshError> {
        PlaneStrain::new(thickness).map(Self)
    }

    /// The thickness \[mm\].
    pub fn thickness(&self) -> f64 {
        self.0.thickness()
    }
}

impl Hypothesis<2> for PlaneStress {
    const IS_PLANE_STRESS: bool = true;

    const FIELDS: usize = PlaneStrain::FIELDS;

    fn fields(n: f64, grad: &[f64; 2], x: &[f64; 2]) -> [f64; 3] {
        PlaneStrain::fields(n, grad, x)
    }

    const OPERATOR: [&'static [Entry]; 2] = PlaneStrain::OPERATOR;

    const GRADIENT: [&'static [Entry]; 2] = PlaneStrain::GRADIENT;

    fn measure(&self, x: &[f64; 2]) -> f64 {
        self.0.measure(x)
    }

    fn rigid_modes(x: &[f64; 2]) -> Vec<[f64; 2]> {
        PlaneStrain::rigid_modes(x)
    }
}

/// Axial symmetry without torsion: x = (r, z), the radius first, and the hoop strain
/// ε₃₃ = u_r / r.
///
/// The strain operator needs r > 0, which holds at the quadrature points of a cell in r ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Axisymmetric;

impl Hypothesis<2> for Axisymmetric {
    const FIELDS: usize = 3;

    fn fields(n: f64, &[x, y]: &[f64; 2], &[r, _]: &[f64; 2]) -> [f64; 3] {
        [x, y, n / r]
    }

    const OPERATOR: [&'static [Entry]; 2] = [
        &[plain(0, 0), shear(5, 1), plain(2, 2)],
        &[plain(1, 1), shear(5, 0)],
    ];

    const GRADIENT: [&'static [Entry]; 2] = [
        &[plain(0, 0), plain(1, 1), plain(8, 2)],
        &[plain(3, 0), plain(4, 1)],
    ];

    fn measure(&self, &[r, _]: &[f64; 2]) -> f64 {
        TAU * r
    }

    fn measure_gradient(&self) -> [f64; 2] {
        [TAU, 0.0]
    }

    /// The axial translation.
    fn rigid_modes(_: &[f64; 2]) -> Vec<[f64; 2]> {
        vec![[0.0, 1.0]]
    }
}

/// The body as it is, in R³.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Solid;

impl Hypothesis<3> for Solid {
    const FIELDS: usize = 3;

    fn fields(_: f64, grad: &[f64; 3], _: &[f64; 3]) -> [f64; 3] {
        *grad
    }

    const OPERATOR: [&'static [Entry]; 3] = [
        &[plain(0, 0), shear(5, 1), shear(4, 2)],
        &[plain(1, 1), shear(5, 0), shear(3, 2)],
        &[plain(2, 2), shear(4, 0), shear(3, 1)],
    ];

    const GRADIENT: [&'static [Entry]; 3] = [
        &[plain(0, 0), plain(1, 1), plain(2, 2)],
        &[plain(3, 0), plain(4, 1), plain(5, 2)],
        &[plain(6, 0), plain(7, 1), plain(8, 2)],
    ];

    fn measure(&self, _: &[f64; 3]) -> f64 {
        1.0
    }

    /// Three translations and the rotations e_k × x.
    fn rigid_modes(&[x, y, z]: &[f64; 3]) -> Vec<[f64; 3]> {
        vec![
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, -z, y],
            [z, 0.0, -x],
            [-y, x, 0.0],
        ]
    }
}
