//! Load against displacement up to collapse; not the exact limit loads.

use super::Fallible;
use moreau::driver::{Axis, Collapse, Driver, IncrementError, Step};

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

/// The collapse that a step of growing loads ends in.
///
/// # Errors
/// Those of [`Driver::run`] but [`IncrementError::Collapse`], and the end of the step.
pub fn collapse_of<const D: usize>(
    driver: &mut Driver<D>,
    step: &Step<D>,
    increments: usize,
) -> Fallible<Collapse> {
    match driver.run(step, increments, |_, _| {}) {
        Err(IncrementError::Collapse { collapse, .. }) => Ok(collapse),
        Err(error) => Err(error.into()),
        Ok(_) => Err(format!("step {:?} was carried", step.name()).into()),
    }
}

/// Load along y of a group that is moved along y, in a virgin body of the same kind, to where it is
/// after collapse: evenly at first, then each increment as long as all before it.
///
/// # Errors
/// Those of [`Driver::run`].
pub fn load_at(
    collapsed: &Driver<2>,
    moved: &mut Driver<2>,
    group: &str,
    supports: impl Fn(&str) -> Step<2>,
) -> Fallible<f64> {
    let nodes = collapsed.mesh().node_group(group)?;
    let sum: f64 = nodes.iter().map(|&n| collapsed.displacement(n)[1]).sum();
    for k in (0..10).rev() {
        let travel = sum / nodes.len() as f64 * 0.5f64.powi(k);
        let step = supports("move").displace(group, Axis::Y, travel);
        moved.run(&step, if k == 9 { 20 } else { 1 }, |_, _| {})?;
    }
    Ok(moved.reaction(group)?[1])
}

/// Slope of the last fifth of a curve of equal increments, over that of its first increment: next
/// to zero on a plateau, not if the mesh locks.
pub fn final_slope(curve: &[f64]) -> f64 {
    let n = curve.len();
    let part = (n / 5).max(1);
    (curve[n - 1] - curve[n - 1 - part]) / (part as f64 * curve[0])
}
