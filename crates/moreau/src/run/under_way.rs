//! A simulation with files around it: those that grow with it, and what it takes to go on from there.

use super::drawing::{Drawing, pictures_of};
use super::files::{Mark, Stream, replace_file, write_file};
use super::vtu::{Collection, LIST};
use super::{RUN, Resumable, RunError, Watch, log};
use crate::deck::Vtu;
use crate::driver::{Clock, IncrementError, IncrementReport, Numbers};
use crate::simulation::{Converged, Outcome, Simulation, StepError};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// A run under way.
pub(super) struct Run<'a> {
    simulation: Simulation,
    directory: &'a Path,
    resolved: String,
    started: Clock,
    /// Seconds spent before the checkpoint that the run goes on from.
    before: f64,
    out: Out,
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
    /// As they were at some marks; what came later is cut off.
    fn reopen(directory: &Path, marks: [Mark; 4]) -> Result<Self, RunError> {
        let at = |k: usize| Stream::reopen(directory.join(STREAMS[k]), marks[k]);
        let mut streams = [at(0)?, at(1)?, at(2)?];
        // Nothing is cut before all are known to be what they were.
        let collection = Collection::reopen(directory.to_owned(), marks[3])?;
        streams.iter_mut().try_for_each(Stream::cut)?;
        let [history, contact, log] = streams;
        Ok(Self {
            history,
            contact,
            log,
            collection,
        })
    }

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

/// Where a run goes on from: seconds spent, and the files cut back to it.
pub(super) struct Reopened(f64, Out);

/// Takes over the numbers of a checkpoint. The simulation is of no use after an error, but for another try.
pub(super) fn reopen(
    simulation: &mut Simulation,
    directory: &Path,
    numbers: &[f64],
) -> Result<Reopened, Box<dyn std::error::Error>> {
    let numbers = &mut Numbers::Read(numbers);
    let mut before = 0.0;
    numbers.value(&mut before)?;
    let mut marks = [Mark::default(); 4];
    for mark in &mut marks {
        let (mut length, mut crc) = (0, 0);
        numbers.count(&mut length)?;
        numbers.count(&mut crc)?;
        (mark.length, mark.crc) = (length as u64, u32::try_from(crc)?);
    }
    simulation.read(numbers)?;
    Ok(Reopened(before, Out::reopen(directory, marks)?))
}

impl<'a> Run<'a> {
    /// At the beginning.
    pub(super) fn new(
        simulation: Simulation,
        directory: &'a Path,
        resolved: String,
    ) -> Result<Self, RunError> {
        let [history, contact, log] = STREAMS.map(|name| Stream::create(directory.join(name)));
        let mut out = Out {
            history: history?,
            contact: contact?,
            log: log?,
            collection: Collection::reopen(directory.to_owned(), Mark::default())?,
        };
        out.history.line(&simulation.history().header())?;
        out.contact.line(&simulation.contacts().header())?;
        out.flush()?;
        let from = Reopened(0.0, out);
        Ok(Self::going_on(simulation, directory, resolved, from))
    }

    /// From a checkpoint.
    pub(super) fn going_on(
        simulation: Simulation,
        directory: &'a Path,
        resolved: String,
        Reopened(before, out): Reopened,
    ) -> Self {
        Self {
            simulation,
            directory,
            resolved,
            started: Clock::start(),
            before,
            out,
        }
    }

    fn seconds(&self) -> f64 {
        self.before + self.started.elapsed().as_secs_f64()
    }

    /// Writes a checkpoint.
    pub(super) fn save(&self) -> Result<(), RunError> {
        self.state().write()
    }

    /// All that [`reopen`] needs. Files are flushed.
    fn state(&self) -> Resumable {
        let mut numbers = vec![self.seconds()];
        let mut streams: Vec<_> = STREAMS.map(|name| self.directory.join(name)).into();
        let marks = self.out.marks();
        for mark in &marks {
            numbers.extend([mark.length as f64, f64::from(mark.crc)]);
        }
        if marks[3].length > 0 {
            streams.push(self.directory.join(LIST));
        }
        self.simulation.write(&mut numbers);
        Resumable {
            directory: self.directory.to_owned(),
            streams,
            increment: self.simulation.increments(),
            resolved: self.resolved.clone(),
            numbers,
            summary: String::new(),
        }
    }

