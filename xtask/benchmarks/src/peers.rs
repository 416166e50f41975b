//! `cargo xtask peers`: the punched block, and forming under large strains, by other systems, where they are
//! installed, beside ours.

use std::error::Error;
use std::path::PathBuf;
use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::bench;
use cpu_time::ProcessTime;
use moreau::driver::{Axis, Driver, Step};
use moreau::mesh::{Axisymmetric, PlaneStrain};
use verification::problems::large::{QUAD8, RING, SQUARE, bar};
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
    /// Cases of forming [default: all]
    #[arg(long = "forming", value_name = "CASE")]
    forming: Vec<Forming>,
    /// Runs a case of forming by ours and prints the figures as JSON
    #[arg(long, hide = true)]
    own: Option<Forming>,
    /// File for the figures as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Another system: its name and the script beside the sources that runs the block by it.
const PEERS: [(&str, &str); 2] = [
    ("GetFEM", "getfem_block.py"),
    ("CalculiX", "calculix_block.py"),
];

/// Forming under large strains, with friction 0.1 where there is a tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Forming {
    /// A square block of steel is pressed to 0.6 of its height
    Billet,
    /// A ring 6:3:2 of steel is pressed to half of its height
    Ring,
    /// A round bar necks
    Bar,
}

/// All of them.
const FORMING: [Forming; 3] = [Forming::Billet, Forming::Ring, Forming::Bar];

/// The other system that runs them, by the script beside the sources.
const FORMING_PEER: (&str, &str) = ("CalculiX", "calculix_forming.py");

impl Forming {
    fn name(self) -> &'static str {
        match self {
            Self::Billet => "billet",
            Self::Ring => "ring",
            Self::Bar => "bar",
        }
    }

    fn increments(self) -> usize {
        match self {
            Self::Billet => 40,
            Self::Ring => 50,
            Self::Bar => 140,
        }
    }

    /// By ours, in this process.
    fn run(self) -> Result<Run, Box<dyn Error>> {
        let (mut driver, step): (Driver<2>, _) = match self {
            Self::Billet => {
                let driver = SQUARE.driver(PlaneStrain::default(), 500.0, 0.1)?;
                (driver, SQUARE.held("press").tool("platen", [0.0, -4.0]))
            }
            Self::Ring => {
                let driver = RING.driver(Axisymmetric, 500.0, 0.1)?;
                (driver, RING.held("press").tool("platen", [0.0, -1.5]))
            }
            Self::Bar => {
                let step = Step::new("pull")
                    .fix("bar.bottom", &[Axis::Y])
                    .fix("bar.left", &[Axis::X])
                    .displace("bar.top", Axis::Y, 7.0);
                (bar(QUAD8)?, step)
            }
        };
        let clock = ProcessTime::now();
        let reports = driver.run(&step, self.increments(), |_, _| {})?;
        let seconds = clock.elapsed().as_secs_f64();
        let load = match self {
            Self::Bar => driver.reaction("bar.top")?[1],
            // On the body, as others tell it.
            _ => -driver.tool_force("platen")?[1],
        };
        Ok(Run {
            unknowns: driver.unknowns(),
            load,
            iterations: reports.iter().map(|r| r.newton_iterations).sum(),
            seconds,
        })
    }
}

/// What a system says of its run, on one thread.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Run {
    unknowns: usize,
    /// Load at the end \[N\]: of the punch, on half of the block; of forming, on what is meshed, of the full circle where
    /// it is round, and of the bar in kN.
    load: f64,
    /// Newton iterations of all increments.
    iterations: usize,
    /// Processor seconds of the others; of ours those of the clock, which are never fewer.
    seconds: f64,
}

/// A row of the table.
#[derive(Debug, Serialize)]
struct Row {
    case: String,
    system: &'static str,
    #[serde(flatten)]
    run: Run,
    /// Seconds over ours.
    ratio: f64,
}

