//! A single contact, solved exactly; no iteration over contacts.

use moreau_laws::{Coulomb, Local};
use nalgebra::SMatrix;

/// Force of a single contact u = W t + q with a positive definite W: opens if it may, else sticks if
/// the cone allows, else slips.
///
/// Slip −u_t = λ t_t leaves one scalar equation |t_t| = μ t_n in λ > 0. Its excess is positive at
/// λ = 0, where the contact would stick, and negative at λ = ∞, so that a safeguarded Newton
/// iteration on the reciprocals (as in the secular equation of trust regions) cannot fail. `guess`
/// is a force near the answer, from which λ starts.
pub(super) fn solve<const D: usize>(
    w: &SMatrix<f64, D, D>,
    q: &Local<D>,
    law: &Coulomb,
    guess: &Local<D>,
) -> Local<D> {
    let mut t = Local::zeros();
    if q[0] >= 0.0 {
        return t;
    }
    let mu = law.friction();
    let normal = 1.0 / w[(0, 0)];
    t[0] = -q[0] * normal;
    if mu == 0.0 {
        return t;
    }
    // Eliminate t_n from u_n = 0; what is left of W on the tangent is its Schur complement.
    let s = |k: usize, l: usize| w[(k, l)] - w[(k, 0)] * w[(0, l)] * normal;
    let b = |k: usize| w[(k, 0)] * q[0] * normal - q[k];
    if D == 2 {
        let (s, b) = (s(1, 1), b(1));
        let side = b.signum();
        let stick = b / s;
        let pressure = -(q[0] + w[(0, 1)] * stick) * normal;
        if s > 0.0 && stick.abs() <= mu * pressure {
            t[0] = pressure;
            t[1] = stick;
        } else {
            // On the edge t_t = ± μ t_n of the cone the equation u_n = 0 is linear.
            let stiffness = w[(0, 0)] + side * mu * w[(0, 1)];
            if stiffness > 0.0 {
                t[0] = -q[0] / stiffness;
                t[1] = side * mu * t[0];
            }
        }
        return t;
    }
    let (s11, s12, s21, s22) = (s(1, 1), s(1, 2), s(2, 1), s(2, 2));
    let (b1, b2) = (b(1), b(2));
    let trace = s11.abs() + s22.abs();
    // The force at λ, its excess |t_t| − μ t_n, and the derivatives of |t_t| and μ t_n.
    let at = |lambda: f64| {
        let (d1, d2) = (s11 + lambda, s22 + lambda);
        let det = d1 * d2 - s12 * s21;
        if det <= f64::EPSILON * trace * trace {
            return None;
        }
        let (x, y) = ((d2 * b1 - s12 * b2) / det, (d1 * b2 - s21 * b1) / det);
        let (dx, dy) = ((s12 * y - d2 * x) / det, (s21 * x - d1 * y) / det);
        let size = (x * x + y * y).sqrt();
        let pressure = -(q[0] + w[(0, 1)] * x + w[(0, 2)] * y) * normal;
        let d_size = if size > 0.0 {
            (x * dx + y * dy) / size
        } else {
            0.0
        };
        let d_pressure = -(w[(0, 1)] * dx + w[(0, 2)] * dy) * normal;
        Some((
            [pressure, x, y],
            size,
            mu * pressure,
            d_size,
            mu * d_pressure,
        ))
    };
    let place = |t: &mut Local<D>, [n, x, y]: [f64; 3]| {
        t[0] = n;
        t[1] = x;
        t[2] = y;
    };
    if let Some((stick, size, limit, ..)) = at(0.0)
        && size <= limit
    {
        place(&mut t, stick);
        return t;
    }
    let (mut low, mut high) = (0.0, f64::INFINITY);
    // λ of the force before: −u_t = λ t_t.
    let slip = |k: usize| b(k) - s(k, 1) * guess[1] - s(k, 2) * guess[2];
    let force = guess[1] * guess[1] + guess[2] * guess[2];
    let before = (slip(1) * guess[1] + slip(2) * guess[2]) / force;
    let mut lambda = if before > 0.0 && before.is_finite() {
        before
    } else {
        0.5 * trace
    };
    for _ in 0..100 {
        let Some((candidate, size, limit, d_size, d_limit)) = at(lambda) else {
            low = lambda;
            lambda = lambda.max(1e-8 * trace) * 4.0;
            continue;
        };
        place(&mut t, candidate);
        let excess = size - limit;
        if excess.abs() <= 8.0 * f64::EPSILON * size {
            break;
        }
        if excess > 0.0 {
            low = lambda;
        } else {
            high = lambda;
        }
        let slope = d_limit / (limit * limit) - d_size / (size * size);
        let newton = lambda - (1.0 / size - 1.0 / limit) / slope;
        lambda = if limit > 0.0 && slope > 0.0 && newton > low && newton < high {
            newton
        } else if high.is_finite() {
            // Between the bounds, far from both where they differ in size.
            if low > 0.0 {
                (low * high).sqrt()
            } else {
                0.1 * high
            }
        } else {
            4.0 * low
        };
        if lambda <= low || lambda >= high {
            break;
        }
    }
    // The root is found to rounding; the cone is met exactly.
    law.project(&t)
}

