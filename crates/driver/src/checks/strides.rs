//! Tools whose place of contact moves over a surface by more than its facets are long within an increment: contact acts at
//! the ends of increments alone; not tools that pass through a body on the way.

use crate::driver::Driver;
use crate::model::points::turned;
use moreau_mesh::Facet;
use nalgebra::SVector;
use std::collections::BTreeMap;

/// How far a tool has gone over a surface in an increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stride<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The node that bears it.
    pub node: usize,
    /// Where that is now \[mm\].
    pub position: [f64; D],
    /// How far the tool has gone along the surface there in the last increment \[mm\].
    pub way: f64,
    /// Length of the facets around the node along that way \[mm\].
    pub facet: f64,
}

/// Gap at the start of the increment with which a node touched then, in parts of a facet.
const TOUCHES: f64 = 1e-2;

/// Angle between the normals of a tool at both ends of the way, over the way in facets, from which on it is no plane \[rad\]: of
/// a round one with a radius of 1000 facets.
const CURVED: f64 = 1e-3;

impl<const D: usize> Driver<D> {
    /// Where a tool that bears has gone farthest over a surface within the last increment, in parts of the facets there, if that
    /// is more than one of them. Where it is plane on the way its place of contact does not move with it.
    pub fn strides(&self) -> Option<Stride<D>> {
        let (d_u, _) = self.state.last.as_ref()?;
        let count = (self.points.iter()).fold(0, |most, p| most.max(p.contact + 1));
        let all = (0..count).filter_map(|contact| self.longest_stride(contact, d_u));
        let all = all.filter(|stride| stride.way > stride.facet);
        all.max_by(|a, b| (a.way / a.facet).total_cmp(&(b.way / b.facet)))
    }

    fn longest_stride(&self, contact: usize, d_u: &[f64]) -> Option<Stride<D>> {
        let rounding = self.settings.tolerance * self.state.largest_force;
        let mut around: BTreeMap<usize, Vec<Facet>> = BTreeMap::new();
        for &facet in self.surfaces(contact).0 {
            for a in self.mesh.facet_nodes(facet) {
                around.entry(a).or_default().push(facet);
            }
        }
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let (mut touched, mut longest) = (false, None::<Stride<D>>);
        for (i, (p, record)) in self.points.iter().zip(&self.state.contacts).enumerate() {
            let Some(tool) = p
                .tool
                .filter(|_| p.contact == contact && record.t[0] > rounding)
            else {
                continue;
            };
            let row = &self.footing.rows[i];
            let obstacle = self.tools[tool].opposite(p);
            // The tool as it is turned now: a roll that turns in its place is where it was.
            let way = turned(row.relative(moved), &-self.state.loading.turn_of(tool));
            let now = self.seen(p, row);
            let (before, n) = (now - way, obstacle.normal(&now));
            let along = way - n * n.dot(&way);
            let along_surface = turned(along, &self.state.loading.turn_of(tool));
            let facet = around
                .get(&p.node)
                .map_or(0.0, |around| self.longest_along(around, &along_surface));
            touched |= obstacle.distance(&before) - p.offset < TOUCHES * facet;
            let bent = obstacle.normal(&before).angle(&n);
            let parts = along.norm() / facet;
            let farther = longest.is_none_or(|l| parts > l.way / l.facet);
            if facet > 0.0 && farther && bent > CURVED * parts {
                longest = Some(Stride {
                    contact,
                    node: p.node,
                    position: self.position(p.node).into(),
                    way: along.norm(),
                    facet,
                });
            }
        }
        // What comes to a surface has gone over none of it.
        longest.filter(|_| touched)
    }

    /// Length of the longest of some facets along a way \[mm\].
    fn longest_along(&self, facets: &[Facet], way: &SVector<f64, D>) -> f64 {
        let Some(way) = way.try_normalize(0.0) else {
            return 0.0;
        };
        let length = |&facet: &Facet| {
            let places = self
                .mesh
                .facet_nodes(facet)
                .map(|a| self.position(a).dot(&way));
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| {
                (l.min(x), h.max(x))
            });
            high - low
        };
        facets.iter().map(length).fold(0.0, f64::max)
    }
}
