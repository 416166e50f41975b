//! A rigid profile of straight pieces in the plane, its corners sharp or rounded; not a closed body, not a surface in
//! space.

use crate::{ContactError, Corner, Obstacle};
use nalgebra::{Matrix2, Vector2};
use std::ops::Range;

/// A rigid obstacle bounded by an open polyline, in the plane, that lies on the right of it; corners may be
/// rounded by arcs.
///
/// Its first and last segments go on for ever: the line has two sides everywhere, and a node that
/// slides past its last point does not fall off. Seen from a sharp convex corner the normal turns
/// continuously from that of one segment to that of the next; at the corner itself it halves the
/// angle. In a sharp concave corner it jumps where both segments are equally near; there the first one
/// is taken. A node that lies in such a corner touches both: its [`parts`](Obstacle::parts) end there.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    first: Vector2<f64>,
    pieces: Vec<Piece>,
    /// How far the first and the last piece go on \[mm\].
    beyond: [f64; 2],
    /// The line that it is a part of.
    of: Option<Box<Whole>>,
}

/// A line of which another is a part.
#[derive(Debug, Clone, PartialEq)]
struct Whole {
    line: Polyline,
    /// The pieces that the part has.
    pieces: Range<usize>,
}

/// A piece of constant curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: Vector2<f64>,
    /// Unit tangent at the start.
    along: Vector2<f64>,
    length: f64,
    /// Curvature \[1/mm\]: of a segment zero, positive where the line bends to the left.
    bend: f64,
}

/// The point of the line nearest to another.
#[derive(Debug, Clone, Copy)]
struct Foot {
    piece: usize,
    /// Length along the piece \[mm\].
    s: f64,
    /// The sharp corner that it is: between this piece and the one before.
    corner: Option<usize>,
}

/// A corner nearer than this part of the length of a segment has no direction to the point, and one of a
/// smaller sine is none.
const COINCIDENT: f64 = 1e-12;

/// Angle of a concave corner from which on a node in it touches both sides \[rad\]; those of arcs made of chords are less.
const HOLLOW: f64 = 0.35;

/// Parts of a line at most: one that has more is rough, and no node lies in its corners.
const MOST_PARTS: usize = 8;

/// Part of the way through the body to where it comes out again that a part is prolonged.
const HIDDEN: f64 = 0.5;

/// Angle between points of an arc that are drawn \[rad\].
const DRAWN: f64 = 0.05;

fn left(along: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-along.y, along.x)
}

impl Piece {
    fn segment(start: Vector2<f64>, end: Vector2<f64>) -> Self {
        let along = end - start;
        Self {
            start,
            along: along.normalize(),
            length: along.norm(),
            bend: 0.0,
        }
    }

    fn at(&self, s: f64) -> Vector2<f64> {
        match self.bend == 0.0 {
            true => self.start + self.along * s,
            false => {
                let (sin, cos) = (self.bend * s).sin_cos();
                self.start + (self.along * sin + left(self.along) * (1.0 - cos)) / self.bend
            }
        }
    }

    /// The unit tangent.
    fn direction(&self, s: f64) -> Vector2<f64> {
        let (sin, cos) = (self.bend * s).sin_cos();
        self.along * cos + left(self.along) * sin
    }

    fn center(&self) -> Vector2<f64> {
        self.start + left(self.along) / self.bend
    }

    /// Where the perpendicular from a point meets the piece, prolonged.
    fn perpendicular(&self, x: &Vector2<f64>) -> f64 {
        if self.bend == 0.0 {
            return (x - self.start).dot(&self.along);
        }
        let (from, to) = (self.start - self.center(), x - self.center());
        let angle = (from.perp(&to) * self.bend.signum()).atan2(from.dot(&to));
        angle / self.bend.abs()
    }

    /// Signed distance and normal at a point whose perpendicular meets the piece at s.
    fn straight_ahead(&self, x: &Vector2<f64>, s: f64) -> (f64, Vector2<f64>) {
        if self.bend == 0.0 {
            let normal = left(self.along);
            return ((x - self.start).dot(&normal), normal);
        }
        let (side, from) = (-self.bend.signum(), x - self.center());
        let length = from.norm();
        let normal = match length > 0.0 {
            true => from * (side / length),
            false => left(self.direction(s)),
        };
        (side * (length - 1.0 / self.bend.abs()), normal)
    }
}

