//! Sweeps through a Cholesky factor, x ← L⁻¹ x and x ← L⁻ᵀ x, on several threads; not its values.
//!
//! A solve reads the factor once and does little else: one thread does not read as fast as the memory gives. Subtrees
//! of the elimination tree have no unknown in common, and are swept at once; what they have in common, the trunk, is
//! swept supernode by supernode, the rows of a large one at once. The parts are those of the factor alone, and their
//! sums are added in one order: the same bits on any number of threads.

use pulp::Arch;
use std::ops::Range;

use super::branches::{Branches, at_once};
use crate::panel::{Backward, Forward, Panel, Product, TransposedProduct};
use crate::symbolic::{Supernode, Symbolic};

/// Columns of a supernode of the trunk that are swept together, and those of them that one thread reads.
const WIDE: usize = 256;
const NARROW: usize = 32;

/// Entries below a triangle from which on its columns are read at once: some twenty microseconds.
const PARALLEL: usize = 1 << 16;

/// A factor that is swept through: its first columns, so many, of all.
#[derive(Clone, Copy)]
pub(super) struct Factor<'a> {
    pub(super) symbolic: &'a Symbolic,
    pub(super) values: &'a [f64],
    pub(super) columns: usize,
    pub(super) arch: Arch,
}

impl Factor<'_> {
    /// Columns of a supernode, of those that are swept through.
    fn panel(&self, node: &Supernode<'_>, columns: Range<usize>) -> Panel<'_> {
        let stored = node.width + node.rows.len();
        let values = &self.values[node.values.clone()];
        Panel {
            values: &values[columns.start * stored..columns.end * stored],
            stored,
            first: columns.start,
            width: columns.len(),
            rows: stored - columns.end,
            unit: false,
        }
    }

    fn size(&self) -> usize {
        self.symbolic.pattern.size()
    }
}

/// What the sweeps through a branch need: its supernodes, of which the last is the root, and their columns.
#[derive(Debug)]
struct Branch {
    supernodes: Range<usize>,
    columns: Range<usize>,
    own: Vec<f64>,
    below: Vec<f64>,
    /// What its columns are to the rows below its root, or what is known there.
    outer: Vec<f64>,
}

/// How a factor is swept through.
#[derive(Debug)]
pub(super) struct Sweeps {
    branches: Vec<Branch>,
    /// Supernodes that are in no branch.
    trunk: Vec<usize>,
    /// Which of the rows below the root of its branch each row of a supernode is, if it is one of them.
    outer: Vec<u32>,
    own: Vec<f64>,
    below: Vec<f64>,
    grouped: Vec<f64>,
}

impl Sweeps {
    pub(super) fn new(symbolic: &Symbolic, all: &Branches) -> Self {
        let mut outer = Vec::new();
        let mut branches = Vec::with_capacity(all.ranges.len());
        for supernodes in &all.ranges {
            let root = symbolic.supernode(supernodes.end - 1);
            let columns = symbolic.supernode(supernodes.start).start..root.start + root.width;
            outer.resize(symbolic.rows_before(supernodes.start), 0);
            for s in supernodes.clone() {
                let rows = symbolic.supernode(s).rows.iter();
                let position = |i: &u32| root.rows.partition_point(|r| r < i) as u32;
                outer.extend(rows.map(position));
            }
            branches.push(Branch {
                supernodes: supernodes.clone(),
                columns,
                own: Vec::new(),
                below: Vec::new(),
                outer: Vec::new(),
            });
        }
        Self {
            branches,
            trunk: all.trunk.clone(),
            outer,
            own: Vec::new(),
            below: Vec::new(),
            grouped: Vec::new(),
        }
    }

    /// x ← L⁻¹ x of some right-hand sides; what is below the columns is condensed.
    pub(super) fn forward(&mut self, factor: Factor<'_>, x: &mut [f64]) {
        let n = factor.size();
        let outer = &self.outer;
        let work = pieces(&mut self.branches, x, n);
        at_once(work, |(branch, mut x)| {
            branch.forward(factor, outer, &mut x)
        });
        for branch in &self.branches {
            let rows = factor.symbolic.supernode(branch.supernodes.end - 1).rows;
            if rows.is_empty() {
                continue;
            }
            for (x, sums) in x
                .chunks_exact_mut(n)
                .zip(branch.outer.chunks_exact(rows.len()))
            {
                for (&i, sum) in rows.iter().zip(sums) {
                    x[i as usize] -= sum;
                }
            }
        }
        for k in 0..self.trunk.len() {
            let node = factor.symbolic.supernode(self.trunk[k]);
            for columns in self.parts(&node, factor.columns) {
                self.panel_forward(factor, (&node, columns), x);
            }
        }
    }

