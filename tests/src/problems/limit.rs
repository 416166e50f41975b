//! Load against displacement up to collapse; not the exact limit loads.

use super::Fallible;
use moreau::driver::{Driver, Step};

/// Load after every increment of a displacement-controlled step.
///
/// # Errors
/// Those of [`Driver::run`].
pub fn load_curve<const D: usize>(
    driver: &mut Driver<D>,
    step: &Step<D>,
    increments: usize,
    load: impl Fn(&Driver<D>) -> f64,
) -> Fallible<Vec<f64>> {
    let mut curve = Vec::new();
    driver.run(step, increments, |driver, _| curve.push(load(driver)))?;
    Ok(curve)
}

/// Slope of the last fifth of a curve of equal increments, over that of its first increment: next
/// to zero on a plateau, not if the mesh locks.
pub fn final_slope(curve: &[f64]) -> f64 {
    let n = curve.len();
    let part = (n / 5).max(1);
    (curve[n - 1] - curve[n - 1 - part]) / (part as f64 * curve[0])
}
