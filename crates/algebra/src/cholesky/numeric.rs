//! The numbers of a Cholesky factor, supernode by supernode from those before it, on several threads; not what is
//! solved with them.
//!
//! Branches of the elimination tree are factorised at once. Of the trunk that they grow from a supernode after the
//! other is put together, some of its columns by each thread, and factorised by all threads. What is added to an
//! entry, and in which order, is the same on any number of threads: so is the factor, to the bit.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{self, LltError};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve;
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use std::ops::Range;

use super::branches::{Branches, at_once};
use crate::symbolic::{Supernode, Symbolic};

/// Parts of a supernode of the trunk of which each thread makes some.
const PARTS: usize = 16;

/// Columns that a product has, if there are so many, and a part has at least: with fewer it spends its time on getting ready.
const NARROW: usize = 96;

/// Rows below a triangle that are solved for at once.
const ROWS: usize = 256;

/// Supernodes from which those after them are made.
#[derive(Debug)]
pub(super) struct Updates {
    /// Where those of a supernode begin.
    start: Vec<usize>,
    /// Supernodes that have rows among its columns, ascending.
    from: Vec<u32>,
}

impl Updates {
    pub(super) fn new(symbolic: &Symbolic) -> Self {
        let count = symbolic.count();
        let of = symbolic.supernode_of_columns();
        let reached = |s: usize| {
            let mut last = s as u32;
            let rows = symbolic.supernode(s).rows.iter();
            rows.map(|&i| of[i as usize])
                .filter(move |&to| std::mem::replace(&mut last, to) != to)
        };
        let mut start = vec![0; count + 1];
        for s in 0..count {
            reached(s).for_each(|to| start[to as usize + 1] += 1);
        }
        for s in 0..count {
            start[s + 1] += start[s];
        }
        let (mut next, mut from) = (start.clone(), vec![0; start[count]]);
        for s in 0..count {
            for to in reached(s) {
                from[next[to as usize]] = s as u32;
                next[to as usize] += 1;
            }
        }
        Self { start, from }
    }

    fn of(&self, s: usize) -> &[u32] {
        &self.from[self.start[s]..self.start[s + 1]]
    }
}

/// What a factor is made of.
#[derive(Clone, Copy)]
pub(super) struct Numeric<'a> {
    pub(super) symbolic: &'a Symbolic,
    pub(super) updates: &'a Updates,
    /// Entries of the lower triangle.
    pub(super) values: &'a [f64],
}

/// Numbers of the supernodes before one, from a position on.
#[derive(Clone, Copy)]
struct Before<'a> {
    from: usize,
    numbers: &'a [f64],
}

