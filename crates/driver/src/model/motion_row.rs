//! Whose displacements make the relative displacement of a contact point; not its gap on a tool, nor the law.

use crate::model::points::ContactPoint;
use moreau_contact::frame;
use moreau_mesh::MortarRow;
use nalgebra::{DMatrix, DVector, SVector};
use std::collections::BTreeMap;

/// Spread of opposite nodes along a direction, over the largest, that is none.
const NO_SPREAD: f64 = 1e-6;

/// Whose displacements make the relative displacement of a contact point during an increment:
/// Σ own·v − Σ opposite·v. Forces go back with the same weights.
#[derive(Debug, Clone, Default)]
pub(crate) struct RelativeMotionRow<const D: usize> {
    /// The node, and those that share its multiplier at the edge of an overlap or its shape function
    /// in a changed basis.
    pub(crate) own: Vec<(usize, f64)>,
    /// Nodes of the surface opposite, or that of the tool.
    pub(crate) opposite: Vec<(usize, f64)>,
    /// Share of the surface in contact \[mm²\].
    pub(crate) area: f64,
    /// Normal and gap where the surfaces were paired, where they are those of a surface.
    plane: Option<(SVector<f64, D>, f64)>,
    /// Slip from the start of the increment to there, in space \[mm\].
    pub(crate) slipped: Option<SVector<f64, D>>,
}

impl<const D: usize> RelativeMotionRow<D> {
    /// On a tool, a body of the one node `tool`.
    pub(crate) fn on_tool(point: &ContactPoint<D>, tool: usize) -> Self {
        Self {
            own: point.own.clone(),
            opposite: vec![(tool, 1.0)],
            area: point.area,
            ..Self::default()
        }
    }

    /// On a surface, with nodes at the given positions.
    pub(crate) fn on_surface(mortar_row: MortarRow<D>, positions: &[[f64; D]]) -> Self {
        let mut motion_row = Self {
            own: mortar_row.own,
            opposite: mortar_row.opposite,
            area: mortar_row.area,
            ..Self::default()
        };
        let normal = SVector::from(mortar_row.normal);
        let apart = motion_row.relative(|a| SVector::from(positions[a]));
        motion_row.plane = Some((normal, normal.dot(&apart)));
        motion_row
    }

    /// Puts both points of the row, Σ own·x and Σ opposite·x, on one normal, and takes the gap from there: forces
    /// that touch leave no moment then. What that changes of the opposite weights is the least in proportion to
    /// them: a part of the gap times the difference of normals, nothing between plane surfaces.
    pub(crate) fn settle(&mut self, positions: &[[f64; D]]) {
        let Some((normal, _)) = self.plane else {
            return;
        };
        let at = |a: usize| SVector::<f64, D>::from(positions[a]);
        let tangents = frame(&normal);
        let along =
            |v: SVector<f64, D>| DVector::from_fn(D - 1, |j, _| tangents.column(j + 1).dot(&v));
        let total: f64 = self.opposite.iter().map(|(_, w)| w.abs()).sum();
        let sum = self.opposite.iter().map(|&(b, w)| at(b) * w.abs());
        let middle = sum.sum::<SVector<f64, D>>() / total;
        let mut spread = DMatrix::<f64>::zeros(D - 1, D - 1);
        for &(b, w) in &self.opposite {
            let off = along(at(b) - middle);
            spread += &off * off.transpose() * w.abs();
        }
        let missing = along(self.relative(at));
        let spread = spread.symmetric_eigen();
        let widest = spread.eigenvalues.amax();
        // What is far apart, and touches nothing, stays as it is.
        if missing.norm_squared() <= widest {
            let mut slope = DVector::<f64>::zeros(D - 1);
            for (direction, &width) in spread.eigenvectors.column_iter().zip(&spread.eigenvalues) {
                if width > NO_SPREAD * widest {
                    slope += direction * (direction.dot(&missing) / width);
                }
            }
            for (b, w) in &mut self.opposite {
                *w += w.abs() * slope.dot(&along(at(*b) - middle));
            }
        }
        self.plane = Some((normal, normal.dot(&self.relative(at))));
    }

    /// Takes note of the slip since the start of the increment, where the row was `first` and the nodes were
    /// `d_u` before these positions: how far, along the surface as it is now, the two points have parted that were opposite to each other
    /// then. It vanishes where the surfaces move as one body, however far (M. A. Puso and T. A. Laursen, *Comput. Methods
    /// Appl. Mech. Engng* 193 (2004) 4891–4913). Opposite to nothing then, the displacement relative to what is
    /// opposite now.
    pub(crate) fn slide(&mut self, first: &Self, positions: &[[f64; D]], d_u: &[f64]) {
        let Some((normal, _)) = self.plane else {
            return;
        };
        let at = |a: usize| SVector::<f64, D>::from(positions[a]);
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let parted = match first.plane {
            Some(_) => first.relative(at) - self.relative(at),
            None => self.relative(moved),
        };
        self.slipped = Some(parted - normal * normal.dot(&parted));
    }

