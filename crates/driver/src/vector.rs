//! Vectors over the degrees of freedom: those that are zero nearly everywhere, and their size; not matrices.

pub(crate) mod directions;
pub(crate) mod prescribed;
pub(crate) mod subspace;

use std::collections::BTreeMap;

/// A combination of unknowns: coefficients by number, ascending.
pub(crate) type Combination = Vec<(usize, f64)>;

/// Loads, contact forces, prescribed motions: a number at some degrees of freedom, zero at the
/// others.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SparseVector(BTreeMap<usize, f64>);

impl SparseVector {
    /// The number at a degree of freedom.
    pub fn at(&self, dof: usize) -> f64 {
        self.0.get(&dof).copied().unwrap_or(0.0)
    }

    /// The numbers at the degrees of freedom of a node, `D·node` and those that follow.
    pub(crate) fn at_node<const D: usize>(&self, node: usize) -> [f64; D] {
        std::array::from_fn(|i| self.at(D * node + i))
    }

    /// Adds at a degree of freedom; zero is not kept.
    pub fn add(&mut self, dof: usize, value: f64) {
        if value != 0.0 {
            *self.0.entry(dof).or_insert(0.0) += value;
        }
    }

    /// What is kept, by ascending degrees of freedom.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (usize, f64)> {
        self.0.iter().map(|(&dof, &value)| (dof, value))
    }

    /// The last degree of freedom of which something is kept.
    pub(crate) fn last(&self) -> Option<usize> {
        self.0.last_key_value().map(|(&dof, _)| dof)
    }

    /// Whether all is zero.
    pub(crate) fn is_zero(&self) -> bool {
        self.0.values().all(|&value| value == 0.0)
    }

    /// Σ a_d v_d with a vector of all degrees of freedom.
    pub(crate) fn dot(&self, v: &[f64]) -> f64 {
        self.iter().map(|(dof, value)| value * v[dof]).sum()
    }

    /// Σ a_d b_d.
    pub(crate) fn inner(&self, b: &Self) -> f64 {
        self.iter().map(|(dof, value)| value * b.at(dof)).sum()
    }

    /// Adds a multiple to a vector of all degrees of freedom.
    pub(crate) fn add_to(&self, v: &mut [f64], factor: f64) {
        for (dof, value) in self.iter() {
            v[dof] += factor * value;
        }
    }

    /// A multiple.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self(self.iter().map(|(dof, v)| (dof, factor * v)).collect())
    }

    /// What a function makes of the numbers of both, degree of freedom by degree of freedom; of zeros
    /// it makes zero.
    pub(crate) fn with(&self, b: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self.0.clone();
        for &dof in b.0.keys() {
            out.entry(dof).or_insert(0.0);
        }
        for (&dof, value) in &mut out {
            *value = f(*value, b.at(dof));
        }
        Self(out)
    }
}

impl IntoIterator for SparseVector {
    type Item = (usize, f64);
    type IntoIter = std::collections::btree_map::IntoIter<usize, f64>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl FromIterator<(usize, f64)> for SparseVector {
    fn from_iter<I: IntoIterator<Item = (usize, f64)>>(pairs: I) -> Self {
        Self(pairs.into_iter().collect())
    }
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn dense(a: &SparseVector) -> Vec<f64> {
        let mut v = vec![0.0; 12];
        a.add_to(&mut v, 1.0);
        v
    }

    fn some() -> impl Strategy<Value = SparseVector> {
        prop::collection::vec((0usize..12, -1.0..1.0f64), 0..9).prop_map(|pairs| {
            let mut sum = SparseVector::default();
            pairs.into_iter().for_each(|(dof, v)| sum.add(dof, v));
            sum
        })
    }

    proptest! {
        #[test]
        fn what_is_done_is_what_is_done_to_all(a in some(), b in some(), s in -2.0..2.0f64) {
            let (x, y) = (dense(&a), dense(&b));
            let sum = |f: &dyn Fn(usize) -> f64| (0..12).map(f).sum::<f64>();
            prop_assert!((a.dot(&y) - sum(&|k| x[k] * y[k])).abs() < 1e-14);
            prop_assert!((a.inner(&b) - a.dot(&y)).abs() < 1e-14);
            let both = dense(&a.with(&b, |a, b| a - s * b));
            let scaled = dense(&a.scaled(s));
            let [p, q] = a.at_node::<2>(3);
            prop_assert_eq!((p, q), (x[6], x[7]));
            for k in 0..12 {
                prop_assert_eq!(a.at(k), x[k]);
                prop_assert_eq!(both[k], x[k] - s * y[k]);
                prop_assert_eq!(scaled[k], s * x[k]);
            }
            prop_assert_eq!(a.is_zero(), x.iter().all(|&x| x == 0.0));
            prop_assert!(a.with(&a, |a, b| a - b).is_zero());
        }
    }
}
