//! Where facets lie on each other that no cells share: cracks, and bodies side by side; not what joins them.

use super::face::{self, Face};
use super::overlap::distance;
use super::tree::Tree;
use crate::geometry::dot;
use crate::mesh::{Facet, Mesh};

/// Part of a facet that is no distance.
const NEAR: f64 = 1e-6;

/// Cosine of the angle between facets that face each other is beyond this.
const FACES: f64 = -0.9;

impl<const D: usize> Mesh<D> {
    /// Facets of the boundary that lie on each other and face each other, each pair once: the middle of one of them, nearer
    /// than 1e-6 of it, on the other.
    pub fn seams(&self) -> Vec<[Facet; 2]> {
        let boundary = self.boundary_facets();
        let face = |&f: &Facet| self.plain_face(f, self.nodes());
        let faces: Vec<Face<D>> = boundary.iter().map(face).collect();
        let around = |face: &Face<D>| face::hull(face.x.iter().copied(), NEAR * face.size());
        let tree = Tree::new(faces.iter().map(around).collect());
        let mut seams = Vec::new();
        for (k, face) in faces.iter().enumerate() {
            let x = face.at(face.middle());
            for other in tree.within(&(x, x)).into_iter().filter(|&o| o != k) {
                let opposite = &faces[other];
                if dot(&face.facing, &opposite.facing) < FACES
                    && distance(&x, opposite) <= NEAR * face.size()
                {
                    seams.push([boundary[k.min(other)], boundary[k.max(other)]]);
                }
            }
        }
        seams.sort_unstable();
        seams.dedup();
        seams
    }
}
