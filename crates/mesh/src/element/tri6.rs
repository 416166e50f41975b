//! The quadratic triangle; not a bubble-enriched one.

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Quadratic triangle on ξ, η ≥ 0, ξ + η ≤ 1.
///
/// ```text
/// η
/// 2
/// │ ╲
/// 5   4
/// │     ╲
/// 0 ─ 3 ─ 1  ξ
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tri6;

impl Element<2, 6> for Tri6 {
    const NODES: [[f64; 2]; 6] = [
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [0.5, 0.0],
        [0.5, 0.5],
        [0.0, 0.5],
    ];
    const FACETS: &'static [&'static [usize]] = &[&[0, 1, 3], &[1, 2, 4], &[2, 0, 5]];

    fn shape([x, y]: [f64; 2]) -> [f64; 6] {
        let z = 1.0 - x - y;
        [
            z * (2.0 * z - 1.0),
            x * (2.0 * x - 1.0),
            y * (2.0 * y - 1.0),
            4.0 * z * x,
            4.0 * x * y,
            4.0 * y * z,
        ]
    }

    fn shape_gradient([x, y]: [f64; 2]) -> [[f64; 2]; 6] {
        let z = 1.0 - x - y;
        [
            [1.0 - 4.0 * z, 1.0 - 4.0 * z],
            [4.0 * x - 1.0, 0.0],
            [0.0, 4.0 * y - 1.0],
            [4.0 * (z - x), -4.0 * x],
            [4.0 * y, 4.0 * x],
            [-4.0 * y, 4.0 * (z - y)],
        ]
    }

    /// Three or six points.
    fn rule(integration: Integration) -> Rule<2> {
        match integration {
            Integration::Reduced => Rule::triangle(2),
            Integration::Full | Integration::BBar => Rule::triangle(4),
        }
    }
}
