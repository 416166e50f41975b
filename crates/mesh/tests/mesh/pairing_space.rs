//! Pairing of surfaces in space that do not match, wholly and partly covered, flat and curved.

use super::{facets, sum};
use moreau_mesh::{CellKind, Mesh, MortarRow, MultiplierChoices, Pairing, Solid, block3, uniform};
use std::collections::BTreeMap;

/// Sides of the footprint along x and z.
const SIDES: [f64; 2] = [6.0, 5.0];

/// A block on the plane y = 0, above it or below, of n × m cells in its footprint, which f maps.
fn body(
    name: &str,
    kind: CellKind,
    cells: [usize; 2],
    f: impl Fn([f64; 2]) -> [f64; 2],
) -> Mesh<3> {
    let y = if name == "upper" {
        [0.0, 1.0]
    } else {
        [-1.0, 0.0]
    };
    let [x, z] = [0, 1].map(|i| uniform(0.0, SIDES[i], cells[i]));
    block3(name, kind, &x, &uniform(y[0], y[1], 1), &z)
        .and_then(|m| {
            m.map(|[x, y, z]| {
                let [x, z] = f([x, z]);
                [x, y, z]
            })
        })
        .expect("valid")
}

/// Grid lines bent within the footprint.
fn bent([x, z]: [f64; 2]) -> [f64; 2] {
    let bump = |v: f64, side: f64| (std::f64::consts::PI * v / side).sin();
    let both = bump(x, SIDES[0]) * bump(z, SIDES[1]);
    [x + 0.5 * both, z - 0.4 * both]
}

/// About the middle of the footprint.
fn turned(angle: f64, scale: [f64; 2]) -> impl Fn([f64; 2]) -> [f64; 2] {
    move |[x, z]| {
        let (s, c) = angle.sin_cos();
        let [x, z] = [
            scale[0] * (x - 0.5 * SIDES[0]),
            scale[1] * (z - 0.5 * SIDES[1]),
        ];
        [
            0.5 * SIDES[0] + c * x - s * z,
            0.5 * SIDES[1] + s * x + c * z,
        ]
    }
}

fn pair(mesh: &Mesh<3>, pairing: Pairing) -> Vec<MortarRow<3>> {
    let group = |name| mesh.facet_group(name).expect("named");
    mesh.mortar_rows(
        mesh.nodes(),
        (group("upper.bottom"), group("lower.top")),
        pairing,
        &Solid,
    )
}

const KINDS: [[CellKind; 2]; 9] = [
    [CellKind::Hex8, CellKind::Hex8],
    [CellKind::Hex8, CellKind::Tet4],
    [CellKind::Tet4, CellKind::Hex8],
    [CellKind::Tet4, CellKind::Tet4],
    [CellKind::Hex20, CellKind::Hex8],
    [CellKind::Hex20, CellKind::Hex20],
    [CellKind::Hex27, CellKind::Tet10],
    [CellKind::Tet10, CellKind::Hex20],
    [CellKind::Hex8, CellKind::Hex27],
];

/// What holds for any overlap of flat surfaces: sums of weights, linear fields, area. Returns the
/// forces of a unit pressure on the lower body.
fn check(mesh: &Mesh<3>, area: f64, what: &str) -> BTreeMap<usize, f64> {
    let mut on_lower: BTreeMap<usize, f64> = BTreeMap::new();
    let mut total = 0.0;
    for c in pair(mesh, Pairing::Mortar) {
        assert!(c.area > 0.0, "{what}");
        assert!((c.normal[1] - 1.0).abs() < 1e-14);
        assert!((sum(&c.own, |_| 1.0) - 1.0).abs() < 1e-12);
        assert!((sum(&c.opposite, |_| 1.0) - 1.0).abs() < 1e-12);
        for i in 0..3 {
            let x = |a: usize| mesh.nodes()[a][i];
            let apart = sum(&c.own, x) - sum(&c.opposite, x);
            assert!(apart.abs() < 1e-10, "{what}: {apart:.2e}");
        }
        total += c.area;
        for &(b, w) in &c.opposite {
            *on_lower.entry(b).or_insert(0.0) += w * c.area;
        }
    }
    let off = (total / area - 1.0).abs();
    assert!(off < 1e-12, "{what}: area off by {off:.2e}");
    on_lower
}

