//! Tools and nodes of other bodies within a surface between its nodes, where contact does not act; not how that could be
//! prevented.

use crate::driver::Driver;
use crate::model::points::turned;
use moreau_contact::Obstacle;
use moreau_mesh::{Facet, FacetKind};
use nalgebra::SVector;

/// Where a tool or a node of the surface opposite is deepest within a surface between its nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Between<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The node opposite, if it is that of a body.
    pub node: Option<usize>,
    /// How far that reaches behind the surface, at least \[mm\].
    pub depth: f64,
    /// Length of the facet \[mm\].
    pub facet: f64,
    /// Where that is now \[mm\].
    pub position: [f64; D],
    /// How far the nodes of the surface have been pressed in along the normal there, against
    /// each other \[mm\].
    pub pressed: f64,
}

impl<const D: usize> Between<D> {
    /// Depth that counts, in parts of the facet: the bow of a cylinder of 2.5 lengths of a facet.
    pub const DEEP: f64 = 0.05;
    /// Depth that counts, in parts of what the nodes are pressed.
    pub const BESIDE_PRESSED: f64 = 0.2;
}

/// Times that a facet is divided to look behind it: into 16 in the plane, into 64 in space.
const DIVISIONS: [usize; 2] = [4, 3];

/// Part of a facet by which rounding may have a tool within what it touches.
const TOUCHES: f64 = 1e-9;

/// Part of a facet that is nothing beside it.
const FINE: f64 = 1e-3;

/// A facet where it is now, in the coordinates of the tool, with the gaps that its nodes must keep.
struct Sheet<'a, const D: usize> {
    kind: FacetKind,
    nodes: Vec<SVector<f64, D>>,
    offsets: Vec<f64>,
    tool: &'a dyn Obstacle<D>,
    /// Direction into the cell, across the facet.
    inwards: SVector<f64, D>,
    /// How far it is followed \[mm\].
    limit: f64,
    /// The other facets of the cell: their inward normals, and the innermost of their nodes along them. What is behind
    /// those is not behind this one.
    walls: Vec<(SVector<f64, D>, f64)>,
    /// Distance of two corners at most \[mm\].
    size: f64,
}

/// From the middle of a facet towards a point, across the facet.
fn across<const D: usize>(corners: &[SVector<f64, D>], to: &SVector<f64, D>) -> SVector<f64, D> {
    let middle = corners.iter().sum::<SVector<f64, D>>() / corners.len() as f64;
    let mut across = to - middle;
    let size = (corners.iter().map(|x| (x - middle).norm())).fold(0.0, f64::max);
    let mut along: Vec<SVector<f64, D>> = Vec::new();
    for corner in corners {
        let mut side = corner - middle;
        along.iter().for_each(|t| side -= t * t.dot(&side));
        if along.len() + 1 < D
            && let Some(side) = side.try_normalize(FINE * size)
        {
            across -= side * side.dot(&across);
            along.push(side);
        }
    }
    across
}

impl<'a, const D: usize> Sheet<'a, D> {
    fn new(
        kind: FacetKind,
        (nodes, offsets): (Vec<SVector<f64, D>>, Vec<f64>),
        middle_of_cell: SVector<f64, D>,
        tool: &'a dyn Obstacle<D>,
    ) -> Self {
        let corners = &nodes[..kind.corner_count()];
        let apart =
            |a: &SVector<f64, D>| corners.iter().map(|b| (a - b).norm()).fold(0.0, f64::max);
        let size = corners.iter().map(apart).fold(0.0, f64::max);
        // Across the facet: of a cell that is sheared the middle lies beside it.
        let half = across(corners, &middle_of_cell);
        Self {
            kind,
            inwards: half.try_normalize(0.0).unwrap_or_else(SVector::zeros),
            limit: size.min(2.0 * half.norm()),
            walls: Vec::new(),
            size,
            nodes,
            offsets,
            tool,
        }
    }

    /// The same, in a cell of which these are the other facets.
    fn between(
        mut self,
        others: impl Iterator<Item = (FacetKind, Vec<SVector<f64, D>>)>,
        middle_of_cell: SVector<f64, D>,
    ) -> Self {
        let wall = |(kind, nodes): (FacetKind, Vec<SVector<f64, D>>)| {
            let corners = &nodes[..kind.corner_count()];
            let normal = across(corners, &middle_of_cell).try_normalize(0.0)?;
            let levels = nodes.iter().map(|x| x.dot(&normal));
            Some((normal, levels.fold(f64::NEG_INFINITY, f64::max)))
        };
        self.walls = others.filter_map(wall).collect();
        self
    }

    /// How far inwards a point is within the cell.
    fn room(&self, x: &SVector<f64, D>) -> f64 {
        self.walls.iter().fold(self.limit, |room, (normal, level)| {
            match -self.inwards.dot(normal) {
                closing if closing > 0.0 => room.min((x.dot(normal) - level).max(0.0) / closing),
                _ => room,
            }
        })
    }

