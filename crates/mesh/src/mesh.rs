//! A mesh of nodes, cells and named groups, valid by construction; it has no unknowns, no state
//! and no file format.

mod arc;
mod groups;
mod inside;
mod integrals;
mod placed;
mod positive;
mod pressure;
mod topology;

pub use integrals::{NodeKind, Share};
pub(crate) use positive::Change;
pub use positive::PositiveShare;
pub use pressure::Pressed;
pub(crate) use topology::facet_key;

use crate::geometry::{bounds, diagonal};
use crate::sample::{CellSamples, Sample, cell_samples};
use crate::{CellKind, FacetKind, MeshError};
use groups::Group;
use std::collections::BTreeMap;

/// A side of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Facet {
    /// Index of the cell in the mesh.
    pub cell: usize,
    /// Index of the side in [`CellKind::facets`].
    pub facet: usize,
}

/// Nodes, cells and named groups in R^D, D = 2 or 3; always valid once constructed.
///
/// Every coordinate is finite, every cell has the nodes of its kind and a positive Jacobian
/// determinant, every node belongs to a cell, every group is sorted, without repetition and not
/// empty. Several bodies may live in one mesh: see [`Mesh::bodies`].
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh<const D: usize> {
    nodes: Vec<[f64; D]>,
    /// [`Mesh::size`], which is asked for at every contact point.
    size: f64,
    kinds: Vec<CellKind>,
    /// Nodes of cell c: `connectivity[offsets[c]..offsets[c + 1]]`.
    offsets: Vec<usize>,
    connectivity: Vec<usize>,
    groups: BTreeMap<String, Group>,
}

/// Least admissible Jacobian determinant, relative to the cell's size to the power D.
const DEGENERATE: f64 = 1e-12;

impl<const D: usize> Mesh<D> {
    /// A mesh of the given nodes \[mm\] and cells, each a kind and its nodes, without groups.
    ///
    /// # Errors
    ///
    /// [`MeshError::NoCells`]; [`MeshError::NotFinite`] for a NaN or infinite coordinate;
    /// [`MeshError::WrongDimension`], [`MeshError::WrongNodeCount`],
    /// [`MeshError::NodeOutOfRange`], [`MeshError::RepeatedNode`], [`MeshError::UnusedNode`] for
    /// cells that do not fit the nodes; [`MeshError::InvertedCell`] and
    /// [`MeshError::DegenerateCell`] where the Jacobian determinant, sampled at the nodes and at
    /// the points of the full rule, is negative or vanishes to rounding.
    pub fn new(
        nodes: Vec<[f64; D]>,
        cells: Vec<(CellKind, Vec<usize>)>,
    ) -> Result<Self, MeshError> {
        if cells.is_empty() {
            return Err(MeshError::NoCells);
        }
        let mut mesh = Self {
            size: diagonal(&nodes),
            nodes,
            kinds: Vec::with_capacity(cells.len()),
            offsets: vec![0],
            connectivity: Vec::new(),
            groups: BTreeMap::new(),
        };
        for (cell, (kind, cell_nodes)) in cells.into_iter().enumerate() {
            check_cell(cell, kind, &cell_nodes, D, mesh.nodes.len())?;
            mesh.kinds.push(kind);
            mesh.connectivity.extend(cell_nodes);
            mesh.offsets.push(mesh.connectivity.len());
        }
        let mut used = vec![false; mesh.nodes.len()];
        for &node in &mesh.connectivity {
            used[node] = true;
        }
        if let Some(node) = used.iter().position(|used| !used) {
            return Err(MeshError::UnusedNode { node });
        }
        mesh.check_geometry()?;
        Ok(mesh)
    }

    /// Coordinates of the nodes \[mm\].
    pub fn nodes(&self) -> &[[f64; D]] {
        &self.nodes
    }

    /// Number of cells.
    pub fn cell_count(&self) -> usize {
        self.kinds.len()
    }

