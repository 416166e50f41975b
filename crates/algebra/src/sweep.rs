//! Sweeps through a Cholesky factor, x ← L⁻¹ x and x ← L⁻ᵀ x, on several threads; not its values.
//!
//! A solve reads the factor once and does little else: one thread does not read as fast as the memory gives. Subtrees
//! of the elimination tree have no unknown in common, and are swept at once; what they have in common, the trunk, is
//! swept supernode by supernode, the rows of a large one at once. The parts are those of the factor alone, and their
//! sums are added in one order: the same bits on any number of threads.

use pulp::Arch;
use std::ops::Range;

use crate::panel::{Backward, Forward, Panel, Product, TransposedProduct};
use crate::symbolic::{Supernode, Symbolic};

/// Entries of a factor from which on its branches are swept at once: a millisecond.
const LARGE: f64 = 1e6;

/// Part of the factor that a branch may have.
const PART: f64 = 1.0 / 16.0;

/// Columns of a supernode of the trunk that are swept together, and those of them that one thread reads.
const WIDE: usize = 256;
const NARROW: usize = 32;

/// Entries below a triangle from which on its columns are read at once: some twenty microseconds.
const PARALLEL: usize = 1 << 16;

/// A factor that is swept through: its first columns, so many, of all.
#[derive(Clone, Copy)]
pub(crate) struct Factor<'a> {
    pub(crate) symbolic: &'a Symbolic,
    pub(crate) values: &'a [f64],
    pub(crate) columns: usize,
    pub(crate) arch: Arch,
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

/// A subtree of the elimination tree: supernodes, of which the last is the root, and their columns.
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
pub(crate) struct Sweeps {
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
    pub(crate) fn new(symbolic: &Symbolic) -> Self {
        let large = symbolic.cost.entries >= LARGE;
        let roots = if large { roots(symbolic) } else { Vec::new() };
        let mut trunk = Vec::new();
        let mut outer = Vec::new();
        let mut branches = Vec::with_capacity(roots.len());
        let mut next = 0;
        for supernodes in roots {
            trunk.extend(next..supernodes.start);
            next = supernodes.end;
            let root = symbolic.supernode(next - 1);
            let columns = symbolic.supernode(supernodes.start).start..root.start + root.width;
            outer.resize(symbolic.rows_before(supernodes.start), 0);
            for s in supernodes.clone() {
                let rows = symbolic.supernode(s).rows.iter();
                let position = |i: &u32| root.rows.partition_point(|r| r < i) as u32;
                outer.extend(rows.map(position));
            }
            branches.push(Branch {
                supernodes,
                columns,
                own: Vec::new(),
                below: Vec::new(),
                outer: Vec::new(),
            });
        }
        trunk.extend(next..symbolic.count());
        Self {
            branches,
            trunk,
            outer,
            own: Vec::new(),
            below: Vec::new(),
            grouped: Vec::new(),
        }
    }

