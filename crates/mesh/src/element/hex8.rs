//! The trilinear hexahedron; not a stabilised one under reduced integration.

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Trilinear hexahedron on \[−1, 1\]³.
///
/// ```text
///        7 ──────── 6
///      ╱ │        ╱ │
///    4 ──────── 5   │
///    │   │      │   │      ζ  η
///    │   3 ─────│── 2      │ ╱
///    │ ╱        │ ╱        └── ξ
///    0 ──────── 1
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Hex8;

impl Element<3, 8> for Hex8 {
    const NODES: [[f64; 3]; 8] = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
    ];
    const FACETS: &'static [&'static [usize]] = &[
        &[0, 3, 2, 1],
        &[0, 1, 5, 4],
        &[1, 2, 6, 5],
        &[2, 3, 7, 6],
        &[3, 0, 4, 7],
        &[4, 5, 6, 7],
    ];

    fn shape([x, y, z]: [f64; 3]) -> [f64; 8] {
        Self::NODES.map(|[a, b, c]| 0.125 * (1.0 + a * x) * (1.0 + b * y) * (1.0 + c * z))
    }

    fn shape_gradient([x, y, z]: [f64; 3]) -> [[f64; 3]; 8] {
        Self::NODES.map(|[a, b, c]| {
            let [p, q, r] = [1.0 + a * x, 1.0 + b * y, 1.0 + c * z];
            [0.125 * a * q * r, 0.125 * b * p * r, 0.125 * c * p * q]
        })
    }

    /// One or 2 × 2 × 2 points.
    fn rule(integration: Integration) -> Rule<3> {
        match integration {
            Integration::Reduced => Rule::hexahedron(1),
            Integration::Full | Integration::BBar => Rule::hexahedron(2),
        }
    }
}
