//! Sharp corners of tools that contact points are at; not how they are solved for.

use crate::driver::Driver;
use crate::model::points::{ContactPoint, Kinematics, Turn, turned};
use crate::vector::subspace::Subspace;
use moreau_contact::{Corner, Obstacle};
use moreau_laws::Local;
use nalgebra::SVector;

/// How far sideways of a sharp corner a point may be to be at it, over the size of the mesh: what
/// decides between its two faces is then rounding, and not the model.
const AHEAD: f64 = 1e-6;

/// Part of that to which the place is found where a way meets a tool.
const MEETS: f64 = 0.1;

/// Steps to that place: a way that meets a tool at 80 degrees to its normal takes as many.
const STEPS: usize = 64;

/// Part of the largest shear from which on a force is at the edge of its cone, and the point slides off.
const EDGE: f64 = 1.0 - 1e-6;

impl<const D: usize> Driver<D> {
    /// At the start of an increment: the corners that points touch.
    pub(crate) fn begin_corners(&mut self) {
        let within = AHEAD * self.mesh.size();
        let touched = |(p, row)| {
            let (p, x): (&ContactPoint<D>, _) = (p, self.seen(p, row));
            let obstacle = self.tools[p.tool?].opposite(p);
            let touches = obstacle.distance(&x) - p.offset <= within;
            touches.then(|| obstacle.corner(&x, within)).flatten()
        };
        self.corners = (self.points.iter().zip(&self.footing.rows))
            .map(touched)
            .collect();
    }

    /// Points under these forces leave their corners: those that open and those that slide up a face.
    pub(crate) fn leave_corners(&mut self, force: &[Local<D>]) {
        let points = self.points.iter().zip(force);
        for (at, (p, t)) in self.corners.iter_mut().zip(points) {
            let stays = |corner: &mut Corner<D>| {
                let most = p.law.at_corner(corner.half_angle).bound(t[0]);
                t[0] > 0.0 && t.rows(1, D - 1).norm() < EDGE * most
            };
            at.take_if(|corner| !stays(corner));
        }
    }

    /// The corner of its tool that a point is at, which the tool has seen at a place and sees at x now: one that it is
    /// straight ahead of or behind; one that it touched and has not left, wherever a tool that moves first is beside the
    /// point; one that its way from there leads into.
    pub(crate) fn corner(
        &self,
        i: usize,
        obstacle: &dyn Obstacle<D>,
        (from, x): (&SVector<f64, D>, &SVector<f64, D>),
    ) -> Option<Corner<D>> {
        let within = AHEAD * self.mesh.size();
        let at = |x: &SVector<f64, D>| obstacle.corner(x, within);
        at(x).or(self.corners[i]).or_else(|| {
            let (gap, way) = (
                |x: &SVector<f64, D>| obstacle.distance(x) - self.points[i].offset,
                x - from,
            );
            if gap(x) >= 0.0 || gap(from) <= within {
                return None;
            }
            let mut met = *from;
            for _ in 0..STEPS {
                let left = gap(&met);
                if left <= MEETS * within {
                    return at(&met);
                }
                met += way * (left / way.norm());
            }
            None
        })
    }
}

/// Of a point at a sharp corner of its tool, which sees it at x and has turned: any normal of the cone, as friction about its
/// axis that holds as far as the cone reaches. What it has slipped is how far it is from the corner.
pub(crate) fn at_corner<const D: usize>(
    p: &ContactPoint<D>,
    corner: &Corner<D>,
    (x, turn): (&SVector<f64, D>, &Turn),
    free: &Subspace<D>,
) -> Kinematics<D> {
    let off = x - corner.position;
    let gap = corner.axis.dot(&off) - p.offset;
    let law = p.law.at_corner(corner.half_angle);
    let blunt = ContactPoint { law, ..p.clone() };
    // Slip along an edge would carry the point across it, where friction against both were one.
    let across = corner.edge.map(|edge| {
        let edge = Subspace::spanned(&[turned(edge, turn)]);
        free.common(&edge.complement())
    });
    let axis = turned(corner.axis, turn);
    let free = across.as_ref().unwrap_or(free);
    Kinematics {
        at_corner: true,
        ..Kinematics::new(&blunt, &axis, gap, &turned(off, turn), free)
    }
}
