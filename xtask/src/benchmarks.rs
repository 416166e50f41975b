//! Hands a task over to the package `benchmarks`, which takes as long to compile as all that `verify`
//! needs; not the measurements.

use std::error::Error;
use std::ffi::OsString;
use std::process::Command;

use verification::workspace;

/// Arguments of a benchmark, as it says them by `--help`.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Args {
    /// What `--help` lists
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Builds the package if need be and runs the task; `Ok(true)` when it succeeds.
pub fn run(task: &str, args: &Args) -> Result<bool, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = workspace::root().join("Cargo.toml");
    let status = Command::new(cargo)
        .args(["run", "--release", "--quiet", "--package", "benchmarks"])
        .arg("--manifest-path")
        .arg(manifest)
        .args(["--", task])
        .args(&args.arguments)
        .status()?;
    Ok(status.success())
}
