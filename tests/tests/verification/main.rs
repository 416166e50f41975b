//! Verification: problems with known answers, from one contact to elastoplastic bodies; not the
//! unit tests of the crates.

mod bars;
mod blown;
mod bodies;
mod cattaneo;
mod contact_patch;
mod cook;
mod cylinder;
mod discrete;
mod energy;
mod faults;
mod greco;
mod hertz;
mod hole;
mod incline;
mod invariance;
mod large;
mod laws;
mod locking;
mod modes;
mod newton;
mod notch;
mod pad;
mod patch;
mod prandtl;
mod rates;
mod report;
mod slender;
mod sliders;
mod soils;
mod solids;
mod sphere;
mod strip;
mod transactions;
mod triangles;

/// Asserts |value − reference| ≤ tolerance · |reference|; NaN fails.
#[track_caller]
fn close(what: &str, value: f64, reference: f64, tolerance: f64) {
    assert!(
        (value - reference).abs() <= tolerance * reference.abs(),
        "{what}: {value} differs from {reference} by {:.3e}, more than {tolerance:e}",
        value / reference - 1.0
    );
}
