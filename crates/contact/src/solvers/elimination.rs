//! Gaussian elimination of matrices with the pattern of W, contact by contact, in an order that is found
//! once; no pivots are exchanged between contacts, for matrices that need it see `blocks`.

use crate::BlockMatrix;
use moreau_laws::Local;
use nalgebra::SMatrix;
use std::collections::BTreeSet;

/// The order of elimination of least degree, the pattern that it fills, and the factors L U of the last
/// matrix eliminated.
///
/// Contacts of few bodies leave almost no fill in this order; exchanging pivots, as a general
/// factorisation of unsymmetric matrices does, would spoil it. The rows of Newton's matrix are of one
/// size and its diagonal is that of a softened law, so that exchanges are seldom needed; who solves
/// checks the answer.
#[derive(Debug)]
pub(super) struct Elimination<const D: usize> {
    /// Contact of every step.
    order: Vec<usize>,
    /// Step of every contact.
    place: Vec<usize>,
    /// Rows of L and U together, by steps; the diagonal holds the inverse.
    starts: Vec<usize>,
    columns: Vec<usize>,
    diagonals: Vec<usize>,
    blocks: Vec<SMatrix<f64, D, D>>,
    /// The row at work, by columns.
    row: Vec<SMatrix<f64, D, D>>,
    /// Steps that were left out.
    idle: Vec<bool>,
}

/// How many products of blocks of a dense factorisation take the time of one here.
const DENSE_IS_FASTER: f64 = 6.0;

/// Contacts up to which a factorisation of a dense matrix does not pay.
const FEW: usize = 12;

impl<const D: usize> Elimination<D> {
    /// Finds the order for a pattern; `None` if a dense factorisation is cheaper.
    pub(super) fn new(pattern: &BlockMatrix<D>) -> Option<Self> {
        let n = pattern.contacts();
        let dense = (n * n) as f64 * n as f64 / 3.0;
        let most = match n {
            0..=FEW => f64::INFINITY,
            // What is full already need not be looked at.
            _ if 2 * pattern.stored() > n * n => return None,
            _ => dense / DENSE_IS_FASTER,
        };
        let mut near: Vec<Vec<usize>> = vec![Vec::new(); n];
        for i in 0..n {
            for (j, _) in pattern.row(i).filter(|(j, _)| *j != i) {
                near[i].push(j);
                near[j].push(i);
            }
        }
        for list in &mut near {
            list.sort_unstable();
            list.dedup();
        }
        let mut degrees: BTreeSet<(usize, usize)> = near
            .iter()
            .enumerate()
            .map(|(i, list)| (list.len(), i))
            .collect();
        let mut order = Vec::with_capacity(n);
        let mut products = 0.0;
        let mut merged = Vec::new();
        while let Some((degree, least)) = degrees.pop_first() {
            products += (degree * degree) as f64;
            if products > most {
                return None;
            }
            order.push(least);
            // What the contact couples is coupled without it.
            let own = std::mem::take(&mut near[least]);
            for &i in &own {
                degrees.remove(&(near[i].len(), i));
                merge(&near[i], &own, [i, least], &mut merged);
                std::mem::swap(&mut near[i], &mut merged);
                degrees.insert((near[i].len(), i));
            }
            near[least] = own;
        }
        let mut place = vec![0; n];
        for (step, &i) in order.iter().enumerate() {
            place[i] = step;
        }
        // `near` now holds the rows of U, and by symmetry of the pattern the columns of L.
        let mut lower = vec![Vec::new(); n];
        for (step, &i) in order.iter().enumerate() {
            for &j in &near[i] {
                lower[place[j]].push(step);
            }
        }
        let mut starts = vec![0];
        let (mut columns, mut diagonals) = (Vec::new(), Vec::new());
        for (step, &i) in order.iter().enumerate() {
            columns.append(&mut lower[step]);
            diagonals.push(columns.len());
            columns.push(step);
            let begin = columns.len();
            columns.extend(near[i].iter().map(|&j| place[j]));
            columns[begin..].sort_unstable();
            starts.push(columns.len());
        }
        Some(Self {
            blocks: vec![SMatrix::zeros(); columns.len()],
            row: vec![SMatrix::zeros(); n],
            idle: vec![false; n],
            order,
            place,
            starts,
            columns,
            diagonals,
        })
    }

    /// Eliminates a matrix within the pattern: `row` gives the blocks of a contact's row by their
    /// contacts, or `false` for a contact that is left out with its row and column. `None` where a
    /// pivot is singular.
    pub(super) fn factorise(
        &mut self,
        mut row: impl FnMut(usize, &mut dyn FnMut(usize, SMatrix<f64, D, D>)) -> bool,
    ) -> Option<()> {
        for step in 0..self.order.len() {
            let range = self.starts[step]..self.starts[step + 1];
            for &column in &self.columns[range.clone()] {
                self.row[column] = SMatrix::zeros();
            }
            let (place, work) = (&self.place, &mut self.row);
            self.idle[step] = !row(self.order[step], &mut |j, block| work[place[j]] = block);
            if self.idle[step] {
                continue;
            }
            let diagonal = self.diagonals[step];
            for at in range.start..diagonal {
                let earlier = self.columns[at];
                if self.idle[earlier] {
                    self.blocks[at] = SMatrix::zeros();
                    continue;
                }
                let pivot = self.diagonals[earlier];
                let factor = self.row[earlier] * self.blocks[pivot];
                self.blocks[at] = factor;
                for k in pivot + 1..self.starts[earlier + 1] {
                    self.row[self.columns[k]] -= factor * self.blocks[k];
                }
            }
            self.blocks[diagonal] = self.row[step].try_inverse()?;
            for at in diagonal + 1..range.end {
                self.blocks[at] = self.row[self.columns[at]];
            }
        }
        Some(())
    }

