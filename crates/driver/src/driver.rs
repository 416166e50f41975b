//! The driver: the state of a model, and steps applied to it; not the iteration of an increment.

use crate::block::{Block, PointState, Stiffness};
use crate::error::{ModelError, StepError};
use crate::increments::Increments;
use crate::interface::{ContactPoint, Tool};
use crate::load::{Condition, Loading, Step, axis_letter};
use crate::model::{Analysis, ContactName, Measure, Model};
use crate::report::{ContactRecord, Energies, StepReport};
use crate::system::System;
use moreau_contact::{ContactSolution, ContactSolver, SemismoothNewton};
use moreau_laws::{Local, Status};
use moreau_mesh::Mesh;
use nalgebra::{DMatrix, SVector};
use std::collections::BTreeMap;

/// Where the contact problem is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Nesting {
    /// Inside every Newton iteration on the bulk, condensed on the interface.
    Inside,
    /// Around the nonlinear solve, as in the paper: Uzawa's prediction and correction \[90′\] with
    /// one nonlinear problem under frozen contact forces per iteration. The contact method of the
    /// settings is not used. Bodies must be held without contact.
    Outside {
        /// Natural-map residual at which the increment is accepted, over the largest force.
        tolerance: f64,
        /// Outer iterations after which an increment fails.
        iterations: usize,
    },
}

/// How increments are solved. The defaults need no change: no number here decides the answer.
#[derive(Debug)]
pub struct Settings<const D: usize> {
    /// Method for the contact problem.
    pub contact: Box<dyn ContactSolver<D>>,
    /// Where the contact problem is solved.
    pub nesting: Nesting,
    /// Out-of-balance force at which an increment is accepted, over the largest nodal force.
    pub tolerance: f64,
    /// Newton iterations after which an increment is cut.
    pub iterations: usize,
    /// Times an increment may be halved before the step stops.
    pub cuts: usize,
}

impl<const D: usize> Default for Settings<D> {
    fn default() -> Self {
        Self {
            contact: Box::new(SemismoothNewton::default()),
            nesting: Nesting::Inside,
            tolerance: 1e-10,
            iterations: 40,
            cuts: 10,
        }
    }
}

/// The state of a model between increments: one value, replaced when an increment is committed.
#[derive(Debug, Clone)]
pub(crate) struct State<const D: usize> {
    pub(crate) increment: usize,
    /// Displacement at every degree of freedom \[mm\].
    pub(crate) displacement: Vec<f64>,
    /// Displacement increment of the last increment, and the loading that it answered.
    pub(crate) last: Option<(Vec<f64>, Loading<D>)>,
    /// Internal force at every degree of freedom \[N\].
    pub(crate) internal: Vec<f64>,
    pub(crate) loading: Loading<D>,
    pub(crate) energies: Energies,
    pub(crate) contacts: Vec<ContactRecord<D>>,
    /// Last solution of the contact problem, to start the next from.
    pub(crate) solution: Option<ContactSolution<D>>,
}

/// A model under load. See the crate's documentation for an example.
pub struct Driver<const D: usize> {
    pub(crate) mesh: Mesh<D>,
    pub(crate) blocks: Vec<Box<dyn Block<D>>>,
    pub(crate) tools: Vec<Tool<D>>,
    pub(crate) points: Vec<ContactPoint<D>>,
    pub(crate) settings: Settings<D>,
    pub(crate) state: State<D>,
    pub(crate) system: Option<System>,
    measure: Box<dyn Measure<D>>,
    contacts: Vec<ContactName>,
}

