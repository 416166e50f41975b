//! What `cargo xtask bench`, `contact-bench` and `peers` measure; not the verification.

mod bench;
mod contact_bench;
mod peers;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Command line, as xtask hands it over.
#[derive(Parser)]
#[command(name = "benchmarks", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    task: Task,
}

/// What can be measured.
#[derive(Subcommand)]
enum Task {
    /// Time the punched block on meshes of growing size
    Bench(bench::Args),
    /// Run all contact solvers over a folder of discrete frictional contact problems
    ContactBench(contact_bench::Args),
    /// Time the punched block and forming by other systems that are installed, beside ours
    Peers(peers::Args),
}

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Bench(args) => bench::run(&args),
        Task::ContactBench(args) => contact_bench::run(&args),
        Task::Peers(args) => peers::run(&args),
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
