//! `moreau run` and `moreau resume`: a deck run to its end or to where it stops, and the exit
//! status that says so.

use super::processes::Started;
use super::progress::Progress;
use super::signals::{Signals, interrupted};
use super::{INPUT_ERROR, Manner, NOT_CONVERGED, UNEXPECTED, folder, read, report, say, tell};
use crate::deck::Given;
use crate::memory;
use crate::numbers::shown;
use crate::run::{Directory, RunError, Watch};
use crate::simulation::{Outcome, RunStatus, Simulation};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Runs a deck; the exit status.
pub(super) fn run(
    path: &Path,
    given: Given,
    (out, force): (Option<PathBuf>, bool),
    manner: &Manner,
) -> u8 {
    let started = match manner.started() {
        Ok(started) => started,
        Err(status) => return status,
    };
    let Some(simulation) = simulation_on(Some(path), given, &started) else {
        return without(&started);
    };
    if !started.is_first() {
        return serve(simulation, (manner, &started));
    }
    let given = simulation.deck().directory.as_ref().map(PathBuf::from);
    let directory = out.or(given).unwrap_or_else(|| default_directory(path, ""));
    let Some(to) = taken(Directory::take_for(&directory, path, force)) else {
        return INPUT_ERROR;
    };
    go(simulation, &to, (manner, &started), crate::run::run)
}

/// Continues a run; the exit status.
pub(super) fn resume(directory: &Path, manner: &Manner) -> u8 {
    let started = match manner.started() {
        Ok(started) => started,
        Err(status) => return status,
    };
    let Some(simulation) = results_on(directory, &started) else {
        return without(&started);
    };
    if !started.is_first() {
        return serve(simulation, (manner, &started));
    }
    let Some(at) = taken(Directory::take(directory)) else {
        return INPUT_ERROR;
    };
    go(simulation, &at, (manner, &started), crate::run::resume)
}

/// What a process does that has no simulation: the first has told why.
fn without(started: &Started) -> u8 {
    match started.is_first() {
        true => INPUT_ERROR,
        false => started.stand_by("does not find the problem"),
    }
}

/// Does what the first process asks.
fn serve(simulation: Simulation, (manner, started): (&Manner, &Started)) -> u8 {
    let Some(pool) = pool(manner.threads.unwrap_or(1)) else {
        return started.give_up();
    };
    pool.install(|| simulation.serve());
    0
}

/// A directory to write to; why not is printed.
pub(super) fn taken(directory: Result<Directory, RunError>) -> Option<Directory> {
    match directory {
        Ok(directory) => {
            if !directory.is_exclusive() {
                let place = directory.path().display();
                tell!("warning: {place} cannot be locked there: let no other run write to it");
            }
            Some(directory)
        }
        Err(error) => {
            tell!("{error}");
            None
        }
    }
}

/// The simulation of a directory of results, at its beginning; what is wrong with it is printed.
pub(super) fn results(directory: &Path) -> Option<Simulation> {
    let path = resolved(directory, true)?;
    simulation(&path, &Given::default())
}

/// The same on several processes.
fn results_on(directory: &Path, started: &Started) -> Option<Simulation> {
    let path = resolved(directory, started.is_first());
    simulation_on(path.as_deref(), Given::default(), started)
}

/// The deck of a directory of results.
fn resolved(directory: &Path, is_told: bool) -> Option<PathBuf> {
    let path = directory.join("deck.resolved.toml");
    if !path.exists() {
        let at = directory.display();
        if is_told {
            tell!(
                "{at} is no directory of results: it has no deck.resolved.toml, which `moreau run` writes"
            );
        }
        return None;
    }
    Some(path)
}

/// The simulation of a deck; findings are printed.
pub(super) fn simulation(path: &Path, given: &Given) -> Option<Simulation> {
    let text = read(path)?;
    let (simulation, findings) = Simulation::open(&text, folder(path), given);
    report(&findings, path, &text);
    simulation
}

/// The simulation of a deck, where there is one, on several processes, of which the first prints the findings.
fn simulation_on(path: Option<&Path>, given: Given, started: &Started) -> Option<Simulation> {
    let text = path.and_then(|path| match started.is_first() {
        true => read(path),
        false => std::fs::read_to_string(path).ok(),
    });
    // Also where there is nothing to read: the first hears of all.
    let found = text.as_deref().zip(path.map(folder));
    if !started.agree(found, &given.meshes) {
        return None;
    }
    let (path, text) = (path?, text?);
    let given = Given {
        team: started.team(),
        ..given
    };
    let (simulation, findings) = Simulation::open(&text, folder(path), &given);
    if started.is_first() {
        report(&findings, path, &text);
    }
    simulation
}

