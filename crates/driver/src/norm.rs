//! The size of a vector.

/// Largest absolute value; infinite where there is a NaN.
pub(crate) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a, v| {
        if v.is_nan() {
            f64::INFINITY
        } else {
            a.max(v.abs())
        }
    })
}
