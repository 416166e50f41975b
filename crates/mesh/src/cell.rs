//! Kinds of cells and facets, known at run time; the mathematics is in [`element`](crate::element).

use crate::nearest::edit_distance;
use crate::{
    Element, Hex8, Hex20, Hex27, Integration, Quad4, Quad8, Quad9, Tet4, Tet10, Tri3, Tri6,
};
use std::{fmt, slice, str};

/// Kind of a cell; each is the [`Element`] of the same name.
///
/// Displayed and parsed as the name in lower case, `"quad8"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CellKind {
    /// Linear triangle, [`Tri3`].
    Tri3,
    /// Quadratic triangle, [`Tri6`].
    Tri6,
    /// Bilinear quadrilateral, [`Quad4`].
    Quad4,
    /// Serendipity quadrilateral, [`Quad8`].
    Quad8,
    /// Biquadratic quadrilateral, [`Quad9`].
    Quad9,
    /// Linear tetrahedron, [`Tet4`].
    Tet4,
    /// Quadratic tetrahedron, [`Tet10`].
    Tet10,
    /// Trilinear hexahedron, [`Hex8`].
    Hex8,
    /// Serendipity hexahedron, [`Hex20`].
    Hex20,
    /// Triquadratic hexahedron, [`Hex27`].
    Hex27,
}

/// Kind of a facet, a side of a cell; each is the [`Element`] of the same name, of dimension D − 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FacetKind {
    /// Straight edge, [`Line2`](crate::Line2).
    Line2,
    /// Quadratic edge, [`Line3`](crate::Line3).
    Line3,
    /// Linear triangle, [`Tri3`].
    Tri3,
    /// Quadratic triangle, [`Tri6`].
    Tri6,
    /// Bilinear quadrilateral, [`Quad4`].
    Quad4,
    /// Serendipity quadrilateral, [`Quad8`].
    Quad8,
    /// Biquadratic quadrilateral, [`Quad9`].
    Quad9,
}

/// What an element type knows, as values.
struct Data {
    name: &'static str,
    dimension: usize,
    corners: usize,
    facet_kind: FacetKind,
    nodes: &'static [f64],
    facets: &'static [&'static [usize]],
}

const fn data<const D: usize, const N: usize, E: Element<D, N>>(
    name: &'static str,
    corners: usize,
    facet_kind: FacetKind,
) -> Data {
    let nodes = const { &E::NODES }.as_flattened();
    Data {
        name,
        dimension: D,
        corners,
        facet_kind,
        nodes,
        facets: E::FACETS,
    }
}

impl CellKind {
    /// Every kind, in order.
    pub const ALL: [Self; 10] = [
        Self::Tri3,
        Self::Tri6,
        Self::Quad4,
        Self::Quad8,
        Self::Quad9,
        Self::Tet4,
        Self::Tet10,
        Self::Hex8,
        Self::Hex20,
        Self::Hex27,
    ];

    const fn data(self) -> Data {
        match self {
            Self::Tri3 => data::<2, 3, Tri3>("tri3", 3, FacetKind::Line2),
            Self::Tri6 => data::<2, 6, Tri6>("tri6", 3, FacetKind::Line3),
            Self::Quad4 => data::<2, 4, Quad4>("quad4", 4, FacetKind::Line2),
            Self::Quad8 => data::<2, 8, Quad8>("quad8", 4, FacetKind::Line3),
            Self::Quad9 => data::<2, 9, Quad9>("quad9", 4, FacetKind::Line3),
            Self::Tet4 => data::<3, 4, Tet4>("tet4", 4, FacetKind::Tri3),
            Self::Tet10 => data::<3, 10, Tet10>("tet10", 4, FacetKind::Tri6),
            Self::Hex8 => data::<3, 8, Hex8>("hex8", 8, FacetKind::Quad4),
            Self::Hex20 => data::<3, 20, Hex20>("hex20", 8, FacetKind::Quad8),
            Self::Hex27 => data::<3, 27, Hex27>("hex27", 8, FacetKind::Quad9),
        }
    }