    /// x ← L⁻ᵀ x, where the unknowns after the columns are known.
    pub(super) fn backward(&mut self, factor: Factor<'_>, x: &mut [f64]) {
        let n = factor.size();
        for k in (0..self.trunk.len()).rev() {
            let node = factor.symbolic.supernode(self.trunk[k]);
            for columns in self.parts(&node, factor.columns).rev() {
                self.panel_backward(factor, (&node, columns), x);
            }
        }
        for branch in &mut self.branches {
            let rows = factor.symbolic.supernode(branch.supernodes.end - 1).rows;
            let rows = rows.iter().map(|&i| i as usize);
            gather(x, n, rows, &mut branch.outer);
        }
        let outer = &self.outer;
        let work = pieces(&mut self.branches, x, n);
        at_once(work, |(branch, mut x)| {
            branch.backward(factor, outer, &mut x)
        });
    }

    /// Columns of a supernode of the trunk that are swept together, part by part.
    fn parts(
        &self,
        node: &Supernode<'_>,
        columns: usize,
    ) -> impl DoubleEndedIterator<Item = Range<usize>> + use<> {
        let width = node.width.min(columns.saturating_sub(node.start));
        let wide = if self.branches.is_empty() {
            width.max(1)
        } else {
            WIDE
        };
        (0..width.div_ceil(wide)).map(move |k| k * wide..width.min((k + 1) * wide))
    }

    /// Whether the columns of a panel of the trunk are read at once.
    fn is_large(&self, panel: Panel<'_>) -> bool {
        !self.branches.is_empty() && panel.rows * panel.width >= PARALLEL
    }

