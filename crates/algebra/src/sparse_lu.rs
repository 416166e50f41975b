//! Factorisation of sparse unsymmetric matrices; with `dense` the only file of this crate that names
//! the library that does it.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use nalgebra::DVector;

use crate::lu::SINGULAR;

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
    /// Largest entry of A.
    largest: f64,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    size: usize,
}

impl SparseLu {
    /// Factorises a square matrix, of no rows where none starts; `None` if it is singular.
    ///
    /// # Panics
    /// If the rows are none of a square matrix.
    pub fn new(a: &Rows) -> Option<Self> {
        let starts = match a.starts.as_slice() {
            [] => &[0],
            starts => starts,
        };
        let size = starts.len() - 1;
        // Rows of A are columns of its transpose: that is what is factorised.
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, starts, None, &a.columns);
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
            largest: a.values.iter().fold(0.0, |most, v| v.abs().max(most)),
            symbolic,
            numeric,
            size,
        })
    }

    /// x of A x = b; `None` where A is singular to rounding, as far as b tells: the pivots are not, but x is as much larger
    /// than b as they would be small.
    ///
    /// # Panics
    /// If b has not as many rows as A.
    pub fn solve(&self, mut b: DVector<f64>) -> Option<DVector<f64>> {
        let request = self
            .symbolic
            .solve_transpose_in_place_scratch::<f64>(1, Par::Seq);
        let mut memory = MemBuffer::try_new(request).ok()?;
        let most = b.amax() / SINGULAR;
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_transpose_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(b.as_mut_slice(), self.size, 1),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        let is_solved = b.iter().all(|v| v.is_finite()) && self.largest * b.amax() <= most;
        is_solved.then_some(b)
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

    /// As a dense factorisation: a pivot that rounding has left is none.
    #[test]
    fn what_is_singular_to_rounding_is_not_solved() {
        let dense = |entries: [f64; 9]| Rows {
            starts: vec![0, 3, 6, 9],
            columns: [0, 1, 2].repeat(3),
            values: entries.to_vec(),
        };
        let solved = |entries: [f64; 9], b: [f64; 3]| {
            SparseLu::new(&dense(entries)).and_then(|lu| lu.solve(DVector::from_row_slice(&b)))
        };
        let mut entries = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];
        let nan = entries.map(|_| f64::NAN);
        assert_eq!(solved(entries, [1.0, 0.0, 0.0]), None);
        assert_eq!(solved(nan, [1.0, 0.0, 0.0]), None);
        // Beside it one that is regular, of any size.
        entries[8] = 1.0;
        for size in [1e-200, 1.0, 1e200] {
            let x = solved(entries.map(|v| v * size), [1.0, 0.0, 0.0]).expect("regular");
            let back = entries[0] * x[0] + entries[1] * x[1] + entries[2] * x[2];
            assert!((size * back - 1.0).abs() < 1e-12);
        }
        assert_eq!(solved(entries, [0.0; 3]), Some(DVector::zeros(3)));
    }

    #[test]
    fn nothing_is_solved_too() {
        let lu = SparseLu::new(&Rows::default()).expect("nothing to refuse");
        assert_eq!(lu.solve(DVector::zeros(0)), Some(DVector::zeros(0)));
    }
}