    /// A point, and the gap that it must keep.
    fn at(&self, xi: [f64; 2]) -> (SVector<f64, D>, f64) {
        let shape = self.kind.shape(xi);
        let x = self.nodes.iter().zip(shape).map(|(x, n)| x * n).sum();
        (x, self.offsets.iter().zip(shape).map(|(o, n)| o * n).sum())
    }

    /// How far the tool reaches behind a point, going inwards. No step is longer than the distance, which
    /// passes nothing by.
    fn depth(&self, x: &SVector<f64, D>, offset: f64) -> f64 {
        let (mut gone, mut depth) = (0.0, 0.0);
        let room = self.room(x);
        while gone <= room {
            let gap = self.tool.distance(&(x + self.inwards * gone)) - offset;
            if gap < -TOUCHES * self.size {
                depth = (gone - gap).min(room);
            }
            gone += gap.abs().max(FINE * self.size);
        }
        depth
    }

    /// How far a node is within the tool \[mm\].
    fn held_within(&self) -> f64 {
        let gap = |(x, offset)| self.tool.distance(x) - offset;
        let gaps = self.nodes.iter().zip(&self.offsets).map(gap);
        -gaps.fold(0.0, f64::min)
    }

    /// The point behind which the tool reaches deepest, and how deep.
    fn deepest(&self) -> (SVector<f64, D>, f64) {
        let corners = self.kind.places();
        let whole = corners[..self.kind.corner_count()].to_vec();
        let mut open = vec![(whole, 0)];
        let mut best = (SVector::zeros(), 0.0);
        while let Some((piece, level)) = open.pop() {
            let mean = |i: usize| piece.iter().map(|xi| xi[i]).sum::<f64>() / piece.len() as f64;
            let (x, offset) = self.at([mean(0), mean(1)]);
            let depth = self.depth(&x, offset);
            if depth > best.1 {
                best = (x, depth);
            }
            let far = piece.iter().map(|&xi| (self.at(xi).0 - x).norm());
            // Half a facet farther than its corners no facet is curved.
            let near = self.limit + far.fold(0.5 * self.size, f64::max);
            if level < DIVISIONS[D - 2] && self.tool.distance(&x) - offset < near {
                open.extend(quarters(&piece).into_iter().map(|p| (p, level + 1)));
            }
        }
        best
    }
}

/// The pieces of a piece, by their corners: halves of an edge, quarters of a face.
fn quarters(piece: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    let middle = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| 0.5 * (a[i] + b[i]));
    match *piece {
        [a, b] => {
            let m = middle(a, b);
            vec![vec![a, m], vec![m, b]]
        }
        [a, b, c] => {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            vec![
                vec![a, ab, ca],
                vec![ab, b, bc],
                vec![ca, bc, c],
                vec![ab, bc, ca],
            ]
        }
        [a, b, c, d] => {
            let (ab, bc, cd, da) = (middle(a, b), middle(b, c), middle(c, d), middle(d, a));
            let m = middle(ab, cd);
            let quarter = |p, q, r, s| vec![p, q, r, s];
            vec![
                quarter(a, ab, m, da),
                quarter(ab, b, bc, m),
                quarter(m, bc, c, cd),
                quarter(da, m, cd, d),
            ]
        }
        _ => Vec::new(),
    }
}

impl<const D: usize> Driver<D> {
    /// Where a tool, or a node of the surface opposite, is deepest within a surface between its nodes, if that is more than the
    /// bow of a round tool over a facet: deeper than [`Between::DEEP`] of the facet and than
    /// [`Between::BESIDE_PRESSED`] of what nodes are pressed in.
    pub fn between_nodes(&self) -> Option<Between<D>> {
        let count = (self.points.iter()).fold(0, |most, p| most.max(p.contact + 1));
        let of = |k: usize| self.deepest_between(k).or_else(|| self.corner_between(k));
        let all = (0..count).filter_map(of);
        all.max_by(|a, b| (a.depth / a.facet).total_cmp(&(b.depth / b.facet)))
    }

