//! Numeric Cholesky factorisation front by front, along the tree of the supernodes; not its dense
//! kernels, and not the symbolic work.

use crate::cholesky::{Kernels, NotPositiveDefinite, Pattern};
use std::ops::Range;

/// Consecutive columns of L with the same rows below them.
#[derive(Debug, Clone)]
pub(crate) struct Supernode {
    /// First column.
    pub(crate) start: usize,
    /// Number of columns.
    pub(crate) width: usize,
    /// Where its rows below are among all [`Fronts::rows`].
    pub(crate) below: Range<usize>,
    /// Where its values are, column by column: those of its own rows, then those below.
    pub(crate) values: Range<usize>,
}

impl Supernode {
    fn height(&self) -> usize {
        self.width + self.below.len()
    }

    /// Multiplications of its elimination, up to a factor.
    fn work(&self) -> f64 {
        self.width as f64 * (self.height() as f64).powi(2)
    }
}

/// The supernodes of a factor, the tree in which they wait for each other, and what of it may go on
/// side by side.
///
/// The front of a supernode holds its columns of K and what the elimination of its children leaves
/// for them and for the rows below. It is eliminated by dense kernels; what it leaves for the rows
/// below goes to its parent, the supernode of the first of these rows. Subtrees without a common
/// supernode know nothing of each other: every sum is the same whichever is done first.
#[derive(Debug)]
pub(crate) struct Fronts {
    pub(crate) supernodes: Vec<Supernode>,
    /// Rows below the supernodes, ascending in each.
    pub(crate) rows: Vec<u32>,
    children: Vec<Vec<u32>>,
    plan: Plan,
}

/// Consecutive supernodes: one after the other, or two closed halves side by side before the rest.
#[derive(Debug)]
enum Plan {
    Serial(Range<usize>),
    Split(Range<usize>, Box<[Plan; 2]>),
}

impl Plan {
    fn range(&self) -> Range<usize> {
        match self {
            Self::Serial(range) | Self::Split(range, _) => range.clone(),
        }
    }
}

/// Work below which a range is not split: some milliseconds.
const GRAIN: f64 = 1e8;

/// Supernodes at the end of a range that may have to wait for both halves.
const SEPARATOR: usize = 256;

/// What an elimination leaves for the rows below: a full square by columns, its lower triangle used.
type Update = Option<Vec<f64>>;

impl Fronts {
    /// From the supernodes in the order of their columns, and the rows below them.
    pub(crate) fn new(supernodes: Vec<Supernode>, rows: Vec<u32>) -> Self {
        let count = supernodes.len();
        let parent = |s: &Supernode| {
            let first = rows[s.below.clone()].first().map(|&row| row as usize);
            first.map_or(count, |row| {
                supernodes.partition_point(|t| t.start <= row) - 1
            })
        };
        let parents: Vec<usize> = supernodes.iter().map(parent).collect();
        let mut children = vec![Vec::new(); count];
        for (s, &p) in parents.iter().enumerate().filter(|(_, p)| **p < count) {
            children[p].push(s as u32);
        }
        let work: Vec<f64> = supernodes.iter().map(Supernode::work).collect();
        Self {
            plan: plan(0..count, &parents, &work),
            supernodes,
            rows,
            children,
        }
    }

    /// Number of values of the factor.
    pub(crate) fn value_count(&self) -> usize {
        self.supernodes.last().map_or(0, |s| s.values.end)
    }

    /// Largest width of a supernode.
    pub(crate) fn widest(&self) -> usize {
        self.supernodes.iter().map(|s| s.width).max().unwrap_or(0)
    }

    /// L Lᵀ of the matrix with these values on a pattern, on as many threads as there are.
    pub(crate) fn factorise(
        &self,
        pattern: &Pattern,
        values: &[f64],
        factor: &mut [f64],
    ) -> Result<(), NotPositiveDefinite> {
        let mut updates: Vec<Update> = vec![None; self.supernodes.len()];
        self.run(&self.plan, (pattern, values), factor, &mut updates)
    }

