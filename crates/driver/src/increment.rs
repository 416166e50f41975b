//! One increment by Newton's method with the contact problem solved inside every iteration; not
//! the sequence of increments.

use crate::block::Stiffness;
use crate::chord::Chord;
use crate::control::Control;
use crate::driver::Driver;
use crate::error::{Imbalance, ModelError, StepError};
use crate::interface::Kinematics;
use crate::iterate::{Iterate, slack};
use crate::line_search::Line;
use crate::linearised::Linearised;
use crate::load::{Loading, axis_letter};
use crate::norm::largest;
use crate::report::{Iteration, StepReport};
use crate::sparse::Sparse;
use crate::system::System;
use moreau_contact::{ContactError, ContactSolution};
use std::borrow::Cow;

/// What an increment has counted.
#[derive(Debug, Default)]
pub(crate) struct Counts {
    pub(crate) newton: usize,
    pub(crate) solves: usize,
    pub(crate) contact: usize,
    /// Iterations of the contact solver in the last solve.
    pub(crate) last_contact: usize,
    pub(crate) shortened: usize,
    pub(crate) factorisations: usize,
    /// Iterations of conjugate gradients, and steps for what a symmetric tangent lacks.
    pub(crate) linear: usize,
    /// [`StepReport::contact_solves`].
    pub(crate) contact_solves: usize,
    pub(crate) residuals: Vec<f64>,
    /// [`StepReport::criticality`].
    pub(crate) criticality: Option<(usize, f64)>,
    /// Whether the statuses have left a rigid motion free on the way.
    pub(crate) undetermined: bool,
}

impl Counts {
    /// Whether the last step has left about as much out of balance as the one before.
    fn no_longer_improves(&self) -> bool {
        match self.residuals.as_slice() {
            [.., before, now] => *now >= 0.25 * before,
            _ => false,
        }
    }
}

/// A converged increment, not yet committed.
pub(crate) struct Candidate<const D: usize> {
    pub(crate) d_u: Vec<f64>,
    pub(crate) internal: Vec<f64>,
    pub(crate) kinematics: Vec<Kinematics<D>>,
    /// Forces and statuses; the displacements are those of the linearised problem.
    pub(crate) solution: ContactSolution<D>,
    pub(crate) out_of_balance: f64,
    pub(crate) counts: Counts,
}

/// Where an increment begins.
pub(crate) struct Start {
    /// The degrees of freedom that are prescribed.
    pub(crate) held: Vec<usize>,
    /// Prescribed displacements that the first iterate does not have.
    pub(crate) missing: Sparse,
    pub(crate) now: Iterate,
    /// Factorisations, and iterations of conjugate gradients, done before.
    pub(crate) done: (usize, usize),
}

/// How far an increment may move anything, in sizes of the mesh, of what it prescribes and of the
/// widest gap.
const FARTHEST: f64 = 10.0;

/// Part of the tolerance at which an increment with tied contacts is accepted as long as steps make the
/// imbalance smaller.
const WELL: f64 = 0.1;

/// Parts of what flow adds to the stiffness that are tried in turn where the tangent is a mechanism.
const BLENDS: [f64; 4] = [1.0 - 1e-4, 0.99, 0.8, 0.0];

