//! Samples of the contract, the same in every run; not for statistics.

use moreau_mandel::{Sym2, rotation};
use nalgebra::{Rotation3, SVector, Vector3};

/// Pseudo-random numbers.
///
/// Source: G. L. Steele, D. Lea and C. H. Flood, *ACM SIGPLAN Notices* 49 (2014) 453-472, SplitMix.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new() -> Self {
        Self(0)
    }

    /// In [0, 1[.
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// One of 0..count.
    pub(super) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Components in [−size, size[.
    pub(super) fn vector<const N: usize>(&mut self, size: f64) -> SVector<f64, N> {
        SVector::from_fn(|_, _| self.between(-size, size))
    }

    /// Of unit length, and no component far below the others.
    pub(super) fn direction<const N: usize>(&mut self) -> SVector<f64, N> {
        let v = self.vector::<N>(1.0);
        (v + v.map(|c| 0.1f64.copysign(c))).normalize()
    }

    /// The map of tensors under a rotation of the axes.
    pub(super) fn rotation(&mut self) -> impl Fn(&Sym2) -> Sym2 + use<> {
        let axis: Vector3<f64> = self.vector(3.0);
        let r = rotation(&Rotation3::new(axis).into_inner());
        move |a| r * a
    }
}
