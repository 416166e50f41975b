//! Frames, gaps, slips and forces of the contact points at an iterate; not how it is found.

use crate::driver::Driver;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::{ContactPoint, Kinematics, RelativeMotionRow};
use crate::vector::SparseVector;
use moreau_laws::Local;
use nalgebra::SVector;

/// How far sideways of a sharp corner a point may be to be at it, over the size of the mesh: what
/// decides between its two faces is then rounding, and not the model.
const AHEAD: f64 = 1e-6;

impl<const D: usize> Driver<D> {
    /// Where a tool is at the end of an increment: as it is told, or moved by what it was driven to.
    fn tool_position(&self, tool: usize, end: &Loading<D>, d_u: &[f64]) -> SVector<f64, D> {
        SVector::from_fn(|i, _| {
            let dof = D * self.tool_node(tool) + i;
            let moved = self.state.displacement[dof] + d_u[dof];
            end.displacement.get(&dof).copied().unwrap_or(moved)
        })
    }

    /// Frames, gaps and slips of the contact points.
    pub(crate) fn kinematics(
        &self,
        system: &System,
        end: &Loading<D>,
        d_u: &[f64],
    ) -> Vec<Kinematics<D>> {
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let size = self.mesh.size();
        let at = |(p, motion_row): (&ContactPoint<D>, &RelativeMotionRow<D>)| {
            let free = motion_row.free(p.node, |dof| system.is_free(dof));
            let slip = motion_row.relative(moved);
            let Some(tool) = p.tool else {
                let kinematics = match motion_row.plane(&slip) {
                    Some((n, gap)) => Kinematics::new(p, &n, gap - p.offset, &slip, free),
                    // Opposite to nothing: as far away as anything can be.
                    None => Kinematics::apart(p.law, size),
                };
                return kinematics.between_forces(motion_row.area);
            };
            let obstacle = &self.tools[tool].obstacle;
            let tool = self.tool_position(tool, end, d_u);
            let now = |a: usize| match a < self.mesh.nodes().len() {
                true => self.position(a) + moved(a),
                false => tool,
            };
            let x = motion_row.relative(now);
            let Some(corner) = obstacle.corner(&x, AHEAD * size) else {
                let gap = p.gap(obstacle.as_ref(), |a| now(a) - tool);
                let kinematics = Kinematics::new(p, &obstacle.normal(&x), gap, &slip, free);
                return kinematics.between_forces(motion_row.area);
            };
            // Any normal of the cone: friction about its axis that holds as far as the cone reaches.
            let gap = corner.axis.dot(&(x - corner.position)) - p.offset;
            let law = p.law.at_corner(corner.half_angle);
            let blunt = ContactPoint { law, ..p.clone() };
            let mut kinematics = Kinematics::new(&blunt, &corner.axis, gap, &slip, free);
            kinematics.at_corner = true;
            kinematics
        };
        let mut all: Vec<_> = self.points.iter().zip(&self.motion_rows).map(at).collect();
        self.stop_once(|dof| system.is_free(dof), &mut all);
        all
    }

    /// Contact forces t₀ at the start of the step, in the frames of now.
    pub(crate) fn previous_forces(&self, kinematics: &[Kinematics<D>]) -> Vec<Local<D>> {
        let pairs = kinematics.iter().zip(&self.state.contacts);
        pairs.map(|(k, c)| k.local_force(&c.force)).collect()
    }

    /// Contact forces at the degrees of freedom \[N\].
    pub(crate) fn contact_forces(
        &self,
        kinematics: &[Kinematics<D>],
        t: &[Local<D>],
    ) -> SparseVector {
        let mut forces = SparseVector::default();
        for ((motion_row, k), t) in self.motion_rows.iter().zip(kinematics).zip(t) {
            let f = k.force(t);
            for (a, w) in motion_row.weights() {
                for i in 0..D {
                    forces.add(D * a + i, w * f[i]);
                }
            }
        }
        forces
    }
}
