//! A coarse space of a sparse symmetric system: vectors in which some unknowns follow others; not the
//! iteration that uses it.

use crate::engine::EngineError;
use crate::matrix::Matrix;
use crate::pattern::Pattern;

/// Vectors v = P w of a system, by fewer unknowns w, and the matrix Pᵀ A P that they see.
///
/// A row of P tells which unknowns w an unknown v follows, and how far: itself where it is an unknown of both,
/// the ends of an edge by halves in its middle, none where it is held.
#[derive(Debug)]
pub struct CoarseSpace {
    matrix: Matrix,
    rows: Weights,
    /// Pᵀ.
    columns: Weights,
}

/// Sparse rows.
#[derive(Debug)]
struct Weights {
    start: Vec<u32>,
    parts: Vec<(u32, f64)>,
}

impl Weights {
    fn row(&self, k: usize) -> &[(u32, f64)] {
        &self.parts[self.start[k] as usize..self.start[k + 1] as usize]
    }

    fn count(&self) -> usize {
        self.start.len() - 1
    }

    fn transposed(&self, size: usize) -> Self {
        let mut start = vec![0u32; size + 1];
        self.parts
            .iter()
            .for_each(|&(c, _)| start[c as usize + 1] += 1);
        for c in 0..size {
            start[c + 1] += start[c];
        }
        let mut next = start.clone();
        let mut parts = vec![(0, 0.0); self.parts.len()];
        for k in 0..self.count() {
            for &(c, part) in self.row(k) {
                let at = &mut next[c as usize];
                parts[*at as usize] = (k as u32, part);
                *at += 1;
            }
        }
        Self { start, parts }
    }
}

/// Rows that are no P.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum CoarseError {
    /// Another number of rows than the system has unknowns.
    #[error("{rows} rows of P for {unknowns} unknowns")]
    Rows {
        /// Rows of P.
        rows: usize,
        /// Unknowns of the system.
        unknowns: usize,
    },
    /// A row follows an unknown that there is none of.
    #[error("row {row} of P follows unknown {unknown} of {size}")]
    Unknown {
        /// The row.
        row: usize,
        /// What it follows.
        unknown: u32,
        /// Number of coarse unknowns.
        size: usize,
    },
    /// More unknowns are kept than the space has.
    #[error("{kept} unknowns to keep of {size}")]
    Kept {
        /// Unknowns to keep.
        kept: usize,
        /// Number of coarse unknowns.
        size: usize,
    },
}