    /// `factor` and `updates` are those of the supernodes of the plan.
    fn run(
        &self,
        plan: &Plan,
        matrix: (&Pattern, &[f64]),
        factor: &mut [f64],
        updates: &mut [Update],
    ) -> Result<(), NotPositiveDefinite> {
        let range = plan.range();
        let mut rest = range.clone();
        if let Plan::Split(_, halves) = plan {
            let [left, right] = halves.as_ref();
            let (middle, end) = (right.range().start, right.range().end);
            let at = |s: usize| self.offset(s) - self.offset(range.start);
            let (of_left, of_right) = factor.split_at_mut(at(middle));
            let (own_left, own_right) = updates.split_at_mut(middle - range.start);
            let of_right = &mut of_right[..at(end) - at(middle)];
            let own_right = &mut own_right[..end - middle];
            let (first, second) = rayon::join(
                || self.run(left, matrix, of_left, own_left),
                || self.run(right, matrix, of_right, own_right),
            );
            first.and(second)?;
            rest.start = end;
        }
        let mut kernels = Kernels::new(self.widest());
        for s in rest {
            self.eliminate(s, matrix, factor, (range.start, updates), &mut kernels)?;
        }
        Ok(())
    }

    /// First value of a supernode, or the end of all.
    fn offset(&self, s: usize) -> usize {
        match self.supernodes.get(s) {
            Some(s) => s.values.start,
            None => self.value_count(),
        }
    }

    /// Sets up and eliminates the front of supernode s; `first` is that of `factor` and `updates`.
    fn eliminate(
        &self,
        s: usize,
        (pattern, values): (&Pattern, &[f64]),
        factor: &mut [f64],
        (first, updates): (usize, &mut [Update]),
        kernels: &mut Kernels,
    ) -> Result<(), NotPositiveDefinite> {
        let own = &self.supernodes[s];
        let below = &self.rows[own.below.clone()];
        let (width, height) = (own.width, own.height());
        let at = self.offset(first);
        let panel = &mut factor[own.values.start - at..own.values.end - at];
        panel.fill(0.0);
        for (j, column) in panel.chunks_exact_mut(height).enumerate() {
            let entries = pattern.range((own.start + j) as u32);
            let mut place = Place::new(own, below);
            for (&row, value) in pattern.row[entries.clone()].iter().zip(&values[entries]) {
                column[place.of(row)] += value;
            }
        }
        let mut update = vec![0.0; below.len() * below.len()];
        let mut places = Vec::new();
        for &child in &self.children[s] {
            let rows = &self.rows[self.supernodes[child as usize].below.clone()];
            let Some(left) = updates[child as usize - first].take() else {
                continue;
            };
            let mut place = Place::new(own, below);
            places.clear();
            places.extend(rows.iter().map(|&row| place.of(row)));
            for (j, column) in left.chunks_exact(rows.len()).enumerate() {
                let (to, skip) = match places[j] {
                    k if k < width => (&mut panel[k * height..(k + 1) * height], 0),
                    k => {
                        let size = below.len();
                        (
                            &mut update[(k - width) * size..(k - width + 1) * size],
                            width,
                        )
                    }
                };
                for (&place, value) in places[j..].iter().zip(&column[j..]) {
                    to[place - skip] += value;
                }
            }
        }
        kernels
            .eliminate(panel, width, &mut update)
            .map_err(|row| NotPositiveDefinite {
                row: own.start + row,
            })?;
        if !below.is_empty() {
            updates[s - first] = Some(update);
        }
        Ok(())
    }
}

/// Finds ascending rows in a front.
struct Place<'a> {
    start: usize,
    width: usize,
    below: &'a [u32],
    next: usize,
}

impl<'a> Place<'a> {
    fn new(supernode: &Supernode, below: &'a [u32]) -> Self {
        Self {
            start: supernode.start,
            width: supernode.width,
            below,
            next: 0,
        }
    }

    /// Position in the front; rows are asked for in ascending order.
    fn of(&mut self, row: u32) -> usize {
        let own = row as usize - self.start;
        if own < self.width {
            return own;
        }
        while self.below[self.next] < row {
            self.next += 1;
        }
        self.width + self.next
    }
}

