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
