//! Relative displacements of contacts as unknowns in place of those of their nodes; not the problem that is
//! solved in them.

use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::Kinematics;
use crate::vector::Combination;
use crate::vector::directions::Directions;
use moreau_algebra::congruence;
use nalgebra::{DMatrix, DVector};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A component of the relative displacement as a combination of unknowns, those that a degree of
/// freedom is given by.
pub(crate) fn row<const D: usize>(
    (motion_row, directions): (&RelativeMotionRow<D>, &Directions),
    kinematics: &Kinematics<D>,
    component: usize,
    unknown: impl Fn(usize) -> Option<usize>,
) -> Combination {
    let mut row = Vec::new();
    for (a, w) in motion_row.weights() {
        for i in 0..D {
            let along = |dof: usize| kinematics.axes[(dof - D * a, component)];
            let coefficient = w * directions.component(D * a + i, along);
            if let Some(dof) = unknown(D * a + i)
                && coefficient != 0.0
            {
                row.push((dof, coefficient));
            }
        }
    }
    if let Some((dof, coefficient)) = kinematics.turning(component)
        && let Some(dof) = unknown(dof)
        && coefficient != 0.0
    {
        row.push((dof, coefficient));
    }
    gathered(row)
}

/// What has the same number added up.
fn gathered(mut entries: Combination) -> Combination {
    entries.sort_by_key(|&(k, _)| k);
    entries.dedup_by(|next, kept| {
        let same = next.0 == kept.0;
        if same {
            kept.1 += next.1;
        }
        same
    });
    entries
}

/// A coefficient of what rows before leave, beside weights whose sum is one and beside what they bring in, that is none:
/// unknowns that are solved for with it are its inverse of those, row after row.
const NONE: f64 = 1e-3;

/// Coefficient of an own unknown, over the largest, from which on it is the one solved for.
const OWN: f64 = 0.05;

/// Gauss–Jordan elimination of the rows B x = u, each for one interface unknown.
pub(crate) struct Elimination {
    /// Which of the solved unknowns each one is.
    place: Vec<Option<usize>>,
    solved: Vec<Solved>,
    /// Room for the combination at work, of u and of x.
    u: Sum,
    x: Sum,
}

/// x_dof = Σ u-coefficients u + Σ x-coefficients x.
struct Solved {
    dof: usize,
    u: Combination,
    x: Combination,
}

/// A combination to which others are added.
#[derive(Default)]
struct Sum {
    value: Vec<f64>,
    is_in: Vec<bool>,
    entries: Vec<usize>,
}

impl Sum {
    /// Adds to a coefficient; whether it is a new one.
    fn add(&mut self, k: usize, value: f64) -> bool {
        if k >= self.value.len() {
            self.value.resize(k + 1, 0.0);
            self.is_in.resize(k + 1, false);
        }
        self.value[k] += value;
        let new = !self.is_in[k];
        if new {
            self.is_in[k] = true;
            self.entries.push(k);
        }
        new
    }

    /// Leaves an unknown out, for its coefficient.
    fn remove(&mut self, k: usize) -> f64 {
        self.is_in[k] = false;
        std::mem::take(&mut self.value[k])
    }

    /// The sum, and room for the next one.
    fn take(&mut self) -> Combination {
        let mut entries = std::mem::take(&mut self.entries);
        entries.retain(|&k| self.is_in[k]);
        entries.sort_unstable();
        let sum = entries.iter().map(|&k| (k, self.remove(k))).collect();
        entries.clear();
        self.entries = entries;
        sum
    }
}

impl Elimination {
    pub(crate) fn new(unknowns: usize) -> Self {
        Self {
            place: vec![None; unknowns],
            solved: Vec::new(),
            u: Sum::default(),
            x: Sum::default(),
        }
    }

    /// Whether a row says something that those solved do not: whether after them a coefficient above the least is left.
    pub(crate) fn is_independent(&mut self, row: &Combination, least: f64) -> bool {
        let (_, left) = self.reduced(row);
        left.iter().any(|(_, c)| c.abs() > least)
    }