/// Runs the task.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    if let Some(case) = args.own {
        println!("{}", serde_json::to_string(&case.run()?)?);
        return Ok(true);
    }
    // Who asks for some cases, wants those.
    let all = args.sizes.is_empty() && args.forming.is_empty();
    let sizes = match args.sizes.as_slice() {
        [] if all => vec![[10, 2], [50, 20], [100, 40]],
        given => given.to_vec(),
    };
    let forming = if all {
        &FORMING
    } else {
        args.forming.as_slice()
    };
    println!(
        "{:>8} {:>9} {:>10} {:>16} {:>8} {:>10} {:>8}",
        "case", "unknowns", "system", "load", "Newton", "seconds", "ratio"
    );
    let mut rows = Vec::new();
    for cells in sizes {
        let numbers = [cells[0], cells[1], bench::INCREMENTS].map(|number| number.to_string());
        let arguments = [numbers.as_slice(), &[bench::FRICTION.to_string()]].concat();
        let others = PEERS.map(|(system, script)| (system, peer(args, script, &arguments)));
        compare(shown(cells), moreau(cells)?, others.into(), &mut rows);
    }
    for case in forming {
        let (system, script) = FORMING_PEER;
        let arguments = [case.name().to_owned(), case.increments().to_string()];
        let other = (system, peer(args, script, &arguments));
        compare(
            case.name().to_owned(),
            formed(*case)?,
            vec![other],
            &mut rows,
        );
    }
    if let Some(file) = &args.json {
        std::fs::write(file, serde_json::to_string_pretty(&rows)?)?;
    }
    Ok(true)
}

/// Prints ours and the others of a case, and adds their rows.
fn compare(
    case: String,
    ours: Run,
    others: Vec<(&'static str, Result<Run, String>)>,
    rows: &mut Vec<Row>,
) {
    let seconds = ours.seconds;
    for (system, run) in [("moreau", Ok(ours))].into_iter().chain(others) {
        match run {
            Ok(run) => {
                let row = Row {
                    case: case.clone(),
                    system,
                    ratio: run.seconds / seconds,
                    run,
                };
                println!("{}", line(&row));
                rows.push(row);
            }
            Err(error) => println!("{case:>8} {:>9} {system:>10} {error}", ""),
        }
    }
}

fn shown([n, m]: [usize; 2]) -> String {
    format!("{n}x{m}")
}

fn line(row: &Row) -> String {
    format!(
        "{:>8} {:>9} {:>10} {:>16.6} {:>8} {:>10.3} {:>8.1}",
        row.case,
        row.run.unknowns,
        row.system,
        row.run.load,
        row.run.iterations,
        row.run.seconds,
        row.ratio
    )
}

/// Forming by this program, in a process of its own on one thread; the fastest of three runs.
fn formed(case: Forming) -> Result<Run, Box<dyn Error>> {
    let mut best: Option<Run> = None;
    for _ in 0..3 {
        let out = Command::new(std::env::current_exe()?)
            .args(["peers", "--own", case.name()])
            .env("RAYON_NUM_THREADS", "1")
            .output()?;
        if !out.status.success() {
            return Err(String::from_utf8_lossy(&out.stderr).into());
        }
        let run: Run = serde_json::from_slice(&out.stdout)?;
        best = match best {
            Some(best) if best.seconds <= run.seconds => Some(best),
            _ => Some(run),
        };
    }
    best.ok_or_else(|| "no run".into())
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
fn peer(args: &Args, script: &str, arguments: &[String]) -> Result<Run, String> {
    let path = workspace::root().join("xtask/peers").join(script);
    let out = Command::new(&args.python)
        .arg(path)
        .args(arguments)
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
            forming: Vec::new(),
            own: None,
            python: "no-such-python".into(),
            json: None,
        };
        let said = peer(&args, PEERS[0].1, &[]).expect_err("no such program");
        assert!(said.contains("no-such-python"), "{said}");
    }

    #[test]
    fn the_scripts_are_there() {
        for (_, script) in PEERS.into_iter().chain([FORMING_PEER]) {
            assert!(workspace::root().join("xtask/peers").join(script).is_file());
        }
    }
}
