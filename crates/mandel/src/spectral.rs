//! Functions of symmetric tensors by their principal values, and the derivative of the logarithm; not of
//! tensors without symmetry.

use nalgebra::Matrix3;

/// Principal values and directions of a symmetric tensor a = Σ aᵢ qᵢ ⊗ qᵢ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// Principal values aᵢ, in no order.
    pub values: [f64; 3],
    /// Principal directions qᵢ, orthonormal, in columns.
    pub directions: Matrix3<f64>,
}

/// Sweeps after which Jacobi's method has converged; it does so quadratically, in four or five.
const SWEEPS: usize = 12;

impl Spectrum {
    /// Of a symmetric tensor, of which the upper triangle counts, by Jacobi's rotations: to rounding of its
    /// largest component whether principal values are apart or coincide, and without a rotation in planes
    /// that have no shear. Not a number where a component is none.
    pub fn new(a: &Matrix3<f64>) -> Self {
        let mut a = *a;
        let mut directions = Matrix3::identity();
        let rounding = 0.25 * f64::EPSILON * f64::EPSILON * a.amax();
        for _ in 0..SWEEPS {
            let mut diagonal = true;
            for (p, q) in [(0, 1), (0, 2), (1, 2)] {
                let shear = a[(p, q)];
                if shear.abs() <= rounding {
                    continue;
                }
                diagonal = false;
                let theta = (a[(q, q)] - a[(p, p)]) / (2.0 * shear);
                // Far below where squares overflow: shears that are rounding are left.
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                a[(p, p)] -= t * shear;
                a[(q, q)] += t * shear;
                a[(p, q)] = 0.0;
                let r = 3 - p - q;
                let (rp, rq) = ((r.min(p), r.max(p)), (r.min(q), r.max(q)));
                (a[rp], a[rq]) = (c * a[rp] - s * a[rq], s * a[rp] + c * a[rq]);
                for k in 0..3 {
                    let (x, y) = (directions[(k, p)], directions[(k, q)]);
                    (directions[(k, p)], directions[(k, q)]) = (c * x - s * y, s * x + c * y);
                }
            }
            if diagonal {
                break;
            }
        }
        Self {
            values: [a[(0, 0)], a[(1, 1)], a[(2, 2)]],
            directions,
        }
    }

    /// Σ f(aᵢ) qᵢ ⊗ qᵢ, symmetric to the bit.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Matrix3<f64> {
        let mut sum = Matrix3::zeros();
        for (k, &value) in self.values.iter().enumerate() {
            let (f, q) = (f(value), self.directions.column(k));
            for i in 0..3 {
                for j in i..3 {
                    sum[(i, j)] += f * q[i] * q[j];
                }
            }
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            sum[(j, i)] = sum[(i, j)];
        }
        sum
    }
}

/// (ln x − ln y)/(x − y) of positive numbers, 1/x where they coincide: without loss where they nearly do.
pub fn logarithmic_slope(x: f64, y: f64) -> f64 {
    let relative = (x - y) / y;
    match relative == 0.0 {
        true => 1.0 / y,
        false => relative.ln_1p() / relative / y,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, Vector3};
    use proptest::prelude::*;

    fn directions() -> impl Strategy<Value = Matrix3<f64>> {
        prop::array::uniform3(-3.0..3.0f64)
            .prop_map(|a| Rotation3::new(Vector3::from(a)).into_inner())
    }

    /// Principal values that are apart, close, equal, and of all sizes.
    fn values() -> impl Strategy<Value = [f64; 3]> {
        let gap = prop_oneof![Just(0.0), -1e-14..1e-14, -1e-6..1e-6, -1.0..1.0];
        let size = prop_oneof![Just(1.0), Just(1e-12), Just(1e9)];
        (-1.0..1.0f64, gap.clone(), gap, size)
            .prop_map(|(a, d, e, size)| [a, a + d, a + e].map(|v| size * v))
    }

    proptest! {
        #[test]
        fn a_tensor_is_made_of_its_principal_values(values in values(), q in directions()) {
            let a = q * Matrix3::from_diagonal(&Vector3::from(values)) * q.transpose();
            let a = 0.5 * (a + a.transpose());
            let spectrum = Spectrum::new(&a);
            let size = a.amax();
            // Each of some dozen rotations rounds: most where rounding alone tells the directions.
            prop_assert!((spectrum.map(|x| x) - a).amax() <= 2e-14 * size);
            let q = spectrum.directions;
            prop_assert!((q.transpose() * q - Matrix3::identity()).amax() <= 2e-14);
            let mut found = spectrum.values;
            let mut given = values;
            found.sort_by(f64::total_cmp);
            given.sort_by(f64::total_cmp);
            for (a, b) in found.iter().zip(given) {
                prop_assert!((a - b).abs() <= 2e-14 * size, "{a} {b}");
            }
        }

        #[test]
        fn the_slope_of_the_logarithm_loses_nothing(y in 1e-3..1e3f64, ratio in values()) {
            let x = y * (1.0 + 0.5 * ratio[0].clamp(-1.0, 1.0));
            let slope = logarithmic_slope(x, y);
            prop_assert!((slope - logarithmic_slope(y, x)).abs() <= 4e-16 * 4.0 * slope);
            prop_assert!(slope <= 1.0 / x.min(y) * (1.0 + 1e-15));
            prop_assert!(slope >= 1.0 / x.max(y) * (1.0 - 1e-15));
            if (x / y - 1.0).abs() > 1e-3 {
                prop_assert!((slope * (x - y) - (x.ln() - y.ln())).abs() <= 1e-13 * (1.0 + y.ln().abs()));
            }
        }
    }

    #[test]
    fn what_is_no_number_gives_none() {
        let mut a = Matrix3::identity();
        a[(0, 1)] = f64::NAN;
        assert!(Spectrum::new(&a).values.iter().any(|v| v.is_nan()));
    }
}
