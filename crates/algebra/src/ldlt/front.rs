//! L D Lᵀ of a dense front: some of its columns are complete and may be pivots, the others receive what
//! these leave; not how fronts are put together.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};

use crate::engine::{EngineError, Inertia};
use crate::panel::add_one;

/// A pivot is at least this part of what is left of its column: the entries of L are below 100. The usual
/// compromise of sparse solvers between few exchanges and little growth.
const THRESHOLD: f64 = 0.01;

/// What is left of a column of a matrix scaled to rows of size 1 is rounding up to this times √n: some times what
/// the last pivot of a Laplacian is that nothing holds.
const ROUNDING: f64 = 10.0 * f64::EPSILON;

/// Pivots after which the other columns are updated, all at once.
const BLOCK: usize = 32;

/// A dense symmetric matrix, of which the lower triangle is held, under elimination.
#[derive(Debug, Default)]
pub(super) struct Front {
    /// Unknowns of the rows.
    pub(super) index: Vec<u32>,
    /// Entries column by column: L of the pivots, what is left of the others.
    pub(super) entries: Vec<f64>,
    /// Diagonal of D, and what is below it, which is zero for a pivot that stands alone.
    pub(super) pivots: Vec<[f64; 2]>,
    /// Number of columns that are complete: the first.
    complete: usize,
    /// L D of the pivots since the last update.
    block: Vec<f64>,
    /// What is left of the columns that are examined.
    columns: [Vec<f64>; 2],
}

/// Signs and sizes of the pivots so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pivots {
    pub(super) inertia: Inertia,
    /// Unknown of the first pivot that is zero.
    pub(super) zero: Option<u32>,
    /// The least that is not.
    pub(super) least: f64,
    /// Up to where a column is zero.
    negligible: f64,
}

impl Pivots {
    /// Of a matrix of so many rows.
    pub(super) fn of(size: usize) -> Self {
        Self {
            inertia: Inertia::default(),
            zero: None,
            least: f64::INFINITY,
            negligible: ROUNDING * (size as f64).sqrt(),
        }
    }

    /// The signs, if none is zero.
    pub(super) fn result(&self) -> Result<Inertia, EngineError> {
        let inertia = self.inertia;
        match self.zero {
            Some(row) => Err(EngineError::Singular {
                row: row as usize,
                inertia,
            }),
            None => Ok(inertia),
        }
    }
}

/// Columns of pivots.
enum Choice {
    One,
    Two,
}

/// column ← column − Σ block·row, with the columns of a block.
struct Update<'a> {
    block: &'a [f64],
    size: usize,
    /// Where the rows of the column begin.
    first: usize,
    row: &'a [f64],
    column: &'a mut [f64],
}

impl WithSimd for Update<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let column = |k: usize| &self.block[k * self.size + self.first..(k + 1) * self.size];
        let mut k = 0;
        while k + 4 <= self.row.len() {
            let columns = [column(k), column(k + 1), column(k + 2), column(k + 3)];
            let x = std::array::from_fn(|i| -self.row[k + i]);
            add_one(columns, x, self.column);
            k += 4;
        }
        for (k, l) in self.row.iter().enumerate().skip(k) {
            for (sum, b) in self.column.iter_mut().zip(column(k)) {
                *sum -= b * l;
            }
        }
    }
}

impl Front {
    /// All zero, of some unknowns of which the first `complete` may be pivots.
    pub(super) fn begin(&mut self, complete: usize) {
        let size = self.index.len();
        self.complete = complete;
        self.entries.clear();
        self.entries.resize(size * size, 0.0);
        self.pivots.clear();
    }

    pub(super) fn size(&self) -> usize {
        self.index.len()
    }

    /// Number of columns that could be pivots.
    pub(super) fn complete(&self) -> usize {
        self.complete
    }

