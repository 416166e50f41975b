//! Rigid obstacles as signed distances; not their motion, which the driver prescribes.

use crate::ContactError;
use nalgebra::{SMatrix, SVector};

/// A rigid obstacle, known by its signed distance.
pub trait Obstacle<const D: usize>: Send + Sync {
    /// Signed distance of a point to the surface \[mm\], positive outside the obstacle.
    fn distance(&self, x: &SVector<f64, D>) -> f64;

    /// Gradient of the distance at x: the unit normal that points from the obstacle (Ω_A) into
    /// the body (Ω_B), so that u_n ≥ 0 opens.
    fn normal(&self, x: &SVector<f64, D>) -> SVector<f64, D>;

    /// ∂n/∂x \[1/mm\], by which the normal turns as x moves: the second derivatives of the distance, symmetric. None
    /// of a plane.
    fn curvature(&self, _x: &SVector<f64, D>) -> SMatrix<f64, D, D> {
        SMatrix::zeros()
    }

    /// The way along the surface from the point nearest to `from` to that nearest to `to` \[mm\], tangent to it at
    /// the latter: as long as the shortest line between them on the surface. What does not say otherwise takes
    /// the chord.
    fn way(&self, from: &SVector<f64, D>, to: &SVector<f64, D>) -> SVector<f64, D> {
        let foot = |x: &SVector<f64, D>| x - self.normal(x) * self.distance(x);
        let (chord, n) = (foot(to) - foot(from), self.normal(to));
        chord - n * n.dot(&chord)
    }

    /// The point that a motion of the obstacle is told of, and that it turns about, unless another is given.
    fn reference(&self) -> SVector<f64, D> {
        SVector::zeros()
    }

    /// What rounding makes of its distances and ways beyond that of the coordinates of points \[mm\]. Nothing of an
    /// obstacle that is one formula.
    fn rounding(&self) -> f64 {
        0.0
    }

    /// The parts between its sharp concave corners, in which a node touches more than one; empty of an obstacle that has
    /// no such corners. None goes on where it would come out of the obstacle again.
    fn parts(&self) -> Vec<Box<dyn Obstacle<D>>> {
        Vec::new()
    }

    /// The sharp convex corner that x is straight ahead of, or at, within `tolerance` \[mm\] sideways:
    /// the normal there is any of a cone. A smooth obstacle has none.
    fn corner(&self, _x: &SVector<f64, D>, _tolerance: f64) -> Option<Corner<D>> {
        None
    }
}

/// A sharp convex corner of an obstacle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner<const D: usize> {
    /// Where it is \[mm\].
    pub position: SVector<f64, D>,
    /// The axis of the cone of normals, of unit length.
    pub axis: SVector<f64, D>,
    /// The angle between the axis and the normals of the faces \[rad\], below π/2.
    pub half_angle: f64,
    /// In space the direction of the edge across which the normals are, of unit length; none where more than two faces
    /// meet, and the cone is one around all of their normals.
    pub edge: Option<SVector<f64, D>>,
}

impl<const D: usize, T: Obstacle<D> + ?Sized> Obstacle<D> for Box<T> {
    fn rounding(&self) -> f64 {
        (**self).rounding()
    }

    fn parts(&self) -> Vec<Box<dyn Obstacle<D>>> {
        (**self).parts()
    }

    fn distance(&self, x: &SVector<f64, D>) -> f64 {
        (**self).distance(x)
    }

    fn normal(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        (**self).normal(x)
    }

    fn curvature(&self, x: &SVector<f64, D>) -> SMatrix<f64, D, D> {
        (**self).curvature(x)
    }

    fn way(&self, from: &SVector<f64, D>, to: &SVector<f64, D>) -> SVector<f64, D> {
        (**self).way(from, to)
    }

    fn reference(&self) -> SVector<f64, D> {
        (**self).reference()
    }

    fn corner(&self, x: &SVector<f64, D>, tolerance: f64) -> Option<Corner<D>> {
        (**self).corner(x, tolerance)
    }
}

/// A half-space; its surface is a plane (in 2D a straight line).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane<const D: usize> {
    point: SVector<f64, D>,
    normal: SVector<f64, D>,
}

