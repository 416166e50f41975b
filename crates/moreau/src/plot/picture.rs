//! Pictures of plane meshes: cells, deformed or not, coloured by a field; not of their history.

mod bands;
mod marks;
mod sheet;

use super::PlotError;
use super::clip::clip;
use super::colour::{INK, LEVELS, colour};
use super::pen::{COARSE, FINE, Pen};
use crate::mesh::{CellKind, Mesh};
use bands::{Corner, Table, combine, fill_bands};
pub use marks::Mark;
use sheet::{Bar, Sheet, check_length};
use std::collections::BTreeMap;

/// A field on the nodes of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Label of the colour bar, with the unit.
    pub label: String,
    /// Value at every node. Cells with a node whose value is not finite stay grey.
    pub values: Vec<f64>,
}

/// A picture of a plane mesh.
///
/// Edges are drawn as the curves that they are. A field is interpolated by the shape functions of
/// each cell and read off a colour bar.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPicture<'a> {
    /// The mesh.
    pub mesh: &'a Mesh<2>,
    /// Title; may be empty.
    pub title: String,
    /// Unit of lengths, as it is written at the scale.
    pub unit: String,
    /// Displacement of every node \[mm\].
    pub displacement: Option<Vec<[f64; 2]>>,
    /// How many times the displacement is drawn.
    pub magnification: f64,
    /// What the cells are coloured by.
    pub field: Option<Field>,
    /// Whether the contour of the undeformed body is drawn as well.
    pub outline: bool,
    /// Polylines drawn besides, of tools for instance \[mm\]; cut off not far from the body.
    pub polylines: Vec<Vec<[f64; 2]>>,
    /// Marks on top, with room for them around the body.
    pub marks: Vec<Mark>,
}

