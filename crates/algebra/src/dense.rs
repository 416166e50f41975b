//! Products and factors of dense symmetric matrices, those of an interface; not of sparse ones.

use crate::engine::Inertia;
use faer::diag::{DiagMut, DiagRef};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::{lblt, llt::factor};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::triangular_solve;
use faer::perm::PermRef;
use faer::prelude::{Reborrow, ReborrowMut};
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
    ///
    /// # Panics
    /// If it is not square.
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
    ///
    /// # Panics
    /// If it has not as many rows as A.
    pub fn forward(&self, x: &mut DMatrix<f64>) {
        let (rows, columns) = x.shape();
        triangular_solve::solve_lower_triangular_in_place(
            self.view(),
            MatMut::from_column_major_slice_mut(x.as_mut_slice(), rows, columns),
            Par::Seq,
        );
    }

    /// x ← L⁻¹ x.
    ///
    /// # Panics
    /// If it has not as many rows as A.
    pub fn forward_one(&self, x: &mut DVector<f64>) {
        // L is regular: its pivots are positive.
        self.factor.solve_lower_triangular_mut(x);
    }

    /// x ← L⁻ᵀ x.
    ///
    /// # Panics
    /// If it has not as many rows as A.
    pub fn backward_one(&self, x: &mut DVector<f64>) {
        self.factor.tr_solve_lower_triangular_mut(x);
    }
}

