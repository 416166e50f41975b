//! Square matrices of D×D blocks, compressed by block rows, and their factorisation; the libraries
//! that factorise are behind `dense` and `sparse`.

use super::{split, stack};
use crate::ContactError;
use crate::error::expect_sizes;
use moreau_algebra::Lu;
use moreau_algebra::{Rows, SparseLu};
use moreau_laws::Local;
use nalgebra::{DMatrix, SMatrix};

/// A square matrix of D×D blocks, one block row and column per contact; blocks that are not stored
/// are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockMatrix<const D: usize> {
    starts: Vec<usize>,
    columns: Vec<usize>,
    blocks: Vec<SMatrix<f64, D, D>>,
}

impl<const D: usize> BlockMatrix<D> {
    /// From scalar entries (row, column, value) in any order; those at the same place are added,
    /// those beyond `contacts` blocks are left out.
    pub fn from_entries(
        contacts: usize,
        entries: impl IntoIterator<Item = (usize, usize, f64)>,
    ) -> Self {
        let size = D * contacts;
        let mut sorted: Vec<(usize, usize, f64)> = entries
            .into_iter()
            .filter(|&(i, j, v)| i < size && j < size && v != 0.0)
            .collect();
        sorted.sort_by_key(|&(i, j, _)| (i / D, j / D));
        let mut matrix = Self {
            starts: vec![0; contacts + 1],
            columns: Vec::new(),
            blocks: Vec::new(),
        };
        let mut last = None;
        for (i, j, value) in sorted {
            let place = (i / D, j / D);
            if last != Some(place) {
                last = Some(place);
                matrix.columns.push(place.1);
                matrix.blocks.push(SMatrix::zeros());
                matrix.starts[place.0 + 1] += 1;
            }
            if let Some(block) = matrix.blocks.last_mut() {
                block[(i % D, j % D)] += value;
            }
        }
        for k in 0..contacts {
            matrix.starts[k + 1] += matrix.starts[k];
        }
        matrix
    }

    /// Without rows; they follow by [`Self::push_row`].
    pub(crate) fn empty() -> Self {
        Self {
            starts: vec![0],
            columns: Vec::new(),
            blocks: Vec::new(),
        }
    }

    /// Appends a row of blocks, given in increasing order of their columns.
    pub(crate) fn push_row(&mut self, row: impl IntoIterator<Item = (usize, SMatrix<f64, D, D>)>) {
        for (column, block) in row {
            self.columns.push(column);
            self.blocks.push(block);
        }
        self.starts.push(self.columns.len());
    }

    /// From a dense matrix of `D·contacts` rows and columns; blocks of zeros are not stored.
    ///
    /// # Errors
    /// [`ContactError::Dimension`] of a matrix of other rows or columns.
    pub fn from_dense(dense: &DMatrix<f64>) -> Result<Self, ContactError> {
        let contacts = dense.nrows() / D;
        expect_sizes([
            ("rows of a dense matrix", dense.nrows(), D * contacts),
            ("columns of a dense matrix", dense.ncols(), D * contacts),
        ])?;
        let mut matrix = Self::empty();
        for i in 0..contacts {
            let block = |j: usize| (j, dense.fixed_view::<D, D>(D * i, D * j).into_owned());
            let row = (0..contacts).map(block);
            matrix.push_row(row.filter(|(_, block)| block.iter().any(|v| *v != 0.0)));
        }
        Ok(matrix)
    }

    /// Number of block rows.
    pub fn contacts(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of stored blocks.
    pub fn stored(&self) -> usize {
        self.blocks.len()
    }

    /// The stored blocks of a block row with their columns, in the order of the columns.
    #[inline]
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, &SMatrix<f64, D, D>)> {
        let range = self.starts[i]..self.starts[i + 1];
        self.columns[range.clone()]
            .iter()
            .copied()
            .zip(&self.blocks[range])
    }

    /// The diagonal block of contact i; zero if it is not stored.
    pub fn diagonal(&self, i: usize) -> SMatrix<f64, D, D> {
        let own = self.row(i).find(|(j, _)| *j == i);
        own.map_or_else(SMatrix::zeros, |(_, block)| *block)
    }

    /// Adds to the diagonal of a stored diagonal block.
    pub(crate) fn add_to_diagonal(&mut self, i: usize, d: &Local<D>) {
        let mut range = self.starts[i]..self.starts[i + 1];
        if let Some(own) = range.find(|at| self.columns[*at] == i) {
            for k in 0..D {
                self.blocks[own][(k, k)] += d[k];
            }
        }
    }

