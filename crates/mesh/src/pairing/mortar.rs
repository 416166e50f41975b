//! Segment-to-segment integration with dual multipliers on the part of an edge that the other
//! surface covers; not the search of that surface's edges.

use super::edge::{self, Edge, cross, difference, root};
use super::{Coupling, Sides};
use crate::gauss;
use crate::mesh::NodeKind;
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Parts of an edge shorter than this, in reference coordinates, are rounding.
const SLIVER: f64 = 1e-9;

/// Weights below this are none.
const ROUNDING: f64 = 1e-13;

/// How far from the overlap a node may be, in reference coordinates, to have a multiplier.
const NEAR: f64 = 0.25;

/// A part of an edge that an edge of the other surface covers, in reference coordinates.
struct Segment {
    from: f64,
    to: f64,
    other: usize,
}

/// A quadrature point of an edge's overlap.
struct Sample {
    xi: f64,
    /// N_c of the edge.
    shape: [f64; 3],
    /// Weight times |∂x/∂ξ| times the measure of the hypothesis.
    d_s: f64,
    other: usize,
    /// N_b of the edge opposite.
    opposite: [f64; 3],
}

/// Weights of a node, gathered over its edges.
struct Sums {
    kind: NodeKind,
    area: f64,
    own: BTreeMap<usize, f64>,
    opposite: BTreeMap<usize, f64>,
}

impl<const D: usize> Sides<'_, D> {
    pub(super) fn mortar(&self, measure: &dyn Fn(&[f64; D]) -> f64) -> Vec<Coupling<D>> {
        let mut sums: BTreeMap<usize, Sums> = BTreeMap::new();
        for edge in self.own {
            let normals = self.normals_of(edge);
            let segments = self.segments(edge, &normals);
            let samples = self.samples(edge, &normals, &segments, measure);
            self.integrate(edge, &segments, &samples, &mut sums);
        }
        // A corner on the axis of symmetry has no share of the surface.
        let largest = sums.values().map(|s| s.area).fold(0.0, f64::max);
        sums.retain(|_, s| s.area > SLIVER * largest);
        let coupling = |(node, sums): (usize, Sums)| {
            // Matching meshes leave weights that are rounding. Both sums of weights are the area.
            let relative = |mut weights: BTreeMap<usize, f64>| -> Vec<(usize, f64)> {
                weights.retain(|_, w| w.abs() > ROUNDING * sums.area);
                let sum: f64 = weights.values().sum();
                weights.into_iter().map(|(b, w)| (b, w / sum)).collect()
            };
            Coupling {
                node,
                kind: sums.kind,
                area: sums.area,
                normal: self.normals[&node].map(|v| -v),
                own: relative(sums.own),
                opposite: relative(sums.opposite),
            }
        };
        sums.into_iter().map(coupling).collect()
    }

    /// The overlap of an edge with the other surface, nearest first where that is folded.
    fn segments(&self, edge: &Edge<D>, normals: &[[f64; D]]) -> Vec<Segment> {
        let depth = edge.size();
        let mut far = depth;
        loop {
            let candidates = self.candidates(&edge.x, normals, depth, far);
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
    fn part(&self, edge: &Edge<D>, normals: &[[f64; D]], other: usize) -> Option<(f64, Segment)> {
        let opposite = &self.other[other];
        let normal = |xi: f64| edge::combine(&edge.shape(xi), normals);
        // Reference coordinate whose normal passes through an end of the other edge.
        let place = |x: &[f64; D]| -> Option<f64> {
            let side = |xi: f64| cross(&difference(&edge.at(xi), x), &normal(xi));
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
        let (x, n) = (edge.at(middle), normal(middle));
        let gap = edge::along(&x, &opposite.at(opposite.hit(&x, &n)?), &n);
        Some((gap, Segment { from, to, other }))
    }

    fn samples(
        &self,
        edge: &Edge<D>,
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
                let xi = segment.from + half * (1.0 + point.xi[0]);
                let (x, shape) = (edge.at(xi), edge.shape(xi));
                let n = edge::combine(&shape, normals);
                let other = &self.other[segment.other];
                let Some(eta) = other.hit(&x, &n) else {
                    continue;
                };
                samples.push(Sample {
                    xi,
                    shape,
                    d_s: point.weight * half * edge.stretch(xi) * measure(&x),
                    other: segment.other,
                    opposite: other.shape(eta),
                });
            }
        }
        samples
    }

    /// Adds the integrals of an edge: ∫ Φ_a N_c, ∫ Φ_a N_b and ∫ Φ_a.
    ///
    /// The multipliers Φ_a are polynomials on the overlap with Σ Φ_a = 1 and ∫ Φ_a N_c = 0 for
    /// the other nodes c that have one: all nodes of an edge that is covered, else those within
    /// the overlap.
    fn integrate(
        &self,
        edge: &Edge<D>,
        segments: &[Segment],
        samples: &[Sample],
        sums: &mut BTreeMap<usize, Sums>,
    ) {
        let integral =
            |f: &dyn Fn(&Sample) -> f64| samples.iter().map(|s| s.d_s * f(s)).sum::<f64>();
        let share = |c: usize| integral(&|s| s.shape[c]);
        let count = edge.nodes.len();
        let near = |c: &usize| {
            let at = Edge::<D>::place(*c);
            segments
                .iter()
                .any(|s| at >= s.from - NEAR && at <= s.to + NEAR)
        };
        let mut active: Vec<usize> = (0..count).filter(near).collect();
        if active.is_empty() {
            // The other surface is narrower than this edge.
            let most = |a: &usize, b: &usize| share(*a).total_cmp(&share(*b));
            active.extend((0..count).max_by(most).filter(|&c| share(c) > 0.0));
        }
        let order = active.len();
        let moments = DMatrix::from_fn(order, order, |k, c| {
            integral(&|s| s.xi.powi(k as i32) * s.shape[active[c]])
        });
        // Φ_a = Σ_k A_ak ξ^k with A ∫ξ^k N_c = δ_ac ∫N_c.
        let Some(inverse) = moments.try_inverse() else {
            return;
        };
        for (row, &a) in active.iter().enumerate() {
            let scale = share(a);
            let multiplier = |xi: f64| -> f64 {
                (0..order)
                    .map(|k| scale * inverse[(row, k)] * xi.powi(k as i32))
                    .sum()
            };
            let area = integral(&|s| multiplier(s.xi));
            let sums = sums.entry(edge.nodes[a]).or_insert_with(|| Sums {
                kind: edge.kind(a),
                area: 0.0,
                own: BTreeMap::new(),
                opposite: BTreeMap::new(),
            });
            sums.area += area;
            for c in (0..count).filter(|&c| c == a || !active.contains(&c)) {
                let weight = integral(&|s| multiplier(s.xi) * s.shape[c]);
                *sums.own.entry(edge.nodes[c]).or_insert(0.0) += weight;
            }
            for sample in samples {
                let weight = multiplier(sample.xi) * sample.d_s;
                let other = &self.other[sample.other];
                for (&b, n) in other.nodes.iter().zip(sample.opposite) {
                    *sums.opposite.entry(b).or_insert(0.0) += weight * n;
                }
            }
        }
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
