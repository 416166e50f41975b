//! Tᵀ S T of a dense symmetric S and a sparse T.

use crate::dense::mirror;
use crate::panel::add_one;
use nalgebra::DMatrix;
use pulp::{Arch, Simd, WithSimd};

/// Tᵀ S T of a symmetric S, for a T of so many columns that is given by the entries of its rows: columns and
/// coefficients.
///
/// # Panics
/// If S has not as many rows and columns as T has rows, or an entry is in a column that is not there.
pub fn congruence(s: &DMatrix<f64>, t: &[Vec<(usize, f64)>], columns: usize) -> DMatrix<f64> {
    assert_eq!(s.shape(), (t.len(), t.len()));
    let mut entries = vec![Vec::new(); columns];
    for (i, row) in t.iter().enumerate() {
        row.iter().for_each(|&(k, c)| entries[k].push((i, c)));
    }
    let arch = Arch::new();
    let combine = |of: &DMatrix<f64>, first: usize, own: &[(usize, f64)], sum: &mut [f64]| {
        arch.dispatch(Combination {
            columns: of.as_slice(),
            size: of.nrows(),
            first,
            entries: own,
            sum,
        });
    };
    let mut product = DMatrix::zeros(t.len(), columns);
    for (own, mut column) in entries.iter().zip(product.column_iter_mut()) {
        combine(s, 0, own, column.as_mut_slice());
    }
    // Of the columns of Tᵀ S, below the diagonal.
    let product = product.transpose();
    let mut out = DMatrix::zeros(columns, columns);
    for (k, (own, mut column)) in entries.iter().zip(out.column_iter_mut()).enumerate() {
        combine(&product, k, own, &mut column.as_mut_slice()[k..]);
    }
    mirror(&mut out);
    out
}

/// sum ← sum + Σ coefficient · column.
struct Combination<'a> {
    columns: &'a [f64],
    /// Rows of a column.
    size: usize,
    /// The row that the sum begins with.
    first: usize,
    entries: &'a [(usize, f64)],
    sum: &'a mut [f64],
}

impl WithSimd for Combination<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let column = |k: usize| &self.columns[k * self.size + self.first..(k + 1) * self.size];
        let mut fours = self.entries.chunks_exact(4);
        for four in &mut fours {
            let columns = std::array::from_fn(|i| column(four[i].0));
            add_one(columns, std::array::from_fn(|i| four[i].1), self.sum);
        }
        for &(k, c) in fours.remainder() {
            for (sum, value) in self.sum.iter_mut().zip(column(k)) {
                *sum += c * value;
            }
        }
    }
}
