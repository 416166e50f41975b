//! A rigid profile of straight pieces in the plane; not a closed body, not a surface in space.

use crate::{ContactError, Corner, Obstacle};
use nalgebra::{Matrix2, Vector2};

/// A rigid obstacle bounded by an open polyline, in the plane, that lies on the right of it.
///
/// Its first and last segments go on for ever: the line has two sides everywhere, and a node that
/// slides past its last point does not fall off. Seen from a convex corner the normal turns
/// continuously from that of one segment to that of the next; at the corner itself it halves the
/// angle. In a concave corner it jumps where both segments are equally near; there the first one
/// is taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    points: Vec<Vector2<f64>>,
}

/// A corner nearer than this part of the length of a segment has no direction to the point.
const COINCIDENT: f64 = 1e-12;

impl Polyline {
    /// The polyline through points, at least two.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for fewer points, coordinates that are not finite, segments of
    /// length zero, and lines that turn back on themselves or cross themselves, their first and last
    /// segments prolonged.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, ContactError> {
        let refused = |what, value, expected| {
            Err(ContactError::OutOfRange {
                what,
                value,
                expected,
            })
        };
        if points.len() < 2 {
            let count = points.len() as f64;
            return refused("number of points of the polyline", count, "at least 2");
        }
        if let Some(&x) = points.iter().flatten().find(|x| !x.is_finite()) {
            return refused("point of the polyline", x, "finite coordinates");
        }
        let points: Vec<Vector2<f64>> = points.iter().map(|&x| x.into()).collect();
        let line = Self { points };
        for k in 0..line.segments() {
            let length = line.along(k).norm();
            if !(length > 0.0 && length.is_finite()) {
                let what = "length of a segment of the polyline";
                return refused(what, length, "a positive number");
            }
        }
        for k in 1..line.segments() {
            let (a, b) = (line.along(k - 1).normalize(), line.along(k).normalize());
            if a.dot(&b) < 0.0 && a.perp(&b).abs() < COINCIDENT {
                let what = "cosine of a corner of the polyline";
                return refused(what, a.dot(&b), "no turn back on itself");
            }
            for j in 0..k - 1 {
                if let Some(at) = line.crossing(j, k) {
                    let what = "crossing of the polyline with itself, at segment";
                    return refused(what, at + j as f64, "none, with both ends prolonged");
                }
            }
        }
        Ok(line)
    }

    fn segments(&self) -> usize {
        self.points.len() - 1
    }

    /// From the start of segment k to its end.
    fn along(&self, k: usize) -> Vector2<f64> {
        self.points[k + 1] - self.points[k]
    }

    /// Unit normal of segment k, to its left.
    fn left(&self, k: usize) -> Vector2<f64> {
        let along = self.along(k).normalize();
        Vector2::new(-along.y, along.x)
    }

    /// Part of segment k nearest to `s`: within [0, 1], but for the ends of the line.
    fn clamped(&self, k: usize, s: f64) -> f64 {
        let low = if k == 0 { f64::NEG_INFINITY } else { 0.0 };
        let high = match k + 1 == self.segments() {
            true => f64::INFINITY,
            false => 1.0,
        };
        s.clamp(low, high)
    }

    /// Where segment j is crossed by segment k, in parts of j.
    fn crossing(&self, j: usize, k: usize) -> Option<f64> {
        let (a, b) = (self.along(j), self.along(k));
        let between = self.points[k] - self.points[j];
        let det = a.perp(&b);
        let (s, t) = (between.perp(&b) / det, between.perp(&a) / det);
        // Parallel segments do not cross: s and t are infinite or NaN.
        (s.is_finite() && t.is_finite() && self.clamped(j, s) == s && self.clamped(k, t) == t)
            .then_some(s)
    }

    /// The segment nearest to a point, and the part of it where it is.
    fn nearest_segment(&self, x: &Vector2<f64>) -> (usize, f64) {
        let mut best = (f64::INFINITY, 0, 0.0);
        for k in 0..self.segments() {
            let along = self.along(k);
            let s = self.clamped(k, (x - self.points[k]).dot(&along) / along.norm_squared());
            let squared = (x - self.points[k] - along * s).norm_squared();
            if squared < best.0 {
                best = (squared, k, s);
            }
        }
        (best.1, best.2)
    }

    /// Signed distance and normal.
    fn nearest(&self, x: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let (k, s) = self.nearest_segment(x);
        let corner = match s {
            0.0 if k > 0 => k,
            1.0 if k + 1 < self.segments() => k + 1,
            _ => {
                let normal = self.left(k);
                return ((x - self.points[k]).dot(&normal), normal);
            }
        };
        let bisector = self.left(corner - 1) + self.left(corner);
        let from = x - self.points[corner];
        let (side, length) = (from.dot(&bisector).signum(), from.norm());
        match length > COINCIDENT * self.along(k).norm() {
            true => (side * length, from * (side / length)),
            false => (side * length, bisector.normalize()),
        }
    }
}