fn refused<T>(what: &'static str, value: f64, expected: &'static str) -> Result<T, ContactError> {
    Err(ContactError::OutOfRange {
        what,
        value,
        expected,
    })
}

impl Polyline {
    /// The polyline through points, at least two.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for fewer points, coordinates that are not finite, segments of
    /// length zero, and lines that turn back on themselves or cross themselves, their first and last
    /// segments prolonged.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, ContactError> {
        let inner = points.len().saturating_sub(2);
        Self::rounded(points, &vec![0.0; inner])
    }

    /// The polyline through points whose inner corners are rounded by arcs of these radii \[mm\], of which zero leaves
    /// a sharp one.
    ///
    /// # Errors
    /// Those of [`Polyline::new`], for the sharp line; radii that are not one for each inner point, negative, or
    /// so large that an arc is longer than its segments, or meets the next.
    pub fn rounded(points: &[[f64; 2]], radii: &[f64]) -> Result<Self, ContactError> {
        if points.len() < 2 {
            let count = points.len() as f64;
            return refused("number of points of the polyline", count, "at least 2");
        }
        if let Some(&x) = points.iter().flatten().find(|x| !x.is_finite()) {
            return refused("point of the polyline", x, "finite coordinates");
        }
        if radii.len() != points.len() - 2 {
            let what = "number of radii of the profile";
            return refused(
                what,
                radii.len() as f64,
                "one for each point between the ends",
            );
        }
        if let Some(&r) = radii.iter().find(|r| !(r.is_finite() && **r >= 0.0)) {
            return refused("radius of the profile", r, "a number that is not negative");
        }
        let points: Vec<Vector2<f64>> = points.iter().map(|&x| x.into()).collect();
        let segments: Vec<Piece> = points
            .windows(2)
            .map(|ends| Piece::segment(ends[0], ends[1]))
            .collect();
        let short = |s: &&Piece| !(s.length > 0.0 && s.length.is_finite());
        if let Some(segment) = segments.iter().find(short) {
            let what = "length of a segment of the polyline";
            return refused(what, segment.length, "a positive number");
        }
        let line = Self {
            first: points[0],
            pieces: segments,
            beyond: [f64::INFINITY; 2],
            of: None,
        };
        line.check_crossings()?;
        line.round(radii)
    }

    /// # Errors
    /// [`ContactError::OutOfRange`] for a line that turns back on itself or crosses itself.
    fn check_crossings(&self) -> Result<(), ContactError> {
        for k in 1..self.pieces.len() {
            let (a, b) = (self.pieces[k - 1].along, self.pieces[k].along);
            if a.dot(&b) < 0.0 && a.perp(&b).abs() < COINCIDENT {
                let what = "cosine of a corner of the polyline";
                return refused(what, a.dot(&b), "no turn back on itself");
            }
            for j in 0..k - 1 {
                if let Some(at) = self.crossing(j, k) {
                    let what = "crossing of the polyline with itself, at segment";
                    return refused(what, at + j as f64, "none, with both ends prolonged");
                }
            }
        }
        Ok(())
    }

    /// The line of segments with its corners rounded.
    fn round(self, radii: &[f64]) -> Result<Self, ContactError> {
        let segments = self.pieces;
        let mut pieces = Vec::with_capacity(2 * segments.len());
        // What the arc at its start takes off a segment.
        let mut taken = 0.0;
        for (k, segment) in segments.iter().enumerate() {
            let next = segments.get(k + 1).zip(radii.get(k));
            let turn = |next: &Piece| {
                let (sin, cos) = (
                    segment.along.perp(&next.along),
                    segment.along.dot(&next.along),
                );
                sin.atan2(cos)
            };
            let arc = next.and_then(|(next, &radius)| {
                let turn = turn(next);
                (radius > 0.0 && turn.abs() > COINCIDENT).then_some((radius, turn))
            });
            let cut = arc.map_or(0.0, |(radius, turn)| radius * (0.5 * turn).abs().tan());
            let left_over = segment.length - taken - cut;
            let fits = left_over >= -COINCIDENT * segment.length;
            let last = segments.get(k + 1).is_none_or(|next| cut <= next.length);
            if !(fits && last) {
                let radius = arc.map_or(0.0, |(radius, _)| radius);
                let what = "radius of the profile";
                return refused(what, radius, "one whose arc leaves room for its neighbours");
            }
            // What prolongs the line is straight, also where an arc takes all of it.
            let is_end = k == 0 || k + 1 == segments.len();
            if is_end || left_over > COINCIDENT * segment.length {
                pieces.push(Piece {
                    start: segment.at(taken),
                    length: left_over.max(0.0),
                    ..*segment
                });
            }
            if let Some((radius, turn)) = arc {
                pieces.push(Piece {
                    start: segment.at(segment.length - cut),
                    along: segment.along,
                    length: radius * turn.abs(),
                    bend: turn.signum() / radius,
                });
            }
            taken = cut;
        }
        Ok(Self {
            first: self.first,
            pieces,
            beyond: self.beyond,
            of: None,
        })
    }

    /// Whether a node may lie in the corner between a piece and the one before, on both.
    fn is_hollow(&self, k: usize) -> bool {
        let (before, after) = (self.pieces[k - 1].along, self.pieces[k].along);
        self.is_sharp(k) && before.perp(&after).atan2(before.dot(&after)) > HOLLOW
    }

    /// How far a part goes on from a corner into the body that the rest of the line bounds.
    fn hidden(&self, from: Vector2<f64>, along: Vector2<f64>) -> f64 {
        let crossed = self.pieces.iter().filter_map(|piece| {
            let chord = Piece::segment(piece.at(0.0), piece.at(piece.length));
            let between = chord.start - from;
            let det = along.perp(&chord.along);
            let (s, t) = (between.perp(&chord.along) / det, between.perp(&along) / det);
            let meets = (-COINCIDENT..=1.0 + COINCIDENT).contains(&(t / chord.length));
            (meets && s.is_finite() && s > COINCIDENT * chord.length).then_some(s)
        });
        HIDDEN * crossed.fold(f64::INFINITY, f64::min)
    }

    /// Its points, with some on every arc.
    pub fn outline(&self) -> Vec<[f64; 2]> {
        let of = |piece: &Piece| {
            let parts = (piece.length * piece.bend.abs() / DRAWN).ceil().max(1.0);
            let at = |k: usize| piece.at(piece.length * k as f64 / parts).into();
            (0..parts as usize).map(at).collect::<Vec<_>>()
        };
        let ends = self.pieces.last().map(|last| last.at(last.length).into());
        self.pieces.iter().flat_map(of).chain(ends).collect()
    }

    /// Part of a piece nearest to `s`: within its length, but for the ends of the line.
    fn clamped(&self, k: usize, s: f64) -> f64 {
        let low = if k == 0 { -self.beyond[0] } else { 0.0 };
        let more = match k + 1 == self.pieces.len() {
            true => self.beyond[1],
            false => 0.0,
        };
        s.clamp(low, self.pieces[k].length + more)
    }

    /// Where segment j is crossed by segment k, in parts of j.
    fn crossing(&self, j: usize, k: usize) -> Option<f64> {
        let (a, b) = (&self.pieces[j], &self.pieces[k]);
        let between = b.start - a.start;
        let det = a.along.perp(&b.along);
        let (s, t) = (between.perp(&b.along) / det, between.perp(&a.along) / det);
        // Segments that are parallel but for rounding do not cross.
        let cross = det.abs() > COINCIDENT;
        (cross && self.clamped(j, s) == s && self.clamped(k, t) == t).then_some(s / a.length)
    }

    /// Whether the line has a corner between a piece and the one before.
    fn is_sharp(&self, k: usize) -> bool {
        let (before, after) = (&self.pieces[k - 1], &self.pieces[k]);
        let turn = before.direction(before.length).perp(&after.along);
        before.bend == 0.0 && after.bend == 0.0 && turn.abs() > COINCIDENT
    }

    fn nearest(&self, x: &Vector2<f64>) -> Foot {
        let mut best = (f64::INFINITY, 0, 0.0);
        for (k, piece) in self.pieces.iter().enumerate() {
            let straight = piece.perpendicular(x);
            let s = match piece.bend == 0.0 {
                true => self.clamped(k, straight),
                // At its ends the neighbours are as near.
                false => straight.clamp(0.0, piece.length),
            };
            let squared = (x - piece.at(s)).norm_squared();
            if squared < best.0 {
                best = (squared, k, s);
            }
        }
        let (_, piece, s) = best;
        let end = match s {
            0.0 if piece > 0 => Some(piece),
            s if s == self.pieces[piece].length && piece + 1 < self.pieces.len() => Some(piece + 1),
            _ => None,
        };
        Foot {
            piece,
            s,
            corner: end.filter(|&k| self.is_sharp(k)),
        }
    }

    /// Signed distance and normal. Of a part, what is behind it counts where it is the nearest part, or at the corner with
    /// the nearest: elsewhere the line has another side in between.
    fn measured(&self, x: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let (distance, normal) = self.alone(x);
        let Some(whole) = self.of.as_ref().filter(|_| distance < 0.0) else {
            return (distance, normal);
        };
        let (own, nearest) = (&whole.pieces, whole.line.nearest(x).piece);
        if whole.line.alone(x).0 > 0.0 {
            return (-distance, -normal);
        }
        if own.contains(&nearest) {
            return (distance, normal);
        }
        let is_before = nearest < own.start;
        let mut between = match is_before {
            true => nearest + 1..own.start,
            false => own.end + 1..nearest + 1,
        };
        let (piece, low, high) = match (self.pieces.as_slice(), is_before) {
            ([first, ..], true) => (first, -self.beyond[0], first.length),
            ([.., last], false) => (last, 0.0, last.length + self.beyond[1]),
            ([], _) => return (distance, normal),
        };
        let s = piece.perpendicular(x);
        let (behind, across) = piece.straight_ahead(x, s);
        let is_next = !between.any(|k| whole.line.is_hollow(k));
        match is_next && behind < 0.0 && (low..=high).contains(&s) {
            true => (behind, across),
            false => (-distance, -normal),
        }
    }

    /// The same of a line that is no part.
    fn alone(&self, x: &Vector2<f64>) -> (f64, Vector2<f64>) {
        let foot = self.nearest(x);
        let Some(k) = foot.corner else {
            let piece = &self.pieces[foot.piece];
            let is_past = foot.s < 0.0 && foot.s == -self.beyond[0]
                || foot.s > piece.length && foot.s == piece.length + self.beyond[1];
            // Past its end there is nothing of it.
            return match x - piece.at(foot.s) {
                from if is_past && from.norm() > 0.0 => (from.norm(), from.normalize()),
                _ => piece.straight_ahead(x, foot.s),
            };
        };
        let bisector = left(self.pieces[k - 1].along) + left(self.pieces[k].along);
        let from = x - self.pieces[k].start;
        let (side, length) = (from.dot(&bisector).signum(), from.norm());
        match length > COINCIDENT * self.pieces[k].length {
            true => (side * length, from * (side / length)),
            false => (side * length, bisector.normalize()),
        }
    }
}

