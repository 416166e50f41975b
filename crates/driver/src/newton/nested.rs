//! The paper's own nesting: Uzawa's prediction and correction around the nonlinear solve; kept to
//! be compared with, not to be used.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::interface::condensation::Condensation;
use crate::interface::tied::Held;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::newton::chord::FORCING;
use crate::newton::increment::Increment;
use crate::newton::iterate::Candidate;
use crate::newton::line_search::NewtonStep;
use crate::report::{IncrementReport, Iteration};
use crate::vector::{SparseVector, largest};
use moreau_contact::{Anderson, ContactError, ContactSolution, uzawa_steps};
use moreau_laws::{Local, Status};
use nalgebra::DVector;
use std::ops::ControlFlow;

/// Contact forces on their way to the fixed point t = proj(t − α ũ(t)).
struct Uzawa<const D: usize> {
    /// t \[N\].
    force: Vec<Local<D>>,
    /// α \[N/mm\].
    alpha: Vec<f64>,
    /// α by which the residual is measured \[N/mm\].
    common: Vec<f64>,
    /// t and ũ before the last correction.
    before: Option<(Vec<Local<D>>, Vec<Local<D>>)>,
    /// What extrapolates the corrections.
    anderson: Option<Anderson>,
    /// The least residual that counted as progress \[N\], and the correction in which it was found.
    least: (f64, usize),
}

/// Part of the corrections allowed in which the residual must fall by as large a part: what is slower arrives nowhere.
const PATIENCE: f64 = 0.1;

/// What a nonlinear solve under frozen contact forces answers.
struct Response<const D: usize> {
    kinematics: Vec<Kinematics<D>>,
    /// Gaps and slips u \[mm\].
    displacement: Vec<Local<D>>,
    status: Vec<Status>,
    /// Largest natural-map residual \[N\].
    residual: f64,
}

impl<const D: usize> Uzawa<D> {
    /// The correction \[90′\], extrapolated from those before, which leaves its fixed point what it is: where bodies flow
    /// they are so much softer against some forces than against others that thousands of plain corrections do not arrive.
    fn correct(&mut self, response: &Response<D>) {
        let (u, law) = (&response.displacement, |i: usize| {
            &response.kinematics[i].law
        });
        let all = 0..self.force.len();
        let shifted: Vec<Local<D>> = all.clone().map(|i| law(i).shifted(&u[i])).collect();
        self.shorten(&shifted);
        let corrected = |i: usize| law(i).correct(&u[i], &self.force[i], self.alpha[i]);
        let corrected: Vec<Local<D>> = all.clone().map(corrected).collect();
        let next = match &mut self.anderson {
            Some(anderson) => anderson.next(&stacked(&self.force), stacked(&corrected)),
            None => stacked(&corrected),
        };
        // Between admissible forces an extrapolation need not be one.
        let admissible = |i: usize| law(i).project(&Local::from_fn(|j, _| next[D * i + j]));
        let force = std::mem::replace(&mut self.force, all.map(admissible).collect());
        self.before = Some((force, shifted));
    }

    /// Whether the corrections get on, of which this many are allowed.
    fn gets_on(&mut self, residual: f64, (correction, allowed): (usize, usize)) -> bool {
        if residual < (1.0 - PATIENCE) * self.least.0 {
            self.least = (residual, correction);
        }
        (correction - self.least.1) as f64 <= PATIENCE * allowed as f64
    }

