//! The surfaces of rigid tools as points and pieces between them, and where they are; not what they press.

use crate::deck::{Shape, ToolEntry};
use crate::vtu::three;
use moreau_contact::Polyline;
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{PI, TAU};

/// Segments of a circle in the plane.
const ROUND: usize = 720;

/// Pieces along a surface in space, and around it.
const GRID: [usize; 2] = [12, 48];

/// The surface of a tool where it was at first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sheet {
    pub(crate) points: Vec<Vector3<f64>>,
    /// Segments of the plane; triangles and quadrilaterals of space.
    pub(crate) pieces: Vec<Vec<usize>>,
    /// What it turns about.
    reference: Vector3<f64>,
}

/// Where a tool is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pose {
    pub(crate) translation: Vector3<f64>,
    /// Along the axis, as long as the angle \[rad\].
    pub(crate) turn: Vector3<f64>,
}

impl Sheet {
    /// The surface of a tool of a model of a dimension, `reach` \[mm\] around what of it is nearest to a point.
    pub(crate) fn new(tool: &ToolEntry, dimension: usize, to: Vector3<f64>, reach: f64) -> Self {
        let vector = |v: &[f64]| Vector3::from(three(v));
        let (points, pieces, reference) = match (&tool.shape.value, dimension) {
            (Shape::Polyline(points, radii), _) => {
                let first = points.first().map_or(Vector3::zeros(), |x| vector(x));
                let rounded = Polyline::rounded(points, radii).map(|line| line.outline());
                let points = rounded.unwrap_or_else(|_| points.clone());
                (points.iter().map(|x| vector(x)).collect(), None, first)
            }
            (Shape::Plane(point, normal), 2) => {
                let (point, n) = (vector(point), vector(normal).normalize());
                let (foot, along) = (to - n * n.dot(&(to - point)), Vector3::new(n.y, -n.x, 0.0));
                let ends = vec![foot - along * reach, foot + along * reach];
                (ends, None, point)
            }
            (Shape::Plane(point, normal), _) => {
                let (point, n) = (vector(point), vector(normal).normalize());
                let foot = to - n * n.dot(&(to - point));
                let [along, across] = perpendicular(&n);
                let at = |s: f64, t: f64| foot + (along * s + across * t) * reach;
                let side = [-1.0, 1.0];
                let points = grid([GRID[0]; 2], |[s, t]| at(mix(side, s), mix(side, t)));
                (points, Some(quadrilaterals([GRID[0]; 2], false)), point)
            }
            (Shape::Ball(center, radius, ..), 2) => {
                let center = vector(center);
                let at = |k: usize| {
                    let (s, c) = (TAU * k as f64 / ROUND as f64).sin_cos();
                    center + Vector3::new(c, s, 0.0) * *radius
                };
                ((0..=ROUND).map(at).collect(), None, center)
            }
            (Shape::Ball(center, radius, ..), _) => {
                let center = vector(center);
                let pole = towards(to - center, Vector3::z());
                let [along, across] = perpendicular(&pole);
                let most = (reach / radius).min(PI);
                let points = grid(GRID, |[s, t]| {
                    let ((sin, cos), (b, a)) = ((most * s).sin_cos(), (TAU * t).sin_cos());
                    center + (pole * cos + (along * a + across * b) * sin) * *radius
                });
                (points, Some(quadrilaterals(GRID, true)), center)
            }
            (Shape::Triangles(entry), _) => {
                let skin = &entry.skin;
                let points: Vec<_> = skin.points.iter().map(|x| vector(x)).collect();
                let pieces = skin.triangles.iter().map(|t| t.to_vec());
                let first = skin.triangles[0][0];
                let first = points[first];
                (points, Some(pieces.collect()), first)
            }
            (Shape::Cylinder(center, axis, radius, _), _) => {
                let (center, axis) = (vector(center), vector(axis).normalize());
                let foot = center + axis * axis.dot(&(to - center));
                let out = towards(to - foot, perpendicular(&axis)[0]);
                let across = axis.cross(&out);
                let most = (reach / radius).min(PI);
                let points = grid(GRID, |[s, t]| {
                    let (b, a) = (most * (2.0 * t - 1.0)).sin_cos();
                    foot + axis * mix([-reach, reach], s) + (out * a + across * b) * *radius
                });
                (points, Some(quadrilaterals(GRID, false)), center)
            }
        };
        let chain = || (1..points.len()).map(|k| vec![k - 1, k]).collect();
        let pieces: Vec<Vec<usize>> = pieces.unwrap_or_else(chain);
        let reference = tool
            .reference
            .as_ref()
            .map_or(reference, |r| vector(&r.value));
        Self {
            points,
            pieces,
            reference,
        }
    }

