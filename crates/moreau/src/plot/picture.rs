//! Pictures of meshes: cells of the plane, or what is seen of a solid, deformed or not, coloured by a field; not of their
//! history.

mod bands;
mod drawn;
mod flat;
mod layers;
mod mark;
mod marks;
mod sheet;
mod view;

use super::PlotError;
use crate::mesh::{CellKind, Facet, FacetKind, Mesh};
use flat::{Face, Flat};
pub use mark::Mark;
use nalgebra::Vector3;
use sheet::check_length;
pub use view::View;

/// A field on the nodes of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Label of the colour bar, with the unit.
    pub label: String,
    /// Value at every node. Cells with a node whose value is not finite stay grey.
    pub values: Vec<f64>,
}

/// A picture of a mesh: of a plane one from the front, of a solid what is seen of its skin from a corner.
///
/// Edges are drawn as the curves that they are. A field is interpolated by the shape functions of
/// each cell and read off a colour bar.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPicture<'a, const D: usize = 2> {
    /// The mesh.
    pub mesh: &'a Mesh<D>,
    /// Where a solid is seen from.
    pub view: View,
    /// What of a solid is drawn, instead of its whole skin.
    pub surface: Option<Vec<Facet>>,
    /// Title; may be empty.
    pub title: String,
    /// Unit of lengths, as it is written at the scale.
    pub unit: String,
    /// Displacement of every node \[mm\].
    pub displacement: Option<Vec<[f64; D]>>,
    /// How many times the displacement is drawn.
    pub magnification: f64,
    /// What the cells are coloured by.
    pub field: Option<Field>,
    /// Whether the contour of the undeformed body is drawn as well.
    pub outline: bool,
    /// Polylines drawn besides, of tools for instance \[mm\]; cut off not far from the body.
    pub polylines: Vec<Vec<[f64; D]>>,
    /// Convex polygons that veil what is behind them, of tools in space for instance \[mm\]; cut off not far from the body.
    pub veils: Vec<Vec<[f64; D]>>,
    /// Marks on top, with room for them around the body; faint where the body hides them.
    pub marks: Vec<Mark<D>>,
    /// What the colours of dots mean, below the body.
    pub keys: Vec<(String, &'static str)>,
}

impl<'a, const D: usize> MeshPicture<'a, D> {
    /// A picture of the undeformed mesh.
    pub fn new(mesh: &'a Mesh<D>, title: impl Into<String>) -> Self {
        Self {
            mesh,
            view: match D {
                2 => View::front(),
                _ => View::corner(),
            },
            surface: None,
            title: title.into(),
            unit: "mm".into(),
            displacement: None,
            magnification: 1.0,
            field: None,
            outline: false,
            polylines: Vec::new(),
            veils: Vec::new(),
            marks: Vec::new(),
            keys: Vec::new(),
        }
    }

    /// With lengths in another unit than mm.
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    /// With the nodes displaced, `magnification` times as far as they are.
    pub fn deformed(mut self, displacement: Vec<[f64; D]>, magnification: f64) -> Self {
        self.displacement = Some(displacement);
        self.magnification = magnification;
        self
    }

    /// With cells coloured by nodal values.
    pub fn field(mut self, label: impl Into<String>, values: Vec<f64>) -> Self {
        self.field = Some(Field {
            label: label.into(),
            values,
        });
        self
    }

    /// With the contour of the undeformed body.
    pub fn outline(mut self) -> Self {
        self.outline = true;
        self
    }

    /// With a polyline.
    pub fn polyline(mut self, points: Vec<[f64; D]>) -> Self {
        self.polylines.push(points);
        self
    }

    /// With a polygon that veils what is behind it.
    pub fn veil(mut self, corners: Vec<[f64; D]>) -> Self {
        self.veils.push(corners);
        self
    }

    /// Of these facets of a solid alone, seen against their mean normal.
    pub fn surface(mut self, facets: Vec<Facet>) -> Self {
        let nodes = self
            .positions()
            .unwrap_or_else(|_| self.mesh.nodes().to_vec());
        let own = facets.iter().map(|&f| normal(self.mesh, &nodes, f));
        self.view = View::against(own.sum());
        self.surface = Some(facets);
        self
    }

    /// With what a colour of dots means.
    pub fn key(mut self, meaning: impl Into<String>, colour: &'static str) -> Self {
        self.keys.push((meaning.into(), colour));
        self
    }

    /// With marks.
    pub fn marks(mut self, marks: Vec<Mark<D>>) -> Self {
        self.marks.extend(marks);
        self
    }