impl<const D: usize> Plane<D> {
    /// The plane through `point` whose `normal`, of any length, points out of the obstacle.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] for a normal of length zero or numbers that are not finite.
    pub fn new(point: [f64; D], normal: [f64; D]) -> Result<Self, ContactError> {
        let (point, normal) = (SVector::from(point), SVector::from(normal));
        let length = normal.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(ContactError::OutOfRange {
                what: "length of the plane's normal",
                value: length,
                expected: "a positive number",
            });
        }
        finite("point of the plane", &point)?;
        Ok(Self {
            point,
            normal: normal / length,
        })
    }
}

impl<const D: usize> Obstacle<D> for Plane<D> {
    fn distance(&self, x: &SVector<f64, D>) -> f64 {
        (x - self.point).dot(&self.normal)
    }

    fn normal(&self, _: &SVector<f64, D>) -> SVector<f64, D> {
        self.normal
    }

    fn way(&self, from: &SVector<f64, D>, to: &SVector<f64, D>) -> SVector<f64, D> {
        let chord = to - from;
        chord - self.normal * self.normal.dot(&chord)
    }

    fn reference(&self) -> SVector<f64, D> {
        self.point
    }
}

/// A ball: in 2D a cylinder seen along its axis, in 3D a sphere; or the hollow left by one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball<const D: usize> {
    center: SVector<f64, D>,
    radius: f64,
    hollow: bool,
}

impl<const D: usize> Ball<D> {
    /// A solid ball: the body is outside.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] unless the radius is positive and all numbers are finite.
    pub fn new(center: [f64; D], radius: f64) -> Result<Self, ContactError> {
        let center = SVector::from(center);
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(ContactError::OutOfRange {
                what: "radius",
                value: radius,
                expected: "a positive number",
            });
        }
        finite("center", &center)?;
        Ok(Self {
            center,
            radius,
            hollow: false,
        })
    }

    /// The same surface around a hollow: the body is inside.
    pub fn hollow(self) -> Self {
        Self {
            hollow: true,
            ..self
        }
    }

    fn side(&self) -> f64 {
        if self.hollow { -1.0 } else { 1.0 }
    }

    /// Distance of a point at x − c less a way along an axis, from the center c. The difference of two lengths is rounded as
    /// they are, which of a large radius is too much for the force that a stiff body makes of it; here it is that of their
    /// squares, with what products and sums round off, over their sum.
    fn beyond(&self, x: &SVector<f64, D>, along: &SVector<f64, D>, times: f64) -> f64 {
        let (mut squares, mut lost, mut around) = (0.0, 0.0, 0.0);
        let mut add = |a: f64, b: f64| {
            let (sum, rest) = sum_and_rest(squares, a * b);
            squares = sum;
            lost += rest + a.mul_add(b, -(a * b));
        };
        for ((x, c), along) in x.iter().zip(&self.center).zip(along) {
            let (way, rest) = sum_and_rest(*x, -c);
            let less = along * times;
            let (way, more) = sum_and_rest(way, -less);
            let rest = rest + more - along.mul_add(times, -less);
            add(way, way);
            add(2.0 * way, rest);
            around += way * way;
        }
        add(-self.radius, self.radius);
        self.side() * (squares + lost) / (around.sqrt() + self.radius)
    }
}

/// a + b, and what its rounding leaves out (D. E. Knuth, The art of computer programming 2, 4.2.2).
fn sum_and_rest(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

impl<const D: usize> Obstacle<D> for Ball<D> {
    fn distance(&self, x: &SVector<f64, D>) -> f64 {
        self.beyond(x, &SVector::zeros(), 0.0)
    }

    fn normal(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        let radial = x - self.center;
        // At the very center every direction is as good as another.
        let unit = radial.try_normalize(0.0).unwrap_or_else(|| axis(0));
        unit * self.side()
    }

    fn curvature(&self, x: &SVector<f64, D>) -> SMatrix<f64, D, D> {
        let (n, radius) = (self.normal(x), (x - self.center).norm());
        match radius > 0.0 {
            true => (SMatrix::identity() - n * n.transpose()) * (self.side() / radius),
            false => SMatrix::zeros(),
        }
    }

    fn way(&self, from: &SVector<f64, D>, to: &SVector<f64, D>) -> SVector<f64, D> {
        // In a hollow normals look against the radius.
        arc(&self.normal(from), &self.normal(to)) * (self.side() * self.radius)
    }

    fn reference(&self) -> SVector<f64, D> {
        self.center
    }
}

/// A cylinder in space, without ends, or the hollow left by one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// A ball around a point of the axis: the section of the cylinder through it.
    ball: Ball<3>,
    axis: SVector<f64, 3>,
}

