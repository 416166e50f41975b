//! What can be wrong with a mesh file, as facts with numbers and places; not a place where
//! anything is decided.

use crate::{CellKind, GroupKind, MeshError};
use std::fmt;

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Line of a text, counted from 1.
    Line(usize),
    /// Offset in a binary file, counted from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
        }
    }
}

/// Why a mesh file cannot be read.
///
/// Nodes and elements are named by their numbers in the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file ends too early.
    #[error("{place}: the file ends where {expected} is expected")]
    Truncated {
        /// Where it ends.
        place: Place,
        /// What should follow.
        expected: String,
    },

    /// Something else than what the format asks for.
    #[error("{place}: found {found:?} where {expected} is expected")]
    Unexpected {
        /// Where it stands.
        place: Place,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },

    /// A count that the rest of the file cannot hold.
    #[error("{place}: {count} {what} are announced, but only {remaining} bytes follow")]
    TooMany {
        /// Where the count ends.
        place: Place,
        /// What is counted.
        what: &'static str,
        /// The count.
        count: u64,
        /// Number of bytes from there to the end of the file.
        remaining: usize,
    },

    /// A version of the format that is not read.
    #[error("{place}: MSH version {found} is not read: save the mesh as MSH 2.2 or 4.1")]
    Version {
        /// Where it stands.
        place: Place,
        /// The version.
        found: String,
    },

    /// A kind of element that is not read.
    #[error("{place}: the element type {element} is not read here: use {supported}")]
    UnsupportedElement {
        /// Where it stands.
        place: Place,
        /// Name and number of the type.
        element: String,
        /// The types that are read.
        supported: &'static str,
    },

    /// Something that would change the mesh and is not read.
    #[error("{place}: {what} is not read: {remedy}")]
    Unsupported {
        /// Where it stands.
        place: Place,
        /// What it is.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },

    /// Two nodes of one number.
    #[error("there are two nodes {node}: the numbers of nodes must differ")]
    DuplicateNode {
        /// Number of the node.
        node: u64,
    },

    /// Two elements of one number.
    #[error("there are two elements {element}: the numbers of elements must differ")]
    DuplicateElement {
        /// Number of the element.
        element: u64,
    },

    /// An element refers to a node that does not exist.
    #[error("element {element} refers to node {node}, which the file does not have")]
    UnknownNode {
        /// Number of the element.
        element: u64,
        /// Number of the node.
        node: u64,
    },

    /// What is no STL file.
    #[error("this is no STL file: {reason}")]
    Stl {
        /// Where it is not.
        reason: String,
    },

    /// A surface without triangles.
    #[error("there are no triangles")]
    NoTriangles,

    /// A physical group of surfaces that no element is in.
    #[error(
        "no surface is in the physical group {group:?}: {}",
        suggestion(nearest)
    )]
    NoGroup {
        /// The name.
        group: String,
        /// The nearest name of a group of surfaces.
        nearest: Option<String>,
    },

    /// An element of a higher dimension than the mesh to be read.
    #[error("element {element} is of dimension {found}: the mesh is read in dimension {expected}")]
    Dimension {
        /// Number of the element.
        element: u64,
        /// Its dimension.
        found: usize,
        /// Dimension of the mesh.
        expected: usize,
    },

    /// No cell of the dimension of the mesh.
    #[error("none of the {elements} elements of the file is a cell of dimension {dimension}")]
    NoCells {
        /// Dimension of the mesh.
        dimension: usize,
        /// Number of elements of any dimension.
        elements: usize,
    },

    /// A plane mesh does not lie in a plane z = constant.
    #[error("node {node} is at z = {z:?} mm, others at z = {plane:?} mm: a plane mesh has one z")]
    NotPlanar {
        /// Number of the node.
        node: u64,
        /// Where it is \[mm\].
        z: f64,
        /// Where the first node is \[mm\].
        plane: f64,
    },

    /// An element of a named surface is no side of a cell that is read.
    #[error(
        "element {element} of \"{group}\", with the nodes {nodes:?}, is no side of any cell; one that lies beside the cells is to be left out of the group"
    )]
    FacetWithoutCell {
        /// Name of the group.
        group: String,
        /// Number of the element.
        element: u64,
        /// Numbers of its nodes.
        nodes: Vec<u64>,
    },

    /// A list refers to a set that does not exist at that place.
    #[error(
        "{place}: no set of {kind} \"{name}\" is defined before: {}",
        suggestion(nearest)
    )]
    UnknownSet {
        /// Where it is referred to.
        place: Place,
        /// [`GroupKind::Cells`] or [`GroupKind::Nodes`].
        kind: GroupKind,
        /// The name.
        name: String,
        /// The nearest name, if there is any.
        nearest: Option<String>,
    },

    /// A list refers to a node or an element that does not exist.
    #[error("{place}: number {number} is none of the {kind} of the file")]
    UnknownMember {
        /// Where it is referred to.
        place: Place,
        /// [`GroupKind::Cells`] or [`GroupKind::Nodes`].
        kind: GroupKind,
        /// The number.
        number: u64,
    },

    /// A surface refers to a side that its element does not have.
    #[error(
        "{place}: element {element}, a {kind}, has no side {side:?}: it has S1 to S{}",
        kind.facets().len()
    )]
    NoSuchSide {
        /// Where it is referred to.
        place: Place,
        /// Number of the element.
        element: u64,
        /// Its kind.
        kind: CellKind,
        /// The side.
        side: String,
    },

    /// The cells do not make a valid mesh.
    #[error("{}the mesh is not valid: {source}", culprit(*element))]
    Mesh {
        /// Number in the file of the cell that the source names, if it names one.
        element: Option<u64>,
        /// What is wrong, in the numbers of the mesh: nodes and cells are counted from 0.
        source: MeshError,
    },
}

fn suggestion(nearest: &Option<String>) -> String {
    match nearest {
        Some(name) => format!("did you mean \"{name}\"?"),
        None => "there is none so far".into(),
    }
}

fn culprit(element: Option<u64>) -> String {
    element.map_or_else(String::new, |element| format!("element {element}: "))
}
