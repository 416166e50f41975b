//! Where a picture is seen from; not what it shows.

use nalgebra::Vector3;

/// Where a body is seen from: its right, its height and its way towards the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    axes: [Vector3<f64>; 3],
}

impl View {
    /// From the front, against z: the view of what lies in the plane.
    pub fn front() -> Self {
        Self::turned(0.0, 0.0)
    }

    /// From the right and above of the front, so that all three axes are seen; y points upwards.
    pub fn corner() -> Self {
        Self::turned(-0.6, 0.45)
    }

    /// Against a normal; from a corner where it has no direction.
    pub fn against(normal: Vector3<f64>) -> Self {
        let Some(n) = normal.try_normalize(1e-12) else {
            return Self::corner();
        };
        let flat = n.x.hypot(n.z);
        match flat < 1e-6 {
            // Rounding turns nothing.
            true => Self::turned(0.0, n.y.atan2(0.0)),
            false => Self::turned((-n.x).atan2(n.z), n.y.atan2(flat)),
        }
    }

    /// Turned about y, then about the horizontal \[rad\].
    fn turned(about: f64, down: f64) -> Self {
        let ((s, c), (e, d)) = (about.sin_cos(), down.sin_cos());
        Self {
            axes: [
                Vector3::new(c, 0.0, s),
                Vector3::new(e * s, d, -e * c),
                Vector3::new(-d * s, e, d * c),
            ],
        }
    }

    /// A place or a direction on paper, x to the right, y upwards, and how near to the eye it is.
    pub(super) fn seen<const D: usize>(&self, x: &[f64; D]) -> [f64; 3] {
        let along = |axis: &Vector3<f64>| x.iter().zip(axis.iter()).map(|(x, a)| x * a).sum();
        self.axes.each_ref().map(along)
    }
}

#[cfg(test)]
mod tests {
    use super::View;
    use nalgebra::{Matrix3, Vector3};

    #[test]
    fn views_are_turns_and_normals_point_to_the_eye() {
        let normals = [
            Vector3::x(),
            -Vector3::y(),
            Vector3::y(),
            -Vector3::z(),
            Vector3::new(0.3, -0.4, 0.2),
        ];
        let against = normals.map(|n| (View::against(n), n));
        let corner = (View::corner(), Vector3::zeros());
        for (view, n) in against.into_iter().chain([corner]) {
            let turn = Matrix3::from_columns(&view.axes);
            assert!((turn.transpose() * turn - Matrix3::identity()).amax() < 1e-15);
            assert!((turn.determinant() - 1.0).abs() < 1e-15);
            let seen = view.seen(&n.into());
            let towards = [0.0, 0.0, n.norm()];
            assert!(seen.iter().zip(towards).all(|(a, b)| (a - b).abs() < 1e-15));
        }
        let [x, y, z] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| View::corner().seen(&e));
        assert!(x[0] > 0.0 && y[1] > 0.0 && x[2] > 0.0 && y[2] > 0.0 && z[2] > 0.0);
        assert_eq!(View::against(Vector3::zeros()), View::corner());
    }
}
