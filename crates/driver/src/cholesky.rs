//! Sparse Cholesky factorisation with kept symbolic work and buffers; the only file that names
//! the sparse library.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::cholesky::{simplicial, supernodal};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par};
use nalgebra::DMatrix;
use std::fmt;

/// Lower triangle of a symmetric sparse matrix by columns: pattern without values. The diagonal
/// is the first entry of every column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pattern {
    pub(crate) column_start: Vec<u32>,
    pub(crate) row: Vec<u32>,
}

impl Pattern {
    pub(crate) fn size(&self) -> usize {
        self.column_start.len() - 1
    }

    /// Position of entry (row, column), row ≥ column, among the values.
    pub(crate) fn slot(&self, row: u32, column: u32) -> Option<u32> {
        let (start, end) = (self.range(column).start, self.range(column).end);
        self.row[start..end]
            .binary_search(&row)
            .ok()
            .map(|k| (start + k) as u32)
    }

    pub(crate) fn range(&self, column: u32) -> std::ops::Range<usize> {
        let j = column as usize;
        self.column_start[j] as usize..self.column_start[j + 1] as usize
    }

    fn transposed(&self) -> Self {
        let n = self.size();
        let mut column_start = vec![0u32; n + 1];
        for &i in &self.row {
            column_start[i as usize + 1] += 1;
        }
        for j in 0..n {
            column_start[j + 1] += column_start[j];
        }
        let mut next = column_start.clone();
        let mut row = vec![0u32; self.row.len()];
        for j in 0..n as u32 {
            for k in self.range(j) {
                let slot = &mut next[self.row[k] as usize];
                row[*slot as usize] = j;
                *slot += 1;
            }
        }
        Self { column_start, row }
    }

    fn symbolic(&self) -> SymbolicSparseColMatRef<'_, u32> {
        let n = self.size();
        SymbolicSparseColMatRef::new_checked(n, n, &self.column_start, None, &self.row)
    }
}

/// A pivot that is not positive: the matrix is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NotPositiveDefinite {
    /// Row of the pivot in the order of the matrix.
    pub(crate) row: usize,
}

/// L Lᵀ = A, in the order in which A is given.
pub(crate) struct Cholesky {
    pattern: Pattern,
    symbolic: supernodal::SymbolicSupernodalCholesky<u32>,
    factor: Vec<f64>,
    factor_memory: MemBuffer,
    solve_memory: MemBuffer,
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
            .field("size", &self.pattern.size())
            .field("entries", &self.factor.len())
            .finish_non_exhaustive()
    }
}

