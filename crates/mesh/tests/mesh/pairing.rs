//! Pairing of surfaces that do not match, straight and curved, wholly and partly covered.

use super::{facets, sum};
use moreau_mesh::{
    Axisymmetric, CellKind, Hypothesis, Mesh, MortarRow, MultiplierChoices, Pairing, PlaneStrain,
    block2, uniform,
};
use std::collections::BTreeMap;

/// Two blocks, the upper on the lower, mapped by f.
fn stack(
    kinds: [CellKind; 2],
    upper: (f64, f64, usize),
    lower: (f64, f64, usize),
    f: impl Fn([f64; 2]) -> [f64; 2],
) -> Mesh<2> {
    let block = |name, kind, (from, to, n): (f64, f64, usize), y: [f64; 2]| {
        block2(name, kind, &uniform(from, to, n), &uniform(y[0], y[1], 1)).expect("valid")
    };
    block("upper", kinds[0], upper, [0.0, 1.0])
        .joined(block("lower", kinds[1], lower, [-1.0, 0.0]))
        .and_then(|m| m.map(f))
        .expect("valid")
}

fn pair(mesh: &Mesh<2>, pairing: Pairing) -> Vec<MortarRow<2>> {
    pair_under(mesh, pairing, &PlaneStrain::default())
}

fn pair_under(
    mesh: &Mesh<2>,
    pairing: Pairing,
    hypothesis: &impl Hypothesis<2>,
) -> Vec<MortarRow<2>> {
    let group = |name| mesh.facet_group(name).expect("named");
    mesh.mortar_rows(
        mesh.nodes(),
        (group("upper.bottom"), group("lower.top")),
        pairing,
        hypothesis,
    )
}

const KINDS: [[CellKind; 2]; 4] = [
    [CellKind::Quad4, CellKind::Quad4],
    [CellKind::Quad8, CellKind::Quad8],
    [CellKind::Quad8, CellKind::Tri3],
    [CellKind::Tri6, CellKind::Quad9],
];

#[test]
fn linear_fields_and_a_uniform_pressure_pass_between_meshes_that_do_not_match() {
    let shift = 2f64.sqrt() / 10.0;
    // Overlap of [0, 6] with the lower block.
    for (lower, overlap) in [
        ((0.0, 6.0, 5), [0.0, 6.0]),
        ((-1.0 - shift, 7.0 + shift, 7), [0.0, 6.0]),
        ((1.0 + shift, 7.0, 6), [1.0 + shift, 6.0]),
        ((0.1, 5.95, 11), [0.1, 5.95]),
        // Narrower than one edge.
        ((2.1, 2.4, 2), [2.1, 2.4]),
    ] {
        for kinds in KINDS {
            let mesh = stack(kinds, (0.0, 6.0, 4), lower, |x| x);
            let mortar_rows = pair(&mesh, Pairing::Mortar);
            let x = |a: usize| mesh.nodes()[a][0];
            let mut on_lower: BTreeMap<usize, f64> = BTreeMap::new();
            let mut total = [0.0; 2];
            for c in &mortar_rows {
                assert!(c.area > 0.0, "{kinds:?} {lower:?}");
                assert!((c.normal[1] - 1.0).abs() < 1e-14);
                assert!((sum(&c.own, |_| 1.0) - 1.0).abs() < 1e-12);
                assert!((sum(&c.opposite, |_| 1.0) - 1.0).abs() < 1e-12);
                let apart = sum(&c.own, x) - sum(&c.opposite, x);
                assert!(apart.abs() < 1e-11, "{kinds:?} {lower:?}: {apart}");
                total[0] += c.area;
                total[1] += c.area * sum(&c.own, x);
                for &(b, w) in &c.opposite {
                    *on_lower.entry(b).or_insert(0.0) += w * c.area;
                }
            }
            let [from, to] = overlap;
            let exact = [to - from, 0.5 * (to * to - from * from)];
            assert!((total[0] - exact[0]).abs() < 1e-12 * exact[0]);
            assert!((total[1] - exact[1]).abs() < 1e-11 * exact[1]);
            // Where the lower block is covered wholly it feels the consistent load of a pressure.
            if from > 0.0 && to < 6.0 {
                let facets = mesh.facet_group("lower.top").expect("named");
                for share in mesh.facet_shares(facets, &PlaneStrain::default()) {
                    let found = on_lower[&share.node];
                    assert!((found - share.area).abs() < 1e-12, "{found} {}", share.area);
                }
            }
        }
    }
}

