//! Where the forces and stiffness of the cells of a block go; not what they are.

use crate::assembly::block::{Block, CellResult};
use moreau_algebra::Pattern;

/// Marks a degree of freedom whose displacement is prescribed.
pub(crate) const FIXED: u32 = u32::MAX;

/// Where the forces and stiffness of the cells of a block go. Settled once for a system, so that an
/// assembly asks nothing.
///
/// The unknowns of a node follow each other, and so do their rows in the column of any other: one
/// number tells where a pair of nodes goes.
#[derive(Debug)]
pub(crate) struct Scatter {
    /// For every pair of nodes of every cell, of the upper triangle: twice the number of entries of
    /// the first column of the earlier node that come before the rows of the later, and one more
    /// where the second is the earlier.
    pairs: Vec<u32>,
    /// Where the cells that other processes hold are none of those: cells of the block before each that are. Empty
    /// where this one holds all.
    before: Vec<u32>,
}

/// Most unknowns of a cell: of 27 nodes in space.
const MOST: usize = 81;

/// Where an unknown of a cell has its column, and which row it is.
#[derive(Clone, Copy, Default)]
struct Place {
    /// Whether it is an unknown.
    free: bool,
    /// Unknowns of its node before it.
    rank: u32,
    /// Where its column starts, less its rank.
    column: u32,
}

impl Scatter {
    /// Of a block, from the position of every degree of freedom in the system.
    pub(crate) fn new<const D: usize>(
        block: &dyn Block<D>,
        position: &[u32],
        pattern: &Pattern,
    ) -> Self {
        let first = |a: usize| {
            let own = &position[D * a..D * a + D];
            own.iter().copied().find(|&p| p != FIXED)
        };
        let pair = |a: usize, b: usize| {
            let (p, q) = (first(a)?, first(b)?);
            let before = pattern.slot(p.max(q), p.min(q))? as usize;
            let before = before - pattern.diagonal(p.min(q) as usize);
            Some(2 * before as u32 + u32::from(q < p))
        };
        let mut pairs = Vec::new();
        let all = 0..block.cells().len();
        let held = all.clone().filter(|&k| block.holds(k)).count();
        let mut before = Vec::new();
        if held < all.len() {
            let mut count = 0;
            for k in all.clone() {
                before.push(count);
                count += u32::from(block.holds(k));
            }
        }
        for k in all.filter(|&k| block.holds(k)) {
            let nodes = block.nodes(k);
            if pairs.is_empty() {
                let of_a_cell = nodes.len() * (nodes.len() + 1) / 2;
                pairs.reserve_exact(of_a_cell * held);
            }
            for (i, &a) in nodes.iter().enumerate() {
                // Nothing goes anywhere from a node that has no unknown.
                pairs.extend(nodes[i..].iter().map(|&b| pair(a, b).unwrap_or(0)));
            }
        }
        Self { pairs, before }
    }

    /// Adds the stiffness of a cell to that of the system.
    pub(crate) fn add<const D: usize>(
        &self,
        cell: &CellResult<'_>,
        position: &[u32],
        pattern: &Pattern,
        values: &mut [f64],
    ) {
        if cell.stiffness.is_empty() {
            return;
        }
        let count = cell.nodes.len();
        let mut places = [Place::default(); MOST];
        for (places, &a) in places.chunks_exact_mut(D).zip(cell.nodes) {
            let mut rank = 0;
            for (place, &p) in places.iter_mut().zip(&position[D * a..D * a + D]) {
                if p != FIXED {
                    *place = Place {
                        free: true,
                        rank,
                        column: pattern.diagonal(p as usize) as u32 - rank,
                    };
                    rank += 1;
                }
            }
        }
        let of_a_cell = count * (count + 1) / 2;
        let own = (self.before.get(cell.cell)).map_or(cell.cell, |&before| before as usize);
        let mut pairs = &self.pairs[own * of_a_cell..(own + 1) * of_a_cell];
        let mut rest = cell.stiffness;
        for a in 0..count {
            let (own, others) = pairs.split_at(count - a);
            pairs = others;
            for i in 0..D {
                let (row, below) = rest.split_at(D * (count - a) - i);
                rest = below;
                let at = places[D * a + i];
                if !at.free {
                    continue;
                }
                let (diagonal, row) = row.split_at(D - i);
                for (k, other) in diagonal.iter().zip(&places[D * a + i..]) {
                    if other.free {
                        values[(at.column + other.rank) as usize] += k;
                    }
                }
                let nodes = row.chunks_exact(D).zip(places[D * a + D..].chunks_exact(D));
                for ((row, others), &pair) in nodes.zip(&own[1..]) {
                    for (k, other) in row.iter().zip(others) {
                        let (column, row) = match pair & 1 {
                            0 => (at.column, other.rank),
                            _ => (other.column, at.rank),
                        };
                        if other.free {
                            values[(column + (pair >> 1) + row) as usize] += k;
                        }
                    }
                }
            }
        }
    }
}

/// Hands on the stiffness of a cell between its unknowns and its prescribed displacements: the
/// degrees of freedom of the one and of the other, and the entry.
pub(crate) fn prescribed_columns<const D: usize>(
    cell: &CellResult<'_>,
    position: &[u32],
    sink: &mut dyn FnMut(usize, usize, f64),
) {
    let dofs = || cell.nodes.iter().flat_map(|&a| D * a..D * a + D);
    let fixed = |dof: usize| position[dof] == FIXED;
    if cell.stiffness.is_empty() || !dofs().any(fixed) {
        return;
    }
    let mut entries = cell.stiffness.iter();
    for (i, a) in dofs().enumerate() {
        for (b, &k) in dofs().skip(i).zip(entries.by_ref()) {
            match (fixed(a), fixed(b)) {
                (false, true) => sink(a, b, k),
                (true, false) => sink(b, a, k),
                _ => {}
            }
        }
    }
}