/// Splits a range of supernodes into two halves of similar work that do not wait for each other, and
/// the few after them that wait for both.
fn plan(range: Range<usize>, parents: &[usize], work: &[f64]) -> Plan {
    let total: f64 = work[range.clone()].iter().sum();
    let least = range.end.saturating_sub(SEPARATOR).max(range.start + 1);
    for end in (least..=range.end).rev() {
        if total < GRAIN {
            break;
        }
        // A cut is between halves if no supernode before it waits for one after it.
        let all: f64 = work[range.start..end].iter().sum();
        let (mut reach, mut left, mut best) = (0, 0.0, (0.0, 0));
        for s in range.start..end {
            reach = reach.max(if parents[s] < end { parents[s] } else { s });
            left += work[s];
            let lesser = f64::min(left, all - left);
            if reach <= s && lesser > best.0 {
                best = (lesser, s + 1);
            }
        }
        if best.0 >= total / 8.0 {
            let halves = [range.start..best.1, best.1..end];
            let halves = halves.map(|half| plan(half, parents, work));
            return Plan::Split(range, Box::new(halves));
        }
    }
    Plan::Serial(range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky::Cholesky;
    use crate::ordering::nested_dissection;

    /// Seven-point Laplacian of a cube of nodes, made definite, in nested-dissection order.
    fn laplacian(n: usize) -> (Pattern, Vec<f64>) {
        let at = |k: usize| [k % n, k / n % n, k / (n * n)];
        let points: Vec<[f64; 3]> = (0..n * n * n).map(|k| at(k).map(|i| i as f64)).collect();
        let step = [1, n, n * n];
        let beside = |k: usize| -> Vec<usize> {
            let place = at(k);
            let axis = |a: usize| {
                let below = (place[a] > 0).then(|| k - step[a]);
                let above = (place[a] + 1 < n).then(|| k + step[a]);
                below.into_iter().chain(above)
            };
            (0..3).flat_map(axis).collect()
        };
        let adjacency: Vec<Vec<usize>> = (0..n * n * n).map(beside).collect();
        let all: Vec<usize> = (0..n * n * n).collect();
        let order = nested_dissection(&all, &points, |a| &adjacency[a]);
        let mut position = vec![0; order.len()];
        for (k, &a) in order.iter().enumerate() {
            position[a] = k as u32;
        }
        let (mut column_start, mut row, mut values) = (vec![0], Vec::new(), Vec::new());
        for (k, &a) in order.iter().enumerate() {
            let mut below: Vec<u32> = adjacency[a].iter().map(|&b| position[b]).collect();
            below.retain(|&i| i as usize > k);
            below.sort_unstable();
            values.push(6.0 + 1.0 / (2.0 + a as f64));
            values.extend(below.iter().map(|_| -1.0));
            row.push(k as u32);
            row.extend(below);
            column_start.push(row.len() as u32);
        }
        (Pattern { column_start, row }, values)
    }

    fn is_split(plan: &Plan) -> bool {
        matches!(plan, Plan::Split(..))
    }

    #[test]
    fn halves_side_by_side_are_the_same_to_the_bit_and_right() {
        let (pattern, values) = laplacian(17);
        let size = pattern.size();
        let load: Vec<f64> = (0..size).map(|i| (i as f64).cos()).collect();
        let solve = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().expect("threads").install(|| {
                let mut cholesky = Cholesky::analyse(pattern.clone()).expect("small");
                assert!(is_split(&cholesky.fronts().plan));
                cholesky.factorise(&values).expect("definite");
                let mut x = load.clone();
                cholesky.forward(&mut x);
                cholesky.backward(&mut x);
                let residual = cholesky.residual(&values, &x, &load);
                assert!(residual.iter().all(|r| r.abs() < 1e-12));
                x.iter().map(|x| x.to_bits()).collect::<Vec<u64>>()
            })
        };
        let one = solve(1);
        assert_eq!(one, solve(2));
        assert_eq!(one, solve(3));
    }

    #[test]
    fn the_first_pivot_that_fails_is_told_whichever_half_it_is_in() {
        let (pattern, mut values) = laplacian(17);
        let mut cholesky = Cholesky::analyse(pattern.clone()).expect("small");
        let Plan::Split(_, halves) = &cholesky.fronts().plan else {
            panic!("one thread only");
        };
        let last = halves[1].range().end - 1;
        let rows = [5, cholesky.fronts().supernodes[last].start];
        for row in rows.into_iter().rev() {
            values[pattern.column_start[row] as usize] = -1.0;
            let found = cholesky.factorise(&values);
            assert_eq!(found, Err(NotPositiveDefinite { row }));
        }
    }

    /// Chains have no halves; two chains that meet have.
    #[test]
    fn only_what_does_not_wait_is_split() {
        let work = vec![GRAIN; 7];
        let chain = [1, 2, 3, 4, 5, 6, 7];
        assert!(!is_split(&plan(0..7, &chain, &work)));
        let Plan::Split(range, halves) = plan(0..7, &[1, 2, 6, 4, 5, 6, 7], &work) else {
            panic!("two chains");
        };
        assert_eq!(
            (range, halves[0].range(), halves[1].range()),
            (0..7, 0..3, 3..6)
        );
        // Crossing chains cannot be cut but at their beginning, where little is gained.
        let work = [1.0, 1.0, GRAIN, GRAIN, GRAIN, GRAIN, GRAIN];
        assert!(!is_split(&plan(0..7, &[2, 3, 4, 5, 6, 6, 7], &work)));
    }
}
