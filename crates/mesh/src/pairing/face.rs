//! A facet of a surface, an edge in the plane and a face in space, and the lines that meet it; not
//! its cell.

use crate::geometry::{bounds, cofactors, diagonal, dot, interpolate};
use crate::mesh::{Change, NodeKind};
use crate::{Element, FacetKind, Line2, Line3, Quad4, Quad8, Quad9, Tri3, Tri6};

/// A box along the axes, by its least and greatest corner.
pub(super) type Aabb<const D: usize> = ([f64; D], [f64; D]);

/// Most nodes of a facet.
pub(super) const NODES: usize = 9;

/// Values of all nodes of a facet; those of nodes that are not there are zero.
pub(super) type Values = [f64; NODES];

/// Coordinates in the reference facet; an edge has the first alone.
pub(super) type Xi = [f64; 2];

/// How far outside a face a line may pass and still meet it, in reference coordinates: neighbours
/// leave no gap between them.
const OUTSIDE: f64 = 1e-9;

/// A facet with its nodes as they are now, outward as in [`Element::FACETS`].
pub(super) struct Face<const D: usize> {
    pub(super) kind: FacetKind,
    pub(super) nodes: Vec<usize>,
    pub(super) x: Vec<[f64; D]>,
    /// From the N_a to the Ñ_a of positive integrals, to which multipliers are dual.
    pub(super) change: Change,
    /// Which of the smooth parts of its surface it is of.
    pub(super) part: usize,
    /// Diagonal of the box around it \[mm\].
    size: f64,
    /// The outward unit normal at its middle.
    pub(super) facing: [f64; D],
}

/// Values of the nodes that there are.
pub(super) fn filled(values: &[f64]) -> Values {
    std::array::from_fn(|a| values.get(a).copied().unwrap_or(0.0))
}

impl<const D: usize> Face<D> {
    pub(super) fn new(
        kind: FacetKind,
        nodes: impl Iterator<Item = usize>,
        positions: &[[f64; D]],
        change: Change,
    ) -> Self {
        let nodes: Vec<usize> = nodes.collect();
        let x: Vec<[f64; D]> = nodes.iter().map(|&a| positions[a]).collect();
        let mut face = Self {
            kind,
            size: diagonal(&x),
            x,
            nodes,
            change,
            part: 0,
            facing: [0.0; D],
        };
        face.facing = unit(&face.outward(face.middle()));
        face
    }

    pub(super) fn node_kind(&self, local: usize) -> NodeKind {
        // A facet has as many edges as corners; one of the plane is its own edge.
        match local / self.kind.corner_count() {
            0 => NodeKind::Corner,
            1 => NodeKind::Midside,
            _ => NodeKind::Face,
        }
    }

    pub(super) fn corners(&self) -> &[[f64; D]] {
        &self.x[..self.kind.corner_count()]
    }

    /// Reference coordinates of the nodes.
    pub(super) fn places(&self) -> Vec<Xi> {
        self.kind.places()
    }

    /// Length of a side of the reference facet.
    pub(super) fn unit(&self) -> f64 {
        match self.kind {
            FacetKind::Tri3 | FacetKind::Tri6 => 1.0,
            _ => 2.0,
        }
    }

    /// Shape functions N_a.
    pub(super) fn shape(&self, xi: Xi) -> Values {
        self.kind.shape(xi)
    }

    /// The vectors ∂x/∂ξ; the first is none, and its cofactor the area vector.
    fn tangents(&self, xi: Xi) -> [[f64; D]; D] {
        fn along<const D: usize, const M: usize, const N: usize>(
            gradient: [[f64; M]; N],
            x: &[[f64; D]],
        ) -> [[f64; D]; D] {
            let sum = |i: usize, j: usize| gradient.iter().zip(x).map(|(g, x)| g[j] * x[i]).sum();
            std::array::from_fn(|j| match j {
                0 => [0.0; D],
                _ => std::array::from_fn(|i| sum(i, j - 1)),
            })
        }
        let x = &self.x;
        match self.kind {
            FacetKind::Line2 => along(Line2::shape_gradient([xi[0]]), x),
            FacetKind::Line3 => along(Line3::shape_gradient([xi[0]]), x),
            FacetKind::Tri3 => along(Tri3::shape_gradient(xi), x),
            FacetKind::Tri6 => along(Tri6::shape_gradient(xi), x),
            FacetKind::Quad4 => along(Quad4::shape_gradient(xi), x),
            FacetKind::Quad8 => along(Quad8::shape_gradient(xi), x),
            FacetKind::Quad9 => along(Quad9::shape_gradient(xi), x),
        }
    }

    /// The point x(ξ).
    pub(super) fn at(&self, xi: Xi) -> [f64; D] {
        interpolate(&self.shape(xi), &self.x)
    }

    /// The outward normal, as long as the ratio of area to reference area.
    pub(super) fn outward(&self, xi: Xi) -> [f64; D] {
        cofactors(&self.tangents(xi))[0]
    }

    /// Ratio of area to reference area.
    pub(super) fn stretch(&self, xi: Xi) -> f64 {
        let n = self.outward(xi);
        dot(&n, &n).sqrt()
    }

    pub(super) fn size(&self) -> f64 {
        self.size
    }

