//! The linear tetrahedron; not a remedy for its own locking.

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Linear tetrahedron on ξ, η, ζ ≥ 0, ξ + η + ζ ≤ 1.
///
/// ```text
///   ζ
///   3
///   │╲╲
///   │ ╲  ╲
///   │  2   ╲      2 lies behind, on η
///   │ ╱   ╲  ╲
///   0 ──────── 1  ξ
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tet4;

impl Element<3, 4> for Tet4 {
    const NODES: [[f64; 3]; 4] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    const FACETS: &'static [&'static [usize]] = &[&[0, 2, 1], &[0, 1, 3], &[0, 3, 2], &[1, 2, 3]];

    fn shape([x, y, z]: [f64; 3]) -> [f64; 4] {
        [1.0 - x - y - z, x, y, z]
    }

    fn shape_gradient(_: [f64; 3]) -> [[f64; 3]; 4] {
        [
            [-1.0, -1.0, -1.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ]
    }

    /// One point in both: the strain is constant.
    fn rule(_: Integration) -> Rule<3> {
        Rule::tetrahedron(1)
    }
}
