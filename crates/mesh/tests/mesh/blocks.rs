//! Grid lines and the blocks on them: counts, sides, conformity, Case P's mesh.

use crate::{ROUND_OFF, kinds};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use moreau_mesh::{
    CellKind, Facet, Mesh, MeshError, PlaneStrain, Solid, block2, block3, geometric, refine,
    uniform,
};
use proptest::prelude::*;
use std::collections::BTreeMap;

#[test]
fn lines_of_case_p_are_reproduced() {
    let columns = geometric(10.0, 2.5 * 1.640849940365, 1.640849940365, 4);
    for (line, exact) in columns
        .iter()
        .zip([10.0, 14.10212485, 20.83309617, 31.87761005, 50.0])
    {
        assert_abs_diff_eq!(*line, exact, epsilon = 5e-9);
    }
    let rows = geometric(0.0, -2.5, 1.342041860819, 7);
    let exact = [
        0.0,
        -2.5,
        -5.85510465,
        -10.35779554,
        -16.40059520,
        -24.51028531,
        -35.39382890,
        -50.0,
    ];
    assert_eq!(rows.len(), 8);
    for (line, exact) in rows.iter().zip(exact) {
        assert_abs_diff_eq!(*line, exact, epsilon = 5e-9);
    }
    // 56 quadratic cells on these lines, as the paper has them.
    let x = [&uniform(0.0, 10.0, 4), &columns[1..]].concat();
    let y: Vec<f64> = rows.into_iter().rev().collect();
    let mesh = block2("half", CellKind::Quad8, &x, &y).expect("the lines increase");
    assert_eq!(mesh.cell_count(), 56);
    assert_eq!(mesh.nodes().len(), 17 * 15 - 56);
    let area = mesh.measure(
        mesh.cell_group("half").expect("named"),
        &PlaneStrain::default(),
    );
    assert_relative_eq!(area, 2500.0, max_relative = 1e-11);
}

#[test]
fn uniform_lines_end_exactly() {
    assert_eq!(uniform(0.0, 1.0, 4), [0.0, 0.25, 0.5, 0.75, 1.0]);
    let lines = uniform(0.1, 0.7, 7);
    assert_eq!((lines[0], lines[7], lines.len()), (0.1, 0.7, 8));
}

#[test]
fn refined_lines_keep_the_given_ones() {
    assert_eq!(refine(&[0.0, 1.0, 3.0], 2), [0.0, 0.5, 1.0, 2.0, 3.0]);
    assert_eq!(refine(&[0.0, 1.0, 3.0], 1), [0.0, 1.0, 3.0]);
    assert_eq!(refine(&[], 3), []);
}

proptest! {
    #[test]
    fn refining_twice_is_refining_by_the_product(
        widths in prop::collection::vec(0.1..10.0f64, 1..6), m in 1..5usize, n in 1..5usize,
    ) {
        let lines: Vec<f64> = widths.iter().scan(-3.0, |x, w| { *x += w; Some(*x) }).collect();
        let (once, twice) = (refine(&lines, m * n), refine(&refine(&lines, m), n));
        prop_assert_eq!(once.len(), twice.len());
        prop_assert!(once.iter().zip(&twice).all(|(a, b)| (a - b).abs() <= 1e-12));
        prop_assert!(lines.iter().enumerate().all(|(i, line)| once[i * m * n] == *line));
    }
}

#[test]
fn blocks_have_the_nodes_and_cells_of_their_kind() {
    // 3 × 2 rectangles.
    for (kind, nodes, cells) in [
        (CellKind::Tri3, 12, 12),
        (CellKind::Tri6, 35, 12),
        (CellKind::Quad4, 12, 6),
        (CellKind::Quad8, 29, 6),
        (CellKind::Quad9, 35, 6),
    ] {
        let mesh = block2("b", kind, &uniform(0.0, 3.0, 3), &uniform(0.0, 2.0, 2)).expect("valid");
        assert_eq!(
            (mesh.nodes().len(), mesh.cell_count()),
            (nodes, cells),
            "{kind}"
        );
        for (side, facets) in [("left", 2), ("right", 2), ("bottom", 3), ("top", 3)] {
            let group = mesh.facet_group(&format!("b.{side}")).expect("named");
            assert_eq!(group.len(), facets, "{kind} {side}");
        }
        assert_eq!(mesh.boundary_facets().len(), 10);
        // Row by row, x fastest.
        assert!(
            mesh.nodes()
                .is_sorted_by(|a, b| (a[1], a[0]) < (b[1], b[0]))
        );
    }
}

#[test]
fn midside_nodes_are_in_the_middle() {
    let lines = [0.0, 1.0, 4.0];
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9] {
        let mesh = block2("b", kind, &lines, &lines).expect("valid");
        for cell in 0..mesh.cell_count() {
            for facet in 0..kind.facets().len() {
                let nodes = mesh.facet_nodes(Facet { cell, facet });
                let x: Vec<[f64; 2]> = nodes.map(|node| mesh.nodes()[node]).collect();
                let middle = std::array::from_fn(|i| 0.5 * (x[0][i] + x[1][i]));
                assert_eq!(x[2], middle);
            }
        }
    }
}

