//! What a file says and its mesh does not have: no error, but perhaps not what was meant.

use std::fmt;

/// A part of a mesh file that is not in the mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Loss {
    /// Elements of the dimension of the mesh that are in no physical group, while others are.
    Ungrouped {
        /// How many.
        elements: usize,
        /// Number of the first of them.
        first: u64,
    },
    /// A group of which nothing is left.
    Group {
        /// Its name.
        name: String,
        /// Why.
        reason: &'static str,
    },
    /// Nodes of a group that belong to no cell.
    Nodes {
        /// The group.
        name: String,
        /// Nodes lost.
        lost: usize,
        /// Nodes that it has in the file.
        of: usize,
    },
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Ungrouped { elements, first } => write!(
                f,
                "{elements} elements, of which {first} is the first, are in no physical group and \
                 are left out, as others are in one"
            ),
            Self::Group { name, reason } => {
                write!(f, "the group {name:?} is left out: {reason}")
            }
            Self::Nodes { name, lost, of } => write!(
                f,
                "{lost} of the {of} nodes of the group {name:?} belong to no cell and are left out"
            ),
        }
    }
}
