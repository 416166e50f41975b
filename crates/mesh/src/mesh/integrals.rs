//! Integrals over cells and facets that need no unknowns: volumes and consistent nodal shares;
//! not the assembling of forces or stiffness.

use super::{Facet, Mesh};
use crate::Hypothesis;
use crate::geometry::dot;
use crate::sample::{cell_samples, facet_samples};
use std::collections::BTreeMap;

/// Place of a node on the facets it belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NodeKind {
    /// A corner of its facets.
    Corner,
    /// In the middle of an edge of a quadratic facet.
    Midside,
    /// In the middle of a biquadratic facet.
    Face,
}

/// Share of one node in a surface: what turns a pressure into nodal forces, and back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share<const D: usize> {
    /// Index of the node.
    pub node: usize,
    /// ∫ N_a dS \[mm²\].
    pub area: f64,
    /// ∫ N_a n dS \[mm²\], n the outward unit normal: −p times this is the force of a pressure p.
    pub normal: [f64; D],
    /// Place of the node on the facets.
    pub kind: NodeKind,
}

impl<const D: usize> Mesh<D> {
    /// Volume ∫ dV of a set of cells under a hypothesis \[mm³\].
    ///
    /// # Panics
    /// Of a cell that the mesh has not.
    pub fn measure<H: Hypothesis<D>>(&self, cells: &[usize], hypothesis: &H) -> f64 {
        self.volume_shares(cells, hypothesis)
            .iter()
            .map(|&(_, share)| share)
            .sum()
    }

    /// Consistent shares ∫ N_a dV of the nodes of a set of cells in their volume \[mm³\], sorted by
    /// node: what turns a body force into nodal forces.
    ///
    /// Exact for cells with straight sides and parallel faces; each mention of a cell counts.
    ///
    /// # Panics
    /// Of a cell that the mesh has not.
    pub fn volume_shares<H: Hypothesis<D>>(
        &self,
        cells: &[usize],
        hypothesis: &H,
    ) -> Vec<(usize, f64)> {
        let mut samples = BTreeMap::new();
        let mut shares = BTreeMap::new();
        for &cell in cells {
            let kind = self.kind(cell);
            let positions = self.cell_positions(cell);
            for sample in &samples
                .entry(kind)
                .or_insert_with(|| cell_samples(kind))
                .rule
            {
                let d_v = sample.weight
                    * sample.det(&positions)
                    * hypothesis.measure(&sample.position(&positions));
                for (&node, n) in self.cell_nodes(cell).iter().zip(&sample.shape) {
                    *shares.entry(node).or_insert(0.0) += n * d_v;
                }
            }
        }
        shares.into_iter().collect()
    }

    /// Consistent shares of the nodes of a set of facets in their surface, sorted by node.
    ///
    /// A straight quadratic edge gives 1/6, 2/3 and 1/6 of its area to its first end, middle and
    /// second end. Exact for flat facets; each mention of a facet counts.
    ///
    /// # Panics
    /// Of a facet that the mesh has not, see [`Mesh::has_facet`].
    pub fn facet_shares<H: Hypothesis<D>>(
        &self,
        facets: &[Facet],
        hypothesis: &H,
    ) -> Vec<Share<D>> {
        self.facet_shares_at(&self.nodes, facets, hypothesis)
    }

    /// The same with the nodes at other positions \[mm\].
    ///
    /// # Panics
    /// Of a facet that the mesh has not, or if there are not as many positions as nodes.
    pub fn facet_shares_at<H: Hypothesis<D>>(
        &self,
        positions: &[[f64; D]],
        facets: &[Facet],
        hypothesis: &H,
    ) -> Vec<Share<D>> {
        assert_eq!(positions.len(), self.nodes.len(), "a position a node");
        let mut samples = BTreeMap::new();
        let mut shares = BTreeMap::new();
        for &facet in facets {
            let kind = self.facet_kind(facet);
            let nodes = self.facet_nodes(facet);
            let positions: Vec<_> = nodes.clone().map(|node| positions[node]).collect();
            for sample in samples.entry(kind).or_insert_with(|| facet_samples(kind)) {
                let vector = sample.area_vector(&positions);
                let area = dot(&vector, &vector).sqrt();
                let factor = sample.weight * hypothesis.measure(&sample.position(&positions));
                for (local, (node, n)) in nodes.clone().zip(&sample.shape).enumerate() {
                    // A facet has as many edges as corners; one of the plane is its own edge.
                    let corners = kind.corner_count();
                    let share = shares.entry(node).or_insert(Share {
                        node,
                        area: 0.0,
                        normal: [0.0; D],
                        kind: match local / corners {
                            0 => NodeKind::Corner,
                            1 => NodeKind::Midside,
                            _ => NodeKind::Face,
                        },
                    });
                    share.area += n * factor * area;
                    for (sum, component) in share.normal.iter_mut().zip(vector) {
                        *sum += n * factor * component;
                    }
                }
            }
        }
        shares.into_values().collect()
    }
}
