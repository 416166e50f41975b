//! A run under way: its steps, the files that grow with them, and what it takes to go on from there.

use super::drawing::{Drawing, pictures_of};
use super::files::{Mark, Stream, replace_file};
use super::history::{self, History};
use super::log::Trace;
use super::outcome::{self, Outcome, RunStatus, Tally};
use super::vtu::{self, Collection, LIST};
use super::{Diagnosis, Event, RUN, Resumable, RunError, View, Watch, contact};
use crate::deck::{Deck, Setup, Vtu};
use crate::driver::{Driver, IncrementError, IncrementReport, Numbers, Ramp, Saved};
use std::path::Path;
use std::time::Instant;

/// A run under way.
pub(super) struct Run<'a, const D: usize> {
    setup: Setup<D>,
    deck: &'a Deck,
    directory: &'a Path,
    pub(super) resolved: String,
    started: Instant,
    /// Seconds spent before the checkpoint that the run goes on from.
    before: f64,
    /// Step under way, from 0, and how far it is.
    stage: usize,
    ramp: Option<Ramp<D>>,
    history: History,
    tally: Tally,
    trace: Trace,
    out: Option<Out>,
}

/// The files that grow.
struct Out {
    history: Stream,
    contact: Stream,
    log: Stream,
    collection: Collection,
}

/// Names of the streams, in the order of [`Out`].
const STREAMS: [&str; 3] = ["history.csv", "contact.csv", "log.jsonl"];

impl Out {
    fn marks(&self) -> [Mark; 4] {
        let Self {
            history,
            contact,
            log,
            collection,
        } = self;
        let list = collection.mark();
        [history.mark(), contact.mark(), log.mark(), list]
    }

    fn flush(&mut self) -> Result<(), RunError> {
        let streams = [&mut self.history, &mut self.contact, &mut self.log];
        streams.into_iter().try_for_each(Stream::flush)
    }
}