/// Every node of a disc on another has a share, that on the axis as well, and the other disc feels the
/// consistent load of a pressure.
#[test]
fn linear_fields_and_a_uniform_pressure_pass_at_the_axis() {
    for kinds in KINDS {
        for kinds in [kinds, [kinds[1], kinds[0]]] {
            for lower in [4, 3, 7] {
                let mesh = stack(kinds, (0.0, 6.0, 4), (0.0, 6.0, lower), |x| x);
                let own = mesh.node_group("upper.bottom").expect("named");
                let facets = mesh.facet_group("upper.bottom").expect("named");
                let shares = mesh.positive_shares(facets, &Axisymmetric);
                for pairing in [Pairing::Mortar, Pairing::NodeToSurface] {
                    let what = format!("{kinds:?} {lower} {pairing:?}");
                    let mortar_rows = pair_under(&mesh, pairing, &Axisymmetric);
                    assert!(mortar_rows.iter().map(|c| &c.node).eq(&own), "{what}");
                    let x = |a: usize| mesh.nodes()[a][0];
                    let mut on_lower: BTreeMap<usize, f64> = BTreeMap::new();
                    for (c, p) in mortar_rows.iter().zip(&shares) {
                        assert!((c.area / p.share.area - 1.0).abs() < 1e-11, "{what}");
                        let apart = sum(&c.own, x) - sum(&c.opposite, x);
                        assert!(apart.abs() < 1e-11, "{what}: {apart}");
                        for &(b, w) in &c.opposite {
                            *on_lower.entry(b).or_insert(0.0) += w * c.area;
                        }
                    }
                    let facets = mesh.facet_group("lower.top").expect("named");
                    for share in mesh.facet_shares(facets, &Axisymmetric) {
                        let found = on_lower.get(&share.node).copied().unwrap_or(0.0);
                        let off = (found - share.area).abs();
                        assert!(off < 1e-11 || pairing != Pairing::Mortar, "{what}: {off}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_node_on_an_edge_that_matches_meets_its_twin_alone() {
    for kinds in [KINDS[0], KINDS[1]] {
        let curved = |[x, y]: [f64; 2]| [x + 0.1 * y, y + 0.2 * (0.5 * x).sin()];
        let mesh = stack(kinds, (0.0, 6.0, 4), (0.0, 6.0, 4), curved);
        for pairing in [Pairing::Mortar, Pairing::NodeToSurface] {
            let mortar_rows = pair(&mesh, pairing);
            assert_eq!(
                mortar_rows.len(),
                mesh.node_group("upper.bottom").expect("named").len()
            );
            for c in mortar_rows {
                assert!(c.own.len() == 1 && c.own[0].0 == c.node);
                assert!((c.own[0].1 - 1.0).abs() < 1e-14);
                for (b, w) in c.opposite {
                    let x = mesh.nodes();
                    let same = (x[b][0] - x[c.node][0]).hypot(x[b][1] - x[c.node][1]) < 1e-12;
                    assert!((w - f64::from(u8::from(same))).abs() < 1e-8, "{w}");
                }
            }
        }
    }
}

/// Two rings: the far side and the back of a surface are not met.
#[test]
fn a_ring_meets_the_near_side_of_the_ring_within() {
    let ring = |name: &str, n: usize, radii: [f64; 2]| {
        let half = |name: &str, from: f64| {
            let angle = uniform(from, from + std::f64::consts::PI, n);
            block2(
                name,
                CellKind::Quad8,
                &uniform(radii[0], radii[1], 1),
                &angle,
            )
            .and_then(|m| m.map(|[r, a]| [r * a.cos(), r * a.sin()]))
            .expect("valid")
        };
        half(&format!("{name}1"), 0.0).joined(half(&format!("{name}2"), std::f64::consts::PI))
    };
    let outer = ring("outer", 11, [2.0, 3.0]).expect("valid");
    let mesh = outer
        .joined(ring("inner", 8, [1.0, 1.99]).expect("valid"))
        .expect("valid");
    let surfaces = (
        facets(&mesh, ["outer1.left", "outer2.left"]),
        facets(&mesh, ["inner1.right", "inner2.right"]),
    );
    for pairing in [Pairing::Mortar, Pairing::NodeToSurface] {
        let mortar_rows = mesh.mortar_rows(
            mesh.nodes(),
            (&surfaces.0, &surfaces.1),
            pairing,
            &PlaneStrain::default(),
        );
        // The joints of the half rings have a node of each half.
        assert_eq!(mortar_rows.len(), 2 * 23);
        for c in mortar_rows {
            let at =
                |weights: &[(usize, f64)]| [0, 1].map(|i| sum(weights, |a| mesh.nodes()[a][i]));
            let (own, other) = (at(&c.own), at(&c.opposite));
            let gap = (own[0] - other[0]) * c.normal[0] + (own[1] - other[1]) * c.normal[1];
            assert!((gap - 0.01).abs() < 3e-3, "{pairing:?}: {gap}");
        }
    }
}

/// Of two layers that face a body the nearer one is met, whatever their order; where it ends, the other.
#[test]
fn of_two_layers_the_nearer_is_met() {
    for (near, far) in [("first", "second"), ("second", "first")] {
        let layer = |name: &str, width: f64, top: f64| {
            block2(
                name,
                CellKind::Quad8,
                &uniform(0.0, width, 5),
                &uniform(top - 0.1, top, 1),
            )
        };
        let upper = block2(
            "upper",
            CellKind::Quad8,
            &uniform(0.0, 6.0, 4),
            &uniform(0.0, 1.0, 1),
        );
        let mut mesh = upper.expect("valid");
        for name in ["first", "second"] {
            let (width, top) = if name == near {
                (3.0, -0.05)
            } else {
                (6.0, -0.4)
            };
            mesh = mesh
                .joined(layer(name, width, top).expect("valid"))
                .expect("valid");
        }
        let tops = ["first.top", "second.top"].map(|n| mesh.facet_group(n).expect("named"));
        let own = mesh.facet_group("upper.bottom").expect("named");
        let mortar_rows = mesh.mortar_rows(
            mesh.nodes(),
            (own, &tops.concat()),
            Pairing::Mortar,
            &PlaneStrain::default(),
        );
        assert_eq!(mortar_rows.len(), 9);
        let met = mesh.node_group(&format!("{near}.top")).expect("named");
        for c in mortar_rows {
            let share: f64 = c
                .opposite
                .iter()
                .filter(|(b, _)| met.binary_search(b).is_ok())
                .map(|o| o.1)
                .sum();
            let x = mesh.nodes()[c.node][0];
            let expected = if x < 2.9 {
                1.0
            } else if x > 3.1 {
                0.0
            } else {
                share
            };
            assert!(
                (share - expected).abs() < 1e-12,
                "{far} behind {near} at {x}: {share}"
            );
        }
    }
}

/// A surface that slides past the end of the other: a node that is beyond it by up to an eighth of a facet has a
/// multiplier, and keeps the one that it has up to a quarter; all pass linear fields.
#[test]
fn a_node_goes_farther_to_lose_its_multiplier_than_to_gain_it() {
    let block = |name, from: f64, y: [f64; 2]| {
        let (x, y) = (uniform(from, from + 6.0, 6), uniform(y[0], y[1], 1));
        block2(name, CellKind::Quad4, &x, &y).expect("valid")
    };
    let upper = block("upper", 0.0, [0.0, 1.0]);
    let mesh = upper.joined(block("lower", -3.0, [-1.0, 0.0]));
    let mesh = mesh.expect("valid");
    let [own, other] =
        ["upper.bottom", "lower.top"].map(|name| mesh.facet_group(name).expect("named"));
    // The node that is beyond the lower body where that has moved to the left.
    let (beyond, hypothesis) = ([3.0, 0.0], PlaneStrain::default());
    let mut kept = MultiplierChoices::default();
    for (moved, fresh, sliding) in [
        (0.20, false, false),
        (0.12, true, true),
        (0.20, false, true),
        (0.26, false, false),
        (0.20, false, false),
        (0.12, true, true),
    ] {
        let of_lower = mesh.node_group("lower").expect("named");
        let positions: Vec<[f64; 2]> = (mesh.nodes().iter().enumerate())
            .map(|(a, x)| match of_lower.binary_search(&a) {
                Ok(_) => [x[0] - moved, x[1]],
                Err(_) => *x,
            })
            .collect();
        let rows_of = |kept: &mut MultiplierChoices| {
            mesh.mortar_rows_keeping(&positions, (own, other), Pairing::Mortar, &hypothesis, kept)
        };
        let has = |rows: &[MortarRow<2>]| rows.iter().any(|c| mesh.nodes()[c.node] == beyond);
        assert_eq!(
            has(&rows_of(&mut MultiplierChoices::default())),
            fresh,
            "{moved}"
        );
        let rows = rows_of(&mut kept);
        assert_eq!(has(&rows), sliding, "{moved}, sliding");
        let area: f64 = rows.iter().map(|c| c.area).sum();
        assert!((area - (3.0 - moved)).abs() < 1e-12, "{area}");
        for c in rows {
            let [mine, met] = [&c.own, &c.opposite].map(|w| sum(w, |a| positions[a][0]));
            assert!((mine - met).abs() < 1e-12, "{mine} {met}");
        }
    }
}

/// The corner of a block over a floor, with a wall at a distance: it is opposite to what is near, which its side looks
/// straight at, or to both, with the normal between them.
#[test]
fn a_corner_faces_what_is_near_or_what_is_on_both_sides() {
    let corner_after = |apart: f64, tilt: f64, pairing: Pairing, choices: &mut _| {
        let block = |name, x: [f64; 2], y: [f64; 2]| {
            let kind = CellKind::Quad4;
            block2(name, kind, &uniform(x[0], x[1], 4), &uniform(y[0], y[1], 4)).expect("valid")
        };
        let right = 2.0 + apart;
        let mesh = block("body", [0.0, 2.0], [0.0, 2.0])
            .joined(block("floor", [-1.0, 4.0], [-1.0, 0.0]))
            .and_then(|m| m.joined(block("wall", [right, right + 1.0], [-0.1, 3.0])))
            // The side of the body leans over the floor.
            .and_then(|m| {
                m.map(|[x, y]| match x > 1.9 && x < 2.1 && y > 0.0 {
                    true => [x + tilt * y, y],
                    false => [x, y],
                })
            })
            .expect("valid");
        let group = |name| mesh.facet_group(name).expect("named");
        let own = [group("body.bottom"), group("body.right")].concat();
        let other = [group("floor.top"), group("wall.left")].concat();
        let (sides, hypothesis) = ((&own[..], &other[..]), PlaneStrain::default());
        let rows = mesh.mortar_rows_keeping(mesh.nodes(), sides, pairing, &hypothesis, choices);
        let at = |a: usize| mesh.nodes()[a];
        let row = rows.iter().find(|row| at(row.node) == [2.0, 0.0]);
        let row = row.expect("the corner has a row").clone();
        let opposite = [0, 1].map(|i| sum(&row.opposite, |a| at(a)[i]));
        (row.normal, opposite)
    };
    let corner = |apart, tilt, pairing| {
        corner_after(apart, tilt, pairing, &mut MultiplierChoices::default())
    };
    for pairing in [Pairing::Mortar, Pairing::NodeToSurface] {
        // Alone on the floor, its side upright or leaning over it.
        for tilt in [0.0, 0.3, 0.8] {
            let (normal, opposite) = corner(9.0, tilt, pairing);
            assert!(
                (normal[1] - 1.0).abs() < 1e-12,
                "{pairing:?} {tilt}: {normal:?}"
            );
            assert!(
                opposite[1].abs() < 1e-12,
                "{pairing:?} {tilt}: {opposite:?}"
            );
        }
        // A wall beside it that is not touched.
        let (normal, opposite) = corner(0.4, 0.0, pairing);
        assert!((normal[1] - 1.0).abs() < 1e-12, "{pairing:?}: {normal:?}");
        assert!(opposite[1].abs() < 1e-12, "{pairing:?}: {opposite:?}");
    }
    let (normal, _) = corner(0.0, 0.0, Pairing::Mortar);
    let half = 0.5f64.sqrt();
    assert!(
        (normal[0] + half).abs() < 1e-12 && (normal[1] - half).abs() < 1e-12,
        "{normal:?}"
    );
    // Facets are 0.5 long: of both at 0.05, and as long as that is kept, at 0.1.
    let mut kept = MultiplierChoices::default();
    for (apart, fresh, sliding) in [
        (0.08, false, false),
        (0.04, true, true),
        (0.08, false, true),
        (0.12, false, false),
    ] {
        let has_wall = |(normal, _): ([f64; 2], [f64; 2])| normal[0] < -0.1;
        let now = corner(apart, 0.0, Pairing::Mortar);
        let after = corner_after(apart, 0.0, Pairing::Mortar, &mut kept);
        assert_eq!([now, after].map(has_wall), [fresh, sliding], "{apart}");
    }
}

/// A wall beside a hill of which the flat top goes on far behind: what is 6 mm away is not opposite to a facet that has
/// something at 0.3 mm, and no weights make a gap of bodies that are apart negative.
#[test]
fn gaps_of_a_wall_to_a_hill_beside_it_are_those_to_its_slope() {
    let block = |name, x: Vec<f64>, y: Vec<f64>| block2(name, CellKind::Quad8, &x, &y);
    for step in 0..40 {
        let up = 0.05 * f64::from(step);
        let top = |x: f64| 1.0 - 0.8 * ((0.25 - x) / 0.3).exp() - 0.2 * ((0.25 - x) / 4.0).exp();
        let hill = |[x, y]: [f64; 2]| [x, y + (1.0 + y) * (up + top(x))];
        let mesh = block("hill", uniform(0.25, 7.25, 14), vec![-1.0, 0.0])
            .and_then(|m| m.map(hill))
            .and_then(|m| m.joined(block("wall", vec![-1.0, 0.0], uniform(0.0, 4.0, 6))?))
            .expect("valid");
        let group = |name| mesh.facet_group(name).expect("named");
        let sides = (group("wall.right"), group("hill.top"));
        let hypothesis = PlaneStrain::default();
        let rows = mesh.mortar_rows(mesh.nodes(), sides, Pairing::Mortar, &hypothesis);
        assert!(!rows.is_empty(), "{up}");
        for row in rows {
            let [own, met] = [&row.own, &row.opposite].map(|w| sum(w, |a| mesh.nodes()[a][0]));
            let gap = row.normal[0] * (own - met);
            assert!(gap > 0.1, "{up}: {gap} at node {}", row.node);
        }
    }
}

/// A surface that is bent by less than 41° is one, bent by more it has an edge, and which of both it was at first it stays:
/// the normal of the node there does not jump while the surface turns.
#[test]
fn a_surface_has_the_edges_that_it_had_at_first() {
    let mesh = stack([CellKind::Quad4; 2], (0.0, 2.0, 2), (-1.0, 3.0, 4), |x| x);
    let group = |name| mesh.facet_group(name).expect("named");
    let sides = (group("upper.bottom"), group("lower.top"));
    let of_upper = mesh.node_group("upper").expect("named");
    let normal = |degrees: f64, choices: &mut MultiplierChoices| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let bent = |(a, x): (usize, &[f64; 2])| match of_upper.binary_search(&a) {
            Ok(_) if x[0] > 1.0 => [1.0 + (x[0] - 1.0) * cos, x[1] + (x[0] - 1.0) * sin],
            _ => *x,
        };
        let positions: Vec<[f64; 2]> = mesh.nodes().iter().enumerate().map(bent).collect();
        let hypothesis = PlaneStrain::default();
        let rows =
            mesh.mortar_rows_keeping(&positions, sides, Pairing::Mortar, &hypothesis, choices);
        let at_bend = rows
            .into_iter()
            .find(|row| mesh.nodes()[row.node] == [1.0, 0.0]);
        at_bend.expect("over the lower body").normal[0]
    };
    let half = |degrees: f64| (0.5 * degrees).to_radians().sin();
    let mut round = MultiplierChoices::default();
    for degrees in [40.0, 43.0, 40.0, 50.0] {
        let found = normal(degrees, &mut round).abs();
        assert!((found - half(degrees)).abs() < 1e-12, "{degrees}: {found}");
    }
    let mut sharp = MultiplierChoices::default();
    for degrees in [43.0, 40.0, 43.0] {
        let found = normal(degrees, &mut sharp).abs();
        assert!(found < 1e-12, "{degrees}: {found}");
    }
}

/// A body that stands beyond the end of another and leans over it: its side looks back, through the body, at the surface that
/// its bottom stands on, and is not within that.
#[test]
fn a_side_beyond_the_end_of_a_surface_meets_nothing_behind_it() {
    let block = |name, x: Vec<f64>, y: Vec<f64>| block2(name, CellKind::Quad4, &x, &y);
    let side = |lean: f64, sink: f64| {
        let leaning = |[x, y]: [f64; 2]| [x + lean * y, y - sink];
        let mesh = block("upper", uniform(-1.0, 1.2, 4), uniform(0.0, 2.0, 2))
            .and_then(|m| m.map(leaning))
            .and_then(|m| m.joined(block("lower", uniform(-3.0, 1.0, 4), vec![-1.0, 0.0])?))
            .expect("valid");
        let group = |name| mesh.facet_group(name).expect("named");
        let surface = [group("upper.bottom"), group("upper.right")].concat();
        let sides = (surface.as_slice(), group("lower.top"));
        let rows = mesh.mortar_rows(
            mesh.nodes(),
            sides,
            Pairing::Mortar,
            &PlaneStrain::default(),
        );
        assert!(rows.len() >= 4, "{lean} {sink}: {} rows", rows.len());
        rows.into_iter().filter(|row| row.normal[1] < 0.999).count()
    };
    for (lean, sink) in [
        (0.0, 0.0),
        (0.01, 0.004),
        (0.1, 0.03),
        (0.2, 0.06),
        (0.2, 0.1),
    ] {
        assert_eq!(side(lean, sink), 0, "{lean} {sink}");
    }
}

/// Bodies that begin within each other, as those of a fit, by nearly a facet: tractions are forces over the whole area.
#[test]
fn areas_do_not_depend_on_how_deep_bodies_are_within_each_other() {
    let block = |name, y: Vec<f64>| block2(name, CellKind::Quad4, &uniform(0.0, 4.0, 8), &y);
    for deep in [0.0, 0.2, 0.4, 0.48] {
        let mesh = block("upper", vec![-deep, 2.0])
            .and_then(|m| m.joined(block("lower", vec![-2.0, 0.0])?))
            .expect("valid");
        let area: f64 = pair(&mesh, Pairing::Mortar).iter().map(|r| r.area).sum();
        assert!((area - 4.0).abs() < 1e-12, "{deep}: {area}");
    }
}