#[test]
fn triangles_cut_along_alternating_diagonals() {
    let lines = uniform(0.0, 2.0, 2);
    let mesh = block2("b", CellKind::Tri3, &lines, &lines).expect("valid");
    let cells_at_the_centre = (0..mesh.cell_count())
        .filter(|&cell| mesh.cell_nodes(cell).contains(&4))
        .count();
    assert_eq!(cells_at_the_centre, 8);
}

#[test]
fn nodes_of_solid_cells_are_where_their_reference_is() {
    let lines = [0.0, 1.0, 4.0];
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        let mesh = block3("b", kind, &lines, &lines, &lines).expect("valid");
        for cell in 0..mesh.cell_count() {
            let x: Vec<[f64; 3]> = mesh
                .cell_nodes(cell)
                .iter()
                .map(|&a| mesh.nodes()[a])
                .collect();
            for (x_a, xi) in x.iter().zip(kind.reference_nodes()) {
                let (low, high) = (x[0], x[6]);
                let expected: [f64; 3] =
                    std::array::from_fn(|i| low[i] + 0.5 * (xi[i] + 1.0) * (high[i] - low[i]));
                assert_eq!(*x_a, expected);
            }
        }
    }
    let mesh = block3("b", CellKind::Tet10, &lines, &lines, &lines).expect("valid");
    for cell in 0..mesh.cell_count() {
        let x: Vec<[f64; 3]> = mesh
            .cell_nodes(cell)
            .iter()
            .map(|&a| mesh.nodes()[a])
            .collect();
        for (x_a, xi) in x.iter().zip(CellKind::Tet10.reference_nodes()) {
            let expected: [f64; 3] = std::array::from_fn(|i| {
                x[0][i] + (0..3).map(|j| xi[j] * (x[j + 1][i] - x[0][i])).sum::<f64>()
            });
            assert_eq!(*x_a, expected);
        }
    }
}

/// Every facet belongs to one cell, on the boundary, or to two.
fn assert_conforming<const D: usize>(mesh: &Mesh<D>) {
    let mut owners: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    for cell in 0..mesh.cell_count() {
        for facet in 0..mesh.kind(cell).facets().len() {
            let mut nodes: Vec<usize> = mesh.facet_nodes(Facet { cell, facet }).collect();
            nodes.sort_unstable();
            *owners.entry(nodes).or_default() += 1;
        }
    }
    let (low, high) = mesh.bounds();
    for (nodes, count) in owners {
        let on_side = |i: usize, bound: f64| nodes.iter().all(|&n| mesh.nodes()[n][i] == bound);
        let outside = (0..D).any(|i| on_side(i, low[i]) || on_side(i, high[i]));
        assert_eq!(count, if outside { 1 } else { 2 });
    }
}

#[test]
fn blocks_conform() {
    let lines = [
        uniform(0.0, 2.0, 3),
        geometric(0.0, 0.3, 1.5, 2),
        uniform(-1.0, 1.0, 2),
    ];
    for kind in kinds(2) {
        assert_conforming(&block2("b", kind, &lines[0], &lines[1]).expect("valid"));
    }
    // 3 × 2 × 2 boxes.
    for (kind, cells, nodes) in [
        (CellKind::Tet4, 72, 36),
        (CellKind::Tet10, 72, 175),
        (CellKind::Hex8, 12, 36),
        (CellKind::Hex20, 12, 111),
        (CellKind::Hex27, 12, 175),
    ] {
        let mesh = block3("b", kind, &lines[0], &lines[1], &lines[2]).expect("valid");
        assert_conforming(&mesh);
        let found = (mesh.nodes().len(), mesh.cell_count());
        assert_eq!(found, (nodes, cells), "{kind}");
        let volume = mesh.measure(mesh.cell_group("b").expect("named"), &Solid);
        assert_relative_eq!(volume, 2.0 * 0.75 * 2.0, max_relative = 10.0 * ROUND_OFF);
        assert_eq!(mesh.bodies().len(), 1);
    }
}

#[test]
fn lines_must_increase() {
    let good = uniform(0.0, 1.0, 2);
    let error = block2("b", CellKind::Quad4, &good, &[0.0]).unwrap_err();
    assert_eq!(
        error,
        MeshError::TooFewLines {
            axis: 'y',
            count: 1
        }
    );
    let error = block2("b", CellKind::Quad4, &[0.0, 1.0, 1.0], &good).unwrap_err();
    assert_eq!(
        error,
        MeshError::LinesNotIncreasing {
            axis: 'x',
            index: 2,
            previous: 1.0,
            value: 1.0
        }
    );
    let error = block3("b", CellKind::Hex8, &good, &good, &[0.0, f64::NAN]).unwrap_err();
    assert!(matches!(
        error,
        MeshError::LinesNotIncreasing {
            axis: 'z',
            index: 1,
            ..
        }
    ));
    let error = block2("b", CellKind::Quad4, &good, &[0.0, f64::INFINITY]).unwrap_err();
    assert!(matches!(error, MeshError::NotFinite { .. }));
}

#[test]
fn kinds_must_fit_the_dimension() {
    let lines = uniform(0.0, 1.0, 1);
    let solid = block2("b", CellKind::Hex8, &lines, &lines);
    assert!(matches!(
        solid,
        Err(MeshError::WrongDimension { dimension: 2, .. })
    ));
    let plane = block3("b", CellKind::Quad8, &lines, &lines, &lines);
    assert!(matches!(
        plane,
        Err(MeshError::WrongDimension { dimension: 3, .. })
    ));
}
