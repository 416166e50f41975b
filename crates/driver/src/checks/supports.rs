//! What stops the rigid motions of the bodies: a rank, not how forces answer.
//!
//! A body of modes r₁ … r_m is stopped by rows a: combinations of displacements that are prescribed,
//! that a contact normal closes on, or that friction resists. What is free is the null space of
//! Σ a aᵀ over all bodies, since contacts couple them.

use crate::checks::rigid::{NOTHING, RigidModes, Rows, Stopper, null_space};
use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::load::{Axis, Condition, Loading, Step, axis_letter, unit};
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, turned};
use moreau_contact::ContactSolution;
use moreau_laws::{Local, Status};
use nalgebra::SVector;

/// Part of the size of the mesh that is no motion.
const MOVED: f64 = 1e-6;

/// A rigid motion of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct RigidMotion {
    /// The motion in words, as in "translation along x".
    pub name: String,
    /// What it takes to stop it; `None` if nothing does.
    pub stopper: Option<Stopper>,
    /// Groups that resist it by prescribed displacements, with the directions in words: `x`, or `(0.6, 0.8)`.
    pub groups: Vec<(String, Vec<String>)>,
    /// Contacts that resist it, where displacements do not stop it by themselves.
    pub contacts: Vec<usize>,
}

/// The rigid motions of a body: translations, then rotations.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// First cell of the body.
    pub cell: usize,
    /// Its motions.
    pub motions: Vec<RigidMotion>,
    /// Independent motions that nothing resists, which may be combinations of these, in words.
    pub free: Vec<String>,
}

/// Components of a contact point that resist a motion.
pub(crate) fn resists<const D: usize>(status: Status) -> usize {
    match status {
        Status::Open => 0,
        Status::Slip => 1,
        Status::Stick | Status::Tied => D,
    }
}

/// The place of an item in a list, at the end of which it is put if it is new.
fn place<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    let found = list.iter().position(|other| *other == item);
    found.unwrap_or_else(|| {
        list.push(item);
        list.len() - 1
    })
}

/// The letter of an axis, or the components of another direction.
fn in_words<const D: usize>(n: &SVector<f64, D>) -> String {
    match (0..D).find(|&i| n[i].abs() == 1.0) {
        Some(i) => axis_letter(i).into(),
        None => crate::error::list(n.as_slice()),
    }
}

impl<const D: usize> Driver<D> {
    /// What stops every rigid motion of every body in a step; nothing is solved.
    ///
    /// # Errors
    /// Those of [`Driver::loading`].
    pub fn supports(&self, step: &Step<D>) -> Result<Vec<Support>, ModelError> {
        let loading = self.loading(step)?;
        let mut groups: Vec<&str> = Vec::new();
        let axes = [Axis::X, Axis::Y, Axis::Z].into_iter().take(D);
        let mut directions: Vec<SVector<f64, D>> = axes.map(Axis::unit).collect();
        let mut held = Vec::new();
        for condition in &step.conditions {
            let (on, n) = match condition {
                Condition::Displace { on, axis, .. } => (on, axis.unit()),
                Condition::DisplaceAlong { on, direction, .. } => (on, unit(on, direction)?),
                _ => continue,
            };
            let source = (place(&mut groups, on.as_str()), place(&mut directions, n));
            let nodes = self.mesh().node_group(on)?;
            held.extend(nodes.iter().map(|&node| (node, n, source)));
        }
        let rows = self.rows(held.into_iter(), &loading, Self::may_resist);
        let kinds = [
            Stopper::Displacement,
            Stopper::Tie,
            Stopper::Contact,
            Stopper::Friction,
        ];
        let free = kinds.map(|kind| null_space(&rows.up_to(kind)));
        let motions = rows.free();
        let support = |body: usize| {
            let stopped = free.each_ref().map(|f| rows.stopped(body, f));
            let motion = |k: usize| {
                let stopper = kinds.into_iter().find(|&kind| stopped[kind as usize][k]);
                let mut motion = RigidMotion {
                    name: rows.name(k),
                    stopper,
                    groups: Vec::new(),
                    contacts: Vec::new(),
                };
                let mode = rows.modes * body + k;
                for (&(kind, index, direction), effect) in &rows.effect {
                    if Some(kind) > stopper || effect[mode] < NOTHING * NOTHING {
                        continue;
                    }
                    if kind == Stopper::Displacement {
                        let along = in_words(&directions[direction]);
                        match motion.groups.last_mut() {
                            Some((name, all)) if name == groups[index] => all.push(along),
                            _ => motion.groups.push((groups[index].to_owned(), vec![along])),
                        }
                    } else if !motion.contacts.contains(&index) {
                        motion.contacts.push(index);
                    }
                }
                motion
            };
            Support {
                cell: rows.cells[body],
                motions: (0..rows.modes).map(motion).collect(),
                free: motions
                    .iter()
                    .filter(|(b, _)| *b == body)
                    .map(|(_, motion)| motion.clone())
                    .collect(),
            }
        };
        Ok((0..rows.cells.len()).map(support).collect())
    }

