//! Vectors and statuses of a contact point in its own frame; not the frame itself.

use nalgebra::SVector;

/// A vector in the frame of a contact: component 0 along the normal n, from the obstacle
/// Ω_A into the body Ω_B, the rest tangential, \[10\].
///
/// Displacements u \[mm\] open the contact when u_n > 0; forces t \[N\] compress it when t_n > 0;
/// the flux conjugate to t is −u.
pub type Local<const D: usize> = SVector<f64, D>;

/// The three statuses of unilateral contact with friction, \[35\], and the one of a tie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Status {
    /// No force.
    Open,
    /// Closed, without slip.
    Stick,
    /// Closed, with slip.
    Slip,
    /// Held together, whatever the force.
    Tied,
}

/// ‖v_t‖, safe from overflow and underflow.
#[inline]
pub(crate) fn tangential_norm<const D: usize>(v: &Local<D>) -> f64 {
    match D {
        3 => hypotenuse(v[1], v[2]),
        _ => v.iter().skip(1).fold(0.0, |norm, &c| hypotenuse(norm, c)),
    }
}

/// √(a² + b²), by the careful function of the library only where squares overflow or vanish: it is
/// several times slower.
#[inline]
pub(crate) fn hypotenuse(a: f64, b: f64) -> f64 {
    let square = a * a + b * b;
    if (1e-290..1e290).contains(&square) {
        square.sqrt()
    } else {
        a.hypot(b)
    }
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