    /// Kind of a cell.
    ///
    /// # Panics
    ///
    /// If the mesh has no such cell; so do the other functions of a cell or a facet.
    pub fn kind(&self, cell: usize) -> CellKind {
        self.kinds[cell]
    }

    /// Nodes of a cell, in the order of its kind.
    pub fn cell_nodes(&self, cell: usize) -> &[usize] {
        &self.connectivity[self.offsets[cell]..self.offsets[cell + 1]]
    }

    /// Whether a cell has such a side.
    pub fn has_facet(&self, facet: Facet) -> bool {
        let in_mesh = facet.cell < self.cell_count();
        in_mesh && facet.facet < self.kind(facet.cell).facets().len()
    }

    /// Kind of a facet.
    pub fn facet_kind(&self, facet: Facet) -> FacetKind {
        self.kind(facet.cell).facet_kind()
    }

    /// Nodes of a facet, oriented outwards, corners first.
    pub fn facet_nodes(&self, facet: Facet) -> impl ExactSizeIterator<Item = usize> + Clone {
        let nodes = self.cell_nodes(facet.cell);
        self.kind(facet.cell).facets()[facet.facet]
            .iter()
            .map(|&local| nodes[local])
    }

    /// Least and greatest corner of the box around the nodes \[mm\].
    pub fn bounds(&self) -> ([f64; D], [f64; D]) {
        bounds(&self.nodes)
    }

    /// Diagonal of the box around the nodes \[mm\].
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The mesh with every node moved from x to f(x) \[mm\], groups kept.
    ///
    /// Mid-side nodes move like the others, so the edges of quadratic cells follow a curved f.
    ///
    /// # Errors
    ///
    /// [`MeshError::NotFinite`], [`MeshError::InvertedCell`] (a reflection inverts every cell) and
    /// [`MeshError::DegenerateCell`], as from [`Mesh::new`].
    pub fn map(mut self, f: impl Fn([f64; D]) -> [f64; D]) -> Result<Self, MeshError> {
        for x in &mut self.nodes {
            *x = f(*x);
        }
        self.size = diagonal(&self.nodes);
        self.check_geometry()?;
        Ok(self)
    }

    /// The cells that displaced nodes turn inside out, those whose Jacobian determinant is not positive
    /// somewhere among the nodes and the points of the full rule, or is no number: each with its worst point \[mm\].
    ///
    /// # Panics
    /// If there are not as many positions as nodes.
    pub fn inverted(&self, positions: &[[f64; D]]) -> Vec<(usize, [f64; D])> {
        assert_eq!(positions.len(), self.nodes.len(), "a position a node");
        let mut samples = BTreeMap::new();
        let mut inverted = Vec::new();
        for cell in 0..self.cell_count() {
            let kind = self.kind(cell);
            let table = samples.entry(kind).or_insert_with(|| cell_samples(kind));
            let x: Vec<[f64; D]> = (self.cell_nodes(cell).iter())
                .map(|&a| positions[a])
                .collect();
            if let Some((det, point)) = least_determinant(&x, table)
                && (det.is_nan() || det <= 0.0)
            {
                inverted.push((cell, point));
            }
        }
        inverted
    }

    /// The quality of the worst cell with displaced nodes, which cell that is, and where \[mm\]: D det(M)^(2/D) / |M|²,
    /// least among the points of the full rule, of the map M from a square, cube or equilateral simplex. Of a
    /// rectangle with sides 1 : a it is 2 a / (1 + a²), of a square sheared by γ 2 / (2 + γ²), and of what is turned
    /// inside out not positive; where a position is no number, nor is the quality.
    ///
    /// Source: P. M. Knupp, *SIAM J. Sci. Comput.* 23 (2001) 193-218.
    ///
    /// # Panics
    /// If there are not as many positions as nodes.
    pub fn worst_quality(&self, positions: &[[f64; D]]) -> (f64, usize, [f64; D]) {
        assert_eq!(positions.len(), self.nodes.len(), "a position a node");
        let mut samples = BTreeMap::new();
        let mut worst = (f64::INFINITY, 0, [0.0; D]);
        for cell in 0..self.cell_count() {
            let kind = self.kind(cell);
            let table = samples.entry(kind).or_insert_with(|| cell_samples(kind));
            let nodes = self.cell_nodes(cell).iter();
            let x: Vec<[f64; D]> = nodes.map(|&a| positions[a]).collect();
            let simplex = kind.corner_count() == D + 1;
            for sample in &table.rule {
                let quality = sample.regularity(&x, simplex);
                // What is no number is worse than any.
                if quality < worst.0 || (quality.is_nan() && !worst.0.is_nan()) {
                    worst = (quality, cell, sample.position(&x));
                }
            }
        }
        worst
    }

