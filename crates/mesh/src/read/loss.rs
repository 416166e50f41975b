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
    /// Sections of a file that say more than a mesh: materials, steps, conditions.
    Sections {
        /// What they are about.
        about: &'static str,
        /// Keywords, in alphabetical order, and how often each stands there.
        keywords: Vec<(String, usize)>,
        /// Line of the first of them.
        line: usize,
    },
    /// Cells of plane stress: the mesh has their shape, not their hypothesis.
    PlaneStress {
        /// Their type.
        element: String,
        /// How many.
        elements: usize,
        /// Line of the first section with them.
        line: usize,
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
            Self::Sections {
                about,
                keywords,
                line,
            } => {
                let counted = |(keyword, count): &(String, usize)| match count {
                    1 => format!("*{keyword}"),
                    _ => format!("{count} *{keyword}"),
                };
                let list: Vec<String> = keywords.iter().map(counted).collect();
                write!(
                    f,
                    "{about} are not read, from line {line} on: {}",
                    list.join(", ")
                )
            }
            Self::PlaneStress {
                element,
                elements,
                line,
            } => write!(
                f,
                "{elements} elements of type {element}, from line {line} on, are meant for plane stress, \
                 and taken as any cells of the plane: analysis = \"plane-stress\" is for the deck to say"
            ),
        }
    }
}
