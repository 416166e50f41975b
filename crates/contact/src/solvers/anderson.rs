//! Anderson's extrapolation of a fixed-point iteration; it knows nothing of contact.

use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// Differences of earlier iterates that are kept. Near a limit load, 40 contacts take up to twenty
/// times as many iterations with 20.
const MEMORY: usize = 50;

/// How much a residual may exceed what the map makes at most of the best so far, before the extrapolation is forgotten.
const EXCESS: f64 = 10.0;

/// Extrapolates x ← T(x): the combination of the last iterates whose residual T(x) − x is least
/// (D. G. Anderson, J. ACM 12, 1965). On a map that is piecewise affine, such as a projection with
/// its statuses settled, it converges like a Krylov method.
#[derive(Debug, Default)]
pub struct Anderson {
    /// Differences of iterates' images and of their residuals, oldest first.
    images: VecDeque<DVector<f64>>,
    residuals: VecDeque<DVector<f64>>,
    /// Largest length of an image's difference over that of the iterates', since the last restart; zero before one is known.
    gain: f64,
    last: Option<(DVector<f64>, DVector<f64>)>,
    /// Image with the smallest residual since the last restart, and that residual.
    best: Option<(DVector<f64>, f64)>,
}

impl Anderson {
    /// The next iterate, from an iterate and its image under T.
    pub fn next(&mut self, x: &DVector<f64>, image: DVector<f64>) -> DVector<f64> {
        let residual = &image - x;
        let size = residual.norm();
        match &self.best {
            Some((safe, best)) if self.strays(size, *best) => {
                // The map has changed its branch: what was learnt is worth nothing.
                let safe = safe.clone();
                *self = Self::default();
                return safe;
            }
            Some((_, best)) if size >= *best => {}
            _ => self.best = Some((image.clone(), size)),
        }
        if let Some((last_image, last_residual)) = &self.last {
            let (of_image, of_residual) = (&image - last_image, &residual - last_residual);
            let moved = (&of_image - &of_residual).norm();
            if moved > 0.0 {
                self.gain = self.gain.max(of_image.norm() / moved);
            }
            self.images.push_back(of_image);
            self.residuals.push_back(of_residual);
            if self.images.len() > MEMORY.min(image.len()) {
                self.images.pop_front();
                self.residuals.pop_front();
            }
        }
        let mut next = image.clone();
        if let Some(weights) = self.weights(&residual) {
            for (w, d) in weights.iter().zip(&self.images) {
                next.axpy(-w, d, 1.0);
            }
        }
        self.last = Some((image, residual));
        next
    }

    /// Whether a residual is none of the branch that was extrapolated. An extrapolated iterate is the image of one whose residual
    /// is no larger than the best, so that on the same branch its own is at most that times the gain of the map. One that grows
    /// before anything was extrapolated tells of a map that expands, and the difference is what there is to learn of it.
    fn strays(&self, size: f64, best: f64) -> bool {
        !size.is_finite() || size > EXCESS * self.gain.max(1.0) * best && !self.images.is_empty()
    }

    /// Least-squares weights of the differences; `None` without differences or without rank.
    fn weights(&mut self, residual: &DVector<f64>) -> Option<DVector<f64>> {
        while !self.residuals.is_empty() {
            let columns: Vec<DVector<f64>> = self.residuals.iter().cloned().collect();
            let qr = DMatrix::from_columns(&columns).qr();
            let r = qr.r();
            let diagonal = r.diagonal();
            // Old differences become dependent on new ones near the solution.
            if diagonal.iter().all(|d| d.abs() > 1e-10 * diagonal.amax()) {
                let projected = qr.q().tr_mul(residual);
                return r.solve_upper_triangular(&projected);
            }
            self.residuals.pop_front();
            self.images.pop_front();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_map_is_solved_in_as_many_steps_as_unknowns() {
        let n = 12;
        let a = DMatrix::from_fn(n, n, |i, j| {
            let coupling = 0.02 * ((i * 5 + j * 3) as f64).sin();
            if i == j {
                0.999 - 0.04 * i as f64
            } else {
                coupling
            }
        });
        let b = DVector::from_fn(n, |i, _| 1.0 + i as f64);
        let exact = (DMatrix::identity(n, n) - &a)
            .lu()
            .solve(&b)
            .expect("regular");
        let mut anderson = Anderson::default();
        let mut x = DVector::zeros(n);
        for _ in 0..n + 6 {
            let image = &a * &x + &b;
            x = anderson.next(&x, image);
        }
        assert!(
            (&x - &exact).norm() < 1e-8 * exact.norm(),
            "{}",
            (x - &exact).norm()
        );
    }

    /// Where a step of the plain iteration multiplies the error by hundreds in some directions, the next ones tell which.
    #[test]
    fn a_map_that_expands_in_some_directions_is_solved_as_one_that_contracts() {
        for gains in [
            [-250.0, 0.1, 0.1, 0.5],
            [-250.0, 80.0, 0.1, 0.5],
            [300.0, -60.0, 20.0, 0.5],
        ] {
            let gains = DVector::from_row_slice(&gains);
            let exact = DVector::from_vec(vec![1.0, -2.0, 3.0, 0.5]);
            let mut anderson = Anderson::default();
            let mut x = DVector::zeros(4);
            for _ in 0..6 {
                let image = &exact + gains.component_mul(&(&x - &exact));
                x = anderson.next(&x, image);
            }
            assert!((&x - &exact).norm() < 1e-8, "{gains} {x}");
        }
    }
}
