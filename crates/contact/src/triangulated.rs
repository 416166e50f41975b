//! A rigid closed surface in space, given by triangles and smooth between them; no file that it comes from.

mod parts;
mod patch;

use crate::{ContactError, Corner, Obstacle};
use nalgebra::{DMatrix, DVector, Dyn, Matrix3, SVD, Vector2, Vector3};
use patch::{Jet, Patch, handles};
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, PointDistance, RTree};
use std::collections::{BTreeMap, HashMap};
use std::f64::consts::FRAC_PI_2;

type Point = Vector3<f64>;

/// A rigid obstacle bounded by triangles whose surface is closed.
///
/// Across an edge where two triangles meet at an angle below a limit the surface is smooth: its corners keep their
/// places, normals there are means over the triangles around, and curved patches in place of the triangles join with
/// one normal along every such edge, so that the normal is everywhere the gradient of the distance. Other edges are
/// sharp, and so is a point, as the tip of a cone, around which faces lean farther than any two of them meet at: there each
/// smooth edge has the normal of the round cone that its two faces are in.
///
/// Points of a sphere, of a cylinder or of a cone in as few triangles as sides give their normals exactly. The surface is off
/// by a small multiple of the fourth power of the length of an edge over the radius, between the sides of a cone by less than
/// a tenth of what plane ones are, and by that of a flat side where a plane cuts a round one off.
/// Plane parts stay plane, and beside a fillet the normals are those of what it rounds off: a plane at least four times as
/// broad as the steps of the fillet, or a wall of long triangles.
///
/// Source of the normals: N. Max, *Journal of Graphics Tools* 4 (1999) 1-6.
#[derive(Debug, Clone)]
pub struct Triangulated {
    patches: Vec<Patch>,
    boxes: Boxes,
    /// For edge k of patch f, which is 3 f + k, the same edge of the other patch.
    opposite: Vec<usize>,
    /// Angle from which on an edge is sharp \[rad\].
    sharp: f64,
    first: Point,
    size: f64,
    side: f64,
}

/// Boxes around patches, by their numbers.
type Boxes = RTree<GeomWithData<Rectangle<[f64; 3]>, usize>>;

/// The point of the surface nearest to another.
#[derive(Clone)]
struct Foot {
    patch: usize,
    /// The edges of the patch that it is on.
    on: [bool; 3],
    jet: Jet,
    /// Out of the obstacle, of the patch.
    normal: Point,
    /// From the foot to the point.
    from: Point,
    /// What of that is along the surface: none but at a sharp edge or corner.
    aside: f64,
    /// Along the edge, if it is on one and at no corner: the square is how far it goes as the point goes along.
    edge: Option<Point>,
}

/// Distances that are one, in parts of the size of the surface.
const SAME: f64 = 1e-11;

/// Rounding of a point of a patch, which is a sum of many powers, in parts of its coordinates.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Barycentric coordinates on an edge.
const EDGE: f64 = 1e-9;

