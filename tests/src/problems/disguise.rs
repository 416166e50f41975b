//! The same mesh in another guise: turned, mirrored, its nodes and cells renumbered; not another
//! problem.

use moreau::mesh::{CellKind, Facet, Mesh, MeshError};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh in another guise.
pub struct Disguised {
    /// The mesh, with the groups asked for.
    pub mesh: Mesh<2>,
    /// Where each node of the first mesh is now.
    pub node: Vec<usize>,
}

/// Moves every node by `place`, renumbers nodes and cells by fixed shuffles if `shuffle`, and walks
/// the cells the other way round if `mirrored`. Groups of cells, of facets and of nodes are kept.
///
/// # Errors
/// Those of [`Mesh::new`] and of the groups.
pub fn disguise(
    mesh: &Mesh<2>,
    groups: (&[&str], &[&str], &[&str]),
    place: impl Fn([f64; 2]) -> [f64; 2],
    mirrored: bool,
    shuffle: bool,
) -> Result<Disguised, MeshError> {
    let count = mesh.nodes().len();
    let node = permutation(count, shuffle);
    let cell = permutation(mesh.cell_count(), shuffle);
    let mut nodes = vec![[0.0; 2]; count];
    for (old, &new) in node.iter().enumerate() {
        nodes[new] = place(mesh.nodes()[old]);
    }
    let mut cells = vec![(CellKind::Quad8, Vec::new()); mesh.cell_count()];
    for (old, &new) in cell.iter().enumerate() {
        let local = mesh.cell_nodes(old);
        let order = if mirrored {
            reversed(mesh.kind(old))
        } else {
            (0..local.len()).collect()
        };
        cells[new] = (
            mesh.kind(old),
            order.iter().map(|&k| node[local[k]]).collect(),
        );
    }
    let mut new_mesh = Mesh::new(nodes, cells)?;
    let mut facets: BTreeMap<(usize, BTreeSet<usize>), Facet> = BTreeMap::new();
    for c in 0..new_mesh.cell_count() {
        for f in 0..new_mesh.kind(c).facets().len() {
            let facet = Facet { cell: c, facet: f };
            facets.insert((c, new_mesh.facet_nodes(facet).collect()), facet);
        }
    }
    for name in groups.0 {
        let members = mesh.cell_group(name)?.iter().map(|&c| cell[c]).collect();
        new_mesh.add_cell_group(name, members)?;
    }
    for name in groups.1 {
        let members = mesh
            .facet_group(name)?
            .iter()
            .map(|&f| facets[&(cell[f.cell], mesh.facet_nodes(f).map(|a| node[a]).collect())]);
        let members = members.collect();
        new_mesh.add_facet_group(name, members)?;
    }
    for name in groups.2 {
        let members = mesh
            .node_group(name)?
            .into_iter()
            .map(|a| node[a])
            .collect();
        new_mesh.add_node_group(name, members)?;
    }
    Ok(Disguised {
        mesh: new_mesh,
        node,
    })
}

/// Nodes of a cell, walked the other way round from its first corner.
fn reversed(kind: CellKind) -> Vec<usize> {
    match kind {
        CellKind::Tri3 => vec![0, 2, 1],
        CellKind::Tri6 => vec![0, 2, 1, 5, 4, 3],
        CellKind::Quad4 => vec![0, 3, 2, 1],
        CellKind::Quad8 => vec![0, 3, 2, 1, 7, 6, 5, 4],
        CellKind::Quad9 => vec![0, 3, 2, 1, 7, 6, 5, 4, 8],
        _ => panic!("{kind} is no plane cell"),
    }
}

/// A shuffle of 0..n: multiplication by a number prime to n; or the identity.
fn permutation(n: usize, shuffle: bool) -> Vec<usize> {
    let divides = |a: usize, b: usize| (2..=a).any(|d| a.is_multiple_of(d) && b.is_multiple_of(d));
    let start = (0.618 * n as f64) as usize;
    let factor = (start.max(1)..).find(|&f| !divides(f, n)).unwrap_or(1);
    let place = |k: usize| if shuffle { (k * factor + n / 3) % n } else { k };
    (0..n).map(place).collect()
}