impl Obstacle<2> for Polyline {
    fn distance(&self, x: &Vector2<f64>) -> f64 {
        self.nearest(x).0
    }

    fn normal(&self, x: &Vector2<f64>) -> Vector2<f64> {
        self.nearest(x).1
    }

    fn curvature(&self, x: &Vector2<f64>) -> Matrix2<f64> {
        let (k, s) = self.nearest_segment(x);
        let corner = match s {
            0.0 if k > 0 => k,
            1.0 if k + 1 < self.segments() => k + 1,
            _ => return Matrix2::zeros(),
        };
        // About a corner the normal turns as that of a circle.
        let (n, from) = (self.normal(x), (x - self.points[corner]).norm());
        match from > COINCIDENT * self.along(k).norm() {
            true => (Matrix2::identity() - n * n.transpose()) * (self.distance(x).signum() / from),
            false => Matrix2::zeros(),
        }
    }

    fn way(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> Vector2<f64> {
        let place = |x: &Vector2<f64>| {
            let (k, s) = self.nearest_segment(x);
            let before: f64 = (0..k).map(|j| self.along(j).norm()).sum();
            before + s * self.along(k).norm()
        };
        let n = self.normal(to);
        Vector2::new(n.y, -n.x) * (place(to) - place(from))
    }

    fn reference(&self) -> Vector2<f64> {
        self.points[0]
    }

    fn corner(&self, x: &Vector2<f64>, tolerance: f64) -> Option<Corner<2>> {
        let (nearest, _) = self.nearest_segment(x);
        let ends = [nearest, nearest + 1].into_iter();
        let inner = ends.filter(|&k| k > 0 && k < self.segments());
        let mut corners = inner.filter_map(|k| {
            let (before, after) = (self.left(k - 1), self.left(k));
            let axis = (before + after).normalize();
            let across = (x - self.points[k]).perp(&axis);
            let convex = self.along(k - 1).perp(&self.along(k)) < 0.0;
            (convex && across.abs() <= tolerance).then(|| Corner {
                position: self.points[k],
                axis,
                half_angle: 0.5 * before.angle(&after),
            })
        });
        corners.next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ball, Plane};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    /// A line that bends to the right at every corner: convex, seen from its left.
    fn hill(turns: &[f64]) -> Polyline {
        let (mut x, mut angle) = ([-3.0, 0.0], 0.6f64);
        let mut points = vec![x];
        for turn in turns {
            x = [x[0] + angle.cos(), x[1] + angle.sin()];
            points.push(x);
            angle -= turn;
        }
        Polyline::new(&points).expect("valid")
    }

    proptest! {
        #[test]
        fn normals_are_gradients_of_the_distance(
            turns in prop::collection::vec(0.05..0.35f64, 1..6),
            x in prop::array::uniform2(-6.0..6.0f64),
        ) {
            let (line, x) = (hill(&turns), Vector2::from(x));
            let n = line.normal(&x);
            prop_assert!((n.norm() - 1.0).abs() < 1e-12);
            // Inside the tool the nearest segment may change; outside, the distance is smooth.
            if line.distance(&x) > 1e-3 {
                let h = 1e-6;
                for axis in 0..2 {
                    let mut e = Vector2::zeros();
                    e[axis] = h;
                    let slope = (line.distance(&(x + e)) - line.distance(&(x - e))) / (2.0 * h);
                    prop_assert!((slope - n[axis]).abs() < 1e-5, "{slope} {n}");
                }
            }
        }

        #[test]
        fn the_normal_turns_continuously_around_a_convex_corner(
            turns in prop::collection::vec(0.05..0.35f64, 1..6),
            x in prop::array::uniform2(-6.0..6.0f64),
            step in prop::array::uniform2(-1e-3..1e-3f64),
        ) {
            let (line, x, step) = (hill(&turns), Vector2::from(x), Vector2::from(step));
            let distance = line.distance(&x);
            prop_assume!(distance > 0.1 && line.distance(&(x + step)) > 0.1);
            let turn = (line.normal(&(x + step)) - line.normal(&x)).norm();
            prop_assert!(turn <= 1.01 * step.norm() / distance, "{turn}");
        }

        #[test]
        fn the_distance_is_that_to_the_nearest_point(
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0f64), 2..6),
            x in prop::array::uniform2(-4.0..4.0f64),
        ) {
            // Most lines at random cross themselves.
            let Ok(line) = Polyline::new(&points) else { return Ok(()) };
            let x = Vector2::from(x);
            let distance = line.distance(&x).abs();
            // No point of the line is nearer, and the one along the normal is on the line.
            for k in 0..line.segments() {
                for i in -100..=100 {
                    let s = line.clamped(k, 0.05 * f64::from(i));
                    let point = line.points[k] + line.along(k) * s;
                    prop_assert!((point - x).norm() >= distance - 1e-12);
                }
            }
            let foot = x - line.normal(&x) * line.distance(&x);
            prop_assert!(line.distance(&foot).abs() < 1e-9);
        }

