//! The contact points of a model: their frames, gaps and slips; not the law that holds there.

use crate::error::ModelError;
use crate::model::motion_row::RelativeMotionRow;
use crate::vector::subspace::Subspace;
use moreau_contact::{Obstacle, arc, frame};
use moreau_laws::{Friction, Local, Status};
use moreau_mesh::{NodeKind, nearest};
use nalgebra::{Rotation3, SMatrix, SVector, UnitQuaternion, Vector3};

/// A rigid tool.
pub(crate) struct Tool<const D: usize> {
    pub(crate) name: String,
    pub(crate) obstacle: Box<dyn Obstacle<D>>,
    /// [`Obstacle::parts`], each of which has contact points of its own.
    pub(crate) parts: Vec<Box<dyn Obstacle<D>>>,
    /// What it turns about, where it was first \[mm\].
    pub(crate) reference: SVector<f64, D>,
}

/// How far a tool has turned: a vector along the axis, as long as the angle \[rad\]. In the plane its third
/// component counts, counter-clockwise.
pub(crate) type Turn = Vector3<f64>;

/// The rotation of a turn.
fn rotation<const D: usize>(turn: &Turn) -> SMatrix<f64, D, D> {
    let all = Rotation3::new(*turn).into_inner();
    SMatrix::from_fn(|i, j| all[(i, j)])
}

impl<const D: usize> Tool<D> {
    /// What a contact point may touch of it.
    pub(crate) fn opposite(&self, point: &ContactPoint<D>) -> &dyn Obstacle<D> {
        let part = self.parts.get(point.part);
        part.map_or(self.obstacle.as_ref(), |part| part.as_ref())
    }

    /// A place that has moved with the tool, but not turned, once that has turned: x_r + R (x − x_r).
    pub(crate) fn turned(&self, x: SVector<f64, D>, turn: &Turn) -> SVector<f64, D> {
        self.reference + turned(x - self.reference, turn)
    }

    /// A place relative to where the tool has moved, as the tool sees it: x_r + Rᵀ (x − x_r).
    pub(crate) fn seen(&self, x: SVector<f64, D>, turn: &Turn) -> SVector<f64, D> {
        match turn.norm() > 0.0 {
            true => self.turned(x, &-turn),
            false => x,
        }
    }
}

/// A vector of the plane or of space, in space.
pub(crate) fn in_space<const D: usize>(v: &SVector<f64, D>) -> Vector3<f64> {
    Vector3::from_fn(|i, _| if i < D { v[i] } else { 0.0 })
}

/// R v.
pub(crate) fn turned<const D: usize>(v: SVector<f64, D>, turn: &Turn) -> SVector<f64, D> {
    match turn.norm() > 0.0 {
        true => rotation::<D>(turn) * v,
        false => v,
    }
}

/// The turn that leads from one to another, R_after R_beforeᵀ: about one axis their difference.
pub(crate) fn turn_between(before: &Turn, after: &Turn) -> Turn {
    let difference = after - before;
    if before.cross(after).norm() <= PARALLEL * before.norm() * after.norm() {
        return difference;
    }
    let [before, after] = [before, after].map(|t| UnitQuaternion::from_scaled_axis(*t));
    (after * before.inverse()).scaled_axis()
}

/// Index of a tool by its name.
pub(crate) fn tool_index<const D: usize>(
    tools: &[Tool<D>],
    name: &str,
) -> Result<usize, ModelError> {
    let names = || tools.iter().map(|t| t.name.as_str());
    names()
        .position(|n| n == name)
        .ok_or_else(|| ModelError::UnknownTool {
            name: name.into(),
            nearest: nearest(name, names()).map(Into::into),
        })
}

