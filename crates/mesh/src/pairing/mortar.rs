//! Dual multipliers on the part of a facet that the other surface covers; not the search of that
//! part.

use super::face::{Face, NODES, Values, along, difference, unit};
use super::{MortarRow, Sides};
use crate::geometry::{dot, interpolate};
use crate::mesh::{Facet, NodeKind};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// Parts of a facet below this part of it are rounding.
pub(super) const SLIVER: f64 = 1e-9;

/// Weights below this are none.
const ROUNDING: f64 = 1e-13;

/// How far from the overlap a node may be, over half a side of the reference facet, to have a
/// multiplier; and to keep the one that it has.
const NEAR: [f64; 2] = [0.25, 0.5];

/// Least share of a multiplier in the overlap of a facet; and of one that is kept.
const LEAST: [f64; 2] = [1e-3, 1e-4];

/// How much less straight than another a part of a surface may look at what is opposite, in cosines; and one that has.
const ASKEW: [f64; 2] = [0.1, 0.2];

/// How much farther than another it may be from that, over the size of a facet; and one that has been near.
const BEYOND: [f64; 2] = [0.1, 0.2];

/// What was decided of a surface by a limit: which nodes have a multiplier, where it has an edge, which of the parts that meet
/// there looks at what is opposite.
///
/// While surfaces slide and turn within an increment, what was decided is kept, or has to go farther than the limit to be
/// decided otherwise: or equilibrium would be sought between two sets of multipliers, of which each iterate has the other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MultiplierChoices {
    /// The smooth part of the surface that each facet is of; none before the first pairing.
    pub(super) parts: Vec<usize>,
    /// Local indices of the nodes with a multiplier, by facet.
    nodes: BTreeMap<Facet, Vec<usize>>,
    /// The parts of which a node has its multiplier.
    facing: BTreeMap<usize, Vec<usize>>,
}

/// What the other surface covers of a facet.
#[derive(Default)]
pub(super) struct Overlap {
    /// Its quadrature points.
    pub(super) samples: Vec<Sample>,
    /// Local indices of the nodes within it or near.
    pub(super) near: Vec<usize>,
}

/// A quadrature point of an overlap.
pub(super) struct Sample {
    /// N_c of the facet.
    pub(super) shape: Values,
    /// Its Ñ_c, to which multipliers are dual.
    pub(super) changed: Values,
    /// Weight times area times the measure of the hypothesis.
    pub(super) d_s: f64,
    /// The facet opposite.
    pub(super) other: usize,
    /// Its N_b.
    pub(super) opposite: Values,
}

/// Weights of a node, gathered over its facets.
struct Sums {
    kind: NodeKind,
    area: f64,
    /// ∫ Φ_a times the cosine of the angle between its normal and that opposite.
    seen: f64,
    /// ∫ Φ_a times the gap along its normal.
    gap: f64,
    /// Largest of its facets.
    size: f64,
    own: BTreeMap<usize, f64>,
    opposite: BTreeMap<usize, f64>,
}

/// The multipliers Φ_a of the nodes that have one, by their values at the samples.
struct Multipliers {
    nodes: Vec<usize>,
    /// Φ_a dS at every sample.
    values: Vec<Vec<f64>>,
}

