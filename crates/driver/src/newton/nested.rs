//! The paper's own nesting: Uzawa's prediction and correction around the nonlinear solve; kept to
//! be compared with, not to be used.

use crate::driver::Driver;
use crate::error::StepError;
use crate::interface::condensation::Condensation;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::newton::candidate::{Candidate, Counts};
use crate::newton::chord::FORCING;
use crate::newton::increment::Start;
use crate::newton::iterate::Iterate;
use crate::newton::line_search::Line;
use crate::report::{Iteration, StepReport};
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_contact::{ContactError, ContactSolution, uzawa_steps};
use moreau_laws::{Local, Status};

impl<const D: usize> Driver<D> {
    /// Applies an increment as section 7.2 of the paper does: t ← proj(t − α ũ(t)), where u(t)
    /// takes a nonlinear elastoplastic solve with t frozen.
    ///
    /// α comes from the tangent at the start of the increment and is lowered where the body has
    /// softened so much that a correction overshoots.
    pub(crate) fn nested_increment(
        &mut self,
        system: &mut System,
        start: &Loading<D>,
        end: &Loading<D>,
        (tolerance, iterations): (f64, usize),
        watch: &mut dyn FnMut(&Iteration<'_>),
    ) -> Result<StepReport, StepError> {
        let Start {
            held,
            mut missing,
            mut now,
            done,
        } = self.first_iterate(system, (start, end), self.predictor(start, end));
        let mut counts = Counts::default();
        let kinematics = self.kinematics(system, end, &now.d_u);
        let mut t = self.previous_forces(&kinematics);
        let contact = |source: ContactError| StepError::Contact {
            iteration: 0,
            source,
        };
        self.factorise(system, &mut now, &missing)?;
        let condensed = system.condense(vec![0.0; now.d_u.len()]);
        let points = (self.points.as_slice(), self.footings.as_slice());
        let seam = (condensed.stiffness, &condensed.load);
        let condensation = Condensation::new(system, seam, points, &kinematics, (t.clone(), &t))
            .map_err(contact)?;
        let mut alpha = uzawa_steps(&condensation.problem).map_err(contact)?;
        let common: Vec<f64> = (0..t.len())
            .map(|i| condensation.problem.alpha(i))
            .collect();
        let mut left = f64::INFINITY;
        let mut before: Option<(Vec<Local<D>>, Vec<Local<D>>)> = None;
        for _ in 0..iterations {
            let kinematics = self.kinematics(system, end, &now.d_u);
            now.contact = self.contact_forces(&kinematics, &t);
            now = self.solve_bulk(system, end, &held, now, &mut missing, &mut counts)?;
            counts.solves += 1;
            let kinematics = self.kinematics(system, end, &now.d_u);
            let u: Vec<Local<D>> = kinematics
                .iter()
                .map(|k| Local::from_fn(|j, _| if k.active[j] || j == 0 { k.u[j] } else { 0.0 }))
                .collect();
            let law = |i: usize| &kinematics[i].law;
            let scale = self.force_scale(&now.assembly, end, &now.contact);
            let residual = (0..t.len())
                .map(|i| law(i).natural_map(&u[i], &t[i], common[i]).norm())
                .fold(0.0, f64::max);
            counts.contact += 1;
            left = residual;
            let status: Vec<Status> = (0..t.len())
                .map(|i| law(i).status(&u[i], &t[i], common[i]))
                .collect();
            let unbalanced = now.imbalance(end, &held);
            watch(&Iteration {
                increment: self.state.increment + 1,
                cuts: 0,
                newton: counts.newton,
                contact_iterations: 1,
                out_of_balance: residual,
                scale,
                d_u: &now.d_u[..self.mesh_dofs()],
                residual: &unbalanced[..self.mesh_dofs()],
                status: &status,
            });
            if residual <= tolerance * scale {
                self.check_passage(&now.d_u)?;
                counts.factorisations = system.factorisations - done.0;
                counts.linear = system.conjugate - done.1;
                let candidate = Candidate {
                    out_of_balance: largest(unbalanced.into_iter()),
                    d_u: now.d_u,
                    internal: now.assembly.internal,
                    kinematics,
                    solution: ContactSolution {
                        irreversible: u.clone(),
                        motion: vec![Local::zeros(); u.len()],
                        displacement: u,
                        force: t,
                        status,
                        iterations: counts.contact,
                        residual,
                        exact: true,
                    },
                    counts,
                };
                return self.commit(start, end, candidate);
            }
            let shifted: Vec<Local<D>> = (0..t.len()).map(|i| law(i).shifted(&u[i])).collect();
            if let Some((old_t, old_shifted)) = &before {
                // A contraction needs α ‖Δũ‖ < 2 ‖Δt‖; keep away from the limit.
                let moved = |a: &[Local<D>], b: &[Local<D>], weight: &dyn Fn(usize) -> f64| {
                    let square = |i: usize| (a[i] - b[i]).norm_squared() * weight(i);
                    (0..a.len()).map(square).sum::<f64>().sqrt()
                };
                let answer = moved(&shifted, old_shifted, &|i| alpha[i]);
                let change = moved(&t, old_t, &|i| 1.0 / alpha[i]);
                if change > 0.0 && answer > 1.2 * change {
                    let factor = 0.8 * change / answer;
                    alpha.iter_mut().for_each(|a| *a *= factor);
                }
            }
            let corrected = (0..t.len())
                .map(|i| law(i).correct(&u[i], &t[i], alpha[i]))
                .collect();
            before = Some((std::mem::replace(&mut t, corrected), shifted));
        }
        let solution = ContactError::NotConverged {
            solver: "Uzawa around the nonlinear solve",
            iterations,
            residual: left,
            tolerance: tolerance * self.force_scale(&now.assembly, end, &now.contact),
        };
        Err(contact(solution))
    }

    /// Newton on the bulk under frozen contact forces.
    fn solve_bulk(
        &mut self,
        system: &mut System,
        end: &Loading<D>,
        held: &[usize],
        mut now: Iterate,
        missing: &mut SparseVector,
        counts: &mut Counts,
    ) -> Result<Iterate, StepError> {
        for _ in 0..self.settings.iterations {
            let residual = now.imbalance(end, held);
            let scale = self.force_scale(&now.assembly, end, &now.contact);
            let complete = missing.is_zero();
            let worst = largest(residual.iter().copied());
            if complete && worst <= self.target(system, scale, &now.d_u) {
                return Ok(now);
            }
            if !worst.is_finite() {
                break;
            }
            counts.newton += 1;
            self.factorise(system, &mut now, missing)?;
            let load = now.assembly.load(&[&end.force, &now.contact]);
            let mut step = vec![0.0; load.len()];
            std::mem::take(missing).add_to(&mut step, 1.0);
            let expected = FORCING * largest(load.iter().copied());
            let mut unsymmetric = self.unsymmetric(system, &now, worst, (expected, 0.0));
            loop {
                match &unsymmetric {
                    None => system.solve(&load, &mut step)?,
                    Some(u) => system.solve(&u.load(&load), &mut step)?,
                }
                if self.settles(&mut unsymmetric, &now, &step, held) {
                    break;
                }
            }
            let target = now.contact.clone();
            let line = Line {
                tangent: true,
                allowed: self.allowed(&[worst]),
                end,
                growth: SparseVector::default(),
                held,
                step: &step,
                target: &target,
                complete,
                slack: 0.0,
            };
            now = self.search(system, &line, now);
        }
        let residual = now.imbalance(end, held);
        let target = self.target(
            system,
            self.force_scale(&now.assembly, end, &now.contact),
            &now.d_u,
        );
        Err(self.not_converged(&residual, self.settings.iterations, target))
    }
}
