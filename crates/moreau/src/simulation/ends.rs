//! Nodes that bear on a tool beyond the ends of its line; not what is told of them.

use crate::deck::Deck;
use crate::deck::Shape;
use crate::driver::{ContactRecord, Driver};
use nalgebra::{Rotation2, Vector2};

/// Part of the way beyond the end by which a node may be beside the line there, and still bear on that.
const BESIDE: f64 = 1e-2;

/// Where a node bears farthest beyond an end of the line of its tool.
pub(super) struct End {
    /// Index of the contact.
    pub(super) contact: usize,
    pub(super) node: usize,
    /// Where the node is now.
    pub(super) position: Vec<f64>,
    /// How far beyond the end.
    pub(super) beyond: f64,
    /// Nodes that bear beyond an end of their tool.
    pub(super) count: usize,
    /// Whether the end is that of the last point.
    pub(super) is_last: bool,
}

impl End {
    /// Of all nodes that bear on lines of several segments, the one farthest beyond: two points alone are a plane.
    pub(super) fn farthest<const D: usize>(driver: &Driver<D>, deck: &Deck) -> Option<Self> {
        let all = driver.contacts().iter();
        let beyond: Vec<Self> = all.filter_map(|c| Self::of(driver, deck, c)).collect();
        let count = beyond.len();
        let farthest = beyond
            .into_iter()
            .max_by(|a, b| a.beyond.total_cmp(&b.beyond));
        farthest.map(|end| Self { count, ..end })
    }

    fn of<const D: usize>(
        driver: &Driver<D>,
        deck: &Deck,
        record: &ContactRecord<D>,
    ) -> Option<Self> {
        let (_, name) = driver.contact_name(record.contact);
        let tool = deck.tools.iter().find(|t| t.name.value == name)?;
        let Shape::Polyline(points, _) = &tool.shape.value else {
            return None;
        };
        if points.len() < 3 || record.t[0] <= driver.rounding_of_forces() {
            return None;
        }
        let now = driver.mesh().nodes()[record.node];
        let moved = driver.displacement(record.node);
        let position: Vec<f64> = (0..D).map(|i| now[i] + moved[i]).collect();
        let reference = match &tool.reference {
            Some(reference) => Vector2::new(reference.value[0], reference.value[1]),
            None => Vector2::from(points[0]),
        };
        let way = driver.tool_displacement(name).ok()?;
        let turn = Rotation2::new(-driver.tool_turn(name).ok()?[2]);
        let from = Vector2::new(position[0] - way[0], position[1] - way[1]) - reference;
        let seen = reference + turn * from;
        let near = driver.rounding_of_gaps();
        let past = |end: [f64; 2], before: [f64; 2]| {
            let along = (Vector2::from(end) - Vector2::from(before)).normalize();
            let from = seen - Vector2::from(end);
            let beyond = from.dot(&along);
            let bears = beyond > near && from.perp(&along).abs() <= BESIDE * beyond + near;
            bears.then_some(beyond)
        };
        let last = points.len() - 1;
        let ends = [
            past(points[0], points[1]),
            past(points[last], points[last - 1]),
        ];
        let found = match ends {
            [_, Some(beyond)] => (beyond, true),
            [Some(beyond), None] => (beyond, false),
            [None, None] => return None,
        };
        Some(Self {
            contact: record.contact,
            node: record.node,
            position,
            beyond: found.0,
            count: 1,
            is_last: found.1,
        })
    }
}
