//! Triangular solves with the columns of a supernode, for any number of right-hand sides; not which
//! supernodes there are.
//!
//! A solve reads the factor once and does little else: what counts is that an entry of it, once read,
//! serves all right-hand sides. The sums of one are added in the same order however many go along with
//! it, without fusing products into sums: the same bits on any processor.

use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Right-hand sides that are solved for at once: what is gathered of them stays near the processor.
pub(crate) const SIDES: usize = 8;

/// Rows that are gone through at once: those of four columns and of all right-hand sides are then next to the
/// processor.
const ROWS: usize = 1024;

/// Columns of a factor that are read at once: what they are added to, or multiplied by, is read once for
/// all.
const TOGETHER: usize = 4;

/// Columns of a lower triangular factor with the same rows: a triangle, and what is below it.
#[derive(Clone, Copy)]
pub(crate) struct Panel<'a> {
    /// Values, column by column.
    pub(crate) values: &'a [f64],
    /// Number of rows that are stored.
    pub(crate) stored: usize,
    /// The one at which the triangle begins.
    pub(crate) first: usize,
    /// Number of columns.
    pub(crate) width: usize,
    /// Number of rows below the triangle.
    pub(crate) rows: usize,
    /// Whether the diagonal is 1, whatever is stored there.
    pub(crate) unit: bool,
}

impl<'a> Panel<'a> {
    /// Some of its columns, without the triangle.
    pub(crate) fn below(self, columns: Range<usize>) -> Self {
        Self {
            values: &self.values[columns.start * self.stored..columns.end * self.stored],
            first: self.first + self.width - columns.len(),
            width: columns.len(),
            ..self
        }
    }

    /// The triangle alone.
    pub(crate) fn triangle(self) -> Self {
        Self { rows: 0, ..self }
    }

    /// Its columns, from the triangle on.
    #[inline(always)]
    fn columns(self) -> impl DoubleEndedIterator<Item = &'a [f64]> + ExactSizeIterator {
        let columns = self.values.chunks_exact(self.stored);
        columns.map(move |column| &column[self.first..][..self.width + self.rows])
    }

    /// Some rows below the triangle of some columns.
    #[inline(always)]
    fn lower(self, columns: &'a [f64], part: Range<usize>) -> impl Iterator<Item = &'a [f64]> {
        let from = self.first + self.width + part.start;
        let columns = columns.chunks_exact(self.stored);
        columns.map(move |column| &column[from..][..part.len()])
    }

    /// Some rows below the triangle of four columns.
    #[inline(always)]
    fn four(self, columns: &'a [f64], part: Range<usize>) -> [&'a [f64]; TOGETHER] {
        let from = self.first + self.width + part.start;
        std::array::from_fn(|k| &columns[k * self.stored + from..][..part.len()])
    }
}

/// `own` ← L₁⁻¹ `own` with the triangle L₁, then `below` ← L₂ `own` with the rows below it. Both are columns
/// one after the other.
pub(crate) struct Forward<'a> {
    pub(crate) panel: Panel<'a>,
    pub(crate) own: &'a mut [f64],
    pub(crate) below: &'a mut [f64],
}

/// `own` ← L₁⁻ᵀ (`own` − L₂ᵀ `below`).
pub(crate) struct Backward<'a> {
    pub(crate) panel: Panel<'a>,
    pub(crate) own: &'a mut [f64],
    pub(crate) below: &'a [f64],
}

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { panel, own, below } = self;
        let width = panel.width;
        for (j, column) in panel.columns().enumerate() {
            for own in own.chunks_exact_mut(width) {
                let solved = if panel.unit {
                    own[j]
                } else {
                    own[j] / column[j]
                };
                own[j] = solved;
                for (x, l) in own[j + 1..].iter_mut().zip(&column[j + 1..width]) {
                    *x -= l * solved;
                }
            }
        }
        below.fill(0.0);
        multiply(panel, own, below);
    }
}

