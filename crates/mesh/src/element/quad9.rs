//! The biquadratic quadrilateral; not the serendipity one.

use super::{Element, Line3};
use crate::quadrature::{Integration, Rule};

/// Biquadratic quadrilateral on \[−1, 1\]², the product of two [`Line3`].
///
/// ```text
///      η
/// 3 ── 6 ── 2
/// │    │    │
/// 7    8 ── 5 ─ ξ
/// │         │
/// 0 ── 4 ── 1
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Quad9;

/// Nodes of [`Line3`] along ξ and η whose product is each node.
const FACTORS: [[usize; 2]; 9] = [
    [0, 0],
    [1, 0],
    [1, 1],
    [0, 1],
    [2, 0],
    [1, 2],
    [2, 1],
    [0, 2],
    [2, 2],
];

impl Element<2, 9> for Quad9 {
    const NODES: [[f64; 2]; 9] = [
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, -1.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [0.0, 0.0],
    ];
    const FACETS: &'static [&'static [usize]] = &[&[0, 1, 4], &[1, 2, 5], &[2, 3, 6], &[3, 0, 7]];

    fn shape([x, y]: [f64; 2]) -> [f64; 9] {
        let (n, m) = (Line3::shape([x]), Line3::shape([y]));
        FACTORS.map(|[i, j]| n[i] * m[j])
    }

    fn shape_gradient([x, y]: [f64; 2]) -> [[f64; 2]; 9] {
        let (n, m) = (Line3::shape([x]), Line3::shape([y]));
        let (d_n, d_m) = (Line3::shape_gradient([x]), Line3::shape_gradient([y]));
        FACTORS.map(|[i, j]| [d_n[i][0] * m[j], n[i] * d_m[j][0]])
    }

    /// 2 × 2 or 3 × 3 points.
    fn rule(integration: Integration) -> Rule<2> {
        match integration {
            Integration::Reduced => Rule::quadrilateral(2),
            Integration::Full | Integration::BBar => Rule::quadrilateral(3),
        }
    }
}
