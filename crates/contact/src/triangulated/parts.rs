//! A surface of triangles cut at its sharp concave edges, so that a node in one touches both sides; not its patches.

use super::{Boxes, Foot, Point, ROUNDED, SAME, Triangulated, boxes, join, root};
use crate::{Corner, Obstacle};
use nalgebra::Matrix3;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::sync::Arc;

/// Angle of a concave edge from which on a node in it touches both sides \[rad\].
const HOLLOW: f64 = 0.35;

/// Parts of a surface at most: one that has more is rough, and no node lies in its edges.
const MOST_PARTS: usize = 8;

/// What two parts of a surface share.
struct Whole {
    surface: Triangulated,
    /// Whether the edges of patches are concave.
    hollow: Vec<bool>,
    /// What a patch is nearest to: a side of concave edges, connected around corners.
    side: Vec<usize>,
    /// How many sharp edges are between.
    across: Vec<usize>,
    /// The part that a patch is of.
    part: Vec<usize>,
    /// Sides that meet in a concave edge.
    facing: BTreeSet<[usize; 2]>,
}

/// Patches of which no two meet in a concave edge.
///
/// It goes on in its tangent planes beyond such edges, into the body behind. Elsewhere, where another part is
/// nearest and this one not straight ahead, it is far away: no node is in touch with two parts at an edge that is not
/// concave.
struct Part {
    whole: Arc<Whole>,
    own: usize,
    /// Around those of its patches that no sharp edge is between and a concave one.
    boxes: Boxes,
}

/// The parts of a surface; none of one that has no concave edges, or is rough.
pub(super) fn of(surface: &Triangulated) -> Vec<Box<dyn Obstacle<3>>> {
    let mut hollow = hollow(surface);
    let sides = sides(surface, &mut hollow);
    let (side, across) = nearest_sides(surface, &hollow, &sides);
    let facing: BTreeSet<[usize; 2]> = (0..hollow.len())
        .filter(|&edge| hollow[edge])
        .map(|edge| [sides[edge], sides[surface.opposite[edge]]])
        .collect();
    let Some((part, count)) = apart(&side, &facing) else {
        return Vec::new();
    };
    let whole = Arc::new(Whole {
        surface: surface.clone(),
        hollow,
        side,
        across,
        part,
        facing,
    });
    let one = |own: usize| -> Box<dyn Obstacle<3>> {
        Box::new(Part {
            whole: whole.clone(),
            own,
            boxes: boxes(&surface.patches, |patch| {
                whole.part[patch] == own && whole.across[patch] == 0
            }),
        })
    };
    (0..count).map(one).collect()
}

/// The normals of the triangles.
fn normals(surface: &Triangulated) -> Vec<Point> {
    let normal = |[a, b, c]: &[Point; 3]| (b - a).cross(&(c - a)).normalize() * surface.side;
    surface
        .patches
        .iter()
        .map(|p| normal(p.corners()))
        .collect()
}

/// Whether edge k of triangle f, at 3 f + k, is sharp and concave, seen by the body.
fn hollow(surface: &Triangulated) -> Vec<bool> {
    let normals = normals(surface);
    let least = HOLLOW.max(surface.sharp + ROUNDED);
    let is_hollow = |edge: usize| {
        let (f, g) = (edge / 3, surface.opposite[edge] / 3);
        let corners = surface.patches[f].corners();
        let along = corners[(edge + 1) % 3] - corners[edge % 3];
        let bend = normals[f].cross(&normals[g]).dot(&along) * surface.side;
        bend < 0.0 && normals[f].angle(&normals[g]) > least
    };
    (0..surface.opposite.len()).map(is_hollow).collect()
}

/// The side of each concave edge that a triangle is on: those of edges that meet are one where no third is between. An
/// edge that ends so that both of its sides are one is none.
fn sides(surface: &Triangulated, hollow: &mut [bool]) -> Vec<usize> {
    let next = |edge: usize| edge - edge % 3 + (edge + 1) % 3;
    let mut joined: Vec<usize> = (0..hollow.len()).collect();
    for edge in (0..hollow.len()).filter(|&edge| hollow[edge]) {
        // Around the end of the edge, to the next concave one.
        let mut other = next(edge);
        while !hollow[other] {
            other = next(surface.opposite[other]);
        }
        if other != surface.opposite[edge] {
            join(&mut joined, edge, other);
        }
    }
    let sides: Vec<usize> = (0..hollow.len()).map(|edge| root(&joined, edge)).collect();
    for (edge, is_hollow) in hollow.iter_mut().enumerate() {
        *is_hollow &= sides[edge] != sides[surface.opposite[edge]];
    }
    sides
}

/// The side that each triangle is nearest to, across how many sharp edges, the fewest; that of the first, across the
/// most, of those that none leads to.
fn nearest_sides(
    surface: &Triangulated,
    hollow: &[bool],
    sides: &[usize],
) -> (Vec<usize>, Vec<usize>) {
    let normals = normals(surface);
    let middle = |f: usize| surface.patches[f].corners().iter().sum::<Point>() / 3.0;
    let mut nearest: Vec<Option<(usize, usize)>> = vec![None; normals.len()];
    // Numbers that are not negative are ordered as their bits are.
    let concave = (0..hollow.len()).filter(|&edge| hollow[edge]);
    let start = concave.map(|edge| Reverse((0, 0.0f64.to_bits(), sides[edge], edge / 3)));
    let mut open: BinaryHeap<_> = start.collect();
    while let Some(Reverse((sharp, length, side, f))) = open.pop() {
        if nearest[f].is_some() {
            continue;
        }
        nearest[f] = Some((side, sharp));
        for edge in (3 * f..3 * f + 3).filter(|&edge| !hollow[edge]) {
            let g = surface.opposite[edge] / 3;
            let is_sharp = normals[f].angle(&normals[g]) > surface.sharp + ROUNDED;
            let length = f64::from_bits(length) + (middle(f) - middle(g)).norm();
            open.push(Reverse((
                sharp + usize::from(is_sharp),
                length.to_bits(),
                side,
                g,
            )));
        }
    }
    let first = nearest.iter().flatten().next().map_or(0, |(side, _)| *side);
    (nearest.into_iter())
        .map(|found| found.unwrap_or((first, usize::MAX)))
        .unzip()
}

