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

    /// The point behind which the tool reaches deepest, and how deep, if that is more than what counts.
    fn deepest(&self) -> (SVector<f64, D>, f64) {
        let corners = self.kind.places();
        let corners = &corners[..self.kind.corner_count()];
        let mut best = (SVector::zeros(), 0.0);
        let middle = self.at(middle_of(corners));
        let far = corners.iter().map(|&xi| (self.at(xi).0 - middle.0).norm());
        // Half a facet farther than its corners no facet is curved.
        let near = self.limit + far.fold(0.5 * self.size, f64::max);
        if self.counts() >= self.limit || self.tool.distance(&middle.0) - middle.1 >= near {
            return best;
        }
        let mut open = vec![self.piece(corners, DIVISIONS[D - 2])];
        while let Some(piece) = open.pop() {
            let (points, offset) = piece.points(&self.inwards);
            if self.is_clear(&piece.middle, offset, &points) {
                continue;
            }
            // Long ways to look behind one point are for those alone that are not clear of the tool by themselves.
            let is_clear = self.is_clear(&piece.middle, piece.offset, &[(0.0, 0.0)]);
            let depth = match is_clear {
                true => 0.0,
                false => self.depth(&piece.middle, piece.offset),
            };
            if depth > best.1 {
                best = (piece.middle, depth);
            }
            open.extend(piece.parts);
        }
        best
    }

    /// Depth that counts \[mm\].
    fn counts(&self) -> f64 {
        Between::<D>::DEEP * self.size
    }

    /// A piece, divided so many times.
    fn piece(&self, corners: &[[f64; 2]], divisions: usize) -> Piece<D> {
        let (middle, offset) = self.at(middle_of(corners));
        let parts: Vec<Piece<D>> = match divisions {
            0 => Vec::new(),
            _ => (quarters(corners).iter())
                .map(|corners| self.piece(corners, divisions - 1))
                .collect(),
        };
        Piece {
            middle,
            offset,
            parts,
        }
    }

    /// Whether the tool reaches by what counts behind none of some points that must keep a gap: given are how far each is from x
    /// across the facet, squared, and how far ahead or behind. A ball that is as large as the tool is far from its middle is
    /// free of it: one after the other, from within the cell to the facet, balls above x are to cover what is behind the points.
    /// A way that is free from a depth on has the tool no deeper than that.
    fn is_clear(&self, x: &SVector<f64, D>, offset: f64, points: &[(f64, f64)]) -> bool {
        let mut deep = self.limit;
        while deep > self.counts() {
            let gap = self.tool.distance(&(x + self.inwards * deep)) - offset;
            let free = |(aside, ahead): &(f64, f64)| (gap * gap - aside).max(0.0).sqrt() - ahead;
            let free = points.iter().map(free).fold(gap, f64::min);
            if free < FINE * self.size {
                return false;
            }
            deep -= free;
        }
        true
    }
}

/// A piece of a facet: its middle, the gap that this must keep, and the pieces that it is divided into.
struct Piece<const D: usize> {
    middle: SVector<f64, D>,
    offset: f64,
    parts: Vec<Piece<D>>,
}

impl<const D: usize> Piece<D> {
    /// Where its middle and those of all of its parts are beside its own, as [`Sheet::is_clear`] has them with this direction
    /// ahead, and the largest gap that they must keep.
    fn points(&self, ahead: &SVector<f64, D>) -> (Vec<(f64, f64)>, f64) {
        let (mut points, mut offset) = (Vec::new(), self.offset);
        let mut open = vec![self];
        while let Some(part) = open.pop() {
            let way = part.middle - self.middle;
            let along = way.dot(ahead);
            points.push((way.norm_squared() - along * along, along.abs()));
            offset = offset.max(part.offset);
            open.extend(&part.parts);
        }
        (points, offset)
    }
}

