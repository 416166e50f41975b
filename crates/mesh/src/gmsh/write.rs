//! Meshes as text of Gmsh, MSH 2.2; the inverse of the reader.

use super::kind;
use crate::Mesh;
use std::fmt::{self, Write};

/// Group of the cells that are in none, so that they are read back.
const REST: &str = "ungrouped";

/// A mesh as the text of an MSH file, version 2.2, which Gmsh and [`read_gmsh`](crate::read_gmsh)
/// read back with the same nodes and groups, facets on the same side also inside a body. Cells come back in the order of
/// their nodes, as from any file of Gmsh: the mesh is equal where they were in it, and members of groups have other
/// numbers where they were not.
///
/// Groups of cells, facets and nodes are physical groups of dimension D, D − 1 and 0; a member of
/// several groups is written for each, which is how this version of the format has it. Cells in no
/// group are in `"ungrouped"`.
pub fn write_gmsh<const D: usize>(mesh: &Mesh<D>) -> String {
    let mut out = String::new();
    // Writing to a string does not fail.
    let _ = write(mesh, &mut out);
    out
}

/// Dimension, type and nodes of an element.
type Row = (usize, i32, Vec<usize>);

fn write<const D: usize>(mesh: &Mesh<D>, out: &mut String) -> fmt::Result {
    let mut groups: Vec<(&str, Vec<Row>)> = mesh
        .group_names()
        .map(|name| (name, members(mesh, name)))
        .collect();
    let mut grouped = vec![false; mesh.cell_count()];
    for name in mesh.group_names() {
        for &cell in mesh.cell_group(name).unwrap_or_default() {
            grouped[cell] = true;
        }
    }
    let rest = (0..mesh.cell_count()).filter(|&c| !grouped[c]);
    let rest: Vec<Row> = rest.map(|c| cell(mesh, c)).collect();
    if !rest.is_empty() {
        groups.push((REST, rest));
    }

    writeln!(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat")?;
    writeln!(out, "$PhysicalNames\n{}", groups.len())?;
    for (tag, (name, rows)) in (1..).zip(&groups) {
        let dimension = rows.first().map_or(0, |row| row.0);
        writeln!(out, "{dimension} {tag} \"{name}\"")?;
    }
    writeln!(out, "$EndPhysicalNames\n$Nodes\n{}", mesh.nodes().len())?;
    for (number, x) in (1..).zip(mesh.nodes()) {
        let [x, y, z] = std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0));
        writeln!(out, "{number} {x:?} {y:?} {z:?}")?;
    }
    let count: usize = groups.iter().map(|(_, rows)| rows.len()).sum();
    writeln!(out, "$EndNodes\n$Elements\n{count}")?;
    let mut number = 0;
    for (tag, (_, rows)) in (1..).zip(&groups) {
        for (_, kind, nodes) in rows {
            number += 1;
            // The entity is called like the group: Gmsh gives groups to entities as a whole.
            write!(out, "{number} {kind} 2 {tag} {tag}")?;
            for node in nodes {
                write!(out, " {}", node + 1)?;
            }
            writeln!(out)?;
        }
    }
    writeln!(out, "$EndElements")
}

/// The elements of a group.
fn members<const D: usize>(mesh: &Mesh<D>, name: &str) -> Vec<Row> {
    if let Ok(cells) = mesh.cell_group(name) {
        return cells.iter().map(|&c| cell(mesh, c)).collect();
    }
    if let Ok(facets) = mesh.facet_group(name) {
        let row = |nodes: Vec<usize>| (D - 1, kind::of_nodes(D - 1, nodes.len()), nodes);
        let facets = facets.iter().map(|&f| mesh.facet_nodes(f).collect());
        return facets.map(row).collect();
    }
    let nodes = mesh.node_group(name).unwrap_or_default();
    let row = |node| (0, kind::of_nodes(0, 1), vec![node]);
    nodes.into_iter().map(row).collect()
}

fn cell<const D: usize>(mesh: &Mesh<D>, cell: usize) -> Row {
    let kind = kind::of_nodes(D, mesh.kind(cell).nodes());
    (D, kind, mesh.cell_nodes(cell).to_vec())
}