    /// Σ own·v − Σ opposite·v.
    pub(crate) fn relative(&self, v: impl Fn(usize) -> SVector<f64, D>) -> SVector<f64, D> {
        self.weights().map(|(a, w)| v(a) * w).sum()
    }

    /// Adds a part of the multiplier of another point to its own: rows and gaps become means by
    /// area.
    pub(crate) fn take_over(&mut self, other: &Self, part: f64) {
        let (own, given) = (self.area, part * other.area);
        let area = own + given;
        let mean = |a: &[(usize, f64)], b: &[(usize, f64)]| -> Vec<(usize, f64)> {
            let mut sum: BTreeMap<usize, f64> = BTreeMap::new();
            for (weights, share) in [(a, own), (b, given)] {
                for &(node, weight) in weights {
                    *sum.entry(node).or_insert(0.0) += share / area * weight;
                }
            }
            sum.into_iter().collect()
        };
        self.own = mean(&self.own, &other.own);
        self.opposite = mean(&self.opposite, &other.opposite);
        self.area = area;
        if let (Some((n, gap)), Some((m, beside))) = (&mut self.plane, other.plane) {
            *n = (*n * own + m * given).normalize();
            *gap = (*gap * own + beside * given) / area;
        }
    }

    /// Nodes with their weights, negative on the opposite side.
    pub(crate) fn weights(&self) -> impl Iterator<Item = (usize, f64)> {
        let opposite = self.opposite.iter().map(|&(b, w)| (b, -w));
        self.own.iter().copied().chain(opposite)
    }

    /// The nodes on both sides.
    pub(crate) fn nodes(&self) -> Vec<usize> {
        self.weights().map(|(a, _)| a).collect()
    }

    /// Normal and gap after a relative displacement; `None` on a tool and opposite to nothing.
    pub(crate) fn plane(&self, slip: &SVector<f64, D>) -> Option<(SVector<f64, D>, f64)> {
        let (normal, gap) = self.plane?;
        Some((normal, gap + normal.dot(slip)))
    }

    /// Directions in which the relative displacement is free: those of the own node, and those in
    /// which no node opposite is held.
    pub(crate) fn free(&self, node: usize, is_free: impl Fn(usize) -> bool) -> [bool; D] {
        let opposite = |i: usize| self.opposite.iter().all(|&(b, _)| is_free(D * b + i));
        std::array::from_fn(|i| is_free(D * node + i) || (!self.opposite.is_empty() && opposite(i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_moves_together_does_not_slip() {
        let motion_row = RelativeMotionRow::<2> {
            own: vec![(0, 0.75), (1, 0.25)],
            opposite: vec![(2, 1.5), (3, -0.5)],
            ..RelativeMotionRow::default()
        };
        let same = motion_row.relative(|_| SVector::<f64, 2>::new(0.5, 0.1));
        assert!(same.norm() < 1e-15, "carried along: {same}");
        // A direction is free if the own node is, or all of those opposite are.
        assert_eq!(motion_row.free(0, |dof| dof != 0), [true, true]);
        assert_eq!(
            motion_row.free(0, |dof| dof != 0 && dof != 4),
            [false, true]
        );
    }

    #[test]
    fn what_is_taken_over_is_a_mean_by_area() {
        let plane = |y: f64, gap| Some((SVector::<f64, 2>::new(0.0, y), gap));
        let mut motion_row = RelativeMotionRow {
            own: vec![(0, 1.0)],
            opposite: vec![(2, 0.5), (3, 0.5)],
            area: 3.0,
            plane: plane(1.0, 0.1),
        };
        let held = RelativeMotionRow {
            own: vec![(1, 1.0)],
            opposite: vec![(2, 1.0)],
            area: 2.0,
            plane: plane(1.0, 0.5),
        };
        motion_row.take_over(&held, 0.5);
        assert_eq!(motion_row.area, 4.0);
        assert_eq!(motion_row.own, [(0, 0.75), (1, 0.25)]);
        assert_eq!(motion_row.opposite, [(2, 0.625), (3, 0.375)]);
        let (normal, gap) = motion_row.plane(&SVector::zeros()).expect("a surface");
        assert_eq!((normal[1], gap), (1.0, 0.2));
    }
}