/// A node that may touch what is opposite.
#[derive(Debug, Clone)]
pub(crate) struct ContactPoint<const D: usize> {
    pub(crate) node: usize,
    /// The tool opposite; `None` for the surface of a deformable body.
    pub(crate) tool: Option<usize>,
    /// Which part of the tool.
    pub(crate) part: usize,
    /// Index of the contact (surface and what is opposite) that it belongs to.
    pub(crate) contact: usize,
    /// Between tractions.
    pub(crate) law: Friction,
    /// The first tangent is along its projection on the surface, if it is given.
    pub(crate) axis: Option<SVector<f64, D>>,
    /// Distance to what is opposite at which it touches \[mm\]: the gap is the distance less this.
    pub(crate) offset: f64,
    /// Share of the surface \[mm²\], to turn a force into a traction.
    pub(crate) area: f64,
    pub(crate) kind: NodeKind,
    /// Nodes whose displacements, with these weights, are that of the point; they add up to 1.
    pub(crate) own: Vec<(usize, f64)>,
    /// What it is tied to, by weights of the undeformed bodies.
    pub(crate) tied: Option<RelativeMotionRow<D>>,
}

/// Sine of the angle between two axes that are one.
const PARALLEL: f64 = 1e-12;

/// Angle between normals that is rounding.
const ROUNDED: f64 = 1e-6;

/// Least cosine between normals of a tool over an edge that is one smooth surface there.
const SMOOTH: f64 = 0.9;

impl<const D: usize> ContactPoint<D> {
    /// Its gap on a tool, from the places of the nodes relative to that \[mm\].
    ///
    /// In a changed basis the gaps of the nodes have the weights that their displacements have, so that
    /// no node is inside a curved tool where the gaps of all points are zero: as far as the tool is one
    /// smooth surface over the edge. Beside its end, or where it is smaller, the gap is that at the point.
    pub(crate) fn gap(
        &self,
        obstacle: &dyn Obstacle<D>,
        x: impl Fn(usize) -> SVector<f64, D>,
    ) -> f64 {
        let at: SVector<f64, D> = self.own.iter().map(|&(a, w)| x(a) * w).sum();
        let here = obstacle.distance(&at);
        let n = obstacle.normal(&at);
        let mut weighted = 0.0;
        let far = self.own.iter().map(|&(a, _)| (x(a) - at).norm());
        let rounding = ROUNDED * ROUNDED * far.fold(0.0, f64::max);
        for &(a, w) in self.own.iter().filter(|_| self.own.len() > 1) {
            let (way, distance, m) = (x(a) - at, obstacle.distance(&x(a)), obstacle.normal(&x(a)));
            // A smooth surface is between its tangents at both ends.
            let off = distance - here - 0.5 * (n + m).dot(&way);
            let between = 0.25 * (n - m).norm().max(ROUNDED) * way.norm() + rounding;
            if n.dot(&m) < SMOOTH || off.abs() > between {
                return here - self.offset;
            }
            weighted += w * (distance - here);
        }
        here + weighted - self.offset
    }

    /// The way along a tool from one place to another, at the distance at which the point touches \[mm\]: that along the
    /// surface, and as much farther around as the normal turns.
    pub(crate) fn way(
        &self,
        obstacle: &dyn Obstacle<D>,
        from: &SVector<f64, D>,
        to: &SVector<f64, D>,
    ) -> SVector<f64, D> {
        let turn = arc(&obstacle.normal(from), &obstacle.normal(to));
        obstacle.way(from, to) + turn * self.offset
    }
}

