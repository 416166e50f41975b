//! Bodies within each other: nodes of one surface inside of the body behind another; not the gap between
//! surfaces that face each other.

use super::face::{self, Face};
use super::tree::Tree;
use crate::geometry::diagonal;

use crate::mesh::{Change, Facet, Mesh};
use std::collections::{BTreeSet, HashSet};

impl<const D: usize> Mesh<D> {
    /// The node of a surface that is deepest within the bodies of the surface opposite, both at the given
    /// positions of the nodes \[mm\], how deep that is below the surface opposite \[mm\], and how many nodes are
    /// within; `None` if none is. Cells count as if their sides were plane.
    pub fn overlap(
        &self,
        positions: &[[f64; D]],
        (surface, opposite): (&[Facet], &[Facet]),
    ) -> Option<(usize, f64, usize)> {
        let of = |facets: &[Facet]| facets.iter().map(|f| f.cell).collect::<BTreeSet<_>>();
        let (own, other) = (of(surface), of(opposite));
        let has = |body: &[usize], cells: &BTreeSet<usize>| body.iter().any(|c| cells.contains(c));
        let bodies = self.bodies().into_iter();
        let cells = bodies.filter(|b| has(b, &other) && !has(b, &own)).flatten();
        let cells: Vec<usize> = cells.collect();
        if cells.is_empty() {
            return None;
        }
        let size = diagonal(positions);
        let boundary: HashSet<Facet> = self.boundary_facets().into_iter().collect();
        // On a side between two cells a point is within, on the surface of the body it is not.
        let is_behind = |x: &[f64; D], side: Facet| {
            let least = match boundary.contains(&side) {
                true => ROUNDING * size,
                false => -ROUNDING * size,
            };
            below(x, &self.plain_face(side, positions)) > least
        };
        let around = |cell: &usize| {
            let x = self.cell_nodes(*cell).iter().map(|&a| positions[a]);
            face::hull(x, 0.0)
        };
        let tree = Tree::new(cells.iter().map(around).collect());
        let within = |x: &[f64; D]| {
            let candidates = tree.within(&(*x, *x));
            candidates.into_iter().any(|k| {
                let sides = 0..self.kind(cells[k]).facets().len();
                let mut sides = sides.map(|facet| Facet {
                    cell: cells[k],
                    facet,
                });
                sides.all(|side| is_behind(x, side))
            })
        };
        let opposite: Vec<Face<D>> = opposite
            .iter()
            .map(|&f| self.plain_face(f, positions))
            .collect();
        let depth = |x: &[f64; D]| {
            let distances = opposite.iter().map(|f| distance(x, f));
            distances.fold(f64::INFINITY, f64::min)
        };
        let nodes: BTreeSet<usize> = surface.iter().flat_map(|&f| self.facet_nodes(f)).collect();
        let inside = nodes.into_iter().filter(|&a| within(&positions[a]));
        let inside: Vec<(usize, f64)> = inside.map(|a| (a, depth(&positions[a]))).collect();
        let deepest = inside.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((deepest.0, deepest.1, inside.len()))
    }

    /// A facet of which the multipliers do not matter.
    fn plain_face(&self, facet: Facet, positions: &[[f64; D]]) -> Face<D> {
        let (kind, nodes) = (self.facet_kind(facet), self.facet_nodes(facet));
        Face::new(kind, nodes, positions, Change::default())
    }
}

/// What lies on a side is not within, in parts of the size of the mesh.
const ROUNDING: f64 = 1e-9;

/// How far a point is below the plane of a side \[mm\].
fn below<const D: usize>(x: &[f64; D], face: &Face<D>) -> f64 {
    let middle = face.middle();
    face::along(x, &face.at(middle), &face.outward(middle))
}

/// Distance of a point to a face, along its normal, or to its nearest node where that passes by \[mm\].
fn distance<const D: usize>(x: &[f64; D], face: &Face<D>) -> f64 {
    // Lines that meet a face come from the side that it looks to.
    let n = face.outward(face.middle()).map(|v| -v);
    if let Some(eta) = face.hit(x, &n) {
        return face::along(x, &face.at(eta), &n).abs();
    }
    let to = |y: &[f64; D]| diagonal(&[*x, *y]);
    face.x.iter().map(to).fold(f64::INFINITY, f64::min)
}
