//! Tools that bear on a node which they do not reach; not why: the gap of a point between corners is that of its neighbours too.

use crate::checks::between::Between;
use crate::driver::Driver;
use crate::model::points::{ContactPoint, turned};

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
    /// Where a tool bears on a node between corners from farthest away, if that is more than
    /// [`Between::BESIDE_PRESSED`] of what the nodes are pressed in: facets are too long there beside its curve.
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
        let normal = turned(obstacle.normal(&x), &turn);
        let pressed = self.pressed(point.contact, &normal, far);
        (distance > (Between::<D>::BESIDE_PRESSED * pressed).max(NEAR * far)).then(|| Ahead {
            contact: point.contact,
            node: point.node,
            position: self.position(point.node).into(),
            distance,
            pressed,
        })
    }
}
