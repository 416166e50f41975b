//! Pairing of two surfaces: which displacements make the relative displacement of a contact node,
//! and in which direction it opens; not the law that holds there, and not how it is enforced.
//!
//! Segment to segment in the plane and face to face in space, with dual multipliers: B. I. Wohlmuth,
//! *SIAM J. Numer. Anal.* 38 (2000); A. Popp, M. W. Gee and W. A. Wall, *Int. J. Numer. Meth. Engng*
//! 79 (2009); A. Popp, M. Gitterle, M. W. Gee and W. A. Wall, *ibid.* 83 (2010).

mod face;
mod fold;
mod mortar;
mod overlap;
mod patches;
mod polygon;
mod seams;
mod segments;
mod tree;

use crate::Hypothesis;
use crate::geometry::{diagonal, dot};
use crate::mesh::{Change, Facet, Mesh, NodeKind};
use crate::sample::facet_samples;
use face::{Face, Values, unit};
pub use fold::Fold;
pub use mortar::MultiplierChoices;
pub use overlap::Intrusion;
use std::collections::BTreeMap;
use tree::Tree;

/// Part of the normal in the middle of a facet that is added at its nodes: nothing beside a normal.
const DEGENERATE: f64 = 1e-12;

/// Cosine of the angle between facets beyond which a surface has two sides there: a circle of nine facets has one.
const SHARP: f64 = 0.75;

/// How a node of one surface is coupled to the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Pairing {
    /// Segment to segment, or face to face: weighted by dual multipliers and integrated over the
    /// overlap. A uniform pressure passes exactly between meshes that do not match.
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
pub struct MortarRow<const D: usize> {
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
    pub fn mortar_rows<H: Hypothesis<D>>(
        &self,
        positions: &[[f64; D]],
        (surface, opposite): (&[Facet], &[Facet]),
        pairing: Pairing,
        hypothesis: &H,
    ) -> Vec<MortarRow<D>> {
        let mut none = MultiplierChoices::default();
        self.mortar_rows_keeping(
            positions,
            (surface, opposite),
            pairing,
            hypothesis,
            &mut none,
        )
    }

    /// The same while the surfaces slide and turn: what was decided by a limit is kept, or has to go beyond it to be decided
    /// otherwise. Takes note of what is decided now.
    pub fn mortar_rows_keeping<H: Hypothesis<D>>(
        &self,
        positions: &[[f64; D]],
        (surface, opposite): (&[Facet], &[Facet]),
        pairing: Pairing,
        hypothesis: &H,
        choices: &mut MultiplierChoices,
    ) -> Vec<MortarRow<D>> {
        let faces = |facets: &[Facet]| -> Vec<Face<D>> {
            let face = |&f: &Facet| {
                let change = self.change(f, hypothesis);
                Face::new(self.facet_kind(f), self.facet_nodes(f), positions, change)
            };
            facets.iter().map(face).collect()
        };
        let (mut own, other) = (faces(surface), faces(opposite));
        if choices.parts.len() != own.len() {
            choices.parts = parts(&own);
        }
        for (face, part) in own.iter_mut().zip(&choices.parts) {
            face.part = *part;
        }
        let sides = Sides {
            normals: normals(&own),
            own: &own,
            other: &other,
            tree: Tree::new(other.iter().map(Face::bounds).collect()),
            reach: reach(own.iter().chain(&other)),
        };
        let measure = |x: &[f64; D]| hypothesis.measure(x);
        match pairing {
            Pairing::Mortar => sides.mortar(surface, &measure, choices),
            Pairing::NodeToSurface => sides.node_to_surface(&measure),
        }
    }
}

