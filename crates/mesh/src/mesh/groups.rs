//! Named groups of cells, facets and nodes of a mesh; not the conditions put on them.

use super::{Facet, Mesh};
use crate::nearest::nearest;
use crate::{GroupKind, MeshError};

/// Members of a group: sorted, without repetition, not empty.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Group {
    Cells(Vec<usize>),
    Facets(Vec<Facet>),
    Nodes(Vec<usize>),
}

impl Group {
    fn kind(&self) -> GroupKind {
        match self {
            Group::Cells(_) => GroupKind::Cells,
            Group::Facets(_) => GroupKind::Facets,
            Group::Nodes(_) => GroupKind::Nodes,
        }
    }

    fn is_empty(&self) -> bool {
        match self {
            Group::Cells(items) | Group::Nodes(items) => items.is_empty(),
            Group::Facets(items) => items.is_empty(),
        }
    }

    /// The group after `nodes` nodes and `cells` cells have been put before those of its mesh.
    pub(super) fn shifted(mut self, nodes: usize, cells: usize) -> Self {
        match &mut self {
            Group::Cells(items) => items.iter_mut().for_each(|cell| *cell += cells),
            Group::Facets(items) => items.iter_mut().for_each(|facet| facet.cell += cells),
            Group::Nodes(items) => items.iter_mut().for_each(|node| *node += nodes),
        }
        self
    }
}

impl<const D: usize> Mesh<D> {
    /// Names a set of cells.
    ///
    /// # Errors
    ///
    /// [`MeshError::GroupName`], [`MeshError::DuplicateGroup`] (cells, facets and nodes share one set of names),
    /// [`MeshError::EmptyGroup`], [`MeshError::GroupOutOfRange`].
    pub fn add_cell_group(&mut self, name: &str, cells: Vec<usize>) -> Result<(), MeshError> {
        self.check_range(name, GroupKind::Cells, &cells, self.cell_count())?;
        self.insert_group(name, Group::Cells(sorted(cells)))
    }

    /// Names a set of facets.
    ///
    /// # Errors
    ///
    /// [`MeshError::GroupName`], [`MeshError::DuplicateGroup`], [`MeshError::EmptyGroup`], [`MeshError::GroupOutOfRange`] for
    /// the cell and [`MeshError::FacetOutOfRange`] for its side.
    pub fn add_facet_group(&mut self, name: &str, facets: Vec<Facet>) -> Result<(), MeshError> {
        for &Facet { cell, facet } in &facets {
            self.check_range(name, GroupKind::Cells, &[cell], self.cell_count())?;
            let kind = self.kind(cell);
            if facet >= kind.facets().len() {
                return Err(MeshError::FacetOutOfRange {
                    name: name.into(),
                    cell,
                    facet,
                    kind,
                });
            }
        }
        self.insert_group(name, Group::Facets(sorted(facets)))
    }

    /// Names a set of nodes.
    ///
    /// # Errors
    ///
    /// [`MeshError::GroupName`], [`MeshError::DuplicateGroup`], [`MeshError::EmptyGroup`], [`MeshError::GroupOutOfRange`].
    pub fn add_node_group(&mut self, name: &str, nodes: Vec<usize>) -> Result<(), MeshError> {
        self.check_range(name, GroupKind::Nodes, &nodes, self.nodes.len())?;
        self.insert_group(name, Group::Nodes(sorted(nodes)))
    }

    /// Cells of a cell group, sorted.
    ///
    /// # Errors
    ///
    /// [`MeshError::UnknownGroup`] with the nearest name, [`MeshError::WrongGroup`].
    pub fn cell_group(&self, name: &str) -> Result<&[usize], MeshError> {
        match self.group(name, Some(GroupKind::Cells))? {
            Group::Cells(cells) => Ok(cells),
            other => Err(wrong_group(name, GroupKind::Cells, other)),
        }
    }

    /// Facets of a facet group, sorted.
    ///
    /// # Errors
    ///
    /// [`MeshError::UnknownGroup`] with the nearest name, [`MeshError::WrongGroup`].
    pub fn facet_group(&self, name: &str) -> Result<&[Facet], MeshError> {
        match self.group(name, Some(GroupKind::Facets))? {
            Group::Facets(facets) => Ok(facets),
            other => Err(wrong_group(name, GroupKind::Facets, other)),
        }
    }