    fn panel_forward(
        &mut self,
        factor: Factor<'_>,
        (node, columns): (&Supernode<'_>, Range<usize>),
        x: &mut [f64],
    ) {
        let (n, sides) = (factor.size(), x.len() / factor.size());
        let panel = factor.panel(node, columns.clone());
        let (width, rows) = (panel.width, panel.rows);
        let at = node.start + columns.start;
        gather(x, n, at..at + width, &mut self.own);
        let is_large = self.is_large(panel);
        let parts = if is_large { width.div_ceil(NARROW) } else { 1 };
        self.below.resize(parts * rows * sides, 0.0);
        factor.arch.dispatch(Forward {
            panel: if is_large { panel.triangle() } else { panel },
            own: &mut self.own,
            below: if is_large { &mut [] } else { &mut self.below },
        });
        for (x, own) in x.chunks_exact_mut(n).zip(self.own.chunks_exact(width)) {
            x[at..at + width].copy_from_slice(own);
        }
        if is_large {
            regroup(&self.own, width, &mut self.grouped);
            let own = self.grouped.chunks(NARROW * sides);
            let sums = self.below.chunks_exact_mut(rows * sides);
            let work = own.zip(sums).enumerate().collect();
            at_once(work, |(k, (own, below)): (usize, (&[f64], &mut [f64]))| {
                let panel = panel.below(k * NARROW..width.min((k + 1) * NARROW));
                factor.arch.dispatch(Product { panel, own, below });
            });
        }
        if rows > 0 {
            for sums in self.below.chunks_exact(rows * sides) {
                for (x, sums) in x.chunks_exact_mut(n).zip(sums.chunks_exact(rows)) {
                    for (i, sum) in node.below(columns.end).zip(sums) {
                        x[i] -= sum;
                    }
                }
            }
        }
    }

    fn panel_backward(
        &mut self,
        factor: Factor<'_>,
        (node, columns): (&Supernode<'_>, Range<usize>),
        x: &mut [f64],
    ) {
        let (n, sides) = (factor.size(), x.len() / factor.size());
        let panel = factor.panel(node, columns.clone());
        let width = panel.width;
        let at = node.start + columns.start;
        gather(x, n, at..at + width, &mut self.own);
        gather(x, n, node.below(columns.end), &mut self.below);
        let is_large = self.is_large(panel);
        if is_large {
            let below = &self.below;
            self.grouped.resize(width * sides, 0.0);
            let work = self.grouped.chunks_mut(NARROW * sides).enumerate();
            at_once(work.collect(), |(k, own): (usize, &mut [f64])| {
                let panel = panel.below(k * NARROW..width.min((k + 1) * NARROW));
                factor
                    .arch
                    .dispatch(TransposedProduct { panel, own, below });
            });
            for (k, group) in self.grouped.chunks(NARROW * sides).enumerate() {
                let wide = group.len() / sides;
                let sides = self.own.chunks_exact_mut(width);
                for (own, sums) in sides.zip(group.chunks_exact(wide)) {
                    for (own, sum) in own[k * NARROW..][..wide].iter_mut().zip(sums) {
                        *own += sum;
                    }
                }
            }
        }
        factor.arch.dispatch(Backward {
            panel: if is_large { panel.triangle() } else { panel },
            own: &mut self.own,
            below: if is_large { &[] } else { &self.below },
        });
        for (x, own) in x.chunks_exact_mut(n).zip(self.own.chunks_exact(width)) {
            x[at..at + width].copy_from_slice(own);
        }
    }
}

impl Branch {
    /// x ← L⁻¹ x with its columns; what they are to the rows below its root is kept.
    fn forward(&mut self, factor: Factor<'_>, outer: &[u32], x: &mut [&mut [f64]]) {
        let symbolic = factor.symbolic;
        let ends = symbolic.supernode(self.supernodes.end - 1).rows.len();
        self.outer.clear();
        self.outer.resize(ends * x.len(), 0.0);
        for s in self.supernodes.clone() {
            let node = symbolic.supernode(s);
            let panel = factor.panel(&node, 0..node.width);
            let (width, rows) = (node.width, node.rows.len());
            let at = node.start - self.columns.start;
            self.own.clear();
            for x in x.iter() {
                self.own.extend_from_slice(&x[at..at + width]);
            }
            self.below.resize(rows * x.len(), 0.0);
            factor.arch.dispatch(Forward {
                panel,
                own: &mut self.own,
                below: &mut self.below,
            });
            let outer = &outer[symbolic.rows_before(s)..][..rows];
            let inner = self.inner(node.rows);
            for (k, x) in x.iter_mut().enumerate() {
                x[at..at + width].copy_from_slice(&self.own[k * width..][..width]);
                let (near, far) = self.below[k * rows..][..rows].split_at(inner);
                for (&i, sum) in node.rows.iter().zip(near) {
                    x[i as usize - self.columns.start] -= sum;
                }
                let sums = &mut self.outer[k * ends..][..ends];
                for (&i, sum) in outer[inner..].iter().zip(far) {
                    sums[i as usize] += sum;
                }
            }
        }
    }

    /// x ← L⁻ᵀ x, where what is below its root is known.
    fn backward(&mut self, factor: Factor<'_>, outer: &[u32], x: &mut [&mut [f64]]) {
        let symbolic = factor.symbolic;
        let ends = symbolic.supernode(self.supernodes.end - 1).rows.len();
        for s in self.supernodes.clone().rev() {
            let node = symbolic.supernode(s);
            let (width, rows) = (node.width, node.rows.len());
            let at = node.start - self.columns.start;
            let outer = &outer[symbolic.rows_before(s)..][..rows];
            let inner = self.inner(node.rows);
            self.own.clear();
            self.below.clear();
            for (k, x) in x.iter().enumerate() {
                self.own.extend_from_slice(&x[at..at + width]);
                let near = node.rows[..inner].iter();
                let near = near.map(|&i| x[i as usize - self.columns.start]);
                self.below.extend(near);
                let known = &self.outer[k * ends..][..ends];
                let far = outer[inner..].iter().map(|&i| known[i as usize]);
                self.below.extend(far);
            }
            factor.arch.dispatch(Backward {
                panel: factor.panel(&node, 0..width),
                own: &mut self.own,
                below: &self.below,
            });
            for (k, x) in x.iter_mut().enumerate() {
                x[at..at + width].copy_from_slice(&self.own[k * width..][..width]);
            }
        }
    }

    /// How many of some rows are columns of the branch.
    fn inner(&self, rows: &[u32]) -> usize {
        rows.partition_point(|&i| (i as usize) < self.columns.end)
    }
}

/// The branches with their parts of every right-hand side.
fn pieces<'a>(
    branches: &'a mut [Branch],
    x: &'a mut [f64],
    n: usize,
) -> Vec<(&'a mut Branch, Vec<&'a mut [f64]>)> {
    let mut work: Vec<_> = branches.iter_mut().map(|b| (b, Vec::new())).collect();
    for x in x.chunks_exact_mut(n) {
        let (mut rest, mut at) = (x, 0);
        for (branch, pieces) in &mut work {
            let (_, after) = std::mem::take(&mut rest).split_at_mut(branch.columns.start - at);
            let (piece, after) = after.split_at_mut(branch.columns.len());
            pieces.push(piece);
            (rest, at) = (after, branch.columns.end);
        }
    }
    work
}

/// Some columns of a triangle after the others, and of some all right-hand sides.
fn regroup(own: &[f64], width: usize, grouped: &mut Vec<f64>) {
    grouped.clear();
    for from in (0..width).step_by(NARROW) {
        let part = from..width.min(from + NARROW);
        for own in own.chunks_exact(width) {
            grouped.extend_from_slice(&own[part.clone()]);
        }
    }
}

/// Some rows of every column of x, column by column.
fn gather(x: &[f64], size: usize, rows: impl Iterator<Item = usize> + Clone, to: &mut Vec<f64>) {
    to.clear();
    for x in x.chunks_exact(size) {
        to.extend(rows.clone().map(|i| x[i]));
    }
}
