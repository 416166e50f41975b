//! A linearised increment and its contact problem: condensed on the interface, or tied in the factor; not
//! the iteration that it is a step of.

use crate::condensation::Condensation;
use crate::conjugate::Interface;
use crate::driver::Driver;
use crate::error::StepError;
use crate::increment::Counts;
use crate::interface::Kinematics;
use crate::norm::largest;
use crate::sparse::Sparse;
use crate::system::System;
use crate::tied::Tied;
use moreau_contact::{ContactError, ContactProblem, ContactSolution, TiedProblem, solve_tied};
use nalgebra::DVector;
use std::time::Instant;

/// Stiffness against motions that the statuses leave free, over that of the interface: softer than any
/// body and stiffer than rounding; more of it where forces that are as small keep the statuses from
/// settling.
const SOFT: [f64; 2] = [1e-10, 1e-6];

/// Part of the forces in play that it may carry where nothing else needs to.
const CARRIED: f64 = 1e-2;

/// An increment linearised at an iterate.
pub(crate) struct Linearised<'a, const D: usize> {
    pub(crate) kinematics: &'a [Kinematics<D>],
    /// Prescribed displacements that the step makes up for.
    pub(crate) missing: &'a Sparse,
    /// The last contact solution.
    pub(crate) guess: Option<&'a ContactSolution<D>>,
    /// A load q of unknown factor, and c and m of q·u + c λ = m.
    pub(crate) border: Option<(&'a Sparse, f64, f64)>,
    /// Residual that the contact solution may keep \[N\].
    pub(crate) enough: f64,
}

/// Its solution.
pub(crate) struct Answer<const D: usize> {
    pub(crate) solution: ContactSolution<D>,
    /// Displacements of the step, at every degree of freedom.
    pub(crate) step: Vec<f64>,
    /// What the step adds to the unknown factor of a load.
    pub(crate) growth: f64,
}

impl<const D: usize> Driver<D> {
    /// Solves a linearised increment under a load at every degree of freedom \[N\].
    pub(crate) fn answer(
        &self,
        system: &mut System,
        linearised: &Linearised<'_, D>,
        load: Vec<f64>,
        counts: &mut Counts,
    ) -> Result<Answer<D>, StepError> {
        let answer = match system.is_tied() {
            true => self.answer_tied(system, linearised, load, counts)?,
            false => self.answer_condensed(system, linearised, load, counts)?,
        };
        counts.contact += answer.solution.iterations;
        counts.last_contact = answer.solution.iterations;
        Ok(answer)
    }

    fn answer_tied(
        &self,
        system: &mut System,
        linearised: &Linearised<'_, D>,
        load: Vec<f64>,
        counts: &mut Counts,
    ) -> Result<Answer<D>, StepError> {
        let kinematics = linearised.kinematics;
        let iteration = counts.newton;
        let contact = |source: ContactError| StepError::Contact { iteration, source };
        let mut step = vec![0.0; load.len()];
        linearised.missing.add_to(&mut step, 1.0);
        let mut tied = Tied::new(self, system, kinematics, &load);
        let springs = self.settings.contact.springs();
        let (compliance, tolerance) = springs.ok_or(ContactError::Singular).map_err(contact)?;
        let mut problem = TiedProblem {
            structure: &mut tied,
            origin: kinematics.iter().map(|k| k.u).collect(),
            friction: kinematics.iter().map(|k| k.law).collect(),
            previous: self.previous_forces(kinematics),
        };
        let asked = (tolerance, linearised.enough);
        let (solution, z) =
            solve_tied(&mut problem, compliance, linearised.guess, asked).map_err(contact)?;
        counts.linear += tied.solves;
        tied.expand(&z, &mut step)?;
        Ok(Answer {
            solution,
            step,
            growth: 0.0,
        })
    }

    fn answer_condensed(
        &self,
        system: &mut System,
        linearised: &Linearised<'_, D>,
        load: Vec<f64>,
        counts: &mut Counts,
    ) -> Result<Answer<D>, StepError> {
        let (kinematics, guess) = (linearised.kinematics, linearised.guess);
        let mut step = vec![0.0; load.len()];
        linearised.missing.add_to(&mut step, 1.0);
        let mut condensed = system.condense(load);
        let border = linearised.border.map(|(load, compliance, missing)| {
            system.border(&mut condensed, load, (compliance, missing))
        });
        let iteration = counts.newton;
        let contact = |source: ContactError| StepError::Contact { iteration, source };
        let clock = Instant::now();
        let points = (self.points.as_slice(), self.footings.as_slice());
        let seam = (std::mem::take(&mut condensed.stiffness), &condensed.load);
        let previous = self.previous_forces(kinematics);
        let force = match guess {
            Some(s) if counts.newton > 1 => s.force.clone(),
            _ => previous.clone(),
        };
        let mut condensation =
            Condensation::new(system, seam, points, kinematics, (previous, &force))
                .map_err(contact)?;
        let problem = &mut condensation.problem;
        let solution = self
            .settings
            .contact
            .approach(problem, guess, linearised.enough)
            .or_else(|error| {
                counts.undetermined = true;
                self.nearest(system, problem, guess, error)
            })
            .map_err(contact)?;
        system.timings.contact += clock.elapsed();
        // On a path the stiffness is not that of the structure alone.
        counts.criticality = (border.is_none())
            .then(|| condensation.problem.criticality(&solution.status))
            .flatten();
        let x = condensation.interface(&solution.motion);
        let growth = border.map_or(0.0, |b| system.factor(&b, &mut condensed, &x));
        let target = self.contact_forces(kinematics, &solution.force);
        // A load of unknown factor is found with the interface.
        let yielding = (!system.is_direct() && linearised.border.is_none())
            .then(|| condensation.yielding(&solution.status))
            .flatten();
        let give = yielding
            .as_ref()
            .map(|y| |g: &DVector<f64>| y.displacement(g));
        let interface = match &give {
            Some(give) => Interface::Yields(give),
            None => Interface::Held,
        };
        system.expand(condensed, &x, (&target, interface), &mut step)?;
        Ok(Answer {
            solution,
            step,
            growth,
        })
    }

    /// A contact problem that is singular, as where all that touches slips or nothing is left to press:
    /// of its solutions, which differ by a rigid motion, the one nearest to where the bodies are. There is
    /// none where a body falls or slides away: what holds it here would have to carry its load.
    fn nearest(
        &self,
        system: &System,
        problem: &mut ContactProblem<D>,
        guess: Option<&ContactSolution<D>>,
        error: ContactError,
    ) -> Result<ContactSolution<D>, ContactError> {
        if error != ContactError::Singular {
            return Err(error);
        }
        for soft in SOFT.map(|part| part * system.shift()) {
            problem.hold(soft);
            let Ok(solved) = self.settings.contact.solve(problem, guess) else {
                continue;
            };
            let motion = largest(solved.motion.iter().flatten().copied());
            let carries = soft * motion > CARRIED * problem.force_scale(&solved.force);
            return if carries { Err(error) } else { Ok(solved) };
        }
        Err(error)
    }
}
