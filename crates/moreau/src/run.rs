//! A simulation with files around it: run to its end, with the results written to a directory as they come;
//! nothing is printed, and no deck is read. What is in memory does not grow with the number of increments.

mod checkpoint;
mod directory;
mod drawing;
mod files;
mod log;
mod report;
mod resumable;
mod under_way;
mod vtu;

pub use directory::Directory;
pub use drawing::{Drawing, draw};
pub use resumable::Resumable;

use crate::simulation::{Converged, Outcome, Simulation};
use files::{read_text, replace_file, write_file};
use std::path::{Path, PathBuf};
use under_way::{Run, reopen};

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
    /// A directory that another process writes.
    #[error(
        "{} is being written by {by}: wait until it has ended, or write elsewhere with --out",
        path.display()
    )]
    Taken {
        /// The directory.
        path: PathBuf,
        /// The process, and for how long, as far as is known.
        by: String,
    },
    /// A file that a run would overwrite, and that no run of its deck wrote.
    #[error(
        "{} {}, and would be overwritten: write elsewhere with --out, or overwrite it with --force",
        file.display(),
        belongs(.deck)
    )]
    NotOurs {
        /// The file.
        file: PathBuf,
        /// The deck whose results it belongs to, if it is of a run.
        deck: Option<PathBuf>,
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

fn belongs(deck: &Option<PathBuf>) -> String {
    match deck {
        Some(deck) => format!("is of the results of another deck, {}", deck.display()),
        None => "was there before, not of a run of this deck".to_owned(),
    }
}

/// Who looks on while a problem runs, and may stop it.
pub trait Watch {
    /// After every converged increment, with the seconds left if the rest goes as what was done since the run was
    /// started or resumed.
    fn converged(&mut self, _increment: &Converged, _seconds_left: f64) {}

    /// With every line of `log.jsonl`.
    fn iterated(&mut self, _line: &str) {}

    /// At the start and after every converged increment: `state` makes what it takes to go on from
    /// there, which another thread may write while the next increment is under way.
    fn reached(&mut self, _state: &dyn Fn() -> Resumable) {}

    /// Asked before every increment: whether to stop here, with a checkpoint.
    fn stops(&self) -> bool {
        false
    }
}

/// Nobody looks on.
impl Watch for () {}

/// Runs a simulation from its beginning and writes its results into a directory.
///
/// A run that does not converge is an outcome, not an error: what converged is written.
///
/// # Errors
/// [`RunError::Write`] for the first file that could not be written: the last checkpoint before it
/// stays.
pub fn run(
    simulation: Simulation,
    directory: &Directory,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError> {
    let at = directory.path();
    let begin = || {
        // Those of another run would be taken for its own.
        checkpoint::clear(&at.join(CHECKPOINTS))?;
        replace_file(&at.join(RUN), RUNNING)?;
        let resolved = simulation.deck().resolved();
        write_file(&at.join(RESOLVED), resolved.as_bytes())?;
        let checkpoints = simulation.deck().checkpoint > 0;
        let run = Run::new(simulation, at, resolved)?;
        if checkpoints {
            run.save()?;
        }
        Ok(run)
    };
    let outcome = begin().and_then(|run| run.finish(watch));
    outcome.inspect_err(|error| break_off(at, error))
}

/// Leaves word of what could not be written, if that can be.
fn break_off(directory: &Path, error: &RunError) {
    let json = serde_json::json!({ "status": "not written", "error": error.to_string() });
    let _ = replace_file(&directory.join(RUN), format!("{json:#}\n").as_bytes());
}

/// Continues a run from its last checkpoint, as if it had never stopped. The simulation is that of the
/// `deck.resolved.toml` of the directory, at its beginning.
///
/// # Errors
/// [`RunError::NoCheckpoint`] if none is whole, or the results that it continues are not; [`RunError::Write`].
pub fn resume(
    mut simulation: Simulation,
    directory: &Directory,
    watch: &mut dyn Watch,
) -> Result<Outcome, RunError> {
    let directory = directory.path();
    let resolved = read_text(&directory.join(RESOLVED))?;
    let checkpoints = directory.join(CHECKPOINTS);
    let mut why = String::new();
    for path in checkpoint::list(&checkpoints) {
        let numbers = checkpoint::read(&path, &resolved);
        let reopened = numbers.and_then(|numbers| {
            reopen(&mut simulation, directory, &numbers).map_err(|error| error.to_string())
        });
        match reopened {
            Ok(from) => {
                replace_file(&directory.join(RUN), RUNNING)?;
                let run = Run::going_on(simulation, directory, resolved, from);
                let outcome = run.finish(watch);
                return outcome.inspect_err(|error| break_off(directory, error));
            }
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

const RUN: &str = "run.json";
/// What it says until there is an outcome: also of a run that was killed.
const RUNNING: &[u8] = b"{\n  \"status\": \"running\"\n}\n";
const RESOLVED: &str = "deck.resolved.toml";
const CHECKPOINTS: &str = "checkpoint";
