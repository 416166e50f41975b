//! Symmetric tensors of R³ in Mandel notation; not a general tensor algebra.
//!
//! A symmetric second-order tensor a is the 6-vector `[a11, a22, a33, √2·a23, √2·a13, √2·a12]`,
//! so that the double contraction a : b is the dot product of the vectors, and a fourth-order
//! tensor with both minor symmetries is a 6×6 matrix acting by the ordinary product.
//!
//! ```
//! use moreau_mandel::{from_matrix, von_mises};
//! use nalgebra::Matrix3;
//!
//! // Simple shear of 100 MPa has the von Mises stress √3·100 MPa, eq. [5].
//! let shear = Matrix3::new(0.0, 100.0, 0.0, 100.0, 0.0, 0.0, 0.0, 0.0, 0.0);
//! assert!((von_mises(&from_matrix(&shear)) - 3f64.sqrt() * 100.0).abs() < 1e-12);
//! ```

mod spectral;

pub use spectral::{Spectrum, logarithmic_slope};

use nalgebra::{Matrix3, SMatrix, SVector};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Symmetric second-order tensor: `[11, 22, 33, √2·23, √2·13, √2·12]`, so that a : b = a·b.
pub type Sym2 = SVector<f64, 6>;

/// Fourth-order tensor with minor symmetries, acting on [`Sym2`] by the matrix product.
pub type Sym4 = SMatrix<f64, 6, 6>;

/// Fourth-order tensor without symmetries, as of a stress by a gradient: entry (3i + j, 3k + m) is
/// ∂(·)ᵢⱼ/∂(·)ₖₘ.
pub type GradientTangent = SMatrix<f64, 9, 9>;

/// Row and column of the Mandel components 0..6.
const INDEX: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

