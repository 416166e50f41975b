//! The `moreau` command: checks, runs, resumes, compares and draws; all that it does is in the
//! library.
// It talks to a person.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod bench;
mod check;
mod converge;
mod convert;
mod plot;
mod processes;
mod progress;
mod run;
mod signals;

use crate::deck::Given;
use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Prints a line; a reader that has gone away, as `head` does, is no error.
macro_rules! say {
    ($($what:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stdout(), $($what)*);
    }};
}
use say;

/// The same to the error output.
macro_rules! tell {
    ($($what:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($what)*);
    }};
}
use tell;

/// Exit status for input that makes no sense.
const INPUT_ERROR: u8 = 1;
/// Exit status for a run that did not converge, was interrupted or could not be written to its end: what
/// converged is kept.
const NOT_CONVERGED: u8 = 2;
/// Exit status for an expectation that failed.
const UNEXPECTED: u8 = 3;

/// Elastoplastic solids in unilateral contact with Coulomb friction.
///
/// Exit status: 0 done, 1 input error, 2 not converged, interrupted, or results that cannot be
/// written (what converged before is kept), 3 an expectation failed.
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
        #[command(flatten)]
        parameters: Parameters,
        /// Draws what every step will do, of a body in the plane: supports, motions, loads, tools, gaps.
        #[arg(long, value_name = "FILE.svg")]
        picture: Option<PathBuf>,
    },
    /// Runs a deck and writes its results. Ctrl-C ends it within a second, and `resume` goes on from the last
    /// increment.
    Run {
        /// The deck.
        deck: PathBuf,
        #[command(flatten)]
        parameters: Parameters,
        /// Directory of the results, instead of the deck's.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Overwrite results of another deck, and files that no run wrote.
        #[arg(long)]
        force: bool,
        #[command(flatten)]
        manner: Manner,
    },
    /// Continues a run from its last checkpoint, as if it had never stopped.
    Resume {
        /// Directory of the results.
        directory: PathBuf,
        #[command(flatten)]
        manner: Manner,
    },
    /// Runs a deck under every contact algorithm and compares.
    Bench {
        /// The deck.
        deck: PathBuf,
        /// Directory of the results, instead of the deck's name with `-bench`.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Overwrite results of another deck, and files that no run wrote.
        #[arg(long)]
        force: bool,
    },
    /// Runs a deck on meshes and with increments that are two and four times as fine: the orders that its results
    /// converge with, and what they tend to.
    Converge {
        /// The deck.
        deck: PathBuf,
        #[command(flatten)]
        parameters: Parameters,
    },
    /// Converts a mesh file: .msh or .inp to .vtu or .msh.
    Convert(convert::Convert),
    /// Prints the JSON schema of decks, for editors.
    Schema,
    /// Draws a run again: history, contact line, deformed body, report.
    Plot {
        /// Directory of the results.
        directory: PathBuf,
        /// Field on the body, as in `von_mises` or `displacement.x`.
        #[arg(long)]
        field: Option<String>,
        /// Increment, instead of the last.
        #[arg(long)]
        increment: Option<usize>,
        /// How many times displacements are drawn.
        #[arg(long, value_name = "FACTOR")]
        scale: Option<f64>,
        /// Also as PNG, twice as large; needs a command built with the feature `png`.
        #[arg(long)]
        png: bool,
    },
}

impl Command {
    /// Whether all processes that `mpirun` has started do it together; the first does everything else.
    fn is_shared(&self) -> bool {
        matches!(self, Self::Run { .. } | Self::Resume { .. })
    }
}

/// Parameters of a deck.
#[derive(Debug, clap::Args)]
struct Parameters {
    /// Value of a parameter, instead of the deck's; may be given again.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = parameter)]
    set: Vec<(String, f64)>,
}

impl Parameters {
    fn given(self) -> Given {
        Given {
            parameters: self.set.into_iter().collect(),
            ..Given::default()
        }
    }
}