/// A contact point at an instant: frame, gap and slip.
///
/// Where Dirichlet conditions hold components of the relative displacement, the law lives on the
/// free subspace F alone: n acts where it is free, the tangents are those in F, and the components
/// left over are switched off (zero slip, zero force).
#[derive(Debug, Clone)]
pub(crate) struct Kinematics<const D: usize> {
    /// Unit normal and tangents: for forces in space, and from relative displacements to gap and
    /// slip; zero where switched off.
    pub(crate) axes: SMatrix<f64, D, D>,
    /// Gap at the end of the step and slip of the step \[mm\], as the law sees them: a point that takes
    /// no part in it is open.
    pub(crate) u: Local<D>,
    /// Gap at the end of the step, negative inside of what is opposite, whether the law holds there or
    /// not \[mm\].
    pub(crate) gap: f64,
    /// Components that take part in the law.
    pub(crate) active: [bool; D],
    /// Whether the point is at a sharp corner of its tool.
    pub(crate) at_corner: bool,
    /// Slip of the step in space \[mm\] where conditions prescribe it along the whole surface and leave the point free
    /// across: friction against it acts on no unknown displacement, so that it can follow from the pressure.
    pub(crate) dragged: Option<SVector<f64, D>>,
    /// Length of the slip of the step \[mm\] where conditions and the surface prescribe a part of it which the free
    /// displacement of the point does not decide, zero elsewhere. All components take part in the law there; one of them
    /// follows from the others, see [`Suspended`](crate::linear::suspension::Suspended).
    pub(crate) known_slip: Option<f64>,
    /// ∂n/∂x of what is opposite, where forces turn with it \[1/mm\].
    pub(crate) curvature: SMatrix<f64, D, D>,
    /// The degree of freedom of the turn of a tool that a moment turns, and how the tool moves here with that.
    pub(crate) lever: Option<(usize, SVector<f64, D>)>,
    /// The law between them.
    pub(crate) law: Friction,
}

/// Below this length the projected normal is that of a wholly prescribed normal displacement.
const PRESCRIBED: f64 = 1e-9;

impl<const D: usize> Kinematics<D> {
    /// Of a point, from normal and gap at the end of the step, and the relative displacement of the
    /// step; of a tie that since the undeformed bodies.
    pub(crate) fn new(
        point: &ContactPoint<D>,
        n: &SVector<f64, D>,
        gap: f64,
        slip: &SVector<f64, D>,
        free: &Subspace<D>,
    ) -> Self {
        let projected = free.part(n);
        let length = projected.norm();
        let dimension = free.dimension();
        if point.law.is_tie() {
            return Self::tied(point.law, (n, projected), slip, free);
        }
        if dimension == 0 || length < PRESCRIBED {
            // Nothing left to decide, whatever the prescribed motion does.
            return Self::apart(point.law, gap);
        }
        let mut out = Self::apart(point.law, gap);
        out.u[0] = gap;
        let tangents = frame_along(n, point.axis.as_ref());
        let q = if dimension == D {
            tangents
        } else {
            frame_in(&(projected / length), free)
        };
        if let Friction::Anisotropic(law) = point.law
            && D == 3
            && dimension == 2
        {
            let left = q.column(1);
            out.law = law
                .along([1, 2].map(|k| left.dot(&tangents.column(k))))
                .into();
        }
        out.axes.set_column(0, n);
        out.dragged = (dimension == 1 && 1.0 - length < PRESCRIBED).then(|| slip - free.part(slip));
        for k in 0..dimension {
            let e = q.column(k);
            out.active[k] = true;
            if k > 0 {
                out.axes.set_column(k, &e);
                out.u[k] = e.dot(slip);
            }
        }
        out
    }

    /// With all components in the law, also those whose slip conditions prescribe: friction against it turns with all of
    /// the slip, and on an incline bears on what is free.
    pub(crate) fn with_known_slip(
        mut self,
        point: &ContactPoint<D>,
        slip: &SVector<f64, D>,
    ) -> Self {
        let n = self.axes.column(0).into_owned();
        // Along what is free, where the law has no directions of its own.
        let first = self.axes.column(1).into_owned();
        let along = match point.law {
            Friction::Anisotropic(_) => point.axis,
            _ => (first.norm() > 0.0).then_some(first),
        };
        self.law = point.law;
        self.axes = frame_along(&n, along.as_ref());
        self.active = [true; D];
        self.dragged = None;
        let tangential = self.axes.tr_mul(slip);
        (1..D).for_each(|j| self.u[j] = tangential[j]);
        self.known_slip = Some(tangential.rows(1, D - 1).norm());
        self
    }