impl Obstacle<2> for Polyline {
    fn distance(&self, x: &Vector2<f64>) -> f64 {
        self.measured(x).0
    }

    fn normal(&self, x: &Vector2<f64>) -> Vector2<f64> {
        self.measured(x).1
    }

    fn curvature(&self, x: &Vector2<f64>) -> Matrix2<f64> {
        let foot = self.nearest(x);
        let piece = &self.pieces[foot.piece];
        // About a corner and about the centre of an arc the normal turns as that of a circle.
        let (from, side) = match foot.corner {
            Some(k) => (x - self.pieces[k].start, self.distance(x).signum()),
            None if piece.bend != 0.0 => (x - piece.center(), -piece.bend.signum()),
            None => return Matrix2::zeros(),
        };
        let (n, length) = (self.normal(x), from.norm());
        match length > COINCIDENT * piece.length {
            true => (Matrix2::identity() - n * n.transpose()) * (side / length),
            false => Matrix2::zeros(),
        }
    }

    fn way(&self, from: &Vector2<f64>, to: &Vector2<f64>) -> Vector2<f64> {
        let place = |x: &Vector2<f64>| {
            let foot = self.nearest(x);
            let before: f64 = self.pieces[..foot.piece].iter().map(|p| p.length).sum();
            before + foot.s
        };
        let n = self.normal(to);
        Vector2::new(n.y, -n.x) * (place(to) - place(from))
    }