    /// Name in lower case.
    pub const fn name(self) -> &'static str {
        self.data().name
    }

    /// Dimension D of the cell, 2 or 3.
    pub const fn dimension(self) -> usize {
        self.data().dimension
    }

    /// Number of nodes.
    pub const fn nodes(self) -> usize {
        self.data().nodes.len() / self.dimension()
    }

    /// Number of corners; they come first among the nodes.
    pub const fn corner_count(self) -> usize {
        self.data().corners
    }

    /// Nodes of the facets, oriented outwards, corners first: [`Element::FACETS`].
    pub const fn facets(self) -> &'static [&'static [usize]] {
        self.data().facets
    }

    /// Kind of the facets.
    pub const fn facet_kind(self) -> FacetKind {
        self.data().facet_kind
    }

    /// The rule to take where none is asked for: the one that locks least in plastic flow without
    /// modes that pass from cell to cell. Those of biquadratic and triquadratic cells under the
    /// reduced rule do.
    ///
    /// Linear triangles and tetrahedra have none that does not lock: see [`CellKind::locks`].
    pub const fn integration(self) -> Integration {
        match self {
            Self::Tri3 | Self::Tet4 | Self::Quad9 | Self::Hex27 => Integration::Full,
            Self::Quad4 | Self::Hex8 => Integration::BBar,
            Self::Tri6 | Self::Quad8 | Self::Tet10 | Self::Hex20 => Integration::Reduced,
        }
    }

    /// The same under plane stress, where no flow keeps an area and no cell locks: there is nothing to average, and
    /// triangles and quadrilaterals of few nodes have the full rule.
    pub const fn integration_in_plane_stress(self) -> Integration {
        match self.integration() {
            Integration::BBar => Integration::Full,
            rule => rule,
        }
    }

    /// Whether cells of this kind and rule cannot flow at constant volume: their limit loads are
    /// too high by far, or there are none.
    pub const fn locks(self, integration: Integration) -> bool {
        match self {
            Self::Tri3 | Self::Tet4 => true,
            Self::Quad4 | Self::Hex8 => matches!(integration, Integration::Full),
            _ => false,
        }
    }

    /// Whether meshes of this kind and rule have deformations without strain at any point: hourglasses, which nothing but
    /// what they are held by resists.
    pub const fn hourglasses(self, integration: Integration) -> bool {
        let kind = matches!(self, Self::Quad4 | Self::Quad9 | Self::Hex8 | Self::Hex27);
        kind && matches!(integration, Integration::Reduced)
    }

    /// Whether flat cells of this kind and rule are too soft across their longer sides: where corners move by 2 and the nodes
    /// between them by −1 the points of the rule see no strain but a shear in parts of thickness over side, from cell to cell.
    pub const fn soft_if_flat(self, integration: Integration) -> bool {
        matches!(self, Self::Quad8 | Self::Hex20) && matches!(integration, Integration::Reduced)
    }

    /// Whether cells of this kind and rule are too stiff where plastic flow dilates: with its shear the dilatation that a flow
    /// asks for varies within a cell, which has the mean alone.
    pub const fn stiff_if_dilating(self, integration: Integration) -> bool {
        matches!(self, Self::Quad4 | Self::Hex8) && matches!(integration, Integration::BBar)
    }

    /// Values at a node of the shape functions of the linear cell with the same corners \[–\]: what a
    /// linear field has there of every corner.
    pub fn corner_shape(self, node: usize) -> Vec<f64> {
        let xi = &self.data().nodes[node * self.dimension()..][..self.dimension()];
        match self {
            Self::Tri3 | Self::Tri6 => shape::<2, 3, Tri3>(xi),
            Self::Quad4 | Self::Quad8 | Self::Quad9 => shape::<2, 4, Quad4>(xi),
            Self::Tet4 | Self::Tet10 => shape::<3, 4, Tet4>(xi),
            Self::Hex8 | Self::Hex20 | Self::Hex27 => shape::<3, 8, Hex8>(xi),
        }
    }

    /// Reference coordinates of the nodes, D each: [`Element::NODES`].
    pub fn reference_nodes(self) -> slice::ChunksExact<'static, f64> {
        self.data().nodes.chunks_exact(self.dimension())
    }
}

/// Shape functions of an element at a point given by a slice.
fn shape<const D: usize, const N: usize, E: Element<D, N>>(xi: &[f64]) -> Vec<f64> {
    E::shape(std::array::from_fn(|i| xi[i])).to_vec()
}

impl FacetKind {
    /// Number of nodes.
    pub const fn nodes(self) -> usize {
        match self {
            Self::Line2 => 2,
            Self::Line3 | Self::Tri3 => 3,
            Self::Quad4 => 4,
            Self::Tri6 => 6,
            Self::Quad8 => 8,
            Self::Quad9 => 9,
        }
    }

    /// Number of corners; they come first among the nodes.
    pub const fn corner_count(self) -> usize {
        match self {
            Self::Line2 | Self::Line3 => 2,
            Self::Tri3 | Self::Tri6 => 3,
            Self::Quad4 | Self::Quad8 | Self::Quad9 => 4,
        }
    }
}

impl fmt::Display for CellKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// No kind of cell of that name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no kind of cell \"{name}\": did you mean \"{nearest}\"?")]
pub struct UnknownKind {
    /// The name given.
    pub name: String,
    /// The nearest kind.
    pub nearest: CellKind,
}

impl str::FromStr for CellKind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        let mut kinds = Self::ALL;
        kinds.sort_by_key(|kind| edit_distance(name, kind.name()));
        if kinds[0].name() == name {
            Ok(kinds[0])
        } else {
            Err(UnknownKind {
                name: name.into(),
                nearest: kinds[0],
            })
        }
    }
}
