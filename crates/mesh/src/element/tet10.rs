//! The quadratic tetrahedron; not a bubble-enriched one.

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Quadratic tetrahedron on ξ, η, ζ ≥ 0, ξ + η + ζ ≤ 1: corners as in [`Tet4`](crate::Tet4), then
/// the middles of its edges:
///
/// ```text
/// node   4    5    6    7    8    9
/// edge  0 1  1 2  0 2  0 3  2 3  1 3
/// ```
///
/// The last two are those of Gmsh; VTK has them the other way round.
#[derive(Debug, Clone, Copy)]
pub struct Tet10;

/// Corners of the edges, in the order of the nodes 4 to 9.
const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// Gradients of the barycentric coordinates.
const SLOPES: [[f64; 3]; 4] = [
    [-1.0, -1.0, -1.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
];

impl Element<3, 10> for Tet10 {
    const NODES: [[f64; 3]; 10] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.5, 0.0, 0.0],
        [0.5, 0.5, 0.0],
        [0.0, 0.5, 0.0],
        [0.0, 0.0, 0.5],
        [0.0, 0.5, 0.5],
        [0.5, 0.0, 0.5],
    ];
    const FACETS: &'static [&'static [usize]] = &[
        &[0, 2, 1, 6, 5, 4],
        &[0, 1, 3, 4, 9, 7],
        &[0, 3, 2, 7, 8, 6],
        &[1, 2, 3, 5, 8, 9],
    ];

    fn shape([x, y, z]: [f64; 3]) -> [f64; 10] {
        let l = [1.0 - x - y - z, x, y, z];
        std::array::from_fn(|a| match a.checked_sub(4) {
            None => l[a] * (2.0 * l[a] - 1.0),
            Some(edge) => EDGES[edge].iter().fold(4.0, |n, &corner| n * l[corner]),
        })
    }

    fn shape_gradient([x, y, z]: [f64; 3]) -> [[f64; 3]; 10] {
        let l = [1.0 - x - y - z, x, y, z];
        std::array::from_fn(|a| match a.checked_sub(4) {
            None => SLOPES[a].map(|slope| (4.0 * l[a] - 1.0) * slope),
            Some(edge) => {
                let [b, c] = EDGES[edge];
                std::array::from_fn(|i| 4.0 * (SLOPES[b][i] * l[c] + l[b] * SLOPES[c][i]))
            }
        })
    }

    /// Four points, exact for the stiffness where the sides are straight, or fourteen.
    fn rule(integration: Integration) -> Rule<3> {
        match integration {
            Integration::Reduced => Rule::tetrahedron(2),
            Integration::Full | Integration::BBar => Rule::tetrahedron(5),
        }
    }
}