    /// Coordinates of the nodes of a cell, in its order.
    pub(crate) fn cell_positions(&self, cell: usize) -> Vec<[f64; D]> {
        self.cell_nodes(cell)
            .iter()
            .map(|&node| self.nodes[node])
            .collect()
    }

    fn check_geometry(&self) -> Result<(), MeshError> {
        if let Some(node) = self
            .nodes
            .iter()
            .position(|x| x.iter().any(|v| !v.is_finite()))
        {
            return Err(MeshError::NotFinite {
                node,
                coordinates: self.nodes[node].to_vec(),
            });
        }
        let mut samples = BTreeMap::new();
        for cell in 0..self.cell_count() {
            let kind = self.kind(cell);
            let table = samples.entry(kind).or_insert_with(|| cell_samples(kind));
            check_shape(cell, &self.cell_positions(cell), table)?;
        }
        Ok(())
    }
}

/// Checks a cell as a list of nodes of a mesh of the given dimension with `count` nodes.
fn check_cell(
    cell: usize,
    kind: CellKind,
    nodes: &[usize],
    dimension: usize,
    count: usize,
) -> Result<(), MeshError> {
    if kind.dimension() != dimension {
        return Err(MeshError::WrongDimension {
            cell,
            kind,
            dimension,
        });
    }
    if nodes.len() != kind.nodes() {
        return Err(MeshError::WrongNodeCount {
            cell,
            kind,
            found: nodes.len(),
        });
    }
    for (i, &node) in nodes.iter().enumerate() {
        if node >= count {
            return Err(MeshError::NodeOutOfRange { cell, node, count });
        }
        if nodes[..i].contains(&node) {
            return Err(MeshError::RepeatedNode { cell, node });
        }
    }
    Ok(())
}

/// The least Jacobian determinant of a cell among its samples, and where that is.
fn least_determinant<const D: usize>(
    positions: &[[f64; D]],
    samples: &CellSamples<D>,
) -> Option<(f64, [f64; D])> {
    let det = |sample: &Sample<D>| (sample.det(positions), sample.position(positions));
    let all = samples.nodes.iter().chain(&samples.rule).map(det);
    // What is no number is less than any.
    let order = |det: f64| if det.is_nan() { f64::NEG_INFINITY } else { det };
    all.min_by(|a, b| order(a.0).total_cmp(&order(b.0)))
}

/// Checks the Jacobian determinant of a cell, where it is least among its samples.
fn check_shape<const D: usize>(
    cell: usize,
    positions: &[[f64; D]],
    samples: &CellSamples<D>,
) -> Result<(), MeshError> {
    let Some((det, point)) = least_determinant(positions, samples) else {
        return Ok(());
    };
    let size = diagonal(positions);
    let tolerance = DEGENERATE * size.powi(D as i32);
    // Neither comparison holds when the coordinates are so large that the determinant overflows.
    if det > tolerance {
        Ok(())
    } else if det < -tolerance {
        Err(MeshError::InvertedCell {
            cell,
            point: point.to_vec(),
            det,
        })
    } else {
        Err(MeshError::DegenerateCell {
            cell,
            point: point.to_vec(),
            det,
            size,
        })
    }
}
