//! The part of a face that the other surface covers, in space: convex polygons in its mean plane;
//! not the multipliers on it.
//!
//! M. A. Puso and T. A. Laursen, *Comput. Methods Appl. Mech. Engng* 193 (2004) 601–629.

use super::Sides;
use super::face::{Face, View, difference};
use super::mortar::{Overlap, SLIVER, Sample};
use super::polygon::{self, Polygon};
use crate::Rule;
use crate::geometry::{dot, interpolate};
use std::collections::BTreeSet;

/// Degree of the polynomials that are integrated exactly between linear faces: N_a N_b.
const LINEAR: usize = 5;

/// The degree where a face is not the linear image of its reference face and shape functions are no
/// polynomials on it.
const OTHERWISE: usize = 12;

/// Normals whose cosine is nearer to 1 are those of a flat surface.
const FLAT: f64 = 1e-14;

/// A part of a face that a face of the other surface covers, as seen along its normal.
struct Patch {
    polygon: Polygon,
    other: usize,
}

impl<const D: usize> Sides<'_, D> {
    pub(super) fn overlap_in_space(
        &self,
        face: &Face<D>,
        measure: &dyn Fn(&[f64; D]) -> f64,
        limit: &dyn Fn(usize) -> f64,
    ) -> Overlap {
        let middle = face.middle();
        let view = View::new(face.at(middle), &face.outward(middle));
        let patches = self.patches(face, &view);
        let samples = patches
            .iter()
            .flat_map(|patch| self.patch_samples(face, &view, patch, measure));
        Overlap {
            samples: samples.collect(),
            near: near(face, &view, &patches, limit),
        }
    }

    /// The faces of the other surface that cover a part of a face.
    pub(super) fn faced_in_space(&self, face: &Face<D>) -> BTreeSet<usize> {
        let middle = face.middle();
        let view = View::new(face.at(middle), &face.outward(middle));
        let patches = self.patches(face, &view);
        patches.iter().map(|patch| patch.other).collect()
    }

    /// The overlap of a face with the other surface, nearest first where that is folded.
    fn patches(&self, face: &Face<D>, view: &View<D>) -> Vec<Patch> {
        let own = seen(face, view, false);
        let whole: f64 = own.iter().map(Polygon::area).sum();
        let least = SLIVER * whole;
        let normals = vec![view.normal; face.x.len()];
        let depth = face.size();
        let mut far = depth;
        loop {
            let mut parts: Vec<(f64, Patch)> = Vec::new();
            for other in self.candidates(&face.nodes, (&face.x, &normals), depth, far) {
                for polygon in seen(&self.other[other], view, true) {
                    for part in own.iter().map(|own| own.within(&polygon)) {
                        if part.area() > least
                            && let Some(gap) = self.gap(face, view, part.centre(), other)
                            && gap >= -depth
                        {
                            let polygon = part;
                            parts.push((gap, Patch { polygon, other }));
                        }
                    }
                }
            }
            parts.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
            let mut patches: Vec<Patch> = Vec::new();
            for (_, Patch { polygon, other }) in parts {
                let left = patches.iter().fold(vec![polygon], |left, taken| {
                    let beside = |p: Polygon| p.without(&taken.polygon, least);
                    left.into_iter().flat_map(beside).collect()
                });
                patches.extend(left.into_iter().map(|polygon| Patch { polygon, other }));
            }
            let covered: f64 = patches.iter().map(|p| p.polygon.area()).sum();
            if covered >= (1.0 - SLIVER) * whole || far >= self.reach {
                return patches;
            }
            far *= 4.0;
        }
    }

    /// Distance to another face along the view, at a point of it.
    fn gap(&self, face: &Face<D>, view: &View<D>, at: [f64; 2], other: usize) -> Option<f64> {
        let other = &self.other[other];
        let x = face.below(view, at, face.middle())?;
        let y = other.below(view, at, other.middle())?;
        Some(dot(&difference(&other.at(y), &face.at(x)), &view.normal))
    }

    fn patch_samples(
        &self,
        face: &Face<D>,
        view: &View<D>,
        patch: &Patch,
        measure: &dyn Fn(&[f64; D]) -> f64,
    ) -> Vec<Sample> {
        let other = &self.other[patch.other];
        let linear = |f: &Face<D>| f.is_affine() && f.nodes.len() == f.kind.corner_count();
        let rule = Rule::triangle(match linear(face) && linear(other) {
            true => LINEAR,
            false => OTHERWISE,
        });
        let normals = self.normals_of(face);
        let tilted = |n: &[f64; D]| dot(n, &view.normal) < 1.0 - FLAT;
        let curved = normals.iter().any(tilted);
        let mut samples = Vec::new();
        for triangle in patch.polygon.triangles() {
            let twice = 2.0 * polygon::area(&triangle);
            // Places between those of the corners are nearly those that are looked for.
            let [own, opposite] = [face, other].map(|f| {
                triangle.map(|p| f.below(view, p, f.middle()).unwrap_or_else(|| f.middle()))
            });
            for point in &rule.points {
                let between = |[a, b, c]: [[f64; 2]; 3]| {
                    let [s, t] = point.xi;
                    [0, 1].map(|i| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]))
                };
                let at = between(triangle);
                let Some(xi) = face.below(view, at, between(own)) else {
                    continue;
                };
                let shape = face.shape(xi);
                let guess = between(opposite);
                // Opposite is what is met along the normal, which changes from place to place.
                let along = curved.then(|| View::new(face.at(xi), &interpolate(&shape, &normals)));
                let met = along.and_then(|along| other.below(&along, [0.0; 2], guess));
                let met = met.filter(|eta| other.is_near(eta));
                let Some(eta) = met.or_else(|| other.below(view, at, guess)) else {
                    continue;
                };
                // The area of the face itself, not of what is seen.
                let outward = face.outward(xi);
                let tilt = dot(&outward, &outward).sqrt() / dot(&outward, &view.normal);
                samples.push(Sample {
                    shape,
                    changed: face.change.apply(&shape),
                    d_s: point.weight * twice * tilt * measure(&face.at(xi)),
                    other: patch.other,
                    opposite: other.shape(eta),
                });
            }
        }
        samples
    }
}

/// A face as it is seen along a view; of one that is looked at from behind, if that is asked for.
fn seen<const D: usize>(face: &Face<D>, view: &View<D>, behind: bool) -> Vec<Polygon> {
    let mut corners: Vec<[f64; 2]> = face.corners().iter().map(|x| view.of(x)).collect();
    if behind {
        corners.reverse();
    }
    Polygon::parts(&corners)
}

/// The nodes of a face that are within an overlap or near, by a limit for each, over half a side, measured in the reference face.
fn near<const D: usize>(
    face: &Face<D>,
    view: &View<D>,
    patches: &[Patch],
    limit: &dyn Fn(usize) -> f64,
) -> Vec<usize> {
    let half = 0.5 * face.unit();
    let place = |patch: &Patch| {
        let corners = patch.polygon.corners().iter();
        let places: Option<Vec<_>> = corners
            .map(|&c| face.below(view, c, face.middle()))
            .collect();
        places.map(Polygon::new)
    };
    let places: Vec<Polygon> = patches.iter().filter_map(place).collect();
    let nodes = face.places();
    let is_near = |a: &usize| {
        places
            .iter()
            .any(|p| p.distance(nodes[*a]) <= half * limit(*a))
    };
    (0..nodes.len()).filter(is_near).collect()
}
