//! The bilinear quadrilateral; not a stabilised one under reduced integration.

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Bilinear quadrilateral on \[−1, 1\]²; also a facet of [`Hex8`](crate::Hex8).
///
/// ```text
///      η
/// 3 ───┼─── 2
/// │    │    │
/// │    └────┼─ ξ
/// │         │
/// 0 ─────── 1
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Quad4;

impl Element<2, 4> for Quad4 {
    const NODES: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    const FACETS: &'static [&'static [usize]] = &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]];

    fn shape([x, y]: [f64; 2]) -> [f64; 4] {
        Self::NODES.map(|[a, b]| 0.25 * (1.0 + a * x) * (1.0 + b * y))
    }

    fn shape_gradient([x, y]: [f64; 2]) -> [[f64; 2]; 4] {
        Self::NODES.map(|[a, b]| [0.25 * a * (1.0 + b * y), 0.25 * b * (1.0 + a * x)])
    }

    /// One or 2 × 2 points.
    fn rule(integration: Integration) -> Rule<2> {
        match integration {
            Integration::Reduced => Rule::quadrilateral(1),
            Integration::Full | Integration::BBar => Rule::quadrilateral(2),
        }
    }
}
