//! Groups are sorted sets under unique names, and misspelt names are answered by the nearest.

use moreau_mesh::{CellKind, Facet, GroupKind, Mesh, MeshError, block2, uniform};

/// Two cells side by side, nodes 0, 1, 2 below 3, 4, 5.
fn mesh() -> Mesh<2> {
    block2(
        "block",
        CellKind::Quad4,
        &uniform(0.0, 2.0, 2),
        &uniform(0.0, 1.0, 1),
    )
    .expect("valid")
}

#[test]
fn groups_are_sorted_sets() {
    let mut mesh = mesh();
    mesh.add_cell_group("cells", vec![1, 0, 1]).expect("valid");
    mesh.add_node_group("nodes", vec![5, 0, 5, 2])
        .expect("valid");
    let [a, b] = [Facet { cell: 0, facet: 3 }, Facet { cell: 1, facet: 0 }];
    mesh.add_facet_group("facets", vec![b, a, b])
        .expect("valid");
    assert_eq!(mesh.cell_group("cells"), Ok(&[0, 1][..]));
    assert_eq!(mesh.node_group("nodes"), Ok(vec![0, 2, 5]));
    assert_eq!(mesh.facet_group("facets"), Ok(&[a, b][..]));
}

#[test]
fn every_group_has_nodes() {
    let mut mesh = mesh();
    mesh.add_cell_group("second", vec![1]).expect("valid");
    assert_eq!(mesh.node_group("second"), Ok(vec![1, 2, 4, 5]));
    assert_eq!(mesh.node_group("block.top"), Ok(vec![3, 4, 5]));
    assert_eq!(mesh.node_group("block.left"), Ok(vec![0, 3]));
}

#[test]
fn names_come_in_alphabetical_order() {
    let names = [
        "block",
        "block.bottom",
        "block.left",
        "block.right",
        "block.top",
    ];
    assert!(mesh().group_names().eq(names));
}

#[test]
fn a_name_serves_once() {
    let mut mesh = mesh();
    let error = mesh.add_node_group("block.top", vec![0]).unwrap_err();
    assert_eq!(
        error,
        MeshError::DuplicateGroup {
            name: "block.top".into()
        }
    );
    assert_eq!(
        error.to_string(),
        "the group \"block.top\" exists already: the names of groups must differ"
    );
}

#[test]
fn a_group_is_not_empty() {
    let mut mesh = mesh();
    for (result, kind) in [
        (mesh.add_cell_group("none", vec![]), GroupKind::Cells),
        (mesh.add_facet_group("none", vec![]), GroupKind::Facets),
        (mesh.add_node_group("none", vec![]), GroupKind::Nodes),
        (
            mesh.node_group_where("none", "block", |_| false),
            GroupKind::Nodes,
        ),
    ] {
        assert_eq!(
            result,
            Err(MeshError::EmptyGroup {
                name: "none".into(),
                kind
            })
        );
    }
    assert!(mesh.node_group("none").is_err());
}

#[test]
fn members_exist() {
    let mut mesh = mesh();
    let out_of_range = |kind, index, count| {
        Err(MeshError::GroupOutOfRange {
            name: "g".into(),
            kind,
            index,
            count,
        })
    };
    assert_eq!(
        mesh.add_cell_group("g", vec![0, 2]),
        out_of_range(GroupKind::Cells, 2, 2)
    );
    assert_eq!(
        mesh.add_node_group("g", vec![6, 1]),
        out_of_range(GroupKind::Nodes, 6, 6)
    );
    let facet = |cell, facet| vec![Facet { cell, facet }];
    assert_eq!(
        mesh.add_facet_group("g", facet(2, 0)),
        out_of_range(GroupKind::Cells, 2, 2)
    );
    let error = mesh.add_facet_group("g", facet(1, 4)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the group \"g\" refers to facet 4 of cell 1: that cell, a quad4, has 4"
    );
}

#[test]
fn an_unknown_name_is_answered_by_the_nearest_of_its_kind() {
    let mesh = mesh();
    let error = mesh.facet_group("blok.tob").unwrap_err();
    assert_eq!(
        error.to_string(),
        "no group \"blok.tob\": did you mean \"block.top\"?"
    );
    // The nearest name of all is a facet group; the nearest group of cells is another.
    let nearest = |error| match error {
        MeshError::UnknownGroup { nearest, .. } => nearest,
        other => panic!("{other}"),
    };
    assert_eq!(
        nearest(mesh.cell_group("block.topp").unwrap_err()).as_deref(),
        Some("block")
    );
    assert_eq!(
        nearest(mesh.node_group("block.topp").unwrap_err()).as_deref(),
        Some("block.top")
    );

    let triangle = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let bare = Mesh::new(triangle, vec![(CellKind::Tri3, vec![0, 1, 2])]).expect("valid");
    let error = bare.node_group("top").unwrap_err();
    assert_eq!(
        error.to_string(),
        "no group \"top\": the mesh has no group to use here"
    );
}

#[test]
fn a_group_of_another_kind_is_named_as_such() {
    let mesh = mesh();
    let error = mesh.cell_group("block.top").unwrap_err();
    assert_eq!(
        error.to_string(),
        "the group \"block.top\" holds facets: cells are needed here"
    );
    assert!(matches!(
        mesh.facet_group("block"),
        Err(MeshError::WrongGroup { .. })
    ));
}

#[test]
fn groups_are_cut_by_position() {
    let mut mesh = mesh();
    mesh.node_group_where("left half", "block.top", |x| x[0] <= 1.0)
        .expect("valid");
    assert_eq!(mesh.node_group("left half"), Ok(vec![3, 4]));
    // A facet is kept if all of it is.
    mesh.facet_group_where("punch", "block.top", |x| x[0] <= 1.5)
        .expect("valid");
    assert_eq!(
        mesh.facet_group("punch"),
        Ok(&[Facet { cell: 0, facet: 2 }][..])
    );
    assert!(matches!(
        mesh.facet_group_where("g", "block", |_| true),
        Err(MeshError::WrongGroup { .. })
    ));
}