    /// Every rigid motion of the bodies must be resisted by a prescribed displacement, by a contact
    /// normal, or by friction.
    pub(crate) fn check_rigid_motions(&self, loading: &Loading<D>) -> Result<(), ModelError> {
        let rows = self.resisted(loading, Self::may_resist);
        match rows.free().into_iter().next() {
            None => Ok(()),
            Some((body, motion)) => Err(match body.checked_sub(rows.cells.len()) {
                Some(k) => ModelError::FreeTool {
                    tool: self.tools[rows.tools[k]].name.clone(),
                    motion,
                },
                None => ModelError::FreeRigidMotion {
                    body: self.body_in_words(rows.cells[body]),
                    motion,
                },
            }),
        }
    }

    /// Whether displacement conditions leave a rigid motion to the contacts.
    pub(crate) fn floats(&self, loading: &Loading<D>) -> bool {
        !self.resisted(loading, |_, _| 0).free().is_empty()
    }

    /// Whether the contacts of a solution that press by more than rounding \[N\] decide where every body is: a surface that
    /// touches without a force may as well be left, and what slips under friction decides by how far, if `slips` tells so.
    pub(crate) fn is_held_by(
        &self,
        loading: &Loading<D>,
        solution: &ContactSolution<D>,
        (rounding, slips): (f64, bool),
    ) -> bool {
        let closed = |status: &Status| matches!(status, Status::Stick | Status::Slip);
        let pairs = solution.status.iter().zip(&solution.force);
        let mut touching = pairs.filter(|(s, _)| closed(s)).peekable();
        let is_one_body = self.skin.values().all(|(body, _)| *body == 0);
        let touches = touching.peek().is_some();
        if slips && is_one_body && touches && touching.all(|(_, t)| t.norm() > rounding) {
            // A problem that its solution does not decide was singular.
            return true;
        }
        let of = |(k, (&status, t)): (usize, (&Status, &Local<D>))| match status {
            Status::Stick | Status::Slip if t.norm() <= rounding => Status::Open,
            Status::Slip if slips && self.points[k].law.resists_slip() => Status::Stick,
            _ => status,
        };
        let pairs = solution.status.iter().zip(&solution.force);
        self.is_held(loading, &pairs.enumerate().map(of).collect::<Vec<_>>())
    }

    /// Whether contacts of these statuses resist every rigid motion: what touches by its normal, and by its
    /// tangents where it sticks.
    pub(crate) fn is_held(&self, loading: &Loading<D>, status: &[Status]) -> bool {
        self.resisted(loading, |_, k| resists::<D>(status[k]))
            .free()
            .is_empty()
    }

    /// The tools in motions that normals of contacts leave free.
    pub(crate) fn spun_by_normals(&self, loading: &Loading<D>) -> Vec<usize> {
        let rows = self.resisted(loading, |_, _| 1);
        let free = rows.free().into_iter();
        let tool =
            |(body, _): (usize, String)| Some(rows.tools[body.checked_sub(rows.cells.len())?]);
        free.filter_map(tool).collect()
    }

    /// A rigid motion of a body in a step, in words after a cell of the body, that nothing resists where contact points
    /// have these statuses: what slips resists by its normal, what sticks by friction too, a tie always.
    pub fn let_go(
        &self,
        step: &Step<D>,
        status: impl Fn(usize) -> Status,
    ) -> Option<(usize, String)> {
        let loading = self.loading(step).ok()?;
        let rows = self.resisted(&loading, |driver, k| {
            let told = match driver.points[k].law.is_tie() {
                true => Status::Tied,
                false => status(k),
            };
            resists::<D>(told).min(driver.may_resist(k))
        });
        let bodies = rows.cells.len();
        let (body, motion) = rows.free().into_iter().find(|(body, _)| *body < bodies)?;
        Some((rows.cells[body], motion))
    }

    pub(crate) fn resisted(
        &self,
        loading: &Loading<D>,
        components: impl Fn(&Self, usize) -> usize,
    ) -> Rows {
        let held = loading.displacement.range(..self.mesh_dofs());
        let held = held.map(|(&dof, _)| (dof / D, loading.directions.along(dof), (0, 0)));
        self.rows(held, loading, components)
    }

    /// Whether the committed forces of the contacts leave a rigid motion to none of them, so that nothing decides where the
    /// body is.
    pub(crate) fn is_let_go(&self) -> bool {
        let loading = &self.state.loading;
        let pressing = |driver: &Self, k: usize| match driver.resisting(k) {
            0 => 0,
            _ => driver.may_resist(k),
        };
        self.floats(loading) && !self.resisted(loading, pressing).free().is_empty()
    }

    /// Components in which a contact point resists a motion in the committed state: none where its force is rounding.
    fn resisting(&self, point: usize) -> usize {
        let contact = &self.state.contacts[point];
        let rounding = self.settings.tolerance * self.state.largest_force;
        match self.points[point].law.is_tie() || contact.t.norm() > rounding {
            true => resists::<D>(contact.status),
            false => 0,
        }
    }

