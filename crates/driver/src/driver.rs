//! The driver: the state of a model, and steps applied to it; not the iteration of an increment.

use crate::assembly::block::{Block, PointField, PointState, points_of};
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::assembly::spread::serve;
use crate::error::{IncrementError, LawFault, ModelError};
use crate::linear::system::{Contacts, System};
use crate::model::Model;
use crate::model::analysis::{Analysis, Measure};
use crate::model::contact::Contact;
use crate::model::footing::Footing;
use crate::model::grip::Grip;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Tool, in_space, tool_index, turned};
use crate::model::skin::{Skin, skin};
use crate::report::counts::Counts;
use crate::report::{ContactRecord, Energies, IncrementReport, Iteration};
use crate::settings::{Nesting, Seam, Settings};
use crate::timings::Timings;
use crate::vector::SparseVector;
use moreau_algebra::SharedTeam;
use moreau_contact::{ContactSolution, Corner};
use moreau_laws::{Local, Status};
use moreau_mesh::Mesh;
use nalgebra::{SVector, Vector3};
use std::ops::ControlFlow;

/// The state of a model between increments: one value, replaced when an increment is committed.
#[derive(Debug, Clone)]
pub(crate) struct State<const D: usize> {
    pub(crate) increment: usize,
    /// Displacement at every degree of freedom \[mm\].
    pub(crate) displacement: Vec<f64>,
    /// Displacement increment of the last increment, and the loading that it answered.
    pub(crate) last: Option<(Vec<f64>, Loading<D>)>,
    /// By how much that differs from the increment before it, at the same rate, and the length of its loading over the one
    /// before: see [`Driver::predictor`].
    pub(crate) bend: Option<(Vec<f64>, f64)>,
    /// [`Assembly::internal`].
    pub(crate) internal: Vec<f64>,
    pub(crate) loading: Loading<D>,
    pub(crate) energies: Energies,
    pub(crate) contacts: Vec<ContactRecord<D>>,
    /// Contact forces \[N\].
    pub(crate) contact: SparseVector,
    /// Largest displacement of a node of the mesh so far \[mm\]: stresses keep the rounding of the largest
    /// that they have been.
    pub(crate) farthest: f64,
    /// Largest internal or contact force of a node so far \[N\].
    pub(crate) largest_force: f64,
    /// Last solution of the contact problem, to start the next from.
    pub(crate) solution: Option<ContactSolution<D>>,
    /// Whether the last equilibrium was unstable.
    pub(crate) unstable: bool,
}

/// Components of contacts at most of which the problem is condensed where it cannot be solved tied.
const CONDENSABLE: usize = 3000;

/// A model under load. See the crate's documentation for an example.
pub struct Driver<const D: usize> {
    pub(crate) mesh: Mesh<D>,
    pub(crate) blocks: Vec<Box<dyn Block<D>>>,
    pub(crate) tools: Vec<Tool<D>>,
    pub(crate) points: Vec<ContactPoint<D>>,
    /// Where the contact points stand in the increment at hand.
    pub(crate) footing: Footing<D>,
    /// Where shears of given limits act in the increment at hand.
    pub(crate) grips: Vec<Grip>,
    /// The sharp corners of tools that contact points touched at the start of the increment at hand, and have not left.
    pub(crate) corners: Vec<Option<Corner<D>>>,
    pub(crate) settings: Settings<D>,
    pub(crate) state: State<D>,
    pub(crate) system: Option<System>,
    /// [`Driver::guess`].
    pub(crate) guessed: Option<Vec<f64>>,
    /// Whether what tools move may end the increment at hand far away: shorter ones do as well.
    pub(crate) may_leap: bool,
    /// What the increment under way has counted on ways that led to no balance.
    pub(crate) spent: Counts,
    /// The nodes on the surfaces of the bodies, where there are tools.
    pub(crate) skin: Skin<D>,
    pub(crate) measure: Box<dyn Measure<D>>,
    pub(crate) contacts: Vec<Contact>,
    materials: Vec<usize>,
    /// Strain of every cell by a kelvin \[1/K\]; empty where none expands.
    pub(crate) expansion: Vec<f64>,
    /// Processes that hold the cells together, and which of them has which cell.
    team: Option<(SharedTeam, Vec<u32>)>,
}