/// Force of a single contact under Tresca's friction: t_n ≥ 0, |t_t| ≤ g.
pub(super) fn tresca<const D: usize>(
    w: &SMatrix<f64, D, D>,
    q: &Local<D>,
    threshold: f64,
) -> Local<D> {
    // Open in normal direction, dragged all the same.
    let open = disc(w, &-q, threshold);
    let gap = q[0] + (1..D).map(|k| w[(0, k)] * open[k]).sum::<f64>();
    if gap >= 0.0 {
        return open;
    }
    // Closed: what is left of W on the tangent is its Schur complement.
    let normal = 1.0 / w[(0, 0)];
    let schur = SMatrix::from_fn(|k, l| w[(k, l)] - w[(k, 0)] * w[(0, l)] * normal);
    let b = Local::from_fn(|k, _| w[(k, 0)] * q[0] * normal - q[k]);
    let mut closed = disc(&schur, &b, threshold);
    let coupled = (1..D).map(|k| w[(0, k)] * closed[k]).sum::<f64>();
    closed[0] = (-(q[0] + coupled) * normal).max(0.0);
    closed
}

/// The tangential t of least ½ t·S t − b·t with |t| ≤ g; the normal component is zero.
fn disc<const D: usize>(s: &SMatrix<f64, D, D>, b: &Local<D>, radius: f64) -> Local<D> {
    let mut t = Local::zeros();
    if radius <= 0.0 {
        return t;
    }
    if D == 2 {
        t[1] = (b[1] / s[(1, 1)]).clamp(-radius, radius);
        return t;
    }
    // (S + λ) t = b: |t| falls and 1/|t| is concave in λ, so that Newton's method on
    // 1/|t| = 1/g rises to the root from below.
    let mut lambda = 0.0;
    for _ in 0..100 {
        let (d1, d2) = (s[(1, 1)] + lambda, s[(2, 2)] + lambda);
        let det = d1 * d2 - s[(1, 2)] * s[(2, 1)];
        t[1] = (d2 * b[1] - s[(1, 2)] * b[2]) / det;
        t[2] = (d1 * b[2] - s[(2, 1)] * b[1]) / det;
        let size = (t[1] * t[1] + t[2] * t[2]).sqrt();
        if size <= radius * (1.0 + 4.0 * f64::EPSILON) {
            break;
        }
        let (dx, dy) = (
            (s[(1, 2)] * t[2] - d2 * t[1]) / det,
            (s[(2, 1)] * t[1] - d1 * t[2]) / det,
        );
        let falls = -(t[1] * dx + t[2] * dy) / size;
        lambda += (size / radius - 1.0) * size / falls;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check<const D: usize>(entries: &[f64], mu: f64) -> Result<(), TestCaseError> {
        let a = SMatrix::<f64, D, D>::from_fn(|i, j| entries[3 * i + j]);
        let w = a * a.transpose() + SMatrix::identity() * 0.01;
        let q = Local::<D>::from_fn(|k, _| entries[9 + k]);
        let law = Coulomb::new(mu).expect("valid");
        let guess = Local::<D>::from_fn(|k, _| entries[12 + k]);
        for guess in [guess, Local::zeros()] {
            let t = solve(&w, &q, &law, &guess);
            let u = w * t + q;
            let map = law.natural_map(&u, &t, 1.0 / w.norm());
            prop_assert!(
                map.norm() <= 1e-11 * (1.0 + t.norm()),
                "{} at {t}",
                map.norm()
            );
        }
        Ok(())
    }

    fn check_tresca<const D: usize>(entries: &[f64], threshold: f64) -> Result<(), TestCaseError> {
        let a = SMatrix::<f64, D, D>::from_fn(|i, j| entries[3 * i + j]);
        let w = a * a.transpose() + SMatrix::identity() * 0.01;
        let q = Local::<D>::from_fn(|k, _| entries[9 + k]);
        let t = tresca(&w, &q, threshold);
        let u = w * t + q;
        let mut projected = t - u;
        projected[0] = projected[0].max(0.0);
        let size = projected.rows_range(1..).norm();
        if size > threshold {
            for k in 1..D {
                projected[k] *= threshold / size;
            }
        }
        prop_assert!(
            (t - projected).norm() <= 1e-11 * (1.0 + t.norm()),
            "{t} {u}"
        );
        Ok(())
    }

    proptest! {
        #[test]
        fn tresca_is_met_whatever_w_q_and_threshold(
            entries in prop::collection::vec(-1.0..1.0f64, 15), threshold in 0.0..3.0f64,
        ) {
            check_tresca::<2>(&entries, threshold)?;
            check_tresca::<3>(&entries, threshold)?;
        }

        #[test]
        fn the_law_is_met_whatever_w_q_and_friction(
            entries in prop::collection::vec(-1.0..1.0f64, 15), mu in 0.0..3.0f64,
        ) {
            check::<2>(&entries, mu)?;
            check::<3>(&entries, mu)?;
        }
    }
}
