//! The tasks of the workspace, `cargo xtask …`; not the `moreau` command that users run.

mod benchmarks;
mod tidy;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Command line of `cargo xtask`.
#[derive(Parser)]
#[command(
    name = "xtask",
    bin_name = "cargo xtask",
    about = "Tasks of the moreau workspace"
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
    /// Time the punched block on meshes of growing size
    Bench(benchmarks::Args),
    /// Run all contact solvers over a folder of discrete frictional contact problems
    ContactBench(benchmarks::Args),
    /// Time the punched block by other systems that are installed, beside ours
    Peers(benchmarks::Args),
    /// Check the architecture of the workspace from its manifests and sources
    Tidy,
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Verify(args) => verify::run(&args),
        Task::Bench(args) => benchmarks::run("bench", &args),
        Task::ContactBench(args) => benchmarks::run("contact-bench", &args),
        Task::Peers(args) => benchmarks::run("peers", &args),
        Task::Tidy => tidy::run(),
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