    /// Eliminates what of the complete columns has a pivot that is not small beside its column, and subtracts
    /// what that leaves from all others. Where nothing comes later (`last`) a pivot is only asked to be not small
    /// beside the complete columns.
    pub(super) fn eliminate(&mut self, last: bool, known: &mut Pivots, (par, arch): (Par, Arch)) {
        let size = self.size();
        self.block.resize(size * (BLOCK + 1), 0.0);
        loop {
            let first = self.pivots.len();
            let mut untried = self.complete;
            loop {
                let k = self.pivots.len();
                if k >= untried || k - first >= BLOCK {
                    break;
                }
                if self.pivot((first, k), last, known, arch).is_none() {
                    untried -= 1;
                    self.exchange(first, k, untried);
                }
            }
            if self.pivots.len() == first {
                break;
            }
            self.update_complete(first, par);
        }
        self.update_others(par);
    }

    /// Looks for a pivot in column k or together with it, and eliminates it.
    fn pivot(
        &mut self,
        (first, k): (usize, usize),
        last: bool,
        known: &mut Pivots,
        arch: Arch,
    ) -> Option<()> {
        let (size, complete) = (self.size(), self.complete);
        self.load(0, (first, k), k, arch);
        let own = &self.columns[0];
        // Beyond the complete columns what is left counts where it could still be waited for.
        let end = if last { complete } else { size };
        let (partner, beside) = largest(own, k + 1..complete);
        let all = beside.max(largest(own, complete..end).1);
        let diagonal = own[k];
        if diagonal.abs().max(all) <= known.negligible {
            known.inertia.zero += 1;
            known.zero.get_or_insert(self.index[k]);
            self.accept_zero(first, k);
            return Some(());
        }
        if diagonal.abs() >= THRESHOLD * all {
            self.accept_one(first, k, known);
            return Some(());
        }
        if beside == 0.0 || beside.is_nan() {
            return None;
        }
        self.load(1, (first, k), partner, arch);
        match self.choose((k, partner), end, known.negligible)? {
            Choice::Two => {
                self.exchange(first, k + 1, partner);
                self.accept_two(first, k, known);
            }
            Choice::One => {
                self.columns.swap(0, 1);
                self.exchange(first, k, partner);
                self.accept_one(first, k, known);
            }
        }
        Some(())
    }

    /// Whether columns k and `partner`, or the latter alone, make a pivot.
    fn choose(&self, (k, partner): (usize, usize), end: usize, negligible: f64) -> Option<Choice> {
        let [own, other] = &self.columns;
        let (a, b, c) = (own[k], own[partner], other[partner]);
        let apart = |column: &[f64]| {
            let ranges = [k + 1..partner, partner + 1..end];
            let largest = ranges.map(|range| largest(column, range).1);
            largest[0].max(largest[1])
        };
        let (of_own, of_other) = (apart(own), apart(other));
        // The determinant over b, and whether it is more than what cancellation leaves of its terms.
        let terms = [a / b * c, b];
        let determinant = terms[0] - terms[1];
        let distinct = determinant.abs() >= 0.5 * terms[0].abs().max(terms[1].abs());
        let reach = determinant.abs() * b.abs() / THRESHOLD;
        let grows_little = c.abs() * of_own + b.abs() * of_other <= reach
            && b.abs() * of_own + a.abs() * of_other <= reach;
        if distinct && grows_little {
            return Some(Choice::Two);
        }
        let alone = c.abs() >= THRESHOLD * of_other.max(b.abs()) && c.abs() > negligible;
        alone.then_some(Choice::One)
    }

    /// What is left of a column j ≥ k from row k on, before the next update.
    fn load(&mut self, which: usize, (first, k): (usize, usize), j: usize, arch: Arch) {
        let size = self.size();
        let mut column = std::mem::take(&mut self.columns[which]);
        column.resize(size, 0.0);
        for i in k..j {
            column[i] = self.entries[j + i * size];
        }
        column[j..].copy_from_slice(&self.entries[j + j * size..(j + 1) * size]);
        let mut row = [0.0; BLOCK + 1];
        let row = &mut row[..k - first];
        for (l, at) in row.iter_mut().zip(first..k) {
            *l = self.entries[j + at * size];
        }
        arch.dispatch(Update {
            block: &self.block,
            size,
            first: k,
            row,
            column: &mut column[k..],
        });
        self.columns[which] = column;
    }

