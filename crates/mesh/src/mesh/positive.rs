//! The basis of a surface whose integrals are positive where those of the shape functions are not:
//! what a law of unilateral contact needs, node by node; not the law.
//!
//! The integrals of the shape functions over the faces of serendipity hexahedra are negative at
//! corners, −A/12; those over quadratic triangles are zero there, and so is that of the end of a
//! quadratic edge on the axis of symmetry, ∫ N 2πr dr. The basis Ñ_c = N_c + α Σ N_m,
//! Ñ_m = (1 − 2α) N_m spans the same functions, and its integrals are positive: A/20 and A/5 on such a
//! quadrilateral, 2A/15 and A/5 on a triangle, 2A/15, 2A/5 and 7A/15 from the axis outwards. The
//! displacement of a mid-side point is then ũ_m = (u_m − α Σ u_c) / (1 − 2α), and that of a corner its
//! own.
//!
//! Source: A. Popp, B. Wohlmuth, M. Gee and W. Wall, *SIAM Journal on Scientific Computing* 34
//! (2012) B421-B446.

use super::{Facet, Mesh, Share};
use crate::{FacetKind, Hypothesis};
use std::collections::BTreeMap;

/// Part α of the shape function of a mid-side node that goes to either corner of its edge.
const TO_CORNERS: f64 = 0.2;

/// Radius of a node on the axis over that of the middle of its edge, at most. One that is farther out
/// has more than a thousandth of the edge.
const ON_AXIS: f64 = 1e-2;

/// Share of a point of a surface in a basis whose integrals are positive.
///
/// At the corners of the faces of serendipity hexahedra those of the shape functions are negative, at the
/// corners of quadratic triangles and at the end on the axis of a quadratic edge they are zero. There
/// Ñ_c = N_c + α Σ N_m and Ñ_m = (1 − 2α) N_m, α = 1/5, with the mid-sides m beside the corner c; else
/// Ñ is N.
#[derive(Debug, Clone, PartialEq)]
pub struct PositiveShare<const D: usize> {
    /// Of the node, ∫ Ñ_a dS instead of ∫ N_a dS.
    pub share: Share<D>,
    /// Nodes whose displacements, with these weights, are that of the point; they add up to 1.
    pub own: Vec<(usize, f64)>,
}

impl<const D: usize> PositiveShare<D> {
    /// Of a node by itself, where Ñ is N.
    pub fn of_node(share: Share<D>) -> Self {
        let own = vec![(share.node, 1.0)];
        Self { share, own }
    }
}

impl<const D: usize> Mesh<D> {
    /// Shares of the nodes of a set of facets in their surface, all positive, sorted by node: see
    /// [`PositiveShare`]. They are those of [`Mesh::facet_shares`] where these are positive.
    pub fn positive_shares<H: Hypothesis<D>>(
        &self,
        facets: &[Facet],
        hypothesis: &H,
    ) -> Vec<PositiveShare<D>> {
        self.positive_shares_at(&self.nodes, facets, hypothesis)
    }

    /// The same, in the same basis, with the nodes at other positions \[mm\].
    pub fn positive_shares_at<H: Hypothesis<D>>(
        &self,
        positions: &[[f64; D]],
        facets: &[Facet],
        hypothesis: &H,
    ) -> Vec<PositiveShare<D>> {
        let mut edges: BTreeMap<usize, [usize; 2]> = BTreeMap::new();
        for &facet in facets {
            let nodes: Vec<usize> = self.facet_nodes(facet).collect();
            let change = self.change(facet, hypothesis).0.into_iter();
            edges.extend(change.map(|(m, corners)| (nodes[m], corners.map(|c| nodes[c]))));
        }
        let mut shares = self.facet_shares_at(positions, facets, hypothesis);
        let index: BTreeMap<usize, usize> = shares.iter().map(|s| s.node).zip(0..).collect();
        for (midside, corners) in &edges {
            let from = index[midside];
            let (area, normal) = (shares[from].area, shares[from].normal);
            let [a, b] = corners.map(|c| index[&c]);
            for (to, part) in [(a, TO_CORNERS), (b, TO_CORNERS), (from, -2.0 * TO_CORNERS)] {
                shares[to].area += part * area;
                for (sum, n) in shares[to].normal.iter_mut().zip(normal) {
                    *sum += part * n;
                }
            }
        }
        let positive = |share: Share<D>| PositiveShare {
            own: own(share.node, edges.get(&share.node).copied()),
            share,
        };
        shares.into_iter().map(positive).collect()
    }

    /// The change of basis on a facet, as the undeformed body asks for it.
    pub(crate) fn change<H: Hypothesis<D>>(&self, facet: Facet, hypothesis: &H) -> Change {
        let kind = self.facet_kind(facet);
        let corners = kind.corner_count();
        let measures = self
            .facet_nodes(facet)
            .map(|a| hypothesis.measure(&self.nodes[a]));
        let changed = match kind {
            FacetKind::Tri6 | FacetKind::Quad8 => true,
            FacetKind::Line3 => {
                let measures: Vec<f64> = measures.collect();
                let (ends, middle) = measures.split_at(corners);
                ends.iter().any(|end| *end <= ON_AXIS * middle[0])
            }
            _ => false,
        };
        let midsides = if changed { kind.nodes() - corners } else { 0 };
        let edge = |k: usize| (corners + k, [k, (k + 1) % corners]);
        Change((0..midsides).map(edge).collect())
    }
}

/// Nodes whose displacements are that of the point of a node, with their weights, from the corners of
/// the edge that it halves.
fn own(node: usize, edge: Option<[usize; 2]>) -> Vec<(usize, f64)> {
    let rest = 1.0 - 2.0 * TO_CORNERS;
    match edge {
        None => vec![(node, 1.0)],
        Some([a, b]) => vec![
            (node, 1.0 / rest),
            (a, -TO_CORNERS / rest),
            (b, -TO_CORNERS / rest),
        ],
    }
}

/// The change of basis on a facet: its mid-sides with the corners that take a part of their shape
/// functions, by local indices.
#[derive(Default)]
pub(crate) struct Change(Vec<(usize, [usize; 2])>);

impl Change {
    /// Whether Ñ is N.
    pub(crate) fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// The values of the Ñ_a, which sum to 1 as well, from those of the N_a.
    pub(crate) fn apply<const N: usize>(&self, shape: &[f64; N]) -> [f64; N] {
        let mut changed = *shape;
        for &(m, corners) in &self.0 {
            for c in corners {
                changed[c] += TO_CORNERS * shape[m];
            }
            changed[m] -= 2.0 * TO_CORNERS * shape[m];
        }
        changed
    }

    /// Local indices of the nodes whose displacements are that of the point of one, with weights.
    pub(crate) fn own(&self, local: usize) -> Vec<(usize, f64)> {
        let edge = self.0.iter().find(|(m, _)| *m == local);
        own(local, edge.map(|&(_, corners)| corners))
    }
}