    /// Lowers α where the last correction overshot: a contraction needs α ‖Δũ‖ < 2 ‖Δt‖, from which it
    /// keeps away.
    fn shorten(&mut self, shifted: &[Local<D>]) {
        let Some((old_force, old_shifted)) = &self.before else {
            return;
        };
        let moved = |a: &[Local<D>], b: &[Local<D>], weight: &dyn Fn(usize) -> f64| {
            let square = |i: usize| (a[i] - b[i]).norm_squared() * weight(i);
            (0..a.len()).map(square).sum::<f64>().sqrt()
        };
        let answer = moved(shifted, old_shifted, &|i| self.alpha[i]);
        let change = moved(&self.force, old_force, &|i| 1.0 / self.alpha[i]);
        if change > 0.0 && answer > 1.2 * change {
            let factor = 0.8 * change / answer;
            self.alpha.iter_mut().for_each(|a| *a *= factor);
            // The corrections are another map now.
            self.anderson = self.anderson.take().map(|_| Anderson::default());
        }
    }
}

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
        (tolerance, iterations, extrapolated): (f64, usize, bool),
        watch: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        let guess = self.predictor(start, end);
        let mut increment = self.begin_increment(system, (start, end), guess, None);
        increment.counts.solves = 0;
        let mut uzawa = self.prediction(system, end, &mut increment, extrapolated)?;
        let mut left = f64::INFINITY;
        let mut corrections = 0;
        while corrections < iterations && uzawa.gets_on(left, (corrections, iterations)) {
            corrections += 1;
            self.solve_bulk(system, end, &uzawa.force, &mut increment)
                .map_err(|error| self.not_borne(error))?;
            let response = self.response(system, end, &uzawa, &increment);
            let iterate = &increment.iterate;
            let scale =
                self.force_scale((&iterate.assembly, iterate.heated), end, &iterate.contact);
            let residual = iterate.residual(end, system.prescribed());
            left = response.residual;
            increment.counts.contact += 1;
            let told = watch(&Iteration {
                increment: self.state.increment + 1,
                cuts: 0,
                newton: increment.counts.newton,
                contact_iterations: 1,
                out_of_balance: left,
                scale,
                d_u: &iterate.d_u[..self.mesh_dofs()],
                residual: &residual[..self.mesh_dofs()],
                status: &response.status,
            });
            if told.is_break() {
                return Err(IncrementError::Interrupted);
            }
            if left <= tolerance * scale {
                if self.release(&uzawa.force) {
                    continue;
                }
                self.check_passage(&iterate.d_u, end)?;
                let state = (response.kinematics.as_slice(), response.status.as_slice());
                let held = &mut Held::default();
                increment.counts.negative = self.negative_eigenvalues(system, end, state, held);
                increment.count(system);
                let out_of_balance = largest(residual.into_iter());
                let candidate = candidate(increment, uzawa.force, response, out_of_balance);
                return self.commit(start, end, candidate);
            }
            uzawa.correct(&response);
            self.grip(&uzawa.force);
        }
        let iterate = &increment.iterate;
        let source = ContactError::NotConverged {
            solver: "Uzawa around the nonlinear solve",
            iterations: corrections,
            residual: left,
            tolerance: tolerance
                * self.force_scale((&iterate.assembly, iterate.heated), end, &iterate.contact),
        };
        let iteration = 0;
        Err(IncrementError::Contact { iteration, source })
    }

    /// That bodies were not brought into balance under frozen contact forces is the method's failure, not that of what is
    /// prescribed: bodies that do not harden bear no larger forces than those of collapse, and corrections on their way go
    /// beyond them.
    fn not_borne(&self, error: IncrementError) -> IncrementError {
        match error {
            IncrementError::NotConverged {
                iterations,
                out_of_balance,
                tolerance,
                ..
            } if !self.points.is_empty() => IncrementError::Contact {
                iteration: iterations,
                source: ContactError::NotConverged {
                    solver: "Uzawa around the nonlinear solve, whose bodies do not bear the contact forces of a correction,",
                    iterations,
                    residual: out_of_balance,
                    tolerance,
                },
            },
            other => other,
        }
    }

    /// The committed forces, and α of the tangent at the first iterate.
    fn prediction(
        &mut self,
        system: &mut System,
        end: &Loading<D>,
        increment: &mut Increment<'_, '_, D>,
        extrapolated: bool,
    ) -> Result<Uzawa<D>, IncrementError> {
        let contact = |source: ContactError| IncrementError::Contact {
            iteration: 0,
            source,
        };
        let kinematics = self.kinematics(system, end, &increment.iterate.d_u);
        let force = self.previous_forces(&kinematics);
        let given = (end, &increment.missing);
        self.factorise(system, &mut increment.iterate, given, false)?;
        let condensed = system.condense(vec![0.0; increment.iterate.d_u.len()]);
        let points = (self.points.as_slice(), self.footing.rows.as_slice());
        let seam = (system.schur(), &condensed.load);
        let springs = self.compliances(&kinematics);
        let forces = (force.as_slice(), force.as_slice(), springs.as_slice());
        let all = (0..kinematics.len()).collect();
        let condensation =
            Condensation::new(system, seam, points, (&kinematics, all), forces).map_err(contact)?;
        let problem = &condensation.problem;
        Ok(Uzawa {
            alpha: uzawa_steps(problem).map_err(contact)?,
            common: (0..force.len()).map(|i| problem.alpha(i)).collect(),
            force,
            before: None,
            anderson: extrapolated.then(Anderson::default),
            least: (f64::INFINITY, 0),
        })
    }

    /// Gaps, slips, statuses and residual of a body in balance with frozen contact forces.
    fn response(
        &self,
        system: &System,
        end: &Loading<D>,
        uzawa: &Uzawa<D>,
        increment: &Increment<'_, '_, D>,
    ) -> Response<D> {
        let kinematics = self.kinematics(system, end, &increment.iterate.d_u);
        let displacement: Vec<Local<D>> = kinematics
            .iter()
            .map(|k| Local::from_fn(|j, _| if k.active[j] || j == 0 { k.u[j] } else { 0.0 }))
            .collect();
        let (u, t, alpha) = (&displacement, &uzawa.force, &uzawa.common);
        let law = |i: usize| &kinematics[i].law;
        let map = |i: usize| law(i).natural_map(&u[i], &t[i], alpha[i]).norm();
        Response {
            residual: (0..t.len()).map(map).fold(0.0, f64::max),
            status: (0..t.len())
                .map(|i| law(i).status(&u[i], &t[i], alpha[i]))
                .collect(),
            displacement,
            kinematics,
        }
    }

    /// Newton on the bulk under frozen contact forces.
    fn solve_bulk(
        &mut self,
        system: &mut System,
        end: &Loading<D>,
        force: &[Local<D>],
        increment: &mut Increment<'_, '_, D>,
    ) -> Result<(), IncrementError> {
        let kinematics = self.kinematics(system, end, &increment.iterate.d_u);
        let contact = self.contact_forces(&kinematics, force);
        increment.iterate.contact = contact.clone();
        increment.counts.solves += 1;
        let last = increment.counts.newton + self.settings.iterations;
        loop {
            let iterate = &mut increment.iterate;
            let residual = iterate.residual(end, system.prescribed());
            let scale =
                self.force_scale((&iterate.assembly, iterate.heated), end, &iterate.contact);
            let worst = largest(residual.iter().copied());
            let complete = increment.missing.is_zero();
            let accepted = self.accepted_residual(system, scale, &iterate.d_u);
            if complete && worst <= accepted {
                return Ok(());
            }
            if !worst.is_finite() || increment.counts.newton == last {
                return Err(self.not_converged(&residual, self.settings.iterations, accepted));
            }
            increment.counts.newton += 1;
            self.factorise(system, iterate, (end, &increment.missing), false)?;
            let load = iterate.assembly.load(&[&end.force, &iterate.contact]);
            let mut step = vec![0.0; load.len()];
            std::mem::take(&mut increment.missing).add_to(&mut step, 1.0);
            let expected = FORCING * largest(load.iter().copied());
            let at = (&*iterate, end);
            let mut unsymmetric = self.unsymmetric(system, at, worst, (expected, 0.0));
            loop {
                match &unsymmetric {
                    None => system.solve(&load, &mut step)?,
                    Some(u) => system.solve(&u.load(&load), &mut step)?,
                }
                if self.settles(&mut unsymmetric, at, &step, system.prescribed()) {
                    break;
                }
            }
            let step = NewtonStep {
                displacement: step,
                factor: 0.0,
                growth: SparseVector::default(),
                contact: contact.clone(),
                turned: SparseVector::default(),
                complete,
                arrives: !complete,
                slack: 0.0,
                tangent: true,
                allowed: self.allowed(&[worst]),
            };
            let part = self.search(system, end, &step, iterate);
            if part < 1.0 && step.arrives {
                increment.missing = self.missing(increment.start, end, &iterate.d_u);
            }
        }
    }
}

/// All components of all contacts as one vector.
fn stacked<const D: usize>(forces: &[Local<D>]) -> DVector<f64> {
    DVector::from_iterator(D * forces.len(), forces.iter().flatten().copied())
}

/// The increment at the fixed point.
fn candidate<const D: usize>(
    increment: Increment<'_, '_, D>,
    force: Vec<Local<D>>,
    response: Response<D>,
    out_of_balance: f64,
) -> Candidate<D> {
    let u = response.displacement;
    Candidate {
        out_of_balance,
        d_u: increment.iterate.d_u,
        internal: increment.iterate.assembly.internal,
        kinematics: response.kinematics,
        solution: ContactSolution {
            irreversible: u.clone(),
            motion: vec![Local::zeros(); u.len()],
            displacement: u,
            force,
            status: response.status,
            iterations: increment.counts.contact,
            residual: response.residual,
            exact: true,
        },
        counts: increment.counts,
    }
}
