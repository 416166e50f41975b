//! `cargo xtask contact-bench`: every method of the contact suite over a folder of discrete frictional
//! contact problems; the methods themselves are in `moreau::contact`.

mod profile;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use moreau::contact::{
    Admm, Auto, GaussSeidel, GlobalProblem, LocalProblem, LocalSolution, LocalSolver, Newton,
    NewtonMap, ProximalNewton, Reason, Residual, Tolerance, TrescaFixedPoint, Uzawa,
};
use verification::Table;
use verification::siconos::{self, Form, Problem};

use crate::verify::{csv, files};
use crate::workspace;

/// Arguments of `contact-bench`.
#[derive(clap::Args)]
pub struct Args {
    /// Folder with problems in the text format of Siconos (`*.dat`)
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Files whose name contains this only
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Methods to run, by name [default: all]
    #[arg(long, value_name = "NAME")]
    method: Vec<String>,
    /// Folder of the table and the profile [default: target/contact-bench of the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Bounds that a solution has to meet: on Siconos' measure, and on the one without units.
const UNSCALED: f64 = 1e-8;
const SCALED: f64 = 1e-6;

/// Largest number of components whose rank is computed.
const RANKED: usize = 2_000;

/// Seconds over which a short solution is repeated; the fastest counts.
const REPEAT: f64 = 0.02;

/// One method on one problem.
struct Run {
    file: String,
    method: &'static str,
    contacts: usize,
    rank: Option<usize>,
    residual: Residual,
    iterations: usize,
    seconds: f64,
    /// The method that arrived, or why none did.
    end: Result<&'static str, Reason>,
}

impl Run {
    fn solved(&self) -> bool {
        self.residual.unscaled <= UNSCALED && self.residual.scaled <= SCALED
    }
}

/// Best seconds known elsewhere, by file.
type Known = Vec<(String, f64)>;

/// Runs the task; `Ok(true)` when `Auto`, if it was run, solves every problem.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| workspace::root().join("target/contact-bench"));
    files::prepare(&out)?;
    let names = names(&args.folder, args.only.as_deref())?;
    let known = known(&args.folder);
    println!("{HEADER}");
    let mut runs = Vec::new();
    for name in &names {
        let text = fs::read_to_string(args.folder.join(name))?;
        let problem = siconos::read(&text, Form::of_name(name))
            .map_err(|error| format!("{name}: {error}"))?;
        let wanted =
            |method: &str| args.method.is_empty() || args.method.iter().any(|m| m == method);
        match problem {
            Problem::Local2(problem) => local(name, &problem, &wanted, &mut runs),
            Problem::Local3(problem) => local(name, &problem, &wanted, &mut runs),
            Problem::Global2(problem) => global(name, problem, &wanted, &mut runs),
            Problem::Global3(problem) => global(name, problem, &wanted, &mut runs),
        }
    }
    let table = table(&runs, &known);
    fs::write(out.join("contact-bench.csv"), csv::text(&table))?;
    let times: Vec<profile::Time<'_>> = runs
        .iter()
        .map(|run| {
            (
                run.method,
                run.file.as_str(),
                run.solved().then_some(run.seconds),
            )
        })
        .collect();
    println!();
    for (method, _) in methods::<2>() {
        let of_method: Vec<&Run> = runs.iter().filter(|run| run.method == method).collect();
        if of_method.is_empty() {
            continue;
        }
        let solved = of_method.iter().filter(|run| run.solved()).count();
        let ratios: Vec<f64> = of_method
            .iter()
            .filter_map(|run| ratio(run, &known))
            .collect();
        let near = ratios.iter().filter(|ratio| **ratio <= 2.0).count();
        let compared = if ratios.is_empty() {
            String::new()
        } else {
            format!(
                ", {near} of {} within 2 × the best time known",
                ratios.len()
            )
        };
        println!(
            "{method:<24} solves {solved} of {}{compared}",
            of_method.len()
        );
    }
    if let Some(svg) = profile::svg(&times)? {
        let path = out.join("profile.svg");
        fs::write(&path, svg)?;
        println!("table and profile in {}", workspace::shown(&out));
    }
    Ok(runs.iter().all(|run| run.method != "Auto" || run.solved()))
}