impl<const D: usize> Mesh<D> {
    /// Outward unit normals of the nodes of a surface, those of its facets there averaged, at the given positions of all
    /// nodes \[mm\].
    pub fn node_normals(
        &self,
        positions: &[[f64; D]],
        surface: &[Facet],
    ) -> BTreeMap<usize, [f64; D]> {
        let face = |&f: &Facet| {
            let nodes = self.facet_nodes(f);
            Face::new(self.facet_kind(f), nodes, positions, Change::default())
        };
        let all = normals(&surface.iter().map(face).collect::<Vec<_>>());
        all.into_iter().map(|((_, node), n)| (node, n)).collect()
    }
}

/// Two surfaces, and the way from one to the other.
struct Sides<'a, const D: usize> {
    own: &'a [Face<D>],
    other: &'a [Face<D>],
    /// Outward unit normals of the own nodes, averaged over their facets of one smooth part, by that and the node.
    normals: BTreeMap<(usize, usize), [f64; D]>,
    tree: Tree<D>,
    /// Farthest that two points of the surfaces can be apart \[mm\].
    reach: f64,
}

impl<const D: usize> Sides<'_, D> {
    fn normals_of(&self, face: &Face<D>) -> Vec<[f64; D]> {
        let own = |a: &usize| self.normals[&(face.part, *a)];
        face.nodes.iter().map(own).collect()
    }

    /// Facets that may be met within a distance of points along their normals, ascending: none of those that have one
    /// of these nodes, as neighbours have where a surface meets itself.
    fn candidates(
        &self,
        nodes: &[usize],
        (points, normals): (&[[f64; D]], &[[f64; D]]),
        depth: f64,
        far: f64,
    ) -> Vec<usize> {
        let ends = points
            .iter()
            .zip(normals)
            .flat_map(|(x, n)| [-depth, far].map(|s| std::array::from_fn(|i| x[i] + s * n[i])));
        let mut found = self.tree.within(&face::hull(ends, 0.1 * depth));
        found.retain(|&k| !self.other[k].nodes.iter().any(|a| nodes.contains(a)));
        found
    }

    /// The point of the other surface opposite to that of every node along its normal.
    fn node_to_surface(&self, measure: &dyn Fn(&[f64; D]) -> f64) -> Vec<MortarRow<D>> {
        let mut shares: BTreeMap<usize, (f64, NodeKind, f64)> = BTreeMap::new();
        let mut points: BTreeMap<usize, Vec<(usize, f64)>> = BTreeMap::new();
        for face in self.own {
            for (k, &node) in face.nodes.iter().enumerate() {
                let own = face.change.own(k).into_iter();
                points.insert(node, own.map(|(c, w)| (face.nodes[c], w)).collect());
            }
            for sample in facet_samples::<D>(face.kind) {
                let area = sample.area_vector(&face.x);
                let d_s = sample.weight * dot(&area, &area).sqrt();
                let d_s = d_s * measure(&sample.position(&face.x));
                let shape = face.change.apply(&face::filled(&sample.shape));
                for (k, &node) in face.nodes.iter().enumerate() {
                    let share = shares.entry(node).or_insert((0.0, face.node_kind(k), 0.0));
                    share.0 += shape[k] * d_s;
                    share.2 = face.size().max(share.2);
                }
            }
        }
        let position: BTreeMap<usize, [f64; D]> = self
            .own
            .iter()
            .flat_map(|e| e.nodes.iter().copied().zip(e.x.iter().copied()))
            .collect();
        let mut normals: BTreeMap<usize, Vec<[f64; D]>> = BTreeMap::new();
        for (&(_, node), &n) in &self.normals {
            normals.entry(node).or_default().push(n);
        }
        let mut mortar_rows = Vec::new();
        for (&node, &(area, kind, size)) in &shares {
            let own = points.remove(&node).unwrap_or_default();
            let place = |i: usize| own.iter().map(|(a, w)| w * position[a][i]).sum();
            let x: [f64; D] = std::array::from_fn(place);
            let parts = normals[&node].iter();
            let met = parts.filter_map(|&n| Some((n, self.met(node, &x, &n, size)?)));
            // What is as near is met by the part that looks straight at it.
            let off = |(n, (gap, k, _)): &([f64; D], (f64, usize, Values))| {
                let other = &self.other[*k];
                gap.abs() + size * (1.0 + dot(n, &other.facing))
            };
            let Some((n, (_, k, n_b))) = met.min_by(|a, b| off(a).total_cmp(&off(b))) else {
                continue;
            };
            mortar_rows.push(MortarRow {
                node,
                kind,
                area,
                normal: n.map(|v| -v),
                own,
                opposite: self.other[k].nodes.iter().copied().zip(n_b).collect(),
            });
        }
        mortar_rows
    }

    /// What is nearest to a node along a direction: the gap, the facet and its shape functions there.
    fn met(
        &self,
        node: usize,
        x: &[f64; D],
        n: &[f64; D],
        size: f64,
    ) -> Option<(f64, usize, Values)> {
        let candidates = self.candidates(&[node], (&[*x], &[*n]), size, self.reach);
        let met = candidates.into_iter().filter_map(|k| {
            let other = &self.other[k];
            let eta = other.hit(x, n)?;
            let gap = face::along(x, &other.at(eta), n);
            (gap >= -size).then(|| (gap, k, other.shape(eta)))
        });
        met.min_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }
}

