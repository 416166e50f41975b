//! What every element must satisfy, in one generic function; and the run-time kinds beside them.

use crate::ROUND_OFF;
use approx::assert_abs_diff_eq;
use moreau_mesh::{
    CellKind, Element, FacetKind, Hex8, Hex20, Hex27, Integration, Line2, Line3, Mesh, Quad4,
    Quad8, Quad9, Tet4, Tet10, Tri3, Tri6, UnknownKind, block2, block3, uniform,
};
use nalgebra::DMatrix;

/// Points scattered over [−1, 1]^D; polynomial identities hold outside a reference cell too.
fn scattered<const D: usize>() -> impl Iterator<Item = [f64; D]> {
    (0..20).map(|k| std::array::from_fn(|i| (1.7 * (k * D + i) as f64 + 0.3).sin()))
}

fn monomial<const D: usize>(powers: &[i32; D], x: &[f64; D]) -> f64 {
    x.iter().zip(powers).map(|(x, &k)| x.powi(k)).product()
}

/// `complete`: exponents of monomials that the element interpolates exactly; `missing`: of one it
/// does not.
fn satisfies_the_contract<const D: usize, const N: usize, E: Element<D, N>>(
    complete: &[[i32; D]],
    missing: [i32; D],
    volume: f64,
) {
    for (b, xi) in E::NODES.into_iter().enumerate() {
        for (a, n) in E::shape(xi).into_iter().enumerate() {
            assert_abs_diff_eq!(n, if a == b { 1.0 } else { 0.0 }, epsilon = ROUND_OFF);
        }
    }
    let interpolated = |powers: &[i32; D], x: [f64; D]| -> f64 {
        E::shape(x)
            .iter()
            .zip(&E::NODES)
            .map(|(n, node)| n * monomial(powers, node))
            .sum()
    };
    for x in scattered::<D>() {
        assert_abs_diff_eq!(E::shape(x).iter().sum::<f64>(), 1.0, epsilon = ROUND_OFF);
        let gradient = E::shape_gradient(x);
        for i in 0..D {
            assert_abs_diff_eq!(
                gradient.iter().map(|g| g[i]).sum::<f64>(),
                0.0,
                epsilon = ROUND_OFF
            );
            // No element exceeds degree 2 in one coordinate, so that central differences are
            // exact whatever their width.
            let [mut left, mut right] = [x; 2];
            left[i] -= 0.5;
            right[i] += 0.5;
            let (n_0, n_1) = (E::shape(left), E::shape(right));
            for a in 0..N {
                assert_abs_diff_eq!(gradient[a][i], n_1[a] - n_0[a], epsilon = 10.0 * ROUND_OFF);
            }
        }
        for powers in complete {
            assert_abs_diff_eq!(
                interpolated(powers, x),
                monomial(powers, &x),
                epsilon = ROUND_OFF
            );
        }
    }
    let miss = |x| (interpolated(&missing, x) - monomial(&missing, &x)).abs();
    assert!(
        scattered().any(|x| miss(x) > 1e-3),
        "{missing:?} is interpolated"
    );

    for integration in RULES {
        let sum: f64 = E::rule(integration).points.iter().map(|p| p.weight).sum();
        assert_abs_diff_eq!(sum, volume, epsilon = ROUND_OFF);
    }
}

/// On each facet of E the nodes of the facet are interpolated by F, and the other ones vanish.
fn facets_are<
    const D: usize,
    const N: usize,
    E: Element<D, N>,
    const M: usize,
    const K: usize,
    F: Element<M, K>,
>() {
    for facet in E::FACETS {
        assert_eq!(facet.len(), K);
        for s in scattered::<M>() {
            let on_facet = F::shape(s);
            let mut expected = [0.0; N];
            let mut x = [0.0; D];
            for (&node, n) in facet.iter().zip(on_facet) {
                expected[node] = n;
                (0..D).for_each(|i| x[i] += n * E::NODES[node][i]);
            }
            for (n, expected) in E::shape(x).into_iter().zip(expected) {
                assert_abs_diff_eq!(n, expected, epsilon = ROUND_OFF);
            }
        }
    }
}

/// Every rule.
const RULES: [Integration; 3] = [Integration::Reduced, Integration::Full, Integration::BBar];

const QUADRATIC: [[i32; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]];

#[test]
fn line2_satisfies_the_contract() {
    satisfies_the_contract::<1, 2, Line2>(&[[0], [1]], [2], 2.0);
}

#[test]
fn line3_satisfies_the_contract() {
    satisfies_the_contract::<1, 3, Line3>(&[[0], [1], [2]], [3], 2.0);
}

#[test]
fn tri3_satisfies_the_contract() {
    satisfies_the_contract::<2, 3, Tri3>(&QUADRATIC[..3], [1, 1], 0.5);
    facets_are::<2, 3, Tri3, 1, 2, Line2>();
}

#[test]
fn tri6_satisfies_the_contract() {
    satisfies_the_contract::<2, 6, Tri6>(&QUADRATIC, [2, 1], 0.5);
    facets_are::<2, 6, Tri6, 1, 3, Line3>();
}

