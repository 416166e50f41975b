//! Relative displacements of contacts as unknowns in place of those of their nodes; not the problem that is
//! solved in them.

use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::Kinematics;
use crate::vector::directions::Directions;
use moreau_algebra::mirror;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A component of the relative displacement as a combination of unknowns, those that a degree of
/// freedom is given by.
pub(crate) fn row<const D: usize>(
    (motion_row, directions): (&RelativeMotionRow<D>, &Directions),
    kinematics: &Kinematics<D>,
    component: usize,
    unknown: impl Fn(usize) -> Option<usize>,
) -> BTreeMap<usize, f64> {
    let mut row = BTreeMap::new();
    for (a, w) in motion_row.weights() {
        for i in 0..D {
            let along = |dof: usize| kinematics.axes[(dof - D * a, component)];
            let coefficient = w * directions.component(D * a + i, along);
            if let Some(dof) = unknown(D * a + i)
                && coefficient != 0.0
            {
                *row.entry(dof).or_insert(0.0) += coefficient;
            }
        }
    }
    if let Some((dof, coefficient)) = kinematics.turning(component)
        && let Some(dof) = unknown(dof)
        && coefficient != 0.0
    {
        row.insert(dof, coefficient);
    }
    row
}

/// A coefficient of what rows before leave, beside weights whose sum is one, that is none: unknowns that are solved for
/// with it are its inverse of what they are.
const NONE: f64 = 1e-3;

/// Coefficient of an own unknown, over the largest, from which on it is the one solved for.
const OWN: f64 = 0.05;

/// Gauss–Jordan elimination of the rows B x = u, each for one interface unknown.
pub(crate) struct Elimination {
    /// Which of the solved unknowns each one is.
    place: Vec<Option<usize>>,
    solved: Vec<Solved>,
}

/// x_dof = Σ u-coefficients u + Σ x-coefficients x.
struct Solved {
    dof: usize,
    u: BTreeMap<usize, f64>,
    x: BTreeMap<usize, f64>,
}

impl Elimination {
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            place: vec![None; unknowns],
            solved: Vec::new(),
        }
    }

    /// Whether a row says something that those solved do not: whether after them a coefficient above the least is left.
    pub(crate) fn is_independent(&self, row: &BTreeMap<usize, f64>, least: f64) -> bool {
        let (_, left) = self.reduced(row.clone());
        left.values().any(|c| c.abs() > least)
    }

    /// Solves Σ row x = u_component, for one of the `own` unknowns if it can; false if no unknown
    /// is left to solve for.
    pub(crate) fn solve(
        &mut self,
        component: usize,
        row: &BTreeMap<usize, f64>,
        own: &[usize],
    ) -> bool {
        let (u, x) = self.reduced(row.clone());
        let largest = |among: &mut dyn Iterator<Item = (&usize, &f64)>| {
            among
                .map(|(&dof, &c)| (dof, c))
                .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        };
        let Some(any) = largest(&mut x.iter()).filter(|(_, c)| c.abs() > NONE) else {
            return false;
        };
        let (dof, pivot) = largest(&mut x.iter().filter(|(dof, _)| own.contains(dof)))
            .filter(|(_, c)| c.abs() >= OWN * any.1.abs())
            .unwrap_or(any);
        let over = |all: BTreeMap<usize, f64>| all.into_iter().map(move |(k, c)| (k, -c / pivot));
        let mut u: BTreeMap<usize, f64> = over(u).collect();
        u.insert(component, 1.0 / pivot);
        let x = over(x).filter(|(k, _)| *k != dof).collect();
        self.place[dof] = Some(self.solved.len());
        self.solved.push(Solved { dof, u, x });
        true
    }

    /// A combination of unknowns with those that are solved replaced.
    fn reduced(&self, mut x: BTreeMap<usize, f64>) -> (BTreeMap<usize, f64>, BTreeMap<usize, f64>) {
        let mut u = BTreeMap::new();
        // One that was solved earlier may bring in later ones, never the other way round.
        let first = |x: &BTreeMap<usize, f64>| {
            let places = x.keys().filter_map(|&dof| self.place[dof]);
            places.min()
        };
        while let Some(solved) = first(&x).map(|k| &self.solved[k]) {
            let c = x.remove(&solved.dof).unwrap_or(0.0);
            add(&mut u, &solved.u, c);
            add(&mut x, &solved.x, c);
        }
        (u, x)
    }

    /// Every unknown by the u of all components and the unknowns never solved for.
    pub(crate) fn finish(mut self, components: usize) -> Transformation {
        for k in (0..self.solved.len()).rev() {
            let x = std::mem::take(&mut self.solved[k].x);
            // All of those solved later have been finished.
            let (u, x) = self.reduced(x);
            add(&mut self.solved[k].u, &u, 1.0);
            self.solved[k].x = x;
        }
        let unknowns = self.place.len();
        let mut column = components;
        let mut columns = vec![0; unknowns];
        for dof in (0..unknowns).filter(|&dof| self.place[dof].is_none()) {
            columns[dof] = column;
            column += 1;
        }
        let row = |dof: usize| match self.place[dof] {
            None => vec![(columns[dof], 1.0)],
            Some(k) => {
                let Solved { u, x, .. } = &self.solved[k];
                let rest = x.iter().map(|(&dof, &c)| (columns[dof], c));
                u.iter().map(|(&k, &c)| (k, c)).chain(rest).collect()
            }
        };
        Transformation {
            rows: (0..unknowns).map(row).collect(),
            columns: column,
        }
    }
}