impl<const D: usize> Sides<'_, D> {
    pub(super) fn mortar(
        &self,
        facets: &[Facet],
        measure: &dyn Fn(&[f64; D]) -> f64,
        choices: &mut MultiplierChoices,
    ) -> Vec<MortarRow<D>> {
        let mut sums: BTreeMap<(usize, usize), Sums> = BTreeMap::new();
        let before = std::mem::take(&mut choices.nodes);
        for (facet, face) in facets.iter().zip(self.own) {
            let kept = before.get(facet).map_or(&[][..], Vec::as_slice);
            let mut overlap = match D {
                2 => self.overlap_in_plane(face, measure, &near(kept)),
                _ => self.overlap_in_space(face, measure, &near(kept)),
            };
            self.fade(face, &mut overlap);
            if let Some(multipliers) = Multipliers::new(&overlap, face.nodes.len(), kept) {
                self.integrate(face, (&overlap, &multipliers), &mut sums);
                choices.nodes.insert(*facet, multipliers.nodes);
            }
        }
        // What lies on the axis of symmetry is no surface.
        let largest = sums.values().map(|s| s.area).fold(0.0, f64::max);
        sums.retain(|_, s| s.area > SLIVER * largest);
        let mut nodes: BTreeMap<usize, Vec<(usize, Sums)>> = BTreeMap::new();
        for ((part, node), sums) in sums {
            nodes.entry(node).or_default().push((part, sums));
        }
        let before = std::mem::take(&mut choices.facing);
        let coupling = |(node, parts): (usize, Vec<(usize, Sums)>)| {
            let parts = facing(parts, before.get(&node).map_or(&[][..], Vec::as_slice));
            let of_node = parts.iter().map(|(part, _)| *part).collect();
            choices.facing.insert(node, of_node);
            let (n, sums) = self.gathered(node, parts);
            // Matching meshes leave weights that are rounding. Both sums of weights are the area.
            let relative = |mut weights: BTreeMap<usize, f64>| -> Vec<(usize, f64)> {
                weights.retain(|_, w| w.abs() > ROUNDING * sums.area);
                let sum: f64 = weights.values().sum();
                weights.into_iter().map(|(b, w)| (b, w / sum)).collect()
            };
            MortarRow {
                node,
                kind: sums.kind,
                area: sums.area,
                normal: n.map(|v| -v),
                own: relative(sums.own),
                opposite: relative(sums.opposite),
            }
        };
        nodes.into_iter().map(coupling).collect()
    }

    /// What is behind what is nearest to a facet by more than its size is less and less opposite to it, by twice that not at
    /// all. Beside a surface that a facet grazes gaps grow without end, and multipliers, which are negative in places, would
    /// weight them to one below zero where bodies are apart.
    ///
    /// So is what it would be within by more than its size times the squared cosine of their angle: a side across a surface
    /// is beyond its end, and not as deep in it as it is wide.
    fn fade(&self, face: &Face<D>, overlap: &mut Overlap) {
        let normals = self.normals_of(face);
        let met = |s: &Sample| {
            let (other, n) = (&self.other[s.other], interpolate(&s.shape, &normals));
            let (x, y) = (
                interpolate(&s.shape, &face.x),
                interpolate(&s.opposite, &other.x),
            );
            let cosine = -dot(&unit(&n), &other.facing);
            (along(&x, &y, &n), cosine.max(f64::EPSILON))
        };
        let met: Vec<(f64, f64)> = overlap.samples.iter().map(met).collect();
        let least = met.iter().map(|m| m.0).fold(f64::INFINITY, f64::min);
        for (sample, (gap, cosine)) in overlap.samples.iter_mut().zip(met) {
            let behind = 2.0 - (gap - least) / face.size();
            let within = 2.0 + gap / (face.size() * cosine * cosine);
            sample.d_s *= behind.min(within).clamp(0.0, 1.0);
        }
        overlap.samples.retain(|s| s.d_s > 0.0);
    }

    /// The mean normal of the parts of a surface of which a node has its multiplier, and all of their integrals.
    fn gathered(&self, node: usize, parts: Vec<(usize, Sums)>) -> ([f64; D], Sums) {
        let mut parts = parts.into_iter();
        let (part, mut sums) = parts.next().expect("a node has a part");
        let mut n = self.normals[&(part, node)];
        for (part, more) in parts {
            let m = self.normals[&(part, node)];
            n = unit(&std::array::from_fn(|i| n[i] + m[i]));
            sums.area += more.area;
            for (weights, more) in [
                (&mut sums.own, more.own),
                (&mut sums.opposite, more.opposite),
            ] {
                for (a, w) in more {
                    *weights.entry(a).or_insert(0.0) += w;
                }
            }
        }
        (n, sums)
    }

    /// Adds the integrals of a facet: ∫ Φ_a N_c, ∫ Φ_a N_b and ∫ Φ_a.
    fn integrate(
        &self,
        face: &Face<D>,
        (overlap, multipliers): (&Overlap, &Multipliers),
        sums: &mut BTreeMap<(usize, usize), Sums>,
    ) {
        let count = face.nodes.len();
        let apart = |s: &Sample| {
            let x = interpolate(&s.shape, &face.x);
            difference(&interpolate(&s.opposite, &self.other[s.other].x), &x)
        };
        let apart: Vec<[f64; D]> = overlap.samples.iter().map(apart).collect();
        for (&a, phi) in multipliers.nodes.iter().zip(&multipliers.values) {
            let sums = sums
                .entry((face.part, face.nodes[a]))
                .or_insert_with(|| Sums {
                    kind: face.node_kind(a),
                    area: 0.0,
                    seen: 0.0,
                    gap: 0.0,
                    size: 0.0,
                    own: BTreeMap::new(),
                    opposite: BTreeMap::new(),
                });
            sums.area += phi.iter().sum::<f64>();
            sums.size = sums.size.max(face.size());
            let n = self.normals[&(face.part, face.nodes[a])];
            // Those of the other nodes with a multiplier vanish where Ñ is N.
            let beside =
                |c: &usize| *c == a || !face.change.is_none() || !multipliers.nodes.contains(c);
            for c in (0..count).filter(beside) {
                let products = overlap.samples.iter().zip(phi).map(|(s, p)| p * s.shape[c]);
                *sums.own.entry(face.nodes[c]).or_insert(0.0) += products.sum::<f64>();
            }
            let gap = |(p, apart): (&f64, &[f64; D])| p * dot(apart, &n);
            sums.gap += phi.iter().zip(&apart).map(gap).sum::<f64>();
            let mut phi = phi.iter();
            for samples in overlap.samples.chunk_by(|s, next| s.other == next.other) {
                let other = &self.other[samples[0].other];
                let (mut whole, mut weights) = (0.0, [0.0; NODES]);
                for (sample, p) in samples.iter().zip(&mut phi) {
                    whole += p;
                    weights
                        .iter_mut()
                        .zip(sample.opposite)
                        .for_each(|(w, n)| *w += p * n);
                }
                sums.seen -= whole * dot(&n, &other.facing);
                for (&b, w) in other.nodes.iter().zip(weights) {
                    *sums.opposite.entry(b).or_insert(0.0) += w;
                }
            }
        }
    }
}

