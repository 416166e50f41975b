//! Tools that bear on a node which they do not reach; not why: the gap of a point between corners is that of its neighbours too.

use crate::checks::between::Between;
use crate::driver::Driver;
use crate::model::points::{ContactPoint, turned};
use nalgebra::SVector;

/// Where a tool bears farthest ahead of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ahead<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The node that bears.
    pub node: usize,
    /// Where it is now \[mm\].
    pub position: [f64; D],
    /// How far the tool is from it \[mm\].
    pub distance: f64,
    /// How far the nodes of the surface have been pressed in along the normal there, against each other \[mm\].
    pub pressed: f64,
}

/// Part of a facet that is no distance.
const NEAR: f64 = 1e-6;

impl<const D: usize> Driver<D> {
    /// Where a tool bears on a node between corners from farthest away, if its curve, or that of the surface in the mesh, makes
    /// more than [`Between::BESIDE_PRESSED`] of what the nodes are pressed in of that: facets are too long there. What the
    /// surface bends under its loads is another matter: a straight side that a plane holds down at one of its corners has the
    /// other at five times the distance of the node between.
    pub fn bears_ahead(&self) -> Option<Ahead<D>> {
        let points = self.points.iter().enumerate();
        let all = points.filter_map(|(k, point)| self.ahead(k, point));
        all.max_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    fn ahead(&self, k: usize, point: &ContactPoint<D>) -> Option<Ahead<D>> {
        let bears = point.own.len() > 1 && self.state.contacts[k].t[0] > 0.0;
        let tool = point.tool.filter(|_| bears)?;
        let (body, turn) = (&self.tools[tool], self.state.loading.turn_of(tool));
        let at = self.displacement(self.tool_node(tool));
        let seen = |a: usize| body.seen(self.position(a) - at, &turn);
        let x = seen(point.node);
        let obstacle = body.opposite(point);
        let distance = obstacle.distance(&x) - point.offset;
        let far = point.own.iter().map(|&(a, _)| (seen(a) - x).norm());
        let far = far.fold(0.0, f64::max);
        // What the gap of the point has beyond that of the node, were the tool a plane and the surface not moved.
        let n = obstacle.normal(&x);
        let normal = turned(n, &turn);
        let virgin = |a: usize| SVector::<f64, D>::from(self.mesh.nodes()[a]);
        let curve = |&(a, weight): &(usize, f64)| {
            let (way, side) = (seen(a) - x, virgin(a) - virgin(point.node));
            let beyond = obstacle.distance(&seen(a)) - obstacle.distance(&x) - n.dot(&way);
            weight * (beyond + normal.dot(&side))
        };
        let curved = -point.own.iter().map(curve).sum::<f64>();
        let pressed = self.pressed(point.contact, &normal, far);
        let least = (Between::<D>::BESIDE_PRESSED * pressed).max(NEAR * far);
        (distance.min(curved) > least).then(|| Ahead {
            contact: point.contact,
            node: point.node,
            position: self.position(point.node).into(),
            distance,
            pressed,
        })
    }
}
