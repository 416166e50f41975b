//! Volumes and consistent nodal shares: exact fractions, and the divergence theorem on curved cells.

use crate::{ROUND_OFF, distorted_cell, kinds};
use approx::{assert_abs_diff_eq, assert_relative_eq};
use moreau_mesh::{
    Axisymmetric, CellKind, Hypothesis, Mesh, NodeKind, PlaneStrain, Solid, block2, block3, uniform,
};
use std::f64::consts::PI;

/// ∮ n dS = 0 and ∮ x·n dS = D · volume: facets close, point outwards and interpolate the cell.
fn obeys_the_divergence_theorem<const D: usize, H: Hypothesis<D>>(kind: CellKind, hypothesis: &H) {
    let mesh = distorted_cell::<D>(kind);
    let shares = mesh.facet_shares(&mesh.boundary_facets(), hypothesis);
    for i in 0..D {
        let sum: f64 = shares.iter().map(|share| share.normal[i]).sum();
        assert_abs_diff_eq!(sum, 0.0, epsilon = ROUND_OFF);
    }
    let flux: f64 = shares
        .iter()
        .map(|s| {
            (0..D)
                .map(|i| s.normal[i] * mesh.nodes()[s.node][i])
                .sum::<f64>()
        })
        .sum();
    let volume = mesh.measure(&[0], hypothesis);
    assert!(volume > 0.0);
    assert_relative_eq!(flux, D as f64 * volume, max_relative = ROUND_OFF);
}

#[test]
fn distorted_cells_obey_the_divergence_theorem() {
    for kind in kinds(2) {
        obeys_the_divergence_theorem(kind, &PlaneStrain::new(2.5).expect("valid"));
    }
    for kind in kinds(3) {
        obeys_the_divergence_theorem(kind, &Solid);
    }
}

#[test]
fn distorted_rings_obey_the_axial_divergence_theorem() {
    for kind in kinds(2) {
        let mesh = distorted_cell::<2>(kind)
            .map(|[r, z]| [r + 3.0, z])
            .expect("a shift is valid");
        let shares = mesh.facet_shares(&mesh.boundary_facets(), &Axisymmetric);
        let closure: f64 = shares.iter().map(|s| s.normal[1]).sum();
        assert_abs_diff_eq!(closure, 0.0, epsilon = 1e2 * ROUND_OFF);
        let flux: f64 = shares
            .iter()
            .map(|s| s.normal[1] * mesh.nodes()[s.node][1])
            .sum();
        assert_relative_eq!(
            flux,
            mesh.measure(&[0], &Axisymmetric),
            max_relative = 10.0 * ROUND_OFF
        );
    }
}

#[test]
fn a_straight_quadratic_edge_shares_1_4_1() {
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9] {
        let mesh = block2("b", kind, &uniform(0.0, 6.0, 1), &uniform(0.0, 2.0, 1)).expect("valid");
        let thick = PlaneStrain::new(0.5).expect("valid");
        let shares = mesh.facet_shares(mesh.facet_group("b.top").expect("named"), &thick);
        assert!(shares.is_sorted_by_key(|share| share.node));
        let expected = [
            (0.5, NodeKind::Corner),
            (2.0, NodeKind::Midside),
            (0.5, NodeKind::Corner),
        ];
        assert_eq!(shares.len(), 3);
        for (share, (area, node_kind)) in shares.iter().zip(expected) {
            assert_abs_diff_eq!(share.area, area, epsilon = ROUND_OFF);
            assert_abs_diff_eq!(share.normal[..], [0.0, area][..], epsilon = ROUND_OFF);
            assert_eq!(share.kind, node_kind);
        }
    }
}