/// L B Lᵀ = P A Pᵀ with blocks B of one or two rows, of a matrix of any sign.
pub struct DenseLdlt {
    /// L below the diagonal, on it that of B.
    factor: DMatrix<f64>,
    /// Entries of B beside its diagonal, zero where a block has one row.
    beside: Vec<f64>,
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl DenseLdlt {
    /// Factorises a symmetric matrix, of which the lower triangle is read; `None` if it holds what is not finite.
    ///
    /// # Panics
    /// If it is not square.
    pub fn new(mut a: DMatrix<f64>) -> Option<Self> {
        if !a.iter().all(|x| x.is_finite()) {
            return None;
        }
        let n = a.nrows();
        let mut beside = vec![0.0; n];
        let (mut forward, mut inverse) = (vec![0usize; n], vec![0usize; n]);
        let own = Default::default();
        let request = lblt::factor::cholesky_in_place_scratch::<usize, f64>(n, Par::Seq, own);
        let mut memory = MemBuffer::try_new(request).ok()?;
        // One thread: the same factor to the bit wherever it runs.
        lblt::factor::cholesky_in_place(
            MatMut::from_column_major_slice_mut(a.as_mut_slice(), n, n),
            DiagMut::from_slice_mut(&mut beside),
            &mut forward,
            &mut inverse,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        Some(Self {
            factor: a,
            beside,
            forward,
            inverse,
        })
    }

    /// Signs of the eigenvalues of A, of which those of a block of B that are not larger than `none` are zero.
    pub fn inertia(&self, none: f64) -> Inertia {
        let mut inertia = Inertia::default();
        let mut count = |value: f64| match value {
            v if v > none => inertia.positive += 1,
            v if v < -none => inertia.negative += 1,
            _ => inertia.zero += 1,
        };
        let mut k = 0;
        while k < self.beside.len() {
            let (a, b) = (self.factor[(k, k)], self.beside[k]);
            if b == 0.0 {
                count(a);
                k += 1;
                continue;
            }
            let c = self.factor[(k + 1, k + 1)];
            let (mean, radius) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
            count(mean + radius);
            count(mean - radius);
            k += 2;
        }
        inertia
    }

    /// x ← A⁻¹ x; no numbers where A is singular.
    ///
    /// # Panics
    /// If it has not as many rows as A.
    pub fn solve(&self, x: &mut DVector<f64>) {
        let n = x.len();
        let factor = MatRef::from_column_major_slice(self.factor.as_slice(), n, n);
        let diagonal: Vec<f64> = self.factor.diagonal().iter().copied().collect();
        let request = lblt::solve::solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq);
        let Ok(mut memory) = MemBuffer::try_new(request) else {
            x.fill(f64::NAN);
            return;
        };
        lblt::solve::solve_in_place(
            factor,
            DiagRef::from_slice(&diagonal),
            DiagRef::from_slice(&self.beside),
            PermRef::new_checked(&self.forward, &self.inverse, n),
            MatMut::from_column_major_slice_mut(x.as_mut_slice(), n, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
    }
}

/// Columns of L Lᵀ that are made at once.
const BLOCK: usize = 128;

/// L Lᵀ of a lower triangular L, of which the lower triangle is read.
pub fn square(mut l: DMatrix<f64>) -> DMatrix<f64> {
    let n = l.nrows();
    let whole = MatMut::from_column_major_slice_mut(l.as_mut_slice(), n, n);
    let mut rest = whole;
    let mut own = Vec::<f64>::new();
    // Of a column only those before it are read: from the last on they take each other's place.
    for first in (0..n).step_by(BLOCK).rev() {
        let width = rest.ncols() - first;
        let (before, columns) = rest.split_at_col_mut(first);
        let mut columns = columns.subrows_mut(first, n - first);
        own.clear();
        for column in columns.rb().col_iter() {
            own.extend(column.iter());
        }
        let own = MatRef::from_column_major_slice(&own, n - first, width);
        let (triangle, below) = own.split_at_row(width);
        let (mut top, mut bottom) = columns.rb_mut().split_at_row_mut(width);
        triangular::matmul(
            top.rb_mut(),
            BlockStructure::TriangularLower,
            Accum::Replace,
            triangle,
            BlockStructure::TriangularLower,
            triangle.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        triangular::matmul(
            bottom.rb_mut(),
            BlockStructure::Rectangular,
            Accum::Replace,
            below,
            BlockStructure::Rectangular,
            triangle.transpose(),
            BlockStructure::TriangularUpper,
            1.0,
            Par::Seq,
        );
        let (row, rows) = before.rb().subrows(first, n - first).split_at_row(width);
        triangular::matmul(
            top,
            BlockStructure::TriangularLower,
            Accum::Add,
            row,
            BlockStructure::Rectangular,
            row.transpose(),
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
        matmul(bottom, Accum::Add, rows, row.transpose(), 1.0, Par::Seq);
        rest = before;
    }
    mirror(&mut l);
    l
}

/// A − Cᵀ C of the first rows and columns of a symmetric A, of which the lower triangle is read, as many as C has
/// columns.
///
/// # Panics
/// If A is smaller.
pub fn less_gram(mut a: DMatrix<f64>, c: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, (rows, kept)) = (a.nrows(), c.shape());
    let c = MatRef::from_column_major_slice(c.as_slice(), rows, kept);
    let whole = MatMut::from_column_major_slice_mut(a.as_mut_slice(), n, n);
    triangular::matmul(
        whole.submatrix_mut(0, 0, kept, kept),
        BlockStructure::TriangularLower,
        Accum::Add,
        c.transpose(),
        BlockStructure::Rectangular,
        c,
        BlockStructure::Rectangular,
        -1.0,
        Par::Seq,
    );
    let mut a = a.remove_columns(kept, n - kept).remove_rows(kept, n - kept);
    mirror(&mut a);
    a
}

/// Aᵀ B.
///
/// # Panics
/// If they have not as many rows.
pub fn transposed_product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let view = |m| -> MatRef<'_, f64> {
        let m: &DMatrix<f64> = m;
        MatRef::from_column_major_slice(m.as_slice(), m.nrows(), m.ncols())
    };
    let (rows, columns) = (a.ncols(), b.ncols());
    let mut out = DMatrix::zeros(rows, columns);
    matmul(
        MatMut::from_column_major_slice_mut(out.as_mut_slice(), rows, columns),
        Accum::Replace,
        view(a).transpose(),
        view(b),
        1.0,
        Par::Seq,
    );
    out
}

/// Rows and columns that are copied at once: both are then next to the processor.
const TILE: usize = 32;

/// Makes the upper triangle what the lower one is.
pub fn mirror(a: &mut DMatrix<f64>) {
    let n = a.nrows();
    let a = a.as_mut_slice();
    for first in (0..n).step_by(TILE) {
        for row in (first..n).step_by(TILE) {
            for j in first..n.min(first + TILE) {
                for i in row.max(j + 1)..n.min(row + TILE) {
                    a[i * n + j] = a[j * n + i];
                }
            }
        }
    }
}
