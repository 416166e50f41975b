//! Running a problem: its steps, increment by increment, with the results written to a directory
//! as they come; nothing is printed, and no deck is read. What is in memory does not grow with the
//! number of increments.

mod body;
mod checkpoint;
mod contact;
mod diagnosis;
mod files;
mod grid;
mod history;
mod log;
mod outcome;
mod pictures;
mod report;
mod surface;
mod table;
mod view;
mod vtu;

pub use diagnosis::{Diagnosis, Flip};
pub(crate) use grid::vtu_of_mesh;
pub use outcome::{Outcome, RunStatus, Verdict};
pub use view::View;

use crate::deck::{Deck, Setup, Vtu};
use crate::driver::{Driver, Ramp, Reader, StepError, StepReport};
use crate::laws::Status;
use files::{Stream, read_text, write_file};
use history::History;
use log::Trace;
use outcome::Tally;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use table::Table;
use vtu::Collection;

/// A run that cannot be written, read back or continued.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// A file that could not be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file that could not be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// No checkpoint to go on from.
    #[error(
        "no checkpoint in {} can be used{why}: run the deck again", directory.display()
    )]
    NoCheckpoint {
        /// Where they should be.
        directory: PathBuf,
        /// What is wrong with each.
        why: String,
    },
    /// A field or an increment that the run did not write.
    #[error("{what} is not in the results, expected one of: {expected}")]
    Unknown {
        /// What was asked for.
        what: String,
        /// What there is.
        expected: String,
    },
}

/// A converged increment, as it is told while running.
#[derive(Debug)]
pub struct Event<'a> {
    /// Name of the step.
    pub step: &'a str,
    /// Number of the step, from 1.
    pub stage: usize,
    /// Number of steps.
    pub stages: usize,
    /// Increments the step was asked for.
    pub increments: usize,
    /// Part of all steps that has been done, in (0, 1].
    pub done: f64,
    /// Seconds left, if the rest goes as what was done since the run was started or resumed.
    pub seconds_left: f64,
    /// The report.
    pub report: &'a StepReport,
}