impl<'a> MeshPicture<'a> {
    /// A picture of the undeformed mesh.
    pub fn new(mesh: &'a Mesh<2>, title: impl Into<String>) -> Self {
        Self {
            mesh,
            title: title.into(),
            unit: "mm".into(),
            displacement: None,
            magnification: 1.0,
            field: None,
            outline: false,
            polylines: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// With lengths in another unit than mm.
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    /// With the nodes displaced, `magnification` times as far as they are.
    pub fn deformed(mut self, displacement: Vec<[f64; 2]>, magnification: f64) -> Self {
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
    pub fn polyline(mut self, points: Vec<[f64; 2]>) -> Self {
        self.polylines.push(points);
        self
    }

    /// With marks.
    pub fn marks(mut self, marks: Vec<Mark>) -> Self {
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
        let nodes = self.positions()?;
        let bar = self
            .field
            .as_ref()
            .map(|f| Bar::new(f, self.mesh.nodes().len()))
            .transpose()?;
        let sheet = Sheet::new(self, &nodes, bar.as_ref());
        let pixels: Vec<[f64; 2]> = nodes.iter().map(|&x| sheet.place(x)).collect();
        let mut svg = sheet.head();
        let (grey, coloured): (Vec<usize>, Vec<usize>) =
            (0..self.mesh.cell_count()).partition(|&cell| match &bar {
                Some(bar) => self
                    .mesh
                    .cell_nodes(cell)
                    .iter()
                    .any(|&n| !bar.values[n].is_finite()),
                None => true,
            });
        self.plain_cells(&mut svg, &grey, &pixels);
        if let Some(bar) = &bar {
            self.coloured_cells(&mut svg, &coloured, &pixels, bar);
        }
        self.edges(&mut svg, &sheet, &pixels);
        for points in &self.polylines {
            // A point that is not finite interrupts the line.
            for piece in points.split(|x| !x.iter().all(|v| v.is_finite())) {
                for part in clip(piece, sheet.low, sheet.high) {
                    let mut pen = Pen::new(FINE);
                    pen.polyline(part.iter().map(|&x| sheet.place(x)));
                    pen.stroke(&mut svg, "#333333", 2.2, "");
                }
            }
        }
        marks::draw(&mut svg, &sheet, &self.marks);
        if let Some(bar) = &bar {
            sheet.bar(&mut svg, bar);
        }
        sheet.captions(&mut svg, self);
        svg.push_str("</svg>");
        Ok(svg)
    }

    /// Nodes as drawn \[mm\].
    fn positions(&self) -> Result<Vec<[f64; 2]>, PlotError> {
        let nodes = self.mesh.nodes();
        let Some(displacement) = &self.displacement else {
            return Ok(nodes.to_vec());
        };
        check_length("the displacement", displacement.len(), nodes.len())?;
        let magnification = self.magnification;
        let place = |(node, (x, &u)): (usize, (&[f64; 2], &[f64; 2]))| {
            let place = [x[0] + magnification * u[0], x[1] + magnification * u[1]];
            if place.iter().all(|v| v.abs() <= FARTHEST) {
                Ok(place)
            } else {
                Err(PlotError::Displacement {
                    node,
                    displacement: u,
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

    /// Fills cells that have no value.
    fn plain_cells(&self, svg: &mut String, cells: &[usize], pixels: &[[f64; 2]]) {
        let mut pen = Pen::new(self.precision());
        for &cell in cells {
            let nodes = self.mesh.cell_nodes(cell);
            for (k, facet) in self.mesh.kind(cell).facets().iter().enumerate() {
                let ends = [pixels[nodes[facet[0]]], pixels[nodes[facet[1]]]];
                if k == 0 {
                    pen.move_to(ends[0]);
                }
                pen.edge(ends, facet.get(2).map(|&m| pixels[nodes[m]]));
            }
            pen.close();
        }
        pen.fill(svg, "#e8ecf0");
    }

    /// Fills cells with the colours of a field, by patches about [`PATCH`] wide.
    fn coloured_cells(&self, svg: &mut String, cells: &[usize], pixels: &[[f64; 2]], bar: &Bar) {
        let mut size = PATCH;
        let divisions = loop {
            let divisions: Vec<[usize; 2]> = cells
                .iter()
                .map(|&cell| self.divisions(cell, pixels, size))
                .collect();
            let patches: usize = divisions.iter().map(|d| d[0] * d[1]).sum();
            if patches <= MOST_PATCHES.max(cells.len()) {
                break divisions;
            }
            size *= 1.3;
        };
        let mut pens = vec![Pen::new(COARSE); LEVELS];
        let mut tables: BTreeMap<(CellKind, [usize; 2]), Table> = BTreeMap::new();
        for (&cell, &division) in cells.iter().zip(&divisions) {
            let kind = self.mesh.kind(cell);
            let nodes = self.mesh.cell_nodes(cell);
            let table = tables
                .entry((kind, division))
                .or_insert_with(|| Table::new(kind, division));
            let corners: Vec<Corner> = table
                .corners
                .iter()
                .map(|shape| Corner {
                    place: [0, 1].map(|i| combine(shape, nodes, |n| pixels[n][i])),
                    // Quadratic interpolation overshoots the nodal values a little.
                    part: bar.part(combine(shape, nodes, |n| bar.values[n])),
                })
                .collect();
            for patch in &table.patches {
                let patch: Vec<Corner> = patch.iter().map(|&k| corners[k]).collect();
                fill_bands(&mut pens, &patch);
            }
        }
        for (level, pen) in pens.iter().enumerate() {
            pen.fill(svg, &colour(level));
        }
    }

    /// Patches of a cell along the two coordinates of its reference cell.
    fn divisions(&self, cell: usize, pixels: &[[f64; 2]], size: f64) -> [usize; 2] {
        let nodes = self.mesh.cell_nodes(cell);
        let kind = self.mesh.kind(cell);
        let mut longest = [0.0f64; 2];
        for (k, facet) in kind.facets().iter().enumerate() {
            let [a, b] = [pixels[nodes[facet[0]]], pixels[nodes[facet[1]]]];
            longest[k % 2] = longest[k % 2].max((a[0] - b[0]).hypot(a[1] - b[1]));
        }
        if kind.corner_count() == 3 {
            longest = [longest[0].max(longest[1]); 2];
        }
        longest.map(|length| ((length / size).ceil() as usize).clamp(1, 100))
    }

    /// Draws the edges between cells and the contour of the body.
    fn edges(&self, svg: &mut String, sheet: &Sheet, pixels: &[[f64; 2]]) {
        // By end nodes, in order: end nodes, mid-side node, number of cells.
        let mut edges: BTreeMap<[usize; 2], (Option<usize>, usize)> = BTreeMap::new();
        for cell in 0..self.mesh.cell_count() {
            let nodes = self.mesh.cell_nodes(cell);
            for facet in self.mesh.kind(cell).facets() {
                let mut ends = [nodes[facet[0]], nodes[facet[1]]];
                ends.sort_unstable();
                let middle = facet.get(2).map(|&m| nodes[m]);
                edges.entry(ends).or_insert((middle, 0)).1 += 1;
            }
        }
        let cell = sheet.typical_cell(self.mesh.cell_count());
        let (ink, opacity) = match self.field {
            Some(_) => ("#000000", r#" stroke-opacity="0.4""#),
            None => ("#5a6673", ""),
        };
        if cell >= 4.0 {
            let mut inner = Pen::new(self.precision());
            for (&[a, b], &(middle, _)) in edges.iter().filter(|(_, edge)| edge.1 > 1) {
                inner.move_to(pixels[a]);
                inner.edge([pixels[a], pixels[b]], middle.map(|m| pixels[m]));
            }
            inner.stroke(svg, ink, (cell / 22.0).clamp(0.2, 0.7), opacity);
        }
        let contour: Vec<Edge> = edges
            .iter()
            .filter(|(_, edge)| edge.1 == 1)
            .map(|(&ends, &(middle, _))| (ends, middle))
            .collect();
        let chains = chains(&contour);
        let draw = |place: &dyn Fn(usize) -> [f64; 2]| {
            let mut pen = Pen::new(FINE);
            for chain in &chains {
                for (k, &([a, b], middle)) in chain.iter().enumerate() {
                    if k == 0 {
                        pen.move_to(place(a));
                    }
                    pen.edge([place(a), place(b)], middle.map(place));
                }
            }
            pen
        };
        if self.outline && self.displacement.is_some() {
            let undeformed = draw(&|n| sheet.place(self.mesh.nodes()[n]));
            undeformed.stroke(svg, "#666666", 1.0, r#" stroke-dasharray="5 3""#);
        }
        draw(&|n| pixels[n]).stroke(svg, INK, 1.1, "");
    }

    /// Coordinates of a large mesh are short.
    fn precision(&self) -> f64 {
        if self.mesh.cell_count() > 1000 {
            COARSE
        } else {
            FINE
        }
    }
}

/// Farthest coordinate of a node: the size of the body is a finite number.
const FARTHEST: f64 = f64::MAX / 4.0;
/// Width of a patch in which the field is taken for linear.
const PATCH: f64 = 8.0;
/// Patches of a picture: keep it below three megabytes.
const MOST_PATCHES: usize = 10_000;

/// An edge of the mesh: end nodes, mid-side node.
type Edge = ([usize; 2], Option<usize>);

/// Edges in chains, end to end, so that dashes run on.
fn chains(edges: &[Edge]) -> Vec<Vec<Edge>> {
    let mut at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, (ends, _)) in edges.iter().enumerate() {
        for &end in ends {
            at.entry(end).or_default().push(k);
        }
    }
    let mut used = vec![false; edges.len()];
    let mut chains = Vec::new();
    for first in 0..edges.len() {
        let mut chain = Vec::new();
        let mut next = (!used[first]).then_some((first, edges[first].0[0]));
        while let Some((k, from)) = next {
            used[k] = true;
            let ([a, b], middle) = edges[k];
            let to = if a == from { b } else { a };
            chain.push(([from, to], middle));
            let free = at.get(&to).and_then(|at| at.iter().find(|&&k| !used[k]));
            next = free.map(|&k| (k, to));
        }
        if !chain.is_empty() {
            chains.push(chain);
        }
    }
    chains
}
