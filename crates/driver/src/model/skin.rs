//! The nodes on the surfaces of the bodies; not what touches them.

use moreau_mesh::{Facet, Mesh};
use nalgebra::SVector;
use std::collections::BTreeMap;

/// What [`skin`] finds.
pub(crate) type Skin<const D: usize> = BTreeMap<usize, (usize, SVector<f64, D>)>;

/// The nodes on the surface of a mesh, each with the number of its body and its outward normal.
pub(crate) fn skin<const D: usize>(mesh: &Mesh<D>) -> Skin<D> {
    let bodies = mesh.bodies().into_iter().enumerate();
    let body: BTreeMap<usize, usize> = bodies
        .flat_map(|(k, cells)| cells.into_iter().map(move |cell| (cell, k)))
        .collect();
    let boundary = mesh.boundary_facets();
    let normals = mesh.node_normals(mesh.nodes(), &boundary);
    let of = |f: &Facet| {
        let body = body[&f.cell];
        mesh.facet_nodes(*f).map(move |a| (a, body))
    };
    let nodes = boundary.iter().flat_map(of);
    let with_normal =
        |(a, body): (usize, usize)| Some((a, (body, SVector::from(*normals.get(&a)?))));
    nodes.filter_map(with_normal).collect()
}
