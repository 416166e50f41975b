//! Bodies within each other: nodes of one surface inside of the body behind another, and cells that share volume; not the
//! gap between surfaces that face each other.

use super::face::{self, Face, difference};
use super::tree::Tree;
use crate::geometry::{diagonal, dot};

use crate::mesh::{Change, Facet, Mesh};
use std::collections::{BTreeMap, BTreeSet, HashSet};

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
        let places = Cells::new(self, positions, cells);
        let within = |x: &[f64; D]| places.around(x, |_| true).is_some();
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

    /// The nodes on the boundary of bodies that are within another body, all at the given positions \[mm\]; none of the nodes
    /// that are left out, each by its number and that of the other body in [`Mesh::bodies`].
    pub fn intrusions(
        &self,
        positions: &[[f64; D]],
        is_left_out: impl Fn(usize, usize) -> bool,
    ) -> Vec<Intrusion> {
        let bodies = self.bodies();
        if bodies.len() < 2 {
            return Vec::new();
        }
        let mut body = vec![0; self.cell_count()];
        for (k, cells) in bodies.iter().enumerate() {
            cells.iter().for_each(|&cell| body[cell] = k);
        }
        let boundary = self.boundary_facets();
        let faces: Vec<Face<D>> = boundary
            .iter()
            .map(|&f| self.plain_face(f, positions))
            .collect();
        let tree = Tree::new(faces.iter().map(Face::bounds).collect());
        // How deep a point is within a body, and how long the facet is that is nearest to it there.
        let depth = |x: &[f64; D], other: usize, mut reach: f64| loop {
            let own = |k: &usize| body[boundary[*k].cell] == other;
            let candidates = tree.within(&face::hull([*x].into_iter(), reach));
            let all = candidates.into_iter().filter(own);
            let all = all.map(|k| (distance(x, &faces[k]), faces[k].size()));
            let nearest = all.min_by(|a, b| a.0.total_cmp(&b.0));
            match nearest {
                Some(nearest) if nearest.0 <= reach => return nearest,
                _ if reach > 2.0 * diagonal(positions) => return (reach, reach),
                _ => reach *= 2.0,
            }
        };
        let cells = Cells::new(self, positions, (0..self.cell_count()).collect());
        let mut lengths: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
        for (&facet, face) in boundary.iter().zip(&faces) {
            for &node in &face.nodes {
                let (_, length) = lengths.entry(node).or_insert((facet.cell, f64::INFINITY));
                *length = length.min(face.size());
            }
        }
        let mut found = Vec::new();
        for (node, (own, length)) in lengths {
            let x = &positions[node];
            let counts = |cell: usize| body[cell] != body[own] && !is_left_out(node, body[cell]);
            if let Some(cell) = cells.around(x, counts) {
                let (depth, facet) = depth(x, body[cell], length);
                found.push(Intrusion {
                    node,
                    cells: [own, cell],
                    depth,
                    facet: facet.min(length),
                });
            }
        }
        found
    }

    /// Pairs of cells that share volume: the middle of the first is within the second, or on its sides, which are as curved
    /// as they are.
    pub fn shared_volume(&self) -> Vec<[usize; 2]> {
        let all = 0..self.cell_count();
        let around = |cell| face::hull(self.cell_positions(cell).into_iter(), 0.0);
        let tree = Tree::new(all.clone().map(around).collect());
        let shared = all.filter_map(|cell| {
            let middle = self.middle(cell);
            let others = tree.within(&(middle, middle)).into_iter();
            let mut others = others.filter(|&other| other != cell);
            let other = others.find(|&other| self.is_in(&middle, other))?;
            Some([cell, other])
        });
        shared.collect()
    }

    /// A facet of which the multipliers do not matter.
    pub(super) fn plain_face(&self, facet: Facet, positions: &[[f64; D]]) -> Face<D> {
        let (kind, nodes) = (self.facet_kind(facet), self.facet_nodes(facet));
        Face::new(kind, nodes, positions, Change::default())
    }
}

