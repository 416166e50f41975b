//! A converged increment becomes the state of the driver, with its energies and its certificate; not
//! how it converged.

use crate::driver::{Driver, State};
use crate::error::IncrementError;
use crate::interface::kinematics::NO_SLIP;
use crate::model::load::Loading;
use crate::model::motion_row::RelativeMotionRow;
use crate::model::points::{ContactPoint, Kinematics, Turn, in_space, turn_between, turned};
use crate::newton::iterate::Candidate;
use crate::report::counts::Counts;
use crate::report::{ContactRecord, Energies, IncrementReport};
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_contact::{Certificate, ContactSolution};
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
    /// [`IncrementError::NotFinite`] for what numbers do not hold, [`IncrementError::Law`]; nothing has changed then.
    pub(crate) fn commit(
        &mut self,
        start: &Loading<D>,
        end: &Loading<D>,
        candidate: Candidate<D>,
    ) -> Result<IncrementReport, IncrementError> {
        let Candidate {
            d_u,
            internal,
            mut kinematics,
            solution,
            out_of_balance,
            counts,
        } = candidate;
        self.check_laws()?;
        let mut told = solution.clone();
        self.drag(&mut kinematics, &mut told);
        let record = |i: usize| self.record(i, &kinematics[i], &told);
        let contacts: Vec<ContactRecord<D>> = (0..kinematics.len()).map(record).collect();
        let forces: Vec<Local<D>> = contacts.iter().map(|c| c.t).collect();
        let obeying: Vec<Local<D>> = contacts.iter().map(|c| c.u + c.spring).collect();
        let laws: Vec<_> = kinematics.iter().map(|k| k.law).collect();
        let mut certificate = Certificate::new(&laws, &obeying, &forces);
        // The springs of a penalty give way, and what they give way is a penetration.
        let sunk = contacts.iter().filter(|c| c.spring[0] > 0.0);
        let sunk = sunk.fold(0.0, |most: f64, c| most.max(-c.u[0]));
        certificate.penetration = certificate.penetration.max(sunk);
        let contact = self.contact_forces(&kinematics, &forces);
        let work = self.external_work((start, end), &d_u, &internal, &contact)
            + self.closing_work(end, &kinematics, &contacts, &d_u)
            + self.turning_work(end, &d_u, &contacts);
        let (mut energies, plastic_fraction) = self.energies_after(work, &kinematics, &contacts);
        all_finite(&energies, &certificate, &d_u)?;
        let free = self.free_strains(end);
        let at_start = self.work_on_free(&free, &self.state.displacement);
        for block in &mut self.blocks {
            block.commit();
        }
        let touches = |i: &usize| kinematics[*i].at_corner && contacts[*i].status != Status::Open;
        let corners = (0..contacts.len()).filter(touches).collect();
        let displacement = self.displacement_after(&d_u, end);
        // Against stresses heat does work, by the trapezoidal rule, that comes back from what it moves.
        energies.external_work -= 0.5 * (at_start + self.work_on_free(&free, &displacement));
        let moved = largest(displacement[..self.mesh_dofs()].iter().copied());
        let forces = internal[..self.mesh_dofs()].iter().copied();
        let force = largest(forces.chain(contact.iter().map(|(_, f)| f)));
        let loading = self.loading_after(&d_u, end);
        let last = self.repeatable(d_u, end);
        let answered = end.increment_from(start);
        let bend = self.bend(&last, &answered);
        self.state = State {
            increment: self.state.increment + 1,
            displacement,
            last: Some((last, answered)),
            bend,
            internal,
            loading,
            energies,
            contacts,
            contact,
            farthest: moved.max(self.state.farthest),
            largest_force: force.max(self.state.largest_force),
            solution: Some(solution),
            unstable: counts.negative > 0,
        };
        let verdict = (plastic_fraction, certificate);
        Ok(self.report(verdict, corners, out_of_balance, counts))
    }

    /// Friction at the points that conditions drag along a surface.
    fn drag(&self, kinematics: &mut [Kinematics<D>], solution: &mut ContactSolution<D>) {
        let rounding = NO_SLIP * self.mesh.size();
        let solved = solution.force.iter_mut().zip(&mut solution.status);
        let known = self.points.iter().zip(&self.state.contacts);
        for ((k, (point, before)), (t, status)) in kinematics.iter_mut().zip(known).zip(solved) {
            let dragged = k.drag(point.axis.as_ref(), t, &before.force, rounding);
            *status = dragged.unwrap_or(*status);
        }
    }

    /// What is kept of a contact point under a solution.
    fn record(
        &self,
        i: usize,
        kinematics: &Kinematics<D>,
        solution: &ContactSolution<D>,
    ) -> ContactRecord<D> {
        let (point, active) = (&self.points[i], &kinematics.active);
        let (mut u, mut t) = (kinematics.u, solution.force[i]);
        u[0] = kinematics.gap;
        for j in (0..D).filter(|&j| !active[j]) {
            t[j] = 0.0;
            if j > 0 {
                u[j] = 0.0;
            }
        }
        // A point that is held along one tangent of a surface in space slips along the other.
        let held = !(1..D).any(|j| active[j]);
        let status = match solution.status[i] {
            Status::Slip if held => Status::Stick,
            other => other,
        };
        ContactRecord {
            contact: point.contact,
            node: point.node,
            position: self.mesh.nodes()[point.node],
            kind: point.kind,
            u,
            t,
            force: kinematics.force(&t),
            area: self.footing.rows[i].area,
            status,
            held,
            spring: solution.irreversible[i] - solution.displacement[i],
        }
    }

    /// Energies at the end of an increment in which what acts from outside does this work, and the part
    /// of the volume that flows.
    fn energies_after(
        &self,
        work: f64,
        kinematics: &[Kinematics<D>],
        contacts: &[ContactRecord<D>],
    ) -> (Energies, f64) {
        let mut energies = self.state.energies;
        energies.external_work += work;
        let (mut friction, mut penalty) = (0.0, 0.0);
        for (k, (c, before)) in kinematics
            .iter()
            .zip(contacts.iter().zip(&self.state.contacts))
        {
            friction += self.rubbed(k, before, c);
            // Springs in series: ½ t·C t, with C t₀* the part they held before.
            let held = k.local_force(&before.force);
            penalty += 0.5 * c.spring[0] * c.t[0];
            penalty += (1..D)
                .map(|j| 0.5 * c.spring[j] * (c.t[j] + held[j]))
                .sum::<f64>();
            penalty -= 0.5 * before.t[0] * before.spring[0];
        }
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
        (energies, fraction(plastic_volume, volume))
    }

    /// What friction dissipates at a contact point in the increment: its slip under the last shear, or under large strains
    /// under the mean of both ends, which is right to second order where a pressure changes. The shear of the start is the
    /// largest one at the pressure then, as far as that much resists the slip at one of the ends: a point that opens counts
    /// with what there was, whether its last pressure is zero or rounding, and one that is lifted off with no shear rubs nothing
    /// on its way.
    fn rubbed(
        &self,
        kinematics: &Kinematics<D>,
        before: &ContactRecord<D>,
        now: &ContactRecord<D>,
    ) -> f64 {
        let slip = now.u + now.spring;
        let last = -(1..D).map(|j| now.t[j] * slip[j]).sum::<f64>();
        let bound = |t_n: f64| kinematics.law.bound(t_n.max(0.0));
        if !self.has_large_strains() || bound(now.t[0]).is_infinite() {
            return last;
        }
        let tangential: Local<D> = SVector::from_fn(|j, _| if j > 0 { slip[j] } else { 0.0 });
        let way = match (now.status, kinematics.dragged) {
            // Dragged along by conditions, and open: its tangents take no part.
            (Status::Open, Some(slip)) => slip,
            _ => kinematics.force(&tangential),
        };
        let shear = before.t.rows(1, D - 1).norm();
        let resisting = (-before.force.dot(&way)).clamp(0.0, shear * way.norm());
        let first = match bound(now.t[0]) > 0.0 && now.t[0] > 0.0 {
            true => (last * bound(before.t[0]) / bound(now.t[0])).min(last + resisting),
            false => resisting,
        };
        0.5 * (first + last)
    }

    /// Displacements at the end of an increment: prescribed values exactly, not as sums of increments.
    fn displacement_after(&self, d_u: &[f64], end: &Loading<D>) -> Vec<f64> {
        let pairs = self.state.displacement.iter().zip(d_u);
        let mut displacement: Vec<f64> = pairs.map(|(u, d)| u + d).collect();
        for (&dof, &u) in &end.displacement {
            end.directions.set(dof, u, &mut displacement);
        }
        displacement
    }

    /// What holds at the end of an increment, with the turns that moments have made.
    fn loading_after(&self, d_u: &[f64], end: &Loading<D>) -> Loading<D> {
        let mut loading = end.clone();
        for tool in (0..self.tools.len()).filter(|&tool| end.axle_of(tool).is_some()) {
            let turned = self.turn_at(tool, end, d_u) - end.turn_of(tool);
            (0..3).for_each(|i| loading.turn.add(3 * tool + i, turned[i]));
        }
        loading
    }

    /// What is told of the increment that has just been committed.
    fn report(
        &self,
        (plastic_fraction, certificate): (f64, Certificate),
        corners: Vec<usize>,
        out_of_balance: f64,
        counts: Counts,
    ) -> IncrementReport {
        let contacts = &self.state.contacts;
        let rounding = self.rounding_of_forces();
        let is_without = |&k: &usize| self.grips[k].is_without(&self.points[k].law);
        let presses = |k: &usize| contacts[*k].t[0] > rounding && is_without(k);
        IncrementReport {
            increment: self.state.increment,
            fraction: 1.0,
            newton_iterations: counts.newton,
            astray_iterations: 0,
            nonlinear_solves: counts.solves,
            contact_iterations: counts.contact,
            factorisations: counts.factorisations,
            linear_iterations: counts.linear,
            contact_solves: counts.contact_solves,
            shortened_steps: counts.shortened,
            cuts: 0,
            open: self.count(Status::Open),
            stick: self.count(Status::Stick),
            slip: self.count(Status::Slip),
            plastic_fraction,
            energies: self.state.energies,
            certificate,
            criticality: counts.criticality,
            negative_eigenvalues: counts.negative,
            mode: None,
            limit: None,
            leap: None,
            free_motions: match counts.undetermined {
                true => self.free_motions(),
                false => Vec::new(),
            },
            corners,
            shearless: (0..contacts.len()).filter(presses).collect(),
            out_of_balance,
            residuals: counts.residuals,
        }
    }

    /// Work over the increment of applied forces and reactions, by the trapezoidal rule.
    fn external_work(
        &self,
        (start, end): (&Loading<D>, &Loading<D>),
        d_u: &[f64],
        internal: &[f64],
        contact: &SparseVector,
    ) -> f64 {
        let state = &self.state;
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        let mut work = start.force.with(&end.force, mean).dot(d_u);
        let at_start = self.pressure_force(start, &vec![0.0; d_u.len()]);
        work += at_start.with(&self.pressure_force(end, d_u), mean).dot(d_u);
        let before = |dof: usize| state.internal[dof] - start.force.at(dof) - state.contact.at(dof);
        let after = |dof: usize| internal[dof] - end.force.at(dof) - contact.at(dof);
        for &dof in end.displacement.keys() {
            let along = |at: &dyn Fn(usize) -> f64| end.directions.component(dof, at);
            work += 0.5 * (along(&before) + along(&after)) * along(&|dof| d_u[dof]);
        }
        work
    }

    /// The normal of its tool at a contact point at the start of an increment.
    fn normal_before(
        &self,
        point: &ContactPoint<D>,
        motion_row: &RelativeMotionRow<D>,
    ) -> Option<SVector<f64, D>> {
        let tool = point.tool?;
        let normal = self.tools[tool]
            .opposite(point)
            .normal(&self.seen(point, motion_row));
        Some(turned(normal, &self.state.loading.turn_of(tool)))
    }

    /// By how much a tool has turned in the increment, about the axis of that turn.
    pub(crate) fn turned_by(&self, tool: usize, end: &Loading<D>, d_u: &[f64]) -> Turn {
        turn_between(
            &self.state.loading.turn_of(tool),
            &self.turn_at(tool, end, d_u),
        )
    }

    /// Work of tools that are told to turn over the increment, by the trapezoidal rule; that of moments is one of forces.
    fn turning_work(&self, end: &Loading<D>, d_u: &[f64], contacts: &[ContactRecord<D>]) -> f64 {
        let rest = vec![0.0; d_u.len()];
        let of = |tool: usize| {
            if end.axle_of(tool).is_some() {
                return 0.0;
            }
            let by = self.turned_by(tool, end, d_u);
            let [before, after] = match by.norm() > 0.0 {
                true => [
                    self.moment(tool, &rest, &self.state.contacts),
                    self.moment(tool, d_u, contacts),
                ],
                false => return 0.0,
            };
            0.5 * (before + after).dot(&by)
        };
        (0..self.tools.len()).map(of).sum()
    }

    /// What the trapezoidal rule makes the normal parts of contact forces do, less what springs of a penalty
    /// take of it: nothing is done, since a pressure is there only where nothing moves along it.
    /// Where a gap closes at the end of an increment, the rule has half of the last pressure push across it. Motions are
    /// those beside the tool, which a turn θ moves by θ × r.
    fn closing_work(
        &self,
        end: &Loading<D>,
        kinematics: &[Kinematics<D>],
        contacts: &[ContactRecord<D>],
        d_u: &[f64],
    ) -> f64 {
        let rest = vec![0.0; d_u.len()];
        let tools = 0..self.tools.len();
        let turns: Vec<_> = tools.map(|tool| self.turned_by(tool, end, d_u)).collect();
        let moved = |a: usize| SVector::<f64, D>::from_column_slice(&d_u[D * a..D * a + D]);
        let large = self.has_large_strains();
        let points = self.points.iter().zip(&self.footing.rows).zip(kinematics);
        let points = points.zip(self.state.contacts.iter().zip(contacts));
        let work = points.map(|(((p, motion_row), k), (before, now))| {
            let (n, parted) = (k.axes.column(0).into_owned(), motion_row.relative(moved));
            let mean = 0.5 * (k.local_force(&before.force)[0] + now.t[0]);
            let sprung = mean * (now.spring[0] - before.spring[0]);
            let turned = p.tool.filter(|&tool| turns[tool].norm() > 0.0);
            // Along a curved tool, and one that turns, each pressure has a normal of its own.
            let first = match large || turned.is_some() {
                true => self.normal_before(p, motion_row),
                false => None,
            };
            let across = match first {
                Some(first) => 0.5 * (first * before.t[0] + n * now.t[0]).dot(&parted),
                None => mean * n.dot(&parted),
            };
            let with_tool = turned.map_or(0.0, |tool| {
                let by = |d_u: &[f64], n| {
                    turns[tool]
                        .cross(&self.arm(tool, p, d_u))
                        .dot(&in_space(&n))
                };
                let pressure = match first {
                    Some(_) => before.t[0],
                    None => k.local_force(&before.force)[0],
                };
                0.5 * (pressure * by(&rest, first.unwrap_or(n)) + now.t[0] * by(d_u, n))
            });
            sprung + across - with_tool
        });
        work.sum()
    }
}

/// Every number that is written follows from these.
fn all_finite(
    energies: &Energies,
    certificate: &Certificate,
    d_u: &[f64],
) -> Result<(), IncrementError> {
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
        Some((what, value)) => Err(IncrementError::NotFinite { what, value }),
    }
}

/// Part of the volume that flows.
fn fraction(flows: f64, all: f64) -> f64 {
    if all > 0.0 { flows / all } else { 0.0 }
}