impl<const D: usize> Driver<D> {
    /// Applies the increment from one loading to another and commits it; `watch` sees every
    /// iterate.
    pub(crate) fn increment(
        &mut self,
        system: &mut System,
        start: &Loading<D>,
        end: &Loading<D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>),
    ) -> Result<StepReport, StepError> {
        let guess = self.predictor(start, end);
        let candidate = self.balance(system, (start, end), guess, None, watch)?;
        self.check_passage(&candidate.d_u)?;
        self.commit(start, end, candidate)
    }

    /// Finds the equilibrium at the end of an increment from a first guess of its displacements.
    /// Under control the loading at the end is a first guess too.
    pub(crate) fn balance(
        &mut self,
        system: &mut System,
        (start, end): (&Loading<D>, &Loading<D>),
        guess: Vec<f64>,
        mut control: Option<&mut Control<'_>>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>),
    ) -> Result<Candidate<D>, StepError> {
        let mut end = Cow::Borrowed(end);
        let Start {
            held,
            mut missing,
            mut now,
            done,
        } = self.first_iterate(system, (start, &end), guess);
        let mut counts = Counts {
            solves: 1,
            ..Counts::default()
        };
        let mut solution = self.state.solution.clone();
        let mut chord = Chord::default();
        loop {
            // The step to come makes up for what is missing.
            let arrived = missing.is_zero();
            let kinematics = if arrived {
                self.kinematics(system, &end, &now.d_u)
            } else {
                let mut reached = now.d_u.clone();
                missing.add_to(&mut reached, 1.0);
                self.kinematics(system, &end, &reached)
            };
            if now.part >= 1.0
                && let Some(s) = &solution
            {
                // The normals may have turned with the step.
                now.contact = self.contact_forces(&kinematics, &s.force);
            }
            let residual = now.imbalance(&end, &held);
            let out_of_balance = largest(residual.iter().copied());
            let scale = self.force_scale(&now.assembly, &end, &now.contact);
            if counts.newton > 0 {
                counts.residuals.push(out_of_balance);
            }
            let iteration = Iteration {
                increment: self.state.increment + 1,
                cuts: 0,
                newton: counts.newton,
                contact_iterations: counts.last_contact,
                out_of_balance,
                scale,
                d_u: &now.d_u[..self.mesh_dofs()],
                residual: &residual[..self.mesh_dofs()],
                status: solution.as_ref().map_or(&[], |s| &s.status),
            };
            watch(self, &iteration);
            // Forces of an iterative contact solver are out of balance by what it left.
            let left = solution.as_ref().map_or(0.0, slack);
            let balance = self.target(system, scale, &now.d_u) + left;
            // Ties round off more than forces do: what another step makes smaller is no rounding yet.
            let rounded = !system.is_tied()
                || out_of_balance <= WELL * self.settings.tolerance * scale
                || counts.no_longer_improves();
            let balanced = now.part >= 1.0
                && out_of_balance <= balance
                && rounded
                && self.is_near(system, &now.d_u, (start, &end));
            if balanced
                && let Some(s) = solution.take_if(|s| self.law_holds(system, &kinematics, s, scale))
            {
                counts.factorisations = system.factorisations - done.0;
                counts.linear += system.conjugate - done.1;
                let candidate = Candidate {
                    d_u: now.d_u,
                    internal: now.assembly.internal,
                    kinematics,
                    solution: s,
                    out_of_balance,
                    counts,
                };
                return Ok(candidate);
            }
            if counts.newton >= self.settings.iterations && counts.undetermined {
                // The motion that the statuses left free has no end.
                let (iteration, source) = (counts.newton, ContactError::Singular);
                return Err(StepError::Contact { iteration, source });
            }
            if counts.newton >= self.settings.iterations || !out_of_balance.is_finite() {
                return Err(self.not_converged(&residual, counts.newton, balance));
            }
            let imbalance = match arrived {
                true => out_of_balance,
                false => now.once_arrived(&residual),
            };
            drop(residual);
            counts.newton += 1;

            let worth = system.steps_per_factorisation();
            // What a symmetric tangent lacks is that of its own iterate.
            let symmetric = self.is_symmetric();
            let fresh = !(symmetric && arrived && chord.serves(out_of_balance, balance, worth));
            if fresh {
                self.linearise(system, &mut now, &missing)?;
            }
            chord.begin(out_of_balance, fresh);
            let mut load = now.assembly.load(&[&end.force]);
            let missing = std::mem::take(&mut missing);
            // What a tool has moved is missing in the first iterate as well.
            let tools = self.mesh_dofs()..;
            let moved = counts.newton == 1
                && !(start.displacement.range(tools.clone())).eq(end.displacement.range(tools));
            let complete = !moved && arrived;
            // Where the step is linear it may be the last.
            let exact = !now.assembly.flows || control.is_some();
            let enough = match exact {
                true => 0.0,
                false => chord.contact_residual(imbalance, balance),
            };
            let accuracy = (chord.contact_residual(imbalance, balance), balance);
            let mut unsymmetric = self.unsymmetric(system, &now, imbalance, accuracy);
            let (step, growth, target) = loop {
                let linearised = Linearised {
                    kinematics: &kinematics,
                    loading: &end,
                    missing: &missing,
                    guess: solution.as_ref(),
                    border: control
                        .as_ref()
                        .map(|c| (c.load, c.compliance, c.missing(&now.d_u))),
                    enough,
                };
                let load = match &unsymmetric {
                    None => std::mem::take(&mut load),
                    Some(u) => u.load(&load),
                };
                let answer = self.answer(system, &linearised, load, &mut counts)?;
                let target = self.contact_forces(&kinematics, &answer.solution.force);
                solution = Some(answer.solution);
                if self.settles(&mut unsymmetric, &now, &answer.step, &held) {
                    break (answer.step, answer.growth, target);
                }
                counts.linear += 1;
            };
            let slack = solution.as_ref().map_or(0.0, slack);
            let elastic = system.holds_elastic_factor() && !now.assembly.flows;
            let line = Line {
                tangent: !(elastic || symmetric && chord.may_serve(balance, worth)),
                allowed: self.allowed(&counts.residuals),
                end: &end,
                growth: control
                    .as_ref()
                    .map_or_else(Sparse::default, |c| c.load.scaled(growth)),
                held: &held,
                step: &step,
                target: &target,
                complete,
                slack,
            };
            now = self.search(system, &line, now);
            chord.taken(now.part);
            counts.shortened += usize::from(now.part < 1.0);
            if let Some(control) = &mut control {
                control.factor += now.part * growth;
                end = Cow::Owned(control.loading(start));
            }
        }
    }

    /// The first iterate, at a guess of the displacement increments and under the committed contact
    /// forces.
    pub(crate) fn first_iterate(
        &mut self,
        system: &mut System,
        (start, end): (&Loading<D>, &Loading<D>),
        mut d_u: Vec<f64>,
    ) -> Start {
        // Tools resist nothing: they are where they shall be from the first.
        for (&dof, u) in end.displacement.range(self.mesh_dofs()..) {
            d_u[dof] = u - start.displacement.get(&dof).unwrap_or(u);
        }
        let missing = self.missing(start, end, &d_u);
        system.untie();
        Start {
            held: system.held_dofs(),
            now: Iterate {
                assembly: system.assemble(
                    &mut self.blocks,
                    &d_u,
                    &missing,
                    Stiffness::Plastic(1.0),
                ),
                d_u,
                contact: self.state.contact.clone(),
                part: 0.0,
            },
            missing,
            done: (system.factorisations, system.conjugate),
        }
    }

    /// Out-of-balance force at which an increment is accepted \[N\]: the tolerance, or the rounding of
    /// internal forces where the body moves almost rigidly, or is let go: a stress that has vanished is
    /// what rounding left of the largest so far.
    pub(crate) fn target(&self, system: &System, scale: f64, d_u: &[f64]) -> f64 {
        // Of the size of the mesh, no position has a smaller part.
        let (size, moved) = (self.mesh.size(), &d_u[..self.mesh_dofs()]);
        let motion = largest(moved.iter().copied()).max(self.state.farthest);
        let motion = motion.clamp(f64::EPSILON * size, size);
        let rounding = 64.0 * f64::EPSILON * system.stiffest() * motion;
        (self.settings.tolerance * scale).max(rounding)
    }

    /// Whether nothing has gone so far that forces are rounding: what slides away is in balance with
    /// anything there. What falls may go as far as to what stops it.
    fn is_near(
        &self,
        system: &System,
        d_u: &[f64],
        (start, end): (&Loading<D>, &Loading<D>),
    ) -> bool {
        let moved = largest(d_u[..self.mesh_dofs()].iter().copied());
        let prescribed = end.displacement.iter();
        let told = largest(prescribed.map(|(dof, u)| u - start.displacement.get(dof).unwrap_or(u)));
        let reach = self.mesh.size() + told;
        moved <= FARTHEST * reach || {
            let before = self.kinematics(system, start, &vec![0.0; d_u.len()]);
            let gap = largest(before.iter().map(|k| k.u[0]));
            moved <= FARTHEST * (reach + gap)
        }
    }

    /// Makes the system that of the tangent at an iterate: factorised, where contacts are not tied in its
    /// factor.
    pub(crate) fn linearise(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        missing: &Sparse,
    ) -> Result<(), StepError> {
        if !system.is_tied() {
            return self.factorise(system, now, missing);
        }
        if !now.assembly.stiffness {
            let tangent = Stiffness::Plastic(1.0);
            now.assembly = system.assemble(&mut self.blocks, &now.d_u, missing, tangent);
        }
        Ok(())
    }

    /// Factorises the tangent at an iterate. Where that is a mechanism, as a plastic tangent may be
    /// far from the solution, more and more of the elastic stiffness is blended in: the step is
    /// then shorter and still downhill.
    pub(crate) fn factorise(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        missing: &Sparse,
    ) -> Result<(), StepError> {
        let elastic = !now.assembly.flows;
        if !(now.assembly.stiffness || elastic && system.holds_elastic_factor()) {
            let tangent = Stiffness::Plastic(1.0);
            now.assembly = system.assemble(&mut self.blocks, &now.d_u, missing, tangent);
        }
        let mut outcome = system.factorise(elastic);
        for part in BLENDS {
            if outcome.is_ok() {
                break;
            }
            let blended = Stiffness::Plastic(part);
            now.assembly = system.assemble(&mut self.blocks, &now.d_u, missing, blended);
            outcome = system.factorise(false);
        }
        if let Err(dof) = outcome
            && let Some(tool) = (dof / D).checked_sub(self.mesh.nodes().len())
        {
            let tool = self.tools[tool].name.clone();
            let motion = format!("translation along {}", axis_letter(dof % D));
            return Err(ModelError::FreeTool { tool, motion }.into());
        }
        outcome.map_err(|dof| StepError::Mechanism {
            node: dof / D,
            axis: axis_letter(dof % D),
            position: self.mesh.nodes()[dof / D].to_vec(),
        })
    }

    /// First guess of the displacement increments: the last increment again, as far as the load
    /// goes on in the same direction, else nothing.
    pub(crate) fn predictor(&self, start: &Loading<D>, end: &Loading<D>) -> Vec<f64> {
        let zero = || vec![0.0; self.state.displacement.len()];
        let Some((last, before)) = &self.state.last else {
            return zero();
        };
        let ratio = end.increment_from(start).ratio(before);
        let same = end.displacement.keys().eq(before.displacement.keys());
        if same && ratio > 0.0 && ratio <= 4.0 {
            last.iter().map(|u| ratio * u).collect()
        } else {
            zero()
        }
    }

    /// Prescribed displacement increments that `d_u` does not have yet \[mm\].
    pub(crate) fn missing(&self, start: &Loading<D>, end: &Loading<D>, d_u: &[f64]) -> Sparse {
        let mut missing = Sparse::default();
        for (&dof, &u) in &end.displacement {
            let increment = u - start.displacement.get(&dof).copied().unwrap_or(u);
            missing.add(dof, increment - d_u[dof]);
        }
        missing
    }

    pub(crate) fn not_converged(
        &self,
        residual: &[f64],
        iterations: usize,
        target: f64,
    ) -> StepError {
        StepError::NotConverged {
            iterations,
            out_of_balance: largest(residual.iter().copied()),
            tolerance: target,
            worst: self.worst(&residual[..self.mesh_dofs()]),
            plastic_fraction: self.plastic_fraction(),
        }
    }

    /// The five nodes with the largest force that nothing balances, worst first; `residual` has an
    /// entry for every degree of freedom \[N\].
    pub fn worst(&self, residual: &[f64]) -> Vec<Imbalance> {
        let norm = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>().sqrt();
        let force: Vec<f64> = residual.chunks(D).map(norm).collect();
        let mut order: Vec<usize> = (0..force.len()).collect();
        order.sort_by(|&a, &b| force[b].total_cmp(&force[a]));
        let imbalance = |&node: &usize| Imbalance {
            node,
            position: self.mesh.nodes()[node].to_vec(),
            force: force[node],
        };
        order.iter().take(5).map(imbalance).collect()
    }
}
