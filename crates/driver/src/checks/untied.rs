//! Nodes of tied surfaces that no tie holds; not why.

use crate::driver::Driver;
use std::collections::BTreeSet;

impl<const D: usize> Driver<D> {
    /// Nodes of the surface of a tie that are free, because nothing is opposite to them; none of a contact.
    pub fn untied_nodes(&self, contact: usize) -> Vec<usize> {
        let points = self.points.iter().filter(|p| p.contact == contact);
        let rows = points.filter_map(|p| p.tied.as_ref());
        let held: BTreeSet<usize> = rows.flat_map(|row| &row.own).map(|(a, _)| *a).collect();
        let surface = self.mesh.node_group(self.contact_name(contact).0);
        let free = surface.into_iter().flatten().filter(|a| !held.contains(a));
        free.filter(|_| !held.is_empty()).collect()
    }
}
