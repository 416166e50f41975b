//! A linearised increment and its contact problem: condensed on the interface, or tied in the factor; not
//! the iteration that it is a step of.

mod condensed;

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::interface::tied::{Held, Tied};
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::report::counts::Counts;
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_contact::{ContactError, ContactSolution, Springs, TiedFactor, TiedProblem, solve_tied};
use moreau_laws::Local;
use nalgebra::DVector;

/// Stiffness against motions that the statuses leave free, over that of the interface: softer than any
/// body and stiffer than rounding; more of it where forces that are as small keep the statuses from
/// settling.
const SOFT: [f64; 2] = [1e-10, 1e-6];

/// Part of the forces in play that it may carry where nothing else needs to.
const CARRIED: f64 = 1e-2;

/// Part of a motion that is left under the stiffer of both where it is not a load that moves the body.
const PUSHED: f64 = 0.5;

/// Part that a contact solution may keep of what increments are excused for as rounding, which is ample.
const ROUNDED: f64 = 0.01;

/// Contact forces over the stiffness of the interface times the motion that finds them, below which they are rounding
/// where no load drives the bodies: what nothing holds is found anywhere, as far as the surfaces around it.
const FAINT: f64 = 1e-9;

/// An increment linearised at an iterate.
pub(crate) struct Linearised<'a, const D: usize> {
    pub(crate) kinematics: &'a [Kinematics<D>],
    pub(crate) loading: &'a Loading<D>,
    /// Prescribed displacements that the step makes up for.
    pub(crate) missing: &'a SparseVector,
    /// The last contact solution.
    pub(crate) guess: Option<&'a ContactSolution<D>>,
    /// A load q of unknown factor, and c and m of q·u + c λ = m.
    pub(crate) border: Option<(&'a SparseVector, f64, f64)>,
    /// A proximal term c/2 |x|² of the motions x of the contacts \[N/mm\], where they are condensed; zero where nothing asks
    /// for one.
    pub(crate) proximal: f64,
    /// Whether nothing holds a body: its solution is the nearest.
    pub(crate) loose: bool,
    /// Residual that the contact solution may keep \[N\].
    pub(crate) enough: f64,
    /// The least stiffness by which displacements weigh in that residual \[N/mm\]: that of the bodies where they are in balance
    /// and the law does not hold yet, else none.
    pub(crate) weight: f64,
    /// Rounding of the forces that it is to balance \[N\].
    pub(crate) rounding: f64,
    /// The factor that the last contact problem has left, where contacts are tied.
    pub(crate) held: &'a mut Held<D>,
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
        linearised: &mut Linearised<'_, D>,
        load: Vec<f64>,
        counts: &mut Counts,
    ) -> Result<Answer<D>, IncrementError> {
        let answer = match system.is_tied() {
            true => self.answer_tied(system, linearised, load, counts)?,
            false => self.answer_condensed(system, linearised, load, counts)?,
        };
        counts.contact += answer.solution.iterations;
        counts.last_contact = answer.solution.iterations;
        Ok(answer)
    }

    /// Motion beyond which a solution is looked for nearer by: the size of the mesh, or the largest gap.
    fn reach(&self, kinematics: &[Kinematics<D>]) -> f64 {
        let gaps = kinematics.iter().map(|k| k.u[0]);
        gaps.fold(self.mesh.size(), f64::max)
    }

    fn answer_tied(
        &self,
        system: &mut System,
        linearised: &mut Linearised<'_, D>,
        load: Vec<f64>,
        counts: &mut Counts,
    ) -> Result<Answer<D>, IncrementError> {
        let kinematics = linearised.kinematics;
        let iteration = counts.newton;
        let contact = |source: ContactError| IncrementError::Contact { iteration, source };
        let mut step = vec![0.0; load.len()];
        linearised.missing.add_to(&mut step, 1.0);
        let (stiffest, floats) = (system.shift(), system.floats);
        let loading = linearised.loading;
        let Held { rows, factor } = &mut *linearised.held;
        let border = linearised.border;
        let kept = (rows, &mut *factor);
        let mut tied = Tied::new(self, system, kinematics, &load, border, kept);
        let method = self.settings.contact.springs();
        let (compliance, tolerance) = method.ok_or(ContactError::Singular).map_err(contact)?;
        let previous = self.previous_forces(kinematics);
        let last = match linearised.guess {
            Some(s) if counts.newton > 1 => &s.force,
            _ => &previous,
        };
        let suspension = tied.suspension(self, kinematics, last);
        let penalty: Vec<Springs<D>> = (kinematics.iter().zip(&previous))
            .map(|(k, previous)| Springs::of_penalty(compliance, *previous, &k.law))
            .collect();
        let both = penalty.iter().zip(&suspension);
        let springs: Vec<Springs<D>> = both.map(|(own, other)| own.and(other)).collect();
        let largest_load = tied.largest_load();
        let largest_of =
            |forces: &[Local<D>], other: f64| forces.iter().map(|t| t.norm()).fold(other, f64::max);
        let given = largest_of(&previous, largest_load);
        let rounding = ROUNDED * linearised.rounding;
        let mut solve = |guess: Option<&ContactSolution<D>>, c: f64, enough: f64| {
            if tied.hold(c) {
                *factor = TiedFactor::default();
            }
            let mut problem = TiedProblem {
                structure: &mut tied,
                origin: kinematics.iter().map(|k| k.u).collect(),
                friction: kinematics.iter().map(|k| k.law).collect(),
                springs: springs.clone(),
                load: largest_load,
                rounding,
                weight: linearised.weight,
                previous: previous.clone(),
            };
            solve_tied(&mut problem, guess, (tolerance, enough), factor)
        };
        let size = (largest_load, linearised.rounding, stiffest);
        let is_decided = |s: &ContactSolution<D>| {
            !floats || self.is_held_by(loading, s, (faint(s, size), false))
        };
        let determined = |(s, z): (ContactSolution<D>, DVector<f64>)| match is_decided(&s) {
            true => Ok((s, z)),
            false => Err(ContactError::Singular),
        };
        let guess = linearised.guess;
        let from = |guessed: bool| solve(guess.filter(|_| guessed), 0.0, linearised.enough);
        let found = match linearised.loose {
            true => Err(ContactError::Singular),
            false => {
                nearer(self.reach(kinematics), |(s, _)| farthest(s), from).and_then(determined)
            }
        };
        let (mut solution, z) = found
            .or_else(|error| {
                counts.undetermined |= error == ContactError::Singular;
                nearest(error, (stiffest, linearised.rounding), |c| {
                    let (solution, z) = solve(guess, c, 0.0)?;
                    let scale = largest_of(&solution.force, given);
                    Ok((solution, z, scale))
                })
            })
            .map_err(contact)?;
        // The contact is where the springs of what is suspended end, not where the bodies are.
        let contacts = solution.displacement.iter_mut().zip(&solution.force);
        for ((u, t), springs) in contacts.zip(&suspension) {
            *u += springs.elongation(t);
        }
        counts.contact_solves += tied.solves;
        if tied.soft > 0.0 {
            *factor = TiedFactor::default();
        }
        let growth = tied.expand(&z, &mut step)?;
        Ok(Answer {
            solution,
            step,
            growth,
        })
    }
}