    /// How far each of the points has gone to where the tool is \[mm\].
    pub(crate) fn displacement(&self, pose: &Pose) -> impl Iterator<Item = Vector3<f64>> {
        let turn = Rotation3::new(pose.turn);
        let gone = move |x: &Vector3<f64>| {
            let from = x - self.reference;
            pose.translation + turn * from - from
        };
        self.points.iter().map(gone)
    }
}

/// A point between two.
fn mix([a, b]: [f64; 2], s: f64) -> f64 {
    a + s * (b - a)
}

/// The direction of a vector, or another where it has none.
fn towards(v: Vector3<f64>, otherwise: Vector3<f64>) -> Vector3<f64> {
    v.try_normalize(1e-12).unwrap_or(otherwise)
}

/// Two directions across a unit vector and across each other.
fn perpendicular(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let least = n.iamin();
    let first = n.cross(&Vector3::ith(least, 1.0)).normalize();
    [first, n.cross(&first)]
}

/// Points at all (s, t) of a grid over the unit square, row by row.
fn grid([rows, columns]: [usize; 2], at: impl Fn([f64; 2]) -> Vector3<f64>) -> Vec<Vector3<f64>> {
    let part = |k: usize, n: usize| k as f64 / n as f64;
    let all = (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j)));
    all.map(|(i, j)| at([part(i, rows), part(j, columns)]))
        .collect()
}

/// The pieces of a grid; those of the first row are triangles where that is one point.
fn quadrilaterals([rows, columns]: [usize; 2], pole: bool) -> Vec<Vec<usize>> {
    let node = |i: usize, j: usize| i * (columns + 1) + j;
    let all = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let piece = |(i, j): (usize, usize)| match pole && i == 0 {
        true => vec![node(0, 0), node(1, j), node(1, j + 1)],
        false => vec![
            node(i, j),
            node(i + 1, j),
            node(i + 1, j + 1),
            node(i, j + 1),
        ],
    };
    all.map(piece).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::At;

    fn tool(shape: Shape) -> ToolEntry {
        ToolEntry {
            name: At::new("die".into(), 0..0),
            shape: At::new(shape, 0..0),
            reference: None,
        }
    }

    /// Every point of a sheet is on its surface, and what is nearest to the body is in it.
    #[test]
    fn sheets_lie_on_their_surfaces() {
        let (to, reach) = (Vector3::new(1.0, 2.0, 0.5), 3.0);
        let center = vec![0.5, -4.0, 1.0];
        let (c, axis) = (Vector3::from(three(&center)), Vector3::new(0.0, 0.6, 0.8));
        for radius in [0.3, 5.0, 400.0] {
            let ball = tool(Shape::Ball(center.clone(), radius, false, "ball"));
            let sheet = Sheet::new(&ball, 3, to, reach);
            let off = |x: &Vector3<f64>| ((x - c).norm() - radius).abs();
            assert!(sheet.points.iter().all(|x| off(x) < 1e-9));
            assert!((sheet.points[0] - c).normalize().dot(&(to - c).normalize()) > 1.0 - 1e-12);
            let hollow = Shape::Cylinder(center.clone(), vec![0.0, 3.0, 4.0], radius, true);
            let sheet = Sheet::new(&tool(hollow), 3, to, reach);
            let off = |x: &Vector3<f64>| ((x - c).cross(&axis).norm() - radius).abs();
            assert!(sheet.points.iter().all(|x| off(x) < 1e-9));
            assert!(
                sheet
                    .pieces
                    .iter()
                    .flatten()
                    .all(|&k| k < sheet.points.len())
            );
        }
        let plane = tool(Shape::Plane(center, vec![0.0, 3.0, 4.0]));
        let sheet = Sheet::new(&plane, 3, to, reach);
        assert!(
            sheet
                .points
                .iter()
                .all(|x| (x - c).dot(&axis).abs() < 1e-12)
        );
    }

    #[test]
    fn a_tool_turns_about_its_reference() {
        let line = tool(Shape::Polyline(vec![[1.0, 0.0], [3.0, 0.0]], Vec::new()));
        let sheet = Sheet::new(&line, 2, Vector3::zeros(), 1.0);
        let pose = Pose {
            translation: Vector3::new(0.0, -1.0, 0.0),
            turn: Vector3::new(0.0, 0.0, 0.5 * PI),
        };
        let gone: Vec<_> = sheet.displacement(&pose).collect();
        assert!((gone[0] - Vector3::new(0.0, -1.0, 0.0)).norm() < 1e-15);
        assert!((gone[1] - Vector3::new(-2.0, 1.0, 0.0)).norm() < 1e-15);
    }
}
