//! Frames, gaps, slips and forces of the contact points at an iterate; not how it is found.

use crate::driver::Driver;
use crate::interface::corners::at_corner;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics, Turn, in_space, turned};
use crate::vector::SparseVector;
use crate::vector::subspace::Subspace;
use moreau_laws::{Friction, Local};
use nalgebra::{SMatrix, SVector};

/// Slip that is rounding, over the size of the mesh.
pub(crate) const NO_SLIP: f64 = 1e-11;

/// Part of a force that is rounding.
const NO_FORCE: f64 = 1e-9;

impl<const D: usize> Driver<D> {
    /// Where a tool is at the end of an increment: as it is told, or moved by what it was driven to.
    fn tool_position(&self, tool: usize, end: &Loading<D>, d_u: &[f64]) -> SVector<f64, D> {
        SVector::from_fn(|i, _| {
            let dof = D * self.tool_node(tool) + i;
            let moved = self.state.displacement[dof] + d_u[dof];
            end.displacement.get(&dof).copied().unwrap_or(moved)
        })
    }

    /// How far a tool has turned at the end of an increment: as it is told, or as a moment has turned it.
    pub(crate) fn turn_at(&self, tool: usize, end: &Loading<D>, d_u: &[f64]) -> Turn {
        let Some(axle) = end.axle_of(tool) else {
            return end.turn_of(tool);
        };
        let angle = d_u[self.turn_dof(tool)] / self.mesh.size();
        self.state.loading.turn_of(tool) + axle * angle
    }

    /// Whether slips are ways along tools, and not displacements beside them: those of tools that are turned, at the start
    /// of an increment or at its end.
    fn follows(&self, turn: &Turn, end: &Loading<D>, tool: usize) -> bool {
        let is_turned = |turn: &Turn| turn.norm() > 0.0;
        self.has_large_strains()
            || is_turned(turn)
            || is_turned(&self.state.loading.turn_of(tool))
            || end.axle_of(tool).is_some()
    }

    /// The degree of freedom of the turn of a tool that a moment turns, and how a point of it moves with that: a place
    /// relative to where the tool has moved.
    fn lever(
        &self,
        tool: usize,
        end: &Loading<D>,
        x: &SVector<f64, D>,
    ) -> Option<(usize, SVector<f64, D>)> {
        let axle = end.axle_of(tool)?;
        let arm = in_space(&(x - self.tools[tool].reference)) / self.mesh.size();
        let way = axle.cross(&arm);
        Some((self.turn_dof(tool), SVector::from_fn(|i, _| way[i])))
    }

    /// Where a contact point is at the start of an increment, relative to where its tool has moved.
    pub(crate) fn place(&self, motion_row: &RelativeMotionRow<D>) -> SVector<f64, D> {
        let nodes = self.mesh.nodes().len();
        motion_row.relative(|a| match a < nodes {
            true => self.position(a),
            false => self.displacement(a),
        })
    }