/// What a uniform pressure asks of the nodes of a face, by their place: 4.6 of quadratic contact.
#[test]
fn a_flat_quadratic_face_shares_as_its_shape_functions_do() {
    let line = uniform(0.0, 1.0, 1);
    let shares = |kind| {
        let mesh = block3("b", kind, &line, &line, &line).expect("valid");
        let top = mesh.facet_group("b.top").expect("named");
        mesh.facet_shares(&top[..1], &Solid)
    };
    let (corner, midside, face) = (NodeKind::Corner, NodeKind::Midside, NodeKind::Face);
    for (kind, expected) in [
        (CellKind::Hex8, vec![(corner, 4, 0.25)]),
        (
            CellKind::Hex20,
            vec![(corner, 4, -1.0 / 12.0), (midside, 4, 1.0 / 3.0)],
        ),
        (
            CellKind::Hex27,
            vec![
                (corner, 4, 1.0 / 36.0),
                (midside, 4, 1.0 / 9.0),
                (face, 1, 4.0 / 9.0),
            ],
        ),
        // A triangle is half the square.
        (CellKind::Tet4, vec![(corner, 3, 1.0 / 6.0)]),
        (
            CellKind::Tet10,
            vec![(corner, 3, 0.0), (midside, 3, 1.0 / 6.0)],
        ),
    ] {
        let shares = shares(kind);
        let count: usize = expected.iter().map(|(_, count, _)| count).sum();
        assert_eq!(shares.len(), count, "{kind}");
        for (place, count, area) in expected {
            let own: Vec<_> = shares.iter().filter(|s| s.kind == place).collect();
            assert_eq!(own.len(), count, "{kind} {place:?}");
            for share in own {
                assert_abs_diff_eq!(share.area, area, epsilon = ROUND_OFF);
            }
        }
    }
}

#[test]
fn sides_have_their_area_and_outward_normal() {
    let lines = [
        uniform(0.0, 2.0, 3),
        uniform(0.0, 3.0, 2),
        uniform(0.0, 5.0, 2),
    ];
    for kind in kinds(3) {
        let mesh = block3("b", kind, &lines[0], &lines[1], &lines[2]).expect("valid");
        for (side, expected) in [
            ("left", [-15.0, 0.0, 0.0]),
            ("right", [15.0, 0.0, 0.0]),
            ("bottom", [0.0, -10.0, 0.0]),
            ("top", [0.0, 10.0, 0.0]),
            ("back", [0.0, 0.0, -6.0]),
            ("front", [0.0, 0.0, 6.0]),
        ] {
            let facets = mesh.facet_group(&format!("b.{side}")).expect("named");
            let shares = mesh.facet_shares(facets, &Solid);
            let area: f64 = shares.iter().map(|share| share.area).sum();
            let normal: [f64; 3] =
                std::array::from_fn(|i| shares.iter().map(|share| share.normal[i]).sum());
            assert_relative_eq!(
                area,
                expected.iter().map(|v: &f64| v.abs()).sum::<f64>(),
                max_relative = ROUND_OFF
            );
            assert_abs_diff_eq!(normal[..], expected[..], epsilon = 1e2 * ROUND_OFF);
        }
    }
}

#[test]
fn blocks_have_their_volume() {
    for kind in kinds(2) {
        let mesh = block2("b", kind, &uniform(1.0, 3.0, 3), &uniform(0.0, 5.0, 2)).expect("valid");
        let cells = mesh.cell_group("b").expect("named");
        let volume = mesh.measure(cells, &PlaneStrain::new(0.25).expect("valid"));
        assert_relative_eq!(volume, 2.5, max_relative = 10.0 * ROUND_OFF);
        // A hollow cylinder of radii 1 and 3 and height 5.
        let volume = mesh.measure(cells, &Axisymmetric);
        assert_relative_eq!(volume, 40.0 * PI, max_relative = 10.0 * ROUND_OFF);
    }
}

#[test]
fn volume_shares_are_exact_on_a_ring_of_triangles() {
    // ∫ N_a 2πr dA over a triangle is 2πA (2 r_a + r_b + r_c)/12.
    let nodes: Vec<[f64; 2]> = vec![[1.0, 0.0], [4.0, 0.0], [2.0, 2.0]];
    let r: Vec<f64> = nodes.iter().map(|x| x[0]).collect();
    let mesh = Mesh::new(nodes, vec![(CellKind::Tri3, vec![0, 1, 2])]).expect("valid");
    for (node, share) in mesh.volume_shares(&[0], &Axisymmetric) {
        let exact = 2.0 * PI * 3.0 * (r[node] + r.iter().sum::<f64>()) / 12.0;
        assert_relative_eq!(share, exact, max_relative = 10.0 * ROUND_OFF);
    }
}

