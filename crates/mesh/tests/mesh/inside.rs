//! Cells that share volume are found, and none else, with sides as curved as they are.

use moreau_mesh::{CellKind, Mesh, block2, block3, uniform};
use std::f64::consts::PI;

/// A half ring of cells of so many layers between two radii, and so many along it.
fn ring(name: &str, kind: CellKind, radii: &[f64], cells: usize) -> Mesh<2> {
    let angles = uniform(0.0, PI, cells);
    let block = block2(name, kind, radii, &angles).expect("valid");
    let bent = block.map(|[r, angle]| [r * angle.cos(), r * angle.sin()]);
    bent.expect("valid")
}

/// A half pipe.
fn pipe(name: &str, kind: CellKind, radii: &[f64], cells: usize) -> Mesh<3> {
    let (angles, along) = (uniform(0.0, PI, cells), uniform(0.0, 8.0, 2));
    let block = block3(name, kind, radii, &angles, &along).expect("valid");
    let bent = block.map(|[r, angle, z]| [r * angle.cos(), r * angle.sin(), z]);
    bent.expect("valid")
}

/// Layers of 0.2; between eight cells along them arcs bow by 0.19.
const THIN: [f64; 3] = [10.0, 10.2, 10.4];

/// As high as one of the layers, and across most of the first.
const WITHIN: [f64; 2] = [10.02, 10.22];

#[test]
fn thin_curved_layers_share_no_volume() {
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9] {
        let ring = ring("ring", kind, &THIN, 8);
        assert_eq!(ring.shared_volume(), [[0; 2]; 0], "{kind}");
    }
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27] {
        let pipe = pipe("pipe", kind, &THIN, 8);
        assert_eq!(pipe.shared_volume(), [[0; 2]; 0], "{kind}");
    }
}

/// Small cells on the coarse ones lie below the planes that touch the curved sides in their middles.
#[test]
fn small_cells_on_a_curved_side_share_no_volume() {
    let on = [10.42, 10.5];
    let fine = ring("fine", CellKind::Quad8, &on, 64);
    let both = ring("ring", CellKind::Quad8, &THIN, 8).joined(fine);
    assert_eq!(both.expect("valid").shared_volume(), [[0; 2]; 0]);
    let fine = pipe("fine", CellKind::Hex20, &on, 64);
    let both = pipe("pipe", CellKind::Hex20, &THIN, 8).joined(fine);
    assert_eq!(both.expect("valid").shared_volume(), [[0; 2]; 0]);
}

#[test]
fn curved_cells_within_each_other_share_volume() {
    let pairs = |k: usize| [[2 * k, 16 + k], [16 + k, 2 * k]];
    let mut expected: Vec<[usize; 2]> = (0..8).flat_map(pairs).collect();
    expected.sort_unstable();
    for kind in [CellKind::Quad8, CellKind::Quad9] {
        let other = ring("other", kind, &WITHIN, 8);
        let both = ring("ring", kind, &THIN, 8).joined(other);
        assert_eq!(both.expect("valid").shared_volume(), expected, "{kind}");
    }
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27] {
        let other = pipe("other", kind, &WITHIN, 8);
        let both = pipe("pipe", kind, &THIN, 8).joined(other).expect("valid");
        let (shared, own) = (both.shared_volume(), 2 * both.cell_count() / 3);
        let is_across = |pair: &[usize; 2]| (pair[0] < own) != (pair[1] < own);
        assert!(shared.len() >= both.cell_count() / 3, "{kind}: {shared:?}");
        assert!(shared.iter().all(is_across), "{kind}: {shared:?}");
    }
}

/// The middle of a cell where four others meet is in them, wherever the mesh is and however large.
#[test]
fn a_cell_over_four_others_shares_their_volume() {
    for (size, at) in [(1.0, 0.0), (1e-3, 1e4), (1e6, -1e6)] {
        let lines = |n: usize| uniform(at, at + size, n);
        let block = |name: &str, n: usize| {
            block2(name, CellKind::Quad4, &lines(n), &lines(n)).expect("valid")
        };
        let both = block("four", 2).joined(block("one", 1)).expect("valid");
        let mut shared = both.shared_volume();
        let over = shared.pop();
        assert_eq!(shared, [[0, 4], [1, 4], [2, 4], [3, 4]], "{size}");
        assert!(over.is_some_and(|[a, b]| a == 4 && b < 4), "{size}");
    }
}