/// All methods, with iterations bounded so that none takes minutes where it fails.
fn methods<const D: usize>() -> Vec<(&'static str, Box<dyn LocalSolver<D>>)> {
    let cap = |iterations| Tolerance {
        relative: 1e-9,
        iterations,
    };
    let newton = |map| Newton {
        map,
        tolerance: cap(200),
    };
    let proximal = |map| ProximalNewton {
        map,
        tolerance: cap(1_000),
    };
    let tolerance = cap(20_000);
    vec![
        ("Auto", Box::new(Auto::default())),
        ("Gauss-Seidel", Box::new(GaussSeidel { tolerance })),
        (
            "Uzawa",
            Box::new(Uzawa {
                tolerance: cap(2_000),
            }),
        ),
        ("Newton AC", Box::new(newton(NewtonMap::AlartCurnier))),
        ("Newton JM", Box::new(newton(NewtonMap::JeanMoreau))),
        ("Newton natural", Box::new(newton(NewtonMap::Natural))),
        ("proximal AC", Box::new(proximal(NewtonMap::AlartCurnier))),
        ("proximal natural", Box::new(proximal(NewtonMap::Natural))),
        (
            "ADMM",
            Box::new(Admm {
                tolerance: cap(5_000),
            }),
        ),
        (
            "Tresca fixed point",
            Box::new(TrescaFixedPoint { tolerance }),
        ),
    ]
}

fn local<const D: usize>(
    name: &str,
    problem: &LocalProblem<D>,
    wanted: &dyn Fn(&str) -> bool,
    runs: &mut Vec<Run>,
) {
    each(name, problem, wanted, runs, |solution| solution.residual);
}

fn global<const D: usize>(
    name: &str,
    mut problem: GlobalProblem<D>,
    wanted: &dyn Fn(&str) -> bool,
    runs: &mut Vec<Run>,
) {
    let form = problem.local().clone();
    each(name, &form, wanted, runs, |solution| {
        let expanded = problem.expand(solution.clone());
        Residual {
            unscaled: expanded.residual.unscaled + expanded.balance,
            ..expanded.residual
        }
    });
}

/// Runs the methods on a problem; `measure` judges their solutions.
fn each<const D: usize>(
    name: &str,
    problem: &LocalProblem<D>,
    wanted: &dyn Fn(&str) -> bool,
    runs: &mut Vec<Run>,
    mut measure: impl FnMut(&LocalSolution<D>) -> Residual,
) {
    let contacts = problem.contacts();
    let rank = (D * contacts <= RANKED).then(|| problem.rank());
    for (method, solver) in methods::<D>() {
        if !wanted(method) {
            continue;
        }
        let begin = Instant::now();
        let mut seconds = f64::INFINITY;
        let (solution, end) = loop {
            let start = Instant::now();
            let result = solver.solve(problem, None);
            seconds = seconds.min(start.elapsed().as_secs_f64());
            if begin.elapsed().as_secs_f64() > REPEAT {
                break match result {
                    Ok(solution) => {
                        let arrived = solution.solver;
                        (solution, Ok(arrived))
                    }
                    Err(failure) => (*failure.best, Err(failure.reason)),
                };
            }
        };
        let run = Run {
            file: name.to_owned(),
            method,
            contacts,
            rank,
            residual: measure(&solution),
            iterations: solution.iterations,
            seconds,
            end,
        };
        println!("{}", line(&run));
        runs.push(run);
    }
}

const HEADER: &str = "  file                                     contacts  rank method              \
                      iterations   seconds   error     scaled    by";

/// A run as a line of the terminal.
fn line(run: &Run) -> String {
    let short: String = run.file.chars().take(40).collect();
    let end = match &run.end {
        Ok(arrived) => (*arrived).to_owned(),
        Err(reason) => reason.to_string(),
    };
    format!(
        "{} {short:<40} {:>8} {:>5} {:<20} {:>9} {:>9.2e} {:>9.1e} {:>9.1e}  {end}",
        if run.solved() { '✓' } else { '✗' },
        run.contacts,
        run.rank
            .map_or_else(|| "–".to_owned(), |rank| rank.to_string()),
        run.method,
        run.iterations,
        run.seconds,
        run.residual.unscaled,
        run.residual.scaled,
    )
}

