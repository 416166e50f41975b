//! Tools driven by a force that touch nothing yet: how far they are, and where their force takes
//! them, which is where an increment begins; not what stops them.

use crate::driver::Driver;
use crate::error::{ModelError, ToolOutOfContact};
use crate::model::load::Loading;
use crate::model::points::in_space;
use nalgebra::SVector;

/// Gaps below this part of the size of the mesh are closed.
const CLOSED: f64 = 1e-9;
/// How near a tool on its way must come to touch, in parts of the size of the mesh.
const TOUCHING: f64 = 1e-6;
/// How far its way is followed, in sizes of the mesh beyond the first gap.
const FARTHEST: f64 = 10.0;
/// Part of the largest shear of all contacts, and of their moments, each taken positive, that is nearly all.
const NEARLY: f64 = 0.95;
/// After so many looks it passes along the body, not towards it.
const LOOKS: usize = 10_000;

impl<const D: usize> Driver<D> {
    /// The least gap of the points that a tool may touch, after a further motion of it, with the point;
    /// `None` if there are none.
    fn tool_gap(&self, tool: usize, motion: &SVector<f64, D>) -> Option<(f64, usize)> {
        let at = self.displacement(self.tool_node(tool)) + motion;
        let (body, turn) = (&self.tools[tool], self.state.loading.turn_of(tool));
        let seen = |a: usize| body.seen(self.position(a) - at, &turn);
        let points = self.points.iter().enumerate();
        let gaps = points
            .filter(|(_, p)| p.tool == Some(tool))
            .map(|(k, p)| (p.gap(body.opposite(p), seen), k));
        gaps.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The displacement increments that may be repeated: those that are about to be committed, less
    /// what a driven tool has moved to close its gap.
    pub(crate) fn repeatable(&self, mut d_u: Vec<f64>, end: &Loading<D>) -> Vec<f64> {
        for tool in 0..self.tools.len() {
            let first = D * self.tool_node(tool);
            let driven = (first..first + D).filter(|dof| !end.displacement.contains_key(dof));
            let driven: Vec<usize> = driven.collect();
            let moved = driven.iter().fold(0.0f64, |m, &dof| m.hypot(d_u[dof]));
            if moved == 0.0 {
                continue;
            }
            let gap = self.tool_gap(tool, &SVector::zeros()).map_or(0.0, |g| g.0);
            if gap > CLOSED * self.mesh.size() {
                let rest = (1.0 - gap / moved).max(0.0);
                driven.iter().for_each(|&dof| d_u[dof] *= rest);
            }
        }
        d_u
    }

    /// The first tool with a moment under a loading that normals of contacts alone would let spin, if there is one.
    pub(crate) fn spinning_tool(&self, end: &Loading<D>) -> Option<ModelError> {
        let spins = self.spun_by_normals(end);
        let moment = |&tool: &usize| end.force.at(self.turn_dof(tool)) * self.mesh.size();
        let tool = spins.into_iter().find(|tool| moment(tool) != 0.0)?;
        let rest = vec![0.0; self.state.displacement.len()];
        let carried = self.moment(tool, &rest, &self.state.contacts);
        Some(ModelError::SpinningTool {
            tool: self.tools[tool].name.clone(),
            moment: moment(&tool),
            carried: carried.dot(&end.axle_of(tool)?),
        })
    }

    /// The first tool that nothing prescribes the turn of, and that friction alone holds against a moment which is nearly all
    /// that it carries: what touches the tool turns it the same way, by almost as much shear as its pressure allows.
    pub(crate) fn slipping_tool(&self, end: &Loading<D>) -> Option<ModelError> {
        let rest = vec![0.0; self.state.displacement.len()];
        let carried = |tool: usize| {
            let axle = end.axle_of(tool)?;
            let (mut sum, mut all, mut shear, mut bound) = (0.0, 0.0, 0.0, 0.0);
            let pairs = self.points.iter().zip(&self.state.contacts);
            for (point, contact) in pairs.filter(|(p, c)| p.tool == Some(tool) && c.t[0] > 0.0) {
                let arm = self.arm(tool, point, &rest);
                let moment = arm.cross(&in_space(&contact.force)).dot(&axle);
                sum += moment;
                all += moment.abs();
                shear += contact.t.rows(1, D - 1).norm();
                bound += point.law.bound(contact.t[0]);
            }
            (all > 0.0 && sum.abs() >= NEARLY * all && shear >= NEARLY * bound).then_some(sum)
        };
        let mut tools = self.spun_by_normals(end).into_iter();
        let (tool, carried) = tools.find_map(|tool| Some((tool, carried(tool)?)))?;
        Some(ModelError::SlippingTool {
            tool: self.tools[tool].name.clone(),
            moment: end.force.at(self.turn_dof(tool)) * self.mesh.size(),
            carried,
        })
    }

    /// How far a tool with a force under a loading is from what it may touch, with the point that is nearest, and the
    /// motion along its force with which it meets it, if it does; `None` if it touches or has no force.
    fn way_to_contact(
        &self,
        tool: usize,
        end: &Loading<D>,
    ) -> Option<(f64, usize, Option<SVector<f64, D>>)> {
        let touching = TOUCHING * self.mesh.size();
        let force = SVector::from(end.force.at_node::<D>(self.tool_node(tool)));
        let (gap, nearest) = self.tool_gap(tool, &SVector::zeros())?;
        if force.norm() == 0.0 || gap <= touching {
            return None;
        }
        // Nothing is nearer than the gap: going as far can pass nothing.
        let way = force.normalize();
        let (mut gone, mut left) = (gap, gap);
        for _ in 0..LOOKS {
            if left <= touching || gone >= FARTHEST * self.mesh.size() + gap {
                break;
            }
            left = self.tool_gap(tool, &(way * gone))?.0;
            gone += left.max(touching);
        }
        Some((gap, nearest, (left <= touching).then(|| way * gone)))
    }

    /// Moves tools that a force drives, that touch nothing and of whose motion nothing is guessed, to where they meet what they
    /// may touch; whether there are any.
    pub(crate) fn meet(&self, end: &Loading<D>, d_u: &mut [f64]) -> bool {
        let mut met = false;
        for tool in 0..self.tools.len() {
            let first = D * self.tool_node(tool);
            let driven = (first..first + D).filter(|dof| !end.displacement.contains_key(dof));
            let driven: Vec<usize> = driven.collect();
            if driven.iter().any(|&dof| d_u[dof] != 0.0) {
                continue;
            }
            let Some((_, _, Some(motion))) = self.way_to_contact(tool, end) else {
                continue;
            };
            met = true;
            driven
                .iter()
                .for_each(|&dof| d_u[dof] = motion[dof - first]);
        }
        met
    }

    /// The first tool with a force under a loading that touches nothing, if there is one.
    pub(crate) fn loose_tool(&self, end: &Loading<D>) -> Option<ModelError> {
        (0..self.tools.len()).find_map(|tool| {
            let (gap, nearest, meets) = self.way_to_contact(tool, end)?;
            let force = SVector::from(end.force.at_node::<D>(self.tool_node(tool)));
            let point = &self.points[nearest];
            Some(ModelError::ToolOutOfContact(Box::new(ToolOutOfContact {
                tool: self.tools[tool].name.clone(),
                force: force.iter().copied().collect(),
                surface: self.contact_name(point.contact).0.to_owned(),
                position: self.position(point.node).iter().copied().collect(),
                gap,
                meets: meets.map(|motion| motion.iter().copied().collect()),
            })))
        })
    }
}
