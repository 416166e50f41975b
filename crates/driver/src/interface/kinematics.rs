//! Frames, gaps, slips and forces of the contact points at an iterate; not how it is found.

use crate::driver::Driver;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics, Turn, turned};
use crate::vector::SparseVector;
use moreau_laws::Local;
use nalgebra::{SMatrix, SVector};

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

    /// Whether slips are ways along tools, and not displacements beside them.
    fn follows(&self, turn: &Turn) -> bool {
        self.has_large_strains() || turn.norm() > 0.0
    }

    /// Where its tool sees a contact point at the start of an increment.
    pub(crate) fn seen(
        &self,
        point: &ContactPoint<D>,
        motion_row: &RelativeMotionRow<D>,
    ) -> SVector<f64, D> {
        let nodes = self.mesh.nodes().len();
        let at = |a: usize| match a < nodes {
            true => self.position(a),
            false => self.displacement(a),
        };
        let x = motion_row.relative(at);
        match point.tool {
            Some(tool) => self.tools[tool].seen(x, &self.state.loading.turn_of(tool)),
            None => x,
        }
    }

    /// Frames, gaps and slips of the contact points after displacement increments. Between two bodies they are
    /// linear in these, from where the surfaces were paired.
    pub(crate) fn kinematics(
        &self,
        system: &System,
        end: &Loading<D>,
        d_u: &[f64],
    ) -> Vec<Kinematics<D>> {
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let size = self.mesh.size();
        let at = |(p, motion_row): (&ContactPoint<D>, &RelativeMotionRow<D>)| {
            let free = &motion_row.free(p.node, |a| system.free_at(a));
            let slip = motion_row.relative(moved);
            let Some(tool) = p.tool else {
                let since = motion_row.relative(|a| moved(a) - self.footing.moved(a));
                let kinematics = match motion_row.plane(&since) {
                    Some((n, gap)) => {
                        let slip = motion_row.slipped.map_or(since, |before| before + since);
                        Kinematics::new(p, &n, gap - p.offset, &slip, free)
                    }
                    // Opposite to nothing: as far away as anything can be.
                    None => Kinematics::apart(p.law, size),
                };
                return kinematics.between_forces(motion_row.area);
            };
            let turn = end.turn_of(tool);
            let (tool, at) = (&self.tools[tool], self.tool_position(tool, end, d_u));
            let obstacle = &tool.obstacle;
            let now = |a: usize| match a < self.mesh.nodes().len() {
                true => self.position(a) + moved(a),
                false => at,
            };
            let x = tool.seen(motion_row.relative(now), &turn);
            let slip = match self.follows(&turn) {
                true => turned(obstacle.way(&self.seen(p, motion_row), &x), &turn),
                false => slip,
            };
            let Some(corner) = obstacle.corner(&x, AHEAD * size) else {
                let gap = p.gap(obstacle.as_ref(), |a| tool.seen(now(a) - at, &turn));
                let n = turned(obstacle.normal(&x), &turn);
                let mut kinematics = Kinematics::new(p, &n, gap, &slip, free);
                if self.has_large_strains() {
                    let axes = [0, 1, 2].map(|k| {
                        let e = SVector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
                        turned(obstacle.curvature(&x) * turned(e, &-turn), &turn)
                    });
                    kinematics.curvature = SMatrix::from_fn(|i, j| axes[j][i]);
                }
                return kinematics.between_forces(motion_row.area);
            };
            // Any normal of the cone: friction about its axis that holds as far as the cone reaches.
            let gap = corner.axis.dot(&(x - corner.position)) - p.offset;
            let law = p.law.at_corner(corner.half_angle);
            let blunt = ContactPoint { law, ..p.clone() };
            let axis = turned(corner.axis, &turn);
            let mut kinematics = Kinematics::new(&blunt, &axis, gap, &slip, free);
            kinematics.at_corner = true;
            kinematics
        };
        let mut all: Vec<_> = self.points.iter().zip(&self.footing.rows).map(at).collect();
        self.stop_once(|a| system.free_at(a), &mut all);
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
        for ((motion_row, k), t) in self.footing.rows.iter().zip(kinematics).zip(t) {
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
