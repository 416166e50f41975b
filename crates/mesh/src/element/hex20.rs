//! The quadratic serendipity hexahedron; not complete, unlike [`Hex27`](crate::Hex27).

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Serendipity hexahedron on \[−1, 1\]³: the monomials whose degree is at most 2 when coordinates
/// that enter linearly are not counted.
///
/// ```text
///        7 ── 19 ── 6
///     17 │       18 │
///    4 ── 16 ── 5   14
///    │  15      │   │      ζ  η
///   10   3 ── 13│── 2      │ ╱
///    │ 9       12 11       └── ξ
///    0 ─── 8 ── 1
/// ```
///
/// The order of the edges is that of Gmsh, not that of VTK.
#[derive(Debug, Clone, Copy)]
pub struct Hex20;

impl Element<3, 20> for Hex20 {
    const NODES: [[f64; 3]; 20] = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
        [0.0, -1.0, -1.0],
        [-1.0, 0.0, -1.0],
        [-1.0, -1.0, 0.0],
        [1.0, 0.0, -1.0],
        [1.0, -1.0, 0.0],
        [0.0, 1.0, -1.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, -1.0, 1.0],
        [-1.0, 0.0, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 1.0],
    ];
    const FACETS: &'static [&'static [usize]] = &[
        &[0, 3, 2, 1, 9, 13, 11, 8],
        &[0, 1, 5, 4, 8, 12, 16, 10],
        &[1, 2, 6, 5, 11, 14, 18, 12],
        &[2, 3, 7, 6, 13, 15, 19, 14],
        &[3, 0, 4, 7, 9, 10, 17, 15],
        &[4, 5, 6, 7, 16, 18, 19, 17],
    ];

    fn shape(xi: [f64; 3]) -> [f64; 20] {
        Self::NODES.map(|node| factors(node, xi).0)
    }

    fn shape_gradient(xi: [f64; 3]) -> [[f64; 3]; 20] {
        Self::NODES.map(|node| factors(node, xi).1)
    }

    /// 2 × 2 × 2 or 3 × 3 × 3 points.
    fn rule(integration: Integration) -> Rule<3> {
        match integration {
            Integration::Reduced => Rule::hexahedron(2),
            Integration::Full | Integration::BBar => Rule::hexahedron(3),
        }
    }
}

/// Shape function of a node and its gradient. With p_i = 1 + a_i ξ_i, or 1 − ξ_i² where a_i = 0, a
/// mid-side node has ¼ p_1 p_2 p_3 and a corner ⅛ p_1 p_2 p_3 (a·ξ − 2).
fn factors(a: [f64; 3], xi: [f64; 3]) -> (f64, [f64; 3]) {
    let midside = a.contains(&0.0);
    let one = |i: usize| match a[i] == 0.0 {
        true => (1.0 - xi[i] * xi[i], -2.0 * xi[i]),
        false => (1.0 + a[i] * xi[i], a[i]),
    };
    let p = [one(0), one(1), one(2)];
    let product = p[0].0 * p[1].0 * p[2].0;
    let slope = |i: usize| p[i].1 * p[(i + 1) % 3].0 * p[(i + 2) % 3].0;
    if midside {
        return (0.25 * product, [0, 1, 2].map(|i| 0.25 * slope(i)));
    }
    let last = a[0] * xi[0] + a[1] * xi[1] + a[2] * xi[2] - 2.0;
    let gradient = [0, 1, 2].map(|i| 0.125 * (slope(i) * last + product * a[i]));
    (0.125 * product * last, gradient)
}