fn go(
    simulation: Simulation,
    directory: &Directory,
    (manner, started): (&Manner, &Started),
    solve: fn(Simulation, &Directory, &mut dyn Watch) -> Result<Outcome, RunError>,
) -> u8 {
    // Several processes share the processors already.
    let usual = match started.size() {
        1 => simulation.deck().solver.threads,
        _ => 1,
    };
    let Some(pool) = pool(manner.threads.unwrap_or(usual)) else {
        return INPUT_ERROR;
    };
    // A limit load is one of small strains.
    let finite = simulation.deck().finite.is_some();
    let mut progress = Progress::new(manner.quiet, manner.json_log, Signals::listen());
    let outcome = pool.install(|| solve(simulation, directory, &mut progress));
    progress.end();
    let status = told(outcome, (manner, finite), directory);
    let Some(error) = progress.unwritten() else {
        return status;
    };
    tell!("cannot write the log to the standard output: {error}");
    match status {
        0 => NOT_CONVERGED,
        other => other,
    }
}

/// The status of what has come of a run, which is told.
fn told(
    outcome: Result<Outcome, RunError>,
    (manner, finite): (&Manner, bool),
    directory: &Directory,
) -> u8 {
    match outcome {
        Ok(outcome) => conclude(&outcome, (manner, finite), directory.path()),
        Err(error) => {
            tell!("{error}");
            match error {
                // What converged before is there.
                RunError::Write { .. } => NOT_CONVERGED,
                _ => INPUT_ERROR,
            }
        }
    }
}

/// Threads to work with, this one among them; why there are none is printed.
pub(super) fn pool(wanted: usize) -> Option<ThreadPool> {
    let told = |error: &dyn Display| tell!("cannot start threads: {error}");
    let threads = memory::threads(wanted).map_err(|e| told(&e)).ok()?;
    let builder = ThreadPoolBuilder::new().num_threads(threads);
    let pool = builder.use_current_thread().build();
    pool.map_err(|e| told(&e)).ok()
}

fn conclude(outcome: &Outcome, (manner, finite): (&Manner, bool), directory: &Path) -> u8 {
    let place = directory.display();
    if !manner.quiet && !manner.json_log {
        say!("{outcome}  results       {place}");
    }
    if manner.quiet && !manner.json_log {
        // Those of the deck were told when it was read.
        let doubts = outcome.warnings.iter().skip(outcome.deck_warnings);
        doubts.for_each(|doubt| tell!("warning: {doubt}"));
    }
    if let Some(error) = outcome.error() {
        tell!("{error}");
    }
    match outcome.status {
        RunStatus::Refused(_) => INPUT_ERROR,
        RunStatus::NotConverged(_) => {
            if let Some(diagnosis) = &outcome.diagnosis {
                tell!("try: {}", diagnosis.suggestion);
            }
            NOT_CONVERGED
        }
        RunStatus::Collapsed(_) if finite => NOT_CONVERGED,
        RunStatus::Collapsed(_) => {
            tell!("if that is what the step is for, give it until = \"collapse\"");
            NOT_CONVERGED
        }
        RunStatus::Interrupted(increment) => {
            tell!("{}", interrupted(increment, directory));
            NOT_CONVERGED
        }
        RunStatus::Done if manner.verify && !outcome.as_expected() => {
            for v in outcome.verdicts.iter().filter(|v| !v.passed()) {
                tell!(
                    "{} is {}, expected {} ± {}",
                    v.column,
                    shown(v.found, 10),
                    shown(v.expected, 10),
                    shown(v.tolerance, 3)
                );
            }
            UNEXPECTED
        }
        RunStatus::Done => 0,
    }
}

/// The deck's name without its ending, where the command is given.
pub(super) fn default_directory(deck: &Path, suffix: &str) -> PathBuf {
    let name = deck.extension().and_then(|_| deck.file_stem());
    let name = name.map_or("out".into(), |n| n.to_string_lossy().into_owned());
    PathBuf::from(name + suffix)
}