    fn accept_zero(&mut self, first: usize, k: usize) {
        let size = self.size();
        self.entries[k * size + k..(k + 1) * size].fill(0.0);
        self.block[(k - first) * size + k..(k - first + 1) * size].fill(0.0);
        self.pivots.push([0.0; 2]);
    }

    fn accept_one(&mut self, first: usize, k: usize, known: &mut Pivots) {
        let size = self.size();
        let pivot = self.columns[0][k];
        let (own, inverse) = (&self.columns[0][k + 1..size], 1.0 / pivot);
        self.block[(k - first) * size + k + 1..(k - first + 1) * size].copy_from_slice(own);
        let l = &mut self.entries[k * size + k + 1..(k + 1) * size];
        l.iter_mut().zip(own).for_each(|(l, c)| *l = c * inverse);
        self.pivots.push([pivot, 0.0]);
        if pivot > 0.0 {
            known.inertia.positive += 1;
        } else {
            known.inertia.negative += 1;
        }
        known.least = known.least.min(pivot.abs());
    }

    fn accept_two(&mut self, first: usize, k: usize, known: &mut Pivots) {
        let size = self.size();
        let [own, other] = &self.columns;
        let (a, b, c) = (own[k], own[k + 1], other[k + 1]);
        let to = (k - first) * size;
        self.block[to + k + 2..to + size].copy_from_slice(&own[k + 2..size]);
        self.block[to + size + k + 2..to + 2 * size].copy_from_slice(&other[k + 2..size]);
        let [p, q, r] = inverse(a, b, c);
        let (left, right) = self.entries.split_at_mut((k + 1) * size);
        left[k * size + k + 1] = 0.0;
        for i in k + 2..size {
            left[k * size + i] = p * own[i] + q * other[i];
            right[i] = q * own[i] + r * other[i];
        }
        self.pivots.extend([[a, b], [c, 0.0]]);
        let determinant = a / b * c - b;
        // The determinant is this times b.
        if (determinant < 0.0) == (b > 0.0) {
            known.inertia.positive += 1;
            known.inertia.negative += 1;
        } else if a > 0.0 {
            known.inertia.positive += 2;
        } else {
            known.inertia.negative += 2;
        }
        // The product of the eigenvalues over more than the larger of them.
        let largest = a.abs().max(c.abs()) + b.abs();
        known.least = known.least.min(determinant.abs() * b.abs() / largest);
    }

    /// Exchanges rows and columns i ≤ j, also of what is examined.
    fn exchange(&mut self, first: usize, i: usize, j: usize) {
        if i == j {
            return;
        }
        let size = self.size();
        let a = &mut self.entries;
        for column in a.chunks_exact_mut(size).take(i) {
            column.swap(i, j);
        }
        a.swap(i + i * size, j + j * size);
        for c in i + 1..j {
            a.swap(c + i * size, j + c * size);
        }
        for r in j + 1..size {
            a.swap(r + i * size, r + j * size);
        }
        let pending = self.pivots.len() - first;
        for column in self.block.chunks_exact_mut(size).take(pending) {
            column.swap(i, j);
        }
        for column in &mut self.columns {
            if column.len() == size {
                column.swap(i, j);
            }
        }
        self.index.swap(i, j);
    }

    /// Subtracts the pivots since `first` from the complete columns that are left.
    fn update_complete(&mut self, first: usize, par: Par) {
        let (size, k, complete) = (self.size(), self.pivots.len(), self.complete);
        if k == complete {
            return;
        }
        let (pivots, rest) = self.entries.split_at_mut(k * size);
        let l = MatRef::from_column_major_slice(&pivots[first * size..], size, k - first);
        let block = &self.block[..(k - first) * size];
        let block = MatRef::from_column_major_slice(block, size, k - first);
        let rest = &mut rest[..(complete - k) * size];
        let rest = MatMut::from_column_major_slice_mut(rest, size, complete - k);
        let (_, rest) = rest.split_at_row_mut(k);
        let (triangle, below) = rest.split_at_row_mut(complete - k);
        let right = block.subrows(k, complete - k).transpose();
        subtract_symmetric(triangle, l.subrows(k, complete - k), right, par);
        matmul(
            below,
            Accum::Add,
            l.subrows(complete, size - complete),
            right,
            -1.0,
            par,
        );
    }