    fn reference(&self) -> Vector2<f64> {
        self.first
    }

    fn parts(&self) -> Vec<Box<dyn Obstacle<2>>> {
        let count = self.pieces.len();
        let hollow = (1..count).filter(|&k| self.is_hollow(k));
        let bounds: Vec<usize> = [0].into_iter().chain(hollow).chain([count]).collect();
        if !(3..=MOST_PARTS + 1).contains(&bounds.len()) {
            return Vec::new();
        }
        let part = |ends: &[usize]| -> Box<dyn Obstacle<2>> {
            let pieces = self.pieces[ends[0]..ends[1]].to_vec();
            let (first, last) = (pieces[0], pieces[pieces.len() - 1]);
            let backward = match ends[0] {
                0 => f64::INFINITY,
                _ => self.hidden(first.start, -first.along),
            };
            let end = last.at(last.length);
            let forward = match ends[1] == count {
                true => f64::INFINITY,
                false => self.hidden(end, last.direction(last.length)),
            };
            Box::new(Self {
                first: self.first,
                pieces,
                beyond: [backward, forward],
                of: Some(Box::new(Whole {
                    line: self.clone(),
                    pieces: ends[0]..ends[1],
                })),
            })
        };
        bounds.windows(2).map(part).collect()
    }

    fn corner(&self, x: &Vector2<f64>, tolerance: f64) -> Option<Corner<2>> {
        let nearest = self.nearest(x).piece;
        let ends = [nearest, nearest + 1].into_iter();
        let inner = ends.filter(|&k| k > 0 && k < self.pieces.len() && self.is_sharp(k));
        let mut corners = inner.filter_map(|k| {
            let [a, b] = [k - 1, k].map(|k| self.pieces[k].along);
            let axis = (left(a) + left(b)).normalize();
            let across = (x - self.pieces[k].start).perp(&axis);
            let convex = a.perp(&b) < 0.0;
            (convex && across.abs() <= tolerance).then(|| Corner {
                position: self.pieces[k].start,
                axis,
                half_angle: 0.5 * left(a).angle(&left(b)),
                edge: None,
            })
        });
        corners.next()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ball, Plane};
    use nalgebra::Rotation2;
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
            for k in 0..line.pieces.len() {
                for i in -100..=100 {
                    let piece = &line.pieces[k];
                    let s = line.clamped(k, 0.05 * f64::from(i) * piece.length);
                    let point = piece.at(s);
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

    /// Corners to both sides.
    fn wave(radius: f64) -> Polyline {
        let points = [
            [-4.0, 0.0],
            [-1.0, 0.5],
            [1.0, -1.5],
            [2.0, -1.4],
            [5.0, 2.0],
        ];
        Polyline::rounded(&points, &[radius, 0.6 * radius, radius]).expect("valid")
    }

    proptest! {
        /// Distance, normal, curvature and way belong to each other, on segments and arcs.
        #[test]
        fn a_rounded_line_is_smooth(
            radius in 0.3..0.8f64,
            at in (0..7usize, 0.0..1.0f64, -0.1..0.1f64),
            by in prop::array::uniform2(-1.0..1.0f64),
        ) {
            let line = wave(radius);
            let (piece, s, off) = (&line.pieces[at.0], at.1, at.2);
            let s = s * piece.length;
            // Well within the smallest radius, 0.18, both sides of the line are smooth: near it differences are not exact.
            let x = piece.at(s) + left(piece.direction(s)) * off;
            let h = 1e-5;
            let (n, v) = (line.normal(&x), Vector2::from(by));
            prop_assert!((n.norm() - 1.0).abs() < 1e-12);
            let slope = (line.distance(&(x + v * h)) - line.distance(&(x - v * h))) / (2.0 * h);
            let pieces = [x + v * h, x - v * h].map(|x| line.nearest(&x).piece);
            // A jump of the curvature in between leaves an error of first order in h.
            let within = if pieces[0] == pieces[1] { 1e-8 } else { 10.0 * h };
            prop_assert!((slope - n.dot(&v)).abs() < within, "{slope}");
            if pieces[0] == pieces[1] {
                let turn = (line.normal(&(x + v * h)) - line.normal(&(x - v * h))) / (2.0 * h);
                prop_assert!((turn - line.curvature(&x) * v).norm() < 1e-6, "{turn}");
            }
            // A short way is that of the foot.
            let foot = |x: Vector2<f64>| x - line.normal(&x) * line.distance(&x);
            let (from, to) = (x - v * h, x + v * h);
            let way = line.way(&from, &to);
            prop_assert!((way - (foot(to) - foot(from))).norm() < 1e-7, "{way}");
            prop_assert!(line.corner(&x, 0.1).is_none());
        }

        #[test]
        fn points_of_arcs_and_segments_are_on_the_line(radius in 0.2..0.8f64, s in 0.0..1.0f64) {
            let line = wave(radius);
            for piece in &line.pieces {
                let x = piece.at(s * piece.length);
                prop_assert!(line.distance(&x).abs() < 1e-12);
                let n = left(piece.direction(s * piece.length));
                prop_assert!((line.normal(&x) - n).norm() < 1e-9);
            }
            // Smooth, from end to end.
            for ends in line.pieces.windows(2) {
                prop_assert!((ends[0].at(ends[0].length) - ends[1].start).norm() < 1e-12);
                let before = ends[0].direction(ends[0].length);
                prop_assert!((before - ends[1].along).norm() < 1e-12);
            }
        }
    }

    proptest! {
        /// What is before a line is before all its parts, and what is a little behind it is so behind one of them.
        #[test]
        fn parts_are_behind_together_what_the_line_is(
            points in prop::collection::vec(prop::array::uniform2(-3.0..3.0f64), 3..8),
            x in prop::array::uniform2(-4.0..4.0f64),
            (piece, part) in (0..7usize, 0.0..1.0f64),
        ) {
            let Ok(line) = Polyline::new(&points) else { return Ok(()) };
            let (parts, x) = (line.parts(), Vector2::from(x));
            if parts.is_empty() {
                return Ok(());
            }
            let least = |x: &Vector2<f64>| {
                let all = parts.iter().map(|p| p.distance(x));
                all.fold(f64::INFINITY, f64::min)
            };
            if line.distance(&x) > 1e-9 {
                prop_assert!(least(&x) > 0.0, "{} {}", line.distance(&x), least(&x));
            }
            let piece = &line.pieces[piece % line.pieces.len()];
            let behind = piece.at(part * piece.length) - left(piece.along) * 1e-3;
            let depth = line.distance(&behind);
            prop_assert!(depth >= 0.0 || least(&behind) <= 0.999 * depth, "{depth} {}", least(&behind));
            for part in &parts {
                prop_assert!((part.normal(&x).norm() - 1.0).abs() < 1e-12);
            }
        }
    }

    /// In the corner of a floor and a wall a node is behind both; the floor ends under a ridge, and the bottom of a cup is
    /// not what is seen from within.
    #[test]
    fn a_concave_corner_has_two_sides() {
        let corner = Polyline::new(&[[-5.0, 0.0], [2.0, 0.0], [2.0, 5.0]]).expect("valid");
        let parts = corner.parts();
        assert_eq!(parts.len(), 2);
        let at = |x: [f64; 2]| [0, 1].map(|k| parts[k].distance(&x.into()));
        assert_eq!(at([1.0, 3.0]), [3.0, 1.0]);
        let [floor, wall] = at([2.1, -0.2]);
        assert!((floor + 0.2).abs() < 1e-14 && (wall + 0.1).abs() < 1e-14);
        // Floors on both sides of a ridge, one lower than the other.
        let ridge = [
            [-5.0, 0.0],
            [0.0, 0.0],
            [0.0, 2.0],
            [1.0, 2.0],
            [1.0, -1.0],
            [5.0, -1.0],
        ];
        let parts = Polyline::new(&ridge).expect("valid").parts();
        assert_eq!(parts.len(), 3);
        assert!(
            parts
                .iter()
                .all(|p| p.distance(&Vector2::new(1.5, -0.5)) > 0.0)
        );
        let cup = [
            [-4.0, 6.0],
            [-4.0, 0.0],
            [4.0, 0.0],
            [4.0, 6.0],
            [3.0, 6.0],
            [3.0, 1.0],
            [-3.0, 1.0],
            [-3.0, 6.0],
        ];
        let cup: Vec<[f64; 2]> = cup.into_iter().rev().collect();
        let cup = Polyline::new(&cup).expect("valid");
        for part in cup.parts() {
            assert!(part.distance(&Vector2::new(0.0, 1.5)) > 0.0);
            let depth = part.distance(&Vector2::new(0.0, 0.99));
            assert!(depth > 0.0 || (depth + 0.01).abs() < 1e-14, "{depth}");
        }
        // Chords of an arc have no corners that hold a node.
        let arc: Vec<[f64; 2]> = (0..20)
            .map(|k| 0.15 * f64::from(k))
            .map(|a| [-a.cos(), -a.sin()])
            .collect();
        assert!(Polyline::new(&arc).expect("valid").parts().is_empty());
    }

    /// A corner of a right angle, rounded, beside the circle that touches both sides.
    #[test]
    fn a_rounded_corner_is_a_ball() {
        let line =
            Polyline::rounded(&[[-3.0, 0.0], [0.0, 0.0], [0.0, -3.0]], &[0.5]).expect("valid");
        let ball = Ball::new([-0.5, -0.5], 0.5).expect("valid");
        for x in [[0.3, 0.7], [-0.2, -0.1], [1.0, 0.0]].map(Vector2::from) {
            assert!((line.distance(&x) - ball.distance(&x)).abs() < 1e-14);
            assert!((line.normal(&x) - ball.normal(&x)).norm() < 1e-14);
            assert!((line.curvature(&x) - ball.curvature(&x)).norm() < 1e-13);
        }
        let quarter = line.way(&Vector2::new(-1.0, 0.2), &Vector2::new(0.2, -1.0));
        assert!((quarter - Vector2::new(0.0, -1.0 - 0.25 * PI)).norm() < 1e-14);
        for radii in [&[][..], &[-0.1], &[3.5], &[f64::NAN], &[0.1, 0.1]] {
            let points = [[-3.0, 0.0], [0.0, 0.0], [0.0, -3.0]];
            assert!(Polyline::rounded(&points, radii).is_err(), "{radii:?}");
        }
        // Beyond arcs that take all of their segments the line goes on straight.
        let whole = Polyline::rounded(&[[0.0, 0.0], [1.0, 0.0], [1.0, -1.0]], &[1.0]);
        let whole = whole.expect("valid");
        for (x, distance) in [([-5.0, 0.5], 0.5), ([1.3, -4.0], 0.3), ([0.0, 1.0], 1.0)] {
            assert!((whole.distance(&x.into()) - distance).abs() < 1e-14);
        }
        let step = [[-1.0, 0.0], [0.0, 0.0], [0.0, -1.0], [1.0, -1.0]];
        assert!(Polyline::rounded(&step, &[0.5, 0.5]).is_ok());
        assert!(Polyline::rounded(&step, &[0.5, 0.6]).is_err());
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

    /// A punch with upright walls, turned: its walls are parallel but for rounding, and never meet.
    #[test]
    fn parallel_walls_do_not_cross() {
        for k in 0..72 {
            let turn = Rotation2::new(f64::from(k).to_radians() * 5.0);
            let points = [[0.3, 0.9], [0.1, 0.3], [1.1, 0.3], [1.3, 0.9]];
            let upright = [[0.1, 0.9], [0.1, 0.3], [1.1, 0.3], [1.1, 0.9]];
            for points in [points, upright] {
                let turned = points.map(|p| (turn * Vector2::from(p)).into());
                assert!(
                    Polyline::new(&turned).is_ok(),
                    "{points:?} turned {k} times"
                );
            }
        }
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