/// The solution found from the guess, `solve(true)`; where its motion is beyond `reach`, that found from where the bodies
/// are, `solve(false)`, if it moves less: contact forces that turn leave a driven tool a little stiffness of either sign,
/// on which it is in balance far away with all of its contacts open. What is returned was solved last, as the factor with
/// the contacts tied needs it.
fn nearer<T>(
    reach: f64,
    motion: impl Fn(&T) -> f64,
    mut solve: impl FnMut(bool) -> Result<T, ContactError>,
) -> Result<T, ContactError> {
    let guessed = solve(true)?;
    let far = motion(&guessed);
    if far <= reach {
        return Ok(guessed);
    }
    match solve(false) {
        Ok(here) if motion(&here) < far => Ok(here),
        _ => solve(true),
    }
}

/// Contact forces up to this, in a solution under a load, hold no body \[N\].
fn faint<const D: usize>(
    solution: &ContactSolution<D>,
    (load, rounding, stiffest): (f64, f64, f64),
) -> f64 {
    match load <= rounding {
        true => rounding.max(FAINT * stiffest * farthest(solution)),
        false => rounding,
    }
}

/// The largest motion of a solution \[mm\].
fn farthest<const D: usize>(solution: &ContactSolution<D>) -> f64 {
    largest(solution.motion.iter().flatten().copied())
}

