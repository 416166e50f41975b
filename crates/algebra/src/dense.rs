//! Products and Cholesky factors of dense matrices, those of an interface; not of sparse ones.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::{DMatrix, DVector};

/// L Lᵀ = A.
pub struct DenseCholesky {
    /// L, and above it what A had there.
    factor: DMatrix<f64>,
}

impl DenseCholesky {
    /// Factorises a symmetric matrix, of which the lower triangle is read; `None` if it is not
    /// positive definite.
    pub fn new(mut a: DMatrix<f64>) -> Option<Self> {
        let n = a.nrows();
        let request = factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(request).ok()?;
        // One thread: the same factor to the bit wherever it runs.
        factor::cholesky_in_place(
            MatMut::from_column_major_slice_mut(a.as_mut_slice(), n, n),
            Default::default(),
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .ok()?;
        Some(Self { factor: a })
    }

    /// Whether all pivots are stiffnesses beside the largest diagonal of A: one at rounding level is a
    /// rigid motion.
    pub fn holds(&self, stiffest: f64) -> bool {
        let pivots = self.factor.diagonal();
        pivots.iter().all(|pivot| pivot.powi(2) > 1e-13 * stiffest)
    }

    fn view(&self) -> MatRef<'_, f64> {
        let n = self.factor.nrows();
        MatRef::from_column_major_slice(self.factor.as_slice(), n, n)
    }

    /// X ← L⁻¹ X.
    pub fn forward(&self, x: &mut DMatrix<f64>) {
        let (rows, columns) = x.shape();
        triangular_solve::solve_lower_triangular_in_place(
            self.view(),
            MatMut::from_column_major_slice_mut(x.as_mut_slice(), rows, columns),
            Par::Seq,
        );
    }

    /// x ← L⁻¹ x.
    pub fn forward_one(&self, x: &mut DVector<f64>) {
        // L is regular: its pivots are positive.
        self.factor.solve_lower_triangular_mut(x);
    }

    /// x ← L⁻ᵀ x.
    pub fn backward_one(&self, x: &mut DVector<f64>) {
        self.factor.tr_solve_lower_triangular_mut(x);
    }
}

/// L Lᵀ of a lower triangular L.
pub fn square(l: &DMatrix<f64>) -> DMatrix<f64> {
    let n = l.nrows();
    let mut out = DMatrix::zeros(n, n);
    let view = MatRef::from_column_major_slice(l.as_slice(), n, n);
    triangular::matmul(
        MatMut::from_column_major_slice_mut(out.as_mut_slice(), n, n),
        BlockStructure::TriangularLower,
        Accum::Replace,
        view,
        BlockStructure::TriangularLower,
        view.transpose(),
        BlockStructure::TriangularUpper,
        1.0,
        Par::Seq,
    );
    out.fill_upper_triangle_with_lower_triangle();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve_and_are_refused_where_there_is_none() {
        let l = DMatrix::from_fn(70, 70, |i, j| match i.cmp(&j) {
            std::cmp::Ordering::Less => 0.0,
            std::cmp::Ordering::Equal => 2.0 + (i as f64).sin(),
            std::cmp::Ordering::Greater => 0.1 * ((3 * i + j) as f64).cos(),
        });
        let a = square(&l);
        assert!((&a - &l * l.transpose()).norm() < 1e-12 * a.norm());
        let cholesky = DenseCholesky::new(a.clone()).expect("definite");
        let least = l.diagonal().amin().powi(2);
        assert!(cholesky.holds(0.9e13 * least) && !cholesky.holds(1.1e13 * least));
        let x = DMatrix::from_fn(70, 3, |i, j| ((i + 5 * j) as f64).sin());
        let mut forward = &l * &x;
        cholesky.forward(&mut forward);
        assert!((forward - &x).norm() < 1e-11);
        let mut one = &a * x.column(0);
        cholesky.forward_one(&mut one);
        cholesky.backward_one(&mut one);
        assert!((one - x.column(0)).norm() < 1e-10);
        let none = DenseCholesky::new(DMatrix::zeros(0, 0)).expect("nothing to refuse");
        assert!(none.holds(0.0));
        let mut indefinite = a;
        indefinite[(40, 40)] = -1.0;
        assert!(DenseCholesky::new(indefinite).is_none());
        assert!(DenseCholesky::new(DMatrix::from_element(2, 2, f64::NAN)).is_none());
    }
}