#[test]
fn linear_fields_and_a_uniform_pressure_pass_between_faces_that_do_not_match() {
    let shift = 2f64.sqrt() / 10.0;
    type Map = Box<dyn Fn([f64; 2]) -> [f64; 2]>;
    let whole = SIDES[0] * SIDES[1];
    let scaled =
        |x: [f64; 2]| -> Map { Box::new(move |[s, t]| [x[0] + (x[1] - x[0]) * s / SIDES[0], t]) };
    // Lower cells, their map, and the area of the overlap.
    let lowers: Vec<([usize; 2], Map, f64)> = vec![
        ([5, 4], Box::new(|x| x), whole),
        ([5, 2], Box::new(bent), whole),
        ([7, 5], scaled([-1.0 - shift, 7.0 + shift]), whole),
        ([6, 5], scaled([1.0 + shift, 7.0]), (5.0 - shift) * SIDES[1]),
        ([11, 3], scaled([0.1, 5.95]), 5.85 * SIDES[1]),
        ([2, 2], scaled([2.1, 2.4]), 0.3 * SIDES[1]),
        // Turned: covers all, or lies within.
        ([7, 6], Box::new(turned(0.4, [2.0, 2.0])), whole),
        ([3, 4], Box::new(turned(0.4, [0.5, 0.5])), 0.25 * whole),
        ([1, 1], Box::new(turned(1.0, [0.05, 0.1])), 0.005 * whole),
    ];
    for kinds in KINDS {
        for (case, (cells, map, area)) in lowers.iter().enumerate() {
            for curved in [false, true] {
                let straight = |k: CellKind| k.nodes() == k.corner_count();
                if !kinds.into_iter().all(straight) && (curved || case == 1) {
                    // The sides of a face are taken to be straight.
                    continue;
                }
                let upper = if curved { bent } else { |x| x };
                let mesh = body("upper", kinds[0], [4, 3], upper)
                    .joined(body("lower", kinds[1], *cells, map))
                    .expect("valid");
                let what = format!("{kinds:?}, case {case}, {curved}");
                let on_lower = check(&mesh, *area, &what);
                // The lower face feels the consistent load of the pressure where all of it is covered.
                let facets = mesh.facet_group("lower.top").expect("named");
                let shares = mesh.facet_shares(facets, &Solid);
                if (shares.iter().map(|s| s.area).sum::<f64>() / area - 1.0).abs() < 1e-9 {
                    for share in shares {
                        // Corners may have a negative share, or none.
                        let found = on_lower.get(&share.node).copied().unwrap_or(0.0);
                        let off = (found - share.area).abs() * facets.len() as f64 / area;
                        assert!(off < 1e-10, "{what}: load off by {off:.2e}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_node_on_a_face_that_matches_meets_its_twin_alone() {
    for kind in [CellKind::Hex8, CellKind::Tet4] {
        let wavy = |[x, y, z]: [f64; 3]| [x, y + 0.2 * (0.5 * x).sin() + 0.1 * z.cos(), z];
        // Tetrahedra cut both sides along the same diagonals.
        let mesh = body("upper", kind, [4, 4], bent)
            .joined(body("lower", kind, [4, 4], bent))
            .and_then(|m| m.map(wavy))
            .expect("valid");
        for pairing in [Pairing::Mortar, Pairing::NodeToSurface] {
            let mortar_rows = pair(&mesh, pairing);
            assert_eq!(mortar_rows.len(), 25);
            for c in mortar_rows {
                assert!(c.own.len() == 1 && c.own[0].0 == c.node);
                for (b, w) in c.opposite {
                    let (x, y) = (mesh.nodes()[b], mesh.nodes()[c.node]);
                    let same = (0..3).all(|i| (x[i] - y[i]).abs() < 1e-12);
                    let exact = f64::from(u8::from(same));
                    assert!((w - exact).abs() < 1e-8, "{kind} {pairing:?}: {w} at {y:?}");
                }
            }
        }
    }
}

/// A gap between cylinders of one axis is the same everywhere, also where a mesh ends at a plane of
/// symmetry: normals of quadratic faces miss the radius by less than a thousandth of the angle that a
/// cell turns by.
#[test]
fn gaps_and_normals_between_curved_faces_are_those_of_the_surfaces() {
    const GAP: f64 = 0.02;
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        let ring = |name: &str, n: usize, radii: [f64; 2]| {
            let angle = uniform(0.0, 1.2, n);
            let line = |a: [f64; 2]| uniform(a[0], a[1], 1);
            block3(name, kind, &line(radii), &angle, &line([0.0, 0.4]))
                .and_then(|m| m.map(|[r, a, z]| [r * a.cos(), r * a.sin(), z]))
                .expect("valid")
        };
        let mesh = ring("outer", 16, [2.0 + GAP, 3.0])
            .joined(ring("inner", 13, [1.0, 2.0]))
            .expect("valid");
        let group = |name| mesh.facet_group(name).expect("named");
        let surfaces = (group("outer.left"), group("inner.right"));
        for c in mesh.mortar_rows(mesh.nodes(), surfaces, Pairing::Mortar, &Solid) {
            let [x, y, _] = mesh.nodes()[c.node];
            let lean = (c.normal[0] * y - c.normal[1] * x) / x.hypot(y);
            assert!(
                lean.abs() < 1e-3 * 1.2 / 16.0,
                "{kind}: {lean:.1e} at {x}, {y}"
            );
            // Both sides in one mean of the normals' direction.
            let along = |w: &[(usize, f64)]| {
                sum(w, |a| {
                    let [x, y, _] = mesh.nodes()[a];
                    c.normal[0] * x + c.normal[1] * y
                })
            };
            let radial = |w: &[(usize, f64)]| {
                sum(w, |a| {
                    let [x, y, _] = mesh.nodes()[a];
                    (c.normal[0] * x + c.normal[1] * y) / x.hypot(y)
                })
            };
            let gap = along(&c.own) - along(&c.opposite);
            let exact = GAP * radial(&c.own);
            let off = (gap - exact).abs() / GAP;
            assert!(off < 1e-3, "{kind}: gap off by {off:.1e} at {x}, {y}");
        }
    }
}

/// Two tubes: the far side and the back of a surface are not met.
#[test]
fn a_tube_meets_the_near_side_of_the_tube_within() {
    let tube = |name: &str, n: usize, length: usize, radii: [f64; 2]| {
        let half = |name: &str, from: f64| {
            let angle = uniform(from, from + std::f64::consts::PI, n);
            let z = uniform(0.0, 3.0, length);
            block3(
                name,
                CellKind::Hex8,
                &uniform(radii[0], radii[1], 1),
                &angle,
                &z,
            )
            .and_then(|m| m.map(|[r, a, z]| [r * a.cos(), r * a.sin(), z]))
            .expect("valid")
        };
        half(&format!("{name}1"), 0.0).joined(half(&format!("{name}2"), std::f64::consts::PI))
    };
    let mesh = tube("outer", 16, 4, [2.0, 3.0])
        .and_then(|outer| outer.joined(tube("inner", 13, 3, [1.0, 1.98])?))
        .expect("valid");
    let surfaces = (
        facets(&mesh, ["outer1.left", "outer2.left"]),
        facets(&mesh, ["inner1.right", "inner2.right"]),
    );
    for pairing in [Pairing::Mortar, Pairing::NodeToSurface] {
        let mortar_rows =
            mesh.mortar_rows(mesh.nodes(), (&surfaces.0, &surfaces.1), pairing, &Solid);
        // The joints of the half tubes have a node of each half.
        assert_eq!(mortar_rows.len(), 2 * 17 * 5, "{pairing:?}");
        for c in mortar_rows {
            let at = |w: &[(usize, f64)]| [0, 1, 2].map(|i| sum(w, |a| mesh.nodes()[a][i]));
            let (own, other) = (at(&c.own), at(&c.opposite));
            let gap: f64 = (0..3).map(|i| (own[i] - other[i]) * c.normal[i]).sum();
            // A chord of the inner tube lies lower by at most 0.0144, one of the outer by 0.0096.
            assert!(gap > 0.005 && gap < 0.04, "{pairing:?}: {gap}");
        }
    }
}

/// Shares are those of the warped faces themselves, not of what is seen of them along their mean normals.
#[test]
fn warped_faces_have_the_area_of_their_surface() {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27] {
        let mesh = body("upper", kind, [2, 2], |x| x)
            .joined(body("lower", kind, [2, 2], |x| x))
            .and_then(|m| m.map(|[x, y, z]| [x, y + 0.1 * (x - 3.0) * (z - 2.5), z]))
            .expect("valid");
        let facets = mesh.facet_group("upper.bottom").expect("named");
        let exact: f64 = mesh
            .facet_shares(facets, &Solid)
            .iter()
            .map(|s| s.area)
            .sum();
        let flat = SIDES[0] * SIDES[1];
        assert!(exact > 1.02 * flat, "{kind}: {exact}");
        let found: f64 = pair(&mesh, Pairing::Mortar).iter().map(|c| c.area).sum();
        assert!(
            (found / exact - 1.0).abs() < 1e-4,
            "{kind}: {found} {exact}"
        );
    }
}

/// Of two layers that face a body the nearer one is met, whatever their order.
#[test]
fn of_two_layers_the_nearer_is_met() {
    let upper = body("upper", CellKind::Hex8, [3, 2], |x| x);
    for (near, far) in [("first", "second"), ("second", "first")] {
        let mut mesh = upper.clone();
        for name in ["first", "second"] {
            let top = if name == near { -0.1 } else { -0.7 };
            let [x, z] = [0, 1].map(|i| uniform(0.0, SIDES[i], 4));
            let layer = block3(name, CellKind::Hex8, &x, &uniform(top - 0.2, top, 1), &z);
            mesh = mesh.joined(layer.expect("valid")).expect("valid");
        }
        let tops = ["first.top", "second.top"].map(|n| mesh.facet_group(n).expect("named"));
        let own = mesh.facet_group("upper.bottom").expect("named");
        let mortar_rows =
            mesh.mortar_rows(mesh.nodes(), (own, &tops.concat()), Pairing::Mortar, &Solid);
        assert_eq!(mortar_rows.len(), 12);
        let met = mesh.node_group(&format!("{near}.top")).expect("named");
        for c in mortar_rows {
            let only = c.opposite.iter().all(|(b, _)| met.binary_search(b).is_ok());
            assert!(only, "{far} is met behind {near}");
        }
    }
}

/// The end of a surface that moves to and fro past the nodes of another: what has a multiplier keeps it as long as it is
/// near, whatever the cells; what it leaves is as if it had never been there.
#[test]
fn nodes_keep_their_multipliers_while_the_end_of_a_surface_passes() {
    for kind in [
        CellKind::Hex8,
        CellKind::Hex20,
        CellKind::Tet4,
        CellKind::Tet10,
    ] {
        let mesh = body("upper", kind, [3, 2], |x| x)
            .joined(body("lower", CellKind::Hex8, [4, 3], |x| x))
            .expect("valid");
        let [own, other] =
            ["upper.bottom", "lower.top"].map(|name| mesh.facet_group(name).expect("named"));
        let of_lower = mesh.node_group("lower").expect("named");
        // How far the end at x = 6 is before the nodes at x = 4, over the side of a facet, 2.
        let rows = |before: f64, kept: &mut MultiplierChoices| {
            let moved = 2.0 + 2.0 * before;
            let place = |(a, x): (usize, &[f64; 3])| match of_lower.binary_search(&a) {
                Ok(_) => [x[0] - moved, x[1], x[2]],
                Err(_) => *x,
            };
            let positions: Vec<[f64; 3]> = mesh.nodes().iter().enumerate().map(place).collect();
            mesh.mortar_rows_keeping(&positions, (own, other), Pairing::Mortar, &Solid, kept)
        };
        let beyond = |rows: &[MortarRow<3>]| {
            rows.iter()
                .filter(|c| (mesh.nodes()[c.node][0] - 4.0).abs() < 1e-9)
                .count()
        };
        let none = MultiplierChoices::default;
        let (near, far) = (rows(0.06, &mut none()), rows(0.2, &mut none()));
        assert!(beyond(&near) > 0, "{kind}");
        assert_eq!(beyond(&far), 0, "{kind}");
        let mut kept = none();
        assert_eq!(rows(0.06, &mut kept), near, "{kind}");
        assert_eq!(beyond(&rows(0.2, &mut kept)), beyond(&near), "{kind}");
        // Beyond what keeps one, and beyond the whole facet.
        for gone in [0.4, 1.1] {
            rows(0.06, &mut kept);
            assert_eq!(beyond(&rows(gone, &mut kept)), 0, "{kind}");
            assert_eq!(rows(0.2, &mut kept), far, "{kind}");
        }
    }
}

/// A node below the middle of a crease, which lines across neither of the facets beside it meet: as deep as it is below the
/// crease, and not as far as the nearest corner is.
#[test]
fn a_node_below_a_crease_is_as_deep_as_it_is_below_that() {
    let kind = CellKind::Hex8;
    for quadratic in [false, true] {
        let kind = if quadratic { CellKind::Hex20 } else { kind };
        let valley = |[x, y, z]: [f64; 3]| [x, y + 0.1 * (x - 3.0).abs(), z];
        let mesh = body("upper", CellKind::Hex8, [2, 4], |x| x)
            .joined(body("lower", kind, [2, 1], |x| x))
            .and_then(|m| m.map(valley))
            .expect("valid");
        let of_upper = mesh.node_group("upper").expect("named");
        let sunk = |(a, x): (usize, &[f64; 3])| match of_upper.binary_search(&a) {
            Ok(_) => [x[0], x[1] - 0.002, x[2]],
            Err(_) => *x,
        };
        let positions: Vec<[f64; 3]> = mesh.nodes().iter().enumerate().map(sunk).collect();
        let [own, other] =
            ["upper.bottom", "lower.top"].map(|name| mesh.facet_group(name).expect("named"));
        let (node, depth, _) = mesh.overlap(&positions, (own, other)).expect("sunk");
        assert!(
            (depth - 0.002).abs() < 1e-9,
            "{depth} at {:?}",
            mesh.nodes()[node]
        );
    }
}
