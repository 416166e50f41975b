//! A symmetric matrix that cells are added to, its products and its sweeps; not its factor.

use crate::cholesky::Pattern;

/// A stiffness: the elastic one, and what it is now.
#[derive(Debug)]
pub(crate) struct Matrix {
    pub(crate) pattern: Pattern,
    /// One more than there are entries, for what no unknown sees.
    elastic: Vec<f64>,
    values: Vec<f64>,
    /// First columns of the panels, and one beyond the last.
    panels: Vec<u32>,
}

/// Columns next to each other, at most, that are gone through at once: those of a node.
const WIDEST: usize = 3;

/// W columns next to each other whose rows below them are the same.
struct Panel<'a, const W: usize> {
    /// The first of them.
    first: usize,
    /// The lower triangle on its diagonal, column by column, in its first places.
    own: [[f64; W]; W],
    below: &'a [u32],
    /// The entries there.
    values: [&'a [f64]; W],
}

impl<const W: usize> Panel<'_, W> {
    /// Σ of the entries below times x, for every column.
    fn sums(&self, x: &[f64]) -> [f64; W] {
        let mut sums = [0.0; W];
        for (t, &i) in self.below.iter().enumerate() {
            for (sum, values) in sums.iter_mut().zip(&self.values) {
                *sum += values[t] * x[i as usize];
            }
        }
        sums
    }

    /// y ← y − the columns below times x.
    fn subtract(&self, x: [f64; W], y: &mut [f64]) {
        for (t, &i) in self.below.iter().enumerate() {
            let pairs = self.values.iter().zip(&x);
            y[i as usize] -= pairs.map(|(values, x)| values[t] * x).sum::<f64>();
        }
    }

    /// The entries of a vector at the columns.
    fn of(&self, x: &[f64]) -> [f64; W] {
        std::array::from_fn(|k| x[self.first + k])
    }
}

/// What is done with a panel of any width.
trait Pass {
    fn panel<const W: usize>(&mut self, panel: &Panel<'_, W>);
}

impl Matrix {
    /// All zero. The last unknowns, so many, are gone through apart from the others.
    pub(crate) fn new(pattern: Pattern, last: usize) -> Self {
        let values = vec![0.0; pattern.entries() + 1];
        let mut panels = vec![0];
        let mut start = 0;
        for j in 1..pattern.size() {
            let width = j - start;
            let rows = |j: usize| &pattern.rows()[pattern.range(j)];
            let alike = rows(start).get(width..) == Some(rows(j));
            if !alike || width == WIDEST || j + last == pattern.size() {
                panels.push(j as u32);
                start = j;
            }
        }
        panels.push(pattern.size() as u32);
        Self {
            pattern,
            elastic: values.clone(),
            values,
            panels,
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

    /// A panel of which the first column is given.
    fn panel<const W: usize>(&self, first: usize) -> Panel<'_, W> {
        let range = |k: usize| self.pattern.range(first + k);
        let entries = |k: usize| &self.values[range(k)];
        Panel {
            first,
            own: std::array::from_fn(|k| {
                std::array::from_fn(|l| entries(k).get(l).copied().unwrap_or(0.0))
            }),
            below: &self.pattern.rows()[range(0)][W..],
            values: std::array::from_fn(|k| &entries(k)[W - k..]),
        }
    }

    /// Goes through panels, by their numbers.
    fn go(&self, numbers: impl Iterator<Item = usize>, pass: &mut impl Pass) {
        for k in numbers {
            let (first, end) = (self.panels[k] as usize, self.panels[k + 1] as usize);
            match end - first {
                1 => pass.panel(&self.panel::<1>(first)),
                2 => pass.panel(&self.panel::<2>(first)),
                _ => pass.panel(&self.panel::<WIDEST>(first)),
            }
        }
    }

    /// How many panels the first `rows` columns are.
    fn panels(&self, rows: usize) -> usize {
        self.panels
            .partition_point(|&first| (first as usize) < rows)
    }

    /// b − A x.
    pub(crate) fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut r = b.to_vec();
        self.subtract_product(x, &mut r);
        r
    }

