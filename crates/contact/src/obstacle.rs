//! Rigid obstacles as signed distances; not their motion, which the driver prescribes.

use crate::ContactError;
use nalgebra::SVector;

/// A rigid obstacle, known by its signed distance.
pub trait Obstacle<const D: usize>: Send + Sync {
    /// Signed distance of a point to the surface \[mm\], positive outside the obstacle.
    fn distance(&self, x: &SVector<f64, D>) -> f64;

    /// Gradient of the distance at x: the unit normal that points from the obstacle (Ω_A) into
    /// the body (Ω_B), so that u_n ≥ 0 opens.
    fn normal(&self, x: &SVector<f64, D>) -> SVector<f64, D>;

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
}

impl<const D: usize, T: Obstacle<D> + ?Sized> Obstacle<D> for Box<T> {
    fn distance(&self, x: &SVector<f64, D>) -> f64 {
        (**self).distance(x)
    }

    fn normal(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        (**self).normal(x)
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
}

impl<const D: usize> Obstacle<D> for Ball<D> {
    fn distance(&self, x: &SVector<f64, D>) -> f64 {
        self.side() * ((x - self.center).norm() - self.radius)
    }

    fn normal(&self, x: &SVector<f64, D>) -> SVector<f64, D> {
        let radial = x - self.center;
        // At the very center every direction is as good as another.
        let unit = radial.try_normalize(0.0).unwrap_or_else(|| axis(0));
        unit * self.side()
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
        self.ball.distance(&self.section(x))
    }

    fn normal(&self, x: &SVector<f64, 3>) -> SVector<f64, 3> {
        let radial = self.section(x) - self.ball.center;
        // On the axis every direction across it is as good as another.
        let unit = radial.try_normalize(0.0);
        let unit = unit.unwrap_or_else(|| frame(&self.axis).column(1).into_owned());
        unit * self.ball.side()
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

/// An orthonormal frame whose first column is the unit vector n; the other columns span the
/// tangent plane. In 2D the tangent is n turned by −90°: for n = e_y it is e_x. In 3D the tangents are
/// the axes in their order, projected, without the one that n is nearest to: for n = e_y they are e_x
/// and e_z, and nearly so for an n nearby.
pub fn frame<const D: usize>(n: &SVector<f64, D>) -> nalgebra::SMatrix<f64, D, D> {
    let mut q = nalgebra::SMatrix::<f64, D, D>::zeros();
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
            prop_assert!((cylinder.distance(&x) - cylinder.distance(&y)).abs() < 1e-12);
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
