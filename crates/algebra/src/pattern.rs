//! Where the entries of a sparse symmetric matrix are; not their values.

use faer::sparse::SymbolicSparseColMat;
use std::sync::Arc;

/// Lower triangle of a symmetric sparse matrix by columns: pattern without values. The diagonal
/// is the first entry of every column. Clones share it.
#[derive(Debug, Clone)]
pub struct Pattern {
    pub(crate) lower: Arc<SymbolicSparseColMat<u32>>,
    kept: usize,
}

/// Numbers that are no pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum PatternError {
    /// The starts of the columns are not 0, then ascending to the number of entries.
    #[error(
        "column {column} does not start where the one before it ends: expected ascending starts from 0 to {entries}"
    )]
    Start {
        /// The first such column.
        column: usize,
        /// Number of entries.
        entries: usize,
    },
    /// The rows of a column are not its diagonal and rows below it, ascending.
    #[error(
        "column {column}: expected its diagonal, then rows below it in ascending order, each once and less than {size}"
    )]
    Rows {
        /// The first such column.
        column: usize,
        /// Number of columns.
        size: usize,
    },
    /// More unknowns to keep than there are.
    #[error("{kept} unknowns to keep of {size}")]
    Kept {
        /// Unknowns to keep.
        kept: usize,
        /// Unknowns that there are.
        size: usize,
    },
}

impl Pattern {
    /// From where the columns start, and where the last one ends, and the rows of their entries.
    ///
    /// # Errors
    /// [`PatternError`] at the first column that is not its diagonal and ascending rows below it.
    pub fn new(column_start: Vec<u32>, row: Vec<u32>) -> Result<Self, PatternError> {
        let (size, entries) = (column_start.len().saturating_sub(1), row.len());
        let start = |column| PatternError::Start { column, entries };
        if column_start.first() != Some(&0) {
            return Err(start(0));
        }
        if column_start.last().map(|&end| end as usize) != Some(entries) {
            return Err(start(size));
        }
        for (column, ends) in column_start.windows(2).enumerate() {
            let own = row.get(ends[0] as usize..ends[1] as usize);
            let own = own.ok_or(start(column))?;
            let ascends = own.windows(2).all(|pair| pair[0] < pair[1]);
            let last = own.last().is_some_and(|&i| (i as usize) < size);
            if own.first() != Some(&(column as u32)) || !ascends || !last {
                return Err(PatternError::Rows { column, size });
            }
        }
        let lower = SymbolicSparseColMat::new_checked(size, size, column_start, None, row);
        Ok(Self {
            lower: Arc::new(lower),
            kept: 0,
        })
    }

    /// The same with so many last unknowns to keep, on which an [`Engine`](crate::Engine) condenses.
    ///
    /// # Errors
    /// [`PatternError::Kept`] if there are not so many.
    pub fn keeping(self, kept: usize) -> Result<Self, PatternError> {
        let size = self.size();
        if kept > size {
            return Err(PatternError::Kept { kept, size });
        }
        Ok(Self { kept, ..self })
    }

    /// Number of rows.
    #[inline]
    pub fn size(&self) -> usize {
        self.lower.nrows()
    }

    /// Number of last unknowns that are kept.
    #[inline]
    pub fn kept(&self) -> usize {
        self.kept
    }

    /// Number of entries.
    pub fn entries(&self) -> usize {
        self.lower.row_idx().len()
    }

    /// Position of entry (row, column) of the lower triangle among the values.
    #[inline]
    pub fn slot(&self, row: u32, column: u32) -> Option<u32> {
        if column as usize >= self.size() {
            return None;
        }
        let range = self.range(column as usize);
        self.lower.row_idx()[range.clone()]
            .binary_search(&row)
            .ok()
            .map(|k| (range.start + k) as u32)
    }

    /// Position of a diagonal entry among the values.
    ///
    /// # Panics
    /// If there is no such row.
    #[inline]
    pub fn diagonal(&self, row: usize) -> usize {
        self.lower.col_ptr()[row] as usize
    }

    /// Positions of the entries of a column among the values.
    ///
    /// # Panics
    /// If there is no such column.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_pattern_is_told_with_its_column() {
        let new = |start: &[u32], row: &[u32]| Pattern::new(start.to_vec(), row.to_vec()).err();
        let rows = |column, size| Some(PatternError::Rows { column, size });
        let start = |column, entries| Some(PatternError::Start { column, entries });
        assert_eq!(new(&[0], &[]), None);
        assert_eq!(new(&[0, 2, 3], &[0, 1, 1]), None);
        assert_eq!(new(&[], &[]), start(0, 0));
        assert_eq!(new(&[1, 2], &[0, 1]), start(0, 2));
        assert_eq!(new(&[0, 2], &[0]), start(1, 1));
        assert_eq!(new(&[0, 3, 2], &[0, 1]), start(0, 2));
        assert_eq!(new(&[0, 2, 1, 3], &[0, 1, 2]), start(1, 3));
        // No diagonal, descending, twice, out of the matrix, above the diagonal.
        assert_eq!(new(&[0, 1, 2], &[1, 1]), rows(0, 2));
        assert_eq!(new(&[0, 0, 1], &[1]), rows(0, 2));
        assert_eq!(new(&[0, 3, 4, 5], &[0, 2, 1, 1, 2]), rows(0, 3));
        assert_eq!(new(&[0, 2, 3], &[0, 0, 1]), rows(0, 2));
        assert_eq!(new(&[0, 1, 3], &[0, 1, 2]), rows(1, 2));
        assert_eq!(new(&[0, 1, 3], &[0, 0, 1]), rows(1, 2));
        let two = Pattern::new(vec![0, 2, 3], vec![0, 1, 1]).expect("valid");
        assert_eq!(two.clone().keeping(2).map(|p| p.kept()), Ok(2));
        let none = PatternError::Kept { kept: 3, size: 2 };
        assert_eq!(two.clone().keeping(3).map(|p| p.kept()), Err(none));
        assert_eq!(
            [two.slot(1, 0), two.slot(0, 1), two.slot(0, 5)],
            [Some(1), None, None]
        );
    }
}
