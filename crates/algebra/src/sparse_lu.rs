//! Factorisation of sparse unsymmetric matrices; with `dense` the only file of this crate that names
//! the library that does it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use nalgebra::DVector;

/// Entries of a square matrix, compressed by rows; the columns of a row in increasing order.
#[derive(Debug, Default, Clone)]
pub struct Rows {
    /// Where the rows start, and where the last one ends.
    pub starts: Vec<usize>,
    /// Columns of the entries.
    pub columns: Vec<usize>,
    /// The entries.
    pub values: Vec<f64>,
}

/// L U = P A Q with partial pivoting and a fill-reducing order of the columns.
pub struct SparseLu {
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    size: usize,
}

impl SparseLu {
    /// Factorises a square matrix; `None` if it is singular.
    pub fn new(a: &Rows) -> Option<Self> {
        let size = a.starts.len() - 1;
        // Rows of A are columns of its transpose: that is what is factorised.
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &a.starts, None, &a.columns);
        let symbolic = factorize_symbolic_lu(pattern, Default::default()).ok()?;
        let request = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(request).ok()?;
        let mut numeric = NumericLu::new();
        symbolic
            .factorize_numeric_lu(
                &mut numeric,
                SparseColMatRef::new(pattern, &a.values),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .ok()?;
        Some(Self {
            symbolic,
            numeric,
            size,
        })
    }

    /// x of A x = b; `None` where A was singular to rounding.
    pub fn solve(&self, mut b: DVector<f64>) -> Option<DVector<f64>> {
        let request = self
            .symbolic
            .solve_transpose_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::try_new(request).ok()?;
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_transpose_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b.as_mut_slice(), self.size, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        b.iter().all(|v| v.is_finite()).then_some(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unsymmetric_matrix_is_solved() {
        // Tridiagonal, unlike above and below the diagonal.
        let n = 50;
        let mut a = Rows {
            starts: vec![0],
            ..Rows::default()
        };
        let x = DVector::from_fn(n, |i, _| (i as f64).sin());
        let mut b = DVector::zeros(n);
        for i in 0..n {
            for (j, v) in [(i.wrapping_sub(1), -2.0), (i, 3.0), (i + 1, 0.5)] {
                if j < n {
                    a.columns.push(j);
                    a.values.push(v);
                    b[i] += v * x[j];
                }
            }
            a.starts.push(a.columns.len());
        }
        let solved = SparseLu::new(&a)
            .and_then(|lu| lu.solve(b))
            .expect("regular");
        assert!((solved - x).norm() < 1e-12);
    }
}