    /// x of A x = b, in place; what was left out of A is left out of x.
    pub(super) fn solve(&self, b: &[Local<D>], x: &mut [Local<D>]) {
        for step in 0..self.order.len() {
            let i = self.order[step];
            let mut sum = Local::zeros();
            if !self.idle[step] {
                sum = b[i];
                for at in self.starts[step]..self.diagonals[step] {
                    sum -= self.blocks[at] * x[self.order[self.columns[at]]];
                }
            }
            x[i] = sum;
        }
        for step in (0..self.order.len()).rev().filter(|step| !self.idle[*step]) {
            let i = self.order[step];
            let mut sum = x[i];
            for at in self.diagonals[step] + 1..self.starts[step + 1] {
                sum -= self.blocks[at] * x[self.order[self.columns[at]]];
            }
            x[i] = self.blocks[self.diagonals[step]] * sum;
        }
    }
}

/// Two increasing lists as one, without some of their members.
fn merge(a: &[usize], b: &[usize], without: [usize; 2], merged: &mut Vec<usize>) {
    merged.clear();
    let (mut a, mut b) = (a.iter().copied().peekable(), b.iter().copied().peekable());
    loop {
        let next = match (a.peek(), b.peek()) {
            (Some(&i), Some(&j)) => i.min(j),
            (Some(&i), None) | (None, Some(&i)) => i,
            (None, None) => break,
        };
        a.next_if_eq(&next);
        b.next_if_eq(&next);
        if !without.contains(&next) {
            merged.push(next);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::stack;
    use moreau_algebra::Lu;
    use nalgebra::{DMatrix, Matrix2};
    use proptest::prelude::*;

    proptest! {
        /// Against the dense factorisation, with contacts left out.
        #[test]
        fn it_solves_as_the_dense_factorisation(
            n in 1usize..25,
            entries in prop::collection::vec(-1.0..1.0f64, 211),
            couplings in prop::collection::vec((0usize..25, 0usize..25), 0..40),
            out in prop::collection::vec(prop::bool::weighted(0.2), 25),
        ) {
            let entry = |k: usize| entries[k % entries.len()];
            let mut dense = DMatrix::<f64>::zeros(3 * n, 3 * n);
            let own = (0..n).map(|i| (i, i));
            let coupled = couplings.iter().map(|&(i, j)| (i % n, j % n));
            for (at, (i, j)) in own.chain(coupled).enumerate() {
                for (k, l) in (0..3).flat_map(|k| (0..3).map(move |l| (k, l))) {
                    dense[(3 * i + k, 3 * j + l)] = entry(9 * at + 3 * k + l);
                }
            }
            for i in 0..3 * n {
                dense[(i, i)] += 100.0;
            }
            for i in (0..n).filter(|i| out[*i]) {
                for k in 3 * i..3 * i + 3 {
                    dense.row_mut(k).fill(0.0);
                    dense.column_mut(k).fill(0.0);
                    dense[(k, k)] = 1.0;
                }
            }
            let matrix = BlockMatrix::<3>::from_dense(&dense).expect("square");
            let Some(mut elimination) = Elimination::new(&matrix) else {
                return Ok(());
            };
            let b: Vec<Local<3>> = (0..n)
                .map(|i| if out[i] { Local::zeros() } else { Local::from_fn(|k, _| entry(5 * i + k)) })
                .collect();
            let row = |i: usize, add: &mut dyn FnMut(usize, SMatrix<f64, 3, 3>)| {
                for (j, block) in matrix.row(i).filter(|(j, _)| !out[*j]) {
                    add(j, *block);
                }
                !out[i]
            };
            prop_assert!(elimination.factorise(row).is_some());
            let mut x = vec![Local::zeros(); n];
            elimination.solve(&b, &mut x);
            let expected = Lu::new(dense).expect("regular").solve(stack(&b));
            prop_assert!((stack(&x) - expected).norm() < 1e-13);
        }
    }

    #[test]
    fn what_is_full_is_left_to_a_dense_factorisation() {
        let full = |n: usize| {
            BlockMatrix::<2>::from_dense(&DMatrix::from_element(2 * n, 2 * n, 1.0)).expect("square")
        };
        assert!(Elimination::new(&full(5)).is_some());
        assert!(Elimination::new(&full(50)).is_none());
        // A chain has no fill in the order of its ends.
        let chain = DMatrix::from_fn(200, 200, |i, j| f64::from(u8::from(i.abs_diff(j) <= 1)));
        let pattern = BlockMatrix::<2>::from_dense(&chain).expect("square");
        let elimination = Elimination::new(&pattern).expect("sparse");
        assert_eq!(elimination.blocks.len(), pattern.stored());
    }

    #[test]
    fn a_singular_pivot_is_refused() {
        let zero = BlockMatrix::<2>::from_entries(1, [(0, 0, 1.0)]);
        let mut elimination = Elimination::new(&zero).expect("small");
        let row = |_: usize, add: &mut dyn FnMut(usize, SMatrix<f64, 2, 2>)| {
            add(0, Matrix2::new(1.0, 2.0, 2.0, 4.0));
            true
        };
        assert!(elimination.factorise(row).is_none());
    }
}
