//! Pairing of two surfaces: which displacements make the relative displacement of a contact node,
//! and in which direction it opens; not the law that holds there, and not how it is enforced.
//!
//! Segment to segment in the plane, with dual multipliers: B. I. Wohlmuth, *SIAM J. Numer. Anal.*
//! 38 (2000); A. Popp, M. W. Gee and W. A. Wall, *Int. J. Numer. Meth. Engng* 79 (2009).

mod edge;
mod mortar;
mod tree;

use crate::mesh::{Facet, Mesh, NodeKind};
use crate::{Hypothesis, Integration};
use edge::{Edge, unit};
use std::collections::BTreeMap;
use tree::Tree;

/// How a node of one surface is coupled to the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pairing {
    /// Segment to segment: weighted by dual multipliers and integrated over the overlap. A uniform
    /// pressure passes exactly between meshes that do not match.
    #[default]
    Mortar,
    /// The point opposite to the node, along its normal. It fails the patch test where meshes do
    /// not match; kept to be compared with.
    NodeToSurface,
}

/// A contact node of a surface, the non-mortar side, and what it meets on the other.
///
/// The relative displacement is Σ own·v − Σ opposite·v; both sets of weights sum to 1 and
/// reproduce positions that are linear along the surface. A contact force goes back with the same
/// weights, so that action is reaction.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling<const D: usize> {
    /// The node.
    pub node: usize,
    /// Corner or mid-side.
    pub kind: NodeKind,
    /// ∫ Φ_a dΓ over the overlap, Φ_a the multiplier: force over it is a traction \[mm²\].
    pub area: f64,
    /// Unit normal, from the opposite side into the body of the node.
    pub normal: [f64; D],
    /// Weights of nodes on its own side: of itself, and of those at the edge of the overlap that
    /// the other side does not reach.
    pub own: Vec<(usize, f64)>,
    /// Weights of nodes on the opposite side.
    pub opposite: Vec<(usize, f64)>,
}

impl<const D: usize> Mesh<D> {
    /// Couples the nodes of a surface to the surface opposite, both at the given positions of the
    /// nodes \[mm\]. Nodes that meet nothing are left out; the others are sorted.
    ///
    /// In the plane alone: in space nothing is coupled.
    pub fn couplings<H: Hypothesis<D>>(
        &self,
        positions: &[[f64; D]],
        (surface, opposite): (&[Facet], &[Facet]),
        pairing: Pairing,
        hypothesis: &H,
    ) -> Vec<Coupling<D>> {
        if D != 2 {
            return Vec::new();
        }
        let edges = |facets: &[Facet]| -> Vec<Edge<D>> {
            let edge = |&f: &Facet| Edge::new(self.facet_nodes(f), positions);
            facets.iter().map(edge).collect()
        };
        let (own, other) = (edges(surface), edges(opposite));
        let sides = Sides {
            normals: normals(&own),
            own: &own,
            other: &other,
            tree: Tree::new(other.iter().map(|e| e.bounds(&[])).collect()),
            reach: reach(own.iter().chain(&other)),
        };
        let measure = |x: &[f64; D]| hypothesis.measure(x);
        match pairing {
            Pairing::Mortar => sides.mortar(&measure),
            Pairing::NodeToSurface => sides.node_to_surface(&measure),
        }
    }
}

/// Two surfaces, and the way from one to the other.
struct Sides<'a, const D: usize> {
    own: &'a [Edge<D>],
    other: &'a [Edge<D>],
    /// Outward unit normals of the own nodes, averaged over their edges.
    normals: BTreeMap<usize, [f64; D]>,
    tree: Tree<D>,
    /// Farthest that two points of the surfaces can be apart \[mm\].
    reach: f64,
}

impl<const D: usize> Sides<'_, D> {
    fn normals_of(&self, edge: &Edge<D>) -> Vec<[f64; D]> {
        edge.nodes.iter().map(|a| self.normals[a]).collect()
    }

    /// Edges that may be met within a distance of points along their normals, ascending.
    fn candidates(
        &self,
        points: &[[f64; D]],
        normals: &[[f64; D]],
        depth: f64,
        far: f64,
    ) -> Vec<usize> {
        let ends = points
            .iter()
            .zip(normals)
            .flat_map(|(x, n)| [-depth, far].map(|s| std::array::from_fn(|i| x[i] + s * n[i])));
        self.tree.within(&edge::hull(ends, 0.1 * depth))
    }

    /// The point of the other surface opposite to every node along its normal.
    fn node_to_surface(&self, measure: &dyn Fn(&[f64; D]) -> f64) -> Vec<Coupling<D>> {
        let mut shares: BTreeMap<usize, (f64, NodeKind, f64)> = BTreeMap::new();
        for edge in self.own {
            for point in crate::gauss(3).points {
                let [xi] = point.xi;
                let n = edge.shape(xi);
                let d_s = point.weight * edge.stretch(xi) * measure(&edge.at(xi));
                for (k, &node) in edge.nodes.iter().enumerate() {
                    let share = shares.entry(node).or_insert((0.0, edge.kind(k), 0.0));
                    share.0 += n[k] * d_s;
                    share.2 = edge.size().max(share.2);
                }
            }
        }
        let position: BTreeMap<usize, [f64; D]> = self
            .own
            .iter()
            .flat_map(|e| e.nodes.iter().copied().zip(e.x.iter().copied()))
            .collect();
        let mut couplings = Vec::new();
        for (&node, &(area, kind, size)) in &shares {
            let (x, n) = (position[&node], self.normals[&node]);
            let mut nearest: Option<(f64, usize, f64)> = None;
            for k in self.candidates(&[x], &[n], size, self.reach) {
                let other = &self.other[k];
                let Some(eta) = other.hit(&x, &n) else {
                    continue;
                };
                let gap = edge::along(&x, &other.at(eta), &n);
                if gap >= -size && nearest.is_none_or(|(g, ..)| gap.abs() < g.abs()) {
                    nearest = Some((gap, k, eta));
                }
            }
            let Some((_, k, eta)) = nearest else { continue };
            let other = &self.other[k];
            let n_b = other.shape(eta);
            couplings.push(Coupling {
                node,
                kind,
                area,
                normal: n.map(|v| -v),
                own: vec![(node, 1.0)],
                opposite: other.nodes.iter().copied().zip(n_b).collect(),
            });
        }
        couplings
    }
}

/// Outward unit normals of the nodes, averaged over the edges that they belong to.
fn normals<const D: usize>(edges: &[Edge<D>]) -> BTreeMap<usize, [f64; D]> {
    let mut sums: BTreeMap<usize, [f64; D]> = BTreeMap::new();
    for edge in edges {
        for point in <crate::Line3 as crate::Element<1, 3>>::rule(Integration::Full).points {
            let [xi] = point.xi;
            let (shape, outward) = (edge.shape(xi), edge.outward(xi));
            for (k, &node) in edge.nodes.iter().enumerate() {
                let sum = sums.entry(node).or_insert([0.0; D]);
                for i in 0..D {
                    sum[i] += point.weight * shape[k] * outward[i];
                }
            }
        }
    }
    sums.values_mut().for_each(|n| *n = unit(n));
    sums
}

fn reach<'a, const D: usize>(edges: impl Iterator<Item = &'a Edge<D>>) -> f64 {
    let all: Vec<[f64; D]> = edges.flat_map(|e| e.x.iter().copied()).collect();
    crate::geometry::diagonal(&all)
}
