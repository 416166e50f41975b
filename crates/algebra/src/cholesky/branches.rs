//! Branches of an elimination tree and the trunk that they grow from: what several threads do at once.

use std::ops::Range;

use crate::symbolic::Symbolic;

/// Entries of a factor from which on its branches are gone through at once: a millisecond of a solve.
pub(super) const LARGE: f64 = 1e6;

/// Part of the factor that a branch may have.
pub(super) const PART: f64 = 1.0 / 16.0;

/// Subtrees of an elimination tree that have no unknown in common, and what they have in common.
#[derive(Debug)]
pub(super) struct Branches {
    /// Supernodes of each, ascending; the last is its root.
    pub(super) ranges: Vec<Range<usize>>,
    /// Supernodes that are in no branch.
    pub(super) trunk: Vec<usize>,
}

impl Branches {
    /// Those of a factor; none where it is small, and all is trunk.
    pub(super) fn new(symbolic: &Symbolic) -> Self {
        let large = symbolic.cost.entries >= LARGE;
        let ranges = if large { roots(symbolic) } else { Vec::new() };
        let (mut trunk, mut next) = (Vec::new(), 0);
        for range in &ranges {
            trunk.extend(next..range.start);
            next = range.end;
        }
        trunk.extend(next..symbolic.count());
        Self { ranges, trunk }
    }
}

/// Subtrees that are gone through at once, in order: of the largest, those of its children, until none is large. Who has
/// kept unknowns, and whose descendants do not stand together before it, belongs to the trunk.
fn roots(symbolic: &Symbolic) -> Vec<Range<usize>> {
    let count = symbolic.count();
    let size = symbolic.pattern.size();
    let first_kept = size - symbolic.pattern.kept();
    let supernode_of = symbolic.supernode_of_columns();
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
                let parent = supernode_of[row as usize] as usize;
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

/// Does the work, on all threads where there are threads.
pub(super) fn at_once<T: Send>(work: Vec<T>, each: impl Fn(T) + Sync + Send) {
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        work.into_par_iter().with_max_len(1).for_each(each);
    }
    #[cfg(not(feature = "parallel"))]
    work.into_iter().for_each(each);
}
