//! Patches of distorted cells; not what is tested on them.
//!
//! Source: R. H. MacNeal and R. L. Harder, *Finite Elements in Analysis and Design* 1 (1985) 3-20.

use moreau::mesh::{CellKind, Element, Hex8, Mesh, MeshError, Quad4, Tet4, Tri3, block3, uniform};
use std::collections::BTreeMap;

/// The plane patch of five quadrilaterals, or of triangles that cut them, with straight sides and
/// mid-side nodes in the middle. Its cells are the group `patch`, its outline `patch.outline`.
///
/// # Errors
/// None for a plane kind of cell; [`MeshError::WrongNodeCount`] and such for others.
pub fn plane_patch(kind: CellKind) -> Result<Mesh<2>, MeshError> {
    let corners = vec![
        [0.0, 0.0],
        [0.24, 0.0],
        [0.24, 0.12],
        [0.0, 0.12],
        [0.04, 0.02],
        [0.18, 0.03],
        [0.16, 0.08],
        [0.08, 0.08],
    ];
    let mut quads = vec![[4, 5, 6, 7]];
    quads.extend((0..4).map(|a| [4 + a, a, (a + 1) % 4, 4 + (a + 1) % 4]));
    let cells: Vec<Vec<usize>> = match kind.corner_count() {
        3 => quads
            .iter()
            .flat_map(|&[a, b, c, d]| [vec![a, b, c], vec![a, c, d]])
            .collect(),
        _ => quads.iter().map(|q| q.to_vec()).collect(),
    };
    named("patch", completed(kind, corners, &cells)?)
}

/// A mesh of cells given by their corners, completed with the other nodes of the kind, each in the
/// middle of the corners that it lies between.
fn completed<const D: usize>(
    kind: CellKind,
    mut nodes: Vec<[f64; D]>,
    cells: &[Vec<usize>],
) -> Result<Mesh<D>, MeshError> {
    let others = kind.reference_nodes().skip(kind.corner_count());
    let between: Vec<Vec<usize>> = others.map(|xi| corners_around(kind, xi)).collect();
    let mut middles: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    let mut complete = Vec::new();
    for corners in cells {
        let mut cell = corners.clone();
        for around in &between {
            let mut around: Vec<usize> = around.iter().map(|&k| corners[k]).collect();
            around.sort_unstable();
            let middle: [f64; D] = std::array::from_fn(|i| {
                around.iter().map(|&a| nodes[a][i]).sum::<f64>() / around.len() as f64
            });
            cell.push(*middles.entry(around).or_insert_with(|| {
                nodes.push(middle);
                nodes.len() - 1
            }));
        }
        complete.push((kind, cell));
    }
    Mesh::new(nodes, complete)
}

/// Corners whose linear shape function is not zero at a reference node.
fn corners_around(kind: CellKind, xi: &[f64]) -> Vec<usize> {
    let linear = match (xi, kind.corner_count()) {
        (&[x, y], 3) => Tri3::shape([x, y]).to_vec(),
        (&[x, y], _) => Quad4::shape([x, y]).to_vec(),
        (&[x, y, z], 4) => Tet4::shape([x, y, z]).to_vec(),
        (&[x, y, z], _) => Hex8::shape([x, y, z]).to_vec(),
        _ => Vec::new(),
    };
    (0..linear.len()).filter(|&k| linear[k] > 0.0).collect()
}

/// The patch of the unit cube with eight corners inside: seven hexahedra, or tetrahedra in a grid
/// with its inner corners moved. Sides are straight.
///
/// # Errors
/// None for a solid kind of cell.
pub fn solid_patch(kind: CellKind) -> Result<Mesh<3>, MeshError> {
    if kind.corner_count() == 4 {
        let lines = uniform(0.0, 1.0, 3);
        let mesh = block3("patch", CellKind::Tet4, &lines, &lines, &lines)?;
        let inside = |x: &[f64; 3]| x.iter().all(|&v| v > 0.0 && v < 1.0);
        let mesh = mesh.map(|x| match inside(&x) {
            true => [
                x[0] + 0.11 * x[1] * x[2],
                x[1] - 0.08 * x[0],
                x[2] + 0.09 * x[0] * x[1],
            ],
            false => x,
        })?;
        let cells = (0..mesh.cell_count()).map(|cell| mesh.cell_nodes(cell).to_vec());
        let cells: Vec<Vec<usize>> = cells.collect();
        return named("patch", completed(kind, mesh.nodes().to_vec(), &cells)?);
    }
    let mut nodes: Vec<[f64; 3]> = Hex8::NODES.map(|xi| xi.map(|v| 0.5 * (1.0 + v))).to_vec();
    let inner = [
        [0.249, 0.342, 0.192],
        [0.826, 0.288, 0.288],
        [0.850, 0.649, 0.263],
        [0.273, 0.750, 0.230],
        [0.320, 0.186, 0.643],
        [0.677, 0.305, 0.683],
        [0.788, 0.693, 0.644],
        [0.165, 0.745, 0.702],
    ];
    // Half-way to the corners of a cube: at one of the nodes of the source a cell is inverted.
    for (x, xi) in inner.iter().zip(Hex8::NODES) {
        nodes.push([0, 1, 2].map(|i| 0.5 * x[i] + 0.25 + 0.125 * xi[i]));
    }
    let mut cells: Vec<Vec<usize>> = vec![(8..16).collect()];
    for facet in Hex8::FACETS {
        let inner = facet.iter().map(|a| 8 + a);
        cells.push(inner.chain(facet.iter().copied()).collect());
    }
    named("patch", completed(kind, nodes, &cells)?)
}

fn named<const D: usize>(name: &str, mut mesh: Mesh<D>) -> Result<Mesh<D>, MeshError> {
    mesh.add_cell_group(name, (0..mesh.cell_count()).collect())?;
    let outline = mesh.boundary_facets();
    mesh.add_facet_group(&format!("{name}.outline"), outline)?;
    Ok(mesh)
}
