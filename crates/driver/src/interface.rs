//! The contact points of a model: their frames, gaps and slips; not the law that holds there.

use crate::system::{Condensed, System};
use moreau_contact::{ContactError, ContactProblem, Obstacle, frame};
use moreau_laws::{Coulomb, Local};
use moreau_mesh::NodeKind;
use nalgebra::{DMatrix, DVector, SMatrix, SVector};

/// A rigid tool.
pub(crate) struct Tool<const D: usize> {
    pub(crate) name: String,
    pub(crate) obstacle: Box<dyn Obstacle<D>>,
}

/// A node that may touch a tool.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactPoint<const D: usize> {
    pub(crate) node: usize,
    pub(crate) tool: usize,
    /// Index of the contact (surface and tool) that it belongs to.
    pub(crate) contact: usize,
    pub(crate) law: Coulomb,
    /// Distance to the tool at which it touches \[mm\]: the gap is the distance less this.
    pub(crate) offset: f64,
    /// Share of the surface \[mm²\], to turn a force into a traction.
    pub(crate) area: f64,
    pub(crate) kind: NodeKind,
}

/// A contact point at an instant: frame, gap and slip.
///
/// Where a Dirichlet condition holds components of the node's displacement, the law lives on the
/// free subspace F alone: n is replaced by its projection on F, the tangents are those in F, and
/// the components left over are switched off (zero slip, zero force).
#[derive(Debug, Clone)]
pub(crate) struct Kinematics<const D: usize> {
    /// Rows: u = B v, from the node's displacement v to gap and slip; zero where switched off.
    pub(crate) to_local: SMatrix<f64, D, D>,
    /// v = M u, the inverse on the free subspace.
    to_node: SMatrix<f64, D, D>,
    /// Unit normal and tangents, for forces in space.
    axes: SMatrix<f64, D, D>,
    /// Gap at the end of the step and slip of the step \[mm\].
    pub(crate) u: Local<D>,
    /// Components that take part in the law.
    pub(crate) active: [bool; D],
}

/// Below this length the projected normal is that of a wholly prescribed normal displacement.
const PRESCRIBED: f64 = 1e-9;

impl<const D: usize> Kinematics<D> {
    /// From the tool and the distance at which the node touches it, the node's position at the
    /// start of the step, its displacement increment, and the tool's position at both ends of the
    /// step.
    pub(crate) fn new(
        (obstacle, offset): (&dyn Obstacle<D>, f64),
        start: &SVector<f64, D>,
        d_u: &SVector<f64, D>,
        tool: (&SVector<f64, D>, &SVector<f64, D>),
        free: [bool; D],
    ) -> Self {
        let relative = start + d_u - tool.1;
        let n = obstacle.normal(&relative);
        let gap = obstacle.distance(&relative) - offset;
        let slip = d_u - (tool.1 - tool.0);
        let mut projected = n;
        for i in 0..D {
            if !free[i] {
                projected[i] = 0.0;
            }
        }
        let length = projected.norm();
        let dimension = free.iter().filter(|f| **f).count();
        let mut out = Self {
            to_local: SMatrix::zeros(),
            to_node: SMatrix::zeros(),
            axes: SMatrix::zeros(),
            u: Local::zeros(),
            active: [false; D],
        };
        out.u[0] = gap;
        if dimension == 0 || length < PRESCRIBED {
            // Nothing left to decide: an open gap whatever the prescribed motion does.
            out.u[0] = gap.abs() + f64::MIN_POSITIVE;
            return out;
        }
        let q = if dimension == D {
            frame(&n)
        } else {
            frame_in(&(projected / length), free)
        };
        out.axes.set_column(0, &n);
        for k in 0..dimension {
            let e = q.column(k);
            let scale = if k == 0 { length } else { 1.0 };
            out.active[k] = true;
            out.to_local.set_row(k, &(e.transpose() * scale));
            out.to_node.set_column(k, &(e / scale));
            if k > 0 {
                out.axes.set_column(k, &e);
                out.u[k] = e.dot(&slip);
            }
        }
        out
    }