impl Cylinder {
    /// The cylinder around the axis through `center` along `axis`, of any length; the body is
    /// outside.
    ///
    /// # Errors
    /// [`ContactError::OutOfRange`] unless the radius and the length of the axis are positive and
    /// all numbers are finite.
    pub fn new(center: [f64; 3], axis: [f64; 3], radius: f64) -> Result<Self, ContactError> {
        let axis = SVector::from(axis);
        let length = axis.norm();
        if !(length > 0.0 && length.is_finite()) {
            return Err(ContactError::OutOfRange {
                what: "length of the cylinder's axis",
                value: length,
                expected: "a positive number",
            });
        }
        Ok(Self {
            ball: Ball::new(center, radius)?,
            axis: axis / length,
        })
    }

    /// The same surface around a hollow: the body is inside.
    pub fn hollow(self) -> Self {
        Self {
            ball: self.ball.hollow(),
            ..self
        }
    }

    /// The point at the same distance in the section through the center.
    fn section(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> {
        x - self.axis * (x - self.ball.center).dot(&self.axis)
    }
}

impl Obstacle<3> for Cylinder {
    fn distance(&self, x: &SVector<f64, 3>) -> f64 {
        let along = (x - self.ball.center).dot(&self.axis);
        self.ball.beyond(x, &self.axis, along)
    }

    fn normal(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> {
        let radial = self.section(x) - self.ball.center;
        // On the axis every direction across it is as good as another.
        let unit = radial.try_normalize(0.0);
        let unit = unit.unwrap_or_else(|| frame(&self.axis).column(1).into_owned());
        unit * self.ball.side()
    }

    fn curvature(&self, x: &SVector<f64, 3>) -> SMatrix<f64, 3, 3> {
        let section = self.section(x);
        let along = self.axis * self.axis.transpose();
        let around = (section - self.ball.center).norm();
        match around > 0.0 {
            true => self.ball.curvature(&section) - along * (self.ball.side() / around),
            false => SMatrix::zeros(),
        }
    }

    fn way(&self, from: &SVector<f64, 3>, to: &SVector<f64, 3>) -> SVector<f64, 3> {
        let around = self.ball.way(&self.section(from), &self.section(to));
        around + self.axis * self.axis.dot(&(to - from))
    }

    fn reference(&self) -> SVector<f64, 3> {
        self.ball.center
    }
}

/// Unit vector along coordinate k.
fn axis<const D: usize>(k: usize) -> SVector<f64, D> {
    SVector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 })
}

fn finite<const D: usize>(what: &'static str, x: &SVector<f64, D>) -> Result<(), ContactError> {
    match x.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(ContactError::OutOfRange {
            what,
            value,
            expected: "finite coordinates",
        }),
        None => Ok(()),
    }
}

/// The angle between two unit vectors, as a vector along the way from the first to the second, tangent to it at the latter:
/// the way over a ball of radius one.
pub fn arc<const D: usize>(before: &SVector<f64, D>, now: &SVector<f64, D>) -> SVector<f64, D> {
    let chord = now - before;
    // As long as the sine is.
    let sine = chord - now * now.dot(&chord);
    let length = sine.norm();
    match length > 0.0 {
        true => sine * (length.atan2(before.dot(now)) / length),
        false => sine,
    }
}

