//! Modelling hypotheses: how a displacement of R^D strains a body of R³; not constitutive laws,
//! which see six components always.

use crate::MeshError;
use nalgebra::SMatrix;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Modelling hypothesis: how a displacement of R^D strains a body of R³.
pub trait Hypothesis<const D: usize>: 'static + Copy + Send + Sync {
    /// Block B_a of \[77\], 6×D: the Mandel strain \[–\] by a unit displacement \[mm\] of one node,
    /// with shape value `n` \[–\] and gradient `grad` \[1/mm\], at the point `x` \[mm\].
    ///
    /// Summed over the nodes, ε = Σ_a B_a U_a. Linear in `(n, grad)`.
    fn strain_operator(n: f64, grad: &[f64; D], x: &[f64; D]) -> SMatrix<f64, 6, D>;

    /// Rows of every column of B_a that may be other than zero, for kernels to skip the rest.
    const ROWS: [&'static [usize]; D];

    /// Factor from dx to the volume, and of a facet to its area, at the point `x` \[mm\]:
    /// thickness \[mm\], 2πr \[mm\] or 1.
    fn measure(&self, x: &[f64; D]) -> f64;

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
    const ROWS: [&'static [usize]; 2] = [&[0, 5], &[1, 5]];

    #[inline]
    fn strain_operator(_: f64, grad: &[f64; 2], _: &[f64; 2]) -> SMatrix<f64, 6, 2> {
        in_plane(grad)
    }

    fn measure(&self, _: &[f64; 2]) -> f64 {
        self.thickness
    }

    /// Two translations and the rotation (−y, x).
    fn rigid_modes(&[x, y]: &[f64; 2]) -> Vec<[f64; 2]> {
        vec![[1.0, 0.0], [0.0, 1.0], [-y, x]]
    }
}

/// Axial symmetry without torsion: x = (r, z), the radius first, and the hoop strain
/// ε₃₃ = u_r / r.
///
/// The strain operator needs r > 0, which holds at the quadrature points of a cell in r ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Axisymmetric;

impl Hypothesis<2> for Axisymmetric {
    const ROWS: [&'static [usize]; 2] = [&[0, 2, 5], &[1, 5]];

    #[inline]
    fn strain_operator(n: f64, grad: &[f64; 2], &[r, _]: &[f64; 2]) -> SMatrix<f64, 6, 2> {
        let mut b = in_plane(grad);
        b[(2, 0)] = n / r;
        b
    }

    fn measure(&self, &[r, _]: &[f64; 2]) -> f64 {
        TAU * r
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
    const ROWS: [&'static [usize]; 3] = [&[0, 4, 5], &[1, 3, 5], &[2, 3, 4]];

    #[inline]
    fn strain_operator(_: f64, &[x, y, z]: &[f64; 3], _: &[f64; 3]) -> SMatrix<f64, 6, 3> {
        let [p, q, r] = [x, y, z].map(|g| FRAC_1_SQRT_2 * g);
        SMatrix::from_row_slice(&[
            x, 0.0, 0.0, //
            0.0, y, 0.0, //
            0.0, 0.0, z, //
            0.0, r, q, //
            r, 0.0, p, //
            q, p, 0.0,
        ])
    }

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

/// The rows 11, 22 and √2·12 that plane strain and axial symmetry share.
#[inline]
fn in_plane(&[x, y]: &[f64; 2]) -> SMatrix<f64, 6, 2> {
    let mut b = SMatrix::zeros();
    b[(0, 0)] = x;
    b[(1, 1)] = y;
    b[(5, 0)] = FRAC_1_SQRT_2 * y;
    b[(5, 1)] = FRAC_1_SQRT_2 * x;
    b
}
