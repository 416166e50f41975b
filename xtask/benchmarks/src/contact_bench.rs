//! `cargo xtask contact-bench`: every method of the contact suite over a folder of discrete frictional
//! contact problems; the methods themselves are in `moreau::contact`.

mod clock;
mod outcome;
mod peer;
mod profile;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use moreau::contact::{
    Admm, Auto, GaussSeidel, LocalProblem, LocalSolution, LocalSolver, Newton, NewtonMap,
    ProximalNewton, Residual, Tolerance, TrescaFixedPoint, Unsolved, Uzawa,
};
use moreau::laws::Local;
use verification::siconos::{self, Form, Global, Problem, SiconosError};

use clock::Clock;
use outcome::Run;
use peer::{Answer, Siconos};
use verification::workspace;

/// Arguments of `contact-bench`.
#[derive(clap::Args)]
pub struct Args {
    /// Folder with problems in the text format of Siconos (`*.dat`) or in HDF5 (`*.hdf5`, feature hdf5)
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Files whose name contains this only
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Methods to run, by name [default: all]
    #[arg(long, value_name = "NAME")]
    method: Vec<String>,
    /// Run the solvers of Siconos beside ours; needs libsiconos-numerics-dev and a C compiler
    #[arg(long)]
    siconos: bool,
    /// Processor seconds after which a solver of Siconos is stopped
    #[arg(long, value_name = "SECONDS", default_value_t = 5.0)]
    limit: f64,
    /// Folder of the table and the profile [default: target/contact-bench of the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Largest number of components whose rank is computed.
const RANKED: usize = 2_000;

/// Runs the task; `Ok(true)` when `Auto`, if it was run, solves every problem that anything solves.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| workspace::root().join("target/contact-bench"));
    fs::create_dir_all(&out)?;
    let names = names(&args.folder, args.only.as_deref())?;
    let bench = Bench {
        args,
        clock: Clock::new(),
        siconos: args.siconos.then(|| Siconos::new(&out)).transpose()?,
    };
    println!("{}", outcome::HEADER);
    let mut runs = Vec::new();
    for name in &names {
        match bench.file(name) {
            Ok(found) => runs.extend(found),
            // The other files can be read all the same.
            Err(error) if matches!(error.downcast_ref(), Some(SiconosError::Feature)) => {
                println!("- {name}: {error}");
            }
            Err(error) => return Err(format!("{name}: {error}").into()),
        }
    }
    if runs.is_empty() {
        return Err("no problem could be read".into());
    }
    let known = if args.siconos {
        outcome::best_of_siconos(&runs)
    } else {
        outcome::manifest(&args.folder)
    };
    let table = outcome::table(&runs, &known);
    fs::write(out.join("contact-bench.csv"), table.csv())?;
    println!("\nprocessor seconds of one thread");
    let mut methods: Vec<&str> = Vec::new();
    for run in &runs {
        if !methods.contains(&run.method.as_str()) {
            methods.push(&run.method);
        }
    }
    for method in methods {
        if let Some(line) = outcome::summary(method, &runs, &known) {
            println!("{line}");
        }
    }
    let times = profile::times(&runs, &known);
    if let Some(svg) = profile::svg(&times)? {
        fs::write(out.join("profile.svg"), svg)?;
        println!("table and profile in {}", workspace::shown(&out));
    }
    let solvable = |file: &str| runs.iter().any(|run| run.file == file && run.solved());
    let mut auto = runs.iter().filter(|run| run.method == "Auto");
    Ok(auto.all(|run| run.solved() || !solvable(&run.file)))
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

/// What is the same for all problems.
struct Bench<'a> {
    args: &'a Args,
    clock: Clock,
    siconos: Option<Siconos>,
}

/// A solution with its own measure, or the best point and why it is none.
type Attempt<const D: usize> = Result<(LocalSolution<D>, Residual, String), Box<dyn Error>>;