/// The unit tensor δ.
#[inline]
pub fn identity() -> Sym2 {
    Sym2::from([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
}

/// tr a = a : δ.
#[inline]
pub fn trace(a: &Sym2) -> f64 {
    a[0] + a[1] + a[2]
}

/// Deviator a − ⅓ tr(a) δ.
#[inline]
pub fn deviator(a: &Sym2) -> Sym2 {
    let mean = trace(a) / 3.0;
    let mut s = *a;
    for i in 0..3 {
        s[i] -= mean;
    }
    s
}

/// Von Mises equivalent stress √(3/2 s : s) of a stress \[MPa\], eq. \[5\].
pub fn von_mises(stress: &Sym2) -> f64 {
    1.5f64.sqrt() * deviator(stress).norm()
}

/// Equivalent strain √(2/3 e : e) of a deviatoric strain, eq. \[60\].
pub fn equivalent_strain(e: &Sym2) -> f64 {
    (2.0f64 / 3.0).sqrt() * e.norm()
}

/// The isotropic tensor k δ ⊗ δ + s (1 − ⅓ δ ⊗ δ): of elasticity with the bulk modulus k and twice the shear
/// modulus s.
#[inline]
pub fn isotropic(k: f64, s: f64) -> Sym4 {
    let mut c = Sym4::zeros();
    for i in 0..3 {
        for j in 0..3 {
            c[(i, j)] = k - s / 3.0;
        }
    }
    for i in 0..6 {
        c[(i, i)] += s;
    }
    c
}

/// c ← c + s (a ⊗ b + b ⊗ a), which stays symmetric to the bit.
#[inline]
pub fn add_symmetric_product(c: &mut Sym4, s: f64, a: &Sym2, b: &Sym2) {
    for j in 0..6 {
        for i in 0..6 {
            c[(i, j)] += s * (a[i] * b[j] + b[i] * a[j]);
        }
    }
}

/// The projector on spherical tensors, ⅓ δ ⊗ δ.
#[inline]
pub fn spherical_projector() -> Sym4 {
    isotropic(1.0 / 3.0, 0.0)
}

/// The projector on deviators, 1 − ⅓ δ ⊗ δ.
#[inline]
pub fn deviatoric_projector() -> Sym4 {
    isotropic(0.0, 1.0)
}

/// Mandel vector of the symmetric part of a 3×3 matrix.
pub fn from_matrix(a: &Matrix3<f64>) -> Sym2 {
    Sym2::from_fn(|k, _| {
        let (i, j) = INDEX[k];
        if i == j {
            a[(i, i)]
        } else {
            (a[(i, j)] + a[(j, i)]) / SQRT_2
        }
    })
}

/// The 3×3 matrix of a Mandel vector.
pub fn to_matrix(a: &Sym2) -> Matrix3<f64> {
    let mut m = Matrix3::zeros();
    for (k, &(i, j)) in INDEX.iter().enumerate() {
        let value = if i == j { a[k] } else { a[k] / SQRT_2 };
        m[(i, j)] = value;
        m[(j, i)] = value;
    }
    m
}

/// a b in loops whose lengths the compiler knows: the product of the matrix library is several times slower where it is not
/// inlined, and as exact.
#[inline(always)]
pub fn product<const N: usize, const M: usize, const K: usize>(
    a: &SMatrix<f64, N, M>,
    b: &SMatrix<f64, M, K>,
) -> SMatrix<f64, N, K> {
    let mut out = SMatrix::<f64, N, K>::zeros();
    for j in 0..K {
        for k in 0..M {
            let factor = b[(k, j)];
            for i in 0..N {
                out[(i, j)] += a[(i, k)] * factor;
            }
        }
    }
    out
}

/// Q a Qᵀ.
#[inline(always)]
pub fn turned<const N: usize>(
    q: &SMatrix<f64, N, N>,
    a: &SMatrix<f64, N, N>,
) -> SMatrix<f64, N, N> {
    let mut out = SMatrix::<f64, N, N>::zeros();
    let left = product(q, a);
    for j in 0..N {
        for k in 0..N {
            let factor = q[(j, k)];
            for i in 0..N {
                out[(i, j)] += left[(i, k)] * factor;
            }
        }
    }
    out
}

/// The 6×6 matrix of a ↦ Q a Qᵀ for an orthogonal Q; itself orthogonal.
pub fn rotation(q: &Matrix3<f64>) -> Sym4 {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
    Sym4::from_fn(|a, b| {
        let ((i, j), (k, m)) = (PAIRS[a], PAIRS[b]);
        match (a < 3, b < 3) {
            (true, true) => q[(i, k)] * q[(i, k)],
            (false, false) => q[(i, k)] * q[(j, m)] + q[(i, m)] * q[(j, k)],
            _ => SQRT_2 * q[(i, k)] * q[(j, m)],
        }
    })
}

/// A tensor with minor symmetries as one that works on gradients: cᵢⱼₖₘ at (3 i + j, 3 k + m).
pub fn of_gradients(c: &Sym4) -> GradientTangent {
    const MANDEL: [usize; 9] = [0, 5, 4, 5, 1, 3, 4, 3, 2];
    let factor = |row: usize| if row < 3 { 1.0 } else { FRAC_1_SQRT_2 };
    GradientTangent::from_fn(|r, s| {
        let (r, s) = (MANDEL[r], MANDEL[s]);
        factor(r) * factor(s) * c[(r, s)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::{Rotation3, Vector3};
    use proptest::prelude::*;

    fn tensor() -> impl Strategy<Value = Sym2> {
        prop::array::uniform6(-1e3..1e3f64).prop_map(Sym2::from)
    }

    fn rotation_matrix() -> impl Strategy<Value = Matrix3<f64>> {
        prop::array::uniform3(-3.0..3.0f64)
            .prop_map(|a| Rotation3::new(Vector3::from(a)).into_inner())
    }

    proptest! {
        #[test]
        fn contraction_is_the_dot_product(a in tensor(), b in tensor()) {
            let full = (to_matrix(&a).transpose() * to_matrix(&b)).trace();
            prop_assert!((full - a.dot(&b)).abs() <= 1e-9 * (1.0 + a.norm() * b.norm()));
        }

        #[test]
        fn matrix_round_trip(a in tensor()) {
            prop_assert!((from_matrix(&to_matrix(&a)) - a).norm() <= 1e-12 * a.norm());
        }

        #[test]
        fn rotation_rotates_and_keeps_invariants(a in tensor(), q in rotation_matrix()) {
            let r = rotation(&q);
            let rotated = r * a;
            let expected = from_matrix(&(q * to_matrix(&a) * q.transpose()));
            prop_assert!((rotated - expected).norm() <= 1e-12 * (1.0 + a.norm()));
            prop_assert!((r.transpose() * r - Sym4::identity()).norm() <= 1e-12);
            prop_assert!((von_mises(&rotated) - von_mises(&a)).abs() <= 1e-11 * (1.0 + a.norm()));
            prop_assert!((trace(&rotated) - trace(&a)).abs() <= 1e-11 * (1.0 + a.norm()));
        }

        #[test]
        fn products_are_those_of_the_matrix_library(a in tensor(), b in tensor(), q in rotation_matrix()) {
            let (m, n) = (to_matrix(&a) * q, to_matrix(&b));
            prop_assert_eq!(product(&m, &n), m * n);
            prop_assert_eq!(turned(&m, &n), m * n * m.transpose());
            let (r, c) = (rotation(&q), a * b.transpose());
            prop_assert_eq!(turned(&r, &c), r * c * r.transpose());
        }

        #[test]
        fn projectors_split_a_tensor(a in tensor()) {
            let s = deviatoric_projector() * a;
            prop_assert!((s - deviator(&a)).norm() <= 1e-12 * (1.0 + a.norm()));
            prop_assert!(trace(&s).abs() <= 1e-12 * (1.0 + a.norm()));
            prop_assert!((s + spherical_projector() * a - a).norm() <= 1e-12 * (1.0 + a.norm()));
        }
    }

    #[test]
    fn uniaxial_stress_is_its_own_von_mises_stress() {
        let stress = Sym2::from([-250.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_relative_eq!(von_mises(&stress), 250.0, max_relative = 1e-15);
        assert_eq!(von_mises(&(identity() * 77.0)), 0.0);
    }

    #[test]
    fn equivalent_strain_of_incompressible_tension_is_the_axial_strain() {
        let e = Sym2::from([0.01, -0.005, -0.005, 0.0, 0.0, 0.0]);
        assert_relative_eq!(equivalent_strain(&e), 0.01, max_relative = 1e-14);
    }
}
