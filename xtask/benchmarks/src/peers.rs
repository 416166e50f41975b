//! `cargo xtask peers`: the punched block by other systems, where they are installed, beside ours.

use std::error::Error;
use std::path::PathBuf;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::bench;
use verification::workspace;

/// Arguments of `peers`.
#[derive(clap::Args)]
pub struct Args {
    /// Cells along and across the block, as 50x20; may be given again [default: 10x2, 50x20, 100x40]
    #[arg(long = "size", value_name = "NxM", value_parser = bench::size)]
    sizes: Vec<[usize; 2]>,
    /// Python that knows the module getfem
    #[arg(long, default_value = "python3")]
    python: PathBuf,
    /// File for the figures as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Another system: its name and the script beside the sources that runs the block by it.
const PEERS: [(&str, &str); 2] = [
    ("GetFEM", "getfem_block.py"),
    ("CalculiX", "calculix_block.py"),
];

/// What a system says of its run, on one thread.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Run {
    unknowns: usize,
    /// Load of the punch \[N\] of half the block at the end.
    load: f64,
    /// Newton iterations of all increments.
    iterations: usize,
    /// Processor seconds of the others; of ours those of the clock, which are never fewer.
    seconds: f64,
}

/// A row of the table.
#[derive(Debug, Serialize)]
struct Row {
    cells: [usize; 2],
    system: &'static str,
    #[serde(flatten)]
    run: Run,
    /// Seconds over ours.
    ratio: f64,
}

/// Runs the task.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let sizes = match args.sizes.as_slice() {
        [] => vec![[10, 2], [50, 20], [100, 40]],
        given => given.to_vec(),
    };
    println!(
        "{:>8} {:>9} {:>10} {:>16} {:>8} {:>10} {:>8}",
        "cells", "unknowns", "system", "punch load N", "Newton", "seconds", "ratio"
    );
    let mut rows = Vec::new();
    for cells in sizes {
        let ours = moreau(cells)?;
        let seconds = ours.seconds;
        let mut add = |system, run: Run| {
            let row = Row {
                cells,
                system,
                ratio: run.seconds / seconds,
                run,
            };
            println!("{}", line(&row));
            rows.push(row);
        };
        add("moreau", ours);
        for (system, script) in PEERS {
            match peer(args, script, cells) {
                Ok(run) => add(system, run),
                Err(error) => println!("{:>8} {:>9} {system:>10} {error}", shown(cells), ""),
            }
        }
    }
    if let Some(file) = &args.json {
        std::fs::write(file, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(true)
}

fn shown([n, m]: [usize; 2]) -> String {
    format!("{n}x{m}")
}

fn line(row: &Row) -> String {
    format!(
        "{:>8} {:>9} {:>10} {:>16.6} {:>8} {:>10.3} {:>8.1}",
        shown(row.cells),
        row.run.unknowns,
        row.system,
        row.run.load,
        row.run.iterations,
        row.run.seconds,
        row.ratio
    )
}

/// Exact contact by this program, in a process of its own on one thread; the fastest of three runs.
fn moreau(cells: [usize; 2]) -> Result<Run, Box<dyn Error>> {
    let name = format!("moreau-peers-{}.json", std::process::id());
    let file = std::env::temp_dir().join(name);
    let out = Command::new(std::env::current_exe()?)
        .args(["bench", "--method", "exact", "--runs", "3", "--size"])
        .args([&shown(cells), "--json"])
        .arg(&file)
        .env("RAYON_NUM_THREADS", "1")
        .output()?;
    if !out.status.success() {
        return Err(String::from_utf8_lossy(&out.stderr).into());
    }
    let text = std::fs::read_to_string(&file)?;
    std::fs::remove_file(&file)?;
    let [figures]: [bench::Figures; 1] = serde_json::from_str(&text)?;
    Ok(Run {
        unknowns: figures.unknowns,
        load: figures.punch_load,
        iterations: figures.newton_iterations,
        seconds: figures.seconds,
    })
}

/// What a script prints, or why it did not.
fn peer(args: &Args, script: &str, [n, m]: [usize; 2]) -> Result<Run, String> {
    let path = workspace::root().join("xtask/peers").join(script);
    let out = Command::new(&args.python)
        .arg(path)
        .args([n, m, bench::INCREMENTS].map(|number| number.to_string()))
        .arg(bench::FRICTION.to_string())
        .output()
        .map_err(|error| format!("{}: {error}", args.python.display()))?;
    let text = String::from_utf8_lossy(&out.stdout);
    let last = text.lines().last().unwrap_or_default();
    serde_json::from_str(last).map_err(|_| {
        let said = String::from_utf8_lossy(&out.stderr);
        let said = said.trim().lines().last().unwrap_or("nothing").to_owned();
        format!("did not run: {said}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_that_is_not_there_is_said() {
        let args = Args {
            sizes: Vec::new(),
            python: "no-such-python".into(),
            json: None,
        };
        let said = peer(&args, PEERS[0].1, [10, 2]).expect_err("no such program");
        assert!(said.contains("no-such-python"), "{said}");
    }

    #[test]
    fn the_scripts_are_there() {
        for (_, script) in PEERS {
            assert!(workspace::root().join("xtask/peers").join(script).is_file());
        }
    }
}