/// A parameter and its value.
fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE")?;
    let value: f64 = value
        .trim()
        .parse()
        .map_err(|_| format!("\"{value}\" is no number"))?;
    Ok((name.trim().to_owned(), value))
}

/// How a run goes on.
#[derive(Debug, clap::Args)]
struct Manner {
    /// Threads, instead of the deck's; 0: all. The results do not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// What solves the linear systems, instead of the embedded engine alone and MUMPS under mpirun.
    #[cfg(feature = "distributed")]
    #[arg(long, value_name = "ENGINE")]
    engine: Option<processes::Solver>,
    /// Fail with status 3 if an expectation of the deck is not met.
    #[arg(long)]
    verify: bool,
    /// No progress and no summary; doubts are told all the same.
    #[arg(long)]
    quiet: bool,
    /// Every iteration as a line of JSON on stdout, instead of progress and summary.
    #[arg(long)]
    json_log: bool,
}

impl Manner {
    /// The processes to run on; why there are none is printed.
    #[cfg(feature = "distributed")]
    fn started(&self) -> Result<processes::Started, u8> {
        processes::Started::begin(self.engine)
    }

    /// This process alone.
    #[cfg(not(feature = "distributed"))]
    fn started(&self) -> Result<processes::Started, u8> {
        Ok(processes::Started)
    }
}

/// The command line as it is defined, for whoever writes about it.
pub fn definition() -> clap::Command {
    Arguments::command()
}

/// Does what the arguments of a command line say, the name of the program first; the exit status.
pub fn main(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    signals::survive_limits();
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are no errors.
            let failed = error.use_stderr();
            let told = match processes::is_another() {
                true => Ok(()),
                false => error.print(),
            };
            return match told {
                Ok(()) if !failed => 0,
                _ => INPUT_ERROR,
            };
        }
    };
    if processes::is_another() && !arguments.command.is_shared() {
        return 0;
    }
    match arguments.command {
        Command::Check {
            deck,
            parameters,
            picture,
        } => check::check(&deck, &parameters.given(), picture.as_deref()),
        Command::Run {
            deck,
            parameters,
            out,
            force,
            manner,
        } => run::run(&deck, parameters.given(), (out, force), &manner),
        Command::Resume { directory, manner } => run::resume(&directory, &manner),
        Command::Bench { deck, out, force } => bench::bench(&deck, out, force),
        Command::Plot {
            directory,
            field,
            increment,
            scale,
            png,
        } => {
            let drawing = crate::run::Drawing {
                field,
                increment,
                magnification: scale,
            };
            plot::plot(&directory, &drawing, png)
        }
        Command::Converge { deck, parameters } => converge::converge(&deck, &parameters.given()),
        Command::Convert(convert) => convert.run(),
        Command::Schema => {
            say!("{}", crate::deck::SCHEMA.trim_end());
            0
        }
    }
}

/// The text of a deck, or a message.
fn read(path: &Path) -> Option<String> {
    match std::fs::read_to_string(path) {
        Ok(text) => Some(text),
        Err(error) => {
            tell!("cannot read the deck {}: {error}", path.display());
            None
        }
    }
}

/// The folder of a deck, to which the paths in it are relative.
fn folder(deck: &Path) -> &Path {
    deck.parent().unwrap_or(Path::new(""))
}

/// Prints findings to stderr, and how many there are.
fn report(findings: &crate::deck::Findings, path: &Path, text: &str) {
    use std::io::IsTerminal;
    let colour = std::io::stderr().is_terminal();
    let (errors, warnings) = (findings.errors(), findings.warnings());
    if errors + warnings > 0 {
        let shown = findings.render(&path.display().to_string(), text, colour);
        tell!("{}\n", shown.trim_end_matches('\n'));
        let counted = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        let (errors, warnings) = (counted(errors, "error"), counted(warnings, "warning"));
        tell!("{}: {errors}, {warnings}", path.display());
    }
}
