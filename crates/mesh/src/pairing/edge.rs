//! A straight or quadratic edge of a plane surface and the lines that meet it; not its cell.

use crate::geometry::{bounds, diagonal, dot};
use crate::mesh::NodeKind;
use crate::{Element, Line2, Line3};

/// A box, by its least and greatest corner.
pub(super) type Box<const D: usize> = ([f64; D], [f64; D]);

/// An edge of two or three nodes, outward on the right of its direction.
pub(super) struct Edge<const D: usize> {
    pub(super) nodes: Vec<usize>,
    pub(super) x: Vec<[f64; D]>,
}

impl<const D: usize> Edge<D> {
    pub(super) fn new(nodes: impl Iterator<Item = usize>, positions: &[[f64; D]]) -> Self {
        let nodes: Vec<usize> = nodes.collect();
        Self {
            x: nodes.iter().map(|&a| positions[a]).collect(),
            nodes,
        }
    }

    pub(super) fn kind(&self, local: usize) -> NodeKind {
        if local < 2 {
            NodeKind::Corner
        } else {
            NodeKind::Midside
        }
    }

    /// Reference coordinate of a node.
    pub(super) fn place(local: usize) -> f64 {
        Line3::NODES[local][0]
    }

    /// Shape functions; that of a middle which is not there is zero.
    pub(super) fn shape(&self, xi: f64) -> [f64; 3] {
        match self.nodes.len() {
            2 => {
                let [a, b] = Line2::shape([xi]);
                [a, b, 0.0]
            }
            _ => Line3::shape([xi]),
        }
    }

    fn gradient(&self, xi: f64) -> [f64; 3] {
        match self.nodes.len() {
            2 => {
                let [[a], [b]] = Line2::shape_gradient([xi]);
                [a, b, 0.0]
            }
            _ => Line3::shape_gradient([xi]).map(|[g]| g),
        }
    }

    /// The point x(ξ).
    pub(super) fn at(&self, xi: f64) -> [f64; D] {
        combine(&self.shape(xi), &self.x)
    }

    fn tangent(&self, xi: f64) -> [f64; D] {
        combine(&self.gradient(xi), &self.x)
    }

    /// |∂x/∂ξ|.
    pub(super) fn stretch(&self, xi: f64) -> f64 {
        let t = self.tangent(xi);
        dot(&t, &t).sqrt()
    }

    /// The outward normal, of length |∂x/∂ξ|.
    pub(super) fn outward(&self, xi: f64) -> [f64; D] {
        let t = self.tangent(xi);
        std::array::from_fn(|i| if i == 0 { t[1] } else { -t[0] })
    }

    pub(super) fn size(&self) -> f64 {
        diagonal(&self.x)
    }

    pub(super) fn bounds(&self, more: &[[f64; D]]) -> Box<D> {
        bounds(&[&self.x, more].concat())
    }

    /// Where a line through x along n meets the edge from outside; `None` if it does not, or from
    /// inside the edge's body.
    pub(super) fn hit(&self, x: &[f64; D], n: &[f64; D]) -> Option<f64> {
        let side = |xi: f64| cross(&difference(x, &self.at(xi)), n);
        let (first, second) = (side(-1.0), side(1.0));
        // Surfaces that face each other are walked in opposite directions.
        (first >= 0.0 && second <= 0.0 && first > second).then(|| root(side, first, second))
    }
}

/// Zero in [−1, 1] of a function with f(−1) ≥ 0 ≥ f(1), by the Illinois variant of regula falsi.
pub(super) fn root(f: impl Fn(f64) -> f64, at_low: f64, at_high: f64) -> f64 {
    let (mut low, mut high) = ((-1.0, at_low), (1.0, at_high));
    let mut xi = 0.0;
    let mut last = 0.0f64;
    for _ in 0..100 {
        if low.1 == 0.0 || high.1 == 0.0 {
            return if low.1 == 0.0 { low.0 } else { high.0 };
        }
        xi = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let value = f(xi);
        if high.0 - low.0 <= 4.0 * f64::EPSILON || value.abs() <= f64::EPSILON * (at_low - at_high)
        {
            break;
        }
        if value > 0.0 {
            low = (xi, value);
            high.1 *= if last > 0.0 { 0.5 } else { 1.0 };
        } else {
            high = (xi, value);
            low.1 *= if last < 0.0 { 0.5 } else { 1.0 };
        }
        last = value;
    }
    xi
}

/// Σ weights·points.
pub(super) fn combine<const D: usize>(weights: &[f64; 3], points: &[[f64; D]]) -> [f64; D] {
    crate::geometry::interpolate(weights, points)
}

pub(super) fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] - b[i])
}

pub(super) fn cross<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn unit<const D: usize>(v: &[f64; D]) -> [f64; D] {
    let length = dot(v, v).sqrt();
    v.map(|c| c / length)
}

/// Distance from a to b along a direction.
pub(super) fn along<const D: usize>(a: &[f64; D], b: &[f64; D], n: &[f64; D]) -> f64 {
    dot(&difference(b, a), &unit(n))
}

/// The box around points, wider by a margin.
pub(super) fn hull<const D: usize>(points: impl Iterator<Item = [f64; D]>, margin: f64) -> Box<D> {
    let (low, high) = bounds(&points.collect::<Vec<_>>());
    (low.map(|v| v - margin), high.map(|v| v + margin))
}
