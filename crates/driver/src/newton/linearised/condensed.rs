//! A linearised increment with its contacts condensed on the interface: among those that may bear, or among all.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::interface::condensation::Condensation;
use crate::interface::nearby::{are_few, closing, nearby, part, whole};
use crate::linear::system::System;
use crate::newton::linearised::{Answer, Linearised, ROUNDED, faint, farthest, nearer, nearest};
use crate::report::counts::Counts;
use crate::timings::Clock;
use moreau_algebra::Interface;
use moreau_contact::{CondensedProblem, ContactError, ContactSolution};
use moreau_laws::Local;
use nalgebra::{DMatrix, DVector};

/// Proximal terms under which the problem of an unstable structure is tried, over the least that makes it stable.
const STABLE: [f64; 4] = [2.0, 8.0, 32.0, 128.0];

/// Stiffness and load of the interface, and what is known of its contacts.
struct Seam<'a, const D: usize> {
    system: &'a System,
    stiffness: DMatrix<f64>,
    load: &'a DVector<f64>,
    /// Contact forces at the start of the step, the last that were found, and springs of a penalty in series with the
    /// contacts \[mm/N\].
    forces: (&'a [Local<D>], &'a [Local<D>], &'a [Local<D>]),
}

/// A contact problem with its solution, and the solution of all contacts.
struct Found<const D: usize> {
    condensation: Condensation<D>,
    own: ContactSolution<D>,
    all: ContactSolution<D>,
}