    /// Of a tie: it holds along every free direction, also where the normal is none of them.
    fn tied(
        law: Friction,
        (n, projected): (&SVector<f64, D>, SVector<f64, D>),
        apart: &SVector<f64, D>,
        free: &Subspace<D>,
    ) -> Self {
        let mut out = Self::apart(law, 0.0);
        out.u = Local::zeros();
        let dimension = free.dimension();
        let along = projected.try_normalize(PRESCRIBED);
        let Some(first) = along.or_else(|| free.vectors().next()) else {
            return out;
        };
        let q = match dimension == D {
            true => frame(n),
            false => frame_in(&first, free),
        };
        // Without its normal a tie has tangents alone.
        let tangents = usize::from(along.is_none());
        for k in 0..dimension {
            let e = q.column(k);
            out.active[k + tangents] = true;
            out.axes.set_column(k + tangents, &e);
            out.u[k + tangents] = e.dot(apart);
        }
        out.gap = out.u[0];
        out
    }

    /// With the law between the forces on an area \[mm²\] instead of that between tractions: limits of
    /// the shear are those of what the point touches.
    pub(crate) fn between_forces(mut self, area: f64) -> Self {
        self.law = self.law.scaled(area);
        self
    }

    /// A point that takes no part in the law.
    pub(crate) fn apart(law: Friction, gap: f64) -> Self {
        let mut u = Local::zeros();
        u[0] = gap.abs() + f64::MIN_POSITIVE;
        Self {
            axes: SMatrix::zeros(),
            u,
            gap,
            active: [false; D],
            at_corner: false,
            dragged: None,
            known_slip: None,
            curvature: SMatrix::zeros(),
            lever: None,
            law,
        }
    }

    /// Friction on a point that conditions drag along the surface, under the pressure that was found: against its slip,
    /// and where that is rounding what there was before, as far as the pressure bears it. Its tangents take part then,
    /// with the status that is returned.
    pub(crate) fn drag(
        &mut self,
        axis: Option<&SVector<f64, D>>,
        t: &mut Local<D>,
        before: &SVector<f64, D>,
        rounding: f64,
    ) -> Option<Status> {
        let slip = self.dragged.filter(|_| t[0] > 0.0)?;
        let q = frame_along(&self.axes.column(0).into_owned(), axis);
        let along = |v: &SVector<f64, D>| {
            let mut tangential: Local<D> = q.tr_mul(v);
            tangential[0] = 0.0;
            tangential
        };
        let (u, before) = (along(&slip), along(before));
        // Of an ellipse between stretched vectors, where it is a circle.
        let (m, bound) = (self.law.stretch::<D>(), self.law.bound(t[0]));
        let held = before.component_div(&m);
        let (status, way, size) = match u.norm() > rounding {
            true => (Status::Slip, -u.component_mul(&m), bound),
            false => (Status::Stick, held, bound.min(held.norm())),
        };
        if size <= 0.0 {
            return None;
        }
        *t += (way * (size / way.norm())).component_mul(&m);
        for j in 1..D {
            self.axes.set_column(j, &q.column(j));
            self.active[j] = true;
            self.u[j] = u[j];
        }
        Some(status)
    }

    /// Force on the body in space, for a force t in the frame \[N\].
    pub(crate) fn force(&self, t: &Local<D>) -> SVector<f64, D> {
        self.axes * t
    }

    /// The entry of a component of the relative displacement at the turn of the tool.
    pub(crate) fn turning(&self, component: usize) -> Option<(usize, f64)> {
        let (dof, lever) = self.lever.as_ref()?;
        Some((*dof, -self.axes.column(component).dot(lever)))
    }

    /// A force in space, seen in the frame \[N\].
    pub(crate) fn local_force(&self, f: &SVector<f64, D>) -> Local<D> {
        self.axes.tr_mul(f)
    }
}