impl<const D: usize> Driver<D> {
    /// The virgin state of a model.
    ///
    /// # Errors
    /// [`ModelError::MissingMaterial`]; [`ModelError::OutOfRange`] of settings that no increment could meet, and of a negative
    /// radius around an axis.
    pub fn new<H: Analysis<D>>(
        mut model: Model<D, H>,
        settings: Settings<D>,
    ) -> Result<Self, ModelError> {
        model.check()?;
        settings.check()?;
        let dofs = D * (model.mesh.nodes().len() + 2 * model.tools.len());
        let rest = |p: &ContactPoint<D>| ContactRecord {
            contact: p.contact,
            node: p.node,
            position: model.mesh.nodes()[p.node],
            kind: p.kind,
            u: Local::zeros(),
            t: Local::zeros(),
            force: SVector::zeros(),
            area: p.area,
            status: match p.law.is_tie() {
                true => Status::Tied,
                false => Status::Open,
            },
            held: false,
            spring: Local::zeros(),
        };
        let state = State {
            increment: 0,
            displacement: vec![0.0; dofs],
            last: None,
            bend: None,
            internal: vec![0.0; dofs],
            loading: Loading::default(),
            energies: Energies::default(),
            contacts: model.points.iter().map(rest).collect(),
            contact: SparseVector::default(),
            farthest: 0.0,
            largest_force: 0.0,
            solution: None,
            unstable: false,
        };
        let blocks = model.take_blocks();
        let mut driver = Self {
            team: model.team,
            skin: match model.tools.is_empty() {
                true => Skin::new(),
                false => skin(&model.mesh),
            },
            measure: Box::new(model.hypothesis),
            // All cells have one: it was checked.
            materials: model.material.into_iter().flatten().collect(),
            expansion: model.expansion,
            mesh: model.mesh,
            blocks,
            tools: model.tools,
            contacts: model.contacts,
            grips: vec![Grip::default(); model.points.len()],
            corners: vec![None; model.points.len()],
            points: model.points,
            footing: Footing::default(),
            settings,
            state,
            system: None,
            guessed: None,
            may_leap: false,
            spent: Counts::default(),
        };
        driver.pair(&Loading::default())?;
        driver.adjust();
        // Other processes answer once they have a driver of their own: what can be wrong with the model comes before.
        driver.start();
        driver.check_laws()?;
        Ok(driver)
    }

    /// Takes the gaps of paired bodies that are adjusted for none: see [`Model::adjust`].
    fn adjust(&mut self) {
        for (point, row) in self.points.iter_mut().zip(&self.footing.rows) {
            let within = self.contacts[point.contact].adjusted;
            let gap = row
                .plane(&SVector::zeros())
                .map(|(_, gap)| gap - point.offset);
            if let (Some(within), Some(gap)) = (within, gap)
                && gap.abs() <= within
            {
                point.offset += gap;
            }
        }
    }

    /// The process that holds each cell; `None` without a team.
    pub fn processes(&self) -> Option<&[u32]> {
        self.team.as_ref().map(|(_, process)| &**process)
    }

    /// Does what the first process of the team asks of this other one, with its cells, until that has ended; at once
    /// without a team.
    pub fn serve(self) {
        let sizes = (self.mesh.nodes().len(), self.state.displacement.len());
        let Self { blocks, team, .. } = self;
        if let Some((team, _)) = team.filter(|(team, _)| team.rank() > 0) {
            serve::serve(team.as_ref(), blocks, sizes);
        }
    }