impl Triangulated {
    /// The surface of triangles given by the numbers of their corners among points \[mm\], counter-clockwise seen from
    /// outside, or all clockwise; sharp where two of them meet at an angle of more than `sharp` \[rad\].
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for coordinates or an angle out of their range, corners that are none of the points,
    /// and triangles without an area. [`ContactError::Surface`] for an edge that is not one of two triangles which go
    /// along it in opposite senses.
    pub fn new(
        points: &[[f64; 3]],
        triangles: &[[usize; 3]],
        sharp: f64,
    ) -> Result<Self, ContactError> {
        let refused = |what, value, expected| {
            Err(ContactError::OutOfRange {
                what,
                value,
                expected,
            })
        };
        if !(0.0..=std::f64::consts::PI).contains(&sharp) {
            let expected = "an angle from 0 to 180 degrees";
            return refused("angle of sharp edges", sharp.to_degrees(), expected);
        }
        if let Some(&x) = points.iter().flatten().find(|x| !x.is_finite()) {
            return refused("point of the surface", x, "finite coordinates");
        }
        let named = triangles.iter().flatten();
        if let Some(&k) = named.clone().find(|&&k| k >= points.len()) {
            return refused("corner of a triangle", k as f64, "one of the points");
        }
        if triangles.is_empty() {
            return refused("number of triangles", 0.0, "at least 4");
        }
        let at: Vec<Point> = points.iter().map(|&x| x.into()).collect();
        let (low, high) = named.fold((at[triangles[0][0]], at[triangles[0][0]]), |(l, h), &k| {
            (l.inf(&at[k]), h.sup(&at[k]))
        });
        let size = (high - low).norm();
        let volume: f64 = triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|k| at[k] - low);
                a.dot(&b.cross(&c))
            })
            .sum();
        let mut faces: Vec<[usize; 3]> = triangles.to_vec();
        if volume < 0.0 {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        let opposite = joins(&at, &faces)?;
        let patches = smooth(&at, &faces, &opposite, sharp)?;
        Ok(Self {
            boxes: boxes(&patches, |_| true),
            patches,
            opposite,
            sharp,
            first: at[faces[0][0]],
            size,
            side: 1.0,
        })
    }

    /// The same surface around a hollow: the body is inside.
    pub fn hollow(self) -> Self {
        Self { side: -1.0, ..self }
    }

    fn foot(&self, x: &Point) -> Foot {
        self.foot_among(&self.boxes, x)
    }

    /// The nearest point of the patches in these boxes, of which there is one at least.
    fn foot_among(&self, boxes: &Boxes, x: &Point) -> Foot {
        let mut best: Option<(f64, Foot)> = None;
        let near = boxes.nearest_neighbor_iter([x[0], x[1], x[2]]);
        for found in near {
            let least = found.geom().distance_2(&[x[0], x[1], x[2]]).sqrt();
            if best
                .as_ref()
                .is_some_and(|(d, _)| least > d + SAME * self.size)
            {
                break;
            }
            let patch = &self.patches[found.data];
            if best
                .as_ref()
                .is_some_and(|(d, _)| patch.away(x) > d + SAME * self.size)
            {
                continue;
            }
            let at = patch.nearest(x);
            let jet = patch.at(&at);
            let from = x - jet.x;
            let (distance, normal) = (from.norm(), jet.normal().unwrap_or_else(Point::x));
            let aside = (from - normal * normal.dot(&from)).norm();
            let nearer = |(d, other): &(f64, Foot)| {
                // Of patches that are as near, that which the point is in front of: it knows the side.
                let tied = (distance - d).abs() <= SAME * self.size;
                if tied {
                    aside < other.aside
                } else {
                    distance < *d
                }
            };
            if best.as_ref().is_none_or(nearer) {
                let on = edges_at(&at);
                let edge = edge_of(on, &jet, &from);
                let foot = Foot {
                    patch: found.data,
                    on,
                    jet,
                    normal,
                    from,
                    aside,
                    edge,
                };
                best = Some((distance, foot));
            }
        }
        let (_, foot) = best.expect("a surface has patches");
        foot
    }

    /// [`Obstacle::way`] from one foot to another.
    fn way_between(&self, start: &Foot, end: &Foot) -> Point {
        let [before, now] = [start, end].map(|foot| foot.normal(self.size));
        let chord = end.jet.x - start.jet.x;
        // What of the chord the normal turns along is that of an arc.
        let turn = now - before;
        let (half, squared) = (0.5 * turn.norm(), turn.norm_squared());
        let round = match half > 0.0 && half < 1.0 {
            true => turn * (turn.dot(&chord) / squared * (half.asin() / half - 1.0)),
            false => Point::zeros(),
        };
        let way = chord + round;
        let along = way - now * now.dot(&way);
        match along.norm() > 0.0 {
            true => along * (way.norm() / along.norm()),
            false => along,
        }
    }
}

/// Angle between normals from which on faces are two \[rad\].
const TWO: f64 = 0.05;

/// A face at a place.
struct Face {
    /// The point of it nearest to the place.
    foot: Point,
    normal: Point,
    /// From there into the face.
    inwards: Point,
}

/// The tangent planes of faces.
struct Planes<'a> {
    faces: &'a [Face],
    normals: SVD<f64, Dyn, Dyn>,
}

impl<'a> Planes<'a> {
    fn of(faces: &'a [Face]) -> Self {
        let normals = DMatrix::from_fn(faces.len(), 3, |i, j| faces[i].normal[j]);
        Self {
            faces,
            normals: normals.svd(true, true),
        }
    }

