//! Slips that change their direction within an increment because a tool turns: friction acts against what they add up to; not
//! tools that go too far.

use crate::driver::Driver;
use crate::model::points::{Turn, in_space, turn_between, turned};
use moreau_laws::{Friction, Status};
use nalgebra::{SVector, Vector3};

/// How far a slip changes its direction within an increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The node that slips.
    pub node: usize,
    /// Where that is now \[mm\].
    pub position: [f64; D],
    /// By how much the tool has turned in the last increment \[rad\].
    pub turn: f64,
    /// Angle between the slip of the increment and that at its end \[rad\].
    pub angle: f64,
}

impl<const D: usize> Driver<D> {
    /// The slip that changed its direction most within the last increment while its tool turned, in space: on a disc by half
    /// of that turn, on a roll that turns about its axis not at all. Friction that depends on the direction is passed over: it
    /// is not against the slip.
    pub fn swings(&self) -> Option<Swing<D>> {
        if D < 3 {
            return None;
        }
        let (d_u, answered) = self.state.last.as_ref()?;
        let now = &self.state.loading;
        let turn_of = |tool: usize| match now.axle_of(tool) {
            Some(axle) => axle * (d_u[self.turn_dof(tool)] / self.mesh.size()),
            None => {
                let after = now.turn_of(tool);
                turn_between(&(after - answered.turn_of(tool)), &after)
            }
        };
        let turns: Vec<Turn> = (0..self.tools.len()).map(turn_of).collect();
        if turns.iter().all(|turn| turn.norm() == 0.0) {
            return None;
        }
        let rounding = self.settings.tolerance * self.state.largest_force;
        let points = self.points.iter().zip(&self.state.contacts).enumerate();
        let swings = points.filter_map(|(i, (p, record))| {
            let (tool, turn) = p.tool.map(|tool| (tool, &turns[tool]))?;
            let slips = record.status == Status::Slip && !matches!(p.law, Friction::Anisotropic(_));
            let rubs = slips && record.t.rows(1, D - 1).norm() > rounding;
            let angle = (rubs && turn.norm() > 0.0).then(|| self.swing(i, (tool, turn), d_u))?;
            Some(Swing {
                contact: p.contact,
                node: p.node,
                position: self.position(p.node).into(),
                turn: turn.norm(),
                angle,
            })
        });
        swings.max_by(|a, b| a.angle.total_cmp(&b.angle))
    }

    /// Angle along the surface between what a contact point has slipped in an increment, which friction is against, and what it
    /// slips at the end: its own way and that of the tool are straight, the turn of the tool is not.
    fn swing(&self, i: usize, (tool, turn): (usize, &Turn), d_u: &[f64]) -> f64 {
        let (p, row) = (&self.points[i], &self.footing.rows[i]);
        let moved = row.relative(|a| SVector::from_column_slice(&d_u[D * a..D * a + D]));
        let arm = self.place(row) - self.tools[tool].reference;
        let rate = in_space(&moved) - turn.cross(&in_space(&arm));
        let normal = self.tools[tool].opposite(p).normal(&self.seen(p, row));
        let normal = turned(normal, &self.state.loading.turn_of(tool));
        let normal = in_space(&normal);
        let along = |v: Vector3<f64>| v - normal * normal.dot(&v);
        let against = -in_space(&self.state.contacts[i].force);
        along(against).angle(&along(rate))
    }
}