/// Who looks on while a problem runs, and may stop it.
pub trait Watch {
    /// After every converged increment.
    fn converged(&mut self, _event: &Event<'_>) {}

    /// With every line of `log.jsonl`.
    fn iterated(&mut self, _line: &str) {}

    /// Asked before every increment: whether to stop here, with a checkpoint.
    fn stops(&self) -> bool {
        false
    }
}

/// Nobody looks on.
impl Watch for () {}

/// Runs a problem and writes its results into a directory, which is made if need be.
///
/// A run that does not converge is an outcome, not an error: what converged is written.
///
/// # Errors
/// [`RunError::Write`] for the first file that could not be written.
pub fn run<const D: usize>(
    setup: Setup<D>,
    deck: &Deck,
    directory: &Path,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError>
where
    Driver<D>: View,
{
    fs::create_dir_all(directory).map_err(|source| RunError::Write {
        path: directory.to_owned(),
        source,
    })?;
    // Those of another run would be taken for its own.
    let _ = fs::remove_dir_all(directory.join(CHECKPOINTS));
    let resolved = deck.resolved();
    write_file(&directory.join(RESOLVED), resolved.as_bytes())?;
    let mut run = Run::new(setup, deck, directory, resolved)?;
    if deck.checkpoint > 0 {
        run.save()?;
    }
    run.finish(watch)
}

/// Continues a run from its last checkpoint, as if it had never stopped. `setup` and `deck` come
/// from the `deck.resolved.toml` of the directory.
///
/// # Errors
/// [`RunError::NoCheckpoint`] if none is whole; [`RunError::Write`].
pub fn resume<const D: usize>(
    setup: Setup<D>,
    deck: &Deck,
    directory: &Path,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError>
where
    Driver<D>: View,
{
    let resolved = read_text(&directory.join(RESOLVED))?;
    let checkpoints = directory.join(CHECKPOINTS);
    let mut why = String::new();
    let mut run = Run::unopened(setup, deck, directory, resolved);
    for path in checkpoint::list(&checkpoints) {
        let numbers = checkpoint::read(&path, &run.resolved);
        match numbers.and_then(|n| run.reopen(&n).map_err(|e| e.to_string())) {
            Ok(()) => return run.finish(watch),
            Err(error) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                why.push_str(&format!("; {name}: {error}"));
            }
        }
    }
    Err(RunError::NoCheckpoint {
        directory: checkpoints,
        why,
    })
}

/// What to draw of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Field on the body, a name in the VTU files; with `.x` and so on, a component.
    pub field: Option<String>,
    /// Increment, instead of the last.
    pub increment: Option<usize>,
    /// How many times displacements are drawn.
    pub magnification: Option<f64>,
}

/// Draws a run again from its files: history, contact line, deformed body, report; returns what
/// was written.
///
/// # Errors
/// [`RunError::Read`] for a directory without results, [`RunError::Unknown`] for a field or an
/// increment that is not in them, [`RunError::Write`].
pub fn draw<const D: usize>(
    setup: &Setup<D>,
    deck: &Deck,
    directory: &Path,
    drawing: &Drawing,
) -> Result<Vec<PathBuf>, RunError>
where
    Driver<D>: View,
{
    pictures_of(&setup.driver, deck, directory, None, drawing)
}

fn pictures_of<const D: usize>(
    driver: &Driver<D>,
    deck: &Deck,
    directory: &Path,
    last: Option<&[grid::Array]>,
    drawing: &Drawing,
) -> Result<Vec<PathBuf>, RunError>
where
    Driver<D>: View,
{
    let history = Table::read(&directory.join("history.csv"), |_, _| true)?;
    let increments = history.texts("increment");
    let number = match (drawing.increment, increments.last()) {
        (Some(number), _) if !increments.contains(&number.to_string().as_str()) => {
            return Err(RunError::Unknown {
                what: format!("increment {number}"),
                expected: format!("1 to {}", increments.last().unwrap_or(&"0")),
            });
        }
        (Some(number), _) => number,
        (None, last) => last.and_then(|t| t.parse().ok()).unwrap_or(0),
    };
    // What was asked for is kept apart from what every run has.
    let asked = drawing.field.iter().map(|f| format!("-{f}"));
    let asked: String = asked
        .chain(drawing.increment.iter().map(|n| format!("-{n}")))
        .collect();
    let mut written = Vec::new();
    let mut write = |name: String, text: Option<String>| {
        if let Some(text) = text {
            let path = directory.join(name);
            write_file(&path, text.as_bytes())?;
            written.push(path);
        }
        Ok(())
    };
    write("history.svg".into(), pictures::forces(&history, deck))?;
    if let Some(mesh) = driver.plane() {
        let contacts = pictures::contact_table(directory, &[number])?;
        let at = drawing.increment.map_or(String::new(), |n| format!("-{n}"));
        write(
            format!("contact{at}.svg"),
            pictures::tractions(&contacts, number, deck),
        )?;
        let files = vtu::bodies(directory);
        let arrays = match files.iter().find(|f| f.0 == number) {
            Some((_, _, path)) => Some(vtu::read_point_data(path)?),
            None if drawing.increment.is_some() => {
                let all: Vec<String> = files.iter().map(|f| f.0.to_string()).collect();
                return Err(RunError::Unknown {
                    what: format!("the body of increment {number}"),
                    expected: all.join(", "),
                });
            }
            None => last.map(<[_]>::to_vec),
        };
        let field = drawing.field.as_deref();
        if let Some(arrays) = arrays {
            let name = field.unwrap_or(pictures::usual_field(deck));
            if pictures::field(&arrays, name).is_none() {
                let all = pictures::fields(&arrays);
                return Err(RunError::Unknown {
                    what: format!("the field \"{name}\""),
                    expected: all.join(", "),
                });
            }
            let svg = pictures::deformed(mesh, deck, &arrays, name, drawing.magnification);
            write(format!("deformed{asked}.svg"), svg)?;
        }
    }
    let page = report::report(driver, deck, directory, last)?;
    write("report.html".into(), Some(page))?;
    Ok(written)
}

const RESOLVED: &str = "deck.resolved.toml";
const CHECKPOINTS: &str = "checkpoint";

/// A run under way.
struct Run<'a, const D: usize> {
    setup: Setup<D>,
    deck: &'a Deck,
    directory: &'a Path,
    resolved: String,
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

impl<'a, const D: usize> Run<'a, D>
where
    Driver<D>: View,
{
    fn unopened(setup: Setup<D>, deck: &'a Deck, directory: &'a Path, resolved: String) -> Self {
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
    fn new(
        setup: Setup<D>,
        deck: &'a Deck,
        directory: &'a Path,
        resolved: String,
    ) -> Result<Self, RunError> {
        let mut run = Self::unopened(setup, deck, directory, resolved);
        let mut out = Out {
            history: Stream::create(directory.join("history.csv"))?,
            contact: Stream::create(directory.join("contact.csv"))?,
            log: Stream::create(directory.join("log.jsonl"))?,
            collection: Collection::reopen(directory.to_owned(), 0)?,
        };
        out.history.line(&run.history.header())?;
        out.contact.line(&contact::header(deck.units))?;
        run.out = Some(out);
        Ok(run)
    }

    fn seconds(&self) -> f64 {
        self.before + self.started.elapsed().as_secs_f64()
    }

    /// Writes a checkpoint: all that [`Run::reopen`] needs.
    fn save(&mut self) -> Result<(), RunError> {
        let mut numbers = vec![self.seconds(), self.stage as f64];
        if let Some(out) = &mut self.out {
            for stream in [&mut out.history, &mut out.contact, &mut out.log] {
                stream.sync()?;
                numbers.push(stream.length() as f64);
            }
            out.collection.sync()?;
            numbers.push(out.collection.length() as f64);
        }
        self.tally.write(&mut numbers);
        numbers.push(self.history.last.len() as f64);
        numbers.extend(&self.history.last);
        self.setup.driver.write(&mut numbers);
        numbers.push(f64::from(u8::from(self.ramp.is_some())));
        if let Some(ramp) = &self.ramp {
            ramp.write(&mut numbers);
        }
        let directory = self.directory.join(CHECKPOINTS);
        let increment = self.setup.driver.increments();
        checkpoint::write(&directory, increment, &self.resolved, &numbers)
    }

    /// Takes over a checkpoint, and cuts the files back to it.
    fn reopen(&mut self, numbers: &[f64]) -> Result<(), Box<dyn std::error::Error>> {
        let from = &mut Reader::new(numbers);
        self.before = from.number()?;
        self.stage = from.count()?;
        let lengths = [from.count()?, from.count()?, from.count()?, from.count()?];
        let [history, contact, log, list] = lengths.map(|n| n as u64);
        self.tally.read(from)?;
        let columns = from.count()?;
        self.history.last = from.take(columns)?.to_vec();
        self.setup.driver.read(from)?;
        self.ramp = match (from.count()?, self.setup.stages.get(self.stage)) {
            (1, Some(stage)) => Some(Ramp::read(&stage.step, stage.increments, from)?),
            _ => None,
        };
        let at = |name: &str| self.directory.join(name);
        self.out = Some(Out {
            history: Stream::reopen(at("history.csv"), history)?,
            contact: Stream::reopen(at("contact.csv"), contact)?,
            log: Stream::reopen(at("log.jsonl"), log)?,
            collection: Collection::reopen(self.directory.to_owned(), list)?,
        });
        Ok(())
    }

    /// Runs to the end, or to where it stops, and writes what is written at the end.
    fn finish(mut self, watch: &mut dyn Watch) -> Result<Outcome, RunError> {
        let (status, diagnosis) = match self.steps(watch)? {
            Ending::Done => (RunStatus::Done, None),
            Ending::Interrupted => {
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
                let sought = matches!(error, StepError::Model(_) | StepError::Collapse { .. });
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
            if self.deck.vtu == Vtu::Last && driver.increments() > 0 {
                out.collection.add(driver, self.history.time())?;
            }
            out.history.flush()?;
            out.contact.flush()?;
            out.log.flush()?;
        }
        let outcome = outcome::conclude(
            driver,
            self.deck,
            &self.history,
            &self.tally,
            (status, diagnosis),
            self.seconds(),
        );
        let json = outcome.json();
        write_file(&self.directory.join("run.json"), json.as_bytes())?;
        if driver.increments() > 0 {
            let last = body::body(driver).0.point_data;
            let drawing = Drawing::default();
            pictures_of(driver, self.deck, self.directory, Some(&last), &drawing)?;
        }
        Ok(outcome)
    }

    fn steps(&mut self, watch: &mut dyn Watch) -> Result<Ending, RunError> {
        let first = self.stage as f64 + self.ramp.as_ref().map_or(0.0, Ramp::done);
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
                    Err(StepError::Collapse { collapse, step }) => {
                        self.tally.collapse = Some((self.stage, collapse));
                        if self.setup.stages[self.stage].until_collapse {
                            collapsed = true;
                            break;
                        }
                        let error = StepError::Collapse { collapse, step };
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
                    self.ramp = Some(ramp.clone());
                    self.save()?;
                    self.ramp = None;
                }
            }
            if to_collapse && !collapsed {
                return Ok(Ending::Carried(name));
            }
            self.stage += 1;
        }
        Ok(Ending::Done)
    }

    /// Writes a converged increment.
    fn record(&mut self, report: &StepReport) -> Result<(), RunError> {
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
        for stream in [&mut out.history, &mut out.contact, &mut out.log] {
            stream.flush()?;
        }
        self.tally.add(driver, report);
        if self.deck.vtu == Vtu::All {
            out.collection.add(driver, self.history.time())?;
        }
        Ok(())
    }
}

/// How the steps ended.
enum Ending {
    Done,
    Interrupted,
    /// A step that was to end in collapse has not.
    Carried(String),
    Failed(StepError),
}

/// A number as text that is read back exactly.
fn number(value: f64) -> String {
    // Adding zero turns −0 into 0.
    match value.fract() == 0.0 && value.abs() < 1e15 {
        true => format!("{:.0}", value + 0.0),
        false => format!("{value:?}"),
    }
}

fn status_name(status: Status) -> &'static str {
    match status {
        Status::Open => "open",
        Status::Stick => "stick",
        Status::Slip => "slip",
    }
}
