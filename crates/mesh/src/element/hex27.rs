//! The triquadratic hexahedron; not the serendipity one.

use super::{Element, Line3};
use crate::quadrature::{Integration, Rule};

/// Triquadratic hexahedron on \[−1, 1\]³, the product of three [`Line3`].
///
/// The edges as in [`Hex20`](crate::Hex20), then the middles of the faces, then the centre:
///
/// ```text
/// node   20   21   22   23   24   25   26
/// face   ζ−   η−   ξ−   ξ+   η+   ζ+   –
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Hex27;

/// Node of [`Line3`] at a reference coordinate −1, 1 or 0.
fn factor(x: f64) -> usize {
    match x {
        x if x < 0.0 => 0,
        x if x > 0.0 => 1,
        _ => 2,
    }
}

impl Element<3, 27> for Hex27 {
    const NODES: [[f64; 3]; 27] = {
        let mut nodes = [[0.0; 3]; 27];
        let mut a = 0;
        while a < 20 {
            nodes[a] = super::Hex20::NODES[a];
            a += 1;
        }
        nodes[20][2] = -1.0;
        nodes[21][1] = -1.0;
        nodes[22][0] = -1.0;
        nodes[23][0] = 1.0;
        nodes[24][1] = 1.0;
        nodes[25][2] = 1.0;
        nodes
    };
    const FACETS: &'static [&'static [usize]] = &[
        &[0, 3, 2, 1, 9, 13, 11, 8, 20],
        &[0, 1, 5, 4, 8, 12, 16, 10, 21],
        &[1, 2, 6, 5, 11, 14, 18, 12, 23],
        &[2, 3, 7, 6, 13, 15, 19, 14, 24],
        &[3, 0, 4, 7, 9, 10, 17, 15, 22],
        &[4, 5, 6, 7, 16, 18, 19, 17, 25],
    ];

    fn shape(xi: [f64; 3]) -> [f64; 27] {
        let [n, m, l] = xi.map(|x| Line3::shape([x]));
        Self::NODES.map(|[a, b, c]| n[factor(a)] * m[factor(b)] * l[factor(c)])
    }

    fn shape_gradient(xi: [f64; 3]) -> [[f64; 3]; 27] {
        let [n, m, l] = xi.map(|x| Line3::shape([x]));
        let [d_n, d_m, d_l] = xi.map(|x| Line3::shape_gradient([x]));
        Self::NODES.map(|node| {
            let [i, j, k] = node.map(factor);
            [
                d_n[i][0] * m[j] * l[k],
                n[i] * d_m[j][0] * l[k],
                n[i] * m[j] * d_l[k][0],
            ]
        })
    }

    /// 2 × 2 × 2 or 3 × 3 × 3 points.
    fn rule(integration: Integration) -> Rule<3> {
        match integration {
            Integration::Reduced => Rule::hexahedron(2),
            Integration::Full | Integration::BBar => Rule::hexahedron(3),
        }
    }
}
