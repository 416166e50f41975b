//! The equilibrium at the end of an increment, found at once or in parts along its loading, and committed; not the
//! iteration that finds it.

use crate::driver::Driver;
use crate::error::IncrementError;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::newton::iterate::Candidate;
use crate::report::counts::Counts;
use crate::report::{IncrementReport, Iteration};
use crate::vector::largest;
use std::ops::ControlFlow;

/// Iterations in which a way to balance halves its residual: of 788 ways in the example decks that led there one took
/// 30, that of a body that snaps, two took 12, and the others 8 at most (`moreau run --json-log`).
const PATIENCE: usize = 15;

/// Motion, over that of the increment before as often as the load grows, from which on a body may have snapped.
const SNAP: f64 = 4.0;

/// The same over the size of the mesh, below which nothing has.
const STILL: f64 = 1e-6;

/// Halvings of the part of the increment in which the body moves most, before it counts as one that snaps.
const HALVINGS: usize = 4;

/// Parts of an increment that is followed along its loading: the first, and the shortest.
const PART: f64 = 0.25;
const SHORTEST: f64 = 1.0 / 128.0;

/// Iterations of all its parts, over those that one way to balance may take, after which an increment that is followed is
/// cut instead: in the example decks those that led to its end took less than one (`moreau run --json-log`).
const FOLLOWED: usize = 3;

