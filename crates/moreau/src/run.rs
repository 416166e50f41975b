//! Running a problem: its steps, increment by increment, with the results written to a directory
//! as they come; nothing is printed, and no deck is read.

mod contact;
mod history;
mod outcome;
mod pictures;
mod view;
mod vtu;

pub use history::columns;
pub use outcome::{Outcome, RunStatus, Verdict};
pub use view::{NodalField, View};
pub(crate) use vtu::vtu_of_mesh;

use crate::deck::{Deck, Setup, Vtu};
use crate::driver::{Driver, StepError, StepReport};
use crate::laws::Status;
use history::History;
use outcome::Tally;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;
use vtu::Collection;

/// A file that could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub source: std::io::Error,
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
    /// The report.
    pub report: &'a StepReport,
}

/// Runs a problem and writes its results into a directory, which is made if need be.
///
/// A run that does not converge is an outcome, not an error: what converged is written.
///
/// # Errors
/// [`OutputError`] for the first file that could not be written.
pub fn run<const D: usize>(
    setup: Setup<D>,
    deck: &Deck,
    directory: &Path,
    mut observe: impl FnMut(&Event<'_>),
) -> Result<Outcome, OutputError>
where
    Driver<D>: View,
{
    let started = Instant::now();
    let at = |path: PathBuf| move |source| OutputError { path, source };
    fs::create_dir_all(directory).map_err(at(directory.to_owned()))?;
    write_file(
        &directory.join("deck.resolved.toml"),
        deck.resolved().as_bytes(),
    )?;
    let Setup {
        mut driver,
        stages,
        held,
        tools,
        ..
    } = setup;
    let mut recorder = Recorder {
        history: History::new(deck.units, D, held, tools.clone()),
        csv: Csv::create(directory.join("history.csv"))?,
        contact_csv: Csv::create(directory.join("contact.csv"))?,
        collection: Collection::new(directory.to_owned()),
        tally: Tally::new(&driver),
        vtu: deck.vtu,
    };
    recorder.csv.line(&recorder.history.header())?;
    recorder.contact_csv.line(&contact::header(deck.units))?;
    let mut failure: Option<StepError> = None;
    let mut broken: Option<OutputError> = None;
    let mut from = vec![vec![0.0; D]; tools.len()];
    for (index, stage) in stages.iter().enumerate() {
        let to: Vec<Vec<f64>> = match driver.loading(&stage.step) {
            Ok(loading) => loading
                .tools
                .iter()
                .map(|u| u.iter().copied().collect())
                .collect(),
            Err(error) => {
                failure = Some(error.into());
                break;
            }
        };
        let result = driver.run(&stage.step, stage.increments, |driver, report| {
            let place = history::Place {
                stage: index + 1,
                directions: &stage.directions,
                tools: history::between(&from, &to, report.fraction),
            };
            if broken.is_none() {
                broken = recorder.record(driver, report, &place).err();
            }
            observe(&Event {
                step: stage.step.name(),
                stage: index + 1,
                stages: stages.len(),
                increments: stage.increments.count(),
                report,
            });
        });
        if let Err(error) = result {
            failure = Some(error);
            break;
        }
        from = to;
    }
    if let Some(error) = broken {
        return Err(error);
    }
    recorder.finish(&driver, deck)?;
    let seconds = started.elapsed().as_secs_f64();
    let outcome = outcome::conclude(
        &driver,
        deck,
        recorder.history,
        recorder.tally,
        failure,
        seconds,
    );
    let json = outcome.json();
    write_file(&directory.join("run.json"), json.as_bytes())?;
    Ok(outcome)
}

/// Everything that is written while running.
struct Recorder {
    history: History,
    csv: Csv,
    contact_csv: Csv,
    collection: Collection,
    tally: Tally,
    vtu: Vtu,
}

impl Recorder {
    fn record<const D: usize>(
        &mut self,
        driver: &Driver<D>,
        report: &StepReport,
        place: &history::Place<'_>,
    ) -> Result<(), OutputError>
    where
        Driver<D>: View,
    {
        let row = self.history.record(driver, report, place);
        self.csv.line(&row)?;
        self.csv.flush()?;
        for line in contact::rows(driver, report, place.stage) {
            self.contact_csv.line(&line)?;
        }
        self.contact_csv.flush()?;
        self.tally.add(driver, report);
        if self.vtu == Vtu::All {
            self.collection.add(driver, self.history.time())?;
        }
        Ok(())
    }

    /// What is written at the end, whether all converged or not.
    fn finish<const D: usize>(&mut self, driver: &Driver<D>, deck: &Deck) -> Result<(), OutputError>
    where
        Driver<D>: View,
    {
        if driver.increments() == 0 {
            return Ok(());
        }
        if self.vtu == Vtu::Last {
            self.collection.add(driver, self.history.time())?;
        }
        for (name, svg) in pictures::pictures(driver, &self.history, deck) {
            write_file(&self.collection.directory.join(name), svg.as_bytes())?;
        }
        Ok(())
    }
}

/// A text file that grows line by line.
struct Csv {
    path: PathBuf,
    file: BufWriter<File>,
}

impl Csv {
    fn create(path: PathBuf) -> Result<Self, OutputError> {
        match File::create(&path) {
            Ok(file) => Ok(Self {
                file: BufWriter::new(file),
                path,
            }),
            Err(source) => Err(OutputError { path, source }),
        }
    }

    fn line(&mut self, line: &str) -> Result<(), OutputError> {
        writeln!(self.file, "{line}").map_err(|source| self.error(source))
    }

    fn flush(&mut self) -> Result<(), OutputError> {
        self.file.flush().map_err(|source| self.error(source))
    }

    fn error(&self, source: std::io::Error) -> OutputError {
        let path = self.path.clone();
        OutputError { path, source }
    }
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    fs::write(path, bytes).map_err(|source| OutputError {
        path: path.to_owned(),
        source,
    })
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