impl Numeric<'_> {
    /// Makes the factor.
    ///
    /// # Errors
    /// The row of a pivot that is not positive.
    pub(super) fn factorise(self, branches: &Branches, numbers: &mut [f64]) -> Result<(), usize> {
        if branches.ranges.is_empty() {
            return self.branch(0..self.symbolic.count(), 0, numbers);
        }
        self.branches(branches, numbers)?;
        let part = |width: usize| width.min(width.div_ceil(PARTS).max(NARROW));
        let mut room = Room::new(part(self.widest(branches.trunk.iter().copied())));
        let mut place = vec![0; self.symbolic.pattern.size()];
        for &s in &branches.trunk {
            let node = self.symbolic.supernode(s);
            let part = part(node.width);
            let (before, own) = numbers[..node.values.end].split_at_mut(node.values.start);
            let before = Before {
                from: 0,
                numbers: before,
            };
            node.number(&mut place);
            let height = node.width + node.rows.len();
            let parts = own.chunks_mut(part * height).enumerate();
            at_once(parts.collect(), |(k, own): (usize, &mut [f64])| {
                let first = node.start + k * part;
                let columns = Columns {
                    range: first..first + own.len() / height,
                    height,
                    place: &place,
                    own,
                };
                self.put_together(s, columns, before, &mut Vec::new());
            });
            room.factorise(&node, part, own)?;
        }
        Ok(())
    }

    /// Columns of the widest of some supernodes.
    fn widest(self, supernodes: impl Iterator<Item = usize>) -> usize {
        let widths = supernodes.map(|s| self.symbolic.supernode(s).width);
        widths.max().unwrap_or(0)
    }

    /// All branches at once.
    fn branches(self, branches: &Branches, numbers: &mut [f64]) -> Result<(), usize> {
        let mut outcomes = vec![Ok(()); branches.ranges.len()];
        let (mut rest, mut at) = (numbers, 0);
        let mut work = Vec::with_capacity(outcomes.len());
        for (range, outcome) in branches.ranges.iter().zip(&mut outcomes) {
            let from = self.symbolic.supernode(range.start).values.start;
            let to = self.symbolic.supernode(range.end - 1).values.end;
            let (_, after) = std::mem::take(&mut rest).split_at_mut(from - at);
            let (own, after) = after.split_at_mut(to - from);
            work.push((range.clone(), from, own, outcome));
            (rest, at) = (after, to);
        }
        at_once(work, |(range, from, numbers, outcome)| {
            *outcome = self.branch(range, from, numbers);
        });
        outcomes.into_iter().collect()
    }

    /// Supernodes of a branch, whose numbers are there from a position on.
    fn branch(
        self,
        supernodes: Range<usize>,
        from: usize,
        numbers: &mut [f64],
    ) -> Result<(), usize> {
        let mut room = Room::new(self.widest(supernodes.clone()));
        let mut products = Vec::new();
        let mut place = vec![0; self.symbolic.pattern.size()];
        for s in supernodes {
            let node = self.symbolic.supernode(s);
            let (before, own) =
                numbers[..node.values.end - from].split_at_mut(node.values.start - from);
            let before = Before {
                from,
                numbers: before,
            };
            node.number(&mut place);
            let columns = Columns {
                range: node.start..node.start + node.width,
                height: node.width + node.rows.len(),
                place: &place,
                own,
            };
            self.put_together(s, columns, before, &mut products);
            room.factorise(&node, node.width, own)?;
        }
        Ok(())
    }

    /// Some columns of a supernode: those of the matrix, less what the supernodes before it take from them.
    fn put_together(self, s: usize, mut to: Columns<'_>, before: Before<'_>, room: &mut Vec<f64>) {
        let pattern = &self.symbolic.pattern;
        to.own.fill(0.0);
        for (j, own) in to.range.clone().zip(to.own.chunks_exact_mut(to.height)) {
            let rows = &pattern.rows()[pattern.range(j)];
            for (&i, v) in rows.iter().zip(&self.values[pattern.range(j)]) {
                own[to.place[i as usize] as usize] = *v;
            }
        }
        for &d in self.updates.of(s) {
            let other = self.symbolic.supernode(d as usize);
            let values = other.values.start - before.from..other.values.end - before.from;
            to.subtract(&other, &before.numbers[values], room);
        }
    }
}

/// Columns of a supernode that are put together.
struct Columns<'a> {
    range: Range<usize>,
    /// Number of rows, and where they are.
    height: usize,
    place: &'a [u32],
    own: &'a mut [f64],
}

