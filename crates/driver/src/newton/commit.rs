//! A converged increment becomes the state of the driver, with its energies and its certificate; not
//! how it converged.

use crate::driver::{Driver, State};
use crate::error::StepError;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::newton::candidate::Candidate;
use crate::report::{ContactRecord, Energies, StepReport};
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_contact::Certificate;
use moreau_laws::{Local, Status};
use nalgebra::SVector;

impl<const D: usize> Driver<D> {
    pub(crate) fn plastic_fraction(&self) -> f64 {
        let energies = self.blocks.iter().map(|b| b.energy());
        let (flow, all) =
            energies.fold((0.0, 0.0), |(f, a), e| (f + e.plastic_volume, a + e.volume));
        fraction(flow, all)
    }

    /// Makes a converged increment the state of the driver.
    ///
    /// # Errors
    /// [`StepError::NotFinite`] for what numbers do not hold; nothing has changed then.
    pub(crate) fn commit(
        &mut self,
        start: &Loading<D>,
        end: &Loading<D>,
        candidate: Candidate<D>,
    ) -> Result<StepReport, StepError> {
        let Candidate {
            d_u,
            internal,
            kinematics,
            solution,
            out_of_balance,
            counts,
        } = candidate;
        let laws: Vec<_> = kinematics.iter().map(|k| k.law).collect();
        let mut irreversible = Vec::with_capacity(kinematics.len());
        let mut contacts = Vec::with_capacity(kinematics.len());
        let mut corners = Vec::new();
        let mut friction = 0.0;
        let mut penalty = 0.0;
        let (mut open, mut stick, mut slip) = (0, 0, 0);
        for (i, (p, k)) in self.points.iter().zip(&kinematics).enumerate() {
            let mut u = k.u;
            u[0] = k.gap;
            let mut t = solution.force[i];
            for j in 0..D {
                if !k.active[j] {
                    t[j] = 0.0;
                    if j > 0 {
                        u[j] = 0.0;
                    }
                }
            }
            let elastic = solution.irreversible[i] - solution.displacement[i];
            let obeying = u + elastic;
            friction -= (1..D).map(|j| t[j] * obeying[j]).sum::<f64>();
            // Springs in series: ½ t·C t, with C t₀* the part they held before.
            let before = k.local_force(&self.state.contacts[i].force);
            penalty += 0.5 * elastic[0] * t[0];
            penalty += (1..D)
                .map(|j| 0.5 * elastic[j] * (t[j] + before[j]))
                .sum::<f64>();
            penalty -= 0.5 * self.state.contacts[i].t[0] * self.state.contacts[i].spring[0];
            irreversible.push(obeying);
            // A point that is held along one tangent of a surface in space slips along the other.
            let held = !(1..D).any(|j| k.active[j]);
            let status = match solution.status[i] {
                Status::Slip if held => Status::Stick,
                other => other,
            };
            match status {
                Status::Open => open += 1,
                Status::Stick if !held => stick += 1,
                Status::Slip if !held => slip += 1,
                _ => {}
            }
            if k.at_corner && status != Status::Open {
                corners.push(i);
            }
            contacts.push(ContactRecord {
                contact: p.contact,
                node: p.node,
                position: self.mesh.nodes()[p.node],
                kind: p.kind,
                u,
                t,
                force: k.force(&t),
                area: self.footings[i].area,
                status,
                held,
                spring: elastic,
            });
        }
        let forces: Vec<Local<D>> = contacts.iter().map(|c| c.t).collect();
        let certificate = Certificate::new(&laws, &irreversible, &forces);
        let contact = self.contact_forces(&kinematics, &forces);
        let mut energies = self.state.energies;
        energies.external_work += self.external_work(start, end, &d_u, &internal, &contact)
            + self.closing_work(&kinematics, &contacts, &d_u);
        energies.friction_dissipation += friction;
        energies.penalty += penalty;
        energies.stored = 0.0;
        let (mut plastic_volume, mut volume) = (0.0, 0.0);
        for block in &self.blocks {
            let energy = block.energy();
            energies.stored += energy.stored;
            energies.plastic_dissipation += energy.dissipated;
            plastic_volume += energy.plastic_volume;
            volume += energy.volume;
        }
        let plastic_fraction = fraction(plastic_volume, volume);
        all_finite(&energies, &certificate, &d_u)?;
        for block in &mut self.blocks {
            block.commit();
        }
        let mut displacement = self.state.displacement.clone();
        for (u, d) in displacement.iter_mut().zip(&d_u) {
            *u += d;
        }
        // Prescribed values exactly, not as sums of increments.
        for (&dof, &u) in &end.displacement {
            displacement[dof] = u;
        }
        let last = self.repeatable(d_u, end);
        let moved = largest(displacement[..self.mesh_dofs()].iter().copied());
        self.state = State {
            increment: self.state.increment + 1,
            displacement,
            last: Some((last, end.increment_from(start))),
            internal,
            loading: end.clone(),
            energies,
            contacts,
            contact,
            farthest: moved.max(self.state.farthest),
            solution: Some(solution),
        };
        Ok(StepReport {
            increment: self.state.increment,
            fraction: 1.0,
            newton_iterations: counts.newton,
            nonlinear_solves: counts.solves,
            contact_iterations: counts.contact,
            factorisations: counts.factorisations,
            linear_iterations: counts.linear,
            contact_solves: counts.contact_solves,
            shortened_steps: counts.shortened,
            cuts: 0,
            open,
            stick,
            slip,
            plastic_fraction,
            energies,
            certificate,
            criticality: counts.criticality,
            free_motions: match counts.undetermined {
                true => self.free_motions(),
                false => Vec::new(),
            },
            corners,
            out_of_balance,
            residuals: counts.residuals,
        })
    }

