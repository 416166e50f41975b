//! The directions in which a point is free to move; not what holds it in the others.

use crate::vector::directions::Directions;
use nalgebra::{SMatrix, SVector};

/// Part of a unit vector across others below which it is one of their combinations.
pub(crate) const PARALLEL: f64 = 1e-6;

/// The span of some vectors of an orthonormal basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Subspace<const D: usize> {
    /// In columns.
    pub(crate) basis: SMatrix<f64, D, D>,
    /// Which of them count.
    pub(crate) within: [bool; D],
}

impl<const D: usize> Subspace<D> {
    /// All of space.
    pub(crate) fn all() -> Self {
        Self {
            basis: SMatrix::identity(),
            within: [true; D],
        }
    }

    /// Where a node can move whose components are free or not.
    pub(crate) fn of_node(
        node: usize,
        directions: &Directions,
        is_free: impl Fn(usize) -> bool,
    ) -> Self {
        let mut own = Self::all();
        for k in 0..D {
            let dof = D * node + k;
            own.within[k] = is_free(dof);
            if directions.is_turned(dof) {
                own.basis.set_column(k, &directions.along::<D>(dof));
            }
        }
        own
    }

    /// The span of unit vectors: the first vector of the basis is the first of them, the others are what is left of
    /// them across those before, and of the axes.
    pub(crate) fn spanned(vectors: &[SVector<f64, D>]) -> Self {
        let mut basis = SMatrix::<f64, D, D>::zeros();
        let mut count = 0;
        let across = |basis: &SMatrix<f64, D, D>, count: usize, mut v: SVector<f64, D>| {
            for k in 0..count {
                let q = basis.column(k).into_owned();
                v -= q * q.dot(&v);
            }
            v
        };
        for v in vectors {
            let left = across(&basis, count, *v);
            if left.norm() > PARALLEL && count < D {
                // Once more, so that what little may be left of it is across to rounding.
                let left = across(&basis, count, left.normalize());
                basis.set_column(count, &left.normalize());
                count += 1;
            }
        }
        let within = std::array::from_fn(|k| k < count);
        for k in count..D {
            let axes = (0..D).map(|i| SVector::from_fn(|j, _| f64::from(u8::from(i == j))));
            let most = axes
                .map(|e| across(&basis, k, e))
                .max_by(|a, b| a.norm().total_cmp(&b.norm()));
            let most = most.unwrap_or_else(SVector::zeros).normalize();
            basis.set_column(k, &across(&basis, k, most).normalize());
        }
        Self { basis, within }
    }

    /// Whether it has nothing across a unit vector.
    pub(crate) fn is_along(&self, n: &SVector<f64, D>) -> bool {
        self.vectors()
            .all(|v| (v - n * n.dot(&v)).norm() < PARALLEL)
    }

    /// Whether another has all of it.
    pub(crate) fn is_within(&self, other: &Self) -> bool {
        self.vectors()
            .all(|v| (v - other.part(&v)).norm() < PARALLEL)
    }

    pub(crate) fn dimension(&self) -> usize {
        self.within.iter().filter(|w| **w).count()
    }

    /// Its vectors of the basis.
    pub(crate) fn vectors(&self) -> impl Iterator<Item = SVector<f64, D>> {
        let own = (0..D).filter(|&k| self.within[k]);
        own.map(|k| self.basis.column(k).into_owned())
    }

    /// What is across all of it.
    pub(crate) fn complement(&self) -> Self {
        Self {
            within: self.within.map(|within| !within),
            ..*self
        }
    }

    /// The part of a vector in it.
    pub(crate) fn part(&self, v: &SVector<f64, D>) -> SVector<f64, D> {
        let beside = self.complement();
        let beside = beside.vectors().map(|q| q * q.dot(v));
        beside.fold(*v, |left, out| left - out)
    }

    /// The sums of vectors of both.
    pub(crate) fn with(&self, other: &Self) -> Self {
        if other.dimension() == 0 {
            return *self;
        }
        if self.basis == other.basis {
            return Self {
                within: std::array::from_fn(|k| self.within[k] || other.within[k]),
                ..*self
            };
        }
        let both: Vec<_> = self.vectors().chain(other.vectors()).collect();
        Self::spanned(&both)
    }

    /// What is in both.
    pub(crate) fn common(&self, other: &Self) -> Self {
        self.complement().with(&other.complement()).complement()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type V = SVector<f64, 3>;

    #[test]
    fn two_planes_have_a_line_in_common_and_span_space() {
        let (m, n) = (V::new(1.0, 2.0, -1.0).normalize(), V::new(0.0, 0.6, 0.8));
        let [a, b] = [m, n].map(|n| Subspace::spanned(&[n]).complement());
        let q = a.basis;
        assert!((q.transpose() * q - SMatrix::identity()).amax() < 1e-15);
        assert!((a.part(&m)).norm() < 1e-15 && (a.part(&n) - (n - m * m.dot(&n))).norm() < 1e-15);
        let line = a.common(&b);
        assert_eq!(line.dimension(), 1);
        let along = line.vectors().next().expect("a line");
        assert!((along.dot(&m.cross(&n).normalize()).abs() - 1.0).abs() < 1e-15);
        assert_eq!(a.with(&b).dimension(), 3);
        assert_eq!(a.with(&a), a);
        assert_eq!(a.common(&a.complement()).dimension(), 0);
    }

    #[test]
    fn what_is_nearly_parallel_is_the_same() {
        let n = V::new(1.0, 1e-8, 0.0).normalize();
        assert_eq!(Subspace::spanned(&[V::x(), n]).dimension(), 1);
        let n = V::new(1.0, 1e-4, 0.0).normalize();
        let plane = Subspace::spanned(&[V::x(), n]);
        assert_eq!(plane.dimension(), 2);
        assert!((plane.basis.determinant().abs() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn coordinate_subspaces_stay_such() {
        let none = Directions::default();
        let [a, b] =
            [1usize, 2].map(|held| Subspace::<3>::of_node(4, &none, |dof| dof != 12 + held));
        assert_eq!(a.with(&b), Subspace::all());
        assert_eq!(a.common(&b).within, [true, false, false]);
        let v = V::new(0.3, -0.2, 0.7);
        assert_eq!(a.part(&v), V::new(0.3, 0.0, 0.7));
    }
}