/// Of the parts of a surface that meet in a node the one that looks straight at what is opposite, or those that do, as a
/// corner that stands in another; some have been those.
fn facing(mut parts: Vec<(usize, Sums)>, kept: &[usize]) -> Vec<(usize, Sums)> {
    let gap = |s: &Sums| (s.gap / s.area).abs();
    let seen = |s: &Sums| s.seen / s.area;
    let is_kept = |part: &usize| usize::from(kept.contains(part));
    let all = parts.iter().map(|(_, s)| s);
    let least = all.map(gap).fold(f64::INFINITY, f64::min);
    parts.retain(|(part, s)| gap(s) <= least + BEYOND[is_kept(part)] * s.size);
    let all = parts.iter().map(|(_, s)| s);
    let best = all.map(seen).fold(f64::NEG_INFINITY, f64::max);
    parts.retain(|(part, s)| seen(s) >= best - ASKEW[is_kept(part)]);
    parts
}

/// How far from the overlap each node of a facet may be, of which some have a multiplier.
fn near(kept: &[usize]) -> impl Fn(usize) -> f64 {
    |a| NEAR[usize::from(kept.contains(&a))]
}

impl Multipliers {
    /// The Φ_a with Σ Φ_a = 1 and ∫ Φ_a Ñ_c = 0 for the other nodes c that have one: all nodes of a
    /// facet that is covered, else those within the overlap or near. `None` without an overlap.
    ///
    /// A multiplier that hardly has a share of the overlap or a negative one, as that of a node of
    /// which the overlap is far, is left to the others: a force would push nowhere, or pull.
    fn new(overlap: &Overlap, count: usize, kept: &[usize]) -> Option<Self> {
        let samples = &overlap.samples;
        let share = |c: usize| samples.iter().map(|s| s.d_s * s.changed[c]).sum::<f64>();
        let by_share = |a: &usize, b: &usize| share(*a).total_cmp(&share(*b));
        let whole: f64 = samples.iter().map(|s| s.d_s).sum();
        let pushes = |(a, phi): (&usize, &Vec<f64>)| {
            phi.iter().sum::<f64>() > LEAST[usize::from(kept.contains(a))] * whole
        };
        let mut nodes = overlap.near.clone();
        if nodes.is_empty() {
            // The other surface is narrower than this facet.
            nodes.extend((0..count).max_by(by_share).filter(|&c| share(c) > 0.0));
        }
        while !nodes.is_empty() {
            if let Some(values) = dual(samples, &nodes)
                && nodes.iter().zip(&values).all(pushes)
            {
                return Some(Self { nodes, values });
            }
            let least = nodes.iter().copied().min_by(by_share);
            nodes.retain(|&a| Some(a) != least);
        }
        None
    }
}

/// Φ_a dS at the samples, for the given nodes.
///
/// They span the ψ_c = Ñ_c + (1 − Σ Ñ)/m, the sum over these m nodes, which sum to 1:
/// Φ_a = Σ_c A_ac ψ_c with A ∫ψ_c Ñ_d = δ_ad ∫Ñ_d.
fn dual(samples: &[Sample], nodes: &[usize]) -> Option<Vec<Vec<f64>>> {
    let order = nodes.len();
    let spanning = |s: &Sample| -> Values {
        let sum: f64 = nodes.iter().map(|&c| s.changed[c]).sum();
        let psi = |&c: &usize| s.changed[c] + (1.0 - sum) / order as f64;
        std::array::from_fn(|c| nodes.get(c).map_or(0.0, psi))
    };
    let spanning: Vec<Values> = samples.iter().map(spanning).collect();
    let mut moments = DMatrix::<f64>::zeros(order, order);
    for (s, psi) in samples.iter().zip(&spanning) {
        for c in 0..order {
            let weight = s.d_s * psi[c];
            for d in 0..order {
                moments[(c, d)] += weight * s.changed[nodes[d]];
            }
        }
    }
    // Σ_c ψ_c = 1: the sums of the columns are the shares ∫ Ñ_d.
    let shares: Vec<f64> = moments.column_iter().map(|c| c.sum()).collect();
    let inverse = moments.try_inverse()?;
    let phi = |a: usize| {
        let at = |(s, psi): (&Sample, &Values)| {
            let value = |c: usize| inverse[(a, c)] * psi[c];
            s.d_s * shares[a] * (0..order).map(value).sum::<f64>()
        };
        samples.iter().zip(&spanning).map(at).collect()
    };
    Some((0..order).map(phi).collect())
}