impl CoarseSpace {
    /// The space of `size` unknowns whose P has these rows, in a system of a pattern; the unknowns that the
    /// pattern keeps are the last here, too. The pattern of Pᵀ A P is found from both.
    ///
    /// # Errors
    /// [`CoarseError`] where they do not fit.
    pub fn new<R: AsRef<[(u32, f64)]>>(
        fine: &Pattern,
        size: usize,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<Self, CoarseError> {
        let unknowns = fine.size();
        let (mut start, mut parts) = (vec![0u32], Vec::new());
        for (row, own) in rows.into_iter().enumerate() {
            let own = own.as_ref();
            if let Some(&(unknown, _)) = own.iter().find(|&&(c, _)| c as usize >= size) {
                return Err(CoarseError::Unknown { row, unknown, size });
            }
            parts.extend_from_slice(own);
            start.push(parts.len() as u32);
        }
        if start.len() != unknowns + 1 {
            let rows = start.len() - 1;
            return Err(CoarseError::Rows { rows, unknowns });
        }
        let rows = Weights { start, parts };
        let columns = rows.transposed(size);
        let kept = fine.kept();
        // What is made here has rows in order; what is left is their number.
        let pattern = product(fine, &rows, &columns).and_then(|pattern| pattern.keeping(kept).ok());
        Ok(Self {
            matrix: Matrix::new(pattern.ok_or(CoarseError::Kept { kept, size })?),
            rows,
            columns,
        })
    }

    /// Number of its unknowns.
    pub fn size(&self) -> usize {
        self.columns.count()
    }

    /// Number of unknowns of the system.
    pub fn fine_size(&self) -> usize {
        self.rows.count()
    }

    /// A row of P: the unknowns w that an unknown v follows, and how far.
    pub fn row(&self, unknown: usize) -> &[(u32, f64)] {
        self.rows.row(unknown)
    }

    /// Pᵀ A P of the last [`project`](Self::project).
    pub fn matrix(&self) -> &Matrix {
        &self.matrix
    }

    /// The same, to be added to.
    pub fn matrix_mut(&mut self) -> &mut Matrix {
        &mut self.matrix
    }

    /// Pᵀ A P of a matrix of the system.
    ///
    /// # Errors
    /// [`EngineError::Length`] for one of another size.
    pub fn project(&mut self, fine: &Matrix) -> Result<(), EngineError> {
        check("rows of a matrix", fine.pattern.size(), self.fine_size())?;
        let (rows, columns) = (&self.rows, &self.columns);
        let (pattern, values) = self.matrix.values_mut();
        values.fill(0.0);
        // M + Mᵀ with M = Pᵀ U P, where U is the lower triangle of A with half of the diagonal.
        let mut sum = vec![0.0; pattern.size()];
        let mut touched: Vec<u32> = Vec::new();
        let mut seen = vec![false; pattern.size()];
        for column in 0..pattern.size() {
            for &(j, of_j) in columns.row(column) {
                let range = fine.pattern.range(j as usize);
                let entries = fine.values()[range.clone()].iter();
                for (&i, a) in fine.pattern.rows()[range].iter().zip(entries) {
                    let a = if i == j { 0.5 * a } else { *a };
                    for &(row, of_i) in rows.row(i as usize) {
                        if !std::mem::replace(&mut seen[row as usize], true) {
                            touched.push(row);
                        }
                        sum[row as usize] += of_i * a * of_j;
                    }
                }
            }
            for row in touched.drain(..) {
                let value = std::mem::take(&mut sum[row as usize]);
                seen[row as usize] = false;
                let (last, first) = (row.max(column as u32), row.min(column as u32));
                let twice = if last == first { 2.0 } else { 1.0 };
                if let Some(slot) = pattern.slot(last, first) {
                    values[slot as usize] += twice * value;
                }
            }
        }
        Ok(())
    }

    /// Pᵀ f.
    ///
    /// # Panics
    /// If f is not as long as the system.
    pub fn restrict(&self, f: &[f64]) -> Vec<f64> {
        assert_eq!(f.len(), self.fine_size(), "a vector of the system");
        let mut out = vec![0.0; self.size()];
        for (k, f) in f.iter().enumerate() {
            for &(unknown, part) in self.rows.row(k) {
                out[unknown as usize] += part * f;
            }
        }
        out
    }

    /// v ← v + P w.
    ///
    /// # Panics
    /// If w is not as long as the space, or v as the system.
    pub fn prolong(&self, w: &[f64], v: &mut [f64]) {
        assert_eq!(w.len(), self.size(), "a vector of the space");
        assert_eq!(v.len(), self.fine_size(), "a vector of the system");
        for (k, v) in v.iter_mut().enumerate() {
            let parts = self.rows.row(k).iter();
            *v += parts.map(|&(c, part)| part * w[c as usize]).sum::<f64>();
        }
    }
}

/// A number that has to be another.
pub(crate) fn check(what: &'static str, found: usize, expected: usize) -> Result<(), EngineError> {
    if found == expected {
        return Ok(());
    }
    Err(EngineError::Length {
        what,
        found,
        expected,
    })
}

/// The pattern of Pᵀ A P.
fn product(fine: &Pattern, rows: &Weights, columns: &Weights) -> Option<Pattern> {
    let upper = fine.transposed();
    let size = columns.count();
    let mut last_seen = vec![u32::MAX; size];
    let (mut start, mut all) = (vec![0u32], Vec::new());
    for column in 0..size {
        let first = all.len();
        all.push(column as u32);
        last_seen[column] = column as u32;
        for &(j, _) in columns.row(column) {
            let below = &fine.rows()[fine.range(j as usize)];
            let [from, to] = [j, j + 1].map(|j| upper.col_ptr()[j as usize] as usize);
            for &i in below.iter().chain(&upper.row_idx()[from..to]) {
                for &(row, _) in rows.row(i as usize) {
                    let seen = &mut last_seen[row as usize];
                    if row as usize > column && *seen != column as u32 {
                        *seen = column as u32;
                        all.push(row);
                    }
                }
            }
        }
        all[first..].sort_unstable();
        start.push(all.len() as u32);
    }
    Pattern::new(start, all).ok()
}
