//! The middle of a cell, and whether a point is in a cell, with its sides as curved as they are; not in which cells points
//! are looked for.

use super::Mesh;
use crate::CellKind;
use crate::sample::cell_sample;

/// Steps of Newton's method at most: of cells that are valid, few are needed for points within.
const STEPS: usize = 30;

/// What is rounding in reference coordinates, also of small cells far from the origin.
const ROUNDING: f64 = 1e-6;

/// The centre of a reference cell, the mean of its corners.
fn centre<const D: usize>(kind: CellKind) -> [f64; D] {
    let corners = kind.corner_count();
    let sum = |i: usize| {
        kind.reference_nodes()
            .take(corners)
            .map(|xi| xi[i])
            .sum::<f64>()
    };
    std::array::from_fn(|i| sum(i) / corners as f64)
}

/// Whether a point is in a reference cell, or on its sides.
fn is_in_reference<const D: usize>(kind: CellKind, xi: &[f64; D]) -> bool {
    match kind.corner_count() > D + 1 {
        true => xi.iter().all(|xi| xi.abs() <= 1.0 + ROUNDING),
        false => xi.iter().all(|&xi| xi >= -ROUNDING) && xi.iter().sum::<f64>() <= 1.0 + ROUNDING,
    }
}

impl<const D: usize> Mesh<D> {
    /// The image of the centre of the reference cell \[mm\]. The mean of the corners is outside of a cell that is bent by
    /// more than half of its thickness.
    pub(crate) fn middle(&self, cell: usize) -> [f64; D] {
        let kind = self.kind(cell);
        cell_sample(kind, &centre(kind)).position(&self.cell_positions(cell))
    }

    /// Whether a point \[mm\] is in a cell or on its sides: whether its reference coordinates are, by Newton's method from
    /// the centre.
    pub(crate) fn is_in(&self, x: &[f64; D], cell: usize) -> bool {
        let (kind, nodes) = (self.kind(cell), self.cell_positions(cell));
        let mut xi = centre(kind);
        for _ in 0..STEPS {
            let here = cell_sample(kind, &xi);
            let at = here.position(&nodes);
            let step = here.pulled_back(&std::array::from_fn(|i| x[i] - at[i]), &nodes);
            xi.iter_mut().zip(step).for_each(|(xi, step)| *xi += step);
            let size = step
                .iter()
                .fold(0.0, |most: f64, step| most.max(step.abs()));
            if size <= ROUNDING {
                return is_in_reference(kind, &xi);
            }
            if !size.is_finite() {
                break;
            }
        }
        false
    }
}
