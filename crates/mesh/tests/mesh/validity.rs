//! A mesh is valid or is not: each way to be wrong has its error; moving and joining keep it valid.

use crate::{kinds, reference_cell};
use moreau_mesh::{CellKind, Facet, Mesh, MeshError, block2, uniform};

fn square() -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
}

fn quad4(nodes: Vec<[f64; 2]>, cell: &[usize]) -> Result<Mesh<2>, MeshError> {
    Mesh::new(nodes, vec![(CellKind::Quad4, cell.to_vec())])
}

#[test]
fn reference_cells_are_valid() {
    fn check<const D: usize>() {
        for kind in kinds(D) {
            let cell = (0..kind.nodes()).collect();
            let mesh = Mesh::new(reference_cell::<D>(kind), vec![(kind, cell)]);
            let mesh = mesh.expect("a reference cell is valid");
            assert_eq!(mesh.kind(0), kind);
            assert_eq!(mesh.cell_nodes(0).len(), kind.nodes());
            assert_eq!(mesh.boundary_facets().len(), kind.facets().len());
        }
    }
    check::<2>();
    check::<3>();
}

#[test]
fn a_mesh_needs_a_cell() {
    assert_eq!(Mesh::<2>::new(square(), vec![]), Err(MeshError::NoCells));
}

#[test]
fn coordinates_are_finite() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut nodes = square();
        nodes[2][1] = bad;
        let error = quad4(nodes, &[0, 1, 2, 3]).unwrap_err();
        assert!(
            matches!(error, MeshError::NotFinite { node: 2, .. }),
            "{error}"
        );
    }
}

#[test]
fn cells_fit_the_dimension() {
    let error = Mesh::new(square(), vec![(CellKind::Tet4, vec![0, 1, 2, 3])]).unwrap_err();
    let kind = CellKind::Tet4;
    assert_eq!(
        error,
        MeshError::WrongDimension {
            cell: 0,
            kind,
            dimension: 2
        }
    );
    assert_eq!(
        error.to_string(),
        "cell 0 is a tet4, of dimension 3: the mesh has dimension 2"
    );
}

#[test]
fn cells_have_the_nodes_of_their_kind() {
    let error = quad4(square(), &[0, 1, 2]).unwrap_err();
    assert_eq!(
        error,
        MeshError::WrongNodeCount {
            cell: 0,
            kind: CellKind::Quad4,
            found: 3
        }
    );
    assert_eq!(error.to_string(), "cell 0 has 3 nodes: a quad4 has 4");
    let error = quad4(square(), &[0, 1, 2, 4]).unwrap_err();
    assert_eq!(
        error,
        MeshError::NodeOutOfRange {
            cell: 0,
            node: 4,
            count: 4
        }
    );
    let error = quad4(square(), &[0, 1, 2, 1]).unwrap_err();
    assert_eq!(error, MeshError::RepeatedNode { cell: 0, node: 1 });
}

#[test]
fn nodes_belong_to_cells() {
    let mut nodes = square();
    nodes.push([5.0, 5.0]);
    assert_eq!(
        quad4(nodes, &[0, 1, 2, 3]),
        Err(MeshError::UnusedNode { node: 4 })
    );
}

#[test]
fn clockwise_and_non_convex_cells_are_inverted() {
    let error = quad4(square(), &[0, 3, 2, 1]).unwrap_err();
    assert!(matches!(error, MeshError::InvertedCell { cell: 0, det, .. } if det == -0.25));
    // Node 2 pushed beyond the diagonal: the determinant is negative at this corner alone.
    let mut nodes = square();
    nodes[2] = [0.3, 0.3];
    let error = quad4(nodes, &[0, 1, 2, 3]).unwrap_err();
    let MeshError::InvertedCell {
        cell: 0,
        point,
        det,
    } = error
    else {
        panic!("{error}")
    };
    assert_eq!(point, [0.3, 0.3]);
    assert!(det < 0.0);
}