impl Columns<'_> {
    /// Less what another supernode takes from them: the product of its rows, and those of them that are among the columns.
    fn subtract(&mut self, other: &Supernode<'_>, values: &[f64], room: &mut Vec<f64>) {
        let l =
            MatRef::from_column_major_slice(values, other.width + other.rows.len(), other.width);
        let before = |column: usize| other.rows.partition_point(|&i| (i as usize) < column);
        let (start, end) = (before(self.range.start), before(self.range.end));
        for from in (start..end).step_by(NARROW) {
            let (rows, wide) = (&other.rows[from..], NARROW.min(end - from));
            let below = l.subrows(other.width + from, rows.len());
            let beside = below.subrows(0, wide).transpose();
            let column = |k: usize| rows[k] as usize - self.range.start;
            let row = |k: usize| self.place[rows[k] as usize] as usize;
            if row(rows.len() - 1) - row(0) + 1 == rows.len() {
                // They follow each other here, too. What comes to lie above the diagonal is not read.
                let (height, width) = (self.height, self.range.len());
                let (at, first) = (row(0), column(0));
                let own = MatMut::from_column_major_slice_mut(self.own, height, width);
                let own = own.submatrix_mut(at, first, rows.len(), wide);
                matmul(own, Accum::Add, below, beside, -1.0, Par::Seq);
                continue;
            }
            let size = rows.len() * wide;
            room.resize(size.max(room.len()), 0.0);
            let product = MatMut::from_column_major_slice_mut(&mut room[..size], rows.len(), wide);
            matmul(product, Accum::Replace, below, beside, 1.0, Par::Seq);
            for (k, product) in room[..size].chunks_exact(rows.len()).enumerate() {
                let own = &mut self.own[column(k) * self.height..][..self.height];
                for (&i, product) in rows[k..].iter().zip(&product[k..]) {
                    own[self.place[i as usize] as usize] -= product;
                }
            }
        }
    }
}

impl Supernode<'_> {
    /// Numbers its rows.
    fn number(&self, place: &mut [u32]) {
        for (k, i) in self.below(0).enumerate() {
            place[i] = k as u32;
        }
    }
}

/// What the dense factorisations of supernodes need.
struct Room(MemBuffer);

impl Room {
    /// For supernodes of at most so many columns.
    fn new(width: usize) -> Self {
        let own = Default::default();
        let request = factor::cholesky_in_place_scratch::<f64>(width, Par::Seq, own);
        Self(MemBuffer::new(request))
    }

    /// L of a supernode, of which all that is to be taken from it has been: so many columns after the other, what is
    /// below and beside them at once.
    fn factorise(
        &mut self,
        node: &Supernode<'_>,
        part: usize,
        own: &mut [f64],
    ) -> Result<(), usize> {
        let height = node.width + node.rows.len();
        let mut rest = MatMut::from_column_major_slice_mut(own, height, node.width);
        for first in (0..node.width).step_by(part) {
            let width = part.min(node.width - first);
            let (panel, others) = rest.split_at_col_mut(width);
            let (mut top, mut below) = panel.split_at_row_mut(width);
            factor::cholesky_in_place(
                top.rb_mut(),
                Default::default(),
                Par::Seq,
                MemStack::new(&mut self.0),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| node.start + first + index)?;
            let top = top.rb();
            at_once(chunks(below.rb_mut().transpose_mut(), ROWS), |rows| {
                triangular_solve::solve_lower_triangular_in_place(top, rows, Par::Seq);
            });
            let below = below.rb();
            let mut others = others.split_at_row_mut(width).1;
            let beside = chunks(others.rb_mut(), part).into_iter().enumerate();
            at_once(
                beside.collect(),
                |(k, columns): (usize, MatMut<'_, f64>)| {
                    let (from, wide) = (k * part, columns.ncols());
                    let l = below.subrows(from, below.nrows() - from);
                    matmul(
                        columns.subrows_mut(from, l.nrows()),
                        Accum::Add,
                        l,
                        l.subrows(0, wide).transpose(),
                        -1.0,
                        Par::Seq,
                    );
                },
            );
            rest = others;
        }
        Ok(())
    }
}

/// So many columns of a matrix after the others.
fn chunks(matrix: MatMut<'_, f64>, columns: usize) -> Vec<MatMut<'_, f64>> {
    let (mut rest, mut all) = (matrix, Vec::new());
    while rest.ncols() > columns {
        let (chunk, after) = rest.split_at_col_mut(columns);
        all.push(chunk);
        rest = after;
    }
    all.push(rest);
    all
}
