//! Meshes written for Gmsh and read back.

use moreau_mesh::{
    CellKind, Facet, Mesh, MeshError, block2, block3, read_gmsh, uniform, write_gmsh,
};

fn again<const D: usize>(mesh: &Mesh<D>) -> Mesh<D> {
    read_gmsh(write_gmsh(mesh).as_bytes()).expect("readable")
}

/// What Gmsh itself wrote comes back as it was: nodes, cells and groups, to the last bit.
#[test]
fn meshes_of_gmsh_come_back() {
    for file in [
        &include_bytes!("../data/tri6.4b.msh")[..],
        include_bytes!("../data/quad8.2b.msh"),
        include_bytes!("../data/quad9.4a.msh"),
        include_bytes!("../data/mixed.4a.msh"),
        include_bytes!("../data/periodic.4a.msh"),
    ] {
        let mesh: Mesh<2> = read_gmsh(file).expect("readable");
        assert_eq!(again(&mesh), mesh);
    }
    for file in [
        &include_bytes!("../data/tet4.4b.msh")[..],
        include_bytes!("../data/hex8.2a.msh"),
    ] {
        let mesh: Mesh<3> = read_gmsh(file).expect("readable");
        assert_eq!(again(&mesh), mesh);
    }
}

#[test]
fn blocks_come_back_with_their_groups() {
    let (x, y) = (uniform(0.0, 1.0 / 3.0, 3), uniform(-1e-7, 2e9, 2));
    for kind in [
        CellKind::Tri3,
        CellKind::Tri6,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
    ] {
        let mut mesh = block2("b", kind, &x, &y).expect("valid");
        mesh.add_node_group("two nodes", vec![3, 1]).expect("new");
        let read = again(&mesh);
        assert_eq!(read.nodes(), mesh.nodes());
        assert!(read.group_names().eq(mesh.group_names()));
        for name in mesh.group_names() {
            assert_eq!(
                read.node_group(name),
                mesh.node_group(name),
                "{kind} {name}"
            );
            assert_eq!(
                read.facet_group(name).is_ok(),
                mesh.facet_group(name).is_ok()
            );
        }
    }
    let z = uniform(0.0, 1.0, 2);
    for kind in [
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
    ] {
        let mesh = block3("b", kind, &x, &z, &z).expect("valid");
        let read = again(&mesh);
        assert_eq!(read.cell_count(), mesh.cell_count());
        for name in mesh.group_names() {
            assert_eq!(
                read.node_group(name),
                mesh.node_group(name),
                "{kind} {name}"
            );
        }
    }
}

/// Cells of no group are not lost: they are in one of their own.
#[test]
fn cells_without_a_group_are_kept() {
    let nodes = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let cells = vec![
        (CellKind::Tri3, vec![0, 1, 2]),
        (CellKind::Tri3, vec![1, 3, 2]),
    ];
    let mut mesh = Mesh::<2>::new(nodes, cells).expect("valid");
    mesh.add_cell_group("first", vec![0]).expect("new");
    let read = again(&mesh);
    assert_eq!(read.cell_count(), 2);
    assert_eq!(read.cell_group("ungrouped"), Ok(&[1][..]));
}

/// A facet inside a body is of one of its two cells, and a pressure on it turns round with the side.
#[test]
fn facets_inside_a_body_keep_their_side() {
    let line = uniform(0.0, 2.0, 2);
    for kind in [
        CellKind::Tri3,
        CellKind::Quad4,
        CellKind::Quad8,
        CellKind::Quad9,
    ] {
        let mut mesh = block2("b", kind, &line, &line).expect("valid");
        inner(&mut mesh);
        let read = again(&mesh);
        sides_are_kept(&mesh, &read);
        if kind != CellKind::Tri3 {
            assert_eq!(read, mesh);
        }
    }
    for kind in [
        CellKind::Tet4,
        CellKind::Tet10,
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Hex27,
    ] {
        let mut mesh = block3("b", kind, &line, &line, &[0.0, 1.0]).expect("valid");
        inner(&mut mesh);
        sides_are_kept(&mesh, &again(&mesh));
    }
}

/// A group for each side inside the mesh, and one of all of the second half of the cells.
fn inner<const D: usize>(mesh: &mut Mesh<D>) {
    let outside = mesh.boundary_facets();
    let all = (0..mesh.cell_count()).flat_map(|cell| {
        (0..mesh.kind(cell).facets().len()).map(move |facet| Facet { cell, facet })
    });
    let inside: Vec<Facet> = all.filter(|f| !outside.contains(f)).collect();
    assert!(inside.len() >= 4);
    for (k, &facet) in inside.iter().enumerate() {
        mesh.add_facet_group(&format!("side {k}"), vec![facet])
            .expect("new");
    }
}

/// The same facets, by the nodes of their cells: these may have another order.
fn sides_are_kept<const D: usize>(mesh: &Mesh<D>, read: &Mesh<D>) {
    for name in mesh.group_names().filter(|name| name.starts_with("side")) {
        let side = |mesh: &Mesh<D>| {
            let facet = mesh.facet_group(name).expect("written")[0];
            let mut nodes: Vec<usize> = mesh.facet_nodes(facet).collect();
            nodes.sort_unstable();
            (mesh.cell_nodes(facet.cell).to_vec(), nodes)
        };
        assert_eq!(side(read), side(mesh), "{name}");
    }
}

/// A name is a line of a file: another would be read as something else, or not at all.
#[test]
fn names_that_no_file_can_have_are_refused() {
    let mesh = || block2("b", CellKind::Quad4, &[0.0, 1.0], &[0.0, 1.0]).expect("valid");
    for name in ["", "two\nlines", "two\rlines"] {
        let expected = Err(MeshError::GroupName { name: name.into() });
        let facet = vec![Facet { cell: 0, facet: 0 }];
        assert_eq!(mesh().add_node_group(name, vec![0]), expected);
        assert_eq!(mesh().add_facet_group(name, facet), expected);
        assert_eq!(mesh().add_cell_group(name, vec![0]), expected);
    }
    for name in [
        " ",
        "a \"quoted\" one",
        "\"",
        "\u{b5}",
        "1",
        "mesh",
        "$EndNodes",
    ] {
        let mut mesh = mesh();
        mesh.add_node_group(name, vec![0]).expect("new");
        assert_eq!(again(&mesh), mesh, "{name:?}");
    }
}
