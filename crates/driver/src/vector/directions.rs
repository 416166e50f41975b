//! Along which directions nodes have the components of their displacements; not which of these are prescribed.

use crate::vector::SparseVector;
use nalgebra::{SMatrix, SVector};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Directions of the components of displacements: those of a node are the axes, unless other ones are given it, as many
/// and orthonormal. Component `D·node + k` of a displacement u is then u·n, with n the k-th of them.
///
/// Vectors over the degrees of freedom have their entries along the axes. What is along directions is the unknowns of a
/// linear system, and what is prescribed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Directions(BTreeMap<usize, Vec<f64>>);

impl Directions {
    /// Gives a node directions of its own, the columns of a matrix.
    pub(crate) fn turn<const D: usize>(&mut self, node: usize, columns: &SMatrix<f64, D, D>) {
        let direction = |k: usize| columns.column(k).iter().copied().collect();
        self.0.extend((0..D).map(|k| (D * node + k, direction(k))));
    }

    /// Whether the node of a degree of freedom has directions of its own.
    pub fn is_turned(&self, dof: usize) -> bool {
        self.0.contains_key(&dof)
    }

    /// The direction of a component.
    pub fn along<const D: usize>(&self, dof: usize) -> SVector<f64, D> {
        let n = self.0.get(&dof);
        SVector::from_fn(|i, _| n.map_or(f64::from(u8::from(i == dof % D)), |n| n[i]))
    }

    /// A component of a vector, of which `at` is the entry at a degree of freedom.
    pub(crate) fn component(&self, dof: usize, at: impl Fn(usize) -> f64) -> f64 {
        match self.0.get(&dof) {
            None => at(dof),
            Some(n) => {
                let first = dof - dof % n.len();
                n.iter().zip(first..).map(|(c, j)| c * at(j)).sum()
            }
        }
    }

    /// The entries of a unit vector along a component.
    pub(crate) fn entries(&self, dof: usize) -> impl Iterator<Item = (usize, f64)> {
        let n = self.0.get(&dof).map_or(&[1.0][..], Vec::as_slice);
        (dof - dof % n.len()..).zip(n.iter().copied())
    }

    /// The components of a unit vector along the axis of a degree of freedom.
    pub(crate) fn parts(&self, dof: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        let count = self.0.get(&dof).map_or(1, Vec::len);
        let first = dof - dof % count;
        let part = move |k: usize| self.0.get(&k).map_or(1.0, |n| n[dof - first]);
        (first..first + count).map(move |k| (k, part(k)))
    }

    /// Gives a component of a vector another value; the other components of its node stay.
    pub(crate) fn set(&self, dof: usize, value: f64, v: &mut [f64]) {
        if !self.is_turned(dof) {
            v[dof] = value;
            return;
        }
        let missing = value - self.component(dof, |j| v[j]);
        self.entries(dof).for_each(|(j, c)| v[j] += c * missing);
    }