impl<const D: usize> Driver<D> {
    /// The virgin state of a model.
    ///
    /// # Errors
    /// [`ModelError::MissingMaterial`].
    pub fn new<H: Analysis<D>>(
        model: Model<D, H>,
        settings: Settings<D>,
    ) -> Result<Self, ModelError> {
        model.check()?;
        let dofs = D * model.mesh.nodes().len();
        let rest = |p: &ContactPoint<D>| ContactRecord {
            contact: p.contact,
            node: p.node,
            position: model.mesh.nodes()[p.node],
            kind: p.kind,
            u: Local::zeros(),
            t: Local::zeros(),
            force: SVector::zeros(),
            area: p.area,
            status: Status::Open,
            held: false,
            spring: Local::zeros(),
        };
        let state = State {
            increment: 0,
            displacement: vec![0.0; dofs],
            last: None,
            internal: vec![0.0; dofs],
            loading: Loading::none(dofs, model.tools.len()),
            energies: Energies::default(),
            contacts: model.points.iter().map(rest).collect(),
            solution: None,
        };
        Ok(Self {
            measure: Box::new(model.hypothesis),
            mesh: model.mesh,
            blocks: model.blocks,
            tools: model.tools,
            contacts: model.contacts,
            points: model.points,
            settings,
            state,
            system: None,
        })
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh<D> {
        &self.mesh
    }

    /// Displacement of a node since the virgin state \[mm\].
    pub fn displacement(&self, node: usize) -> SVector<f64, D> {
        SVector::from_column_slice(&self.state.displacement[D * node..D * node + D])
    }

    /// Increments converged so far.
    pub fn increments(&self) -> usize {
        self.state.increment
    }

    /// Unknowns of the current step; 0 before the first.
    pub fn unknowns(&self) -> usize {
        self.system.as_ref().map_or(0, System::size)
    }

    /// Contact points, in the order of the contacts and of the nodes in each.
    pub fn contacts(&self) -> &[ContactRecord<D>] {
        &self.state.contacts
    }

    /// Names of surface and tool of a contact.
    pub fn contact_name(&self, contact: usize) -> (&str, &str) {
        (
            &self.contacts[contact].surface,
            &self.contacts[contact].tool,
        )
    }

    /// Energies since the virgin state.
    pub fn energies(&self) -> Energies {
        self.state.energies
    }

    /// Committed state at all quadrature points, cells in the order of their blocks.
    pub fn points(&self) -> Vec<PointState<D>> {
        self.blocks.iter().flat_map(|b| b.points()).collect()
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
    pub fn nodal_reaction(&self, node: usize) -> SVector<f64, D> {
        let state = &self.state;
        let contact = state.contacts.iter().find(|c| c.node == node);
        let contact = contact.map_or_else(SVector::zeros, |c| c.force);
        SVector::from_fn(|i, _| {
            let dof = D * node + i;
            match state.loading.displacement.contains_key(&dof) {
                true => state.internal[dof] - state.loading.force[dof] - contact[i],
                false => 0.0,
            }
        })
    }

    /// Sum of the forces that a tool exerts on the body \[N\].
    ///
    /// # Errors
    /// [`ModelError::UnknownTool`].
    pub fn tool_force(&self, name: &str) -> Result<SVector<f64, D>, ModelError> {
        let tool = self.tool_index(name)?;
        let touches = |(p, _): &(&ContactPoint<D>, &ContactRecord<D>)| p.tool == tool;
        let pairs = self.points.iter().zip(&self.state.contacts);
        Ok(pairs.filter(touches).map(|(_, c)| c.force).sum())
    }

    fn tool_index(&self, name: &str) -> Result<usize, ModelError> {
        let names = || self.tools.iter().map(|t| t.name.as_str());
        names()
            .position(|n| n == name)
            .ok_or_else(|| ModelError::UnknownTool {
                name: name.into(),
                nearest: moreau_mesh::nearest(name, names()).map(Into::into),
            })
    }

    /// The loading at the end of a step.
    ///
    /// # Errors
    /// Unknown groups and tools, displacements prescribed twice, numbers that are not finite.
    pub fn loading(&self, step: &Step<D>) -> Result<Loading<D>, ModelError> {
        let mesh = &self.mesh;
        let mut loading = Loading::none(self.state.displacement.len(), self.tools.len());
        // A tool that is not mentioned stays where it is.
        loading.tools.clone_from(&self.state.loading.tools);
        let mut add = |node: usize, share: f64, vector: &[f64; D]| {
            for i in 0..D {
                loading.force[D * node + i] += share * vector[i];
            }
        };
        let mut moved: BTreeMap<usize, f64> = BTreeMap::new();
        for condition in &step.conditions {
            match condition {
                Condition::Displace { on, axis, value } => {
                    if axis.index() >= D {
                        return Err(ModelError::OutOfRange {
                            what: format!("direction of the displacement of {on:?}"),
                            value: axis.index() as f64,
                            expected: "a direction below the dimension of the model",
                        });
                    }
                    for node in mesh.node_group(on)? {
                        let dof = D * node + axis.index();
                        if let Some(&first) = moved.get(&dof)
                            && first != *value
                        {
                            return Err(ModelError::TwoDisplacements {
                                step: step.name.clone(),
                                node,
                                axis: axis_letter(axis.index()),
                                first,
                                second: *value,
                            });
                        }
                        moved.insert(dof, *value);
                    }
                }
                Condition::Force { on, force } => {
                    let nodes = mesh.node_group(on)?;
                    for &node in &nodes {
                        add(node, 1.0 / nodes.len() as f64, force);
                    }
                }
                Condition::Pressure { on, pressure } => {
                    for s in self.measure.facet_shares(mesh, mesh.facet_group(on)?) {
                        add(s.node, -pressure, &s.normal);
                    }
                }
                Condition::Traction { on, traction } => {
                    for s in self.measure.facet_shares(mesh, mesh.facet_group(on)?) {
                        add(s.node, s.area, traction);
                    }
                }
                Condition::BodyForce { on, density } => {
                    for (node, share) in self.measure.volume_shares(mesh, mesh.cell_group(on)?) {
                        add(node, share, density);
                    }
                }
                Condition::Tool { .. } => {}
            }
        }
        for condition in &step.conditions {
            if let Condition::Tool { name, displacement } = condition {
                loading.tools[self.tool_index(name)?] = SVector::from(*displacement);
            }
        }
        loading.displacement = moved;
        loading.check()?;
        Ok(loading)
    }

    /// The loading that holds now, with the prescribed displacements of `end`: those that are new
    /// start where the body is, and the reactions of those released become forces.
    fn start_of(&self, end: &Loading<D>) -> Loading<D> {
        let state = &self.state;
        let mut start = state.loading.clone();
        for dof in state.loading.displacement.keys() {
            if !end.displacement.contains_key(dof) {
                start.force[*dof] += self.nodal_reaction(dof / D)[dof % D];
            }
        }
        start.displacement = end
            .displacement
            .keys()
            .map(|&dof| (dof, state.displacement[dof]))
            .collect();
        start
    }

    /// Applies a step in increments, a number of equal ones or [`Increments`], halving those that
    /// fail and doubling again after those that converge. `observe` sees the driver after every
    /// converged increment.
    ///
    /// # Errors
    /// [`StepError::Stopped`] when an increment has been halved as often as the settings allow;
    /// the increments that converged are kept. [`StepError::Model`] for a step that makes no sense.
    pub fn run(
        &mut self,
        step: &Step<D>,
        increments: impl Into<Increments>,
        mut observe: impl FnMut(&Self, &StepReport),
    ) -> Result<Vec<StepReport>, StepError> {
        let end = self.loading(step)?;
        let start = self.start_of(&end);
        let increments: Increments = increments.into();
        let pieces = increments.pieces();
        let base = 1.0 / pieces as f64;
        let fewest = increments.start * 0.5f64.powi(self.settings.cuts as i32);
        let smallest = increments.min.unwrap_or(fewest);
        let mut reports: Vec<StepReport> = Vec::new();
        let (mut done, mut length) = (0.0f64, increments.start);
        let (mut cuts, mut easy) = (0, 0);
        // Whole pieces are counted, so that their ends are exact multiples of the base.
        let mut whole = 0;
        while whole < pieces {
            let next = (whole + 1) as f64 * base;
            let at_end = done + length >= next - 1e-9 * base;
            let target = match at_end {
                true if whole + 1 == pieces => 1.0,
                true => next,
                false => done + length,
            };
            match self.advance(&start.towards(&end, target)) {
                Ok(mut report) => {
                    report.fraction = target;
                    report.cuts = cuts;
                    observe(self, &report);
                    reports.push(report);
                    done = target;
                    whole += usize::from(at_end);
                    let iterations = reports.last().map_or(0, |r| r.newton_iterations);
                    length = increments.next(length, &mut easy, iterations);
                    cuts = 0;
                }
                Err(error @ StepError::Model(_)) => return Err(error),
                Err(cause) => {
                    // Halved exactly, and until it is not what has just failed.
                    length *= 0.5;
                    while length >= (1.0 - 1e-9) * (target - done) {
                        length *= 0.5;
                    }
                    cuts += 1;
                    if length < smallest {
                        let last = reports.last().map_or(0.0, |r| r.plastic_fraction);
                        let plastic_fraction = match &cause {
                            StepError::NotConverged {
                                plastic_fraction, ..
                            } => plastic_fraction.max(last),
                            _ => last,
                        };
                        return Err(StepError::Stopped {
                            step: step.name.clone(),
                            reached: done,
                            smallest: 2.0 * length,
                            plastic_fraction,
                            cause: Box::new(cause),
                        });
                    }
                }
            }
        }
        Ok(reports)
    }

    /// Applies one increment, up to the loading `end`: commits it, or fails and changes nothing.
    ///
    /// # Errors
    /// See [`StepError`].
    pub fn advance(&mut self, end: &Loading<D>) -> Result<StepReport, StepError> {
        end.check()?;
        let mut system = self.prepare(end)?;
        let start = self.start_of(end);
        let outcome = match self.settings.nesting {
            Nesting::Inside => self.increment(&mut system, &start, end, &mut |_, _| {}),
            Nesting::Outside {
                tolerance,
                iterations,
            } => self.nested_increment(&mut system, &start, end, tolerance, iterations),
        };
        self.system = Some(system);
        outcome
    }

    /// The linear system for the prescribed degrees of freedom of a loading: the one at hand, or
    /// a new one if they have changed.
    pub(crate) fn prepare(&mut self, loading: &Loading<D>) -> Result<System, ModelError> {
        let fixed = |dof: usize| loading.displacement.contains_key(&dof);
        let dofs = self.state.displacement.len();
        if let Some(system) = self
            .system
            .take_if(|s| (0..dofs).all(|d| s.is_free(d) != fixed(d)))
        {
            return Ok(system);
        }
        self.check_rigid_motions(&fixed)?;
        let interface: Vec<usize> = self.points.iter().map(|p| p.node).collect();
        let mut system = System::new(&self.mesh, &self.blocks, fixed, &interface)?;
        let zero = vec![0.0; dofs];
        system.assemble(&mut self.blocks, &zero, &zero, Stiffness::Blended(1.0));
        system.scale(self.settings.nesting == Nesting::Inside);
        Ok(system)
    }

    /// Checks that every rigid motion of every body is resisted by the prescribed displacements of
    /// a loading, by a contact normal, or by friction; nothing is solved.
    ///
    /// # Errors
    /// [`ModelError::FreeRigidMotion`].
    pub fn check_supports(&self, loading: &Loading<D>) -> Result<(), ModelError> {
        self.check_rigid_motions(&|dof| loading.displacement.contains_key(&dof))
    }

    /// Every rigid motion of every body must be resisted by a prescribed displacement, by a
    /// contact normal, or by friction.
    fn check_rigid_motions(&self, fixed: &impl Fn(usize) -> bool) -> Result<(), ModelError> {
        let size = self.mesh.size();
        let mut body_of = vec![usize::MAX; self.mesh.nodes().len()];
        let bodies = self.mesh.bodies();
        for (b, cells) in bodies.iter().enumerate() {
            for &cell in cells {
                for &node in self.mesh.cell_nodes(cell) {
                    body_of[node] = b;
                }
            }
        }
        for (b, cells) in bodies.iter().enumerate() {
            let first = cells[0];
            let center = self.mesh.nodes()[self.mesh.cell_nodes(first)[0]];
            // Modes about a point of the body, in its size: numbers of order one.
            let modes = |node: usize| -> Vec<SVector<f64, D>> {
                let x = self.mesh.nodes()[node];
                let relative = std::array::from_fn(|i| (x[i] - center[i]) / size);
                self.measure
                    .rigid_modes(&relative)
                    .into_iter()
                    .map(SVector::from)
                    .collect()
            };
            let count = modes(self.mesh.cell_nodes(first)[0]).len();
            let mut gram = DMatrix::<f64>::zeros(count, count);
            let mut resist = |node: usize, direction: &SVector<f64, D>| {
                let rows: Vec<f64> = modes(node).iter().map(|m| m.dot(direction)).collect();
                for i in 0..count {
                    for j in 0..count {
                        gram[(i, j)] += rows[i] * rows[j];
                    }
                }
            };
            for node in (0..body_of.len()).filter(|&a| body_of[a] == b) {
                for i in (0..D).filter(|i| fixed(D * node + i)) {
                    let mut axis = SVector::<f64, D>::zeros();
                    axis[i] = 1.0;
                    resist(node, &axis);
                }
            }
            for point in self.points.iter().filter(|p| body_of[p.node] == b) {
                let x = SVector::from(self.mesh.nodes()[point.node])
                    + self.displacement(point.node)
                    - self.state.loading.tools[point.tool];
                let q = moreau_contact::frame(&self.tools[point.tool].obstacle.normal(&x));
                let columns = if point.law.friction() > 0.0 { D } else { 1 };
                for k in 0..columns {
                    resist(point.node, &q.column(k).into_owned());
                }
            }
            let eigen = gram.symmetric_eigen();
            let weakest = eigen.eigenvalues.imin();
            if eigen.eigenvalues[weakest] <= 1e-10 * eigen.eigenvalues.amax().max(1.0) {
                let mode = eigen.eigenvectors.column(weakest);
                let motion = describe::<D>(mode.as_slice());
                return Err(ModelError::FreeRigidMotion {
                    cell: first,
                    motion,
                });
            }
        }
        Ok(())
    }
}

/// A rigid motion in words, from its components on translations first, rotations after.
fn describe<const D: usize>(mode: &[f64]) -> String {
    let largest = mode.iter().map(|c| c.abs()).fold(0.0, f64::max);
    let name = |k: usize| match k {
        _ if mode.len() == 1 => "translation along y".into(),
        k if k < D => format!("translation along {}", axis_letter(k)),
        k if D == 3 => format!("rotation about {}", axis_letter(k - D)),
        _ => "rotation in the plane".into(),
    };
    let parts: Vec<String> = (0..mode.len())
        .filter(|&k| mode[k].abs() > 0.1 * largest)
        .map(name)
        .collect();
    parts.join(" with ")
}