/// Normal and tangents, the first of these along the projection of an axis: without an axis, or with
/// one along the normal, they are those of [`frame`].
fn frame_along<const D: usize>(
    n: &SVector<f64, D>,
    axis: Option<&SVector<f64, D>>,
) -> SMatrix<f64, D, D> {
    let mut q = frame(n);
    let along = axis.map(|a| a - n * n.dot(a));
    if let Some(along) = along.filter(|v| D == 3 && v.norm() > ALONG_NORMAL) {
        let along = along.normalize();
        let across = SVector::from_fn(|i, _| {
            let (j, k) = ((i + 1) % D, (i + 2) % D);
            n[j] * along[k] - n[k] * along[j]
        });
        q.set_column(1, &along);
        q.set_column(2, &across);
    }
    q
}

/// Length of the projection of a unit axis on a surface below which it has no direction there.
pub(crate) const ALONG_NORMAL: f64 = 1e-3;

/// Orthonormal basis of the free subspace, first vector `e`.
fn frame_in<const D: usize>(e: &SVector<f64, D>, free: &Subspace<D>) -> SMatrix<f64, D, D> {
    let mut q = SMatrix::<f64, D, D>::zeros();
    q.set_column(0, e);
    let mut k = 1;
    let mut others: Vec<SVector<f64, D>> = free.vectors().collect();
    others.sort_by(|a, b| a.dot(e).abs().total_cmp(&b.dot(e).abs()));
    for mut v in others {
        for j in 0..k {
            let c = q.column(j).into_owned();
            v -= c * c.dot(&v);
        }
        if k < D && v.norm() > 1e-6 {
            q.set_column(k, &v.normalize());
            k += 1;
        }
    }
    q
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::directions::Directions;
    use moreau_contact::Ball;
    use moreau_laws::{AnisotropicCoulomb, Coulomb};

    /// The axes that are free.
    fn axes<const D: usize>(free: [bool; D]) -> Subspace<D> {
        Subspace::of_node(0, &Directions::default(), |dof| free[dof])
    }

    fn point<const D: usize>() -> ContactPoint<D> {
        ContactPoint {
            node: 0,
            tool: Some(0),
            part: 0,
            contact: 0,
            law: Coulomb::new(0.1).expect("a coefficient").into(),
            axis: None,
            offset: 0.0,
            area: 1.0,
            kind: NodeKind::Corner,
            own: vec![(0, 1.0)],
            tied: None,
        }
    }

    #[test]
    fn a_held_tangent_is_switched_off() {
        let n = SVector::<f64, 2>::new(0.0, 1.0);
        let k = Kinematics::new(
            &point(),
            &n,
            0.15,
            &SVector::<f64, 2>::new(0.0, -0.1),
            &axes([false, true]),
        );
        assert_eq!(k.active, [true, false]);
        assert_eq!(k.u, Local::<2>::new(0.15, 0.0));
        assert_eq!(k.axes, nalgebra::Matrix2::new(0.0, 0.0, 1.0, 0.0));
    }

    #[test]
    fn an_inclined_normal_acts_along_the_free_direction() {
        let (s, c) = 0.5f64.sin_cos();
        let n = SVector::<f64, 2>::new(-s, c);
        let d_u = SVector::<f64, 2>::new(0.0, 0.3);
        let k = Kinematics::new(&point(), &n, 0.3 * c, &d_u, &axes([false, true]));
        // Moving up by 0.3 opens the gap by 0.3 cos; the force n t_n does the same work.
        assert!((k.local_force(&d_u) - k.u).norm() < 1e-15);
        let t = Local::<2>::new(2.0, 0.0);
        assert!((k.force(&t).dot(&d_u) - t.dot(&k.u)).abs() < 1e-15);
    }

    #[test]
    fn one_held_axis_in_space_leaves_two_components() {
        let n = SVector::<f64, 3>::new(0.0, 1.0, 0.0);
        let slip = SVector::<f64, 3>::new(0.0, 0.0, 0.2);
        let k = Kinematics::new(&point(), &n, 0.0, &slip, &axes([false, true, true]));
        assert_eq!(k.active, [true, true, false]);
        assert!((k.u[1].abs() - 0.2).abs() < 1e-15 && k.u[2] == 0.0);
    }

    /// Three nodes of an edge on a cylinder have no gap, nor has the point of the mid-side; where a tool is
    /// smaller than the edge the gaps of the ends say nothing about it.
    #[test]
    fn gaps_have_the_weights_of_the_basis_where_a_tool_is_smooth() {
        let (corner, rest) = (-0.2 / 0.6, 1.0 / 0.6);
        let point = ContactPoint {
            own: vec![(0, rest), (1, corner), (2, corner)],
            ..point()
        };
        let x = [0.5, 0.0, 1.0];
        let large = Ball::new([0.0, -10.0], 10.0).expect("a ball");
        let on_it = |a: usize| SVector::from([x[a], f64::sqrt(100.0 - x[a] * x[a]) - 10.0]);
        assert!(point.gap(&large, on_it).abs() < 1e-14);
        // Whatever the rounding: the mid-side is on the normal of its point.
        for k in 0..360 {
            let turn = nalgebra::Rotation2::new(f64::from(k).to_radians());
            let center = SVector::from([0.3, -0.7]);
            let turned = |x: f64| center + turn * SVector::from([x, f64::sqrt(100.0 - x * x)]);
            let ball = Ball::new(center.into(), 10.0).expect("a ball");
            let gap = point.gap(&ball, |a| turned([0.0, -1.0, 1.0][a]));
            assert!(gap.abs() < 1e-13, "{k}: {gap}");
        }
        // A straight side beside a ball that it does not touch, turned and elsewhere.
        for k in 0..360 {
            let turn = nalgebra::Rotation2::new(f64::from(k).to_radians());
            let center = turn * SVector::from([0.0, -10.3]);
            let ball = Ball::new(center.into(), 10.0).expect("a ball");
            let gap = point.gap(&ball, |a| turn * SVector::from([[0.0, -1.0, 1.0][a], 0.0]));
            let expected = (5.0 * 0.3 - 2.0 * (10.3f64.hypot(1.0) - 10.0)) / 3.0;
            assert!((gap - expected).abs() < 1e-13, "{k}: {gap}");
        }
        let small = Ball::new([0.5, -0.3], 0.3).expect("a ball");
        assert!(point.gap(&small, |a| SVector::from([x[a], 0.0])).abs() < 1e-15);
    }

    /// The first coefficient along the axis on an inclined surface; along the one tangent that a plane
    /// of symmetry leaves, what the ellipse has there.
    #[test]
    fn coefficients_follow_their_axis() {
        let law = AnisotropicCoulomb::new(0.1, 0.4).expect("coefficients");
        let axis = SVector::<f64, 3>::new(1.0, 0.0, 1.0).normalize();
        let point = ContactPoint {
            law: law.into(),
            axis: Some(axis),
            ..point()
        };
        let n = SVector::<f64, 3>::new(0.0, 0.6, 0.8);
        let k = Kinematics::new(&point, &n, 0.0, &SVector::zeros(), &axes([true; 3]));
        let q = k.axes;
        assert!((q.transpose() * q - SMatrix::identity()).norm() < 1e-14);
        assert!((q.determinant() - 1.0).abs() < 1e-14);
        let projected = axis - n * n.dot(&axis);
        assert!((q.column(1) - projected.normalize()).norm() < 1e-14);
        assert_eq!(k.law, law.into());

        // 1/√((cos 30°/0.1)² + (sin 30°/0.4)²) = 4/35.
        let floor = SVector::<f64, 3>::new(0.0, 0.0, 1.0);
        for (degrees, expected) in [(0.0f64, 0.1), (90.0, 0.4), (30.0, 4.0 / 35.0)] {
            let (s, c) = degrees.to_radians().sin_cos();
            let point = ContactPoint {
                axis: Some(SVector::<f64, 3>::new(c, s, 0.0)),
                ..point.clone()
            };
            let held_across = axes([true, false, true]);
            let k = Kinematics::new(&point, &floor, 0.0, &SVector::zeros(), &held_across);
            assert!(
                (k.law.coefficient() - expected).abs() < 1e-14,
                "{:?}",
                k.law
            );
            assert_eq!(k.active, [true, true, false]);
        }
    }
}
