//! `moreau run`: a deck run to its end or to where it stops, and the exit status that says so.

use super::progress::Progress;
use super::{INPUT_ERROR, NOT_CONVERGED, UNEXPECTED, folder, read, report};
use moreau::deck::{Problem, open_in};
use moreau::run::{Event, Outcome, RunStatus};
use std::path::{Path, PathBuf};

/// What is asked for.
#[derive(Debug)]
pub(crate) struct Request {
    pub(crate) deck: PathBuf,
    pub(crate) out: Option<PathBuf>,
    pub(crate) threads: Option<usize>,
    pub(crate) verify: bool,
    pub(crate) quiet: bool,
}

/// Runs a deck; the exit status.
pub(crate) fn run(request: &Request) -> u8 {
    let Some(text) = read(&request.deck) else {
        return INPUT_ERROR;
    };
    let (deck, problem, findings) = open_in(&text, folder(&request.deck));
    report(&findings, &request.deck, &text);
    let Some(problem) = problem else {
        return INPUT_ERROR;
    };
    let threads = request.threads.unwrap_or(deck.solver.threads);
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
        Ok(pool) => pool,
        Err(error) => {
            eprintln!("cannot start {threads} threads: {error}");
            return INPUT_ERROR;
        }
    };
    let given = deck.directory.as_ref().map(PathBuf::from);
    let directory = request
        .out
        .clone()
        .or(given)
        .unwrap_or_else(|| default_directory(&request.deck));
    let progress = Progress::new(request.quiet);
    let show = |event: &Event<'_>| progress.show(event);
    let outcome = pool.install(|| match problem {
        Problem::Plane(setup) => moreau::run::run(*setup, &deck, &directory, show),
        Problem::Solid(setup) => moreau::run::run(*setup, &deck, &directory, show),
    });
    progress.end();
    match outcome {
        Ok(outcome) => conclude(&outcome, request, &directory),
        Err(error) => {
            eprintln!("{error}");
            INPUT_ERROR
        }
    }
}

fn conclude(outcome: &Outcome, request: &Request, directory: &Path) -> u8 {
    if !request.quiet {
        println!("{outcome}  results       {}", directory.display());
    }
    if let Some(error) = outcome.error() {
        eprintln!("{error}");
    }
    match outcome.status {
        RunStatus::Refused(_) => INPUT_ERROR,
        RunStatus::NotConverged(_) => NOT_CONVERGED,
        RunStatus::Done if request.verify && !outcome.as_expected() => {
            for v in outcome.verdicts.iter().filter(|v| !v.passed()) {
                eprintln!(
                    "{} is {:.10e}, expected {:.10e} ± {:.2e}",
                    v.column, v.found, v.expected, v.tolerance
                );
            }
            UNEXPECTED
        }
        RunStatus::Done => 0,
    }
}

/// The deck's name without its ending, where the command is given.
fn default_directory(deck: &Path) -> PathBuf {
    match deck.extension() {
        Some(_) => deck.file_stem().map(PathBuf::from),
        None => None,
    }
    .unwrap_or_else(|| "out".into())
}