fn add(to: &mut BTreeMap<usize, f64>, from: &BTreeMap<usize, f64>, factor: f64) {
    for (&k, &c) in from {
        *to.entry(k).or_insert(0.0) += factor * c;
    }
}

/// The sparse matrix T of x = T (u, y), by rows.
pub(crate) struct Transformation {
    rows: Vec<Vec<(usize, f64)>>,
    columns: usize,
}

impl Transformation {
    /// x of z = (u, y).
    pub(crate) fn apply(&self, z: &DVector<f64>) -> DVector<f64> {
        let row = |row: &Vec<(usize, f64)>| row.iter().map(|&(k, c)| c * z[k]).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(row))
    }

    /// Σ row x by (u, y).
    pub(crate) fn combination(&self, row: &BTreeMap<usize, f64>) -> BTreeMap<usize, f64> {
        let mut sum = BTreeMap::new();
        for (&x, &c) in row {
            for &(z, t) in &self.rows[x] {
                *sum.entry(z).or_insert(0.0) += c * t;
            }
        }
        sum
    }

    /// Tᵀ f.
    pub(crate) fn transposed(&self, f: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(self.columns);
        for (row, f) in self.rows.iter().zip(f.iter()) {
            for &(k, c) in row {
                out[k] += c * f;
            }
        }
        out
    }

    /// Tᵀ S T of a symmetric S.
    pub(crate) fn congruence(&self, s: DMatrix<f64>) -> DMatrix<f64> {
        // Entries of T by columns, and where those of each column begin.
        let mut entries: Vec<(usize, usize, f64)> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            entries.extend(row.iter().map(|&(k, c)| (k, i, c)));
        }
        entries.sort_unstable_by_key(|&(k, i, _)| (k, i));
        let start = |k: usize| entries.partition_point(|entry| entry.0 < k);
        let start: Vec<usize> = (0..=self.columns).map(start).collect();
        let mut out = DMatrix::zeros(self.columns, self.columns);
        // A column of Tᵀ S, of which the lower triangle takes what is below the diagonal.
        let mut answer = vec![0.0; self.columns];
        for (s, row) in s.column_iter().zip(&self.rows) {
            let Some(first) = row.iter().map(|&(k, _)| k).min() else {
                continue;
            };
            answer[first..].fill(0.0);
            for &(k, i, c) in &entries[start[first]..] {
                answer[k] += c * s[i];
            }
            for &(k, c) in row {
                let mut column = out.column_mut(k);
                let column = &mut column.as_mut_slice()[k..];
                for (entry, answer) in column.iter_mut().zip(&answer[k..]) {
                    *entry += c * answer;
                }
            }
        }
        mirror(&mut out);
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Rows that share unknowns, chained and in cycles: B T is the identity on u.
        #[test]
        fn the_transformation_inverts_the_rows(
            entries in prop::collection::vec(-1.0..1.0f64, 24),
            mask in prop::collection::vec(any::<bool>(), 24),
        ) {
            let (rows, unknowns) = (4, 6);
            let mut b = DMatrix::zeros(rows, unknowns);
            for (k, (&v, &m)) in entries.iter().zip(&mask).enumerate() {
                b[(k / unknowns, k % unknowns)] = if m { v } else { 0.0 };
            }
            for r in 0..rows {
                b[(r, r)] += 2.5;
            }
            let mut elimination = Elimination::new(unknowns);
            for r in 0..rows {
                let row = (0..unknowns).filter(|&i| b[(r, i)] != 0.0).map(|i| (i, b[(r, i)]));
                prop_assert!(elimination.solve(r, &row.collect(), &[r]));
            }
            let t = elimination.finish(rows);
            prop_assert_eq!(t.columns, unknowns);
            let identity = t.congruence(DMatrix::identity(unknowns, unknowns));
            let mut product = DMatrix::zeros(rows, unknowns);
            for k in 0..unknowns {
                let z = DVector::from_fn(unknowns, |i, _| f64::from(u8::from(i == k)));
                let x = t.apply(&z);
                product.set_column(k, &(&b * &x));
                prop_assert!((x.norm_squared() - identity[(k, k)]).abs() < 1e-10 * identity.amax());
            }
            prop_assert!((product - DMatrix::identity(rows, unknowns)).amax() < 1e-10);
        }
    }

    #[test]
    fn a_row_without_freedom_is_refused() {
        let mut elimination = Elimination::new(2);
        let row = |c: [f64; 2]| -> BTreeMap<usize, f64> { [(0, c[0]), (1, c[1])].into() };
        assert!(elimination.solve(0, &row([1.0, 2.0]), &[0]));
        assert!(elimination.solve(1, &row([1.0, -1.0]), &[0]));
        assert!(!elimination.solve(2, &row([3.0, 1.0]), &[0]));
    }
}