    /// The picture as a standalone SVG document, at most 760 wide.
    ///
    /// # Errors
    ///
    /// [`PlotError::Length`] and [`PlotError::Displacement`] for displacements, and
    /// [`PlotError::Length`] and [`PlotError::NoValues`] for a field, that do not fit the mesh.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let view = &self.view;
        let seen = |x: &[f64; D]| view.seen(x);
        let flat = |x: &[f64; D]| {
            let [x, y, _] = view.seen(x);
            [x, y]
        };
        let nodes: Vec<[f64; 3]> = self.positions()?.iter().map(seen).collect();
        let still = || self.mesh.nodes().iter().map(seen).collect();
        let axis = |i: usize| {
            let [x, y, _] = view.seen(&std::array::from_fn::<f64, D, _>(|k| {
                f64::from(u8::from(k == i))
            }));
            [x, y]
        };
        let marks = self.marks.iter();
        Flat {
            title: &self.title,
            unit: &self.unit,
            magnification: self.displacement.as_ref().map(|_| self.magnification),
            still: (self.outline && self.displacement.is_some()).then(still),
            faces: self.faces(&nodes),
            nodes,
            solid: D == 3,
            field: self.field.as_ref(),
            polylines: self
                .polylines
                .iter()
                .map(|p| p.iter().map(flat).collect())
                .collect(),
            veils: self
                .veils
                .iter()
                .map(|v| v.iter().map(seen).collect())
                .collect(),
            marks: marks
                .map(|m| (m.map(flat), view.seen(&m.place())[2]))
                .collect(),
            keys: &self.keys,
            axes: (D == 3).then(|| [axis(0), axis(1), axis(2)]),
        }
        .to_svg()
    }

    /// Cells of the plane, or facets of a solid that face the eye.
    fn faces(&self, seen: &[[f64; 3]]) -> Vec<Face> {
        if D == 2 {
            let face = |cell| Face {
                kind: self.mesh.kind(cell),
                nodes: self.mesh.cell_nodes(cell).to_vec(),
            };
            return (0..self.mesh.cell_count()).map(face).collect();
        }
        let skin = match &self.surface {
            Some(facets) => facets.clone(),
            None => self.mesh.boundary_facets(),
        };
        let face = |facet: Facet| {
            let kind = match self.mesh.facet_kind(facet) {
                FacetKind::Tri3 => CellKind::Tri3,
                FacetKind::Tri6 => CellKind::Tri6,
                FacetKind::Quad8 => CellKind::Quad8,
                FacetKind::Quad9 => CellKind::Quad9,
                _ => CellKind::Quad4,
            };
            let nodes = self.mesh.facet_nodes(facet).collect();
            (normal(self.mesh, seen, facet).z > 0.0).then_some(Face { kind, nodes })
        };
        skin.into_iter().filter_map(face).collect()
    }

    /// Nodes as drawn \[mm\].
    fn positions(&self) -> Result<Vec<[f64; D]>, PlotError> {
        let nodes = self.mesh.nodes();
        let Some(displacement) = &self.displacement else {
            return Ok(nodes.to_vec());
        };
        check_length("the displacement", displacement.len(), nodes.len())?;
        let magnification = self.magnification;
        let place = |(node, (x, &u)): (usize, (&[f64; D], &[f64; D]))| {
            let place: [f64; D] = std::array::from_fn(|i| x[i] + magnification * u[i]);
            if place.iter().all(|v| v.abs() <= FARTHEST) {
                Ok(place)
            } else {
                Err(PlotError::Displacement {
                    node,
                    displacement: u.to_vec(),
                    magnification,
                })
            }
        };
        nodes
            .iter()
            .zip(displacement)
            .enumerate()
            .map(place)
            .collect()
    }
}

/// Twice the area of a facet along its outward normal, by its diagonals or two of its sides.
fn normal<const D: usize, const N: usize>(
    mesh: &Mesh<D>,
    places: &[[f64; N]],
    facet: Facet,
) -> Vector3<f64> {
    let corners: Vec<usize> = mesh.facet_nodes(facet).collect();
    let side = |a: usize, b: usize| {
        let [a, b] = [&places[corners[a]], &places[corners[b]]];
        Vector3::from_fn(|i, _| b.get(i).unwrap_or(&0.0) - a.get(i).unwrap_or(&0.0))
    };
    match mesh.facet_kind(facet) {
        FacetKind::Tri3 | FacetKind::Tri6 => side(0, 1).cross(&side(0, 2)),
        _ => side(0, 2).cross(&side(1, 3)),
    }
}

/// Farthest coordinate of a node: the size of the body is a finite number.
const FARTHEST: f64 = f64::MAX / 4.0;
