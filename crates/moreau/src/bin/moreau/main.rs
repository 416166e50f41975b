//! The `moreau` command: checks and runs decks; all that it does is in the library.
#![allow(clippy::print_stdout, clippy::print_stderr)] // It talks to a person.

mod check;
mod convert;
mod progress;
mod run;

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Prints a line; a reader that has gone away, as `head` does, is no error.
macro_rules! say {
    ($($what:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($what)*);
    }};
}
use say;

/// Exit status for input that makes no sense.
const INPUT_ERROR: u8 = 1;
/// Exit status for a run that did not converge.
const NOT_CONVERGED: u8 = 2;
/// Exit status for an expectation that failed.
const UNEXPECTED: u8 = 3;

/// Elastoplastic solids in unilateral contact with Coulomb friction.
///
/// Exit status: 0 done, 1 input error, 2 not converged (what converged is kept and written), 3 an
/// expectation failed.
#[derive(Debug, Parser)]
#[command(name = "moreau", version)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Reads a deck and tells what was understood, without solving.
    Check {
        /// The deck.
        deck: PathBuf,
    },
    /// Runs a deck and writes its results.
    Run {
        /// The deck.
        deck: PathBuf,
        /// Directory of the results, instead of the deck's.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Threads, instead of the deck's; 0: all. The results do not depend on it.
        #[arg(long)]
        threads: Option<usize>,
        /// Fail with status 3 if an expectation of the deck is not met.
        #[arg(long)]
        verify: bool,
        /// No progress and no summary.
        #[arg(long)]
        quiet: bool,
    },
    /// Converts a mesh file: .msh or .inp to .vtu or .msh.
    Convert(convert::Convert),
    /// Prints the JSON schema of decks, for editors.
    Schema,
}

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are no errors.
            let failed = error.use_stderr();
            return match error.print() {
                Ok(()) if !failed => ExitCode::SUCCESS,
                _ => ExitCode::from(INPUT_ERROR),
            };
        }
    };
    let status = match arguments.command {
        Command::Check { deck } => check::check(&deck),
        Command::Run {
            deck,
            out,
            threads,
            verify,
            quiet,
        } => run::run(&run::Request {
            deck,
            out,
            threads,
            verify,
            quiet,
        }),
        Command::Convert(convert) => convert.run(),
        Command::Schema => {
            say!("{}", moreau::deck::SCHEMA.trim_end());
            0
        }
    };
    ExitCode::from(status)
}

/// The text of a deck, or a message.
fn read(path: &Path) -> Option<String> {
    match std::fs::read_to_string(path) {
        Ok(text) => Some(text),
        Err(error) => {
            eprintln!("cannot read the deck {}: {error}", path.display());
            None
        }
    }
}

/// The folder of a deck, to which the paths in it are relative.
fn folder(deck: &Path) -> &Path {
    deck.parent().unwrap_or(Path::new(""))
}

/// Prints findings to stderr, and how many there are.
fn report(findings: &moreau::deck::Findings, path: &Path, text: &str) {
    use std::io::IsTerminal;
    let colour = std::io::stderr().is_terminal();
    let (errors, warnings) = (findings.errors(), findings.warnings());
    if errors + warnings > 0 {
        eprint!(
            "{}",
            findings.render(&path.display().to_string(), text, colour)
        );
        eprintln!("{}: {errors} errors, {warnings} warnings", path.display());
    }
}
