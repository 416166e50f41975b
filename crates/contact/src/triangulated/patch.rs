//! A curved triangle whose tangent planes along an edge depend on that edge alone; not its neighbours.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};

type Point = Vector3<f64>;

/// A triangular Gregory patch of degree four: it passes through three corners with given normals, and joins the
/// patch across an edge with the same tangent planes where both are given the same curve and normals at its ends.
/// Where the two edges of a corner have different normals there, it is a cone with its tip in that corner.
///
/// Source but for the tips: D. J. Walton and D. S. Meek, *Computer-Aided Design* 28 (1996) 113-119.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Patch {
    corners: [Point; 3],
    /// Coefficients of uⁱ vʲ, by [`place`], of what is polynomial in the coordinates u and v of corners 1 and 2.
    powers: [Point; 15],
    /// Half of what the two inner coefficients near a corner differ by.
    twists: [Point; 3],
    /// Of a corner with two normals, what is added to the derivative across its edges there, of the edge that starts in it
    /// and of that which ends in it.
    tips: [[Point; 2]; 3],
    /// Whether it is its plane triangle.
    pub(super) is_plane: bool,
    /// Least and greatest coordinates of a box around it.
    around: [[f64; 3]; 2],
    /// How far it is at most from its plane triangle \[mm\].
    bulge: f64,
}

/// A point of a patch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Jet {
    pub(super) x: Point,
    /// First derivatives by the coordinates of corners 1 and 2.
    pub(super) d: Matrix3x2<f64>,
    /// Second derivatives: ₁₁, ₁₂ and ₂₂.
    dd: [Point; 3],
}

/// Powers of the barycentric coordinates, edge by edge.
const BOUNDARY: [[usize; 3]; 12] = [
    [4, 0, 0],
    [3, 1, 0],
    [2, 2, 0],
    [1, 3, 0],
    [0, 4, 0],
    [0, 3, 1],
    [0, 2, 2],
    [0, 1, 3],
    [0, 0, 4],
    [1, 0, 3],
    [2, 0, 2],
    [3, 0, 1],
];