    /// Force on the body in space, for a force t in the frame \[N\].
    pub(crate) fn force(&self, t: &Local<D>) -> SVector<f64, D> {
        self.axes * t
    }

    /// A force in space, seen in the frame \[N\].
    pub(crate) fn local_force(&self, f: &SVector<f64, D>) -> Local<D> {
        self.axes.tr_mul(f)
    }
}

/// Orthonormal basis of the free coordinate subspace, first vector `e`.
fn frame_in<const D: usize>(e: &SVector<f64, D>, free: [bool; D]) -> SMatrix<f64, D, D> {
    let mut q = SMatrix::<f64, D, D>::zeros();
    q.set_column(0, e);
    let mut k = 1;
    let mut axes: Vec<usize> = (0..D).filter(|&i| free[i]).collect();
    axes.sort_by(|&a, &b| e[a].abs().total_cmp(&e[b].abs()));
    for i in axes {
        let mut v = SVector::<f64, D>::zeros();
        v[i] = 1.0;
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

/// The contact problem of a linearised increment, and the way back to the interface unknowns.
pub(crate) struct Condensation<const D: usize> {
    pub(crate) problem: ContactProblem<D>,
    places: Vec<Place<D>>,
    now: Vec<Local<D>>,
    unknowns: usize,
}

/// Where a contact point is among the interface unknowns.
struct Place<const D: usize> {
    /// Interface unknown of every free component of the node; the first `count` are used.
    rows: [usize; D],
    count: usize,
    /// Rows of M for these components: x = M (u − u_now).
    to_node: SMatrix<f64, D, D>,
}

impl<const D: usize> Place<D> {
    fn new(system: &System, node: usize, kinematics: &Kinematics<D>) -> Self {
        let mut place = Self {
            rows: [0; D],
            count: 0,
            to_node: SMatrix::zeros(),
        };
        for i in 0..D {
            if let Some(row) = system.interface_index(D * node + i) {
                place.rows[place.count] = row;
                let from = kinematics.to_node.row(i);
                place.to_node.set_row(place.count, &from);
                place.count += 1;
            }
        }
        place
    }
}

impl<const D: usize> Condensation<D> {
    /// Turns the condensed system into the local frames of the contacts: S ← Mᵀ S M, f ← Mᵀ f.
    pub(crate) fn new(
        system: &System,
        condensed: &Condensed,
        points: &[ContactPoint<D>],
        kinematics: &[Kinematics<D>],
        previous: Vec<Local<D>>,
    ) -> Result<Self, ContactError> {
        let size = D * points.len();
        let places: Vec<Place<D>> = points
            .iter()
            .zip(kinematics)
            .map(|(point, k)| Place::new(system, point.node, k))
            .collect();
        let mut stiffness = DMatrix::zeros(size, size);
        let mut load = DVector::zeros(size);
        for (d, right) in places.iter().enumerate() {
            for (c, left) in places.iter().enumerate().skip(d) {
                let mut block = SMatrix::<f64, D, D>::zeros();
                for a in 0..left.count {
                    for b in 0..right.count {
                        block[(a, b)] = condensed.stiffness[(left.rows[a], right.rows[b])];
                    }
                }
                let local = left.to_node.tr_mul(&(block * right.to_node));
                stiffness
                    .fixed_view_mut::<D, D>(D * c, D * d)
                    .copy_from(&local);
                stiffness
                    .fixed_view_mut::<D, D>(D * d, D * c)
                    .copy_from(&local.transpose());
            }
            let own = Local::<D>::from_fn(|a, _| match a < right.count {
                true => condensed.load[right.rows[a]],
                false => 0.0,
            });
            load.fixed_rows_mut::<D>(D * d)
                .copy_from(&right.to_node.tr_mul(&own));
        }
        // Components switched off: alone on their diagonal, of the size of their neighbours.
        let typical = stiffness.diagonal().amax().max(f64::MIN_POSITIVE);
        for (c, k) in kinematics.iter().enumerate() {
            for j in 0..D {
                if !k.active[j] {
                    stiffness[(D * c + j, D * c + j)] = typical;
                }
            }
        }
        let now: Vec<Local<D>> = kinematics.iter().map(|k| k.u).collect();
        let laws = points.iter().map(|p| p.law).collect();
        let problem = ContactProblem::new(stiffness, load, now.clone(), laws, previous)?;
        let unknowns = condensed.load.len();
        Ok(Self {
            problem,
            places,
            now,
            unknowns,
        })
    }

    /// Interface displacements x for gaps and slips u.
    pub(crate) fn interface(&self, u: &[Local<D>]) -> DVector<f64> {
        let mut x = DVector::zeros(self.unknowns);
        for ((place, u), now) in self.places.iter().zip(u).zip(&self.now) {
            let motion = place.to_node * (u - now);
            for a in 0..place.count {
                x[place.rows[a]] = motion[a];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_contact::Plane;

    #[test]
    fn a_held_tangent_is_switched_off() {
        let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
        let zero = SVector::<f64, 2>::zeros();
        let start = SVector::<f64, 2>::new(0.0, 0.25);
        let d_u = SVector::<f64, 2>::new(0.0, -0.1);
        let k = Kinematics::new((&floor, 0.0), &start, &d_u, (&zero, &zero), [false, true]);
        assert_eq!(k.active, [true, false]);
        assert!((k.u - Local::<2>::new(0.15, 0.0)).norm() < 1e-15);
        let product = k.to_local * k.to_node;
        assert_eq!(product, nalgebra::Matrix2::new(1.0, 0.0, 0.0, 0.0));
    }

    #[test]
    fn an_inclined_normal_acts_along_the_free_direction() {
        let (s, c) = 0.5f64.sin_cos();
        let slope = Plane::new([0.0, 0.0], [-s, c]).expect("valid");
        let zero = SVector::<f64, 2>::zeros();
        let d_u = SVector::<f64, 2>::new(0.0, 0.3);
        let k = Kinematics::new((&slope, 0.0), &zero, &d_u, (&zero, &zero), [false, true]);
        // Moving up by 0.3 opens the gap by 0.3 cos; the force n t_n does the same work.
        assert!((k.u[0] - 0.3 * c).abs() < 1e-15);
        assert!((k.to_local * d_u - k.u).norm() < 1e-15);
        let t = Local::<2>::new(2.0, 0.0);
        assert!((k.force(&t).dot(&d_u) - t.dot(&k.u)).abs() < 1e-15);
    }

    #[test]
    fn slip_is_measured_against_a_moving_tool() {
        let floor = Plane::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]).expect("valid");
        let zero = SVector::<f64, 3>::zeros();
        let tool = SVector::<f64, 3>::new(0.5, 0.1, 0.0);
        let d_u = SVector::<f64, 3>::new(0.5, 0.1, 0.0);
        let k = Kinematics::new((&floor, 0.0), &zero, &d_u, (&zero, &tool), [true; 3]);
        assert!(k.u.norm() < 1e-15, "carried along: {}", k.u);
    }

    #[test]
    fn one_held_axis_in_space_leaves_two_components() {
        let floor = Plane::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]).expect("valid");
        let zero = SVector::<f64, 3>::zeros();
        let d_u = SVector::<f64, 3>::new(0.0, 0.0, 0.2);
        let k = Kinematics::new(
            (&floor, 0.0),
            &zero,
            &d_u,
            (&zero, &zero),
            [false, true, true],
        );
        assert_eq!(k.active, [true, true, false]);
        assert!((k.u[1].abs() - 0.2).abs() < 1e-15 && k.u[2] == 0.0);
    }
}
