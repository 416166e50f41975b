//! Vectors and statuses of a contact point in its own frame; not the frame itself.

use nalgebra::SVector;

/// A vector in the frame of a contact: component 0 along the normal n, from the obstacle
/// Ω_A into the body Ω_B, the rest tangential, \[10\].
///
/// Displacements u \[mm\] open the contact when u_n > 0; forces t \[N\] compress it when t_n > 0;
/// the flux conjugate to t is −u.
pub type Local<const D: usize> = SVector<f64, D>;

/// The three statuses of unilateral contact with friction, \[35\].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// No force.
    Open,
    /// Closed, without slip.
    Stick,
    /// Closed, with slip.
    Slip,
}

/// ‖v_t‖, safe from overflow and underflow.
#[inline]
pub(crate) fn tangential_norm<const D: usize>(v: &Local<D>) -> f64 {
    v.iter().skip(1).fold(0.0, |norm: f64, &c| norm.hypot(c))
}

/// v_t, as a vector without normal component.
#[inline]
pub(crate) fn tangential<const D: usize>(v: &Local<D>) -> Local<D> {
    let mut tangential = *v;
    tangential[0] = 0.0;
    tangential
}

/// v_t/‖v_t‖, zero where v_t = 0.
#[inline]
pub(crate) fn direction<const D: usize>(v: &Local<D>) -> Local<D> {
    let norm = tangential_norm(v);
    if norm == 0.0 {
        Local::zeros()
    } else {
        tangential(v) / norm
    }
}
