//! Random vectors and tensors; not checks.

use moreau_laws::Local;
use moreau_mandel::{Sym2, deviator, identity};
use nalgebra::SVector;
use proptest::prelude::*;

/// A vector of components in [−size, size].
pub(crate) fn vector<const N: usize>(size: f64) -> BoxedStrategy<SVector<f64, N>> {
    prop::array::uniform::<_, N>(-size..size)
        .prop_map(SVector::from)
        .boxed()
}

/// A unit vector.
pub(crate) fn unit<const N: usize>() -> BoxedStrategy<SVector<f64, N>> {
    vector::<N>(1.0)
        .prop_map(|v| (v + v.map(|c| 0.1f64.copysign(c))).normalize())
        .boxed()
}

/// A unit vector without normal component.
pub(crate) fn unit_tangent<const D: usize>() -> BoxedStrategy<Local<D>> {
    unit::<D>()
        .prop_map(|v| {
            let mut v = v;
            v[0] = 0.0;
            v.normalize()
        })
        .boxed()
}

/// A deviator of unit norm.
pub(crate) fn unit_deviator() -> BoxedStrategy<Sym2> {
    // The last component keeps the deviator away from zero.
    unit::<6>()
        .prop_map(|v| deviator(&deviator(&v).normalize()))
        .boxed()
}

/// A deviator of components up to about `size`.
pub(crate) fn any_deviator(size: f64) -> BoxedStrategy<Sym2> {
    vector::<6>(size).prop_map(|v| deviator(&v)).boxed()
}

/// The unit normal of a contact.
pub(crate) fn normal<const D: usize>() -> Local<D> {
    let mut normal = Local::zeros();
    normal[0] = 1.0;
    normal
}

/// A pressure, a multiple of δ.
pub(crate) fn spherical(mean: f64) -> Sym2 {
    mean * identity()
}
