//! The outlines of rigid tools in the plane where they are in an increment; not what they press.

use crate::deck::{Deck, Shape};
use crate::table::Table;
use std::f64::consts::TAU;

/// Points of a circle.
const ROUND: u32 = 720;

/// How far a line without ends is drawn, in sizes of the mesh.
const FAR: f64 = 10.0;

/// The outlines of the tools of a plane deck in a row of the history, with their translations magnified as
/// those of the body are, and their turns as they are. `size` is that of the mesh.
pub(super) fn outlines(
    deck: &Deck,
    (history, row): (&Table, usize),
    size: f64,
    magnification: f64,
) -> Vec<Vec<[f64; 2]>> {
    let number = |name: &str| history.numbers(name).get(row).copied().unwrap_or(0.0);
    let outline = |tool: &crate::deck::ToolEntry| {
        let name = &tool.name.value;
        let (points, reference) = shape(&tool.shape.value, FAR * size)?;
        let about = match &tool.reference {
            Some(given) => [given.value[0], given.value[1]],
            None => reference,
        };
        let u = ["x", "y"].map(|axis| magnification * number(&format!("u.{name}.{axis}")));
        let (s, c) = number(&format!("turn.{name}")).to_radians().sin_cos();
        let place = |x: [f64; 2]| {
            let [dx, dy] = [x[0] - about[0], x[1] - about[1]];
            [
                about[0] + u[0] + c * dx - s * dy,
                about[1] + u[1] + s * dx + c * dy,
            ]
        };
        Some(points.into_iter().map(place).collect())
    };
    deck.tools.iter().filter_map(outline).collect()
}

/// Points of a surface, and its reference point.
fn shape(shape: &Shape, far: f64) -> Option<(Vec<[f64; 2]>, [f64; 2])> {
    match shape {
        Shape::Plane(point, normal) => {
            let (point, length) = ([point[0], point[1]], normal[0].hypot(normal[1]));
            let along = [far * normal[1] / length, -far * normal[0] / length];
            let at = |s: f64| [point[0] + s * along[0], point[1] + s * along[1]];
            Some((vec![at(-1.0), at(1.0)], point))
        }
        Shape::Ball(center, radius, ..) => {
            let center = [center[0], center[1]];
            let at = |k: u32| {
                let (s, c) = (TAU * f64::from(k) / f64::from(ROUND)).sin_cos();
                [center[0] + radius * c, center[1] + radius * s]
            };
            Some(((0..=ROUND).map(at).collect(), center))
        }
        Shape::Polyline(points) => Some((points.clone(), *points.first()?)),
        Shape::Cylinder(..) => None,
    }
}