#[test]
fn quad4_satisfies_the_contract() {
    let bilinear = [[0, 0], [1, 0], [0, 1], [1, 1]];
    satisfies_the_contract::<2, 4, Quad4>(&bilinear, [2, 0], 4.0);
    facets_are::<2, 4, Quad4, 1, 2, Line2>();
}

#[test]
fn quad8_satisfies_the_contract() {
    let serendipity = [&QUADRATIC[..], &[[2, 1], [1, 2]]].concat();
    satisfies_the_contract::<2, 8, Quad8>(&serendipity, [2, 2], 4.0);
    facets_are::<2, 8, Quad8, 1, 3, Line3>();
}

#[test]
fn quad9_satisfies_the_contract() {
    let biquadratic = [&QUADRATIC[..], &[[2, 1], [1, 2], [2, 2]]].concat();
    satisfies_the_contract::<2, 9, Quad9>(&biquadratic, [3, 0], 4.0);
    facets_are::<2, 9, Quad9, 1, 3, Line3>();
}

#[test]
fn tet4_satisfies_the_contract() {
    let linear = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
    satisfies_the_contract::<3, 4, Tet4>(&linear, [1, 1, 0], 1.0 / 6.0);
    facets_are::<3, 4, Tet4, 2, 3, Tri3>();
}

/// Exponents from 0 to 2 each, of which `keep` holds.
fn quadratics(keep: impl Fn(&[i32; 3]) -> bool) -> Vec<[i32; 3]> {
    let all = (0..27).map(|k| [k % 3, k / 3 % 3, k / 9]);
    all.filter(|powers| keep(powers)).collect()
}

#[test]
fn tet10_satisfies_the_contract() {
    let complete = quadratics(|powers| powers.iter().sum::<i32>() <= 2);
    assert_eq!(complete.len(), 10);
    satisfies_the_contract::<3, 10, Tet10>(&complete, [1, 1, 1], 1.0 / 6.0);
    facets_are::<3, 10, Tet10, 2, 6, Tri6>();
}

/// Serendipity: one coordinate at most enters with a square.
#[test]
fn hex20_satisfies_the_contract() {
    let complete = quadratics(|powers| powers.iter().filter(|&&k| k == 2).count() <= 1);
    assert_eq!(complete.len(), 20);
    satisfies_the_contract::<3, 20, Hex20>(&complete, [2, 2, 0], 8.0);
    facets_are::<3, 20, Hex20, 2, 8, Quad8>();
}

#[test]
fn hex27_satisfies_the_contract() {
    satisfies_the_contract::<3, 27, Hex27>(&quadratics(|_| true), [0, 3, 0], 8.0);
    facets_are::<3, 27, Hex27, 2, 9, Quad9>();
}

/// The rule that is taken where none is asked for never is one that locks, but where there is no
/// other.
#[test]
fn the_rule_of_a_kind_does_not_lock() {
    for kind in CellKind::ALL {
        let constant_strain = matches!(kind, CellKind::Tri3 | CellKind::Tet4);
        assert_eq!(kind.locks(kind.integration()), constant_strain, "{kind}");
    }
    assert!(CellKind::Hex8.locks(Integration::Full) && !CellKind::Hex20.locks(Integration::Full));
}

/// Whether a block of two cells each way has more deformations without strain at the points of the reduced rule than its
/// rigid motions.
fn has_hourglasses<const D: usize, const N: usize, E: Element<D, N>>(mesh: &Mesh<D>) -> bool {
    let dofs = D * mesh.nodes().len();
    let mut rows = Vec::new();
    for cell in 0..mesh.cell_count() {
        let nodes = mesh.cell_nodes(cell);
        let positions: [[f64; D]; N] = std::array::from_fn(|a| mesh.nodes()[nodes[a]]);
        for point in &E::rule(Integration::Reduced).points {
            let gradient = E::map(&positions, point.xi).gradient;
            for (i, j) in (0..D).flat_map(|i| (i..D).map(move |j| (i, j))) {
                let mut row = vec![0.0; dofs];
                for (a, g) in gradient.iter().enumerate() {
                    row[D * nodes[a] + i] += 0.5 * g[j];
                    row[D * nodes[a] + j] += 0.5 * g[i];
                }
                rows.extend(row);
            }
        }
    }
    let strains = DMatrix::from_row_slice(rows.len() / dofs, dofs, &rows);
    dofs - strains.rank(1e-9) > D * (D + 1) / 2
}