impl<const D: usize> Driver<D> {
    /// Applies the increment from one loading to another and commits it; `watch` sees every
    /// iterate.
    pub(crate) fn increment(
        &mut self,
        system: &mut System,
        start: &Loading<D>,
        end: &Loading<D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<IncrementReport, IncrementError> {
        let mut candidate = self.equilibrium(system, (start, end), watch)?;
        let astray_iterations = self.spent.newton;
        if candidate.counts.undetermined {
            candidate = self.nearest(system, (start, end), candidate, watch)?;
        }
        self.check_passage(&candidate.d_u, end)?;
        self.check_bodies(&candidate.d_u)?;
        let leap = self.check_snap(system, (start, end), &candidate, watch)?;
        candidate.counts = std::mem::take(&mut self.spent).with(candidate.counts);
        let mode = match candidate.counts.negative > 0 && !self.state.unstable {
            true => self.unstable_mode(system, &candidate),
            false => None,
        };
        let report = self.commit(start, end, candidate)?;
        Ok(IncrementReport {
            astray_iterations,
            mode,
            leap,
            ..report
        })
    }

    /// The equilibrium at the end of an increment: found at once or, under large strains, by following it along the
    /// loading. First in quarters, none of which may wander, so that contacts that do not settle are given less to settle;
    /// but a body that snaps is found where it has snapped to by iterates that have wandered for long, if at all.
    fn equilibrium(
        &mut self,
        system: &mut System,
        (start, end): (&Loading<D>, &Loading<D>),
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Candidate<D>, IncrementError> {
        let follows = self.has_large_strains();
        let guess = self.predictor(start, end);
        let mut increment = self.begin_increment(system, (start, end), guess, None);
        // Who gives a guess wants to go where it leads.
        let is_guessed = self.guessed.is_some();
        increment.patience = (follows && !is_guessed).then_some(PATIENCE);
        let mut found = self.balance(system, increment, watch);
        for patience in [Some(PATIENCE), None] {
            let Err(error) = &found else { break };
            if !follows
                || error.is_final()
                || patience.is_none() && self.condenses(system, error)
                || self.ties(system, error, end)
            {
                break;
            }
            match self.continued(system, (start, end), patience, watch) {
                Err(other) if !other.is_broken_off() => {}
                other => found = other,
            }
        }
        found
    }

    /// Whether, under large strains, the body has stayed near where it was: an equilibrium beyond a limit is that of
    /// another branch, to which loads lead along a path, and tools perhaps in shorter increments. Where those have been
    /// tried, [`Driver::may_leap`], what is left is a leap: the node that moves most, and how far.
    ///
    /// # Errors
    /// [`IncrementError::Snap`].
    fn check_snap(
        &mut self,
        system: &mut System,
        (start, end): (&Loading<D>, &Loading<D>),
        candidate: &Candidate<D>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Option<(usize, f64)>, IncrementError> {
        let grows = end.increment_from(start);
        let driven = self.driven(&grows);
        let stable = candidate.counts.negative == 0;
        if !stable || !self.has_large_strains() || driven > 0.0 && self.is_let_go() {
            return Ok(None);
        }
        let dofs = self.mesh_dofs();
        let between =
            |a: &[f64], b: &[f64]| largest(a.iter().zip(b).take(dofs).map(|(a, b)| a - b));
        let rest = vec![0.0; candidate.d_u.len()];
        let moved = between(&candidate.d_u, &rest);
        let expected = between(&self.predictor(start, end), &rest).max(driven);
        // Of the first increment of loads nothing is expected. One in which contact opens may pass a limit although no
        // tangent of its iterates was indefinite.
        let may_snap = expected > 0.0 || system.was_indefinite();
        if !may_snap || moved <= SNAP * expected.max(STILL * self.mesh.size()) {
            return Ok(None);
        }
        // A body that yields moves less in less of the increment, one that snaps as much.
        let (mut near, mut far) = ((0.0, rest), (1.0, candidate.d_u.clone()));
        let mut is_known = true;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (near.0 + far.0);
            let here = start.towards(end, middle);
            let increment = self.begin_increment(system, (start, &here), near.1.clone(), None);
            let Candidate { d_u, counts, .. } = match self.balance(system, increment, watch) {
                Err(error) if driven > 0.0 && !error.is_final() => {
                    is_known = false;
                    break;
                }
                found => found?,
            };
            self.spent.add(&counts);
            match between(&d_u, &near.1) > between(&far.1, &d_u) {
                true => far = (middle, d_u),
                false => near = (middle, d_u),
            }
        }
        let snaps = between(&far.1, &near.1) > 0.5 * moved;
        if snaps && is_known && !(self.may_leap && driven > 0.0) {
            return Err(IncrementError::Snap { moved });
        }
        self.evaluate(system, end, &candidate.d_u)?;
        let leaps = |dof: &usize| candidate.d_u[*dof].abs() == moved;
        let node = (0..dofs).find(leaps).map_or(0, |dof| dof / D);
        Ok(snaps.then_some((node, moved)))
    }

    /// The largest motion that a loading prescribes, of a turn at the size of the mesh \[mm\].
    pub(crate) fn driven(&self, grows: &Loading<D>) -> f64 {
        let turned = largest(grows.turn.iter().map(|(_, angle)| angle));
        let moved = largest(grows.displacement.values().copied());
        moved.max(turned * self.mesh.size())
    }

    /// Finds the equilibrium at the end of an increment by following it along the loading, in parts: history stands
    /// still, so that the equilibrium is that of one increment. Where a part may not go on for more than `patience`
    /// iterations without halving its residual, none may fail, else parts shrink where they do. All of them together may
    /// take [`FOLLOWED`] times the iterations of one: a shorter increment costs less than parts that hardly get on.
    ///
    /// # Errors
    /// That of a part as short as they may be, or after which no more may be tried.
    fn continued(
        &mut self,
        system: &mut System,
        (start, end): (&Loading<D>, &Loading<D>),
        patience: Option<usize>,
        watch: &mut dyn FnMut(&Self, &Iteration<'_>) -> ControlFlow<()>,
    ) -> Result<Candidate<D>, IncrementError> {
        let (mut done, mut length) = (0.0, PART);
        let mut last: Option<Candidate<D>> = None;
        let mut spent = Counts::default();
        // Those of parts that failed are in `self.spent` alone.
        let failed = self.spent.newton;
        let most = FOLLOWED * self.settings.iterations;
        loop {
            let to = if done + length < 1.0 - 0.5 * PART {
                done + length
            } else {
                1.0
            };
            let here = start.towards(end, to);
            let d_u = match &last {
                Some(last) => last.d_u.clone(),
                None => vec![0.0; self.state.displacement.len()],
            };
            let mut increment = self.begin_increment(system, (start, &here), d_u, None);
            increment.patience = patience;
            if let Some(last) = &last {
                self.follow_surfaces(&here, &last.d_u)?;
                increment.iterate.contact =
                    self.contact_forces(&last.kinematics, &last.solution.force);
                increment.solution = Some(last.solution.clone());
            }
            match self.balance(system, increment, watch) {
                Ok(mut candidate) => {
                    spent.add(&candidate.counts);
                    if to == 1.0 {
                        candidate.counts = spent;
                        return Ok(candidate);
                    }
                    done = to;
                    length = (2.0 * length).min(PART);
                    last = Some(candidate);
                }
                Err(error) => {
                    let tried = spent.newton + (self.spent.newton - failed);
                    let ends = patience.is_some() || length < SHORTEST || tried >= most;
                    if ends || error.is_broken_off() {
                        self.spent.add(&spent);
                        return Err(error);
                    }
                    length *= 0.5;
                }
            }
        }
    }
}
