//! Bodies that lie on each other, or within each other, where neither a contact nor a tie joins them; not those that are joined.

use crate::driver::Driver;
use moreau_mesh::{Facet, Intrusion};
use std::collections::{BTreeMap, BTreeSet};

/// Depth that counts, in parts of the facet: the bow of a circle of eight facets.
const DEEP: f64 = 0.1;

/// Which sides of contacts and ties facets are on: the contact, and 0 for its surface, 1 for the one opposite.
type Sides = BTreeMap<Facet, BTreeSet<(usize, usize)>>;

impl<const D: usize> Driver<D> {
    /// Facets that lie on each other in the virgin state and that no cells share, each pair once, where neither a contact nor
    /// a tie is between them.
    pub fn unjoined_facets(&self) -> Vec<[Facet; 2]> {
        let mut sides: Sides = BTreeMap::new();
        for contact in 0..self.contacts.len() {
            for (side, facets) in self.sides_of(contact).into_iter().enumerate() {
                for &facet in facets {
                    sides.entry(facet).or_default().insert((contact, side));
                }
            }
        }
        let of = |facet: &Facet| sides.get(facet).into_iter().flatten();
        let faces = |f: &Facet, contact: usize, side: usize| {
            sides
                .get(f)
                .is_some_and(|s| s.contains(&(contact, 1 - side)))
        };
        let mut seams = self.mesh.seams();
        seams.retain(|[a, b]| !of(a).any(|&(contact, side)| faces(b, contact, side)));
        seams
    }

    /// Nodes of the surfaces of bodies, where they are now, that are deeper within another body than a tenth of a facet, and
    /// that neither a contact nor a tie joins to it.
    pub fn unjoined_nodes(&self) -> Vec<Intrusion> {
        let nodes = 0..self.mesh.nodes().len();
        let now: Vec<[f64; D]> = nodes.map(|a| self.position(a).into()).collect();
        self.unjoined_at(&now)
    }

    /// The same, but for those that were so in the virgin state.
    pub fn unjoined_since(&self) -> Vec<Intrusion> {
        let mut now = self.unjoined_nodes();
        if !now.is_empty() {
            let before = self.unjoined_at(self.mesh.nodes());
            now.retain(|i| before.iter().all(|b| b.node != i.node));
        }
        now
    }

    fn unjoined_at(&self, positions: &[[f64; D]]) -> Vec<Intrusion> {
        let bodies = self.mesh.bodies();
        if bodies.len() < 2 {
            return Vec::new();
        }
        let bodies = bodies.into_iter().enumerate();
        let body: BTreeMap<usize, usize> = bodies
            .flat_map(|(k, cells)| cells.into_iter().map(move |cell| (cell, k)))
            .collect();
        // A node on one side of a contact is joined to the bodies on the other.
        let mut joined = BTreeSet::new();
        for contact in 0..self.contacts.len() {
            let [own, other] = self.sides_of(contact);
            for (from, to) in [(own, other), (other, own)] {
                let to: BTreeSet<usize> = to.iter().map(|f| body[&f.cell]).collect();
                let nodes = from.iter().flat_map(|&f| self.mesh.facet_nodes(f));
                joined.extend(nodes.flat_map(|a| to.iter().map(move |&b| (a, b))));
            }
        }
        let is_joined = |node: usize, other: usize| joined.contains(&(node, other));
        let mut found = self.mesh.intrusions(positions, is_joined);
        found.retain(|i| i.depth > DEEP * i.facet);
        found
    }

    /// The facets on both sides of a contact or tie between bodies; none, if it is with a tool.
    fn sides_of(&self, contact: usize) -> [&[Facet]; 2] {
        let opposite = self.contact_name(contact).1;
        match self.tools.iter().any(|tool| tool.name == opposite) {
            true => [&[], &[]],
            false => self.surfaces(contact).into(),
        }
    }
}
