//! Convex polygons of the plane: clipped, subtracted, cut into triangles; not polygons with holes
//! or re-entrant corners.

use super::face::{cross, difference};

type Point = [f64; 2];

/// Corners closer than this, over the size, are one.
const SAME: f64 = 1e-13;

/// A convex polygon, anticlockwise.
#[derive(Debug, Clone)]
pub(super) struct Polygon(Vec<Point>);

impl Polygon {
    /// Of corners that are convex, anticlockwise.
    pub(super) fn new(corners: Vec<Point>) -> Self {
        Self(corners)
    }

    /// Convex polygons that make up a triangle or a quadrilateral; none of one that is clockwise
    /// or crosses itself.
    pub(super) fn parts(corners: &[Point]) -> Vec<Self> {
        let n = corners.len();
        let turn = |k: usize| {
            let [a, b, c] = [k, k + 1, k + 2].map(|k| corners[k % n]);
            cross(&difference(&b, &a), &difference(&c, &b))
        };
        if (0..n).all(|k| turn(k) >= 0.0) {
            return vec![Self(corners.to_vec())];
        }
        if n != 4 {
            return Vec::new();
        }
        let halves = |[a, b]: [[usize; 3]; 2]| [a, b].map(|t| Self(t.map(|k| corners[k]).to_vec()));
        let cuts = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]].map(halves);
        let valid = cuts.into_iter().find(|h| h.iter().all(|t| t.area() > 0.0));
        valid.map_or_else(Vec::new, Vec::from)
    }

    pub(super) fn corners(&self) -> &[Point] {
        &self.0
    }

    /// Fan of triangles from the first corner.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [Point; 3]> {
        let corners = &self.0;
        (2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]])
    }

    pub(super) fn area(&self) -> f64 {
        self.triangles().map(|t| area(&t)).sum()
    }

    /// Centre of gravity.
    pub(super) fn centre(&self) -> Point {
        let whole = self.area();
        [0, 1].map(|i| {
            let moment = |t: [Point; 3]| area(&t) * (t[0][i] + t[1][i] + t[2][i]) / 3.0;
            self.triangles().map(moment).sum::<f64>() / whole
        })
    }

    fn sides(&self) -> impl Iterator<Item = [Point; 2]> {
        let n = self.0.len();
        (0..n).map(move |k| [self.0[k], self.0[(k + 1) % n]])
    }

    /// The part on the left of the line from a to b.
    fn left(&self, [a, b]: [Point; 2]) -> Self {
        let along = difference(&b, &a);
        let side = |p: &Point| cross(&along, &difference(p, &a));
        let mut kept = Vec::with_capacity(self.0.len() + 1);
        for [p, q] in self.sides() {
            let (at_p, at_q) = (side(&p), side(&q));
            if at_p >= 0.0 {
                kept.push(p);
            }
            if (at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0) {
                let s = at_p / (at_p - at_q);
                kept.push([0, 1].map(|i| p[i] + s * (q[i] - p[i])));
            }
        }
        let size = |p: &Point| p[0].abs().max(p[1].abs());
        let same = SAME * kept.iter().map(size).fold(0.0, f64::max);
        kept.dedup_by(|a, b| size(&difference(a, b)) <= same);
        while kept.len() > 1 && size(&difference(&kept[0], &kept[kept.len() - 1])) <= same {
            kept.pop();
        }
        Self(kept)
    }

    /// The part within another.
    pub(super) fn within(&self, other: &Self) -> Self {
        other
            .sides()
            .fold(self.clone(), |part, side| part.left(side))
    }

    /// The parts outside another; those smaller than an area are none.
    pub(super) fn without(&self, other: &Self, least: f64) -> Vec<Self> {
        if self.within(other).area() <= least {
            return vec![self.clone()];
        }
        let mut rest = self.clone();
        let mut parts = Vec::new();
        for [a, b] in other.sides() {
            let outside = rest.left([b, a]);
            if outside.area() > least {
                parts.push(outside);
            }
            rest = rest.left([a, b]);
        }
        parts
    }

    /// Distance of a point; 0 inside.
    pub(super) fn distance(&self, p: Point) -> f64 {
        let inside = |[a, b]: [Point; 2]| cross(&difference(&b, &a), &difference(&p, &a)) >= 0.0;
        if self.sides().all(inside) {
            return 0.0;
        }
        let to_side = |[a, b]: [Point; 2]| {
            let (d, e) = (difference(&b, &a), difference(&p, &a));
            let length = d[0] * d[0] + d[1] * d[1];
            let s = (d[0] * e[0] + d[1] * e[1]) / length.max(f64::MIN_POSITIVE);
            let s = s.clamp(0.0, 1.0);
            (e[0] - s * d[0]).hypot(e[1] - s * d[1])
        };
        self.sides().map(to_side).fold(f64::INFINITY, f64::min)
    }
}