    /// Forces and energy of the stresses at the start, which as much force on the nodes and work have made: the first step
    /// takes that force away as it applies its own.
    fn start(&mut self) {
        let rest = vec![0.0; self.state.displacement.len()];
        let motion = Motion::new(&rest, &rest);
        for block in &mut self.blocks {
            block.evaluate(motion, Stiffness::None, &mut |cell| {
                for (&a, own) in cell.nodes.iter().zip(cell.force.chunks_exact(D)) {
                    let at = self.state.internal[D * a..D * a + D].iter_mut();
                    at.zip(own).for_each(|(sum, f)| *sum += f);
                }
            });
            self.state.energies.stored += block.energy().stored;
        }
        self.state.energies.external_work = self.state.energies.stored;
        let held = self.state.internal.iter().enumerate();
        held.for_each(|(dof, &f)| self.state.loading.force.add(dof, f));
    }

    /// Whether strains and rotations are large: displacements change the stiffness.
    pub fn has_large_strains(&self) -> bool {
        !self.blocks.iter().all(|b| b.keeps_elastic_stiffness())
    }

    /// The node that stands for a tool.
    pub(crate) fn tool_node(&self, tool: usize) -> usize {
        self.mesh.nodes().len() + tool
    }

    /// The degree of freedom of the turn of a tool by a moment: the way of a point as far from its reference point as the
    /// mesh is large \[mm\], so that its force is the moment over that size \[N\].
    pub(crate) fn turn_dof(&self, tool: usize) -> usize {
        D * (self.mesh.nodes().len() + self.tools.len() + tool)
    }

    /// Degrees of freedom of the mesh; those of the tools come after them.
    pub(crate) fn mesh_dofs(&self) -> usize {
        D * self.mesh.nodes().len()
    }

    /// Where a node of the mesh is \[mm\].
    pub(crate) fn position(&self, node: usize) -> SVector<f64, D> {
        SVector::from(self.mesh.nodes()[node]) + self.displacement(node)
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }

    /// Number of the material of every cell, in the order in which the model was given them.
    pub fn materials(&self) -> &[usize] {
        &self.materials
    }

    /// Displacement of a node since the virgin state \[mm\].
    ///
    /// # Panics
    /// If the mesh has no such node.
    pub fn displacement(&self, node: usize) -> SVector<f64, D> {
        self.expect_node(node);
        SVector::from_column_slice(&self.state.displacement[D * node..D * node + D])
    }

    /// Panics of a node that is none, of the mesh or of a tool.
    #[inline]
    fn expect_node(&self, node: usize) {
        let nodes = self.state.displacement.len() / D;
        assert!(node < nodes, "node {node} is none of the mesh");
    }

    /// Displacements of all nodes since the virgin state, D components each \[mm\].
    pub fn displacements(&self) -> &[f64] {
        &self.state.displacement[..self.mesh_dofs()]
    }

    /// Increments converged so far.
    pub fn increments(&self) -> usize {
        self.state.increment
    }

    /// The loading that holds now.
    pub fn applied(&self) -> &Loading<D> {
        &self.state.loading
    }

    /// Unknowns of the current step; 0 before the first.
    pub fn unknowns(&self) -> usize {
        self.system.as_ref().map_or(0, System::size)
    }

    /// Entries stored of the factor of the stiffness, by which orders of elimination are compared;
    /// 0 before the first step.
    pub fn factor_entries(&self) -> usize {
        self.system.as_ref().map_or(0, System::factor_entries)
    }

    /// Where the time went so far.
    pub fn timings(&self) -> Timings {
        self.system
            .as_ref()
            .map_or_else(Timings::default, |s| s.timings)
    }

    /// Gives back the memory of the linear system, which another increment makes anew; what is told of it, its times among
    /// that, is gone with it.
    pub fn free_system(&mut self) {
        self.system = None;
    }

    /// Contact points, in the order of the contacts and of the nodes in each.
    pub fn contacts(&self) -> &[ContactRecord<D>] {
        &self.state.contacts
    }