/// Seconds of a run over the best known; nothing for global problems, of which only the solution of
/// the local form is timed here.
fn ratio(run: &Run, known: &Known) -> Option<f64> {
    if Form::of_name(&run.file) == Form::Global {
        return None;
    }
    let (_, best) = known.iter().find(|(file, _)| *file == run.file)?;
    let seconds = if run.solved() {
        run.seconds
    } else {
        f64::INFINITY
    };
    Some(seconds / best)
}

fn table(runs: &[Run], known: &Known) -> Table {
    let header = [
        "file",
        "contacts",
        "rank",
        "method",
        "solved",
        "error",
        "error_scaled",
        "iterations",
        "seconds",
        "seconds over best known",
        "by",
    ];
    let row = |run: &Run| {
        vec![
            run.file.clone(),
            run.contacts.to_string(),
            run.rank.map_or_else(String::new, |rank| rank.to_string()),
            run.method.to_owned(),
            if run.solved() { "yes" } else { "no" }.to_owned(),
            format!("{:.2e}", run.residual.unscaled),
            format!("{:.2e}", run.residual.scaled),
            run.iterations.to_string(),
            format!("{:.3e}", run.seconds),
            ratio(run, known).map_or_else(String::new, |ratio| format!("{ratio:.2}")),
            match &run.end {
                Ok(arrived) => (*arrived).to_owned(),
                Err(reason) => reason.to_string(),
            },
        ]
    };
    Table {
        name: "contact-bench".to_owned(),
        title: "Methods for the discrete frictional contact problem".to_owned(),
        header: header.map(str::to_owned).to_vec(),
        rows: runs.iter().map(row).collect(),
    }
}

/// The problems of a folder, by name.
fn names(folder: &Path, only: Option<&str>) -> Result<Vec<String>, Box<dyn Error>> {
    let entries = fs::read_dir(folder)
        .map_err(|error| format!("cannot read {}: {error}", folder.display()))?;
    let mut names = Vec::new();
    for entry in entries {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name.ends_with(".dat") && only.is_none_or(|only| name.contains(only)) {
            names.push(name);
        }
    }
    names.sort();
    if names.is_empty() {
        return Err(format!("no *.dat in {}", folder.display()).into());
    }
    Ok(names)
}

/// Columns `file` and `best_seconds` of `MANIFEST.csv`, where the folder has one.
fn known(folder: &Path) -> Known {
    let text = fs::read_to_string(folder.join("MANIFEST.csv")).unwrap_or_default();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap_or_default();
    let column = |name: &str| header.iter().position(|cell| *cell == name);
    let (Some(file), Some(seconds)) = (column("file"), column("best_seconds")) else {
        return Known::new();
    };
    let entry = |cells: Vec<&str>| {
        let seconds = cells.get(seconds)?.parse().ok()?;
        Some((cells.get(file)?.to_string(), seconds))
    };
    lines.filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scratch::Scratch;

    #[test]
    fn every_method_is_run_and_the_answer_is_written() {
        let scratch = Scratch::new();
        let folder = scratch.path().join("problems");
        fs::create_dir_all(&folder).unwrap();
        // One contact in the plane, pressed and dragged.
        fs::write(
            folder.join("one.dat"),
            "2 1 0 2 2 2 2 1 0.2 0.2 0.8 -1 0.5 0.3",
        )
        .unwrap();
        fs::write(
            folder.join("MANIFEST.csv"),
            "file,best_seconds\none.dat,100\n",
        )
        .unwrap();
        let args = Args {
            folder: folder.clone(),
            only: None,
            method: Vec::new(),
            out: Some(scratch.path().to_path_buf()),
        };
        assert!(run(&args).unwrap());
        let table = fs::read_to_string(scratch.path().join("contact-bench.csv")).unwrap();
        assert_eq!(table.lines().count(), 1 + methods::<2>().len());
        assert!(
            table
                .lines()
                .skip(1)
                .all(|line| line.starts_with("one.dat,1,2,") && line.contains(",yes,"))
        );
        assert!(scratch.path().join("profile.svg").exists());
        let args = Args {
            only: Some("none".to_owned()),
            ..args
        };
        assert!(
            run(&args)
                .unwrap_err()
                .to_string()
                .starts_with("no *.dat in ")
        );
    }
}
