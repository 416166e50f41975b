//! The types of elements of Abaqus and the numbers of their sides; not their formulations.

use crate::CellKind;

/// The types that are read in some dimension.
pub(super) const fn supported(dimension: usize) -> &'static str {
    match dimension {
        2 => "CPE3, CPE4, CPE6, CPE8, or CAX or CPS instead of CPE,",
        _ => "C3D4, C3D8, C3D10 or C3D20,",
    }
}

/// The kind of cell of an element type, whatever its integration and formulation: the letters R,
/// H, I and M after the number.
pub(super) fn kind(name: &str) -> Option<CellKind> {
    let upper = name.to_uppercase();
    let base = upper.trim_end_matches(['R', 'H', 'I', 'M']);
    match base {
        "C3D4" => Some(CellKind::Tet4),
        "C3D8" => Some(CellKind::Hex8),
        "C3D10" => Some(CellKind::Tet10),
        "C3D20" => Some(CellKind::Hex20),
        _ => {
            let family = ["CPE", "CAX", "CPS"];
            let nodes = family.iter().find_map(|family| base.strip_prefix(family))?;
            match nodes {
                "3" => Some(CellKind::Tri3),
                "4" => Some(CellKind::Quad4),
                "6" => Some(CellKind::Tri6),
                "8" => Some(CellKind::Quad8),
                _ => None,
            }
        }
    }
}

/// Where each node of the kind stands in an element of the file: the edges of solids come in another
/// order there. A hexahedron has those below, above and upright, a tetrahedron 1-4, 2-4 and 3-4 last.
pub(super) const fn places(kind: CellKind) -> Option<&'static [usize]> {
    match kind {
        CellKind::Tet10 => Some(&[0, 1, 2, 3, 4, 5, 6, 7, 9, 8]),
        CellKind::Hex20 => Some(&[
            0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14,
        ]),
        _ => None,
    }
}

/// The index in [`CellKind::facets`] of each side S1, S2, ….
///
/// Plane sides run from node 1 as here. A tetrahedron has S1 = 1-2-3, S2 = 1-4-2, S3 = 2-4-3,
/// S4 = 3-4-1; a hexahedron S1 = 1-2-3-4, S2 = 5-8-7-6, S3 = 1-5-6-2, S4 = 2-6-7-3, S5 = 3-7-8-4,
/// S6 = 4-8-5-1.
const fn sides(kind: CellKind) -> &'static [usize] {
    match kind {
        CellKind::Tri3 | CellKind::Tri6 => &[0, 1, 2],
        CellKind::Quad4 | CellKind::Quad8 | CellKind::Quad9 => &[0, 1, 2, 3],
        CellKind::Tet4 | CellKind::Tet10 => &[0, 1, 3, 2],
        CellKind::Hex8 | CellKind::Hex20 | CellKind::Hex27 => &[0, 5, 1, 2, 3, 4],
    }
}

/// The facet of a side `"S1"`, `"S2"`, ….
pub(super) fn facet(kind: CellKind, side: &str) -> Option<usize> {
    let number: usize = side.strip_prefix(['S', 's'])?.parse().ok()?;
    sides(kind).get(number.checked_sub(1)?).copied()
}
