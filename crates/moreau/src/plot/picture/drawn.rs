//! What a picture shows, seen from one side and put on paper: faces in layers, edges, tools; not what is seen from where.

use super::bands::{Corner, Table, combine, fill_bands};
use super::flat::{Face, Flat};
use super::layers::{Polygon, hides, layers};
use super::mark::Mark;
use super::marks;
use super::sheet::{Bar, Sheet};
use crate::mesh::CellKind;
use crate::plot::PlotError;
use crate::plot::clip::{clip, cut};
use crate::plot::colour::{INK, LEVELS, colour};
use crate::plot::pen::{COARSE, FINE, Pen};
use nalgebra::Vector3;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

impl Flat<'_> {
    /// The picture as SVG.
    pub(super) fn to_svg(&self) -> Result<String, PlotError> {
        let count = self.nodes.len();
        let bar = self.field.map(|f| Bar::new(f, count)).transpose()?;
        let sheet = Sheet::new(self, bar.as_ref());
        let place = |x: &[f64; 3]| sheet.place([x[0], x[1]]);
        let pixels: Vec<[f64; 2]> = self.nodes.iter().map(place).collect();
        let mut svg = sheet.head();
        let outline = self.still.as_ref().map(|still| self.outline(&sheet, still));
        if let Some(outline) = outline.as_ref().filter(|_| self.solid) {
            outline.stroke(&mut svg, "#666666", 1.0, DASHED);
        }
        let veils = self.veils(&sheet);
        let layers = self.layers(&sheet, &veils);
        let divisions = self.divisions_of_all(&pixels);
        let edges = self.edges(&layers);
        for (k, layer) in layers.iter().enumerate() {
            let faces: Vec<usize> = layer
                .iter()
                .copied()
                .filter(|&f| f < self.faces.len())
                .collect();
            let known = |&f: &usize| match &bar {
                Some(bar) => !self.faces[f]
                    .nodes
                    .iter()
                    .any(|&n| !bar.values[n].is_finite()),
                None => false,
            };
            let (coloured, grey): (Vec<usize>, Vec<usize>) = faces.into_iter().partition(known);
            self.plain_cells(&mut svg, &grey, &pixels);
            if let Some(bar) = &bar {
                self.coloured_cells(&mut svg, &coloured, (&pixels, &divisions), bar);
            }
            if let Some(outline) = outline
                .as_ref()
                .filter(|_| k + 1 == layers.len() && !self.solid)
            {
                outline.stroke(&mut svg, "#666666", 1.0, DASHED);
            }
            self.draw_edges(&mut svg, &sheet, &pixels, &edges, k);
            let mut pen = Pen::new(COARSE);
            for f in layer.iter().filter_map(|f| f.checked_sub(self.faces.len())) {
                pen.polyline(veils[f].iter().map(place));
                pen.close();
            }
            pen.veil(&mut svg, "#4a4f57");
        }
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
        marks::draw(&mut svg, &sheet, &self.seen_marks());
        if let Some(bar) = &bar {
            sheet.bar(&mut svg, bar);
        }
        sheet.captions(&mut svg, self);
        svg.push_str("</svg>");
        Ok(svg)
    }

    /// Corners of a face.
    fn polygon(&self, face: &Face) -> Polygon {
        let corners = &face.nodes[..face.kind.corner_count()];
        corners.iter().map(|&n| self.nodes[n]).collect()
    }

    /// Marks, and whether the body hides them.
    fn seen_marks(&self) -> Vec<(&Mark<2>, bool)> {
        let faces: Vec<Polygon> = match self.solid {
            true => self.faces.iter().map(|f| self.polygon(f)).collect(),
            false => Vec::new(),
        };
        let mut bounds = [f64::INFINITY, f64::NEG_INFINITY];
        for x in faces.iter().flatten() {
            bounds = [bounds[0].min(x[2]), bounds[1].max(x[2])];
        }
        let tolerance = 1e-3 * (bounds[1] - bounds[0]);
        let hidden = |(mark, depth): &(Mark<2>, f64)| {
            let [x, y] = mark.place();
            faces.iter().any(|f| hides(f, [x, y, *depth], tolerance))
        };
        self.marks.iter().map(|m| (&m.0, hidden(m))).collect()
    }

    /// What of the tools is on the sheet.
    fn veils(&self, sheet: &Sheet) -> Vec<Polygon> {
        let mut parts = Vec::new();
        for veil in &self.veils {
            // Whatever its corners, triangles are plane and convex.
            let pieces: Vec<Polygon> = match veil.len() {
                0..=4 => vec![veil.clone()],
                n => (2..n)
                    .map(|k| vec![veil[0], veil[k - 1], veil[k]])
                    .collect(),
            };
            for piece in pieces {
                let part = (0..2).fold(piece, |p, i| {
                    let above = cut(&p, |x| x[i] - sheet.low[i]);
                    cut(&above, |x| sheet.high[i] - x[i])
                });
                if part.len() > 2 && part.iter().flatten().all(|v| v.is_finite()) {
                    parts.push(part);
                }
            }
        }
        parts
    }

    /// Faces, and tools after them, in the order in which they are drawn.
    fn layers(&self, sheet: &Sheet, veils: &[Polygon]) -> Vec<Vec<usize>> {
        if !self.solid {
            return vec![(0..self.faces.len()).collect()];
        }
        let faces = self.faces.iter().map(|f| self.polygon(f));
        let on_paper = |polygon: Polygon| -> Polygon {
            polygon
                .into_iter()
                .map(|x| x.map(|v| sheet.scale * v))
                .collect()
        };
        let all: Vec<Polygon> = faces.chain(veils.iter().cloned()).map(on_paper).collect();
        layers(&all)
    }

    /// Fills cells that have no value.
    fn plain_cells(&self, svg: &mut String, cells: &[usize], pixels: &[[f64; 2]]) {
        let mut pen = Pen::new(self.precision());
        for &cell in cells {
            let Face { kind, nodes } = &self.faces[cell];
            for (k, facet) in kind.facets().iter().enumerate() {
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

    /// Patches about [`PATCH`] wide of every face.
    fn divisions_of_all(&self, pixels: &[[f64; 2]]) -> Vec<[usize; 2]> {
        let mut size = PATCH;
        loop {
            let divisions: Vec<[usize; 2]> = (0..self.faces.len())
                .map(|cell| self.divisions(cell, pixels, size))
                .collect();
            let patches: usize = divisions.iter().map(|d| d[0] * d[1]).sum();
            if patches <= MOST_PATCHES.max(self.faces.len()) {
                return divisions;
            }
            size *= 1.3;
        }
    }

    /// Fills cells with the colours of a field, by patches.
    fn coloured_cells(
        &self,
        svg: &mut String,
        cells: &[usize],
        (pixels, divisions): (&[[f64; 2]], &[[usize; 2]]),
        bar: &Bar,
    ) {
        let mut pens = vec![Pen::new(COARSE); LEVELS];
        let mut tables: BTreeMap<(CellKind, [usize; 2]), Table> = BTreeMap::new();
        for &cell in cells {
            let Face { kind, nodes } = &self.faces[cell];
            let (kind, division) = (*kind, divisions[cell]);
            let table = tables
                .entry((kind, division))
                .or_insert_with(|| Table::new(kind, division));
            let corners: Vec<Corner> = table
                .corners
                .iter()
                .map(|shape| {
                    let [x, y] = [0, 1].map(|i| combine(shape, nodes, |n| pixels[n][i]));
                    // Quadratic interpolation overshoots the nodal values a little.
                    [x, y, bar.part(combine(shape, nodes, |n| bar.values[n]))]
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
        let Face { kind, nodes } = &self.faces[cell];
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

    /// The edges of the faces, each with the layer after which nothing behind it is drawn.
    fn edges(&self, layers: &[Vec<usize>]) -> BTreeMap<[usize; 2], Side> {
        let mut edges: BTreeMap<[usize; 2], Side> = BTreeMap::new();
        for (k, layer) in layers.iter().enumerate() {
            for &f in layer.iter().filter(|f| **f < self.faces.len()) {
                let Face { kind, nodes } = &self.faces[f];
                let normal = match self.solid {
                    true => normal(&self.polygon(&self.faces[f])),
                    false => Vector3::z(),
                };
                for facet in kind.facets() {
                    let mut ends = [nodes[facet[0]], nodes[facet[1]]];
                    ends.sort_unstable();
                    let middle = facet.get(2).map(|&m| nodes[m]);
                    match edges.entry(ends) {
                        Entry::Vacant(at) => {
                            at.insert(Side {
                                middle,
                                layer: k,
                                contour: true,
                                normal,
                            });
                        }
                        Entry::Occupied(mut at) => {
                            let side = at.get_mut();
                            side.contour = side.normal.dot(&normal) < SHARP;
                            side.layer = k;
                        }
                    }
                }
            }
        }
        edges
    }

    /// Draws the edges between cells and the contour of the body in a layer.
    fn draw_edges(
        &self,
        svg: &mut String,
        sheet: &Sheet,
        pixels: &[[f64; 2]],
        edges: &BTreeMap<[usize; 2], Side>,
        layer: usize,
    ) {
        let cell = sheet.typical_cell(self.faces.len());
        let (ink, opacity) = match self.field {
            Some(_) => ("#000000", r#" stroke-opacity="0.4""#),
            None => ("#5a6673", ""),
        };
        let own = || edges.iter().filter(|(_, side)| side.layer == layer);
        if cell >= 4.0 {
            let mut inner = Pen::new(self.precision());
            for (&[a, b], side) in own().filter(|(_, side)| !side.contour) {
                inner.move_to(pixels[a]);
                inner.edge([pixels[a], pixels[b]], side.middle.map(|m| pixels[m]));
            }
            inner.stroke(svg, ink, (cell / 22.0).clamp(0.2, 0.7), opacity);
        }
        let contour: Vec<Edge> = own()
            .filter(|(_, side)| side.contour)
            .map(|(&ends, side)| (ends, side.middle))
            .collect();
        contour_path(&contour, &|n| pixels[n]).stroke(svg, INK, 1.1, "");
    }

    /// The contour where nothing is displaced.
    fn outline(&self, sheet: &Sheet, still: &[[f64; 3]]) -> Pen {
        let all = [(0..self.faces.len()).collect()];
        let contour = self
            .edges(&all)
            .into_iter()
            .filter(|(_, side)| side.contour);
        let contour: Vec<Edge> = contour.map(|(ends, side)| (ends, side.middle)).collect();
        contour_path(&contour, &|n| sheet.place([still[n][0], still[n][1]]))
    }

    /// Coordinates of a large mesh are short.
    fn precision(&self) -> f64 {
        if self.faces.len() > 1000 {
            COARSE
        } else {
            FINE
        }
    }
}

/// Width of a patch in which the field is taken for linear.
const PATCH: f64 = 8.0;
/// Patches of a picture: keep it below three megabytes.
const MOST_PATCHES: usize = 10_000;

/// An edge of the mesh: end nodes, mid-side node.
type Edge = ([usize; 2], Option<usize>);

/// An edge as the faces beside it have it.
struct Side {
    middle: Option<usize>,
    layer: usize,
    /// Whether it bounds what is seen, or is sharp.
    contour: bool,
    /// Of the first of its faces.
    normal: Vector3<f64>,
}

/// Cosine of the angle between faces from which on an edge is sharp.
const SHARP: f64 = 0.87;
const DASHED: &str = r#" stroke-dasharray="5 3""#;

/// The unit normal of a face by its diagonals, or by two of its sides.
fn normal(face: &Polygon) -> Vector3<f64> {
    let side = |a: usize, b: usize| Vector3::from(face[b]) - Vector3::from(face[a]);
    let cross = match face.len() {
        3 => side(0, 1).cross(&side(0, 2)),
        _ => side(0, 2).cross(&side(1, 3)),
    };
    cross.try_normalize(0.0).unwrap_or_default()
}

/// A path along edges.
fn contour_path(edges: &[Edge], place: &dyn Fn(usize) -> [f64; 2]) -> Pen {
    let mut pen = Pen::new(FINE);
    for chain in chains(edges) {
        for (k, &([a, b], middle)) in chain.iter().enumerate() {
            if k == 0 {
                pen.move_to(place(a));
            }
            pen.edge([place(a), place(b)], middle.map(place));
        }
    }
    pen
}

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