impl<const D: usize> Driver<D> {
    pub(super) fn answer_condensed(
        &self,
        system: &mut System,
        linearised: &Linearised<'_, D>,
        load: Vec<f64>,
        counts: &mut Counts,
    ) -> Result<Answer<D>, IncrementError> {
        let (kinematics, guess) = (linearised.kinematics, linearised.guess);
        let mut step = vec![0.0; load.len()];
        linearised.missing.add_to(&mut step, 1.0);
        let mut condensed = system.condense(load);
        let mut stiffness = system.schur();
        let border = linearised.border.map(|(load, compliance, missing)| {
            system.border(
                (&mut stiffness, &mut condensed),
                load,
                (compliance, missing),
            )
        });
        let clock = Clock::start();
        let previous = self.previous_forces(kinematics);
        let last = match guess {
            Some(s) if counts.newton > 1 => s.force.clone(),
            _ => previous.clone(),
        };
        let seam = Seam {
            system,
            stiffness,
            load: &condensed.load,
            forces: (&previous, &last, &self.compliances(kinematics)),
        };
        let found = match self.among_nearby(&seam, linearised) {
            Some(found) => Ok(found),
            None => self.among_all(seam, linearised, counts),
        };
        let iteration = counts.newton;
        let contact = |source: ContactError| IncrementError::Contact { iteration, source };
        let Found {
            condensation,
            own,
            all,
        } = found.map_err(contact)?;
        system.timings.contact += clock.elapsed();
        // On a path, or held, the stiffness is not that of the structure alone.
        counts.criticality = (border.is_none() && linearised.proximal == 0.0)
            .then(|| condensation.problem.criticality(&own.status))
            .flatten()
            .map(|(contact, ratio)| (condensation.contacts[contact], ratio));
        let x = condensation.interface(&own.motion);
        let growth = border.map_or(0.0, |b| system.factor(&b, &mut condensed, &x));
        let target = self.contact_forces(kinematics, &all.force);
        // A load of unknown factor is found with the interface.
        let yielding = (!system.is_direct() && linearised.border.is_none())
            .then(|| condensation.yielding(&own.status))
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
            solution: all,
            step,
            growth,
        })
    }

    fn condensation(
        &self,
        seam: &Seam<'_, D>,
        (stiffness, among): (DMatrix<f64>, Vec<usize>),
        linearised: &Linearised<'_, D>,
    ) -> Result<Condensation<D>, ContactError> {
        let points = (self.points.as_slice(), self.footing.rows.as_slice());
        let contacts = (linearised.kinematics, among);
        let stiffness = (stiffness, seam.load);
        let mut condensation =
            Condensation::new(seam.system, stiffness, points, contacts, seam.forces)?;
        condensation.problem.hold(linearised.proximal);
        condensation.problem.rounds(ROUNDED * linearised.rounding);
        condensation.problem.weigh(linearised.weight);
        Ok(condensation)
    }

    /// Whether the contacts of a solution decide where the bodies are, if those are free without.
    fn decides(
        &self,
        (system, load): (&System, &DVector<f64>),
        linearised: &Linearised<'_, D>,
        solution: &ContactSolution<D>,
    ) -> bool {
        let size = (load.amax(), linearised.rounding, system.shift());
        let least = faint(solution, size);
        !system.floats || self.is_held_by(linearised.loading, solution, (least, true))
    }

    /// The solution of a problem, or with a proximal term where stresses make the structure unstable: there may be none
    /// without.
    fn stable(
        &self,
        problem: &mut CondensedProblem<D>,
        linearised: &Linearised<'_, D>,
        solve: impl Fn(&CondensedProblem<D>) -> Result<ContactSolution<D>, ContactError>,
    ) -> Result<ContactSolution<D>, ContactError> {
        solve(problem).or_else(|error| {
            let is_free = linearised.border.is_none() && linearised.proximal == 0.0;
            let may_be_held = self.has_large_strains() && is_free;
            let held = may_be_held.then(|| stabilised(problem, |p| solve(p).ok()));
            held.flatten().ok_or(error)
        })
    }

    /// The solution that is found among the contacts that may bear; those that close under it are taken in. `None` where
    /// these are most, or where they have no solution that is one of all.
    fn among_nearby(&self, seam: &Seam<'_, D>, linearised: &Linearised<'_, D>) -> Option<Found<D>> {
        let kinematics = linearised.kinematics;
        if linearised.proximal > 0.0 || linearised.loose {
            return None;
        }
        let reach = self.reach(kinematics);
        let (previous, last, _) = seam.forces;
        let mut among = nearby(kinematics, (previous, last))?;
        let mut iterations = 0;
        while are_few(among.len(), kinematics.len()) {
            let stiffness = (seam.stiffness.clone(), among.clone());
            let mut condensation = self.condensation(seam, stiffness, linearised).ok()?;
            let guess = linearised.guess.map(|guess| part(guess, &among));
            let problem = &mut condensation.problem;
            let method = &self.settings.contact;
            let approach = |p: &_| {
                let found = method.approach(p, guess.as_ref(), linearised.enough)?;
                // What an unstable structure has far away is not what is looked for.
                match farthest(&found) <= reach {
                    true => Ok(found),
                    false => Err(ContactError::Singular),
                }
            };
            let mut own = self.stable(problem, linearised, approach).ok()?;
            iterations += own.iterations;
            own.iterations = iterations;
            let left_out = condensation.left_out(&own.motion);
            let closing = closing(kinematics, &left_out, seam.system.shift());
            if closing.is_empty() {
                let all = whole(kinematics, (&among, &own), &left_out);
                let is_near = farthest(&all) <= reach;
                let is_found = is_near && self.decides((seam.system, seam.load), linearised, &all);
                return is_found.then_some(Found {
                    condensation,
                    own,
                    all,
                });
            }
            among.extend(closing);
            among.sort_unstable();
        }
        None
    }

    fn among_all(
        &self,
        mut seam: Seam<'_, D>,
        linearised: &Linearised<'_, D>,
        counts: &mut Counts,
    ) -> Result<Found<D>, ContactError> {
        let (kinematics, guess) = (linearised.kinematics, linearised.guess);
        let all = (0..kinematics.len()).collect();
        let stiffness = std::mem::take(&mut seam.stiffness);
        let mut condensation = self.condensation(&seam, (stiffness, all), linearised)?;
        let problem = &mut condensation.problem;
        let method = &self.settings.contact;
        let enough = linearised.enough;
        let reach = self.reach(kinematics);
        let approach = |p: &_| {
            let from = |guessed: bool| method.approach(p, guess.filter(|_| guessed), enough);
            nearer(reach, farthest, from)
        };
        let found = match linearised.loose {
            true => Err(ContactError::Singular),
            false => self.stable(problem, linearised, approach).or_else(|error| {
                let step = self
                    .has_large_strains()
                    .then(|| method.step(problem, seam.forces.1));
                step.flatten().ok_or(error)
            }),
        };
        let error = match &found {
            Ok(found) if !self.decides((seam.system, seam.load), linearised, found) => {
                Some(ContactError::Singular)
            }
            Ok(_) => None,
            Err(error) => Some(error.clone()),
        };
        let solution = match error {
            None => found,
            Some(error) => {
                counts.undetermined |= error == ContactError::Singular;
                let stiffest = seam.system.shift();
                let nearest = nearest(error, (stiffest, linearised.rounding), |c| {
                    problem.hold(c);
                    let solution = method.solve(problem, guess)?;
                    let scale = problem.force_scale(&solution.force);
                    Ok((solution, (), scale))
                });
                nearest.map(|(solution, ())| solution).or(found)
            }
        }?;
        Ok(Found {
            condensation,
            own: solution.clone(),
            all: solution,
        })
    }
}

/// The solution of the problem of an unstable structure with a proximal term that makes it stable; `None` where there is none
/// either, or the structure is stable. The term is gone afterwards.
fn stabilised<const D: usize>(
    problem: &mut CondensedProblem<D>,
    solve: impl Fn(&CondensedProblem<D>) -> Option<ContactSolution<D>>,
) -> Option<ContactSolution<D>> {
    let least = problem.stabilising()?;
    let found = STABLE.iter().find_map(|times| {
        problem.hold(times * least);
        solve(problem)
    });
    problem.hold(0.0);
    found
}
