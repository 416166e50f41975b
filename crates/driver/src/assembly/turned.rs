//! The stiffness of a cell along the directions of its nodes; not where it goes.

use crate::assembly::block::CellResult;
use crate::vector::directions::Directions;

/// Cells as the unknowns see them: their stiffness along the directions of its nodes, their forces along the axes.
pub(crate) struct Turned<'d> {
    directions: &'d Directions,
    /// The stiffness, all of it, and its upper triangle.
    room: (Vec<f64>, Vec<f64>),
}

impl<'d> Turned<'d> {
    pub(crate) fn of(directions: &'d Directions) -> Self {
        Self {
            directions,
            room: (Vec::new(), Vec::new()),
        }
    }

    /// A cell as it is, unless some of its nodes have directions of their own.
    pub(crate) fn cell<'c, const D: usize>(&'c mut self, cell: CellResult<'c>) -> CellResult<'c> {
        let is_turned = |a: &usize| self.directions.is_turned(D * a);
        if cell.stiffness.is_empty() || !cell.nodes.iter().any(is_turned) {
            return cell;
        }
        let size = D * cell.nodes.len();
        let (square, triangle) = &mut self.room;
        square.resize(size * size, 0.0);
        let mut entries = cell.stiffness.iter();
        for i in 0..size {
            for (j, &k) in (i..size).zip(entries.by_ref()) {
                (square[size * i + j], square[size * j + i]) = (k, k);
            }
        }
        for (own, &a) in cell.nodes.iter().enumerate().filter(|(_, a)| is_turned(a)) {
            // Its rows, then its columns.
            for (along, across) in [(size, 1), (1, size)] {
                for other in 0..size {
                    let at = |k: usize| along * (D * own + k) + across * other;
                    let entries: [f64; D] = std::array::from_fn(|i| square[at(i)]);
                    for k in 0..D {
                        let component = |dof: usize| entries[dof - D * a];
                        square[at(k)] = self.directions.component(D * a + k, component);
                    }
                }
            }
        }
        triangle.clear();
        (0..size).for_each(|i| triangle.extend_from_slice(&square[size * i + i..size * (i + 1)]));
        CellResult {
            stiffness: triangle,
            ..cell
        }
    }
}