    /// Work over the increment of applied forces and reactions, by the trapezoidal rule.
    fn external_work(
        &self,
        start: &Loading<D>,
        end: &Loading<D>,
        d_u: &[f64],
        internal: &[f64],
        contact: &SparseVector,
    ) -> f64 {
        let state = &self.state;
        let mean = start.force.with(&end.force, |a, b| 0.5 * (a + b));
        let mut work = mean.dot(d_u);
        for &dof in end.displacement.keys() {
            let before = state.internal[dof] - start.force.at(dof) - state.contact.at(dof);
            let after = internal[dof] - end.force.at(dof) - contact.at(dof);
            work += 0.5 * (before + after) * d_u[dof];
        }
        work
    }

    /// What the trapezoidal rule makes the normal parts of contact forces do, less what springs of a penalty
    /// take of it: nothing is done, since a pressure is there only where nothing moves along it.
    /// Where a gap closes at the end of an increment, the rule has half of the last pressure push across it.
    fn closing_work(
        &self,
        kinematics: &[Kinematics<D>],
        contacts: &[ContactRecord<D>],
        d_u: &[f64],
    ) -> f64 {
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let points = self.footings.iter().zip(kinematics);
        let points = points.zip(self.state.contacts.iter().zip(contacts));
        let work = points.map(|((footing, k), (before, now))| {
            let mean = 0.5 * (k.local_force(&before.force)[0] + now.t[0]);
            let opened = k.axes.column(0).dot(&footing.relative(moved));
            mean * (opened + now.spring[0] - before.spring[0])
        });
        work.sum()
    }
}

/// Every number that is written follows from these.
fn all_finite(
    energies: &Energies,
    certificate: &Certificate,
    d_u: &[f64],
) -> Result<(), StepError> {
    let motion = largest(d_u.iter().copied());
    let told = [
        ("largest displacement", motion),
        ("stored energy", energies.stored),
        ("energy dissipated", energies.taken()),
        ("external work", energies.external_work),
        (
            "contact force outside of its cone",
            certificate.excess_force,
        ),
        ("bipotential gap", certificate.bipotential_gap),
    ];
    match told.into_iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((what, value)) => Err(StepError::NotFinite { what, value }),
    }
}

/// Part of the volume that flows.
fn fraction(flows: f64, all: f64) -> f64 {
    if all > 0.0 { flows / all } else { 0.0 }
}