/// The middle of a piece, given by its corners.
fn middle_of(corners: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| corners.iter().map(|xi| xi[i]).sum::<f64>() / corners.len() as f64)
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
            if depth <= sheet.counts() {
                return None;
            }
            // Nodes that are held within the tool are another matter.
            let depth = depth - sheet.held_within();
            (depth > sheet.counts()).then_some((x, depth, sheet.size))
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
    use moreau_contact::{Ball, Plane};
    use nalgebra::{Vector2, Vector3};
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A tool that counts how often its distance is asked for.
    struct Counted<T>(T, AtomicUsize);

    impl<T: Obstacle<3>> Obstacle<3> for Counted<T> {
        fn distance(&self, x: &Vector3<f64>) -> f64 {
            self.1.fetch_add(1, Ordering::Relaxed);
            self.0.distance(x)
        }

        fn normal(&self, x: &Vector3<f64>) -> Vector3<f64> {
            self.0.normal(x)
        }
    }

    /// The top of a cell as high as told, a unit square that bows upwards, with gaps that its first node and the others must keep.
    fn top(
        (kind, bow, height): (FacetKind, f64, f64),
        gaps: [f64; 2],
        tool: &dyn Obstacle<3>,
    ) -> Sheet<'_, 3> {
        let at = |xi: &[f64; 2]| {
            let [x, y] = xi.map(|xi| 0.5 * (1.0 + xi));
            let up = 4.0 * bow * (x * (1.0 - x) + y * (1.0 - y));
            Vector3::new(x, y, up)
        };
        let nodes: Vec<Vector3<f64>> = kind.places().iter().map(at).collect();
        let offsets = (0..nodes.len()).map(|k| gaps[k.min(1)]).collect();
        let middle = Vector3::new(0.5, 0.5, -0.5 * height);
        Sheet::new(kind, (nodes, offsets), middle, tool)
    }

    /// The deepest of all points that are looked behind.
    fn of_all<const D: usize>(sheet: &Sheet<'_, D>) -> (SVector<f64, D>, f64) {
        let corners = &sheet.kind.places()[..sheet.kind.corner_count()];
        let mut open = vec![sheet.piece(corners, DIVISIONS[D - 2])];
        let mut best = (SVector::zeros(), 0.0);
        while let Some(piece) = open.pop() {
            let depth = sheet.depth(&piece.middle, piece.offset);
            if depth > best.1 {
                best = (piece.middle, depth);
            }
            open.extend(piece.parts);
        }
        best
    }

    /// What is left out is not what counts: of balls of all sizes everywhere around a facet.
    #[test]
    fn what_is_deepest_is_the_deepest_of_all() {
        let kinds = [FacetKind::Quad4, FacetKind::Quad8, FacetKind::Quad9];
        let parts = |k: usize, by: f64| (k as f64 * by).fract();
        let (mut found, mut none) = (0, 0);
        for k in 0..600 {
            let radius = 0.03 * 100.0_f64.powf(parts(k, 0.618_034));
            let aside = [0.754_878, 0.569_84].map(|by| 2.0 * parts(k, by) - 0.5);
            let up = radius + 0.4 * parts(k, 0.819_173) - 0.3;
            let ball = Ball::new([aside[0], aside[1], up], radius).expect("a ball");
            let kind = kinds[k % 3];
            let bow = if k % 3 == 0 {
                0.0
            } else {
                0.1 * parts(k, 0.324_718)
            };
            let height = [0.1, 0.4, 1.0, 3.0][k % 4];
            let gaps = [0.0, if k % 5 == 0 { 0.1 } else { 0.0 }];
            let sheet = top((kind, bow, height), gaps, &ball);
            let (all, deepest) = (of_all(&sheet), sheet.deepest());
            if all.1 > sheet.counts() {
                assert_eq!(deepest, all, "{k}");
                found += 1;
            } else {
                assert!(deepest.1 <= sheet.counts(), "{k}: {deepest:?}");
                none += 1;
            }
        }
        assert!(found > 100 && none > 100, "{found} {none}");
    }

    /// Distances to a surface of many triangles take long: of what lies flat on a facet, or away from it, few are asked for.
    #[test]
    fn few_distances_tell_that_nothing_is_between_nodes() {
        let asked = |gap: f64, height: f64| {
            let plane = Plane::new([0.0, 0.0, gap], [0.0, 0.0, -1.0]).expect("a plane");
            let tool = Counted(plane, AtomicUsize::new(0));
            let sheet = top((FacetKind::Quad4, 0.0, height), [0.0; 2], &tool);
            assert!(sheet.deepest().1 <= sheet.counts());
            tool.1.load(Ordering::Relaxed)
        };
        assert_eq!(asked(5.0, 1.0), 1);
        assert!(asked(0.0, 1.0) <= 12, "{}", asked(0.0, 1.0));
        assert!(asked(0.3, 1.0) <= 4, "{}", asked(0.3, 1.0));
        assert!(asked(0.0, 0.2) <= 100, "{}", asked(0.0, 0.2));
    }

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