    /// The shortest vector with these components along the normals.
    fn solve(&self, components: &DVector<f64>) -> Option<Point> {
        let met = self.normals.solve(components, 1e-6).ok()?;
        Some(Point::new(met[0], met[1], met[2]))
    }

    /// From x to where they meet: a line, or a point.
    fn meet(&self, x: &Point) -> Option<Point> {
        let off = |face: &Face| (face.foot - x).dot(&face.normal);
        let off = self.faces.iter().map(off);
        self.solve(&DVector::from_iterator(self.faces.len(), off))
    }
}

impl Triangulated {
    /// The faces within a distance of a place, if they are of more than one normal and the obstacle is convex there.
    fn faces_at(&self, x: &Point, within: f64) -> Option<Vec<Face>> {
        let (low, high) = (x.add_scalar(-within), x.add_scalar(within));
        let around = AABB::from_corners(low.into(), high.into());
        let mut faces: Vec<Face> = Vec::new();
        for found in self.boxes.locate_in_envelope_intersecting(around) {
            let patch = &self.patches[found.data];
            if patch.away(x) > within {
                continue;
            }
            let (jet, middle) = (
                patch.at(&patch.nearest(x)),
                patch.at(&Vector2::repeat(1.0 / 3.0)),
            );
            let normal = jet.normal().filter(|_| (jet.x - x).norm() <= within);
            let Some(normal) = normal else { continue };
            if faces.iter().all(|face| face.normal.angle(&normal) > TWO) {
                faces.push(Face {
                    foot: jet.x,
                    normal,
                    inwards: middle.x - jet.x,
                });
            }
        }
        let is_below = |face: &Face, other: &Face| {
            let same = face.normal == other.normal;
            same || self.side * face.normal.dot(&other.inwards) < 0.0
        };
        let is_convex = faces.iter().all(|f| faces.iter().all(|g| is_below(f, g)));
        (faces.len() > 1 && is_convex).then_some(faces)
    }
}

/// Boxes around some of the patches.
fn boxes(patches: &[Patch], is_in: impl Fn(usize) -> bool) -> Boxes {
    let some = patches.iter().enumerate().filter(|(k, _)| is_in(*k));
    let boxed = some.map(|(k, patch)| {
        let [low, high] = patch.around();
        GeomWithData::new(Rectangle::from_corners(low, high), k)
    });
    RTree::bulk_load(boxed.collect())
}

/// Whether a point of a patch is on its edges, of which edge k goes from corner k to the next.
fn edges_at(at: &Vector2<f64>) -> [bool; 3] {
    [at.y, 1.0 - at.x - at.y, at.x].map(|c| c < EDGE)
}

/// Along the edge that a point of a patch is on, none inside and at corners: as long as the root of how far the point
/// of the edge that is nearest to another, `from` there, goes as that goes along.
fn edge_of(on: [bool; 3], jet: &Jet, from: &Point) -> Option<Point> {
    let along = match on {
        [true, false, false] => Vector2::new(1.0, 0.0),
        [false, true, false] => Vector2::new(-1.0, 1.0),
        [false, false, true] => Vector2::new(0.0, 1.0),
        _ => return None,
    };
    let direction = jet.d * along;
    let bend = along.dot(&(jet.second(from) * along));
    let ahead = direction.norm_squared() - bend;
    (ahead > 0.0).then(|| direction / ahead.sqrt())
}

impl Foot {
    /// Moves it to where the perpendicular from x meets the tangent plane.
    fn onto_plane(&mut self, x: &Point) {
        let ahead = self.normal * self.normal.dot(&self.from);
        (self.jet.x, self.from, self.aside) = (x - ahead, ahead, 0.0);
    }

    /// Whether the point is opposite a sharp edge or corner, not of the face beside it.
    fn is_off(&self, size: f64) -> bool {
        self.aside > 1e-9 * size
    }

    /// Signed distance, positive outside.
    fn distance(&self, size: f64) -> f64 {
        let ahead = self.from.dot(&self.normal);
        match self.is_off(size) {
            true => self.from.norm().copysign(ahead),
            false => ahead,
        }
    }

    /// Out of the obstacle.
    fn normal(&self, size: f64) -> Point {
        match self.is_off(size) {
            true => self.from / self.distance(size),
            false => self.normal,
        }
    }