impl Bench<'_> {
    /// Runs the methods on the problem of a file.
    fn file(&self, name: &str) -> Result<Vec<Run>, Box<dyn Error>> {
        let path = self.args.folder.join(name);
        let problem = siconos::open(&path)?;
        // The Siconos of the distributions reads texts only.
        let text = name.ends_with(".dat");
        let answers = match &self.siconos {
            Some(siconos) if text => siconos.solve(&path, Form::of_name(name), self.args.limit)?,
            _ => Vec::new(),
        };
        match problem {
            Problem::Local2(problem) => self.local(name, &problem, &answers),
            Problem::Local3(problem) => self.local(name, &problem, &answers),
            Problem::Global2(parts) => self.global(name, &parts, &answers),
            Problem::Global3(parts) => self.global(name, &parts, &answers),
        }
    }

    fn local<const D: usize>(
        &self,
        name: &str,
        problem: &LocalProblem<D>,
        answers: &[Answer],
    ) -> Result<Vec<Run>, Box<dyn Error>> {
        let attempt = |solver: &dyn LocalSolver<D>| {
            let (seconds, result) = self.clock.time(|| solver.solve(problem, None));
            let (solution, end) = ended(result);
            let residual = solution.residual;
            (seconds, Ok((solution, residual, end)))
        };
        let judge = |force: Vec<Local<D>>| {
            let displacement = problem.displacement(&force);
            problem.residual(&force, &displacement)
        };
        self.each(name, problem, attempt, judge, answers)
    }

    /// The reduction to the local form and the displacements of the bodies count, too.
    fn global<const D: usize>(
        &self,
        name: &str,
        parts: &Global<D>,
        answers: &[Answer],
    ) -> Result<Vec<Run>, Box<dyn Error>> {
        let attempt = |solver: &dyn LocalSolver<D>| {
            let parts = parts.clone();
            self.clock.time(|| {
                let mut problem = parts.problem()?;
                let (solution, end) = ended(solver.solve(problem.local(), None));
                let expanded = problem.expand(solution);
                let residual = Residual {
                    unscaled: expanded.residual.unscaled + expanded.balance,
                    ..expanded.residual
                };
                Ok((expanded.local, residual, end))
            })
        };
        let mut problem = parts.clone().problem()?;
        let form = problem.local().clone();
        let judge = |force: Vec<Local<D>>| {
            let displacement = form.displacement(&force);
            let expanded = problem.expand(LocalSolution {
                residual: form.residual(&force, &displacement),
                force,
                displacement,
                iterations: 0,
                solver: "",
            });
            Residual {
                unscaled: expanded.residual.unscaled + expanded.balance,
                ..expanded.residual
            }
        };
        self.each(name, &form, attempt, judge, answers)
    }

    /// Runs our methods by `attempt`, which tells its seconds, and judges the forces of others.
    fn each<const D: usize>(
        &self,
        name: &str,
        problem: &LocalProblem<D>,
        attempt: impl Fn(&dyn LocalSolver<D>) -> (f64, Attempt<D>),
        mut judge: impl FnMut(Vec<Local<D>>) -> Residual,
        answers: &[Answer],
    ) -> Result<Vec<Run>, Box<dyn Error>> {
        let contacts = problem.contacts();
        let rank = (D * contacts <= RANKED).then(|| problem.rank());
        let mut runs = Vec::new();
        let mut add = |method: &str, residual, iterations, seconds, end| {
            let run = Run {
                file: name.to_owned(),
                method: method.to_owned(),
                contacts,
                rank,
                residual,
                iterations,
                seconds,
                end,
            };
            println!("{}", outcome::line(&run));
            runs.push(run);
        };
        let wanted = &self.args.method;
        for (method, solver) in methods::<D>() {
            if wanted.is_empty() || wanted.iter().any(|name| name == method) {
                let (seconds, result) = self.clock.fastest(|| attempt(&*solver));
                let (solution, residual, end) = result?;
                add(method, residual, solution.iterations, seconds, end);
            }
        }
        for answer in answers {
            let force = answer.force.chunks_exact(D).map(Local::from_column_slice);
            let method = format!("Siconos {}", answer.solver);
            let residual = judge(force.collect());
            add(
                &method,
                residual,
                answer.iterations,
                answer.seconds,
                String::new(),
            );
        }
        Ok(runs)
    }
}

/// The solution or the best point, and which method arrived or why none did.
fn ended<const D: usize>(
    result: Result<LocalSolution<D>, Unsolved<D>>,
) -> (LocalSolution<D>, String) {
    match result {
        Ok(solution) => {
            let by = solution.solver.to_owned();
            (solution, by)
        }
        Err(failure) => (*failure.best, failure.reason.to_string()),
    }
}

/// The problems of a folder, by name.
fn names(folder: &Path, only: Option<&str>) -> Result<Vec<String>, Box<dyn Error>> {
    let entries = fs::read_dir(folder)
        .map_err(|error| format!("cannot read {}: {error}", folder.display()))?;
    let mut names = Vec::new();
    for entry in entries {
        let name = entry?.file_name().to_string_lossy().into_owned();
        let problem = name.ends_with(".dat") || name.ends_with(".hdf5");
        if problem && only.is_none_or(|only| name.contains(only)) {
            names.push(name);
        }
    }
    names.sort();
    if names.is_empty() {
        return Err(format!("no *.dat or *.hdf5 in {}", folder.display()).into());
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::scratch::Scratch;

    #[test]
    fn every_method_is_run_and_the_answer_is_written() {
        let scratch = Scratch::new().unwrap();
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
        // A file that this build cannot read stops none of the others.
        #[cfg(not(feature = "hdf5"))]
        fs::write(folder.join("two.hdf5"), "").unwrap();
        let args = Args {
            folder: folder.clone(),
            only: None,
            method: Vec::new(),
            siconos: false,
            limit: 1.0,
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
                .starts_with("no *.dat or *.hdf5 in ")
        );
    }
}