/// A node of the boundary of a body that is within another body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Intrusion {
    /// The node.
    pub node: usize,
    /// A cell of its own body, and the one of the other body that it is in.
    pub cells: [usize; 2],
    /// How deep it is below the surface of the other body \[mm\].
    pub depth: f64,
    /// Size of the smaller of the facets at the node and nearest to it \[mm\].
    pub facet: f64,
}

/// What lies on a side is not within, in parts of the size of the mesh.
const ROUNDING: f64 = 1e-9;

/// Cells in which points are looked for.
struct Cells<'a, const D: usize> {
    mesh: &'a Mesh<D>,
    positions: &'a [[f64; D]],
    cells: Vec<usize>,
    tree: Tree<D>,
    boundary: HashSet<Facet>,
    /// Distance that is rounding.
    rounding: f64,
}

impl<'a, const D: usize> Cells<'a, D> {
    fn new(mesh: &'a Mesh<D>, positions: &'a [[f64; D]], cells: Vec<usize>) -> Self {
        let around = |cell: &usize| {
            let x = mesh.cell_nodes(*cell).iter().map(|&a| positions[a]);
            face::hull(x, 0.0)
        };
        Self {
            tree: Tree::new(cells.iter().map(around).collect()),
            boundary: mesh.boundary_facets().into_iter().collect(),
            rounding: ROUNDING * diagonal(positions),
            mesh,
            positions,
            cells,
        }
    }

    /// The first of the cells that count which a point is in.
    fn around(&self, x: &[f64; D], counts: impl Fn(usize) -> bool) -> Option<usize> {
        let candidates = self.tree.within(&(*x, *x)).into_iter();
        let mut cells = candidates.map(|k| self.cells[k]).filter(|&c| counts(c));
        cells.find(|&cell| {
            let sides = 0..self.mesh.kind(cell).facets().len();
            let mut sides = sides.map(|facet| Facet { cell, facet });
            sides.all(|side| self.is_behind(x, side))
        })
    }

    /// On a side between two cells a point is within, on the surface of the body it is not.
    fn is_behind(&self, x: &[f64; D], side: Facet) -> bool {
        let least = match self.boundary.contains(&side) {
            true => self.rounding,
            false => -self.rounding,
        };
        below(x, &self.mesh.plain_face(side, self.positions)) > least
    }
}

/// How far a point is below the plane of a side \[mm\].
fn below<const D: usize>(x: &[f64; D], face: &Face<D>) -> f64 {
    let middle = face.middle();
    face::along(x, &face.at(middle), &face.facing)
}

/// Distance of a point to a face, along its normal, or to its boundary where that passes by \[mm\].
pub(super) fn distance<const D: usize>(x: &[f64; D], face: &Face<D>) -> f64 {
    // Lines that meet a face come from the side that it looks to.
    let n = face.facing.map(|v| -v);
    if let Some(eta) = face.hit(x, &n) {
        return face::along(x, &face.at(eta), &n).abs();
    }
    let sides = boundary(face).into_iter();
    let distances = sides.map(|side| to_side(x, side.map(|a| &face.x[a])));
    distances.fold(f64::INFINITY, f64::min)
}

/// The ends of an edge in the plane, the sides of a face in space, through their middles: local indices of nodes.
fn boundary<const D: usize>(face: &Face<D>) -> Vec<[usize; 2]> {
    let corners = face.kind.corner_count();
    if D == 2 {
        return (0..corners).map(|a| [a, a]).collect();
    }
    let halves = |k: usize| {
        let (from, to) = (k, (k + 1) % corners);
        match face.x.len() > corners {
            true => vec![[from, corners + k], [corners + k, to]],
            false => vec![[from, to]],
        }
    };
    (0..corners).flat_map(halves).collect()
}

/// Distance of a point to what is straight between two others \[mm\].
fn to_side<const D: usize>(x: &[f64; D], [a, b]: [&[f64; D]; 2]) -> f64 {
    let (along, from) = (difference(b, a), difference(x, a));
    let length = dot(&along, &along).max(f64::MIN_POSITIVE);
    let part = (dot(&along, &from) / length).clamp(0.0, 1.0);
    let nearest = std::array::from_fn(|i| a[i] + part * along[i]);
    diagonal(&[*x, nearest])
}