    /// Nodes of a group, whether of nodes, facets or cells; sorted, without repetition.
    ///
    /// # Errors
    ///
    /// [`MeshError::UnknownGroup`] with the nearest name.
    pub fn node_group(&self, name: &str) -> Result<Vec<usize>, MeshError> {
        Ok(match self.group(name, None)? {
            Group::Nodes(nodes) => nodes.clone(),
            Group::Facets(facets) => sorted(
                facets
                    .iter()
                    .flat_map(|&facet| self.facet_nodes(facet))
                    .collect(),
            ),
            Group::Cells(cells) => sorted(
                cells
                    .iter()
                    .flat_map(|&cell| self.cell_nodes(cell))
                    .copied()
                    .collect(),
            ),
        })
    }

    /// Names of all groups, in alphabetical order.
    pub fn group_names(&self) -> impl Iterator<Item = &str> {
        self.groups.keys().map(String::as_str)
    }

    /// Names the nodes of the group `on`, of whatever kind, whose position \[mm\] satisfies `keep`.
    ///
    /// # Errors
    ///
    /// Those of [`Mesh::node_group`] and [`Mesh::add_node_group`].
    pub fn node_group_where(
        &mut self,
        name: &str,
        on: &str,
        keep: impl Fn(&[f64; D]) -> bool,
    ) -> Result<(), MeshError> {
        let mut nodes = self.node_group(on)?;
        nodes.retain(|&node| keep(&self.nodes[node]));
        self.add_node_group(name, nodes)
    }

    /// Names the facets of the facet group `on` all of whose nodes satisfy `keep` by their
    /// position \[mm\].
    ///
    /// # Errors
    ///
    /// Those of [`Mesh::facet_group`] and [`Mesh::add_facet_group`].
    pub fn facet_group_where(
        &mut self,
        name: &str,
        on: &str,
        keep: impl Fn(&[f64; D]) -> bool,
    ) -> Result<(), MeshError> {
        let mut facets = self.facet_group(on)?.to_vec();
        facets.retain(|&facet| self.facet_nodes(facet).all(|node| keep(&self.nodes[node])));
        self.add_facet_group(name, facets)
    }

    pub(super) fn insert_group(&mut self, name: &str, group: Group) -> Result<(), MeshError> {
        let owned = || name.to_owned();
        if group.is_empty() {
            return Err(MeshError::EmptyGroup {
                name: owned(),
                kind: group.kind(),
            });
        }
        if name.is_empty() || name.contains(['\n', '\r']) {
            return Err(MeshError::GroupName { name: owned() });
        }
        if self.groups.contains_key(name) {
            return Err(MeshError::DuplicateGroup { name: owned() });
        }
        self.groups.insert(owned(), group);
        Ok(())
    }

    /// The group of that name; if there is none, the nearest of the wanted kind is suggested.
    fn group(&self, name: &str, wanted: Option<GroupKind>) -> Result<&Group, MeshError> {
        self.groups.get(name).ok_or_else(|| {
            let valid = |group: &Group| wanted.is_none_or(|kind| group.kind() == kind);
            let names = self
                .groups
                .iter()
                .filter(|(_, group)| valid(group))
                .map(|(name, _)| &**name);
            MeshError::UnknownGroup {
                name: name.into(),
                nearest: nearest(name, names).map(Into::into),
            }
        })
    }

    fn check_range(
        &self,
        name: &str,
        kind: GroupKind,
        indices: &[usize],
        count: usize,
    ) -> Result<(), MeshError> {
        match indices.iter().find(|&&index| index >= count) {
            Some(&index) => Err(MeshError::GroupOutOfRange {
                name: name.into(),
                kind,
                index,
                count,
            }),
            None => Ok(()),
        }
    }
}

fn wrong_group(name: &str, expected: GroupKind, group: &Group) -> MeshError {
    MeshError::WrongGroup {
        name: name.into(),
        expected,
        found: group.kind(),
    }
}

fn sorted<T: Ord>(mut items: Vec<T>) -> Vec<T> {
    items.sort_unstable();
    items.dedup();
    items
}
