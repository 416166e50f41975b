//! A problem of one dimension under way: its steps, increment by increment, and what is taken note of on the way;
//! no file.

use super::history::{History, Place};
use super::outcome::{self, Outcome, RunStatus, Tally};
use super::trace::Trace;
use super::{Converged, Diagnosis, StepError, contact};
use crate::deck::{Deck, Setup, Stage};
use crate::driver::{
    Clock, Driver, IncrementError, IncrementReport, Iteration, ModelError, Numbers, Ramp, Saved,
};
use crate::grids;
use crate::table::Table;
use crate::vtu::Grid;
use std::ops::ControlFlow;

/// Who sees every iterate, with the name of the step, and may break the increment off.
pub(super) type Watch<'a> = dyn FnMut(&str, &Iteration<'_>) -> ControlFlow<()> + 'a;

/// A problem under way.
pub(crate) struct Course<const D: usize> {
    setup: Setup<D>,
    /// Step under way, from 0, and how far it is.
    stage: usize,
    ramp: Option<Ramp<D>>,
    history: History,
    tally: Tally,
    trace: Trace,
    /// Why it does not go on.
    failed: Option<(StepError, Option<Diagnosis>)>,
    /// Time that increments took, of those that were interrupted too.
    seconds: f64,
}

impl<const D: usize> Course<D> {
    pub(super) fn new(deck: &Deck, setup: Setup<D>) -> Self {
        Self {
            history: History::new(deck.units, &setup),
            tally: Tally::new(&setup.driver),
            setup,
            stage: 0,
            ramp: None,
            trace: Trace::new(),
            failed: None,
            seconds: 0.0,
        }
    }

    /// [`Driver::serve`].
    pub(super) fn serve(self) {
        self.setup.driver.serve();
    }

    pub(crate) fn driver(&self) -> &Driver<D> {
        &self.setup.driver
    }

    pub(super) fn history(&self) -> &Table {
        self.history.table()
    }

    pub(super) fn forget_history(&mut self) {
        self.history.forget();
    }

    pub(super) fn is_done(&self) -> bool {
        self.stage >= self.setup.stages.len()
    }

    /// Steps done, with the part of the one under way.
    pub(super) fn done(&self) -> f64 {
        self.stage as f64 + self.ramp.as_ref().map_or(0.0, Ramp::done)
    }

    /// Part of the run that is done, by the increments that steps plan.
    pub(super) fn part(&self) -> f64 {
        let planned = |stages: &[Stage<D>]| -> f64 {
            let counts = stages.iter().map(|stage| stage.increments.count());
            counts.sum::<usize>() as f64
        };
        let stages = &self.setup.stages;
        let under_way = stages.get(self.stage..=self.stage).unwrap_or_default();
        let part = self.ramp.as_ref().map_or(0.0, Ramp::done);
        (planned(&stages[..self.stage]) + part * planned(under_way)) / planned(stages).max(1.0)
    }

    /// Steps of which at least the first increment has been done.
    pub(super) fn begun(&self) -> usize {
        let under_way = self.ramp.as_ref().is_some_and(|ramp| ramp.done() > 0.0);
        self.stage + usize::from(under_way)
    }

    /// See [`Simulation::advance`](super::Simulation::advance).
    pub(super) fn advance(
        &mut self,
        deck: &Deck,
        watch: &mut Watch<'_>,
    ) -> Result<Option<Converged>, StepError> {
        let started = Clock::start();
        let outcome = self.next(deck, watch);
        self.seconds += started.elapsed().as_secs_f64();
        outcome
    }

    fn next(&mut self, deck: &Deck, watch: &mut Watch<'_>) -> Result<Option<Converged>, StepError> {
        if let Some((error, _)) = &self.failed {
            return Err(error.clone());
        }
        while !self.is_done() {
            let mut ramp = match self.ramp.take() {
                Some(ramp) => ramp,
                None => match self.begin() {
                    Ok(ramp) => ramp,
                    Err(error) => return Err(self.fail(deck, IncrementError::from(error))),
                },
            };
            let stage = &self.setup.stages[self.stage];
            let (driver, trace) = (&mut self.setup.driver, &mut self.trace);
            if ramp.is_done() {
                // Its loads were to grow until nothing carries them.
                let step = stage.step.name().to_owned();
                let stage = (self.stage, stage.until_collapse);
                self.tally.warnings.end_of_step(driver, stage);
                self.ramp = Some(ramp);
                return Err(self.fail(deck, StepError::Carried { step }));
            }
            let outcome = driver.proceed(&mut ramp, &mut |iteration| {
                trace.note(iteration);
                watch(stage.step.name(), iteration)
            });
            self.ramp = Some(ramp);
            match outcome {
                Ok(report) => return Ok(Some(self.converged(deck, report))),
                Err(error) if error.is_broken_off() => return Err(error.into()),
                Err(IncrementError::Collapse { collapse, step }) => {
                    self.tally.collapse = Some((self.stage, collapse));
                    if !self.setup.stages[self.stage].until_collapse {
                        let error = IncrementError::Collapse { collapse, step };
                        return Err(self.fail(deck, error));
                    }
                    self.end_step();
                }
                Err(error) => return Err(self.fail(deck, error)),
            }
        }
        Ok(None)
    }