#[test]
fn flat_cells_are_degenerate_at_any_scale() {
    for scale in [1e-20, 1.0, 1e20] {
        let flat = |height: f64| {
            let x = square()
                .into_iter()
                .map(|[x, y]| [scale * x, scale * height * y])
                .collect();
            quad4(x, &[0, 1, 2, 3])
        };
        assert!(flat(1e-9).is_ok());
        assert!(matches!(
            flat(1e-13),
            Err(MeshError::DegenerateCell { cell: 0, .. })
        ));
    }
    // A mid-side node at the quarter point makes the determinant vanish at the corner.
    let mut nodes = reference_cell::<2>(CellKind::Quad8);
    nodes[4] = [-0.5, -1.0];
    nodes[7] = [-1.0, -0.5];
    let error = Mesh::new(nodes, vec![(CellKind::Quad8, (0..8).collect())]).unwrap_err();
    assert!(matches!(&error, MeshError::DegenerateCell { point, .. } if *point == [-1.0, -1.0]));
}

#[test]
fn coordinates_too_large_for_a_determinant_are_refused() {
    let huge = square().into_iter().map(|x| x.map(|v| 1e200 * v)).collect();
    assert!(matches!(
        quad4(huge, &[0, 1, 2, 3]),
        Err(MeshError::DegenerateCell { .. })
    ));
}

fn block(name: &str) -> Mesh<2> {
    block2(
        name,
        CellKind::Quad8,
        &uniform(0.0, 4.0, 4),
        &uniform(0.0, 3.0, 3),
    )
    .expect("valid")
}

#[test]
fn bounds_and_size_are_those_of_the_box() {
    assert_eq!(block("a").bounds(), ([0.0, 0.0], [4.0, 3.0]));
    assert_eq!(block("a").size(), 5.0);
}

#[test]
fn a_moved_mesh_keeps_its_groups_and_is_checked_again() {
    let mesh = block("a");
    let moved = mesh
        .clone()
        .map(|[x, y]| [2.0 * x + 1.0, y])
        .expect("a stretch is valid");
    assert_eq!(moved.bounds(), ([1.0, 0.0], [9.0, 3.0]));
    assert_eq!(moved.facet_group("a.top"), mesh.facet_group("a.top"));
    let mirrored = mesh.clone().map(|[x, y]| [-x, y]);
    assert!(matches!(
        mirrored,
        Err(MeshError::InvertedCell { cell: 0, .. })
    ));
    assert!(matches!(
        mesh.clone().map(|[x, _]| [x, 0.0]),
        Err(MeshError::DegenerateCell { .. })
    ));
    assert!(matches!(
        mesh.map(|[x, _]| [x, f64::NAN]),
        Err(MeshError::NotFinite { .. })
    ));
}

#[test]
fn joined_meshes_stay_two_bodies() {
    let (a, b) = (
        block("a"),
        block("b")
            .map(|[x, y]| [x, y + 3.0])
            .expect("a shift is valid"),
    );
    let both = a.clone().joined(b.clone()).expect("the names differ");
    assert_eq!(both.nodes().len(), a.nodes().len() + b.nodes().len());
    assert_eq!(
        both.bodies(),
        [(0..12).collect::<Vec<_>>(), (12..24).collect()]
    );
    assert_eq!(both.bodies()[1], both.cell_group("b").expect("named"));
    assert_eq!(both.cell_group("a"), a.cell_group("a"));
    assert_eq!(
        both.boundary_facets().len(),
        a.boundary_facets().len() + b.boundary_facets().len()
    );
    let y = |name: &str| {
        let nodes = both.node_group(name).expect("named");
        nodes
            .iter()
            .map(|&node| both.nodes()[node][1])
            .fold(f64::NAN, f64::max)
    };
    assert_eq!([y("a.top"), y("b.bottom"), y("b.top")], [3.0, 3.0, 6.0]);
    let error = a.clone().joined(a).unwrap_err();
    assert_eq!(error, MeshError::DuplicateGroup { name: "a".into() });
}

