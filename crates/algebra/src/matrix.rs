//! A symmetric matrix that cells are added to, its products and its sweeps; not its factor.

use crate::pattern::Pattern;

/// A symmetric matrix of which the lower triangle is held, and what it goes back to.
#[derive(Debug)]
pub struct Matrix {
    /// Where its entries are.
    pub pattern: Pattern,
    values: Vec<f64>,
    kept: Option<Vec<f64>>,
}

impl Matrix {
    /// All zero.
    pub fn new(pattern: Pattern) -> Self {
        Self {
            values: vec![0.0; pattern.entries()],
            pattern,
            kept: None,
        }
    }

    /// Where it is added up.
    pub fn values_mut(&mut self) -> (&Pattern, &mut [f64]) {
        (&self.pattern, &mut self.values)
    }

    /// Keeps it as it is now, to go back to.
    pub fn keep(&mut self) {
        self.kept = Some(self.values.clone());
    }

    /// Goes back to what was kept, or to zero.
    pub fn reset(&mut self) {
        match &self.kept {
            Some(kept) => self.values.copy_from_slice(kept),
            None => self.values.fill(0.0),
        }
    }

    /// The entries, in the order of the pattern.
    #[inline]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The entry on the diagonal of a row.
    #[inline]
    pub fn diagonal(&self, row: usize) -> f64 {
        self.values[self.pattern.diagonal(row)]
    }

    /// Adds to the last diagonals, so many.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn shift(&mut self, last: usize, by: f64) {
        let size = self.pattern.size();
        assert!(last <= size, "{last} diagonals of {size}");
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
    ///
    /// # Panics
    /// If x or b is not as long as there are rows.
    pub fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut r = b.to_vec();
        self.subtract_product(x, &mut r);
        r
    }

    /// r ← r − A x.
    ///
    /// # Panics
    /// If x or r is not as long as there are rows.
    pub fn subtract_product(&self, x: &[f64], r: &mut [f64]) {
        assert_eq!(
            [x.len(), r.len()],
            [self.pattern.size(); 2],
            "a number a row"
        );
        for j in 0..x.len() {
            let (diagonal, below, values) = self.column(j);
            let mut sum = diagonal * x[j];
            for (&i, a) in below.iter().zip(values) {
                let i = i as usize;
                sum += a * x[i];
                r[i] -= a * x[j];
            }
            r[j] -= sum;
        }
    }

    /// x of (D + L) x = b on the rows that move, zero on the others, with D the diagonal and L what is
    /// below it: a sweep of Gauss and Seidel from nothing. Writes to `left` what that leaves of b.
    pub fn sweep_down(
        &self,
        b: &[f64],
        moves: impl Fn(usize) -> bool,
        x: &mut [f64],
        left: &mut [f64],
    ) {
        x.copy_from_slice(b);
        for j in (0..x.len()).filter(|&j| moves(j)) {
            let (diagonal, below, values) = self.column(j);
            x[j] /= diagonal;
            let own = x[j];
            for (&i, a) in below.iter().zip(values) {
                x[i as usize] -= a * own;
            }
        }
        for (j, left) in left.iter_mut().enumerate() {
            *left = match moves(j) {
                true => 0.0,
                false => std::mem::take(&mut x[j]),
            };
        }
        for (j, left) in left.iter_mut().enumerate() {
            *left -= self.sum_below(j, x);
        }
    }

    /// A sweep of Gauss and Seidel over the rows of A x = b that move, from the last to the first;
    /// `b` is overwritten.
    pub fn sweep_up(&self, b: &mut [f64], moves: impl Fn(usize) -> bool, x: &mut [f64]) {
        for (j, own) in x.iter().enumerate() {
            let (_, below, values) = self.column(j);
            for (&i, a) in below.iter().zip(values) {
                b[i as usize] -= a * own;
            }
        }
        for j in (0..x.len()).rev().filter(|&j| moves(j)) {
            x[j] = (b[j] - self.sum_below(j, x)) / self.column(j).0;
        }
    }

    /// Σ of the entries of a column below its diagonal times x.
    fn sum_below(&self, j: usize, x: &[f64]) -> f64 {
        let (_, below, values) = self.column(j);
        let pairs = below.iter().zip(values);
        pairs.map(|(&i, a)| a * x[i as usize]).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Nodes of three, two and one unknown, not all of them neighbours, and the same dense.
    fn sample() -> (Matrix, DMatrix<f64>) {
        let nodes = [0..3, 3..5, 5..8, 8..9, 9..12];
        let n = 12;
        let neighbours = |a: usize, b: usize| a == b || (a * b + a + b) % 3 != 1;
        let node = |i: usize| nodes.iter().position(|node| node.contains(&i));
        let mut dense = DMatrix::zeros(n, n);
        let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            for i in j..n {
                let (a, b) = (node(i).expect("one"), node(j).expect("one"));
                if neighbours(a.min(b), a.max(b)) {
                    let v = if i == j {
                        12.0
                    } else {
                        ((i + 5 * j) as f64).sin()
                    };
                    (dense[(i, j)], dense[(j, i)]) = (v, v);
                    rows.push(i as u32);
                    values.push(v);
                }
            }
            start.push(rows.len() as u32);
        }
        let mut matrix = Matrix::new(Pattern::new(start, rows).expect("ascending"));
        matrix.values_mut().1.copy_from_slice(&values);
        (matrix, dense)
    }

    #[test]
    fn a_product_is_that_of_the_dense_matrix() {
        let (matrix, dense) = sample();
        let x = DVector::from_fn(12, |i, _| (i as f64).cos());
        let b = DVector::from_fn(12, |i, _| (i as f64).sin());
        let r = matrix.residual(x.as_slice(), b.as_slice());
        assert!((DVector::from_vec(r) - (b - dense * x)).norm() < 1e-13);
    }

    #[test]
    fn sweeps_are_those_of_gauss_and_seidel() {
        let b = DVector::from_fn(12, |i, _| 1.0 + (i as f64).sin());
        let (matrix, dense) = sample();
        let all = [12, 9, 7].map(|rows| (0..12).map(|i| i < rows).collect());
        let scattered: Vec<bool> = (0..12).map(|i| i % 3 != 1).collect();
        for moves in all.into_iter().chain([scattered]) {
            let moving = || (0..12).filter(|&i| moves[i]);
            let mut x = vec![0.0; 12];
            let mut left = vec![f64::NAN; 12];
            matrix.sweep_down(b.as_slice(), |i| moves[i], &mut x, &mut left);
            let mut expected = DVector::zeros(12);
            for i in moving() {
                let others = (dense.row(i) * &expected)[0];
                expected[i] += (b[i] - others) / dense[(i, i)];
            }
            assert!((DVector::from_vec(x) - &expected).norm() < 1e-13);
            assert!((DVector::from_vec(left) - (&b - &dense * &expected)).norm() < 1e-12);
            // From anywhere, and what is not swept counts.
            let mut expected = DVector::from_fn(12, |i, _| 0.1 * i as f64);
            let mut x = expected.as_slice().to_vec();
            matrix.sweep_up(&mut b.as_slice().to_vec(), |i| moves[i], &mut x);
            for i in moving().collect::<Vec<_>>().into_iter().rev() {
                let all = (dense.row(i) * &expected)[0];
                expected[i] += (b[i] - all) / dense[(i, i)];
            }
            assert!((DVector::from_vec(x) - expected).norm() < 1e-13);
        }
    }
}