    /// r ← r − A x.
    pub(crate) fn subtract_product(&self, x: &[f64], r: &mut [f64]) {
        struct Product<'a> {
            x: &'a [f64],
            r: &'a mut [f64],
        }
        impl Pass for Product<'_> {
            fn panel<const W: usize>(&mut self, panel: &Panel<'_, W>) {
                let own = panel.of(self.x);
                let mut sums = [0.0; W];
                for (t, &i) in panel.below.iter().enumerate() {
                    let (x, mut part) = (self.x[i as usize], 0.0);
                    for k in 0..W {
                        sums[k] += panel.values[k][t] * x;
                        part += panel.values[k][t] * own[k];
                    }
                    self.r[i as usize] -= part;
                }
                for k in 0..W {
                    sums[k] += panel.own[k][0] * own[k];
                    for l in k + 1..W {
                        sums[k] += panel.own[k][l - k] * own[l];
                        sums[l] += panel.own[k][l - k] * own[k];
                    }
                }
                for (k, sum) in sums.into_iter().enumerate() {
                    self.r[panel.first + k] -= sum;
                }
            }
        }
        self.go(0..self.panels(self.pattern.size()), &mut Product { x, r });
    }

    /// x of (D + L) x = b on the first `rows`, zero on the others, with D the diagonal and L what is
    /// below it: a sweep of Gauss and Seidel from nothing. Writes to `left` what that leaves of b.
    /// The rows are all, or all but the last unknowns.
    pub(crate) fn sweep_down(&self, b: &[f64], rows: usize, x: &mut [f64], left: &mut [f64]) {
        struct Down<'a>(&'a mut [f64]);
        impl Pass for Down<'_> {
            fn panel<const W: usize>(&mut self, panel: &Panel<'_, W>) {
                let mut own = panel.of(self.0);
                for k in 0..W {
                    own[k] /= panel.own[k][0];
                    for l in k + 1..W {
                        own[l] -= panel.own[k][l - k] * own[k];
                    }
                }
                self.0[panel.first..panel.first + W].copy_from_slice(&own);
                panel.subtract(own, self.0);
            }
        }
        struct Left<'a>(&'a [f64], &'a mut [f64]);
        impl Pass for Left<'_> {
            fn panel<const W: usize>(&mut self, panel: &Panel<'_, W>) {
                let (own, mut sums) = (panel.of(self.0), panel.sums(self.0));
                for k in 0..W {
                    for l in k + 1..W {
                        sums[k] += panel.own[k][l - k] * own[l];
                    }
                }
                let left = &mut self.1[panel.first..panel.first + W];
                left.iter_mut().zip(sums).for_each(|(l, sum)| *l = -sum);
            }
        }
        x.copy_from_slice(b);
        self.go(0..self.panels(rows), &mut Down(x));
        left[rows..].copy_from_slice(&x[rows..]);
        x[rows..].fill(0.0);
        self.go(0..self.panels(rows), &mut Left(x, left));
    }

    /// A sweep of Gauss and Seidel over the first `rows` of A x = b, from the last to the first;
    /// `b` is overwritten. The rows are all, or all but the last unknowns.
    pub(crate) fn sweep_up(&self, b: &mut [f64], rows: usize, x: &mut [f64]) {
        struct Known<'a>(&'a [f64], &'a mut [f64]);
        impl Pass for Known<'_> {
            fn panel<const W: usize>(&mut self, panel: &Panel<'_, W>) {
                let own = panel.of(self.0);
                for k in 0..W {
                    for l in k + 1..W {
                        self.1[panel.first + l] -= panel.own[k][l - k] * own[k];
                    }
                }
                panel.subtract(own, self.1);
            }
        }
        struct Up<'a>(&'a [f64], &'a mut [f64]);
        impl Pass for Up<'_> {
            fn panel<const W: usize>(&mut self, panel: &Panel<'_, W>) {
                let (mut own, sums) = (panel.of(self.0), panel.sums(self.1));
                for k in (0..W).rev() {
                    own[k] -= sums[k];
                    for l in k + 1..W {
                        own[k] -= panel.own[k][l - k] * own[l];
                    }
                    own[k] /= panel.own[k][0];
                }
                self.1[panel.first..panel.first + W].copy_from_slice(&own);
            }
        }
        self.go(0..self.panels(rows), &mut Known(x, b));
        self.go((0..self.panels(rows)).rev(), &mut Up(b, x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Nodes of three, two and one unknown, not all of them neighbours, and the same dense.
    fn sample(last: usize) -> (Matrix, DMatrix<f64>) {
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
        let mut matrix = Matrix::new(Pattern::new(start, rows), last);
        matrix.values_mut()[..values.len()].copy_from_slice(&values);
        (matrix, dense)
    }

    #[test]
    fn a_product_is_that_of_the_dense_matrix() {
        let (matrix, dense) = sample(0);
        assert!(matrix.panels.len() < 9, "{:?}", matrix.panels);
        let x = DVector::from_fn(12, |i, _| (i as f64).cos());
        let b = DVector::from_fn(12, |i, _| (i as f64).sin());
        let r = matrix.residual(x.as_slice(), b.as_slice());
        assert!((DVector::from_vec(r) - (b - dense * x)).norm() < 1e-13);
    }

    #[test]
    fn sweeps_are_those_of_gauss_and_seidel() {
        let b = DVector::from_fn(12, |i, _| 1.0 + (i as f64).sin());
        for last in [0, 3, 4, 5] {
            let (matrix, dense) = sample(last);
            let rows = 12 - last;
            let mut x = vec![0.0; 12];
            let mut left = vec![f64::NAN; 12];
            matrix.sweep_down(b.as_slice(), rows, &mut x, &mut left);
            let mut expected = DVector::zeros(12);
            for i in 0..rows {
                let others = (dense.row(i) * &expected)[0];
                expected[i] += (b[i] - others) / dense[(i, i)];
            }
            assert!((DVector::from_vec(x) - &expected).norm() < 1e-13);
            assert!((DVector::from_vec(left) - (&b - &dense * &expected)).norm() < 1e-12);
            // From anywhere, and what is not swept counts.
            let mut expected = DVector::from_fn(12, |i, _| 0.1 * i as f64);
            let mut x = expected.as_slice().to_vec();
            matrix.sweep_up(&mut b.as_slice().to_vec(), rows, &mut x);
            for i in (0..rows).rev() {
                let all = (dense.row(i) * &expected)[0];
                expected[i] += (b[i] - all) / dense[(i, i)];
            }
            assert!((DVector::from_vec(x) - expected).norm() < 1e-13);
        }
    }
}
