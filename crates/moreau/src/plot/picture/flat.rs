//! What is drawn of a body, on paper: places, faces, lines and marks; not how.

use super::Field;
use super::layers::Polygon;
use super::mark::Mark;
use crate::mesh::CellKind;

/// A face that is seen: a cell of the plane, or a facet of a solid, with its nodes as a plane cell of its kind has them.
pub(super) struct Face {
    pub(super) kind: CellKind,
    pub(super) nodes: Vec<usize>,
}

/// A picture on paper. Places are x to the right and y upwards \[mm\], and how near they are to the eye.
pub(super) struct Flat<'a> {
    pub(super) title: &'a str,
    pub(super) unit: &'a str,
    /// How many times displacements are drawn, if they are.
    pub(super) magnification: Option<f64>,
    /// All nodes of the mesh, where they are drawn.
    pub(super) nodes: Vec<[f64; 3]>,
    /// The same without displacement, if the contour there is drawn as well.
    pub(super) still: Option<Vec<[f64; 3]>>,
    /// Those that face the eye.
    pub(super) faces: Vec<Face>,
    /// Whether faces may hide each other.
    pub(super) solid: bool,
    pub(super) field: Option<&'a Field>,
    pub(super) polylines: Vec<Vec<[f64; 2]>>,
    pub(super) veils: Vec<Polygon>,
    /// With how near they are.
    pub(super) marks: Vec<(Mark<2>, f64)>,
    pub(super) keys: &'a [(String, &'static str)],
    /// Directions of the axes, where they are not those of the paper.
    pub(super) axes: Option<[[f64; 2]; 3]>,
}