impl<'a, const D: usize> Run<'a, D>
where
    Driver<D>: View,
{
    pub(super) fn unopened(
        setup: Setup<D>,
        deck: &'a Deck,
        directory: &'a Path,
        resolved: String,
    ) -> Self {
        Self {
            history: History::new(deck.units, &setup),
            tally: Tally::new(&setup.driver),
            setup,
            deck,
            directory,
            resolved,
            started: Instant::now(),
            before: 0.0,
            stage: 0,
            ramp: None,
            trace: Trace::new(),
            out: None,
        }
    }

    /// At the beginning.
    pub(super) fn new(
        setup: Setup<D>,
        deck: &'a Deck,
        directory: &'a Path,
        resolved: String,
    ) -> Result<Self, RunError> {
        let mut run = Self::unopened(setup, deck, directory, resolved);
        let [history, contact, log] = STREAMS.map(|name| Stream::create(directory.join(name)));
        let mut out = Out {
            history: history?,
            contact: contact?,
            log: log?,
            collection: Collection::reopen(directory.to_owned(), Mark::default())?,
        };
        out.history.line(&run.history.header())?;
        out.contact.line(&contact::header(deck.units))?;
        out.flush()?;
        run.out = Some(out);
        Ok(run)
    }

    fn seconds(&self) -> f64 {
        self.before + self.started.elapsed().as_secs_f64()
    }

    /// Writes a checkpoint.
    pub(super) fn save(&mut self) -> Result<(), RunError> {
        self.state(self.ramp.as_ref()).write()
    }

    /// All that [`Run::reopen`] needs, in the middle of a step or between two. Files are flushed.
    fn state(&self, ramp: Option<&Ramp<D>>) -> Resumable {
        let mut numbers = vec![self.seconds(), self.stage as f64];
        let mut streams: Vec<_> = STREAMS.map(|name| self.directory.join(name)).into();
        let marks = self.out.as_ref().map_or_else(Default::default, Out::marks);
        for mark in &marks {
            numbers.extend([mark.length as f64, f64::from(mark.crc)]);
        }
        if marks[3].length > 0 {
            streams.push(self.directory.join(LIST));
        }
        self.tally.write(&mut numbers);
        numbers.push(self.history.last.len() as f64);
        numbers.extend(&self.history.last);
        self.setup.driver.write(&mut numbers);
        numbers.push(f64::from(u8::from(ramp.is_some())));
        if let Some(ramp) = ramp {
            ramp.write(&mut numbers);
        }
        Resumable {
            directory: self.directory.to_owned(),
            streams,
            increment: self.setup.driver.increments(),
            resolved: self.resolved.clone(),
            numbers,
            summary: String::new(),
        }
    }

    /// Hands over the state to go on from, if anybody asks.
    fn reached(&self, ramp: Option<&Ramp<D>>, watch: &mut dyn Watch) {
        watch.reached(&|| {
            let increment = self.setup.driver.increments();
            let outcome = self.outcome((RunStatus::Interrupted(increment), None));
            Resumable {
                summary: outcome.json(),
                ..self.state(ramp)
            }
        });
    }

    fn outcome(&self, how: (RunStatus, Option<Diagnosis>)) -> Outcome {
        outcome::conclude(
            &self.setup,
            self.deck,
            &self.history,
            &self.tally,
            how,
            self.seconds(),
        )
    }

    /// Takes over a checkpoint, and cuts the files back to it.
    pub(super) fn reopen(&mut self, numbers: &[f64]) -> Result<(), Box<dyn std::error::Error>> {
        let numbers = &mut Numbers::Read(numbers);
        numbers.value(&mut self.before)?;
        numbers.count(&mut self.stage)?;
        let mut marks = [Mark::default(); 4];
        for mark in &mut marks {
            let (mut length, mut crc) = (0, 0);
            numbers.count(&mut length)?;
            numbers.count(&mut crc)?;
            (mark.length, mark.crc) = (length as u64, u32::try_from(crc)?);
        }
        self.tally.read(numbers)?;
        numbers.list(&mut self.history.last)?;
        let driver = &mut self.setup.driver;
        driver.read(numbers)?;
        let mut steps = false;
        numbers.flag(&mut steps)?;
        self.ramp = match self.setup.stages.get(self.stage) {
            Some(stage) if steps => {
                let mut ramp = driver.begin(&stage.step, stage.increments)?;
                ramp.read(numbers)?;
                Some(ramp)
            }
            _ => None,
        };
        let at = |k: usize| Stream::reopen(self.directory.join(STREAMS[k]), marks[k]);
        let mut streams = [at(0)?, at(1)?, at(2)?];
        // Nothing is cut before all are known to be what they were.
        let collection = Collection::reopen(self.directory.to_owned(), marks[3])?;
        streams.iter_mut().try_for_each(Stream::cut)?;
        let [history, contact, log] = streams;
        self.out = Some(Out {
            history,
            contact,
            log,
            collection,
        });
        Ok(())
    }

    /// Runs to the end, or to where it stops, and writes what is written at the end.
    pub(super) fn finish(mut self, watch: &mut dyn Watch) -> Result<Outcome, RunError> {
        let (status, diagnosis) = match self.steps(watch)? {
            Ending::Done => (RunStatus::Done, None),
            Ending::Interrupted => {
                if let Some(out) = &mut self.out {
                    out.flush()?;
                }
                self.save()?;
                let increment = self.setup.driver.increments();
                (RunStatus::Interrupted(increment), None)
            }
            Ending::Carried(step) => {
                let error = format!(
                    "step {step:?} was to end in collapse, but its loads are carried: increase them"
                );
                (RunStatus::NotConverged(error), None)
            }
            Ending::Failed(error) => {
                let sought = matches!(
                    error,
                    IncrementError::Model(_) | IncrementError::Collapse { .. }
                );
                let diagnosis = (!sought).then(|| {
                    let (driver, trace) = (&self.setup.driver, &self.trace);
                    Diagnosis::new(driver, self.deck, self.stage, trace, &error)
                });
                (RunStatus::of(Some(&error)), diagnosis)
            }
        };
        let driver = &self.setup.driver;
        if let Some(out) = &mut self.out {
            if diagnosis.is_some() && self.trace.is_of_next(driver) {
                let displacement = self.trace.displacement(driver);
                let residual = &self.trace.residual;
                out.collection.failed(driver, &displacement, residual)?;
            }
            if driver.increments() > 0 {
                let parts = (self.deck.vtu == Vtu::Last, self.deck.points == Vtu::Last);
                out.collection.add(driver, self.history.time(), parts)?;
            }
            out.flush()?;
        }
        let outcome = self.outcome((status, diagnosis));
        replace_file(&self.directory.join(RUN), outcome.json().as_bytes())?;
        if driver.increments() > 0 {
            let last = vtu::body::body(driver).0.point_data;
            let drawing = Drawing::default();
            pictures_of(driver, self.deck, self.directory, Some(&last), &drawing)?;
        }
        Ok(outcome)
    }

    fn steps(&mut self, watch: &mut dyn Watch) -> Result<Ending, RunError> {
        let first = self.stage as f64 + self.ramp.as_ref().map_or(0.0, Ramp::done);
        self.reached(self.ramp.as_ref(), watch);
        while let Some(stage) = self.setup.stages.get(self.stage) {
            let mut ramp = match self.ramp.take() {
                Some(ramp) => ramp,
                None => match self.setup.driver.begin(&stage.step, stage.increments) {
                    Ok(ramp) => ramp,
                    Err(error) => return Ok(Ending::Failed(error.into())),
                },
            };
            let name = stage.step.name().to_owned();
            let to_collapse = stage.until_collapse;
            let mut collapsed = false;
            while !ramp.is_done() {
                if watch.stops() {
                    self.ramp = Some(ramp);
                    return Ok(Ending::Interrupted);
                }
                let Some(out) = &mut self.out else { break };
                let (trace, log) = (&mut self.trace, &mut out.log);
                let mut broken = None;
                let result = self.setup.driver.proceed(&mut ramp, &mut |iteration| {
                    let line = trace.note(&name, iteration);
                    watch.iterated(&line);
                    broken = broken.take().or(log.line(&line).err());
                });
                if let Some(error) = broken {
                    return Err(error);
                }
                let report = match result {
                    Ok(report) => report,
                    Err(IncrementError::Collapse { collapse, step }) => {
                        self.tally.collapse = Some((self.stage, collapse));
                        if self.setup.stages[self.stage].until_collapse {
                            collapsed = true;
                            break;
                        }
                        let error = IncrementError::Collapse { collapse, step };
                        return Ok(Ending::Failed(error));
                    }
                    Err(error) => return Ok(Ending::Failed(error)),
                };
                self.record(&report)?;
                let stages = self.setup.stages.len();
                let done = self.stage as f64 + ramp.done();
                let rate = self.started.elapsed().as_secs_f64() / (done - first);
                watch.converged(&Event {
                    step: &name,
                    stage: self.stage + 1,
                    stages,
                    increments: self.setup.stages[self.stage].increments.count(),
                    done: done / stages as f64,
                    seconds_left: rate * (stages as f64 - done),
                    report: &report,
                });
                let every = self.deck.checkpoint;
                if every > 0 && report.increment.is_multiple_of(every) {
                    self.state(Some(&ramp)).write()?;
                }
                self.reached(Some(&ramp), watch);
            }
            (self.tally.warnings).end_of_step(&mut self.setup.driver, self.stage);
            if to_collapse && !collapsed {
                return Ok(Ending::Carried(name));
            }
            self.stage += 1;
        }
        Ok(Ending::Done)
    }

    /// Writes a converged increment.
    fn record(&mut self, report: &IncrementReport) -> Result<(), RunError> {
        let Some(out) = &mut self.out else {
            return Ok(());
        };
        let driver = &self.setup.driver;
        let place = history::Place {
            stage: self.stage + 1,
            directions: &self.setup.stages[self.stage].directions,
        };
        let row = self.history.record(driver, report, &place);
        out.history.line(&row)?;
        for line in contact::rows(driver, report, place.stage) {
            out.contact.line(&line)?;
        }
        out.flush()?;
        let to_collapse = self.setup.stages[self.stage].until_collapse;
        self.tally.add(driver, report, to_collapse);
        let parts = (self.deck.vtu == Vtu::All, self.deck.points == Vtu::All);
        out.collection.add(driver, self.history.time(), parts)
    }
}

/// How the steps ended.
enum Ending {
    Done,
    Interrupted,
    /// A step that was to end in collapse has not.
    Carried(String),
    Failed(IncrementError),
}
