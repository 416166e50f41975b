//! The part of an edge that the other surface covers, in the plane: segments between the normals
//! through the ends of its edges; not the multipliers on it.

use super::Sides;
use super::face::{self, Face, cross, difference, root};
use super::mortar::{Overlap, SLIVER, Sample};
use crate::gauss;
use crate::geometry::interpolate;
use std::collections::BTreeSet;

/// A part of an edge that an edge of the other surface covers, in reference coordinates.
struct Segment {
    from: f64,
    to: f64,
    other: usize,
}

impl<const D: usize> Sides<'_, D> {
    pub(super) fn overlap_in_plane(
        &self,
        edge: &Face<D>,
        measure: &dyn Fn(&[f64; D]) -> f64,
        limit: &dyn Fn(usize) -> f64,
    ) -> Overlap {
        let normals = self.normals_of(edge);
        let segments = self.segments(edge, &normals);
        let places = edge.places();
        let is_near = |&a: &usize| {
            let (xi, limit) = (places[a][0], limit(a));
            let mut parts = segments.iter();
            parts.any(|s| xi >= s.from - limit && xi <= s.to + limit)
        };
        Overlap {
            near: (0..places.len()).filter(is_near).collect(),
            samples: self.samples(edge, &normals, &segments, measure),
        }
    }

    /// The edges of the other surface that cover a part of an edge.
    pub(super) fn faced_in_plane(&self, edge: &Face<D>) -> BTreeSet<usize> {
        let segments = self.segments(edge, &self.normals_of(edge));
        segments.iter().map(|s| s.other).collect()
    }

    /// The overlap of an edge with the other surface, nearest first where that is folded.
    fn segments(&self, edge: &Face<D>, normals: &[[f64; D]]) -> Vec<Segment> {
        let depth = edge.size();
        let mut far = depth;
        loop {
            let candidates = self.candidates(&edge.nodes, (&edge.x, normals), depth, far);
            let mut parts: Vec<(f64, Segment)> = candidates
                .into_iter()
                .filter_map(|k| self.part(edge, normals, k))
                .filter(|(gap, _)| *gap >= -depth)
                .collect();
            parts.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            let mut segments: Vec<Segment> = Vec::new();
            for (_, part) in parts {
                for (from, to) in without(&part, &segments) {
                    segments.push(Segment {
                        from,
                        to,
                        other: part.other,
                    });
                }
            }
            segments.sort_by(|a, b| a.from.total_cmp(&b.from));
            let covered: f64 = segments.iter().map(|s| s.to - s.from).sum();
            if covered >= 2.0 - SLIVER || far >= self.reach {
                return segments;
            }
            far *= 4.0;
        }
    }

    /// The part of an edge that one of the other surface covers, and the gap in its middle.
    fn part(&self, edge: &Face<D>, normals: &[[f64; D]], other: usize) -> Option<(f64, Segment)> {
        let opposite = &self.other[other];
        let at = |xi: f64| edge.at([xi, 0.0]);
        let normal = |xi: f64| interpolate(&edge.shape([xi, 0.0]), normals);
        // Reference coordinate whose normal passes through an end of the other edge.
        let place = |x: &[f64; D]| -> Option<f64> {
            let side = |xi: f64| cross(&difference(&at(xi), x), &normal(xi));
            let (low, high) = (side(-1.0), side(1.0));
            match (low >= 0.0, high >= 0.0) {
                (true, true) => Some(f64::INFINITY),
                (false, false) => Some(f64::NEG_INFINITY),
                (true, false) => Some(root(side, low, high)),
                // Beyond where the normals cross.
                (false, true) => None,
            }
        };
        // Surfaces that face each other are walked in opposite directions.
        let from = place(&opposite.x[1])?.max(-1.0);
        let to = place(&opposite.x[0])?.min(1.0);
        if to - from <= SLIVER {
            return None;
        }
        let middle = 0.5 * (from + to);
        let (x, n) = (at(middle), normal(middle));
        let gap = face::along(&x, &opposite.at(opposite.hit(&x, &n)?), &n);
        Some((gap, Segment { from, to, other }))
    }

    fn samples(
        &self,
        edge: &Face<D>,
        normals: &[[f64; D]],
        segments: &[Segment],
        measure: &dyn Fn(&[f64; D]) -> f64,
    ) -> Vec<Sample> {
        // Exact for quadratic functions on both sides of a straight edge, and to spare.
        let rule = gauss(5);
        let mut samples = Vec::new();
        for segment in segments {
            let half = 0.5 * (segment.to - segment.from);
            for point in &rule.points {
                let xi = [segment.from + half * (1.0 + point.xi[0]), 0.0];
                let (x, shape) = (edge.at(xi), edge.shape(xi));
                let other = &self.other[segment.other];
                let Some(eta) = other.hit(&x, &interpolate(&shape, normals)) else {
                    continue;
                };
                samples.push(Sample {
                    shape,
                    changed: edge.change.apply(&shape),
                    d_s: point.weight * half * edge.stretch(xi) * measure(&x),
                    other: segment.other,
                    opposite: other.shape(eta),
                });
            }
        }
        samples
    }
}

/// What is left of a segment beside others.
fn without(part: &Segment, taken: &[Segment]) -> Vec<(f64, f64)> {
    let mut left = vec![(part.from, part.to)];
    for other in taken {
        let beside =
            |(from, to): (f64, f64)| [(from, to.min(other.from)), (from.max(other.to), to)];
        left = left
            .into_iter()
            .flat_map(beside)
            .filter(|(from, to)| to - from > SLIVER)
            .collect();
    }
    left
}