        #[test]
        fn one_segment_is_a_plane(
            a in prop::array::uniform2(-3.0..3.0f64),
            b in prop::array::uniform2(4.0..6.0f64),
            x in prop::array::uniform2(-9.0..9.0f64),
        ) {
            let line = Polyline::new(&[a, b]).expect("valid");
            let plane = Plane::new(a, [a[1] - b[1], b[0] - a[0]]).expect("valid");
            let x = Vector2::from(x);
            prop_assert!((line.distance(&x) - plane.distance(&x)).abs() < 1e-12);
            prop_assert!((line.normal(&x) - plane.normal(&x)).norm() < 1e-12);
        }
    }

    /// Half a circle of short chords is the circle, but for their sagitta.
    #[test]
    fn many_segments_are_a_ball() {
        let arc = |n: i32, sign: f64| -> Vec<[f64; 2]> {
            let angle = |k: i32| sign * (0.5 * PI - PI * f64::from(k) / f64::from(n));
            (0..=n)
                .map(|k| [-angle(k).sin() * 2.0, angle(k).cos() * 2.0])
                .collect()
        };
        let ball = Ball::new([0.0, 0.0], 2.0).expect("valid");
        let sagitta = 2.0 * (1.0 - (0.5 * PI / 200.0).cos());
        for (sign, ball) in [(-1.0, ball.hollow()), (1.0, ball)] {
            // From right to left over the top the ball is on the left: a hollow; and back.
            let line = Polyline::new(&arc(200, sign)).expect("valid");
            for (r, phi) in [(1.0, 1.2), (1.9, 0.7), (2.0, 1.5), (2.5, 2.2), (4.0, 0.4)] {
                let x = Vector2::new(r * f64::cos(phi), r * f64::sin(phi));
                let difference = (line.distance(&x) - ball.distance(&x)).abs();
                assert!(difference <= sagitta + 1e-12, "{sign} {r}: {difference}");
                assert!(
                    (line.normal(&x) - ball.normal(&x)).norm() < 0.02,
                    "{sign} {r}"
                );
            }
        }
    }

    #[test]
    fn the_corner_itself_halves_the_angle() {
        let line = Polyline::new(&[[-1.0, 0.0], [0.0, 0.0], [0.0, -1.0]]).expect("valid");
        let half = 0.5f64.sqrt();
        let n = line.normal(&Vector2::zeros());
        assert!((n - Vector2::new(half, half)).norm() < 1e-15);
        assert_eq!(line.distance(&Vector2::new(-0.25, -0.5)), -0.25);
        assert_eq!(line.distance(&Vector2::new(3.0, 4.0)), 5.0);
        // Beyond its last point the line goes on.
        assert_eq!(line.distance(&Vector2::new(2.0, -9.0)), 2.0);
    }

    #[test]
    fn bad_polylines_are_refused() {
        for points in [
            &[[0.0, 0.0]][..],
            &[[0.0, 0.0], [0.0, 0.0]],
            &[[0.0, 0.0], [f64::NAN, 0.0]],
            &[[0.0, 0.0], [1.0, 0.0], [0.5, 0.0]],
            &[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.5, -1.0]],
            // The ends, prolonged, cross.
            &[[0.0, 0.0], [1.0, 1.0], [3.0, 1.0], [2.0, 0.0], [1.0, -0.5]],
        ] {
            assert!(Polyline::new(points).is_err(), "{points:?}");
        }
    }
}