    /// Where its tool sees a contact point at the start of an increment.
    pub(crate) fn seen(
        &self,
        point: &ContactPoint<D>,
        motion_row: &RelativeMotionRow<D>,
    ) -> SVector<f64, D> {
        let x = self.place(motion_row);
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
        let at = |(i, (p, motion_row)): (usize, (&ContactPoint<D>, &RelativeMotionRow<D>))| {
            let free = &motion_row.free(p.node, |a| system.free_at(a));
            if p.law.is_tie() {
                // Of the undeformed bodies, not of the increment: nothing adds up.
                let apart = motion_row.relative(|a| self.displacement(a) + moved(a));
                return match motion_row.plane(&SVector::zeros()) {
                    Some((n, _)) => Kinematics::new(p, &n, 0.0, &apart, free),
                    None => Kinematics::apart(p.law, 0.0),
                };
            }
            let slip = motion_row.relative(moved);
            let Some(tool) = p.tool else {
                let since = motion_row.relative(|a| moved(a) - self.footing.moved(a));
                let kinematics = self.between_bodies(system, (i, p), motion_row, since, free);
                return kinematics.between_forces(self.grips[i].area(&p.law, motion_row.area));
            };
            let turn = self.turn_at(tool, end, d_u);
            let follows = self.follows(&turn, end, tool);
            let (number, at) = (tool, self.tool_position(tool, end, d_u));
            let tool = &self.tools[tool];
            let obstacle = tool.opposite(p);
            let now = |a: usize| match a < self.mesh.nodes().len() {
                true => self.position(a) + moved(a),
                false => at,
            };
            let place = motion_row.relative(now);
            let lever = self.lever(number, end, &place);
            let x = tool.seen(place, &turn);
            let from = self.seen(p, motion_row);
            let slip = match follows {
                true => turned(p.way(obstacle, &from, &x), &turn),
                false => slip,
            };
            let Some(corner) = self.corner(i, obstacle, (&from, &x)) else {
                let gap = p.gap(obstacle, |a| tool.seen(now(a) - at, &turn));
                let n = turned(obstacle.normal(&x), &turn);
                let mut kinematics = Kinematics::new(p, &n, gap, &slip, free);
                if lever.is_none() && self.is_dragged(i, &kinematics, &slip, free) {
                    kinematics = kinematics.with_known_slip(p, &slip);
                }
                kinematics.lever = lever;
                if self.has_large_strains() {
                    let axes = [0, 1, 2].map(|k| {
                        let e = SVector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
                        turned(obstacle.curvature(&x) * turned(e, &-turn), &turn)
                    });
                    kinematics.curvature = SMatrix::from_fn(|i, j| axes[j][i]);
                }
                return kinematics.between_forces(self.grips[i].area(&p.law, motion_row.area));
            };
            let mut kinematics = at_corner(p, &corner, (&x, &turn), free);
            kinematics.lever = lever;
            kinematics
        };
        let points = self.points.iter().zip(&self.footing.rows);
        let mut all: Vec<_> = points.enumerate().map(at).collect();
        self.stop_once(|a| system.free_at(a), &mut all);
        for (k, motion_row) in all.iter_mut().zip(&self.footing.rows) {
            // Neither the cone of a corner nor a tool that feels its friction turn it.
            let decided = k.at_corner || k.lever.is_some();
            let alone = |n: &SVector<f64, D>| {
                let mut nodes = motion_row.weights();
                nodes.all(|(a, _)| system.free_at(a).is_along(n))
            };
            let n = k.axes.column(0).into_owned();
            k.dragged = k.dragged.filter(|_| !decided && alone(&n));
        }
        all
    }

    /// Of a contact point between two bodies, after a relative displacement since they were paired.
    fn between_bodies(
        &self,
        system: &System,
        (i, p): (usize, &ContactPoint<D>),
        motion_row: &RelativeMotionRow<D>,
        since: SVector<f64, D>,
        free: &Subspace<D>,
    ) -> Kinematics<D> {
        // Opposite to nothing: as far away as anything can be.
        let Some((n, gap)) = motion_row.plane(&since) else {
            return Kinematics::apart(p.law, self.mesh.size());
        };
        let slip = motion_row.slipped.map_or(since, |before| before + since);
        let kinematics = Kinematics::new(p, &n, gap - p.offset, &slip, free);
        // Nodes that are not held decide of the slip.
        let mut nodes = motion_row.nodes().into_iter();
        let known = nodes.all(|a| system.free_at(a).is_within(free))
            && self.is_dragged(i, &kinematics, &slip, free);
        match known {
            true => kinematics.with_known_slip(p, &slip),
            false => kinematics,
        }
    }

    /// Whether friction acts along what conditions prescribe of a slip while the point is free across the surface or
    /// along an incline: against a slip there, or because there was some before.
    fn is_dragged(
        &self,
        contact: usize,
        kinematics: &Kinematics<D>,
        slip: &SVector<f64, D>,
        free: &Subspace<D>,
    ) -> bool {
        let decided = kinematics.dragged.is_some() || free.dimension() == D;
        if decided || !kinematics.active[0] || !kinematics.law.resists_slip() {
            return false;
        }
        let prescribed = (slip - free.part(slip)).norm();
        let before = &self.state.contacts[contact];
        let beside = match kinematics.law {
            Friction::Anisotropic(_) => {
                let within = kinematics.force(&kinematics.local_force(&before.force));
                (before.force - within).norm()
            }
            _ => {
                let left = (1..D).filter(|&j| !kinematics.active[j]);
                left.map(|j| before.t[j].abs()).fold(0.0, f64::max)
            }
        };
        prescribed > NO_SLIP * self.mesh.size() || beside > NO_FORCE * before.force.norm()
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
            if let Some((dof, lever)) = &k.lever {
                forces.add(*dof, -lever.dot(&f));
            }
        }
        forces
    }
}
