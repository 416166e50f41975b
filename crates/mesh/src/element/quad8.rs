//! The quadratic serendipity quadrilateral, the element of the paper's examples; not complete in
//! ξ²η², unlike [`Quad9`](crate::Quad9).

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Serendipity quadrilateral on \[−1, 1\]²: all quadratics, ξ²η and ξη².
///
/// ```text
///      η
/// 3 ── 6 ── 2
/// │    │    │
/// 7    └─── 5 ─ ξ
/// │         │
/// 0 ── 4 ── 1
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Quad8;

impl Element<2, 8> for Quad8 {
    const NODES: [[f64; 2]; 8] = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, -1.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
    ];
    const FACETS: &'static [&'static [usize]] = &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]];

    fn shape([x, y]: [f64; 2]) -> [f64; 8] {
        Self::NODES.map(|[a, b]| match (a == 0.0, b == 0.0) {
            (true, _) => 0.5 * (1.0 - x * x) * (1.0 + b * y),
            (_, true) => 0.5 * (1.0 + a * x) * (1.0 - y * y),
            _ => 0.25 * (1.0 + a * x) * (1.0 + b * y) * (a * x + b * y - 1.0),
        })
    }

    fn shape_gradient([x, y]: [f64; 2]) -> [[f64; 2]; 8] {
        Self::NODES.map(|[a, b]| match (a == 0.0, b == 0.0) {
            (true, _) => [-x * (1.0 + b * y), 0.5 * b * (1.0 - x * x)],
            (_, true) => [0.5 * a * (1.0 - y * y), -y * (1.0 + a * x)],
            _ => [
                0.25 * a * (1.0 + b * y) * (2.0 * a * x + b * y),
                0.25 * b * (1.0 + a * x) * (a * x + 2.0 * b * y),
            ],
        })
    }

    /// 2 × 2 or 3 × 3 points.
    fn rule(integration: Integration) -> Rule<2> {
        match integration {
            Integration::Reduced => Rule::quadrilateral(2),
            Integration::Full | Integration::BBar => Rule::quadrilateral(3),
        }
    }
}