    fn curvature(&self, size: f64) -> Matrix3<f64> {
        let distance = self.distance(size);
        if self.is_off(size) {
            let n = self.normal(size);
            let along = self.edge.unwrap_or_default();
            let across = Matrix3::identity() - n * n.transpose() - along * along.transpose();
            return across / distance;
        }
        // dn = D G⁻¹ B dξ where D (1 + g G⁻¹ B) dξ is what of dx is along the surface.
        let (d, bend) = (&self.jet.d, -self.jet.second(&self.normal));
        let metric = d.transpose() * d;
        let Some(inverse) = metric.try_inverse() else {
            return Matrix3::zeros();
        };
        let shape = inverse * bend;
        let ahead = nalgebra::Matrix2::identity() + shape * distance;
        let turned = ahead.try_inverse().map(|ahead| shape * ahead);
        turned.map_or_else(Matrix3::zeros, |t| d * t * inverse * d.transpose())
    }
}

/// Angle between normals that is rounding, of coordinates of single precision \[rad\].
const ROUNDED: f64 = 1e-4;

/// Least angle around a corner of what a fillet rounds off: half of a turn, less a corner of an outline \[rad\].
const HALF: f64 = 2.6;

/// Where faces lean this many times farther from their mean normal than neighbours among them meet at, their corner is a point.
/// Where a surface is smooth and n faces meet, they lean 1/(2 sin π/n) times as far, and at a pole half as far as faces bend
/// across its first ring.
const POINTED: f64 = 1.5;

/// Angle to its chord from which on the direction of a crease, along both of its faces, is none of its edge \[rad\].
const ASTRAY: f64 = 0.6;

/// How much longer than others the triangles of a wall are, and how much broader a plane.
const LARGE: f64 = 4.0;

/// The triangles around a corner that are in one plane.
#[derive(Clone, Default)]
struct Plane {
    /// Sum of a × b/(|a|² |b|²) over them, with their edges a and b from the corner.
    normal: Point,
    /// Sum of the angles between those \[rad\].
    angle: f64,
    longest: f64,
    /// Of the whole face that they are of.
    breadth: f64,
}

impl Plane {
    fn add(&mut self, a: Point, b: Point, breadth: f64) {
        self.normal += a.cross(&b) / (a.norm_squared() * b.norm_squared());
        self.angle += a.angle(&b);
        self.longest = self.longest.max(a.norm()).max(b.norm());
        self.breadth = breadth;
    }

    /// Beside an edge that ends in a point: as long as the cotangent of half the angle, for the mean of two to be the normal
    /// of the round cone that both are in.
    fn at_point(&self) -> Self {
        let cotangent = (0.5 * self.angle).tan().recip();
        Self {
            normal: self.normal.normalize() * cotangent.max(f64::EPSILON),
            ..self.clone()
        }
    }
}

/// The mean normal of the planes around a corner, not of unit length. Of one that is broad beside all others, or ends there,
/// half around the corner, that of the plane, and of long triangles beside others the mean of theirs: these others are a
/// fillet, tangent to them.
fn mean_normal(mut planes: Vec<Plane>) -> Point {
    let angle = |planes: &[Plane]| planes.iter().map(|p| p.angle).sum::<f64>();
    let broadest = planes.iter().map(|p| p.breadth).fold(0.0, f64::max);
    let mut broad = planes.iter().filter(|p| p.breadth * LARGE >= broadest);
    if let (Some(only), None) = (broad.next(), broad.next()) {
        return only.normal;
    }
    let longest = planes.iter().map(|p| p.longest).fold(0.0, f64::max);
    let halves = planes.iter().filter(|p| p.angle >= HALF).count();
    if halves == 1 {
        planes.retain(|p| p.angle >= HALF);
    }
    let (long, short): (Vec<Plane>, Vec<Plane>) = planes
        .into_iter()
        .partition(|p| p.longest * LARGE >= longest);
    let all = match angle(&long) >= HALF {
        true => long,
        false => long.into_iter().chain(short).collect(),
    };
    all.iter().map(|p| p.normal).sum()
}

