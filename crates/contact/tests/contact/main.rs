//! The methods for contact problems as who uses them sees them: known answers, one against the other, and what they refuse.

mod methods;
mod refused;
mod soft;
mod solvers;
mod tied;

use moreau_laws::Local;
use nalgebra::DVector;

/// Vectors of the contacts one after the other.
fn stack<const D: usize>(vectors: &[Local<D>]) -> DVector<f64> {
    let components = vectors.iter().flatten().copied();
    DVector::from_iterator(D * vectors.len(), components)
}