impl Cholesky {
    /// Symbolic factorisation, once for a pattern. `None` if memory or the 32-bit index of the
    /// factor does not suffice.
    pub(crate) fn analyse(pattern: Pattern) -> Option<Self> {
        let n = pattern.size();
        let upper = pattern.transposed();
        let request = StackReq::or(
            simplicial::prefactorize_symbolic_cholesky_scratch::<u32>(n, upper.row.len()),
            supernodal::factorize_supernodal_symbolic_cholesky_scratch::<u32>(n),
        );
        let mut memory = MemBuffer::try_new(request).ok()?;
        let (mut tree, mut counts) = (vec![0i32; n], vec![0u32; n]);
        let tree = simplicial::prefactorize_symbolic_cholesky(
            &mut tree,
            &mut counts,
            upper.symbolic(),
            MemStack::new(&mut memory),
        );
        let symbolic = supernodal::factorize_supernodal_symbolic_cholesky(
            upper.symbolic(),
            tree,
            &counts,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .ok()?;
        let factor_request = supernodal::factorize_supernodal_numeric_llt_scratch::<u32, f64>(
            &symbolic,
            Par::Seq,
            Default::default(),
        );
        let solve_request = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Some(Self {
            factor: vec![0.0; symbolic.len_val()],
            factor_memory: MemBuffer::try_new(factor_request).ok()?,
            solve_memory: MemBuffer::try_new(solve_request).ok()?,
            pattern,
            symbolic,
        })
    }

    pub(crate) fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    /// Factorises the matrix with these values on the pattern.
    pub(crate) fn factorise(&mut self, values: &[f64]) -> Result<(), NotPositiveDefinite> {
        // One thread: the factor is then the same to the bit wherever it runs.
        supernodal::factorize_supernodal_numeric_llt(
            &mut self.factor,
            SparseColMatRef::new(self.pattern.symbolic(), values),
            Default::default(),
            &self.symbolic,
            Par::Seq,
            MemStack::new(&mut self.factor_memory),
            Default::default(),
        )
        .map(|_| ())
        .map_err(|LltError::NonPositivePivot { index }| NotPositiveDefinite { row: index })
    }

    /// x ← L⁻¹ x.
    pub(crate) fn forward(&mut self, x: &mut [f64]) {
        let n = x.len();
        supernodal::SupernodalLltRef::new(&self.symbolic, &self.factor).l_solve_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.solve_memory),
        );
    }

    /// x ← L⁻ᵀ x.
    pub(crate) fn backward(&mut self, x: &mut [f64]) {
        let n = x.len();
        supernodal::SupernodalLltRef::new(&self.symbolic, &self.factor)
            .l_transpose_solve_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(x, n, 1),
                Par::Seq,
                MemStack::new(&mut self.solve_memory),
            );
    }

    /// The last `size` rows and columns of L, lower triangular.
    pub(crate) fn trailing(&self, size: usize) -> DMatrix<f64> {
        let first = self.pattern.size() - size;
        let mut block = DMatrix::zeros(size, size);
        let factor = supernodal::SupernodalLltRef::new(&self.symbolic, &self.factor);
        for s in (0..self.symbolic.n_supernodes()).rev() {
            let node = factor.supernode(s);
            let (start, width) = (node.start(), node.val().ncols());
            if start + width <= first {
                break;
            }
            for j in first.max(start)..start + width {
                let column = node.val().col(j - start);
                for i in j..start + width {
                    block[(i - first, j - first)] = column[i - start];
                }
                for (k, &i) in node.pattern().iter().enumerate() {
                    block[(i as usize - first, j - first)] = column[width + k];
                }
            }
        }
        block
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DVector;
    use proptest::prelude::*;

    /// Arrow matrix plus a random band: sparse rows with a dense tail.
    fn sample(n: usize, seed: &[f64]) -> (Pattern, Vec<f64>, DMatrix<f64>) {
        let mut dense = DMatrix::zeros(n, n);
        let mut column_start = vec![0];
        let (mut row, mut values) = (Vec::new(), Vec::new());
        for j in 0..n {
            for i in j..n {
                if i == j || i - j == 3 || i + 2 >= n {
                    let v = if i == j {
                        8.0
                    } else {
                        seed[(i * 7 + j) % seed.len()]
                    };
                    dense[(i, j)] = v;
                    dense[(j, i)] = v;
                    row.push(i as u32);
                    values.push(v);
                }
            }
            column_start.push(row.len() as u32);
        }
        // Diagonally dominant, hence positive definite.
        for i in 0..n {
            let sum: f64 = (0..n)
                .filter(|&j| j != i)
                .map(|j| dense[(i, j)].abs())
                .sum();
            dense[(i, i)] += sum;
            values[column_start[i] as usize] += sum;
        }
        (Pattern { column_start, row }, values, dense)
    }

    proptest! {
        #[test]
        fn solves_and_gives_its_trailing_block(
            n in 4usize..40, seed in prop::collection::vec(-1.0..1.0f64, 13), tail in 1usize..4,
        ) {
            let (pattern, values, dense) = sample(n, &seed);
            let mut cholesky = Cholesky::analyse(pattern).expect("small");
            cholesky.factorise(&values).expect("definite");
            let x = DVector::from_fn(n, |i, _| (i as f64).cos());
            let mut b = (&dense * &x).as_slice().to_vec();
            cholesky.forward(&mut b);
            cholesky.backward(&mut b);
            prop_assert!((DVector::from_vec(b) - &x).norm() < 1e-11);
            // L_cc L_ccᵀ is the Schur complement of the trailing block.
            let l = cholesky.trailing(tail);
            let (m, c) = (n - tail, tail);
            let inner = dense.view((0, 0), (m, m)).into_owned();
            let coupling = dense.view((m, 0), (c, m)).into_owned();
            let schur = dense.view((m, m), (c, c))
                - &coupling * inner.try_inverse().expect("definite") * coupling.transpose();
            prop_assert!((&l * l.transpose() - schur).norm() < 1e-10);
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused_at_its_row() {
        let pattern = Pattern {
            column_start: vec![0, 2, 3],
            row: vec![0, 1, 1],
        };
        let mut cholesky = Cholesky::analyse(pattern).expect("small");
        assert_eq!(
            cholesky.factorise(&[1.0, 2.0, 1.0]),
            Err(NotPositiveDefinite { row: 1 })
        );
        cholesky.factorise(&[1.0, 0.5, 1.0]).expect("definite");
    }
}