/// The patches of faces, oriented outwards.
fn smooth(
    at: &[Point],
    faces: &[[usize; 3]],
    opposite: &[usize],
    sharp: f64,
) -> Result<Vec<Patch>, ContactError> {
    let normals = normals(at, faces)?;
    // Corner k of face f is 3 f + k; those that a smooth edge joins have one normal.
    let mut joined: Vec<usize> = (0..3 * faces.len()).collect();
    let is_smooth = |f: usize, g: usize| normals[f].angle(&normals[g]) <= sharp + ROUNDED;
    let mut flat = joined.clone();
    let mut plane: Vec<usize> = (0..faces.len()).collect();
    for (edge, &other) in opposite.iter().enumerate() {
        let (f, g) = (edge / 3, other / 3);
        let ends = [
            (edge, 3 * g + (other + 1) % 3),
            (3 * f + (edge + 1) % 3, other),
        ];
        for (own, beside) in ends {
            if is_smooth(f, g) {
                join(&mut joined, own, beside);
            }
            if normals[f].angle(&normals[g]) <= ROUNDED {
                join(&mut flat, own, beside);
                join(&mut plane, f, g);
            }
        }
    }
    let breadths = breadths(at, faces, opposite, &plane);
    let mut planes: BTreeMap<usize, Plane> = BTreeMap::new();
    for k in 0..joined.len() {
        let [x, y, z] = [0, 1, 2].map(|i| at[faces[k / 3][(k + i) % 3]]);
        let plane = planes.entry(root(&flat, k)).or_default();
        plane.add(y - x, z - x, breadths[k / 3]);
    }
    let sums = |roots: &[usize]| -> HashMap<usize, Point> {
        let mut around: BTreeMap<usize, Vec<Plane>> = BTreeMap::new();
        for (&k, plane) in &planes {
            around.entry(roots[k]).or_default().push(plane.clone());
        }
        (around.into_iter())
            .map(|(root, planes)| (root, mean_normal(planes)))
            .collect()
    };
    let mut roots: Vec<usize> = (0..joined.len()).map(|k| root(&joined, k)).collect();
    let bend = |edge: usize| {
        let (f, g) = (edge / 3, opposite[edge] / 3);
        is_smooth(f, g).then(|| normals[f].angle(&normals[g]))
    };
    let bends = |f: usize| (3 * f..3 * f + 3).filter_map(bend).fold(0.0, f64::max);
    let bends: Vec<f64> = (0..faces.len()).map(bends).collect();
    let pointed = pointed(&roots, &sums(&roots), &normals, &bends);
    for (k, own) in roots
        .iter_mut()
        .enumerate()
        .filter(|(_, own)| pointed[**own])
    {
        *own = root(&flat, k);
    }
    let sums = sums(&roots);
    let corners = Corners {
        flat: (0..flat.len()).map(|k| root(&flat, k)).collect(),
        normals: &normals,
        roots,
        planes,
        sums,
    };
    let place = |k: usize| at[faces[k / 3][k % 3]];
    let next = |edge: usize| edge - edge % 3 + (edge + 1) % 3;
    // The normal and the direction of an edge at its ends.
    let edge = |edge: usize| {
        let other = opposite[edge];
        let (chord, is_smooth) = (
            place(next(edge)) - place(edge),
            is_smooth(edge / 3, other / 3),
        );
        [[edge, next(other)], [next(edge), other]].map(|end| corners.end(end, chord, is_smooth))
    };
    let patch = |f: usize| {
        let own = [0, 1, 2].map(|k| 3 * f + k);
        let edges = own.map(edge);
        let handles = |k: usize| {
            let ends = [own[k], next(own[k])].map(place);
            handles(ends, edges[k].map(|[_, along]| along))
        };
        let normals = edges.map(|ends| ends.map(|[normal, _]| normal));
        Patch::new(own.map(place), normals, [0, 1, 2].map(handles))
    };
    Ok((0..faces.len()).map(patch).collect())
}

/// The normals of triangles.
fn normals(at: &[Point], faces: &[[usize; 3]]) -> Result<Vec<Point>, ContactError> {
    let normal = |face: &[usize; 3]| {
        let [a, b, c] = face.map(|k| at[k]);
        let area = (b - a).cross(&(c - a));
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        match area.norm() > 1e-10 * longest * longest && area.norm().is_finite() {
            true => Ok(area.normalize()),
            false => Err(ContactError::Surface {
                what: "a triangle has no area",
                at: [a.into(), b.into()],
                apart: None,
            }),
        }
    };
    faces.iter().map(normal).collect()
}

