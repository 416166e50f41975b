//! What can be wrong with a mesh, as facts with numbers; not a place where anything is decided.

use crate::CellKind;
use std::fmt;

/// What a named group holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GroupKind {
    /// Cells, by index.
    Cells,
    /// Facets, as pairs of a cell and one of its sides.
    Facets,
    /// Nodes, by index.
    Nodes,
}

impl fmt::Display for GroupKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            GroupKind::Cells => "cells",
            GroupKind::Facets => "facets",
            GroupKind::Nodes => "nodes",
        })
    }
}

/// Why a mesh, a group or a hypothesis cannot be built or found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The list of cells is empty.
    #[error("the mesh has no cell: at least one is needed")]
    NoCells,

    /// A coordinate is NaN or infinite.
    #[error("node {node} is at {coordinates:?}: every coordinate must be finite")]
    NotFinite {
        /// Index of the node.
        node: usize,
        /// Its coordinates \[mm\].
        coordinates: Vec<f64>,
    },

    /// A node carries no cell; its displacement would be undetermined.
    #[error("node {node} belongs to no cell: every node must belong to one")]
    UnusedNode {
        /// Index of the node.
        node: usize,
    },

    /// A cell of another dimension than the mesh.
    #[error(
        "cell {cell} is a {kind}, of dimension {}: the mesh has dimension {dimension}",
        kind.dimension()
    )]
    WrongDimension {
        /// Index of the cell.
        cell: usize,
        /// Its kind.
        kind: CellKind,
        /// Dimension of the mesh.
        dimension: usize,
    },

    /// A cell with too few or too many nodes.
    #[error("cell {cell} has {found} nodes: a {kind} has {}", kind.nodes())]
    WrongNodeCount {
        /// Index of the cell.
        cell: usize,
        /// Its kind.
        kind: CellKind,
        /// Number of nodes given.
        found: usize,
    },

    /// A cell refers to a node that does not exist.
    #[error("cell {cell} refers to node {node}: the mesh has {count} nodes, counted from 0")]
    NodeOutOfRange {
        /// Index of the cell.
        cell: usize,
        /// The index it refers to.
        node: usize,
        /// Number of nodes of the mesh.
        count: usize,
    },

    /// A cell refers to a node twice.
    #[error("cell {cell} refers to node {node} twice: the nodes of a cell must differ")]
    RepeatedNode {
        /// Index of the cell.
        cell: usize,
        /// The repeated node.
        node: usize,
    },

    /// The map from the reference cell reverses orientation somewhere in the cell.
    #[error(
        "cell {cell} is inverted at {point:?}: its Jacobian determinant is {det:e} there and must \
         be positive (is the cell numbered the wrong way round, or too distorted?)"
    )]
    InvertedCell {
        /// Index of the cell.
        cell: usize,
        /// Where the determinant is least \[mm\].
        point: Vec<f64>,
        /// The determinant there \[mm^D\].
        det: f64,
    },

    /// The map from the reference cell is singular to rounding somewhere in the cell.
    #[error(
        "cell {cell}, of size {size:e}, is degenerate at {point:?}: its Jacobian determinant is \
         {det:e} there and must exceed 1e-12 of the size to the power of the dimension"
    )]
    DegenerateCell {
        /// Index of the cell.
        cell: usize,
        /// Where the determinant is least \[mm\].
        point: Vec<f64>,
        /// The determinant there \[mm^D\].
        det: f64,
        /// Diagonal of the box around the cell \[mm\].
        size: f64,
    },

    /// A group of that name exists already.
    #[error("the group \"{name}\" exists already: the names of groups must differ")]
    DuplicateGroup {
        /// Name of the group.
        name: String,
    },

    /// A group whose name no file could have.
    #[error("the name of a group is {name:?}: it must be one line, of one character at least")]
    GroupName {
        /// The name.
        name: String,
    },

    /// A group would hold nothing.
    #[error("the group \"{name}\" would be empty: it needs at least one of its {kind}")]
    EmptyGroup {
        /// Name of the group.
        name: String,
        /// What it should hold.
        kind: GroupKind,
    },

    /// A group refers to a cell or node that does not exist.
    #[error("the group \"{name}\" refers to index {index}: the mesh has {count} {kind}")]
    GroupOutOfRange {
        /// Name of the group.
        name: String,
        /// [`GroupKind::Cells`] or [`GroupKind::Nodes`].
        kind: GroupKind,
        /// The index it refers to.
        index: usize,
        /// Number of such items of the mesh.
        count: usize,
    },

    /// A group refers to a side that its cell does not have.
    #[error(
        "the group \"{name}\" refers to facet {facet} of cell {cell}: that cell, a {kind}, has {}",
        kind.facets().len()
    )]
    FacetOutOfRange {
        /// Name of the group.
        name: String,
        /// Index of the cell.
        cell: usize,
        /// The facet referred to.
        facet: usize,
        /// Kind of the cell.
        kind: CellKind,
    },

    /// No group of that name.
    #[error("no group \"{name}\": {}", suggestion(nearest.as_deref()))]
    UnknownGroup {
        /// The name asked for.
        name: String,
        /// The nearest name that would have been valid, if there is any.
        nearest: Option<String>,
    },

    /// A group of that name exists, but holds something else.
    #[error("the group \"{name}\" holds {found}: {expected} are needed here")]
    WrongGroup {
        /// Name of the group.
        name: String,
        /// What was asked for.
        expected: GroupKind,
        /// What it holds.
        found: GroupKind,
    },

    /// A thickness that is not a positive number.
    #[error("the thickness is {value} mm: it must be positive and finite")]
    Thickness {
        /// The value given \[mm\].
        value: f64,
    },

    /// A block with no cell along one axis.
    #[error("the block has {count} grid lines along {axis}: at least 2 are needed")]
    TooFewLines {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// Number of lines given.
        count: usize,
    },

    /// The lines of a block do not increase.
    #[error(
        "grid line {index} along {axis} is at {value}, after {previous}: the lines must increase"
    )]
    LinesNotIncreasing {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// Index of the offending line.
        index: usize,
        /// Where the line before it is \[mm\].
        previous: f64,
        /// Where it is \[mm\].
        value: f64,
    },
}

fn suggestion(nearest: Option<&str>) -> String {
    match nearest {
        Some(name) => format!("did you mean \"{name}\"?"),
        None => "the mesh has no group to use here".into(),
    }
}