    /// Hands over the state to go on from, if anybody asks.
    fn reached(&self, watch: &mut dyn Watch) {
        watch.reached(&|| Resumable {
            summary: self.outcome().json(),
            ..self.state()
        });
    }

    fn outcome(&self) -> Outcome {
        Outcome {
            seconds: self.seconds(),
            ..self.simulation.outcome()
        }
    }

    /// Runs to the end, or to where it stops, and writes what is written at the end.
    pub(super) fn finish(mut self, watch: &mut dyn Watch) -> Result<Outcome, RunError> {
        self.steps(watch)?;
        let outcome = self.outcome();
        // There is as much memory for the files as the factor has held.
        self.simulation.free_system();
        let (simulation, out) = (&self.simulation, &mut self.out);
        let deck = simulation.deck();
        if let Some(grid) = simulation.failed() {
            write_file(&self.directory.join("failed.vtu"), &grid.vtu())?;
        }
        if simulation.increments() > 0 {
            let parts = (deck.vtu == Vtu::Last, deck.points == Vtu::Last);
            out.collection.add(simulation, parts)?;
        }
        out.flush()?;
        let now = SystemTime::now().duration_since(UNIX_EPOCH);
        let outcome = Outcome {
            finished: now.ok().map(|now| now.as_secs()),
            seconds: self.seconds(),
            ..outcome
        };
        replace_file(&self.directory.join(RUN), outcome.json().as_bytes())?;
        let simulation = &self.simulation;
        if simulation.increments() > 0 {
            let last = simulation.body().point_data;
            let drawing = Drawing::default();
            pictures_of(simulation, self.directory, Some(&last), &drawing)?;
        }
        Ok(outcome)
    }

    fn steps(&mut self, watch: &mut dyn Watch) -> Result<(), RunError> {
        let first = self.simulation.part();
        self.reached(watch);
        loop {
            if watch.stops() && !self.simulation.is_done() {
                self.out.flush()?;
                return self.save();
            }
            let log = &mut self.out.log;
            let mut broken = None;
            let (before, started) = (self.before, self.started);
            let outcome = self.simulation.advance(&mut |step, iteration| {
                let line = log::line(step, iteration, before + started.elapsed().as_secs_f64());
                watch.iterated(&line);
                broken = log.line(&line).err();
                match broken {
                    None => ControlFlow::Continue(()),
                    Some(_) => ControlFlow::Break(()),
                }
            });
            match (outcome, broken) {
                (Ok(Some(increment)), _) => {
                    self.record(&increment.report)?;
                    self.tell(&increment, first, watch)?;
                }
                (Err(StepError::Increment(IncrementError::Interrupted)), Some(error)) => {
                    return Err(error);
                }
                (Ok(None) | Err(_), _) => return Ok(()),
            }
        }
    }

    /// Tells of a converged increment, and writes a checkpoint if it is time for one.
    fn tell(
        &self,
        increment: &Converged,
        first: f64,
        watch: &mut dyn Watch,
    ) -> Result<(), RunError> {
        let rate = self.started.elapsed().as_secs_f64() / (increment.done - first);
        watch.converged(increment, rate * (1.0 - increment.done));
        let every = self.simulation.deck().checkpoint;
        if every > 0 && increment.report.increment.is_multiple_of(every) {
            self.save()?;
        }
        self.reached(watch);
        Ok(())
    }

    /// Writes a converged increment. Its row of the history is in the file then, and memory does not grow.
    fn record(&mut self, report: &IncrementReport) -> Result<(), RunError> {
        let (simulation, out) = (&mut self.simulation, &mut self.out);
        let history = simulation.history();
        out.history.line(&history.line(history.rows() - 1))?;
        let contacts = simulation.contacts();
        (0..contacts.rows()).try_for_each(|row| out.contact.line(&contacts.line(row)))?;
        out.flush()?;
        simulation.forget_history();
        let deck = simulation.deck();
        let parts = (deck.vtu == Vtu::All, deck.points == Vtu::All);
        out.collection.add(simulation, parts)?;
        match &report.mode {
            Some(mode) if deck.vtu != Vtu::None => out.collection.add_mode(simulation, mode),
            _ => Ok(()),
        }
    }
}