/// The corners of triangles, of which corner k of face f is 3 f + k.
struct Corners<'a> {
    /// Of the faces.
    normals: &'a [Point],
    /// Those that have one normal have one number, as those in one plane have.
    roots: Vec<usize>,
    flat: Vec<usize>,
    planes: BTreeMap<usize, Plane>,
    /// Mean normals, not of unit length, by those numbers.
    sums: HashMap<usize, Point>,
}

impl Corners<'_> {
    fn normal(&self, k: usize) -> Point {
        let normal = self.sums[&self.roots[k]].try_normalize(0.0);
        normal.unwrap_or(self.normals[k / 3])
    }

    /// The normal that the two corners at an end of a smooth edge share, also in a point.
    fn shared(&self, [k, other]: [usize; 2]) -> Point {
        if self.roots[k] == self.roots[other] {
            return self.normal(k);
        }
        let sides = [k, other].map(|k| self.planes[&self.flat[k]].at_point());
        let mean = mean_normal(sides.to_vec()).try_normalize(0.0);
        mean.unwrap_or_else(|| self.normal(k.min(other)))
    }

    /// The normal of the first of two corners at an end of an edge, and the direction of the edge there.
    fn end(&self, [k, other]: [usize; 2], chord: Point, is_smooth: bool) -> [Point; 2] {
        if is_smooth || self.roots[k] == self.roots[other] {
            let n = self.shared([k, other]);
            return [n, across(chord, n)];
        }
        // A sharp one goes along both of its faces, as far as these leave it where it is.
        let n = self.normal(k);
        let crease = n.cross(&self.normal(other));
        let along = (crease * crease.dot(&chord).signum()).try_normalize(1e-6);
        match along.filter(|along| along.angle(&chord) < ASTRAY) {
            Some(along) => [n, along],
            None => [across(n, chord.normalize()), chord.normalize()],
        }
    }
}

/// A vector without what of it is along another of unit length, and of unit length itself; its direction where nothing is left.
fn across(of: Point, other: Point) -> Point {
    let rest = of - other * other.dot(&of);
    rest.try_normalize(0.0).unwrap_or_else(|| of.normalize())
}

/// Which of the corners that smooth edges join, each known by the least of them, are points, as the tip of a cone: see
/// [`POINTED`].
fn pointed(
    roots: &[usize],
    sums: &HashMap<usize, Point>,
    normals: &[Point],
    bends: &[f64],
) -> Vec<bool> {
    let (mut lean, mut bend) = (vec![0.0_f64; roots.len()], vec![0.0_f64; roots.len()]);
    for (k, &root) in roots.iter().enumerate() {
        lean[root] = lean[root].max(sums[&root].angle(&normals[k / 3]));
        bend[root] = bend[root].max(bends[k / 3]);
    }
    let leans = lean.iter().zip(bend);
    leans
        .map(|(&lean, bend)| lean > TWO && lean > POINTED * bend)
        .collect()
}

/// Of each face, twice the area over the perimeter of all that are in its plane and joined to it.
fn breadths(at: &[Point], faces: &[[usize; 3]], opposite: &[usize], plane: &[usize]) -> Vec<f64> {
    let planes: Vec<usize> = (0..faces.len()).map(|f| root(plane, f)).collect();
    let (mut areas, mut perimeters) = (vec![0.0; faces.len()], vec![0.0; faces.len()]);
    for (f, &plane) in planes.iter().enumerate() {
        let [a, b, c] = faces[f].map(|k| at[k]);
        areas[plane] += 0.5 * (b - a).cross(&(c - a)).norm();
        for (k, side) in [b - a, c - b, a - c].iter().enumerate() {
            if planes[opposite[3 * f + k] / 3] != plane {
                perimeters[plane] += side.norm();
            }
        }
    }
    (planes.iter())
        .map(|&plane| 2.0 * areas[plane] / perimeters[plane])
        .collect()
}