/// An orthonormal frame whose first column is the unit vector n; the other columns span the
/// tangent plane. In 2D the tangent is n turned by −90°: for n = e_y it is e_x. In 3D the tangents are
/// the axes in their order, projected, without the one that n is nearest to: for n = e_y they are e_x
/// and e_z, and nearly so for an n nearby.
pub fn frame<const D: usize>(n: &SVector<f64, D>) -> SMatrix<f64, D, D> {
    let mut q = SMatrix::<f64, D, D>::zeros();
    q.set_column(0, n);
    if D == 2 {
        q[(0, 1)] = n[1];
        q[(1, 1)] = -n[0];
        return q;
    }
    // Gram–Schmidt on the other axes. Of components that are equal up to rounding the last counts.
    let nearest = (0..D).rfind(|&i| n[i].abs() >= n.amax() - 1e-9);
    for (i, k) in (0..D).filter(|&i| Some(i) != nearest).zip(1..) {
        let mut v = axis::<D>(i);
        for j in 0..k {
            let c = q.column(j).into_owned();
            v -= c * c.dot(&v);
        }
        q.set_column(k, &v.normalize());
    }
    q
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn obeys_eikonal(obstacle: &dyn Obstacle<3>, x: SVector<f64, 3>) {
        let n = obstacle.normal(&x);
        assert!((n.norm() - 1.0).abs() < 1e-12);
        let h = 1e-4;
        let ahead = obstacle.distance(&(x + n * h));
        let behind = obstacle.distance(&(x - n * h));
        assert!(
            ((ahead - behind) / (2.0 * h) - 1.0).abs() < 1e-8,
            "normal is not the gradient"
        );
    }

    fn turns_by_its_curvature(obstacle: &dyn Obstacle<3>, x: SVector<f64, 3>) {
        let (w, h) = (obstacle.curvature(&x), 1e-5);
        for k in 0..3 {
            let e = axis::<3>(k) * h;
            let slope = (obstacle.normal(&(x + e)) - obstacle.normal(&(x - e))) / (2.0 * h);
            assert!((w.column(k) - slope).norm() < 1e-7, "{w} {slope}");
        }
    }

    /// Ways add up along the shortest line, and are as long as the chords of many small pieces.
    fn goes_along_itself(obstacle: &dyn Obstacle<3>, from: SVector<f64, 3>, to: SVector<f64, 3>) {
        let way = obstacle.way(&from, &to);
        assert!(way.dot(&obstacle.normal(&to)).abs() < 1e-12);
        let foot = |x: &SVector<f64, 3>| x - obstacle.normal(x) * obstacle.distance(x);
        // Backwards along the way, by which the surface leads to where it began.
        let (mut x, mut left, pieces) = (foot(&to), -way, 20_000);
        for _ in 0..pieces {
            let next = foot(&(x + left / f64::from(pieces)));
            let n = obstacle.normal(&next);
            let turned = left - n * n.dot(&left);
            (x, left) = (
                next,
                turned * (left.norm() / turned.norm().max(f64::MIN_POSITIVE)),
            );
        }
        assert!((x - foot(&from)).norm() < 1e-3, "{x} {}", foot(&from));
    }

    /// The distance of a point near the origin from one whose center is far away is as exact as its coordinates: with c at
    /// the distance R from the origin |x − c|² − R² is |x|² − 2 x·c, of which nothing cancels here.
    #[test]
    fn a_large_radius_is_as_exact_as_a_small_one() {
        for k in [1.0, 1e3, 1e6, 1e9] {
            let (radius, center) = (5.0 * k, SVector::from([3.0 * k, 4.0 * k, 0.0]));
            let ball = Ball::new([3.0 * k, 4.0 * k, 0.0], radius).expect("valid");
            let roll = Cylinder::new([3.0 * k, 4.0 * k, 0.0], [0.0, 0.0, 1.0], radius);
            let roll = roll.expect("valid");
            for x in [[-0.3, 0.1, 0.0], [0.02, -0.7, 0.4], [-0.37, -0.11, -0.9]] {
                let x = SVector::from(x);
                let exact = |square: f64| {
                    let squares = square - 2.0 * x.dot(&center);
                    squares / (radius + (squares + radius * radius).sqrt())
                };
                let (ball, round) = (ball.distance(&x), exact(x.norm_squared()));
                assert!((ball / round - 1.0).abs() < 1e-14, "{k}: {ball} {round}");
                let (roll, flat) = (roll.distance(&x), exact(x.norm_squared() - x[2] * x[2]));
                assert!((roll / flat - 1.0).abs() < 1e-14, "{k}: {roll} {flat}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn ways_lead_along_the_surface(
            from in prop::array::uniform3(-1.0..1.0f64),
            to in prop::array::uniform3(-1.0..1.0f64),
        ) {
            let (from, to) = (SVector::from(from), SVector::from(to));
            prop_assume!(from.norm() > 0.1 && to.norm() > 0.1 && from.angle(&to) < 3.0);
            let ball = Ball::new([0.0; 3], 2.0).expect("valid");
            goes_along_itself(&ball, from, to);
            goes_along_itself(&ball.hollow(), from, to);
            goes_along_itself(&Plane::new([0.0; 3], [1.0, -2.0, 0.5]).expect("valid"), from, to);
            let cylinder = Cylinder::new([0.0; 3], [0.3, 1.0, -0.4], 2.0).expect("valid");
            let [a, b] = [from, to].map(|x| cylinder.section(&x));
            prop_assume!(a.norm() > 0.1 && b.norm() > 0.1 && a.angle(&b) < 3.0);
            goes_along_itself(&cylinder, from, to);
            goes_along_itself(&cylinder.hollow(), from, to);
        }
    }

    proptest! {
        #[test]
        fn normals_are_gradients_of_the_distance(
            x in prop::array::uniform3(-5.0..5.0f64),
            center in prop::array::uniform3(6.0..9.0f64),
        ) {
            let x = SVector::from(x);
            obeys_eikonal(&Plane::new(center, [1.0, -2.0, 0.5]).expect("valid"), x);
            obeys_eikonal(&Ball::new(center, 2.0).expect("valid"), x);
            obeys_eikonal(&Ball::new(center, 30.0).expect("valid").hollow(), x);
            let along = [0.3, 1.0, -0.4];
            // From 0.5 mm off the axis on the surface is smooth.
            let cylinder = Cylinder::new(center, along, 2.0).expect("valid");
            prop_assume!(cylinder.distance(&x) > -1.5);
            obeys_eikonal(&cylinder, x);
            turns_by_its_curvature(&Plane::new(center, [1.0, -2.0, 0.5]).expect("valid"), x);
            turns_by_its_curvature(&Ball::new(center, 2.0).expect("valid"), x);
            turns_by_its_curvature(&Ball::new(center, 30.0).expect("valid").hollow(), x);
            turns_by_its_curvature(&cylinder, x);
            obeys_eikonal(&Cylinder::new(center, along, 30.0).expect("valid").hollow(), x);
        }

        #[test]
        fn a_cylinder_is_the_same_along_its_axis(
            x in prop::array::uniform3(-5.0..5.0f64),
            s in -9.0..9.0f64,
        ) {
            let axis = SVector::from([1.0, 2.0, -2.0]);
            let cylinder = Cylinder::new([1.0, 0.5, 0.0], axis.into(), 1.5).expect("valid");
            let (x, y) = (SVector::from(x), SVector::from(x) + axis * s);
            prop_assert!((cylinder.distance(&x) - cylinder.distance(&y)).abs() < 1e-13);
            let far = x + axis * 1e4;
            prop_assert!((cylinder.distance(&x) - cylinder.distance(&far)).abs() < 4e-11);
            // Distance of a point to a line, by the cross product.
            let from = x - SVector::from([1.0, 0.5, 0.0]);
            let distance = from.cross(&axis).norm() / axis.norm() - 1.5;
            prop_assert!((cylinder.distance(&x) - distance).abs() < 1e-12);
            prop_assert!(cylinder.normal(&x).dot(&axis).abs() < 1e-12);
        }

        #[test]
        fn frames_are_orthonormal(n in prop::array::uniform3(-1.0..1.0f64)) {
            prop_assume!(SVector::from(n).norm() > 1e-3);
            let n = SVector::from(n).normalize();
            let q = frame(&n);
            prop_assert!((q.transpose() * q - nalgebra::Matrix3::identity()).norm() < 1e-13);
            prop_assert!((q.column(0) - n).norm() < 1e-15);
        }
    }

    #[test]
    fn tangent_of_the_floor_is_the_x_axis() {
        // Rounding of the normal turns no tangent.
        let q = frame(&SVector::<f64, 3>::new(1e-17, -1.0, 0.0));
        assert!((q.column(1) - SVector::<f64, 3>::x()).norm() < 1e-15);
        assert!((q.column(2) - SVector::<f64, 3>::z()).norm() < 1e-15);
        let q = frame(&SVector::<f64, 2>::new(0.0, 1.0));
        assert_eq!(q.column(1).into_owned(), SVector::<f64, 2>::new(1.0, 0.0));
    }

    #[test]
    fn bad_obstacles_are_refused() {
        assert!(Plane::new([0.0, 0.0], [0.0, 0.0]).is_err());
        assert!(Plane::new([0.0, f64::NAN], [0.0, 1.0]).is_err());
        assert!(Cylinder::new([0.0; 3], [0.0; 3], 1.0).is_err());
        assert!(Cylinder::new([0.0; 3], [0.0, 0.0, 1.0], 0.0).is_err());
        assert!(Ball::new([0.0, 0.0], -1.0).is_err());
        assert!(Ball::new([0.0, 0.0], f64::INFINITY).is_err());
    }
}
