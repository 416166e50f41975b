//! The linear triangle; not a remedy for its own locking.

use super::Element;
use crate::quadrature::{Integration, Rule};

/// Linear triangle on ξ, η ≥ 0, ξ + η ≤ 1; also a facet of [`Tet4`](crate::Tet4).
///
/// ```text
/// η
/// 2
/// │ ╲
/// │   ╲
/// │     ╲
/// 0 ───── 1  ξ
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Tri3;

impl Element<2, 3> for Tri3 {
    const NODES: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    const FACETS: &'static [&'static [usize]] = &[&[0, 1], &[1, 2], &[2, 0]];

    fn shape([x, y]: [f64; 2]) -> [f64; 3] {
        [1.0 - x - y, x, y]
    }

    fn shape_gradient(_: [f64; 2]) -> [[f64; 2]; 3] {
        [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]
    }

    /// One point in both: the strain is constant.
    fn rule(_: Integration) -> Rule<2> {
        Rule::triangle(1)
    }
}