/// A contact problem that is singular, as where all that touches slips or nothing is left to press: of its
/// solutions, which differ by a rigid motion, the one nearest to where the bodies are, found with a proximal
/// term c. There is none where a body falls or slides away: what holds it here would have to carry its
/// load, of which `scale` tells the size, if that is more than `rounding` \[N\]. What a surface pushes away moves as far
/// whatever holds it.
fn nearest<const D: usize, T>(
    error: ContactError,
    (stiffest, rounding): (f64, f64),
    mut solve: impl FnMut(f64) -> Result<(ContactSolution<D>, T, f64), ContactError>,
) -> Result<(ContactSolution<D>, T), ContactError> {
    if error != ContactError::Singular {
        return Err(error);
    }
    let [soft, stiff] = SOFT.map(|part| part * stiffest);
    for c in [soft, stiff] {
        let Ok((solution, other, scale)) = solve(c) else {
            continue;
        };
        let motion = farthest(&solution);
        if c * motion <= (CARRIED * scale).max(rounding) {
            return Ok((solution, other));
        }
        let is_pushed = |s: &ContactSolution<D>| farthest(s) > PUSHED * motion;
        let stiffer = c * (stiff / soft);
        return match solve(stiffer).is_ok_and(|(s, ..)| is_pushed(&s)) {
            true => solve(c).map(|(solution, other, _)| (solution, other)),
            false => Err(error),
        };
    }
    Err(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(motion: f64) -> ContactSolution<2> {
        ContactSolution {
            displacement: Vec::new(),
            motion: vec![Local::<2>::new(motion, 0.0)],
            irreversible: Vec::new(),
            force: Vec::new(),
            status: Vec::new(),
            residual: 0.0,
            iterations: 0,
            exact: true,
        }
    }

    /// What no load moves is where it is; what a load moves goes as far as what holds it is soft, and has no place; what a
    /// surface pushes goes as far as the surface, and the solution that counts is the last.
    #[test]
    fn a_body_that_falls_has_no_place_and_one_that_is_pushed_has() {
        let within = |rounding: f64, motion: &dyn Fn(f64) -> f64, scale: f64| {
            let mut last = 0.0;
            let found = nearest(ContactError::Singular, (1e5, rounding), |c| {
                last = c;
                Ok((moved(motion(c)), (), scale))
            });
            found.map(|(s, ())| (farthest(&s), last == SOFT[0] * 1e5))
        };
        let found = |motion: &dyn Fn(f64) -> f64, scale: f64| within(0.0, motion, scale);
        assert_eq!(found(&|_| 1e-3, 1.0), Ok((1e-3, true)));
        assert_eq!(found(&|c| 0.5 / c, 1.0), Err(ContactError::Singular));
        assert_eq!(found(&|c| 0.5e-6 / c, 1e-6), Err(ContactError::Singular));
        assert_eq!(found(&|_| 1e-3, 1e-8), Ok((1e-3, true)));
        // A load that is rounding may be carried.
        let drift = 1e-12 / (SOFT[0] * 1e5);
        assert_eq!(within(1e-11, &|c| 1e-12 / c, 1e-12), Ok((drift, true)));
    }

    /// The nearer one, and always the one that was solved last.
    #[test]
    fn of_two_solutions_the_nearer_is_the_last() {
        let singular = Err(ContactError::Singular);
        let cases = [
            (Ok(0.5), Ok(0.1), Ok(0.5), 1),
            (Ok(2.0), Ok(0.1), Ok(0.1), 2),
            (Ok(2.0), Ok(3.0), Ok(2.0), 3),
            (Ok(2.0), singular.clone(), Ok(2.0), 3),
            (singular.clone(), Ok(0.1), singular, 1),
        ];
        for (guessed, here, expected, count) in cases {
            let mut solved = Vec::new();
            let found = nearer(
                1.0,
                |m: &f64| *m,
                |from_guess| {
                    solved.push(if from_guess {
                        guessed.clone()
                    } else {
                        here.clone()
                    });
                    solved[solved.len() - 1].clone()
                },
            );
            assert_eq!((&found, solved.len()), (&expected, count));
            assert_eq!(solved.last(), Some(&found));
        }
    }
}