    /// x ← L⁻¹ x of some right-hand sides; what is below the columns is condensed.
    pub(crate) fn forward(&mut self, factor: Factor<'_>, x: &mut [f64]) {
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
    pub(crate) fn backward(&mut self, factor: Factor<'_>, x: &mut [f64]) {
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

/// Subtrees that are swept at once, in order: of the largest, those of its children, until none is large. Who has
/// kept unknowns, and whose descendants do not stand together before it, belongs to the trunk.
fn roots(symbolic: &Symbolic) -> Vec<Range<usize>> {
    let count = symbolic.count();
    let size = symbolic.pattern.size();
    let first_kept = size - symbolic.pattern.kept();
    let mut supernode_of = vec![0; size];
    for s in 0..count {
        let node = symbolic.supernode(s);
        supernode_of[node.start..node.start + node.width].fill(s);
    }
    // Of a subtree: its entries, its supernodes, the first of them, and the children of its root.
    let mut entries: Vec<f64> = Vec::with_capacity(count);
    let mut members = vec![1; count];
    let mut first: Vec<usize> = (0..count).collect();
    let mut children = vec![Vec::new(); count];
    let mut waiting = Vec::new();
    for s in 0..count {
        entries.push(symbolic.supernode(s).values.len() as f64);
    }
    for s in 0..count {
        match symbolic.supernode(s).rows.first() {
            Some(&row) => {
                let parent = supernode_of[row as usize];
                entries[parent] += entries[s];
                members[parent] += members[s];
                first[parent] = first[parent].min(first[s]);
                children[parent].push(s);
            }
            None => waiting.push(s),
        }
    }
    let large = PART * symbolic.cost.entries;
    let mut found = Vec::new();
    while let Some(s) = waiting.pop() {
        let node = symbolic.supernode(s);
        let is_whole = members[s] == s + 1 - first[s] && node.start + node.width <= first_kept;
        match is_whole && entries[s] <= large {
            true => found.push(first[s]..s + 1),
            false => waiting.extend(&children[s]),
        }
    }
    found.sort_unstable_by_key(|range| range.start);
    found
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

/// Does the work, on all threads where there are threads.
fn at_once<T: Send>(work: Vec<T>, each: impl Fn(T) + Sync + Send) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        work.into_par_iter().with_max_len(1).for_each(each);
    }
    #[cfg(not(feature = "parallel"))]
    work.into_iter().for_each(each);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::laplacian;
    use crate::{Cholesky, Engine, Pattern};
    use faer::Par;

    /// A x of the lower triangle of A.
    fn product(pattern: &Pattern, values: &[f64], x: &[f64]) -> Vec<f64> {
        let mut b = vec![0.0; x.len()];
        for j in 0..x.len() {
            let range = pattern.range(j);
            for (&i, v) in pattern.rows()[range.clone()].iter().zip(&values[range]) {
                b[i as usize] += v * x[j];
                if i as usize != j {
                    b[j] += v * x[i as usize];
                }
            }
        }
        b
    }

    fn largest(a: &[f64], b: &[f64]) -> f64 {
        let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max)
    }

    /// A Laplacian of which the last unknowns are coupled to each other, all of them: a large supernode of the trunk.
    fn with_dense_end(n: usize, dense: usize) -> (Pattern, Vec<f64>) {
        let (sparse, weights) = laplacian(n, 0.2);
        let size = sparse.size();
        let (mut start, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..size {
            let range = sparse.range(j);
            let own = sparse.rows()[range.clone()].iter().zip(&weights[range]);
            let mut column: std::collections::BTreeMap<u32, f64> =
                own.map(|(&i, &v)| (i, v)).collect();
            if j >= size - dense {
                for i in j..size {
                    let own = if i == j { 1.0 } else { -0.5 / dense as f64 };
                    *column.entry(i as u32).or_default() += own;
                }
            }
            rows.extend(column.keys());
            values.extend(column.values());
            start.push(rows.len() as u32);
        }
        (Pattern::new(start, rows).expect("ascending"), values)
    }

    #[test]
    fn branches_and_trunk_are_all_supernodes_once() {
        let (pattern, _) = laplacian(22, 0.2);
        let symbolic = Symbolic::new(&pattern.keeping(10).expect("so many"), None).expect("small");
        let sweeps = Sweeps::new(&symbolic);
        assert!(sweeps.branches.len() > 8, "{}", sweeps.branches.len());
        let branches = sweeps.branches.iter().flat_map(|b| b.supernodes.clone());
        let mut all: Vec<usize> = branches.chain(sweeps.trunk.iter().copied()).collect();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..symbolic.count()));
        let first_kept = symbolic.pattern.size() - 10;
        for branch in &sweeps.branches {
            assert!(branch.columns.end <= first_kept);
            let entries = branch.supernodes.clone();
            let entries = entries
                .map(|s| symbolic.supernode(s).values.len())
                .sum::<usize>();
            assert!(entries as f64 <= PART * symbolic.cost.entries);
        }
    }

    /// A solution solves, whatever else is solved with it, in one go or condensed and expanded.
    #[test]
    fn a_large_factor_solves_for_any_number_of_sides() {
        for (pattern, values) in [laplacian(22, 0.2), with_dense_end(20, 700)] {
            let n = pattern.size();
            let pattern = pattern.keeping(10).expect("so many");
            let mut engine = Cholesky::analyse_for(&pattern, None, Some(Par::Seq)).expect("small");
            assert!(engine.cost().entries > LARGE);
            engine.factorise(&values).expect("definite");
            let known: Vec<f64> = (0..9 * n).map(|i| (i as f64).sin()).collect();
            let b: Vec<f64> = known
                .chunks(n)
                .flat_map(|x| product(&pattern, &values, x))
                .collect();
            let mut together = b.clone();
            engine.solve(&mut together).expect("factorised");
            assert!(largest(&together, &known) < 1e-11);
            for (k, together) in together.chunks(n).enumerate() {
                let mut alone = b[k * n..][..n].to_vec();
                engine.solve(&mut alone).expect("factorised");
                assert!(alone == together, "side {k}");
                let mut parted = b[k * n..][..n].to_vec();
                engine.condense(&mut parted).expect("factorised");
                parted[n - 10..].copy_from_slice(&known[k * n..][n - 10..n]);
                engine.expand(&mut parted).expect("factorised");
                assert!(largest(&parted, &known[k * n..][..n]) < 1e-11);
            }
        }
    }
}