/// `below` ← L₂ `own`, alone.
pub(crate) struct Product<'a> {
    pub(crate) panel: Panel<'a>,
    pub(crate) own: &'a [f64],
    pub(crate) below: &'a mut [f64],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { panel, own, below } = self;
        below.fill(0.0);
        multiply(panel, own, below);
    }
}

/// Adds L₂ `own` to `below`.
#[inline(always)]
fn multiply(panel: Panel<'_>, own: &[f64], below: &mut [f64]) {
    let rows = panel.rows;
    for from in (0..rows).step_by(ROWS) {
        add_rows(panel, own, below, from..rows.min(from + ROWS));
    }
}

/// Adds to some rows of `below` their part of L₂ `own`.
#[inline(always)]
fn add_rows(panel: Panel<'_>, own: &[f64], below: &mut [f64], part: Range<usize>) {
    let (width, stored) = (panel.width, panel.stored);
    let mut rest = panel.values;
    for first in (0..width).step_by(TOGETHER) {
        let (columns, others) = rest.split_at(rest.len().min(TOGETHER * stored));
        rest = others;
        let own = own.chunks_exact(width);
        let mut sides = own.zip(below.chunks_exact_mut(panel.rows));
        if first + TOGETHER > width {
            for (x, sum) in sides {
                for (l, x) in panel.lower(columns, part.clone()).zip(&x[first..]) {
                    for (sum, l) in sum[part.clone()].iter_mut().zip(l) {
                        *sum += l * x;
                    }
                }
            }
            return;
        }
        let columns = panel.four(columns, part.clone());
        while let Some((x, sum)) = sides.next() {
            let (x, sum) = (four(&x[first..]), &mut sum[part.clone()]);
            match sides.next() {
                Some((y, other)) => {
                    let y = four(&y[first..]);
                    add_two(columns, [x, y], sum, &mut other[part.clone()]);
                }
                None => add_one(columns, x, sum),
            }
        }
    }
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { panel, own, below } = self;
        let width = panel.width;
        multiply_transposed(panel, own, below);
        for (j, column) in panel.columns().enumerate().rev() {
            for own in own.chunks_exact_mut(width) {
                let left = own[j] - dot(&column[j + 1..width], &own[j + 1..]);
                own[j] = if panel.unit { left } else { left / column[j] };
            }
        }
    }
}

/// `own` ← −L₂ᵀ `below`, alone.
pub(crate) struct TransposedProduct<'a> {
    pub(crate) panel: Panel<'a>,
    pub(crate) own: &'a mut [f64],
    pub(crate) below: &'a [f64],
}

impl WithSimd for TransposedProduct<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { panel, own, below } = self;
        own.fill(0.0);
        multiply_transposed(panel, own, below);
    }
}

/// Subtracts L₂ᵀ `below` from `own`.
#[inline(always)]
fn multiply_transposed(panel: Panel<'_>, own: &mut [f64], below: &[f64]) {
    let rows = panel.rows;
    for from in (0..rows).step_by(ROWS) {
        subtract_rows(panel, own, below, from..rows.min(from + ROWS));
    }
}

/// Subtracts from `own` what some rows of `below` are to L₂ᵀ `below`.
#[inline(always)]
fn subtract_rows(panel: Panel<'_>, own: &mut [f64], below: &[f64], part: Range<usize>) {
    let (width, stored) = (panel.width, panel.stored);
    let mut rest = panel.values;
    for first in (0..width).step_by(TOGETHER) {
        let (columns, others) = rest.split_at(rest.len().min(TOGETHER * stored));
        rest = others;
        let own = own.chunks_exact_mut(width);
        let mut sides = own.zip(below.chunks_exact(panel.rows));
        if first + TOGETHER > width {
            for (x, known) in sides {
                for (l, x) in panel.lower(columns, part.clone()).zip(&mut x[first..]) {
                    *x -= dot(l, &known[part.clone()]);
                }
            }
            return;
        }
        let columns = panel.four(columns, part.clone());
        let subtract = |x: &mut [f64], sums: [f64; TOGETHER]| {
            for (x, sum) in x[first..first + TOGETHER].iter_mut().zip(sums) {
                *x -= sum;
            }
        };
        while let Some((x, known)) = sides.next() {
            let known = &known[part.clone()];
            match sides.next() {
                Some((y, other)) => {
                    let [of_x, of_y] = dots_two(columns, known, &other[part.clone()]);
                    subtract(x, of_x);
                    subtract(y, of_y);
                }
                None => subtract(x, dots_one(columns, known)),
            }
        }
    }
}

