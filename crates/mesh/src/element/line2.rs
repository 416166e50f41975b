//! The linear segment, a facet of linear plane cells; not a bar.

use super::Element;
use crate::quadrature::{Integration, Rule, gauss};

/// Linear segment on \[−1, 1\].
///
/// ```text
/// 0 ─────────── 1  → ξ
/// −1            1
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Line2;

impl Element<1, 2> for Line2 {
    const NODES: [[f64; 1]; 2] = [[-1.0], [1.0]];
    const FACETS: &'static [&'static [usize]] = &[&[0], &[1]];

    fn shape([x]: [f64; 1]) -> [f64; 2] {
        [0.5 * (1.0 - x), 0.5 * (1.0 + x)]
    }

    fn shape_gradient(_: [f64; 1]) -> [[f64; 1]; 2] {
        [[-0.5], [0.5]]
    }

    /// One or two points.
    fn rule(integration: Integration) -> Rule<1> {
        match integration {
            Integration::Reduced => gauss(1),
            Integration::Full | Integration::BBar => gauss(2),
        }
    }
}