    /// Status of a contact point, an index of [`Driver::contacts`], as it is told: one that bears no more than the rounding of
    /// the largest force so far is open, whatever rounding has made of its status.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn status(&self, point: usize) -> Status {
        let record = &self.state.contacts[point];
        let rounding = self.settings.tolerance * self.state.largest_force;
        match record.status == Status::Tied || record.t.norm() > rounding {
            true => record.status,
            false => Status::Open,
        }
    }

    /// How many contact points have a status, see [`Driver::status`]; those held by a displacement condition along the
    /// surface are not counted as sticking or slipping.
    pub fn count(&self, status: Status) -> usize {
        let counts = |&k: &usize| {
            let held = self.state.contacts[k].held && status != Status::Open;
            self.status(k) == status && !held
        };
        (0..self.state.contacts.len()).filter(counts).count()
    }

    /// Names of the surface of a contact and of the tool or surface opposite.
    ///
    /// # Panics
    /// If there is no such contact.
    pub fn contact_name(&self, contact: usize) -> (&str, &str) {
        let Some(named) = self.contacts.get(contact) else {
            panic!("contact {contact} is none of the model");
        };
        (&named.surface, &named.opposite)
    }

    /// Contact points, as indices of [`Driver::contacts`], that displacement conditions left no
    /// multiplier of their own in the last increment: what they transmit is with their neighbours.
    pub fn redistributed(&self) -> &[usize] {
        &self.footing.redistributed
    }

    /// Energies since the virgin state.
    pub fn energies(&self) -> Energies {
        self.state.energies
    }

    /// Committed state at all quadrature points, cells in the order of their blocks.
    pub fn points(&self) -> Vec<PointState<D>> {
        self.blocks
            .iter()
            .flat_map(|b| b.points(&self.state.displacement))
            .collect()
    }

    /// The fields that laws have of their own at every quadrature point, in the order of
    /// [`Driver::points`].
    pub fn fields(&self) -> Vec<PointField> {
        let mut all: Vec<PointField> = Vec::new();
        let mut before = 0;
        for block in &self.blocks {
            let points = points_of(block.as_ref());
            for own in block.fields(&self.state.displacement) {
                let same = |f: &PointField| (&f.name, f.components) == (&own.name, own.components);
                match all.iter_mut().find(|f| same(f)) {
                    Some(field) => field.values.extend(own.values),
                    None => {
                        let mut values = vec![f64::NAN; own.components * before];
                        values.extend(own.values);
                        all.push(PointField { values, ..own });
                    }
                }
            }
            before += points;
            for field in &mut all {
                field.values.resize(field.components * before, f64::NAN);
            }
        }
        all
    }

    /// How much warmer every quadrature point is than when the body was free of stress \[K\], in the order of
    /// [`Driver::points`]; `None` where nothing expands.
    pub fn temperatures(&self) -> Option<PointField> {
        let points: usize = self.blocks.iter().map(|b| points_of(b.as_ref())).sum();
        let now = &self.state.loading.temperature;
        (!self.expansion.is_empty()).then(|| PointField {
            name: "temperature".into(),
            components: 1,
            values: (0..points).map(|k| now.at(k)).collect(),
        })
    }

    /// Sum of the reactions of the prescribed displacements of a group \[N\]: the force that the
    /// supports exert on the body.
    ///
    /// # Errors
    /// An unknown group.
    pub fn reaction(&self, group: &str) -> Result<SVector<f64, D>, ModelError> {
        let mut sum = SVector::zeros();
        for node in self.mesh.node_group(group)? {
            sum += self.nodal_reaction(node);
        }
        Ok(sum)
    }

    /// Force that the prescribed displacements of a node exert on it \[N\].
    ///
    /// # Panics
    /// If the mesh has no such node.
    pub fn nodal_reaction(&self, node: usize) -> SVector<f64, D> {
        self.expect_node(node);
        let State {
            internal,
            loading,
            contact,
            ..
        } = &self.state;
        let left = SVector::from_fn(|i, _| {
            let dof = D * node + i;
            internal[dof] - loading.force.at(dof) - contact.at(dof)
        });
        loading.held_at(node).part(&left)
    }

    /// Sum of the reactions of a group that the supports of a loading let go \[N\]: forces that a step to it takes off in
    /// proportion.
    ///
    /// # Errors
    /// An unknown group.
    pub fn released(&self, group: &str, end: &Loading<D>) -> Result<SVector<f64, D>, ModelError> {
        let of = |node| end.free_at(node).part(&self.nodal_reaction(node));
        Ok(self.mesh.node_group(group)?.into_iter().map(of).sum())
    }

    /// Sum of the forces that a tool exerts on the body \[N\].
    ///
    /// # Errors
    /// [`ModelError::UnknownTool`].
    pub fn tool_force(&self, name: &str) -> Result<SVector<f64, D>, ModelError> {
        let tool = Some(tool_index(&self.tools, name)?);
        let touches = |(p, _): &(&ContactPoint<D>, &ContactRecord<D>)| p.tool == tool;
        let pairs = self.points.iter().zip(&self.state.contacts);
        Ok(pairs.filter(touches).map(|(_, c)| c.force).sum())
    }

    /// Moment of the forces that a tool exerts on the body about its reference point, where that is now \[N·mm\]:
    /// in the plane the third component.
    ///
    /// # Errors
    /// [`ModelError::UnknownTool`].
    pub fn tool_moment(&self, name: &str) -> Result<Vector3<f64>, ModelError> {
        let rest = vec![0.0; self.state.displacement.len()];
        let tool = tool_index(&self.tools, name)?;
        Ok(self.moment(tool, &rest, &self.state.contacts))
    }

    /// The same of contact forces after displacement increments.
    pub(crate) fn moment(
        &self,
        tool: usize,
        d_u: &[f64],
        contacts: &[ContactRecord<D>],
    ) -> Vector3<f64> {
        let of = |(p, c): (&ContactPoint<D>, &ContactRecord<D>)| {
            self.arm(tool, p, d_u).cross(&in_space(&c.force))
        };
        let points = self.points.iter().zip(contacts);
        points.filter(|(p, _)| p.tool == Some(tool)).map(of).sum()
    }

    /// From the reference point of a tool to a contact point after displacement increments \[mm\].
    pub(crate) fn arm(&self, tool: usize, point: &ContactPoint<D>, d_u: &[f64]) -> Vector3<f64> {
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let node = self.tool_node(tool);
        let about = self.tools[tool].reference + self.displacement(node) + moved(node);
        let own = point.own.iter();
        let own = own.map(|&(a, w)| (self.position(a) + moved(a)) * w);
        in_space(&(own.sum::<SVector<f64, D>>() - about))
    }

    /// How far a tool has turned: a vector along the axis, as long as the angle \[rad\].
    ///
    /// # Errors
    /// [`ModelError::UnknownTool`].
    pub fn tool_turn(&self, name: &str) -> Result<Vector3<f64>, ModelError> {
        let tool = tool_index(&self.tools, name)?;
        Ok(self.state.loading.turn_of(tool))
    }

    /// Translation of a tool from its first position \[mm\].
    ///
    /// # Errors
    /// [`ModelError::UnknownTool`].
    pub fn tool_displacement(&self, name: &str) -> Result<SVector<f64, D>, ModelError> {
        let tool = tool_index(&self.tools, name)?;
        Ok(self.displacement(self.tool_node(tool)))
    }

    /// Contact force on a group \[N\]: on a surface of contacts, on either side, what these exert on it, whatever other
    /// contacts do at nodes that it shares with others; on any other group the sum over its nodes.
    ///
    /// # Errors
    /// An unknown group.
    pub fn contact_force(&self, group: &str) -> Result<SVector<f64, D>, ModelError> {
        let nodes = self.mesh.node_group(group)?;
        if !self.is_contact_surface(group) {
            return Ok(nodes.iter().map(|&a| self.nodal_contact_force(a)).sum());
        }
        let mut sum = SVector::zeros();
        let rows = self.footing.rows.iter().zip(&self.state.contacts);
        for ((row, record), point) in rows.zip(&self.points) {
            let Contact {
                surface, opposite, ..
            } = &self.contacts[point.contact];
            let weight = |side: &[(usize, f64)]| side.iter().map(|(_, w)| w).sum::<f64>();
            if surface == group {
                sum += record.force * weight(&row.own);
            }
            if opposite == group {
                sum -= record.force * weight(&row.opposite);
            }
        }
        Ok(sum)
    }

    /// Whether a group is a surface of a contact, on either side.
    pub fn is_contact_surface(&self, group: &str) -> bool {
        (self.contacts.iter()).any(|c| c.surface == group || c.opposite == group)
    }

    /// Contact force on a node \[N\].
    ///
    /// # Panics
    /// If the mesh has no such node.
    pub fn nodal_contact_force(&self, node: usize) -> SVector<f64, D> {
        self.expect_node(node);
        SVector::from(self.state.contact.at_node::<D>(node))
    }

    /// Takes displacement increments of the nodes, D components each \[mm\], for the first guess of the next increment that is
    /// tried, in place of what the path so far lets expect; one whose load factor is unknown takes none. Where there are
    /// several equilibria the guess decides which is found: a part of [`IncrementReport::mode`] leads to the branch that leaves the
    /// path there.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for another number of them, or if one is not finite.
    pub fn guess(&mut self, d_u: &[f64]) -> Result<(), ModelError> {
        let dofs = self.mesh_dofs();
        let refused = |what: &str, value: f64, expected: &'static str| ModelError::OutOfRange {
            what: what.into(),
            value,
            expected,
        };
        if d_u.len() != dofs {
            let expected = "one for every component at every node";
            return Err(refused(
                "number of displacement increments",
                d_u.len() as f64,
                expected,
            ));
        }
        if let Some(&value) = d_u.iter().find(|u| !u.is_finite()) {
            return Err(refused("displacement increment", value, "a finite number"));
        }
        let mut all = d_u.to_vec();
        all.resize(self.state.displacement.len(), 0.0);
        self.guessed = Some(all);
        Ok(())
    }

    /// Applies one increment, up to the loading `end`: commits it, or fails and changes nothing.
    ///
    /// # Errors
    /// See [`IncrementError`].
    pub fn advance(&mut self, end: &Loading<D>) -> Result<IncrementReport, IncrementError> {
        self.advance_watched(end, &mut |_| ControlFlow::Continue(()))
    }

    /// [`Driver::advance`], told of every iterate.
    pub(crate) fn advance_watched(
        &mut self,
        end: &Loading<D>,
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        self.spent = Counts::default();
        let outcome = self.attempt(end, watch);
        self.guessed = None;
        self.may_leap = false;
        outcome
    }

    fn attempt(
        &mut self,
        end: &Loading<D>,
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        self.check_loading(end)?;
        self.pair(end)?;
        self.check_pushes(end)?;
        let mut system = self.prepare(end, None)?;
        let start = self.start_of(end);
        let outcome = match self.settings.nesting {
            Nesting::Inside => self.increment(&mut system, &start, end, &mut |_, now| watch(now)),
            Nesting::Outside {
                tolerance,
                iterations,
                extrapolated,
            } => {
                let until = (tolerance, iterations, extrapolated);
                self.nested_increment(&mut system, &start, end, until, watch)
            }
        };
        let other = match &outcome {
            Err(error) => self.other_seam(&mut system, error, end)?,
            Ok(_) => None,
        };
        let Some(mut other) = other else {
            self.system = Some(system);
            return outcome.map_err(|error| self.or_fault(error));
        };
        let watch = &mut |_: &Self, now: &Iteration<'_>| watch(now);
        let again = self.increment(&mut other, &start, end, watch);
        let (system, outcome) = match again {
            // What nothing holds either way has the error of the first try, which names it.
            Err(ref error) if other.is_tied() && !error.is_broken_off() => (system, outcome),
            again => (other, again),
        };
        self.system = Some(system);
        outcome.map_err(|error| self.or_fault(error))
    }

    /// The system for another try of an increment that ends so, where both seams are there to choose from: contacts that
    /// nothing holds on a dense matrix may be held in the factor, and so is a body that only they hold, where stresses let
    /// it turn away.
    fn other_seam(
        &mut self,
        system: &mut System,
        error: &IncrementError,
        end: &Loading<D>,
    ) -> Result<Option<System>, ModelError> {
        if self.condenses(system, error) {
            return self.elastic_system(end, None, Seam::Condensed).map(Some);
        }
        let is_worth = error.is_singular() && self.may_tie(system, end);
        if !(is_worth || self.ties(system, error, end)) {
            return Ok(None);
        }
        let tied = self.elastic_system(end, None, Seam::Tied)?;
        system.lose_others();
        Ok(Some(tied).filter(System::is_tied))
    }

    /// Whether contacts on a dense matrix may as well be tied in the factor.
    fn may_tie(&self, system: &System, end: &Loading<D>) -> bool {
        let chosen = self.settings.seam == Seam::Cheaper && !system.is_tied();
        chosen && self.coupled(Seam::Tied, end).is_some()
    }

    /// Whether an increment that ends so is tried with contacts tied in the factor at once: a body that nothing but them
    /// holds, and that stresses turn away, comes to rest there in less than on the way in quarters.
    pub(crate) fn ties(&self, system: &System, error: &IncrementError, end: &Loading<D>) -> bool {
        let ends = error.is_final();
        let turns_away = system.floats && self.has_large_strains() && !ends;
        turns_away && self.may_tie(system, end)
    }

    /// Whether an increment that ends so with contacts tied in the factor is tried on a dense matrix, which costs more,
    /// and whose methods find what that one does not.
    pub(crate) fn condenses(&self, system: &System, error: &IncrementError) -> bool {
        let small = D * self.points.len() <= CONDENSABLE;
        let chosen = self.settings.seam == Seam::Cheaper && system.is_tied();
        small && chosen && matches!(error, IncrementError::Contact { .. })
    }

    /// # Errors
    /// What a law could not answer in the last evaluation.
    pub(crate) fn check_laws(&mut self) -> Result<(), LawFault> {
        let fault = self.blocks.iter_mut().find_map(|block| block.take_fault());
        fault.map_or(Ok(()), Err)
    }

    /// What a law could not answer, where there is such, in place of what followed from that.
    pub(crate) fn or_fault(&mut self, error: IncrementError) -> IncrementError {
        self.check_laws().err().map_or(error, Into::into)
    }

    /// The linear system for the prescribed degrees of freedom of a loading and a pivot: the one at
    /// hand, or a new one if they have changed.
    pub(crate) fn prepare(
        &mut self,
        loading: &Loading<D>,
        pivot: Option<usize>,
    ) -> Result<System, ModelError> {
        let fixed = |dof: usize| loading.displacement.contains_key(&dof);
        let dofs = self.state.displacement.len();
        let paired = self.paired();
        if let Some(system) = self.system.take_if(|s| {
            s.pivot == pivot
                && (0..dofs).all(|d| s.is_free(d) != fixed(d))
                && s.prescribed().directions == loading.directions
                && (!s.is_tied() || s.paired == paired)
        }) {
            if !system.has_lost_others() {
                return Ok(system);
            }
            // The same again, with its times.
            let seam = system.seam();
            self.system = Some(system);
            return self.elastic_system(loading, pivot, seam);
        }
        self.check_rigid_motions(loading)?;
        self.elastic_system(loading, pivot, self.settings.seam)
    }

    /// The nodes that each contact point between bodies couples.
    fn paired(&self) -> Vec<Vec<usize>> {
        let points = self.points.iter().zip(&self.footing.rows);
        let paired = points.filter(|(p, _)| p.tool.is_none());
        paired.map(|(_, motion_row)| motion_row.nodes()).collect()
    }

    /// A new linear system for a loading, with the elastic stiffness assembled.
    pub(crate) fn elastic_system(
        &mut self,
        loading: &Loading<D>,
        pivot: Option<usize>,
        seam: Seam,
    ) -> Result<System, ModelError> {
        let fixed = |dof: usize| loading.displacement.contains_key(&dof);
        let mut interface: Vec<usize> = self.points.iter().map(|p| p.node).collect();
        for contact in self.contacts.iter().filter(|c| c.pairing.is_some()) {
            interface.extend(self.mesh.node_group(&contact.opposite)?);
        }
        let ties = self.points.iter().filter_map(|p| p.tied.as_ref());
        interface.extend(ties.flat_map(RelativeMotionRow::nodes));
        let before = self.timings();
        // Two factors at once may not fit.
        self.system = None;
        let coupled = self.coupled(seam, loading);
        let turned = self.turned(loading);
        let mut system = System::new(
            &self.mesh,
            &self.blocks,
            (fixed, &loading.directions),
            &Contacts {
                nodes: &interface,
                pivot,
                tools: 2 * self.tools.len(),
                seam,
                coupled: coupled.as_deref(),
                turned: &turned,
            },
            (
                self.settings.memory,
                self.team.as_ref().map(|(team, _)| team),
            ),
        )?;
        system.timings += before;
        system.floats = self.floats(loading);
        system.paired = self.paired();
        let inside = self.settings.nesting == Nesting::Inside;
        // Of the undeformed body, so that what follows from it does not depend on when the system was made.
        let undeformed = vec![0.0; self.state.displacement.len()];
        system.assemble_elastic(&mut self.blocks, &undeformed, inside);
        Ok(system)
    }

    /// What a tool that is driven by a force may touch must be able to stand up to it.
    fn check_pushes(&self, end: &Loading<D>) -> Result<(), ModelError> {
        for (k, tool) in self.tools.iter().enumerate() {
            let node = self.tool_node(k);
            let force = SVector::from(end.force.at_node::<D>(node));
            let moment = end.force.at(self.turn_dof(k)) * self.mesh.size();
            let axle = end.axle_of(k).unwrap_or_default() * moment;
            // The most work that a contact force of unit pressure can do against the tool's force, or its moment.
            let most = |p: &ContactPoint<D>| {
                let place = self.position(p.node) - self.displacement(node);
                let turn = self.state.loading.turn_of(k);
                let n = turned(tool.opposite(p).normal(&tool.seen(place, &turn)), &turn);
                let spin = axle.cross(&in_space(&(place - tool.reference)));
                [force, SVector::from_fn(|i, _| spin[i])].map(|drives| {
                    let along = n.dot(&drives);
                    let across = (drives - n * along).norm();
                    along + if p.law.resists_slip() { across } else { 0.0 }
                })
            };
            let mut points = self.points.iter().filter(|p| p.tool == Some(k)).peekable();
            if (force.norm() > 0.0 || moment != 0.0) && points.peek().is_none() {
                let tool = tool.name.clone();
                return Err(ModelError::UntouchedTool { tool });
            }
            let least = 1e-9 * moment.abs() * self.mesh.size();
            // A round tool about its centre is not turned away from anything: whether it spins is told elsewhere.
            let mut works = points.clone().map(|p| most(p)[1]);
            let never_stands = works.clone().all(|work| work <= least);
            if moment != 0.0 && never_stands && works.any(|work| work < -least) {
                return Err(ModelError::TurnedAwayTool {
                    tool: tool.name.clone(),
                    moment,
                });
            }
            if force.norm() > 0.0 && !points.any(|p| most(p)[0] > 1e-9 * force.norm()) {
                return Err(ModelError::PulledTool {
                    tool: tool.name.clone(),
                    force: force.iter().copied().collect(),
                });
            }
        }
        Ok(())
    }
}