    /// The step at hand before its first increment.
    fn begin(&mut self) -> Result<Ramp<D>, ModelError> {
        let (driver, stages) = (&self.setup.driver, &self.setup.stages);
        let Stage {
            step, increments, ..
        } = &stages[self.stage];
        let before = self.stage.checked_sub(1).map(|k| &stages[k].directions[..]);
        let ramp = driver.begin(step, *increments)?;
        let end = driver.loading(step)?;
        self.history.begin(driver, &end, before.unwrap_or_default());
        Ok(ramp)
    }

    /// Takes note of a converged increment, and of the end of its step if that is it.
    fn converged(&mut self, deck: &Deck, report: IncrementReport) -> Converged {
        let (stages, stage) = (self.setup.stages.len(), &self.setup.stages[self.stage]);
        let place = Place {
            stage: self.stage + 1,
            directions: &stage.directions,
        };
        let (driver, until_collapse) = (&self.setup.driver, stage.until_collapse);
        self.history.record(driver, &report, &place);
        self.tally.add((driver, deck), &report, until_collapse);
        let converged = Converged {
            step: stage.step.name().to_owned(),
            stage: place.stage,
            stages,
            increments: stage.increments.count(),
            done: self.part(),
            report,
        };
        if !until_collapse && self.ramp.as_ref().is_some_and(Ramp::is_done) {
            self.end_step();
        }
        converged
    }

    fn end_step(&mut self) {
        let (warnings, driver) = (&mut self.tally.warnings, &mut self.setup.driver);
        let to_collapse = self.setup.stages[self.stage].until_collapse;
        warnings.end_of_step(driver, (self.stage, to_collapse));
        self.stage += 1;
        self.ramp = None;
    }

    /// Takes note of why it does not go on.
    fn fail(&mut self, deck: &Deck, error: impl Into<StepError>) -> StepError {
        let error = error.into();
        let diagnosis = match &error {
            StepError::Carried { .. }
            | StepError::Increment(
                IncrementError::Model(_)
                | IncrementError::Collapse { .. }
                | IncrementError::RunsAway { .. },
            ) => None,
            StepError::Increment(cause) => {
                let (driver, trace) = (&self.setup.driver, &self.trace);
                let step = self.setup.stages.get(self.stage).map(|s| &s.step);
                let at = (self.stage, step);
                Some(Diagnosis::new(driver, deck, at, trace, cause))
            }
        };
        self.failed = Some((error.clone(), diagnosis));
        error
    }

    /// See [`Simulation::contacts`](super::Simulation::contacts).
    pub(super) fn contacts(&self, deck: &Deck) -> Table {
        let stage = self.history().numbers("step").pop().unwrap_or(0.0);
        contact::table(&self.setup.driver, deck.units, stage as usize)
    }

    /// See [`Simulation::free_system`](super::Simulation::free_system).
    pub(super) fn free_system(&mut self) {
        self.setup.driver.free_system();
    }

    /// See [`Simulation::failed`](super::Simulation::failed).
    pub(super) fn failed(&self) -> Option<Grid> {
        let driver = &self.setup.driver;
        let (_, diagnosis) = self.failed.as_ref()?;
        if diagnosis.is_none() || !self.trace.is_of_next(driver) {
            return None;
        }
        let displacement = self.trace.displacement(driver);
        Some(grids::failed(driver, &displacement, &self.trace.residual))
    }

    pub(super) fn outcome(&self, deck: &Deck) -> Outcome {
        let how = match &self.failed {
            Some((error, diagnosis)) => (RunStatus::of(error), diagnosis.clone()),
            None if self.is_done() => (RunStatus::Done, None),
            None => (RunStatus::Interrupted(self.driver().increments()), None),
        };
        let history = &self.history;
        outcome::conclude(&self.setup, deck, history, &self.tally, how, self.seconds)
    }

    /// Appends all that [`Course::read`] needs.
    pub(super) fn write(&self, numbers: &mut Vec<f64>) {
        numbers.extend([self.seconds, self.stage as f64]);
        self.tally.write(numbers);
        self.history.write(numbers);
        self.setup.driver.write(numbers);
        numbers.push(f64::from(u8::from(self.ramp.is_some())));
        if let Some(ramp) = &self.ramp {
            ramp.write(numbers);
        }
    }

    /// Takes over what [`Course::write`] left of the same problem; of no use after an error.
    pub(super) fn read(&mut self, numbers: &mut Numbers<'_>) -> Result<(), ModelError> {
        numbers.value(&mut self.seconds)?;
        numbers.count(&mut self.stage)?;
        self.tally.read(numbers)?;
        self.history.read(numbers)?;
        let driver = &mut self.setup.driver;
        driver.read(numbers)?;
        let mut steps = false;
        numbers.flag(&mut steps)?;
        self.ramp = match self.setup.stages.get(self.stage) {
            Some(Stage {
                step, increments, ..
            }) if steps => {
                let mut ramp = driver.begin(step, *increments)?;
                ramp.read(numbers)?;
                Some(ramp)
            }
            _ => None,
        };
        self.failed = None;
        Ok(())
    }

    /// Goes on where another left off whose steps were the same as far as they were begun: what is left of the last
    /// of those is given up.
    pub(super) fn take_over(&mut self, other: &Self) -> Result<(), ModelError> {
        let mut numbers = Vec::new();
        other.setup.driver.write(&mut numbers);
        self.setup.driver.read(&mut Numbers::Read(&numbers))?;
        self.history.take_over(&other.history);
        self.tally = other.tally.clone();
        (self.stage, self.seconds) = (other.stage, other.seconds);
        if self.stage < other.begun() {
            self.end_step();
        }
        Ok(())
    }
}