    /// The rigid motions that nothing resists in the committed state, in words: of what presses, the
    /// normals, and the tangents where it sticks.
    pub fn free_motions(&self) -> Vec<String> {
        let rows = self.resisted(&self.state.loading, Self::resisting);
        let whose = |body: usize| match body.checked_sub(rows.cells.len()) {
            Some(k) => format!("tool {:?}", self.tools[rows.tools[k]].name),
            None => self.body_in_words(rows.cells[body]),
        };
        let motions = rows.free().into_iter();
        motions
            .map(|(body, motion)| format!("{motion} of {}", whose(body)))
            .collect()
    }

    /// Rigid motions in words of bodies that have moved and that only contacts hold, none of which presses by more than
    /// rounding there: what pushes a body that nothing holds on its other side.
    pub fn pushed_motions(&self) -> Vec<String> {
        let loading = &self.state.loading;
        if !self.floats(loading) {
            return Vec::new();
        }
        let rounding = self.rounding_of_forces();
        let pressing = |driver: &Self, k: usize| match driver.state.contacts[k].t.norm() > rounding
        {
            true if driver.resisting(k) > 0 => driver.may_resist(k),
            _ if driver.points[k].law.is_tie() => D,
            _ => 0,
        };
        let rows = self.resisted(loading, pressing);
        let bodies = self.mesh.bodies();
        let has_moved = |body: &usize| {
            let nodes = bodies[*body].iter().flat_map(|&c| self.mesh.cell_nodes(c));
            nodes
                .copied()
                .any(|a| self.displacement(a).norm() > MOVED * self.mesh.size())
        };
        let motions = rows.free().into_iter();
        let moved = motions.filter(|(body, _)| *body < bodies.len() && has_moved(body));
        moved
            .map(|(body, motion)| format!("{motion} of {}", self.body_in_words(rows.cells[body])))
            .collect()
    }

    /// The body of a cell in words: by the smallest group of cells that holds the cell, by the cell itself where none does.
    pub fn body_in_words(&self, cell: usize) -> String {
        let groups = self.mesh.group_names();
        let groups = groups.filter_map(|name| Some((name, self.mesh.cell_group(name).ok()?)));
        let holding = groups.filter(|(_, cells)| cells.binary_search(&cell).is_ok());
        match holding.min_by_key(|(_, cells)| cells.len()) {
            Some((name, _)) => format!("the body \"{name}\""),
            None => format!("the body of cell {cell}"),
        }
    }

    /// Components in which a contact point may resist a motion: the normal, and the tangents where its
    /// law has friction.
    fn may_resist(&self, point: usize) -> usize {
        match self.points[point].law.resists_slip() {
            true => D,
            false => 1,
        }
    }

    /// What resists, with the nodes that are held and in which directions, by which of the groups and directions, and the
    /// number of components, the normal first, in which each contact point does.
    fn rows(
        &self,
        held: impl Iterator<Item = (usize, SVector<f64, D>, (usize, usize))>,
        loading: &Loading<D>,
        components: impl Fn(&Self, usize) -> usize,
    ) -> Rows {
        let modes = RigidModes::new(self, loading);
        let mut rows = modes.rows();
        for (node, n, (group, direction)) in held {
            let source = (Stopper::Displacement, group, direction);
            rows.add(source, &modes.row(&[(node, 1.0)], &n));
        }
        for (c, (point, motion_row)) in self.points.iter().zip(&self.footing.rows).enumerate() {
            let Some(normal) = self.normal_at(point, motion_row) else {
                continue;
            };
            let weights: Vec<(usize, f64)> = motion_row.weights().collect();
            let axes = moreau_contact::frame(&normal);
            let place = self.place(motion_row);
            for k in 0..components(self, c) {
                let kind = match k {
                    _ if point.law.is_tie() => Stopper::Tie,
                    0 => Stopper::Contact,
                    _ => Stopper::Friction,
                };
                let direction = axes.column(k).into_owned();
                let mut row = modes.row(&weights, &direction);
                if let Some(tool) = point.tool
                    && let Some((mode, way)) = modes.turning(tool, &place, &direction)
                {
                    *row.entry(mode).or_insert(0.0) -= way;
                }
                rows.add((kind, point.contact, 0), &row);
            }
        }
        rows
    }

    /// The normal at a contact point where it stands; `None` between bodies where it meets nothing.
    fn normal_at(
        &self,
        point: &ContactPoint<D>,
        motion_row: &RelativeMotionRow<D>,
    ) -> Option<SVector<f64, D>> {
        let Some(tool) = point.tool else {
            return motion_row
                .plane(&SVector::zeros())
                .map(|(normal, _)| normal);
        };
        let normal = self.tools[tool]
            .opposite(point)
            .normal(&self.seen(point, motion_row));
        Some(turned(normal, &self.state.loading.turn_of(tool)))
    }
}
