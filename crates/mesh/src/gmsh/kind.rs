//! The types of elements of Gmsh and their numbers; not their geometry.

use crate::CellKind;

/// A type of element that is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Kind {
    /// Number in the file.
    pub(super) number: i32,
    pub(super) dimension: usize,
    pub(super) nodes: usize,
    /// `None` for points and lines, which are no cells in any dimension.
    pub(super) cell: Option<CellKind>,
}

const fn cell(number: i32, kind: CellKind) -> Kind {
    Kind {
        number,
        dimension: kind.dimension(),
        nodes: kind.nodes(),
        cell: Some(kind),
    }
}

const fn thin(number: i32, dimension: usize, nodes: usize) -> Kind {
    Kind {
        number,
        dimension,
        nodes,
        cell: None,
    }
}

/// The types that are read; nodes are numbered as in [`CellKind`].
const KINDS: [Kind; 13] = [
    thin(15, 0, 1),
    thin(1, 1, 2),
    thin(8, 1, 3),
    cell(2, CellKind::Tri3),
    cell(9, CellKind::Tri6),
    cell(3, CellKind::Quad4),
    cell(16, CellKind::Quad8),
    cell(10, CellKind::Quad9),
    cell(4, CellKind::Tet4),
    cell(11, CellKind::Tet10),
    cell(5, CellKind::Hex8),
    cell(17, CellKind::Hex20),
    cell(12, CellKind::Hex27),
];

/// The types that are read, in words.
pub(super) const SUPPORTED: &str = "points (15), lines of 2 (1) and 3 nodes (8), triangles of 3 (2) \
     and 6 nodes (9), quadrangles of 4 (3), 8 (16) and 9 nodes (10), tetrahedra of 4 (4) and 10 \
     nodes (11), hexahedra of 8 (5), 20 (17) and 27 nodes (12)";

/// The type of a number, if it is read.
pub(super) fn kind(number: i32) -> Option<Kind> {
    KINDS.into_iter().find(|kind| kind.number == number)
}

/// The number of the type of that dimension and number of nodes; 0, which Gmsh does not use, if
/// there is none.
pub(super) fn of_nodes(dimension: usize, nodes: usize) -> i32 {
    let same = |kind: &Kind| kind.dimension == dimension && kind.nodes == nodes;
    KINDS.into_iter().find(same).map_or(0, |kind| kind.number)
}

/// Name and number of a type that is not read.
pub(super) fn name(number: i32) -> String {
    let name = match number {
        6 => "prism of 6 nodes",
        7 => "pyramid of 5 nodes",
        13 => "prism of 18 nodes",
        14 => "pyramid of 14 nodes",
        18 => "prism of 15 nodes",
        19 => "pyramid of 13 nodes",
        20 | 22 | 24 => "incomplete triangle of high order",
        21 | 23 | 25 => "triangle of high order",
        26..=28 => "line of high order",
        29..=31 => "tetrahedron of high order",
        36..=38 => "quadrangle of high order",
        92 | 93 => "hexahedron of high order",
        _ => "unknown",
    };
    format!("{number} ({name})")
}
