//! `moreau run` and `moreau resume`: a deck run to its end or to where it stops, and the exit
//! status that says so.

use super::progress::Progress;
use super::{INPUT_ERROR, Manner, NOT_CONVERGED, UNEXPECTED, folder, read, report, say, tell};
use moreau::deck::{Deck, Problem, open_in};
use moreau::run::{Outcome, RunError, RunStatus, Watch, shown};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs a deck; the exit status.
pub(crate) fn run(path: &Path, out: Option<PathBuf>, manner: &Manner) -> u8 {
    let Some((deck, problem)) = problem(path) else {
        return INPUT_ERROR;
    };
    let given = deck.directory.as_ref().map(PathBuf::from);
    let directory = out.or(given).unwrap_or_else(|| default_directory(path, ""));
    let (deck, to) = (&deck, directory.as_path());
    go(deck, to, manner, move |watch| match problem {
        Problem::Plane(setup) => moreau::run::run(*setup, deck, to, watch),
        Problem::Solid(setup) => moreau::run::run(*setup, deck, to, watch),
    })
}

/// Continues a run; the exit status.
pub(crate) fn resume(directory: &Path, manner: &Manner) -> u8 {
    let Some((deck, problem)) = results(directory) else {
        return INPUT_ERROR;
    };
    let deck = &deck;
    go(deck, directory, manner, move |watch| match problem {
        Problem::Plane(setup) => moreau::run::resume(*setup, deck, directory, watch),
        Problem::Solid(setup) => moreau::run::resume(*setup, deck, directory, watch),
    })
}

/// The problem of a directory of results; what is wrong with it is printed.
pub(crate) fn results(directory: &Path) -> Option<(Deck, Problem)> {
    let path = directory.join("deck.resolved.toml");
    if !path.exists() {
        let at = directory.display();
        tell!(
            "{at} is no directory of results: it has no deck.resolved.toml, which `moreau run` writes"
        );
        return None;
    }
    problem(&path)
}

/// The problem of a deck; findings are printed.
pub(crate) fn problem(path: &Path) -> Option<(Deck, Problem)> {
    let text = read(path)?;
    let (deck, problem, findings) = open_in(&text, folder(path));
    report(&findings, path, &text);
    Some((deck, problem?))
}

fn go(
    deck: &Deck,
    directory: &Path,
    manner: &Manner,
    solve: impl FnOnce(&mut dyn Watch) -> Result<Outcome, RunError> + Send,
) -> u8 {
    let threads = manner.threads.unwrap_or(deck.solver.threads);
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool,
        Err(error) => {
            tell!("cannot start {threads} threads: {error}");
            return INPUT_ERROR;
        }
    };
    let mut progress = Progress::new(manner.quiet, manner.json_log, stopping());
    let outcome = pool.install(|| solve(&mut progress));
    progress.end();
    match outcome {
        Ok(outcome) => conclude(&outcome, manner, directory),
        Err(error) => {
            tell!("{error}");
            INPUT_ERROR
        }
    }
}

/// A flag that the first Ctrl-C raises; the second ends the process.
fn stopping() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = flag.clone();
    let handler = move || {
        if raised.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(NOT_CONVERGED));
        }
        tell!("stopping after this increment; once more to stop now");
    };
    // Without a handler Ctrl-C ends the process, and checkpoints are there all the same.
    let _ = ctrlc::set_handler(handler);
    flag
}

fn conclude(outcome: &Outcome, manner: &Manner, directory: &Path) -> u8 {
    let place = directory.display();
    if !manner.quiet && !manner.json_log {
        say!("{outcome}  results       {place}");
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
        RunStatus::Collapsed(_) => {
            eprintln!("if that is what the step is for, give it until = \"collapse\"");
            NOT_CONVERGED
        }
        RunStatus::Interrupted(increment) => {
            tell!("interrupted after increment {increment}; to go on: moreau resume \"{place}\"");
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
pub(crate) fn default_directory(deck: &Path, suffix: &str) -> PathBuf {
    let name = deck.extension().and_then(|_| deck.file_stem());
    let name = name.map_or("out".into(), |n| n.to_string_lossy().into_owned());
    PathBuf::from(name + suffix)
}