/// For edge k of face f, which goes from corner k to the next and is 3 f + k, the same edge of the other face.
fn joins(at: &[Point], faces: &[[usize; 3]]) -> Result<Vec<usize>, ContactError> {
    let ends = |edge: usize| [faces[edge / 3][edge % 3], faces[edge / 3][(edge + 1) % 3]];
    let mut edges: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
    for edge in 0..3 * faces.len() {
        let [a, b] = ends(edge);
        edges.entry([a.min(b), a.max(b)]).or_default().push(edge);
    }
    let mut opposite = vec![0; 3 * faces.len()];
    for (pair, found) in &edges {
        let what = match found[..] {
            [e, f] if ends(e) != ends(f) => {
                (opposite[e], opposite[f]) = (f, e);
                continue;
            }
            [_, _] => "two triangles go along an edge in the same sense",
            [_] => "the surface is open along an edge",
            _ => "more than two triangles meet at an edge",
        };
        return Err(ContactError::Surface {
            what,
            at: pair.map(|k| at[k].into()),
            apart: (found.len() == 1)
                .then(|| apart(at, &edges, pair))
                .flatten(),
        });
    }
    Ok(opposite)
}

/// Parts of an edge up to which corners are near each other.
const NEAR: f64 = 0.1;

/// How far an end of an open edge is from the nearest corner of others that no edge joins it to, if that is near.
fn apart(at: &[Point], edges: &BTreeMap<[usize; 2], Vec<usize>>, ends: &[usize; 2]) -> Option<f64> {
    let open = edges.iter().filter(|(_, found)| found.len() == 1);
    let others = open.flat_map(|(pair, _)| *pair);
    let pairs = others.flat_map(|other| ends.map(|end| [end.min(other), end.max(other)]));
    let free = pairs.filter(|[a, b]| a != b && !edges.contains_key(&[*a, *b]));
    let least = free.map(|[a, b]| (at[a] - at[b]).norm()).reduce(f64::min);
    least.filter(|least| *least < NEAR * (at[ends[0]] - at[ends[1]]).norm())
}

fn root(joined: &[usize], mut k: usize) -> usize {
    while joined[k] != k {
        k = joined[k];
    }
    k
}

fn join(joined: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(joined, a), root(joined, b));
    joined[a.max(b)] = a.min(b);
}

impl Obstacle<3> for Triangulated {
    fn distance(&self, x: &Point) -> f64 {
        self.side * self.foot(x).distance(self.size)
    }

    fn normal(&self, x: &Point) -> Point {
        self.foot(x).normal(self.size) * self.side
    }

    fn curvature(&self, x: &Point) -> Matrix3<f64> {
        self.foot(x).curvature(self.size) * self.side
    }

    fn way(&self, from: &Point, to: &Point) -> Point {
        self.way_between(&self.foot(from), &self.foot(to))
    }

    fn reference(&self) -> Point {
        self.first
    }

    fn rounding(&self) -> f64 {
        ROUNDING * (self.size + self.first.amax())
    }

    fn parts(&self) -> Vec<Box<dyn Obstacle<3>>> {
        parts::of(self)
    }
    fn corner(&self, x: &Point, tolerance: f64) -> Option<Corner<3>> {
        let foot = self.foot(x);
        let depth = -self.side * foot.distance(self.size);
        // Behind a corner its faces are all as far away, and their planes meet there.
        let near = match depth > tolerance {
            true => x + Planes::of(&self.faces_at(x, depth + 2.0 * tolerance)?).meet(x)?,
            false => foot.jet.x,
        };
        let faces = self.faces_at(&near, 2.0 * tolerance)?;
        let planes = Planes::of(&faces);
        let way = planes.meet(x)?;
        // As far from all normals.
        let equal = DVector::repeat(faces.len(), self.side);
        let axis = planes.solve(&equal)?.try_normalize(1e-6)?;
        let aside = (way - axis * axis.dot(&way)).norm();
        let angle = |face: &Face| axis.angle(&(face.normal * self.side));
        let half_angle = faces.iter().map(angle).fold(0.0, f64::max);
        let edge = match &faces[..] {
            [a, b] => a.normal.cross(&b.normal).try_normalize(0.0),
            _ => None,
        };
        (aside <= tolerance && half_angle < FRAC_PI_2).then_some(Corner {
            position: x + way,
            axis,
            half_angle,
            edge,
        })
    }
}

#[cfg(test)]
mod tests;