/// Area of a triangle, negative clockwise.
pub(super) fn area([a, b, c]: &[Point; 3]) -> f64 {
    0.5 * cross(&difference(b, a), &difference(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A polygon with its corners on a circle.
    fn polygon() -> impl Strategy<Value = Polygon> {
        let angles = prop::collection::vec(0.0..std::f64::consts::TAU, 3..7);
        (angles, prop::array::uniform2(-1.0..1.0f64), 0.2..2.0f64).prop_map(|(mut a, c, r)| {
            a.sort_by(f64::total_cmp);
            Polygon(
                a.iter()
                    .map(|a| [c[0] + r * a.cos(), c[1] + r * a.sin()])
                    .collect(),
            )
        })
    }

    proptest! {
        #[test]
        fn what_is_within_and_without_is_all(a in polygon(), b in polygon(), c in polygon()) {
            let common = a.within(&b);
            prop_assert!((common.area() - b.within(&a).area()).abs() < 1e-12);
            let outside = a.without(&b, 1e-14);
            let parts: f64 = outside.iter().map(Polygon::area).sum();
            prop_assert!((common.area() + parts - a.area()).abs() < 1e-12);
            // Inclusion and exclusion, of three.
            let left: f64 = outside.iter().flat_map(|p| p.without(&c, 1e-14)).map(|p| p.area()).sum();
            let expected = a.area() - common.area() - a.within(&c).area() + common.within(&c).area();
            prop_assert!((left - expected).abs() < 1e-12);
            for p in outside {
                prop_assert!(p.within(&b).area() < 1e-12);
            }
        }

        #[test]
        fn the_distance_is_that_of_the_nearest_point(a in polygon(), p in prop::array::uniform2(-3.0..3.0f64)) {
            let found = a.distance(p);
            // No point of the fan is nearer, and the circle around p by that distance meets it.
            for t in a.triangles() {
                for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.5, 0.5), (0.3, 0.3), (0.1, 0.7)] {
                    let q = [0, 1].map(|i| t[0][i] + u * (t[1][i] - t[0][i]) + v * (t[2][i] - t[0][i]));
                    prop_assert!((q[0] - p[0]).hypot(q[1] - p[1]) >= found - 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_quadrilateral_with_a_notch_is_two_triangles() {
        let arrow = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]];
        let parts = Polygon::parts(&arrow);
        assert_eq!(parts.len(), 2);
        let area: f64 = parts.iter().map(Polygon::area).sum();
        assert!((area - 1.5).abs() < 1e-15);
        let mut back = arrow;
        back.reverse();
        assert!(Polygon::parts(&back).is_empty());
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let [square] = Polygon::parts(&square).try_into().expect("convex");
        assert_eq!(square.centre(), [0.5, 0.5]);
        assert_eq!(square.distance([2.0, 2.0]), 2f64.sqrt());
        assert_eq!(square.distance([0.5, -3.0]), 3.0);
    }
}