/// Binomial coefficients of the points of an edge of degree four.
const BINOMIAL: [f64; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

/// Handles of the cubic curve between two points with these directions, each of unit length, such that an arc of a
/// circle is met to sixth order.
pub(super) fn handles(ends: [Point; 2], directions: [Point; 2]) -> [Point; 2] {
    let chord = ends[1] - ends[0];
    let length = chord.norm();
    let handle = |along: &Point| 2.0 * length / (3.0 * (1.0 + along.dot(&chord) / length));
    let [a, b] = directions;
    [ends[0] + a * handle(&a), ends[1] - b * handle(&b)]
}

impl Patch {
    /// The patch through corners, along edges whose cubic curves have these handles, with normals at the ends of each;
    /// edge k goes from corner k to the next.
    pub(super) fn new(
        corners: [Point; 3],
        normals: [[Point; 2]; 3],
        handles: [[Point; 2]; 3],
    ) -> Self {
        // The edges raised to degree four.
        let edges: [[Point; 5]; 3] = std::array::from_fn(|k| {
            let (from, [a, b], to) = (corners[k], handles[k], corners[(k + 1) % 3]);
            [
                from,
                0.25 * from + 0.75 * a,
                0.5 * (a + b),
                0.75 * b + 0.25 * to,
                to,
            ]
        });
        let boundary: [Point; 12] = std::array::from_fn(|k| edges[k / 4][k % 4]);
        let (mut inner, mut tips) = ([[Point::zeros(); 2]; 3], [[Point::zeros(); 2]; 3]);
        for k in 0..3 {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            let p = &edges[k];
            // Direction of the curve, and across it in the tangent plane, as quadratic curves.
            let [a, b] = handles[k];
            let w = [a - corners[k], b - a, corners[next] - b];
            let across = |n: &Point, w: &Point| n.cross(w).normalize();
            let [n, m] = normals[k];
            let (first, second) = (across(&n, &w[0]), across(&m, &w[2]));
            let v = [first, (first + second).normalize(), second];
            // What the other edges leave of the derivative across this one at its ends.
            let start = edges[last][3] - 0.5 * (p[0] + p[1]);
            let end = edges[next][1] - 0.5 * (p[3] + p[4]);
            let along = [
                start.dot(&w[0]) / w[0].norm_squared(),
                end.dot(&w[2]) / w[2].norm_squared(),
            ];
            let aside = [start.dot(&v[0]), end.dot(&v[2])];
            let blend = |[c, d]: [f64; 2], q: &[Point; 3]| {
                [
                    (2.0 * c * q[1] + d * q[0]) / 3.0,
                    (c * q[2] + 2.0 * d * q[1]) / 3.0,
                ]
            };
            let (s, t) = (blend(along, &w), blend(aside, &v));
            inner[k][0] = 0.5 * (p[1] + p[2]) + s[0] + t[0];
            inner[next][1] = 0.5 * (p[2] + p[3]) + s[1] + t[1];
            // The other edge leaves the tangent plane of this one where its own is another.
            if n != normals[last][1] {
                tips[k][0] = n * (-4.0 * n.dot(&start));
            }
            if m != normals[next][0] {
                tips[next][1] = m * (-4.0 * m.dot(&end));
            }
        }
        let mut powers = [Point::zeros(); 15];
        let mut add = |point: &Point, factor: f64, of: [usize; 3]| {
            expand(of, |k, c| powers[k] += (point - corners[0]) * (factor * c));
        };
        for (k, (point, of)) in boundary.iter().zip(BOUNDARY).enumerate() {
            add(point, BINOMIAL[k % 4], of);
        }
        for (k, [p, q]) in inner.iter().enumerate() {
            let of = std::array::from_fn(|i| 1 + usize::from(i == k));
            add(&(0.5 * (p + q)), 12.0, of);
        }
        powers[0] += corners[0];
        let points = boundary.into_iter().chain(inner.into_iter().flatten());
        let patch = Self {
            corners,
            powers,
            twists: inner.map(|[p, q]| 0.5 * (p - q)),
            tips,
            is_plane: false,
            around: [[0.0; 3]; 2],
            bulge: 0.0,
        };
        patch.enclosed(&points.collect::<Vec<_>>())
    }

    /// With the box around it and its bulge, of its coefficients: it lies within these, tips added, and the distance to a
    /// triangle is convex.
    fn enclosed(self, points: &[Point]) -> Self {
        let most = |i: usize, side: fn(f64, f64) -> f64| {
            let of = points.iter().map(|p| p[i]);
            of.reduce(side).unwrap_or_default()
        };
        let tip: f64 = (self.tips.iter())
            .map(|tip| TIP * tip[0].norm().max(tip[1].norm()))
            .sum();
        let mut around = [f64::min, f64::max].map(|side| std::array::from_fn(|i| most(i, side)));
        around[0].iter_mut().for_each(|low| *low -= tip);
        around[1].iter_mut().for_each(|high| *high += tip);
        let is_plane = self.is_straight();
        let bulge = tip
            + points
                .iter()
                .fold(0.0, |most, p| f64::max(most, self.away(p)));
        Self {
            is_plane,
            around,
            bulge: if is_plane { 0.0 } else { bulge },
            ..self
        }
    }

    /// Whether it has no coefficients that a plane triangle has not.
    fn is_straight(&self) -> bool {
        let size = [0, 1, 2].map(|k| (self.corners[k] - self.corners[(k + 1) % 3]).norm());
        let powers = self.powers.iter().enumerate();
        let bent = powers.filter(|(k, _)| ![0, place(0, 1), place(1, 0)].contains(k));
        let bent = bent
            .map(|(_, p)| p)
            .chain(&self.twists)
            .chain(self.tips.iter().flatten());
        let bent = bent.map(Point::norm).fold(0.0, f64::max);
        bent <= STRAIGHT * size.into_iter().fold(0.0, f64::max)
    }

    pub(super) fn corners(&self) -> &[Point; 3] {
        &self.corners
    }

    /// What its distance from a point is at least \[mm\].
    pub(super) fn away(&self, x: &Point) -> f64 {
        let [a, b, c] = self.corners;
        let at = self.nearest_of_triangle(x);
        (x - (a + (b - a) * at.x + (c - a) * at.y)).norm() - self.bulge
    }

    /// Least and greatest coordinates of a box around it.
    pub(super) fn around(&self) -> [[f64; 3]; 2] {
        self.around
    }

    /// Where it is at the coordinates of corners 1 and 2, with derivatives.
    pub(super) fn at(&self, at: &Vector2<f64>) -> Jet {
        let ([u, du, ddu], [v, dv, ddv]) = (powers(at.x), powers(at.y));
        // The point, its first and its second derivatives.
        let mut jet = [Point::zeros(); 6];
        let mut add = |point: &Point, by: [f64; 6]| {
            for (sum, factor) in jet.iter_mut().zip(by) {
                *sum += point * factor;
            }
        };
        let mut k = 0;
        for i in 0..5 {
            for j in 0..5 - i {
                let first = [du[i] * v[j], u[i] * dv[j]];
                let second = [ddu[i] * v[j], du[i] * dv[j], u[i] * ddv[j]];
                add(
                    &self.powers[k],
                    [
                        u[i] * v[j],
                        first[0],
                        first[1],
                        second[0],
                        second[1],
                        second[2],
                    ],
                );
                k += 1;
            }
        }
        if !self.is_plane {
            let c = [1.0 - at.x - at.y, at.x, at.y];
            for (k, twist) in self.twists.iter().enumerate() {
                add(twist, twisted(c, k));
            }
            for (k, [first, second]) in self.tips.iter().enumerate() {
                if *first != Point::zeros() || *second != Point::zeros() {
                    let (p, q) = ((k + 1) % 3, (k + 2) % 3);
                    add(first, tipped(c, [k, p, q]));
                    add(second, tipped(c, [k, q, p]));
                }
            }
        }
        let [x, d1, d2, d11, d12, d22] = jet;
        Jet {
            x,
            d: Matrix3x2::from_columns(&[d1, d2]),
            dd: [d11, d12, d22],
        }
    }

    /// Coordinates of the point of the plane triangle nearest to one, of the plane itself.
    fn flat(&self, x: &Point) -> Vector2<f64> {
        let [a, b, c] = self.corners;
        let sides = Matrix3x2::from_columns(&[b - a, c - a]);
        let metric = sides.transpose() * sides;
        let found = metric
            .try_inverse()
            .map(|inverse| inverse * (sides.transpose() * (x - a)));
        found.unwrap_or_else(|| Vector2::repeat(1.0 / 3.0))
    }

    /// Coordinates of the point of the plane triangle nearest to x, of its inside or of its edges.
    fn nearest_of_triangle(&self, x: &Point) -> Vector2<f64> {
        let flat = self.flat(x);
        if least(&flat) >= 0.0 {
            return flat;
        }
        let on = |k: usize| {
            let (from, along) = (self.corners[k], self.corners[(k + 1) % 3] - self.corners[k]);
            let s = ((x - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            ((from + along * s - x).norm_squared(), on_side(k, s))
        };
        let nearer =
            |p: (f64, Vector2<f64>), q: (f64, Vector2<f64>)| if p.0 <= q.0 { p } else { q };
        nearer(nearer(on(0), on(1)), on(2)).1
    }

    /// Coordinates of its point nearest to x: of its inside, or of its edges.
    pub(super) fn nearest(&self, x: &Point) -> Vector2<f64> {
        if self.is_plane {
            return self.nearest_of_triangle(x);
        }
        if let Some(inside) = self.perpendicular(x, inwards(self.flat(x))) {
            return inside;
        }
        let far = |at: &Vector2<f64>| (self.at(at).x - x).norm();
        let nearer = |p, q| if far(&p) <= far(&q) { p } else { q };
        // Where a search for the perpendicular ends does not tell which edge is the nearest.
        let edges = [0, 1, 2].map(|k| self.on_edge(x, k));
        let [a, b, c] = edges;
        let edge = nearer(nearer(a, b), c);
        let away = self.away(x);
        let is_far = away > self.bulge;
        if far(&edge) <= away || is_far && edges.iter().all(|at| self.at(at).is_valley(x)) {
            return edge;
        }
        // A bent patch may be nearer inside, where a search from its middle does not lead.
        let inside = edges.map(|edge| self.perpendicular(x, inwards(edge)));
        inside.into_iter().flatten().fold(edge, nearer)
    }

    /// Where inside a perpendicular to the patch meets x, by Newton's method.
    fn perpendicular(&self, x: &Point, start: Vector2<f64>) -> Option<Vector2<f64>> {
        let mut at = start;
        for _ in 0..STEPS {
            let jet = self.at(&at);
            let from = x - jet.x;
            let slope = jet.d.transpose() * from;
            let metric = jet.d.transpose() * jet.d;
            let whole = metric - jet.second(&from);
            // Where the distance is no valley, as a plane patch would have it.
            let bent = if is_valley(&whole) { whole } else { metric };
            let step = bent.try_inverse()? * slope;
            at += step * (LONGEST / step.amax()).min(1.0);
            let inside = least(&at);
            if inside.is_nan() || inside <= -BEYOND {
                return None;
            }
            if step.amax() < MET {
                return (inside > -MET).then_some(at);
            }
        }
        None
    }

    /// Coordinates of the point of edge k nearest to x.
    fn on_edge(&self, x: &Point, k: usize) -> Vector2<f64> {
        let along = on_side(k, 1.0) - on_side(k, 0.0);
        let [a, b] = [k, (k + 1) % 3].map(|i| self.corners[i]);
        let chord = b - a;
        let mut s = ((x - a).dot(&chord) / chord.norm_squared()).clamp(0.0, 1.0);
        for _ in 0..STEPS {
            let jet = self.at(&on_side(k, s));
            let (d, from) = (jet.d * along, x - jet.x);
            let bend = along.dot(&(jet.second(&from) * along));
            let whole = d.norm_squared() - bend;
            let stiffness = if whole > 0.0 { whole } else { d.norm_squared() };
            let next = (s + (d.dot(&from) / stiffness).clamp(-LONGEST, LONGEST)).clamp(0.0, 1.0);
            let step = next - s;
            s = next;
            if step.abs() < MET {
                break;
            }
        }
        on_side(k, s)
    }
}

/// Coefficients that a plane patch has not, in parts of its longest edge.
const STRAIGHT: f64 = 1e-12;

/// The most that a tip adds to a point, in parts of what it adds to a derivative: c³ (1 - c) / 4.
const TIP: f64 = 27.0 / 1024.0;

/// Steps of a search for the nearest point.
const STEPS: usize = 30;

/// Largest step of it, in coordinates of the patch.
const LONGEST: f64 = 0.3;

/// How far beyond its edges a patch is followed.
const BEYOND: f64 = 0.5;

/// Coordinates that are met.
const MET: f64 = 1e-13;

fn least(at: &Vector2<f64>) -> f64 {
    at.x.min(at.y).min(1.0 - at.x - at.y)
}

/// The point itself within the triangle; otherwise one of its inside.
fn inwards(at: Vector2<f64>) -> Vector2<f64> {
    let middle = Vector2::repeat(1.0 / 3.0);
    let low = least(&at);
    match low > 0.0 {
        true => at,
        false => middle + (at - middle) * ((1.0 / 3.0) / (1.0 / 3.0 - low)).min(1.0),
    }
}

/// The point that divides edge k in the ratio of s to 1 - s.
fn on_side(k: usize, s: f64) -> Vector2<f64> {
    match k {
        0 => Vector2::new(s, 0.0),
        1 => Vector2::new(1.0 - s, s),
        _ => Vector2::new(0.0, 1.0 - s),
    }
}

/// Place of uⁱ vʲ among the powers up to the fourth.
fn place(i: usize, j: usize) -> usize {
    i * (11 - i) / 2 + j
}

/// Adds (1 - u - v)ᵃ uᵇ vᶜ, as powers by their places.
fn expand([a, b, c]: [usize; 3], mut add: impl FnMut(usize, f64)) {
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |x, i| x * (n - i) as f64 / (i + 1) as f64);
    for i in 0..=a {
        for j in 0..=a - i {
            let sign = if (i + j) % 2 == 0 { 1.0 } else { -1.0 };
            add(place(b + i, c + j), sign * choose(a, i) * choose(a - i, j));
        }
    }
}

/// Powers up to the fourth, with their first and second derivatives.
fn powers(x: f64) -> [[f64; 5]; 3] {
    let (x2, x3) = (x * x, x * x * x);
    [
        [1.0, x, x2, x3, x2 * x2],
        [0.0, 1.0, 2.0 * x, 3.0 * x2, 4.0 * x3],
        [0.0, 0.0, 2.0, 6.0 * x, 12.0 * x2],
    ]
}

/// What the twist near corner k is multiplied by, 12 c_k² p q (p - q) / (p + q) with the other coordinates p and q in
/// turn, and its derivatives by the coordinates of corners 1 and 2.
fn twisted(c: [f64; 3], k: usize) -> [f64; 6] {
    let (p, q) = ((k + 1) % 3, (k + 2) % 3);
    let ([f, f_p, f_q, f_pp, f_pq, f_qq], other) = (share(c[p], c[q]), share(c[q], c[p]));
    let f = [
        f - other[0],
        f_p - other[2],
        f_q - other[1],
        f_pp - other[5],
        f_pq - other[4],
        f_qq - other[3],
    ];
    let s = 12.0 * c[k];
    product([s * c[k], 2.0 * s, 24.0], f, [k, p, q])
}

/// What the tip of corner k is multiplied by, c_k³ p² q / (p + q)², and its derivatives by the coordinates of corners 1
/// and 2: of those across the edges of the patch only that of edge kp is not zero, and c_k³.
fn tipped(c: [f64; 3], [k, p, q]: [usize; 3]) -> [f64; 6] {
    let s = c[k];
    let outer = [s * s * s, 3.0 * s * s, 6.0 * s];
    product(outer, cone(c[p], c[q]), [k, p, q])
}

/// A function of c_k, with two derivatives, times one of the other coordinates p and q, with its derivatives by p and q; their
/// product with its derivatives by the coordinates of corners 1 and 2.
fn product([s, ds, dds]: [f64; 3], f: [f64; 6], [k, p, q]: [usize; 3]) -> [f64; 6] {
    let [f, f_p, f_q, f_pp, f_pq, f_qq] = f;
    // By the barycentric coordinates; second derivatives ₀₀, ₁₁, ₂₂, ₀₁, ₁₂, ₂₀.
    let (mut d, mut dd) = ([0.0; 3], [0.0; 6]);
    (d[k], d[p], d[q]) = (ds * f, s * f_p, s * f_q);
    (dd[k], dd[p], dd[q]) = (dds * f, s * f_pp, s * f_qq);
    dd[between(k, p)] = ds * f_p;
    dd[between(k, q)] = ds * f_q;
    dd[between(p, q)] = s * f_pq;
    [
        s * f,
        d[1] - d[0],
        d[2] - d[0],
        dd[1] - 2.0 * dd[3] + dd[0],
        dd[4] - dd[3] - dd[5] + dd[0],
        dd[2] - 2.0 * dd[5] + dd[0],
    ]
}

/// Place of a mixed second derivative among ₀₁, ₁₂, ₂₀.
fn between(a: usize, b: usize) -> usize {
    match (a.min(b), a.max(b)) {
        (0, 1) => 3,
        (1, 2) => 4,
        _ => 5,
    }
}

/// f = p² q / (p + q), f_p, f_q, f_pp, f_pq and f_qq; where both are zero, nothing.
///
/// Of the parts a and b of the sum that p and q are: powers of the sum itself are none near enough to the corner.
fn share(p: f64, q: f64) -> [f64; 6] {
    let s = p + q;
    if s <= 0.0 {
        return [0.0; 6];
    }
    let (a, b) = (p / s, q / s);
    [
        a * p * q,
        a * b * (p + 2.0 * q),
        a * a * p,
        2.0 * b * b * b,
        a * a * (a + 3.0 * b),
        -2.0 * a * a * a,
    ]
}

/// f = p² q / (p + q)², f_p, f_q, f_pp, f_pq and f_qq; where both are zero, nothing.
///
/// The second derivatives grow without bounds towards the corner: nearer than [`MET`] they are those at that distance.
fn cone(p: f64, q: f64) -> [f64; 6] {
    let s = p + q;
    if s <= 0.0 {
        return [0.0; 6];
    }
    let (a, b, s) = (p / s, q / s, s.max(MET));
    [
        a * a * q,
        2.0 * a * b * b,
        a * a * (a - b),
        2.0 * b * b * (b - 2.0 * a) / s,
        2.0 * a * b * (2.0 * a - b) / s,
        2.0 * a * a * (b - 2.0 * a) / s,
    ]
}

/// Whether second derivatives are those of a valley.
fn is_valley(whole: &Matrix2<f64>) -> bool {
    whole.determinant() > 0.0 && whole.trace() > 0.0
}

impl Jet {
    /// Whether the distance from x is a valley here.
    fn is_valley(&self, x: &Point) -> bool {
        is_valley(&(self.d.transpose() * self.d - self.second(&(x - self.x))))
    }

    /// The unit normal, to the left of the first two corners seen from the third: out of the surface where corners
    /// go round counter-clockwise.
    pub(super) fn normal(&self) -> Option<Point> {
        let n = self.d.column(0).cross(&self.d.column(1));
        n.try_normalize(0.0)
    }

    /// The second derivatives of the point along a vector.
    pub(super) fn second(&self, along: &Point) -> Matrix2<f64> {
        let [a, b, c] = self.dd.map(|dd| dd.dot(along));
        Matrix2::new(a, b, b, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the corner is near, in the same direction, only scales: nothing underflows on the way.
    #[test]
    fn near_a_corner_derivatives_are_those_farther_off() {
        let (p, q) = (3.0, 5.0);
        let (wide, steep) = (share(p, q), cone(p, q));
        for far in [1.0, 1e-40, 1e-109, 1e-160, 1e-300, 5e-324] {
            let same = |found: f64, expected: f64| {
                // What is less than the least of numbers is one of its neighbours.
                (found - expected).abs() <= 1e-14 * expected.abs() + 10.0 * 5e-324
            };
            let (f, g) = (share(far * p, far * q), cone(far * p, far * q));
            let by = |order: i32| [far * far, far, 1.0][order as usize];
            for (k, order) in [0, 1, 1, 2, 2, 2].into_iter().enumerate() {
                assert!(same(f[k], wide[k] * by(order)), "{far:e}: {f:?}");
            }
            // The tip of a cone is bent the more the nearer it is, up to what is told apart.
            let bent = 8.0 / (8.0 * far).max(MET);
            for (k, by) in [far, 1.0, 1.0, bent, bent, bent].into_iter().enumerate() {
                assert!(same(g[k], steep[k] * by), "{far:e}: {g:?}");
            }
        }
    }
}
