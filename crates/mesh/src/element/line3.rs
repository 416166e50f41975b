//! The quadratic segment, a facet of quadratic plane cells; not a bar.

use super::Element;
use crate::quadrature::{Integration, Rule, gauss};

/// Quadratic segment on \[−1, 1\].
///
/// ```text
/// 0 ───── 2 ───── 1  → ξ
/// −1      0       1
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Line3;

impl Element<1, 3> for Line3 {
    const NODES: [[f64; 1]; 3] = [[-1.0], [1.0], [0.0]];
    const FACETS: &'static [&'static [usize]] = &[&[0], &[1]];

    fn shape([x]: [f64; 1]) -> [f64; 3] {
        [0.5 * x * (x - 1.0), 0.5 * x * (x + 1.0), 1.0 - x * x]
    }

    fn shape_gradient([x]: [f64; 1]) -> [[f64; 1]; 3] {
        [[x - 0.5], [x + 0.5], [-2.0 * x]]
    }

    /// Two or three points.
    fn rule(integration: Integration) -> Rule<1> {
        match integration {
            Integration::Reduced => gauss(2),
            Integration::Full | Integration::BBar => gauss(3),
        }
    }
}