/// The part of each triangle and their number: as few as keep sides that face each other apart.
fn apart(side: &[usize], facing: &BTreeSet<[usize; 2]>) -> Option<(Vec<usize>, usize)> {
    let mut size: BTreeMap<usize, usize> = BTreeMap::new();
    side.iter()
        .for_each(|&side| *size.entry(side).or_default() += 1);
    let mut order: Vec<usize> = size.keys().copied().collect();
    order.sort_by_key(|side| (Reverse(size[side]), *side));
    let mut part: BTreeMap<usize, usize> = BTreeMap::new();
    for own in order {
        let faced = |[a, b]: &[usize; 2]| (*a == own).then(|| part.get(b)).flatten();
        let taken: BTreeSet<usize> = facing.iter().filter_map(faced).copied().collect();
        let free = (0..).find(|k| !taken.contains(k)).unwrap_or_default();
        part.insert(own, free);
    }
    let count = part.values().max().map_or(0, |most| most + 1);
    (2..=MOST_PARTS)
        .contains(&count)
        .then(|| (side.iter().map(|side| part[side]).collect(), count))
}

impl Whole {
    /// Whether the foot is on a concave edge, and its tangent plane goes on from there to where its point is.
    fn goes_on(&self, foot: &Foot) -> bool {
        let is_hollow = |k: usize| foot.on[k] && self.hollow[3 * foot.patch + k];
        let beyond = foot.from - foot.normal * foot.normal.dot(&foot.from);
        // As far again it is still in the body, and does not come out of it.
        let is_within = || self.surface.distance(&(foot.jet.x + beyond * 2.0)) < 0.0;
        (0..3).any(is_hollow) && (!foot.is_off(self.surface.size) || is_within())
    }

    /// The part that is nearest, the first of those that meet at the foot.
    fn owner(&self, nearest: &Foot) -> usize {
        let own = self.part[nearest.patch];
        if nearest.on == [false; 3] {
            return own;
        }
        let (same, foot) = (SAME * self.surface.size, nearest.jet.x);
        let patches = &self.surface.patches;
        let near = (self.surface.boxes).locate_within_distance(foot.into(), same * same);
        let meets = |patch: &usize| {
            let at = patches[*patch].nearest(&foot);
            (patches[*patch].at(&at).x - foot).norm() <= same
        };
        let meeting = near.map(|found| found.data).filter(meets);
        meeting.map(|patch| self.part[patch]).fold(own, usize::min)
    }
}

impl Part {
    /// The point of the part that counts for x, and how much farther than that it is.
    fn seen(&self, x: &Point) -> (Foot, f64) {
        let (whole, surface) = (&*self.whole, &self.whole.surface);
        let nearest = surface.foot(x);
        let is_own = whole.part[nearest.patch] == self.own;
        let goes_on = whole.goes_on(&nearest);
        if !goes_on && whole.owner(&nearest) == self.own {
            return (nearest, 0.0);
        }
        let mut foot = match is_own && goes_on {
            true => nearest.clone(),
            false => surface.foot_among(&self.boxes, x),
        };
        let same = SAME * surface.size;
        let goes_on = whole.goes_on(&foot);
        if !goes_on && (foot.jet.x - nearest.jet.x).norm() <= same {
            return (nearest, surface.size);
        }
        if goes_on {
            foot.onto_plane(x);
        }
        // What is before the surface is behind none of its parts.
        let outside = surface.side * nearest.distance(surface.size);
        let depth = -surface.side * foot.normal.dot(&foot.from);
        let [a, b] = [nearest.patch, foot.patch].map(|patch| whole.side[patch]);
        let is_next = a == b || whole.facing.contains(&[a, b]) && whole.across[nearest.patch] == 0;
        let counts = depth <= 0.0 || is_next && (depth <= same || outside < 0.0);
        match counts && !foot.is_off(surface.size) {
            true => (foot, 0.0),
            false => (nearest, surface.size),
        }
    }
}

impl Obstacle<3> for Part {
    fn distance(&self, x: &Point) -> f64 {
        let (foot, farther) = self.seen(x);
        self.whole.surface.side * foot.distance(self.whole.surface.size) + farther
    }

    fn normal(&self, x: &Point) -> Point {
        let surface = &self.whole.surface;
        self.seen(x).0.normal(surface.size) * surface.side
    }

    fn curvature(&self, x: &Point) -> Matrix3<f64> {
        let surface = &self.whole.surface;
        self.seen(x).0.curvature(surface.size) * surface.side
    }

    fn way(&self, from: &Point, to: &Point) -> Point {
        let [start, end] = [from, to].map(|x| self.seen(x).0);
        self.whole.surface.way_between(&start, &end)
    }

    fn reference(&self) -> Point {
        self.whole.surface.first
    }

    fn corner(&self, x: &Point, tolerance: f64) -> Option<Corner<3>> {
        let surface = &self.whole.surface;
        let is_own = self.whole.owner(&surface.foot(x)) == self.own;
        is_own.then(|| surface.corner(x, tolerance)).flatten()
    }
}
