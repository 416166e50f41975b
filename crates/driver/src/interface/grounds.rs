//! What tools hold of the nodes that also face another body, as an increment goes on; not what follows for their
//! multipliers.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::linear::system::System;
use crate::model::footing::Ground;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics, turned};
use moreau_laws::Status;
use std::collections::BTreeSet;

/// Gap that is none, over the size of the mesh.
const CLOSED: f64 = 1e-6;

/// How often in an increment it is found anew what tools hold.
const CHANGES: u8 = 8;

impl<const D: usize> Driver<D> {
    /// At the start of an increment: as at the end of the last one; of the first where the undeformed bodies touch.
    pub(crate) fn begin_grounds(&mut self) {
        let none = CLOSED * self.mesh.size();
        self.footing.beside = self.points_beside_bodies();
        let grounds = self.footing.beside.iter().filter_map(|&c| {
            let (point, record) = (&self.points[c], &self.state.contacts[c]);
            let tool = point.tool?;
            let row = RelativeMotionRow::on_tool(&point.own, point.area, self.tool_node(tool));
            let (obstacle, at) = (self.tools[tool].opposite(point), self.seen(point, &row));
            let closed = match self.state.increment {
                0 => obstacle.distance(&at) - point.offset <= none,
                _ => record.status != Status::Open,
            };
            let normal = obstacle.normal(&at);
            closed.then(|| Ground {
                point: c,
                normal: turned(normal, &self.state.loading.turn_of(tool)),
                sticks: self.holds_along(record.status),
            })
        });
        self.footing.grounds = grounds.collect();
        self.footing.regrounded = 0;
    }

    /// What tools hold under these statuses. Whether that changes which multipliers there are.
    ///
    /// # Errors
    /// [`Driver::pair_at`].
    pub(crate) fn reground(
        &mut self,
        system: &System,
        (loading, d_u): (&Loading<D>, &[f64]),
        (kinematics, status): (&[Kinematics<D>], &[Status]),
    ) -> Result<bool, ModelError> {
        // Where contacts are tied in the factor, which nodes are coupled must not change.
        if system.is_tied() {
            return Ok(false);
        }
        let footing = &self.footing;
        let stuck: BTreeSet<usize> = (footing.grounds.iter())
            .filter(|ground| ground.sticks && footing.regrounded > 0)
            .map(|ground| ground.point)
            .collect();
        let closed = |c: &&usize| status[**c] != Status::Open && kinematics[**c].active[0];
        let closed = footing.beside.iter().filter(closed);
        let grounds: Vec<Ground<D>> = closed
            .map(|&c| Ground {
                point: c,
                normal: kinematics[c].axes.column(0).into_owned(),
                // What sticks while its neighbours have its multiplier, and slips when it has its own, does one of both.
                sticks: self.holds_along(status[c]) || stuck.contains(&c),
            })
            .collect();
        let held = |all: &[Ground<D>]| all.iter().map(|g| (g.point, g.sticks)).collect::<Vec<_>>();
        if footing.regrounded >= CHANGES || held(&grounds) == held(&footing.grounds) {
            return Ok(false);
        }
        self.footing.regrounded += 1;
        self.footing.grounds = grounds;
        let before = self.left_to_others();
        match self.repairs() {
            true => self.pair_at(loading, d_u)?,
            false => self.pair_at(loading, &vec![0.0; d_u.len()])?,
        }
        Ok(before != self.left_to_others())
    }

    /// Whether a tool counts as holding a point along its surface. Under small strains it does wherever it touches, so that
    /// all of the pressure of a joint has its friction: what overlaps at the foot is of the size of its slip. Where slips are
    /// large too, what slips has a multiplier of its own.
    fn holds_along(&self, status: Status) -> bool {
        status == Status::Stick || !self.repairs()
    }

    /// The points whose multipliers their neighbours have, and those of which tools hold some of the motion along the surface.
    fn left_to_others(&self) -> (Vec<usize>, Vec<usize>) {
        let rows = self.footing.rows.iter().enumerate();
        let held = rows.filter(|(_, row)| !row.grounded.is_empty());
        (
            self.footing.redistributed.clone(),
            held.map(|(c, _)| c).collect(),
        )
    }

    /// The points on tools of the nodes on surfaces that face another body.
    fn points_beside_bodies(&self) -> Vec<usize> {
        if self.points.iter().all(|p| p.tool.is_some()) {
            return Vec::new();
        }
        let mut beside = BTreeSet::new();
        for contact in self.contacts.iter().filter(|c| c.pairing.is_some()) {
            for surface in [&contact.surface, &contact.opposite] {
                let facets = self.mesh.facet_group(surface).unwrap_or(&[]);
                beside.extend(
                    facets
                        .iter()
                        .flat_map(|&facet| self.mesh.facet_nodes(facet)),
                );
            }
        }
        let is_beside = |c: &usize| {
            let ContactPoint { own, tool, .. } = &self.points[*c];
            tool.is_some() && own.iter().any(|(a, _)| beside.contains(a))
        };
        (0..self.points.len()).filter(is_beside).collect()
    }
}
