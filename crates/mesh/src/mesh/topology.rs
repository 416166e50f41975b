//! Who is whose neighbour: boundary, bodies, and two meshes in one; not where they
//! are.

use super::{Facet, Mesh};
use crate::MeshError;
use crate::geometry::diagonal;

/// Nodes of a facet in increasing order: the same for the facets of both of its cells.
pub(crate) type FacetKey = [usize; 9];

/// `None` for more nodes than any facet has.
pub(crate) fn facet_key(nodes: impl IntoIterator<Item = usize>) -> Option<FacetKey> {
    let mut key = [usize::MAX; 9];
    for (i, node) in nodes.into_iter().enumerate() {
        *key.get_mut(i)? = node;
    }
    key.sort_unstable();
    Some(key)
}

impl<const D: usize> Mesh<D> {
    /// Facets that belong to one cell only, sorted; two facets are the same if they have the same
    /// nodes.
    pub fn boundary_facets(&self) -> Vec<Facet> {
        let facets = (0..self.cell_count()).flat_map(|cell| {
            (0..self.kind(cell).facets().len()).map(move |facet| Facet { cell, facet })
        });
        let mut keyed: Vec<(FacetKey, Facet)> = facets
            .filter_map(|facet| Some((facet_key(self.facet_nodes(facet))?, facet)))
            .collect();
        keyed.sort_unstable();
        let mut boundary: Vec<Facet> = keyed
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|same| same.len() == 1)
            .map(|same| same[0].1)
            .collect();
        boundary.sort_unstable();
        boundary
    }

    /// The bodies: sets of cells connected through shared nodes, each sorted, in the order of
    /// their first cells.
    pub fn bodies(&self) -> Vec<Vec<usize>> {
        // Union–find over the cells; the representative of a body is its first cell.
        let mut parent: Vec<usize> = (0..self.cell_count()).collect();
        let mut owner = vec![None; self.nodes.len()];
        for cell in 0..self.cell_count() {
            for &node in self.cell_nodes(cell) {
                let first = find(&mut parent, *owner[node].get_or_insert(cell));
                let this = find(&mut parent, cell);
                parent[first.max(this)] = first.min(this);
            }
        }
        let mut bodies: Vec<Vec<usize>> = Vec::new();
        let mut index = vec![0; self.cell_count()];
        for cell in 0..self.cell_count() {
            let root = find(&mut parent, cell);
            if root == cell {
                index[root] = bodies.len();
                bodies.push(Vec::new());
            }
            bodies[index[root]].push(cell);
        }
        bodies
    }

    /// Both meshes in one: the nodes and cells of `other` follow those of `self`, and no node is
    /// merged.
    ///
    /// # Errors
    ///
    /// [`MeshError::DuplicateGroup`] if both have a group of the same name.
    pub fn joined(mut self, other: Self) -> Result<Self, MeshError> {
        let (nodes, cells) = (self.nodes.len(), self.cell_count());
        let start = self.connectivity.len();
        for (name, group) in other.groups {
            self.insert_group(&name, group.shifted(nodes, cells))?;
        }
        self.nodes.extend(other.nodes);
        self.size = diagonal(&self.nodes);
        self.kinds.extend(other.kinds);
        self.offsets
            .extend(other.offsets[1..].iter().map(|offset| offset + start));
        self.connectivity
            .extend(other.connectivity.iter().map(|node| node + nodes));
        Ok(self)
    }
}

/// Representative of a set, halving the path to it.
fn find(parent: &mut [usize], mut item: usize) -> usize {
    while parent[item] != item {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    item
}