    pub(super) fn bounds(&self) -> Aabb<D> {
        bounds(&self.x)
    }

    /// Mean of the places of the corners.
    pub(super) fn middle(&self) -> Xi {
        match self.kind {
            FacetKind::Tri3 | FacetKind::Tri6 => [1.0 / 3.0; 2],
            _ => [0.0; 2],
        }
    }

    /// Whether x(ξ) is linear: a triangle with straight sides, a parallelogram.
    pub(super) fn is_affine(&self) -> bool {
        let (middle, places) = (self.middle(), self.places());
        let (from, along) = (self.at(middle), self.tangents(middle));
        let size = self.size();
        places.iter().zip(&self.x).all(|(xi, x)| {
            let linear: [f64; D] = std::array::from_fn(|i| {
                let moved = |j: usize| along[j][i] * (xi[j - 1] - middle[j - 1]);
                from[i] + (1..D).map(moved).sum::<f64>()
            });
            let apart = difference(x, &linear);
            dot(&apart, &apart).sqrt() <= 1e-12 * size
        })
    }

    /// Where a line through x along n meets the facet from outside; `None` if it does not, or from
    /// inside the facet's body.
    pub(super) fn hit(&self, x: &[f64; D], n: &[f64; D]) -> Option<Xi> {
        if D == 2 {
            let side = |xi: f64| cross(&difference(x, &self.at([xi, 0.0])), n);
            let (first, second) = (side(-1.0), side(1.0));
            // Surfaces that face each other are walked in opposite directions.
            let hit = first >= 0.0 && second <= 0.0 && first > second;
            return hit.then(|| [root(side, first, second), 0.0]);
        }
        let xi = self.below(&View::new(*x, n), [0.0; 2], self.middle())?;
        let inside = match self.kind {
            FacetKind::Tri3 | FacetKind::Tri6 => {
                xi[0].min(xi[1]).min(1.0 - xi[0] - xi[1]) >= -OUTSIDE
            }
            _ => xi[0].abs().max(xi[1].abs()) <= 1.0 + OUTSIDE,
        };
        (inside && dot(&self.outward(xi), n) < 0.0).then_some(xi)
    }

    /// Whether a place is within the face or next to it: farther outside its shape functions, which
    /// are continued there, say little.
    pub(super) fn is_near(&self, xi: &Xi) -> bool {
        let middle = self.middle();
        (0..2).all(|i| (xi[i] - middle[i]).abs() <= self.unit())
    }

    /// The place that is seen at a point of a view, by Newton's method from a first guess; `None` if
    /// none is found, as may happen far outside.
    pub(super) fn below(&self, view: &View<D>, point: [f64; 2], guess: Xi) -> Option<Xi> {
        let mut xi = guess;
        for _ in 0..30 {
            let missing = view.of(&self.at(xi));
            let missing = [0, 1].map(|i| point[i] - missing[i]);
            let tangents = self.tangents(xi);
            let a = [1, 2].map(|j| view.of_direction(&tangents[j]));
            let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
            let step = [
                (missing[0] * a[1][1] - missing[1] * a[1][0]) / det,
                (missing[1] * a[0][0] - missing[0] * a[0][1]) / det,
            ];
            xi = [xi[0] + step[0], xi[1] + step[1]];
            if !xi.iter().all(|v| v.abs() < 1e3) {
                // Far outside, or NaN.
                return None;
            }
            // Quadratic convergence: the next step is below rounding.
            if step[0].abs().max(step[1].abs()) <= 1e-9 {
                return Some(xi);
            }
        }
        None
    }
}

/// What is seen along a direction in space: coordinates in the plane across it.
pub(super) struct View<const D: usize> {
    origin: [f64; D],
    /// The direction; the viewer looks against it.
    pub(super) normal: [f64; D],
    axes: [[f64; D]; 2],
}

impl<const D: usize> View<D> {
    /// With a normal of any length.
    pub(super) fn new(origin: [f64; D], normal: &[f64; D]) -> Self {
        let n = unit(normal);
        let least = (0..D).min_by(|&i, &j| n[i].abs().total_cmp(&n[j].abs()));
        let least = least.unwrap_or(0);
        let first = unit(&std::array::from_fn(|i| {
            f64::from(u8::from(i == least)) - n[least] * n[i]
        }));
        // n × first.
        let frame = std::array::from_fn(|j| match j {
            1 => n,
            2 => first,
            _ => [0.0; D],
        });
        Self {
            origin,
            normal: n,
            axes: [first, cofactors(&frame)[0]],
        }
    }

    pub(super) fn of(&self, x: &[f64; D]) -> [f64; 2] {
        self.of_direction(&difference(x, &self.origin))
    }

    fn of_direction(&self, v: &[f64; D]) -> [f64; 2] {
        [0, 1].map(|i| dot(&self.axes[i], v))
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

pub(super) fn difference<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// In the plane of the first two axes.
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
pub(super) fn hull<const D: usize>(points: impl Iterator<Item = [f64; D]>, margin: f64) -> Aabb<D> {
    let (low, high) = bounds(&points.collect::<Vec<_>>());
    (low.map(|v| v - margin), high.map(|v| v + margin))
}