    /// Subtracts all pivots from the columns that are not complete.
    fn update_others(&mut self, par: Par) {
        let (size, k, complete) = (self.size(), self.pivots.len(), self.complete);
        let others = size - complete;
        if k == 0 || others == 0 {
            return;
        }
        let (done, rest) = self.entries.split_at_mut(complete * size);
        let mut product = std::mem::take(&mut self.block);
        product.clear();
        product.reserve(others * k);
        let mut at = 0;
        while at < k {
            let [a, b] = self.pivots[at];
            let own = &done[at * size + complete..(at + 1) * size];
            if b == 0.0 {
                product.extend(own.iter().map(|l| a * l));
                at += 1;
                continue;
            }
            let c = self.pivots[at + 1][0];
            let other = &done[(at + 1) * size + complete..(at + 2) * size];
            let pairs = || own.iter().zip(other);
            product.extend(pairs().map(|(l, m)| a * l + b * m));
            product.extend(pairs().map(|(l, m)| b * l + c * m));
            at += 2;
        }
        let l = MatRef::from_column_major_slice(&done[..k * size], size, k);
        let rest = MatMut::from_column_major_slice_mut(rest, size, others);
        subtract_symmetric(
            rest.split_at_row_mut(complete).1,
            l.subrows(complete, others),
            MatRef::from_column_major_slice(&product, others, k).transpose(),
            par,
        );
        self.block = product;
    }
}

/// to ← to − left right, in the lower triangle of a symmetric matrix.
fn subtract_symmetric(
    to: MatMut<'_, f64>,
    left: MatRef<'_, f64>,
    right: MatRef<'_, f64>,
    par: Par,
) {
    triangular::matmul(
        to,
        BlockStructure::TriangularLower,
        Accum::Add,
        left,
        BlockStructure::Rectangular,
        right,
        BlockStructure::Rectangular,
        -1.0,
        par,
    );
}

/// Where the largest of some entries is, and its size; NaN if one is.
fn largest(column: &[f64], range: std::ops::Range<usize>) -> (usize, f64) {
    let mut found = (range.start, 0.0);
    for (i, v) in range.clone().zip(&column[range]) {
        if v.is_nan() {
            return (i, f64::NAN);
        }
        if v.abs() > found.1 {
            found = (i, v.abs());
        }
    }
    found
}

/// Inverse of a symmetric matrix of two rows with b ≠ 0: its entries (1, 1), (1, 2) and (2, 2).
pub(super) fn inverse(a: f64, b: f64, c: f64) -> [f64; 3] {
    let (a, c) = (a / b, c / b);
    let scale = 1.0 / ((a * c - 1.0) * b);
    [c * scale, -scale, a * scale]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns of which the second follows from the first: no pivot together, and one alone.
    #[test]
    fn columns_that_cancel_are_no_pivot_together() {
        let (a, c) = (0.9e-4, 1.0f64);
        let b = (a * c).sqrt();
        for by in [1.0 - 1e-16, 1.0, 1.0 + 3e-16] {
            let mut front = Front {
                index: vec![0, 1],
                ..Front::default()
            };
            front.begin(2);
            front.entries.copy_from_slice(&[a, b * by, f64::NAN, c]);
            let mut known = Pivots::of(2);
            front.eliminate(false, &mut known, (Par::Seq, Arch::new()));
            let expected = Inertia {
                positive: 1,
                negative: 0,
                zero: 1,
            };
            assert_eq!((known.inertia, known.zero), (expected, Some(0)));
            assert_eq!(known.least, c);
        }
    }
}