    fn deepest_between(&self, contact: usize) -> Option<Between<D>> {
        let own = || self.points.iter().filter(|p| p.contact == contact);
        let tool = own().next()?.tool?;
        let (body, turn) = (&self.tools[tool], self.state.loading.turn_of(tool));
        let obstacle = &body.obstacle;
        let at = self.displacement(self.tool_node(tool));
        let seen = |a: usize| body.seen(self.position(a) - at, &turn);
        let mut offsets = vec![0.0; self.mesh.nodes().len()];
        own().for_each(|p| offsets[p.node] = p.offset);
        let facets = self.mesh.facet_group(self.contact_name(contact).0).ok()?;
        let deepest = |facet: &Facet| {
            let nodes = self.mesh.facet_nodes(*facet);
            let places = nodes.clone().map(seen).collect();
            let offsets = nodes.map(|a| offsets[a]).collect();
            let cell = self.mesh.cell_nodes(facet.cell);
            let middle = cell.iter().map(|&a| seen(a)).sum::<SVector<f64, D>>();
            let middle = middle / cell.len() as f64;
            let kind = self.mesh.facet_kind(*facet);
            let others = (0..self.mesh.kind(facet.cell).facets().len())
                .map(|other| Facet {
                    facet: other,
                    ..*facet
                })
                .filter(|other| other != facet)
                .map(|other| {
                    let nodes = self.mesh.facet_nodes(other).map(seen).collect();
                    (self.mesh.facet_kind(other), nodes)
                });
            let sheet = Sheet::new(kind, (places, offsets), middle, obstacle.as_ref())
                .between(others, middle);
            let (x, depth) = sheet.deepest();
            // Nodes that are held within the tool are another matter.
            let depth = depth - sheet.held_within();
            (depth > Between::<D>::DEEP * sheet.size).then_some((x, depth, sheet.size))
        };
        let all = facets.iter().filter_map(deepest);
        let (x, depth, facet) = all.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2)))?;
        let normal = turned(obstacle.normal(&x), &turn);
        let pressed = self.pressed(contact, &normal, facet);
        (depth > Between::<D>::BESIDE_PRESSED * pressed).then(|| Between {
            contact,
            node: None,
            depth,
            facet,
            position: (body.turned(x, &turn) + at).into(),
            pressed,
        })
    }

    /// The node of the surface of a body that is deepest within the body whose nodes are kept out of it, if that counts.
    fn corner_between(&self, contact: usize) -> Option<Between<D>> {
        let own = self.points.iter().filter(|p| p.contact == contact);
        if own.clone().any(|p| p.tool.is_some() || p.law.is_tie()) {
            return None;
        }
        let (surface, opposite) = self.surfaces(contact);
        let nodes = 0..self.mesh.nodes().len();
        let positions: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
        let (node, depth, _) = self.mesh.overlap(&positions, (opposite, surface))?;
        // Gaps that are adjusted or given may leave bodies within each other.
        let depth = depth + own.fold(0.0, |least: f64, p| least.min(p.offset));
        let position = self.position(node);
        let near_and_size = |facet: &Facet| {
            let nodes = self.mesh.facet_nodes(*facet);
            let places: Vec<_> = nodes.map(|a| self.position(a)).collect();
            let near = (places.iter().map(|a| (a - position).norm())).fold(f64::INFINITY, f64::min);
            let apart = |a: &SVector<f64, D>| {
                let others = places.iter().map(|b| (a - b).norm());
                others.fold(0.0, f64::max)
            };
            (near, places.iter().map(apart).fold(0.0, f64::max))
        };
        let facets = surface.iter().map(near_and_size);
        let (_, facet) = facets.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let normal = *self.mesh.node_normals(&positions, opposite).get(&node)?;
        let pressed = self.pressed(contact, &normal.into(), facet);
        let deep = (Between::<D>::DEEP * facet).max(Between::<D>::BESIDE_PRESSED * pressed);
        (depth > deep).then(|| Between {
            contact,
            node: Some(node),
            depth,
            facet,
            position: position.into(),
            pressed,
        })
    }

    /// How far the nodes of a contact have been pressed along a direction, against each other \[mm\]: what rounding moves
    /// on a facet of this length is not pressed.
    pub(super) fn pressed(&self, contact: usize, along: &SVector<f64, D>, facet: f64) -> f64 {
        let own = self.points.iter().filter(|p| p.contact == contact);
        let moved = own.map(|p| self.displacement(p.node).dot(along));
        let (low, high) = moved.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), u| {
            (l.min(u), h.max(u))
        });
        match high - low > FINE * FINE * facet {
            true => high - low,
            false => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_contact::Ball;
    use nalgebra::Vector2;

    /// A facet drawn over a disc has its bow behind it, however the cell below is sheared.
    #[test]
    fn a_sheared_cell_is_looked_into_across_its_facet() {
        let disc = Ball::new([0.0, 3.0], 3.0).expect("a disc");
        let on = |degrees: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Vector2::new(3.0 * sin, 3.0 - 3.0 * cos)
        };
        let depth = |middle: Vector2<f64>| {
            let nodes = vec![on(20.0), on(60.0), on(40.0)];
            Sheet::new(FacetKind::Line3, (nodes, vec![0.0; 3]), middle, &disc)
                .deepest()
                .1
        };
        let (along, across) = (on(60.0) - on(20.0), on(40.0) - Vector2::new(0.0, 3.0));
        let straight = depth(on(40.0) + across * 0.2);
        assert!(straight < 1e-2, "{straight}");
        for shear in [-2.0, 2.0] {
            let sheared = depth(on(40.0) + across * 0.2 + along * shear);
            assert!(
                (sheared - straight).abs() < 1e-3,
                "{shear}: {sheared} {straight}"
            );
        }
    }
}