/// The first four numbers.
#[inline(always)]
fn four(x: &[f64]) -> [f64; TOGETHER] {
    std::array::from_fn(|k| x[k])
}

/// sum ← sum + Σ column x of four columns.
#[inline(always)]
pub(crate) fn add_one(columns: [&[f64]; TOGETHER], x: [f64; TOGETHER], sum: &mut [f64]) {
    let n = sum.len();
    let [p, q, r, s] = columns.map(|column| &column[..n]);
    let [a, b, c, d] = x;
    for i in 0..n {
        sum[i] += (p[i] * a + q[i] * b) + (r[i] * c + s[i] * d);
    }
}

/// The same for two right-hand sides.
#[inline(always)]
fn add_two(
    columns: [&[f64]; TOGETHER],
    x: [[f64; TOGETHER]; 2],
    sum: &mut [f64],
    other: &mut [f64],
) {
    let n = sum.len();
    let other = &mut other[..n];
    let [p, q, r, s] = columns.map(|column| &column[..n]);
    let [[a, b, c, d], [e, f, g, h]] = x;
    for i in 0..n {
        let (p, q, r, s) = (p[i], q[i], r[i], s[i]);
        sum[i] += (p * a + q * b) + (r * c + s * d);
        other[i] += (p * e + q * f) + (r * g + s * h);
    }
}

/// Partial sums of a product, which a processor adds at once.
const LANES: usize = 4;

/// The products of four columns with one.
#[inline(always)]
fn dots_one(columns: [&[f64]; TOGETHER], known: &[f64]) -> [f64; TOGETHER] {
    let mut sums = [[0.0; LANES]; TOGETHER];
    let whole = known.len() - known.len() % LANES;
    for i in (0..whole).step_by(LANES) {
        let x = &known[i..i + LANES];
        for (sums, column) in sums.iter_mut().zip(&columns) {
            let l = &column[i..i + LANES];
            for k in 0..LANES {
                sums[k] += l[k] * x[k];
            }
        }
    }
    closed(columns, known, whole, sums)
}

/// The same for two right-hand sides.
#[inline(always)]
fn dots_two(columns: [&[f64]; TOGETHER], known: &[f64], other: &[f64]) -> [[f64; TOGETHER]; 2] {
    let mut sums = [[[0.0; LANES]; TOGETHER]; 2];
    let whole = known.len() - known.len() % LANES;
    for i in (0..whole).step_by(LANES) {
        let (x, y) = (&known[i..i + LANES], &other[i..i + LANES]);
        for (j, column) in columns.iter().enumerate() {
            let l = &column[i..i + LANES];
            for k in 0..LANES {
                sums[0][j][k] += l[k] * x[k];
                sums[1][j][k] += l[k] * y[k];
            }
        }
    }
    let [one, two] = sums;
    [
        closed(columns, known, whole, one),
        closed(columns, other, whole, two),
    ]
}

/// The partial sums and what is left of the products beyond whole lanes.
#[inline(always)]
fn closed(
    columns: [&[f64]; TOGETHER],
    known: &[f64],
    whole: usize,
    sums: [[f64; LANES]; TOGETHER],
) -> [f64; TOGETHER] {
    std::array::from_fn(|j| {
        let rest = columns[j][whole..].iter().zip(&known[whole..]);
        sums[j].iter().sum::<f64>() + rest.map(|(l, x)| l * x).sum::<f64>()
    })
}

/// Σ a b in an order that lets a processor add several at once.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest = a.remainder().iter().zip(b.remainder());
    let rest: f64 = rest.map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for k in 0..LANES {
            sums[k] += a[k] * b[k];
        }
    }
    rest + sums.iter().sum::<f64>()
}
