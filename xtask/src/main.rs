//! The tasks of the workspace, `cargo xtask …`; not the `moreau` command that users run.

mod benchmarks;
mod docs;
mod markdown;
mod package;
mod page;
mod tidy;
mod verify;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Command line of `cargo xtask`.
#[derive(Parser)]
#[command(
    name = "xtask",
    bin_name = "cargo xtask",
    about = "Tasks of the moreau workspace",
    after_help = benchmarks::HELP
)]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

/// What can be asked for.
#[derive(Subcommand)]
enum Task {
    /// Run the verification cases and write a report
    Verify(verify::Args),
    /// Check the architecture of the workspace from its manifests and sources
    Tidy,
    /// Write the pages of docs/reference from what they describe
    Docs(docs::Args),
    /// Write the page that computes in a browser, as one file
    Page(page::Args),
    /// Pack every crate, build what was packed, and run a deck with it
    Package,
    /// A benchmark and its arguments
    #[command(external_subcommand)]
    Benchmark(Vec<OsString>),
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Verify(args) => verify::run(&args),
        Task::Tidy => tidy::run(),
        Task::Docs(args) => docs::run(&args),
        Task::Page(args) => page::run(&args),
        Task::Package => package::run(),
        Task::Benchmark(arguments) => benchmarks::run(&arguments),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
