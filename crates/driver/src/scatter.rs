//! Where the forces and stiffness of the cells of a block go; not what they are.

use crate::block::{Block, CellResult};
use crate::cholesky::Pattern;

/// Marks a degree of freedom whose displacement is prescribed.
pub(crate) const FIXED: u32 = u32::MAX;

/// Where the forces and stiffness of the cells of a block go. Settled once for a system, so that an
/// assembly asks nothing.
#[derive(Debug)]
pub(crate) struct Scatter {
    /// Unknowns of a cell.
    size: usize,
    /// Degree of freedom of the mesh of every unknown of every cell.
    dofs: Vec<u32>,
    /// Slot among the values of every entry of the upper triangle of every cell; the one beyond
    /// the last for what no unknown sees.
    slots: Vec<u32>,
    /// Cells with a prescribed displacement.
    held: Vec<bool>,
}

impl Scatter {
    /// Of a block, from the position of every degree of freedom in the system.
    pub(crate) fn new<const D: usize>(
        block: &dyn Block<D>,
        position: &[u32],
        pattern: &Pattern,
    ) -> Self {
        let cells = block.cells().len();
        let size = if cells == 0 {
            0
        } else {
            D * block.nodes(0).len()
        };
        let mut dofs = Vec::with_capacity(cells * size);
        let mut slots = Vec::with_capacity(cells * size * (size + 1) / 2);
        for k in 0..cells {
            let first = dofs.len();
            dofs.extend(
                block
                    .nodes(k)
                    .iter()
                    .flat_map(|&a| (D * a..D * a + D).map(|d| d as u32)),
            );
            let cell = &dofs[first..];
            for (i, &a) in cell.iter().enumerate() {
                for &b in &cell[i..] {
                    let (p, q) = (position[a as usize], position[b as usize]);
                    let free = p != FIXED && q != FIXED;
                    let slot = free.then(|| pattern.slot(p.max(q), p.min(q))).flatten();
                    slots.push(slot.unwrap_or(pattern.entries() as u32));
                }
            }
        }
        let is_held = |cell: &[u32]| cell.iter().any(|&dof| position[dof as usize] == FIXED);
        let held = (0..cells)
            .map(|k| is_held(&dofs[k * size..(k + 1) * size]))
            .collect();
        Self {
            size,
            dofs,
            slots,
            held,
        }
    }

    /// Adds forces and stiffness of a cell to those of the system.
    pub(crate) fn add(&self, cell: &CellResult<'_>, internal: &mut [f64], values: &mut [f64]) {
        let size = self.size;
        let triangle = size * (size + 1) / 2;
        let dofs = &self.dofs[cell.cell * size..(cell.cell + 1) * size];
        for (&dof, f) in dofs.iter().zip(cell.force) {
            internal[dof as usize] += f;
        }
        let slots = &self.slots[cell.cell * triangle..(cell.cell + 1) * triangle];
        for (&slot, k) in slots.iter().zip(cell.stiffness) {
            values[slot as usize] += k;
        }
    }

    /// Hands on the stiffness of a cell between its unknowns and its prescribed displacements:
    /// the degrees of freedom of the one and of the other, and the entry.
    pub(crate) fn couplings(
        &self,
        cell: &CellResult<'_>,
        position: &[u32],
        sink: &mut dyn FnMut(u32, u32, f64),
    ) {
        if !self.held[cell.cell] {
            return;
        }
        let dofs = &self.dofs[cell.cell * self.size..(cell.cell + 1) * self.size];
        let mut entries = cell.stiffness.iter();
        for (i, &a) in dofs.iter().enumerate() {
            for (&b, &k) in dofs[i..].iter().zip(entries.by_ref()) {
                match (position[a as usize] == FIXED, position[b as usize] == FIXED) {
                    (false, true) => sink(a, b, k),
                    (true, false) => sink(b, a, k),
                    _ => {}
                }
            }
        }
    }
}