#[test]
fn bodies_are_found_across_interleaved_cells() {
    // Four triangles: 0 and 3 share an edge, 1 and 2 only a node.
    let nodes = vec![
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [1.0, 1.0],
        [5.0, 0.0],
        [6.0, 0.0],
        [5.0, 1.0],
        [7.0, 0.0],
        [7.0, 1.0],
    ];
    let triangles = [[0, 1, 2], [4, 5, 6], [5, 7, 8], [1, 3, 2]];
    let cells = triangles.map(|t| (CellKind::Tri3, t.to_vec())).to_vec();
    let mesh = Mesh::new(nodes, cells).expect("valid");
    assert_eq!(mesh.bodies(), [[0, 3], [1, 2]]);
    let interior = [Facet { cell: 0, facet: 1 }, Facet { cell: 3, facet: 2 }];
    let boundary = mesh.boundary_facets();
    assert_eq!(boundary.len(), 10);
    assert!(interior.iter().all(|facet| !boundary.contains(facet)));
    assert!(boundary.is_sorted());
}

/// Squares, cubes and equilateral simplices are best, whatever their size and place; flat, sheared and inverted cells
/// have the quality of their formulas.
#[test]
fn the_quality_of_cells_is_known() {
    fn check<const D: usize>() {
        for kind in kinds(D) {
            let cell = (0..kind.nodes()).collect();
            let mesh = Mesh::new(reference_cell::<D>(kind), vec![(kind, cell)]).expect("valid");
            let nodes = mesh.nodes().to_vec();
            let simplex = kind.corner_count() == D + 1;
            // From the reference cell to a regular one of edges 3.
            let regular = |x: &[f64; D]| -> [f64; D] {
                let edges: [[f64; 3]; 3] = match (simplex, D) {
                    (false, _) => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                    (true, _) => [
                        [1.0, 0.0, 0.0],
                        [0.5, 0.75f64.sqrt(), 0.0],
                        [0.5, 1.0 / 12f64.sqrt(), (2.0f64 / 3.0).sqrt()],
                    ],
                };
                std::array::from_fn(|i| 7.0 + 3.0 * (0..D).map(|k| x[k] * edges[k][i]).sum::<f64>())
            };
            let quality = |f: &dyn Fn([f64; D]) -> [f64; D]| {
                let moved: Vec<[f64; D]> = nodes.iter().map(|x| f(regular(x))).collect();
                mesh.worst_quality(&moved).0
            };
            assert!((quality(&|x| x) - 1.0).abs() < 1e-12, "{kind}");
            let turned = quality(&|mut x| {
                (x[0], x[1]) = (0.6 * x[0] - 0.8 * x[1], 0.8 * x[0] + 0.6 * x[1]);
                x
            });
            assert!((turned - 1.0).abs() < 1e-12, "{kind}");
            // |F|² of an equilateral simplex is that of the map itself.
            let drawn = |mut x: [f64; D]| {
                x[0] *= 5.0;
                x
            };
            let d = D as f64;
            let flat = d * 5f64.powf(2.0 / d) / (25.0 + d - 1.0);
            assert!((quality(&drawn) - flat).abs() < 1e-12, "{kind}");
            let sheared = |mut x: [f64; D]| {
                x[0] += 3.0 * x[1];
                x
            };
            assert!((quality(&sheared) - d / (d + 9.0)).abs() < 1e-12, "{kind}");
            let over = |mut x: [f64; D]| {
                x[0] *= -1.0;
                x
            };
            assert!((quality(&over) + 1.0).abs() < 1e-12, "{kind}");
        }
    }
    check::<2>();
    check::<3>();
}

/// What is no number is turned inside out, and of the worst quality, in its cells and no others.
#[test]
fn positions_that_are_no_numbers_are_told() {
    let mesh = block2("b", CellKind::Quad8, &[0.0, 1.0, 2.0, 3.0], &[0.0, 1.0]).expect("valid");
    let node = mesh.cell_nodes(0)[0];
    for k in 0..2 {
        let mut positions = mesh.nodes().to_vec();
        positions[node][k] = f64::NAN;
        let cells: Vec<usize> = mesh
            .inverted(&positions)
            .iter()
            .map(|(cell, _)| *cell)
            .collect();
        assert_eq!(cells, [0]);
        let (quality, cell, _) = mesh.worst_quality(&positions);
        assert!(quality.is_nan() && cell == 0, "{quality} {cell}");
    }
    assert_eq!(mesh.inverted(mesh.nodes()), []);
}
