//! Where the entries of a sparse symmetric matrix are; not their values.

use faer::sparse::SymbolicSparseColMat;

/// Lower triangle of a symmetric sparse matrix by columns: pattern without values. The diagonal
/// is the first entry of every column.
#[derive(Debug, Clone)]
pub struct Pattern {
    pub(crate) lower: SymbolicSparseColMat<u32>,
}

impl Pattern {
    /// From where the columns start and the rows of their entries, ascending.
    ///
    /// # Panics
    /// Where these are no such numbers.
    pub fn new(column_start: Vec<u32>, row: Vec<u32>) -> Self {
        let n = column_start.len() - 1;
        Self {
            lower: SymbolicSparseColMat::new_checked(n, n, column_start, None, row),
        }
    }

    /// Number of rows.
    #[inline]
    pub fn size(&self) -> usize {
        self.lower.nrows()
    }

    /// Number of entries.
    pub fn entries(&self) -> usize {
        self.lower.row_idx().len()
    }

    /// Position of entry (row, column), row ≥ column, among the values.
    #[inline]
    pub fn slot(&self, row: u32, column: u32) -> Option<u32> {
        let range = self.range(column as usize);
        self.lower.row_idx()[range.clone()]
            .binary_search(&row)
            .ok()
            .map(|k| (range.start + k) as u32)
    }

    /// Position of a diagonal entry among the values.
    #[inline]
    pub fn diagonal(&self, row: usize) -> usize {
        self.lower.col_ptr()[row] as usize
    }

    /// Positions of the entries of a column among the values.
    #[inline]
    pub fn range(&self, column: usize) -> std::ops::Range<usize> {
        let start = self.lower.col_ptr();
        start[column] as usize..start[column + 1] as usize
    }

    /// Rows of the entries of all columns.
    #[inline]
    pub fn rows(&self) -> &[u32] {
        self.lower.row_idx()
    }

    pub(crate) fn transposed(&self) -> SymbolicSparseColMat<u32> {
        let n = self.size();
        let mut column_start = vec![0u32; n + 1];
        for &i in self.rows() {
            column_start[i as usize + 1] += 1;
        }
        for j in 0..n {
            column_start[j + 1] += column_start[j];
        }
        let mut next = column_start.clone();
        let mut row = vec![0u32; self.entries()];
        for j in 0..n {
            for &i in &self.rows()[self.range(j)] {
                let slot = &mut next[i as usize];
                row[*slot as usize] = j as u32;
                *slot += 1;
            }
        }
        SymbolicSparseColMat::new_checked(n, n, column_start, None, row)
    }
}