#[test]
fn a_serendipity_cell_shares_its_volume_with_negative_corners() {
    let mesh = block2("b", CellKind::Quad8, &[0.0, 1.0], &[0.0, 12.0]).expect("valid");
    let shares = mesh.volume_shares(&[0], &PlaneStrain::default());
    for (node, share) in shares {
        let corner = mesh.cell_nodes(0)[..4].contains(&node);
        assert_abs_diff_eq!(
            share,
            if corner { -1.0 } else { 4.0 },
            epsilon = 1e2 * ROUND_OFF
        );
    }
}

/// Of bodies that need another basis where they touch: faces of hex20 and tet10, and quadratic edges
/// with an end on the axis.
#[test]
fn positive_shares_are_positive_and_carry_the_load_of_a_pressure() {
    fn check<const D: usize, H: Hypothesis<D>>(mesh: &Mesh<D>, hypothesis: &H) {
        let kind = mesh.kind(0);
        let facets = mesh.facet_group("b.bottom").expect("named");
        let consistent = mesh.facet_shares(facets, hypothesis);
        let positive = mesh.positive_shares(facets, hypothesis);
        assert!(
            positive
                .iter()
                .map(|p| p.share.node)
                .eq(consistent.iter().map(|s| s.node))
        );
        let whole: f64 = consistent.iter().map(|s| s.area).sum();
        let mut nodal = vec![0.0; mesh.nodes().len()];
        for p in &positive {
            assert!(p.share.area > 1e-3 * whole, "{kind}: {p:?}");
            assert_abs_diff_eq!(p.share.normal[1], -p.share.area, epsilon = 1e2 * ROUND_OFF);
            let sum = |x: &dyn Fn(usize) -> f64| p.own.iter().map(|&(a, w)| w * x(a)).sum::<f64>();
            assert_abs_diff_eq!(sum(&|_| 1.0), 1.0, epsilon = ROUND_OFF);
            for i in 0..D {
                let x = sum(&|a| mesh.nodes()[a][i]);
                assert_abs_diff_eq!(x, mesh.nodes()[p.share.node][i], epsilon = 10.0 * ROUND_OFF);
            }
            p.own
                .iter()
                .for_each(|&(a, w)| nodal[a] += w * p.share.area);
        }
        for share in consistent {
            assert_abs_diff_eq!(nodal[share.node], share.area, epsilon = 1e-13 * whole);
        }
    }
    let lines = uniform(0.0, 6.0, 3);
    for kind in kinds(2) {
        check(
            &block2("b", kind, &lines, &lines).expect("valid"),
            &Axisymmetric,
        );
        // On both sides of the axis: its node is the second end of one edge, the first of another.
        let turned = block2("b", kind, &lines, &lines)
            .and_then(|m| m.map(|[x, y]| [6.0 - x, 6.0 - y]))
            .expect("valid");
        let top = turned.facet_group("b.top").expect("named");
        let axis = turned.positive_shares(top, &Axisymmetric);
        assert!(axis.iter().all(|p| p.share.area > 0.0), "{kind}");
    }
    for kind in kinds(3) {
        check(
            &block3("b", kind, &lines, &lines, &lines).expect("valid"),
            &Solid,
        );
    }
}

/// ∫ N_a 2πr dr from the axis to h, A = πh², with a fifth of the middle at either end.
#[test]
fn a_quadratic_edge_at_the_axis_shares_as_its_changed_basis_does() {
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9] {
        let mesh = block2("b", kind, &uniform(0.0, 6.0, 3), &[0.0, 1.0]).expect("valid");
        let facets = mesh.facet_group("b.bottom").expect("named");
        let area = PI * 4.0;
        // The edge beside has shares of its own: r from h to 2h.
        let edge = [2.0 / 15.0, 2.0 / 5.0, 7.0 / 15.0 + 1.0 / 3.0];
        let positive = mesh.positive_shares(facets, &Axisymmetric);
        for (p, part) in positive.iter().zip(edge) {
            assert_relative_eq!(p.share.area, part * area, max_relative = 1e-13);
        }
        // Elsewhere nothing is changed, nor where there is no axis.
        let consistent = mesh.facet_shares(facets, &Axisymmetric);
        for (p, share) in positive.iter().zip(consistent).skip(3) {
            assert_eq!((p.share, p.own.len()), (share, 1));
        }
        let plane = mesh.positive_shares(facets, &PlaneStrain::default());
        assert!(plane.iter().all(|p| p.own == [(p.share.node, 1.0)]));
    }
}
