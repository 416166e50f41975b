//! A symmetric matrix that cells are added to, its products and its sweeps; not its factor.

use crate::cholesky::Pattern;

/// A stiffness: the elastic one, and what it is now.
#[derive(Debug)]
pub(crate) struct Matrix {
    pub(crate) pattern: Pattern,
    /// One more than there are entries, for what no unknown sees.
    elastic: Vec<f64>,
    values: Vec<f64>,
}

impl Matrix {
    /// All zero.
    pub(crate) fn new(pattern: Pattern) -> Self {
        let values = vec![0.0; pattern.entries() + 1];
        Self {
            pattern,
            elastic: values.clone(),
            values,
        }
    }

    /// Where the elastic stiffness is added up.
    pub(crate) fn elastic_mut(&mut self) -> &mut [f64] {
        &mut self.elastic
    }

    /// Where what flow adds to it is added up.
    pub(crate) fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Makes it the elastic stiffness.
    pub(crate) fn reset(&mut self) {
        self.values.copy_from_slice(&self.elastic);
    }

    /// The entries, in the order of the pattern.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values[..self.pattern.entries()]
    }

    /// Diagonal of the elastic stiffness.
    pub(crate) fn elastic_diagonal(&self, row: usize) -> f64 {
        self.elastic[self.pattern.diagonal(row)]
    }

    /// Adds to the last diagonals, so many.
    pub(crate) fn shift(&mut self, last: usize, by: f64) {
        let size = self.pattern.size();
        for row in size - last..size {
            self.values[self.pattern.diagonal(row)] += by;
        }
    }

    /// The diagonal and, of those below it, rows and entries of a column.
    fn column(&self, j: usize) -> (f64, &[u32], &[f64]) {
        let range = self.pattern.range(j);
        let (values, rows) = (&self.values[range.clone()], &self.pattern.rows()[range]);
        (values[0], &rows[1..], &values[1..])
    }

    /// b − A x.
    pub(crate) fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut r = b.to_vec();
        self.subtract_product(x, &mut r);
        r
    }

    /// r ← r − A x.
    pub(crate) fn subtract_product(&self, x: &[f64], r: &mut [f64]) {
        for j in 0..x.len() {
            let (diagonal, rows, values) = self.column(j);
            let mut sum = diagonal * x[j];
            for (&i, a) in rows.iter().zip(values) {
                let i = i as usize;
                sum += a * x[i];
                r[i] -= a * x[j];
            }
            r[j] -= sum;
        }
    }

    /// x of (D + L) x = b on the first `rows`, zero on the others, with D the diagonal and L what is
    /// below it: a sweep of Gauss and Seidel from nothing. Writes to `left` what that leaves of b.
    pub(crate) fn sweep_down(&self, b: &[f64], rows: usize, x: &mut [f64], left: &mut [f64]) {
        x.copy_from_slice(b);
        for j in 0..rows {
            let (diagonal, below, values) = self.column(j);
            x[j] /= diagonal;
            let own = x[j];
            for (&i, a) in below.iter().zip(values) {
                x[i as usize] -= a * own;
            }
        }
        left[rows..].copy_from_slice(&x[rows..]);
        x[rows..].fill(0.0);
        for (j, left) in left[..rows].iter_mut().enumerate() {
            let (_, below, values) = self.column(j);
            let pairs = below.iter().zip(values);
            *left = -pairs.map(|(&i, a)| a * x[i as usize]).sum::<f64>();
        }
    }

    /// A sweep of Gauss and Seidel over the first `rows` of A x = b, from the last to the first;
    /// `b` is overwritten.
    pub(crate) fn sweep_up(&self, b: &mut [f64], rows: usize, x: &mut [f64]) {
        for j in 0..rows {
            let (_, below, values) = self.column(j);
            let own = x[j];
            for (&i, a) in below.iter().zip(values) {
                b[i as usize] -= a * own;
            }
        }
        for j in (0..rows).rev() {
            let (diagonal, below, values) = self.column(j);
            let pairs = below.iter().zip(values);
            let sum = pairs.map(|(&i, a)| a * x[i as usize]).sum::<f64>();
            x[j] = (b[j] - sum) / diagonal;
        }
    }
}
