//! Least squares over directions that have been answered already, and new ones along what they leave; not
//! the operator.

use nalgebra::DVector;

/// Directions z with their answers W z, for all equations M x = b of which M follows from W.
#[derive(Debug, Clone, Default)]
pub(super) struct Recycled {
    pairs: Vec<(DVector<f64>, DVector<f64>)>,
}

/// Part of a direction left by those before it below which it is their sum.
const DEPENDENT: f64 = 1e-10;

impl Recycled {
    /// Adds a direction and its answer.
    pub(super) fn add(&mut self, z: DVector<f64>, answer: DVector<f64>) {
        self.pairs.push((z, answer));
    }

    pub(super) fn len(&self) -> usize {
        self.pairs.len()
    }

    /// A direction and its answer.
    pub(super) fn pair(&self, k: usize) -> &(DVector<f64>, DVector<f64>) {
        &self.pairs[k]
    }

    /// Σ y z and Σ y W z.
    pub(super) fn combined(&self, y: &[f64], size: usize) -> (DVector<f64>, DVector<f64>) {
        let mut sum = (DVector::zeros(size), DVector::zeros(size));
        for (&y, (z, answer)) in y.iter().zip(&self.pairs) {
            sum.0.axpy(y, z, 1.0);
            sum.1.axpy(y, answer, 1.0);
        }
        sum
    }

    /// Σ |y| |W z|, of the largest component of each.
    pub(super) fn size(&self, y: &[f64]) -> f64 {
        let pairs = y.iter().zip(&self.pairs);
        pairs.map(|(y, (_, answer))| y.abs() * answer.amax()).sum()
    }
}

/// The least |b − Σ y m| over images m, one after the other.
pub(super) struct LeastSquares {
    basis: Vec<DVector<f64>>,
    /// Columns of the triangular factor, the last entry the diagonal; empty of an image that is a sum of
    /// those before.
    columns: Vec<Vec<f64>>,
    coefficients: Vec<f64>,
    /// b − Σ y m.
    pub(super) left: DVector<f64>,
}

impl LeastSquares {
    pub(super) fn new(b: DVector<f64>) -> Self {
        Self {
            basis: Vec::new(),
            columns: Vec::new(),
            coefficients: Vec::new(),
            left: b,
        }
    }

    /// Takes in an image; whether it is independent of those before.
    pub(super) fn add(&mut self, mut image: DVector<f64>) -> bool {
        let before = image.norm();
        let mut column = vec![0.0; self.basis.len()];
        // Once more makes it orthogonal to rounding.
        for _ in 0..2 {
            for (q, c) in self.basis.iter().zip(&mut column) {
                let part = q.dot(&image);
                image.axpy(-part, q, 1.0);
                *c += part;
            }
        }
        let norm = image.norm();
        if norm <= DEPENDENT * before || !norm.is_finite() {
            self.columns.push(Vec::new());
            return false;
        }
        image /= norm;
        column.push(norm);
        let part = image.dot(&self.left);
        self.left.axpy(-part, &image, 1.0);
        self.coefficients.push(part);
        self.basis.push(image);
        self.columns.push(column);
        true
    }

    /// y, of all images taken in.
    pub(super) fn solution(&self) -> Vec<f64> {
        let mut y = vec![0.0; self.columns.len()];
        let mut c = self.coefficients.clone();
        for (k, column) in self.columns.iter().enumerate().rev() {
            if let Some((diagonal, above)) = column.split_last() {
                let value = c[above.len()] / diagonal;
                for (c, a) in c.iter_mut().zip(above) {
                    *c -= a * value;
                }
                y[k] = value;
            }
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    #[test]
    fn what_is_left_is_least_and_dependent_images_do_no_harm() {
        let images = DMatrix::from_fn(9, 4, |i, j| ((3 * i * j + i + 5 * j) as f64).sin());
        let b = DVector::from_fn(9, |i, _| (i as f64).cos());
        let mut least = LeastSquares::new(b.clone());
        for j in [0, 1, 0, 2, 3] {
            let image = images.column(j).into_owned();
            assert_eq!(least.add(image), !(j == 0 && least.columns.len() > 1));
        }
        let y = least.solution();
        assert_eq!(y[2], 0.0);
        let y = DVector::from_row_slice(&[y[0], y[1], y[3], y[4]]);
        assert!((&b - &images * &y - &least.left).norm() < 1e-13);
        assert!((images.transpose() * &least.left).norm() < 1e-13);
    }
}