    /// Row i of the product A x.
    #[inline]
    pub fn row_times(&self, i: usize, x: &[Local<D>]) -> Local<D> {
        let mut sum = Local::zeros();
        for (j, block) in self.row(i) {
            // Column by column, the order of sums of a dense product.
            for l in 0..D {
                for k in 0..D {
                    sum[k] += block[(k, l)] * x[j][l];
                }
            }
        }
        sum
    }

    /// All entries of the stored blocks.
    pub(crate) fn entries(&self) -> impl Iterator<Item = &f64> {
        self.blocks.iter().flatten()
    }
}

/// Size of a matrix up to which it is factorised as a dense one.
const SMALL: usize = 60;

/// Part of stored blocks above which a matrix is factorised as a dense one.
const FULL: f64 = 0.15;

/// A factorised block matrix.
pub(crate) enum Factor {
    Dense(Lu),
    Sparse(Box<SparseLu>),
}

impl Factor {
    /// Factorises; `None` if the matrix is singular.
    pub(crate) fn new<const D: usize>(matrix: &BlockMatrix<D>) -> Option<Self> {
        let (n, rows) = (D * matrix.contacts(), matrix.contacts());
        if n <= SMALL || matrix.stored() as f64 > FULL * (rows * rows) as f64 {
            let mut dense = DMatrix::zeros(n, n);
            for i in 0..rows {
                for (j, block) in matrix.row(i) {
                    dense.fixed_view_mut::<D, D>(D * i, D * j).copy_from(block);
                }
            }
            return Lu::new(dense).map(Self::Dense);
        }
        let mut scalar = Rows::default();
        scalar.starts.push(0);
        for i in 0..rows {
            for k in 0..D {
                for (j, block) in matrix.row(i) {
                    for l in 0..D {
                        scalar.columns.push(D * j + l);
                        scalar.values.push(block[(k, l)]);
                    }
                }
                scalar.starts.push(scalar.columns.len());
            }
        }
        SparseLu::new(&scalar).map(|lu| Self::Sparse(Box::new(lu)))
    }

    /// x of A x = b; `None` where A was singular to rounding.
    pub(crate) fn solve<const D: usize>(&mut self, b: &[Local<D>]) -> Option<Vec<Local<D>>> {
        let x = match self {
            Self::Dense(lu) => lu.solve(stack(b)),
            Self::Sparse(lu) => lu.solve(stack(b))?,
        };
        x.iter().all(|v| v.is_finite()).then(|| split(&x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_product_is_that_of_the_dense_matrix() {
        let dense = DMatrix::from_fn(6, 6, |i, j| {
            // The block (0, 1) is empty.
            if i < 2 && (2..4).contains(&j) {
                0.0
            } else {
                (7 * i + j) as f64
            }
        });
        let sparse = BlockMatrix::<2>::from_dense(&dense).expect("square");
        assert_eq!((sparse.contacts(), sparse.stored()), (3, 8));
        let x: Vec<Local<2>> = (0..3).map(|i| Local::<2>::new(i as f64, 1.0)).collect();
        let expected = &dense * crate::problem::stack(&x);
        for i in 0..3 {
            let row = sparse.row_times(i, &x);
            assert_eq!([row[0], row[1]], [expected[2 * i], expected[2 * i + 1]]);
        }
        assert_eq!(sparse.diagonal(1)[(1, 0)], dense[(3, 2)]);
        let twice = BlockMatrix::<2>::from_entries(1, [(0, 1, 2.0), (1, 1, 1.0), (0, 1, 3.0)]);
        assert_eq!(twice.diagonal(0)[(0, 1)], 5.0);
    }

    /// What does not fit into blocks is not left out.
    #[test]
    fn a_matrix_that_is_none_of_blocks_is_refused() {
        for (rows, columns) in [(5, 5), (4, 2), (4, 6), (0, 2)] {
            let dense = DMatrix::from_element(rows, columns, 1.0);
            let matrix = BlockMatrix::<2>::from_dense(&dense);
            let refused = matches!(matrix, Err(ContactError::Dimension { .. }));
            assert!(refused, "{rows} x {columns}");
        }
        let empty = BlockMatrix::<2>::from_dense(&DMatrix::zeros(0, 0)).expect("square");
        assert_eq!(empty.contacts(), 0);
    }
}