    /// A vector by its components in place of its entries.
    pub(crate) fn components<'a>(&self, v: &'a SparseVector) -> Cow<'a, SparseVector> {
        if self.0.is_empty() {
            return Cow::Borrowed(v);
        }
        let mut sum = SparseVector::default();
        for (dof, value) in v.iter() {
            self.parts(dof).for_each(|(k, c)| sum.add(k, c * value));
        }
        Cow::Owned(sum)
    }

    /// Turns components into the entries of the vector that they are of.
    pub(crate) fn restore(&self, v: &mut [f64]) {
        if v.is_empty() {
            return;
        }
        let take = |&dof: &usize| (dof, std::mem::take(&mut v[dof]));
        let turned: Vec<(usize, f64)> = self.0.keys().map(take).collect();
        for (dof, value) in turned {
            self.entries(dof).for_each(|(j, c)| v[j] += c * value);
        }
    }

    /// The degrees of freedom that are turned, ascending, with the directions of one after those of the other.
    pub(crate) fn numbers(&self) -> (Vec<u32>, Vec<f64>) {
        let dofs = self.0.keys().map(|&dof| dof as u32).collect();
        (dofs, self.0.values().flatten().copied().collect())
    }

    /// What [`Directions::numbers`] left of those in so many dimensions.
    pub(crate) fn from_numbers(
        dimension: usize,
        dofs: impl Iterator<Item = usize>,
        numbers: &[f64],
    ) -> Self {
        let directions = numbers.chunks_exact(dimension).map(<[f64]>::to_vec);
        Self(dofs.zip(directions).collect())
    }

    /// Whether every node has all of its directions or none, none beyond so many degrees of freedom, and orthonormal ones.
    pub(crate) fn are_sound<const D: usize>(&self, dofs: usize) -> bool {
        let is_sound = |&dof: &usize| {
            let node = dof - dof % D;
            let all = (node..node + D).all(|k| self.0.get(&k).is_some_and(|n| n.len() == D));
            all && dof < dofs && {
                let q = SMatrix::<f64, D, D>::from_fn(|i, k| self.0[&(node + k)][i]);
                (q.transpose() * q - SMatrix::identity()).amax() < 1e-12
            }
        };
        self.0.keys().all(is_sound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::subspace::Subspace;

    fn turned() -> (Directions, SMatrix<f64, 3, 3>) {
        let n = SVector::<f64, 3>::new(2.0, -1.0, 0.5).normalize();
        let across = SVector::<f64, 3>::new(1.0, 2.0, 0.0).normalize();
        let all = Subspace::spanned(&[n, across]);
        let q = all.basis;
        let mut directions = Directions::default();
        directions.turn(1, &q);
        (directions, q)
    }

    #[test]
    fn components_and_entries_are_the_same_vector() {
        let (directions, q) = turned();
        let v: Vec<f64> = (0..9).map(|k| (k as f64 + 0.3).sin()).collect();
        let components: Vec<f64> = (0..9)
            .map(|dof| directions.component(dof, |j| v[j]))
            .collect();
        assert_eq!((&components[..3], &components[6..]), (&v[..3], &v[6..]));
        let own = q.transpose() * SVector::<f64, 3>::from_column_slice(&v[3..6]);
        assert!((own - SVector::from_column_slice(&components[3..6])).norm() < 1e-15);
        let mut back = components.clone();
        directions.restore(&mut back);
        assert!(v.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-15));
        let sparse: SparseVector = v.iter().copied().enumerate().collect();
        let sparse = directions.components(&sparse);
        assert!((0..9).all(|dof| (sparse.at(dof) - components[dof]).abs() < 1e-15));
    }

    #[test]
    fn a_component_is_set_and_the_others_stay() {
        let (directions, q) = turned();
        let mut v: Vec<f64> = (0..9).map(|k| (k as f64).cos()).collect();
        let before: Vec<f64> = (3..6).map(|d| directions.component(d, |j| v[j])).collect();
        directions.set(4, 2.5, &mut v);
        let after: Vec<f64> = (3..6).map(|d| directions.component(d, |j| v[j])).collect();
        assert!((after[1] - 2.5).abs() < 1e-15);
        assert!((after[0] - before[0]).abs() < 1e-15 && (after[2] - before[2]).abs() < 1e-15);
        let prescribed = crate::vector::prescribed::Prescribed {
            dofs: vec![0, 3],
            directions,
        };
        prescribed.clear(&mut v);
        let left = SVector::<f64, 3>::from_column_slice(&v[3..6]);
        assert!(v[0] == 0.0 && left.dot(&q.column(0)).abs() < 1e-15);
        assert!((left.dot(&q.column(1)) - 2.5).abs() < 1e-15);
    }

    #[test]
    fn numbers_bring_directions_back() {
        let (directions, _) = turned();
        let (dofs, numbers) = directions.numbers();
        let again = Directions::from_numbers(3, dofs.iter().map(|&d| d as usize), &numbers);
        assert_eq!(again, directions);
        assert!(again.are_sound::<3>(9) && !again.are_sound::<3>(5));
        let few = Directions::from_numbers(3, [3, 4].into_iter(), &numbers);
        assert!(!few.are_sound::<3>(9));
        let long: Vec<f64> = numbers.iter().map(|x| 1.1 * x).collect();
        let long = Directions::from_numbers(3, 3..6, &long);
        assert!(!long.are_sound::<3>(9));
    }
}