    /// Solves Σ row x = u_component, for one of the `own` unknowns if it can; false if no unknown
    /// is left to solve for, or only one that would be far larger than what it follows from.
    pub(crate) fn solve(&mut self, component: usize, row: &Combination, own: &[usize]) -> bool {
        let (mut u, mut x) = self.reduced(row);
        let larger = |a: &&(usize, f64), b: &&(usize, f64)| a.1.abs().total_cmp(&b.1.abs());
        let brought = u.iter().map(|(_, c)| c.abs()).fold(1.0, f64::max);
        let any = x.iter().max_by(larger);
        let Some(&any) = any.filter(|(_, c)| c.abs() > NONE * brought) else {
            return false;
        };
        let among_own = x.iter().filter(|(dof, _)| own.contains(dof));
        let (dof, pivot) = among_own
            .max_by(larger)
            .filter(|(_, c)| c.abs() >= OWN * any.1.abs())
            .copied()
            .unwrap_or(any);
        x.retain(|(k, _)| *k != dof);
        u.iter_mut()
            .chain(&mut x)
            .for_each(|(_, c)| *c = -*c / pivot);
        u.push((component, 1.0 / pivot));
        u.sort_unstable_by_key(|&(k, _)| k);
        self.place[dof] = Some(self.solved.len());
        self.solved.push(Solved { dof, u, x });
        true
    }

    /// A combination of unknowns with those that are solved replaced: by u, and by others.
    fn reduced(&mut self, row: &Combination) -> (Combination, Combination) {
        // One that was solved earlier may bring in later ones, never the other way round.
        let mut open = BinaryHeap::new();
        let enter = |dof: usize, c: f64, x: &mut Sum, open: &mut BinaryHeap<Reverse<usize>>| {
            if x.add(dof, c)
                && let Some(k) = self.place[dof]
            {
                open.push(Reverse(k));
            }
        };
        for &(dof, c) in row {
            enter(dof, c, &mut self.x, &mut open);
        }
        while let Some(Reverse(k)) = open.pop() {
            let solved = &self.solved[k];
            let factor = self.x.remove(solved.dof);
            for &(k, c) in &solved.u {
                self.u.add(k, factor * c);
            }
            for &(dof, c) in &solved.x {
                enter(dof, factor * c, &mut self.x, &mut open);
            }
        }
        (self.u.take(), self.x.take())
    }

    /// Every unknown by the u of all components and the unknowns never solved for.
    pub(crate) fn finish(mut self, components: usize) -> Transformation {
        for k in (0..self.solved.len()).rev() {
            let x = std::mem::take(&mut self.solved[k].x);
            // All of those solved later have been finished.
            let (u, x) = self.reduced(&x);
            let solved = &mut self.solved[k];
            solved.u = gathered([std::mem::take(&mut solved.u), u].concat());
            solved.x = x;
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
                let rest = x.iter().map(|&(dof, c)| (columns[dof], c));
                u.iter().copied().chain(rest).collect()
            }
        };
        Transformation {
            rows: (0..unknowns).map(row).collect(),
            columns: column,
        }
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
    pub(crate) fn combination(&self, row: &Combination) -> Combination {
        let of = |&(x, c): &(usize, f64)| self.rows[x].iter().map(move |&(z, t)| (z, c * t));
        gathered(row.iter().flat_map(of).collect())
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
    pub(crate) fn congruence(&self, s: &DMatrix<f64>) -> DMatrix<f64> {
        congruence(s, &self.rows, self.columns)
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
            let s = DMatrix::from_fn(unknowns, unknowns, |i, j| ((i * i + j * j) as f64).sin());
            let seen = t.congruence(&s);
            let mut product = DMatrix::zeros(rows, unknowns);
            for k in 0..unknowns {
                let z = DVector::from_fn(unknowns, |i, _| f64::from(u8::from(i == k)));
                let x = t.apply(&z);
                product.set_column(k, &(&b * &x));
                let seen = seen.column(k) - t.transposed(&(&s * &x));
                prop_assert!(seen.amax() < 1e-10 * (1.0 + x.amax().powi(2)));
            }
            prop_assert!((product - DMatrix::identity(rows, unknowns)).amax() < 1e-10);
        }
    }

    #[test]
    fn a_row_without_freedom_is_refused() {
        let mut elimination = Elimination::new(2);
        let row = |c: [f64; 2]| vec![(0, c[0]), (1, c[1])];
        assert!(elimination.solve(0, &row([1.0, 2.0]), &[0]));
        assert!(elimination.solve(1, &row([1.0, -1.0]), &[0]));
        assert!(!elimination.solve(2, &row([3.0, 1.0]), &[0]));
    }

    /// Of two tools that look nearly the same way one decides how a node moves along both; of what follows from that and
    /// is as slight another node does not.
    #[test]
    fn a_slight_row_is_solved_for_but_none_after_the_other() {
        let mut elimination = Elimination::new(3);
        assert!(elimination.solve(0, &vec![(0, 1.0)], &[0]));
        assert!(elimination.solve(1, &vec![(0, 1.0), (1, 2e-3)], &[1]));
        assert!(!elimination.solve(2, &vec![(1, 1.0), (2, 2e-3)], &[2]));
        assert!(elimination.solve(2, &vec![(1, 1.0), (2, 2.0)], &[2]));
    }
}