#[test]
fn hourglasses_are_deformations_without_strain() {
    let lines = uniform(0.0, 2.0, 2);
    let plane = |kind| block2("b", kind, &lines, &lines).expect("valid");
    let solid = |kind| block3("b", kind, &lines, &lines, &lines).expect("valid");
    for kind in CellKind::ALL {
        let found = match kind {
            CellKind::Tri3 => has_hourglasses::<2, 3, Tri3>(&plane(kind)),
            CellKind::Tri6 => has_hourglasses::<2, 6, Tri6>(&plane(kind)),
            CellKind::Quad4 => has_hourglasses::<2, 4, Quad4>(&plane(kind)),
            CellKind::Quad8 => has_hourglasses::<2, 8, Quad8>(&plane(kind)),
            CellKind::Quad9 => has_hourglasses::<2, 9, Quad9>(&plane(kind)),
            CellKind::Tet4 => has_hourglasses::<3, 4, Tet4>(&solid(kind)),
            CellKind::Tet10 => has_hourglasses::<3, 10, Tet10>(&solid(kind)),
            CellKind::Hex8 => has_hourglasses::<3, 8, Hex8>(&solid(kind)),
            CellKind::Hex20 => has_hourglasses::<3, 20, Hex20>(&solid(kind)),
            CellKind::Hex27 => has_hourglasses::<3, 27, Hex27>(&solid(kind)),
        };
        assert_eq!(kind.hourglasses(Integration::Reduced), found, "{kind}");
        assert!(!kind.hourglasses(kind.integration()), "{kind}");
    }
}

#[test]
fn hex8_satisfies_the_contract() {
    let trilinear: Vec<[i32; 3]> = (0..8).map(|k| [k & 1, k >> 1 & 1, k >> 2]).collect();
    satisfies_the_contract::<3, 8, Hex8>(&trilinear, [2, 0, 0], 8.0);
    facets_are::<3, 8, Hex8, 2, 4, Quad4>();
}

#[test]
fn rules_have_the_documented_number_of_points() {
    fn counts<const D: usize, const N: usize, E: Element<D, N>>() -> [usize; 2] {
        let [reduced, full, b_bar] = RULES.map(|rule| E::rule(rule).points.len());
        assert_eq!(b_bar, full, "the mean is that of the full rule");
        [reduced, full]
    }
    assert_eq!(counts::<1, 2, Line2>(), [1, 2]);
    assert_eq!(counts::<1, 3, Line3>(), [2, 3]);
    assert_eq!(counts::<2, 3, Tri3>(), [1, 1]);
    assert_eq!(counts::<2, 6, Tri6>(), [3, 6]);
    assert_eq!(counts::<2, 4, Quad4>(), [1, 4]);
    assert_eq!(counts::<2, 8, Quad8>(), [4, 9]);
    assert_eq!(counts::<2, 9, Quad9>(), [4, 9]);
    assert_eq!(counts::<3, 4, Tet4>(), [1, 1]);
    assert_eq!(counts::<3, 10, Tet10>(), [4, 14]);
    assert_eq!(counts::<3, 8, Hex8>(), [1, 8]);
    assert_eq!(counts::<3, 20, Hex20>(), [8, 27]);
    assert_eq!(counts::<3, 27, Hex27>(), [8, 27]);
}

#[test]
fn a_map_stretches_by_its_determinant() {
    // A rectangle of 3 mm by 5 mm at (10, 20).
    let nodes = Quad4::NODES.map(|[x, y]| [10.0 + 1.5 * x, 20.0 + 2.5 * y]);
    let point = Quad4::map(&nodes, [0.5, -0.2]);
    assert_abs_diff_eq!(point.det, 15.0 / 4.0, epsilon = 10.0 * ROUND_OFF);
    assert_abs_diff_eq!(point.x[..], [10.75, 19.5][..], epsilon = 10.0 * ROUND_OFF);
    let reference = Quad4::shape_gradient([0.5, -0.2]);
    for (g, d) in point.gradient.iter().zip(reference) {
        assert_abs_diff_eq!(g[..], [d[0] / 1.5, d[1] / 2.5][..], epsilon = ROUND_OFF);
    }
}

#[test]
fn kinds_know_their_elements() {
    for kind in CellKind::ALL {
        assert_eq!(kind.reference_nodes().len(), kind.nodes());
        assert!(kind.reference_nodes().all(|x| x.len() == kind.dimension()));
        for facet in kind.facets() {
            assert_eq!(facet.len(), kind.facet_kind().nodes());
            let (corners, midsides) = facet.split_at(kind.facet_kind().corner_count());
            assert!(corners.iter().all(|&node| node < kind.corner_count()));
            assert!(midsides.iter().all(|&node| node >= kind.corner_count()));
        }
    }
    assert_eq!(CellKind::Quad8.facets(), Quad8::FACETS);
    assert_eq!(CellKind::Quad8.facet_kind(), FacetKind::Line3);
    assert_eq!(CellKind::Hex8.corner_count(), 8);
}

#[test]
fn kinds_are_displayed_and_parsed_by_name() {
    for kind in CellKind::ALL {
        assert_eq!(kind.to_string().parse(), Ok(kind));
    }
    assert_eq!(format!("{:>6}", CellKind::Quad8), " quad8");
    let error = "qad8".parse::<CellKind>().unwrap_err();
    assert_eq!(
        error,
        UnknownKind {
            name: "qad8".into(),
            nearest: CellKind::Quad8
        }
    );
    assert_eq!(
        error.to_string(),
        "no kind of cell \"qad8\": did you mean \"quad8\"?"
    );
}