/// The smooth part of the surface that each facet is of: what meets at a sharp edge looks in two directions.
fn parts<const D: usize>(faces: &[Face<D>]) -> Vec<usize> {
    // Across a node in the plane, across an edge in space.
    let mut around: BTreeMap<Vec<usize>, Vec<(usize, [f64; D])>> = BTreeMap::new();
    for (f, face) in faces.iter().enumerate() {
        let corners = face.kind.corner_count();
        for k in 0..corners {
            let (mut ends, at) = match D {
                2 => (vec![face.nodes[k]], face.places()[k]),
                _ => (
                    vec![face.nodes[k], face.nodes[(k + 1) % corners]],
                    face.middle(),
                ),
            };
            ends.sort_unstable();
            around
                .entry(ends)
                .or_default()
                .push((f, unit(&face.outward(at))));
        }
    }
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); faces.len()];
    for all in around.values() {
        for (f, n) in all {
            let smooth = all.iter().filter(|(_, m)| dot(n, m) >= SHARP);
            beside[*f].extend(smooth.map(|(g, _)| *g));
        }
    }
    let mut parts: Vec<Option<usize>> = vec![None; faces.len()];
    for first in 0..faces.len() {
        let mut open = vec![first];
        while let Some(f) = open.pop() {
            if parts[f].is_none() {
                parts[f] = Some(first);
                open.extend(&beside[f]);
            }
        }
    }
    parts.into_iter().map(Option::unwrap_or_default).collect()
}

/// Outward unit normals of the nodes, those of the facets of one part there, averaged. At a plane of symmetry the
/// mean over a facet that is curved would lean outwards.
fn normals<const D: usize>(faces: &[Face<D>]) -> BTreeMap<(usize, usize), [f64; D]> {
    let mut sums: BTreeMap<(usize, usize), [f64; D]> = BTreeMap::new();
    for face in faces {
        let middle = face.outward(face.middle());
        for (&node, xi) in face.nodes.iter().zip(face.places()) {
            let sum = sums.entry((face.part, node)).or_insert([0.0; D]);
            let outward = face.outward(xi);
            for i in 0..D {
                // Of a facet that is degenerate there a trace is left.
                sum[i] += outward[i] + DEGENERATE * middle[i];
            }
        }
    }
    sums.values_mut().for_each(|n| *n = unit(n));
    sums
}

fn reach<'a, const D: usize>(faces: impl Iterator<Item = &'a Face<D>>) -> f64 {
    let all: Vec<[f64; D]> = faces.flat_map(|f| f.x.iter().copied()).collect();
    diagonal(&all)
}
