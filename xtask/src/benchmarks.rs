//! Hands a task over to the package `benchmarks`, which takes as long to compile as all that `verify`
//! needs; not the measurements, nor their arguments.

use std::error::Error;
use std::ffi::OsString;
use std::process::Command;

use clap::CommandFactory;
use clap::error::ErrorKind;
use verification::workspace;

/// Where its tasks are told.
pub const HELP: &str =
    "Benchmarks: bench, contact-bench, peers; `cargo xtask bench --help` tells of one";

const TASKS: [&str; 3] = ["bench", "contact-bench", "peers"];

/// Builds the package if need be and runs the task that `arguments` begin with; `Ok(true)` when it
/// succeeds. Ends the process as clap does for a task that is not known.
pub fn run(arguments: &[OsString]) -> Result<bool, Box<dyn Error>> {
    if !TASKS
        .iter()
        .any(|task| arguments.first().is_some_and(|a| a == task))
    {
        refuse(arguments);
    }
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = workspace::root().join("Cargo.toml");
    let status = Command::new(cargo)
        .args(["run", "--release", "--quiet", "--package", "benchmarks"])
        .arg("--manifest-path")
        .arg(manifest)
        .arg("--")
        .args(arguments)
        .status()?;
    Ok(status.success())
}

fn refuse(arguments: &[OsString]) -> ! {
    let task = arguments.first().map(|a| a.to_string_lossy());
    let message = format!("unrecognized subcommand '{}'", task.unwrap_or_default());
    crate::Cli::command()
        .error(ErrorKind::InvalidSubcommand, message)
        .exit()
}
