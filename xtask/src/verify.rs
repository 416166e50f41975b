//! `cargo xtask verify`: runs the verification cases, shows their checks and writes the report; what
//! is computed is the business of the package `verification`.

mod comparison;
mod execute;
mod files;
mod groups;
mod number;
mod pages;
mod paint;
mod progress;
mod report;
#[cfg(test)]
mod samples;
mod select;
mod side_by_side;
mod summary;
mod svg;
mod terminal;
mod verdict;

use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::CommandFactory;
use clap::error::ErrorKind;
use verification::Case;

use execute::Run;
use paint::Paint;
use progress::Board;
use verdict::Verdict;
use verification::workspace;

/// Arguments of `verify`.
#[derive(clap::Args)]
pub struct Args {
    /// Cases to run, by name [default: all]
    #[arg(value_name = "CASE")]
    cases: Vec<String>,
    /// Coarse meshes and few variants only, and no long cases unless named
    #[arg(long)]
    quick: bool,
    /// Folder of the report [default: target/verify of the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Write the pages of the cases in docs/validation too
    #[arg(long)]
    pages: bool,
}

/// How a set of cases was run.
#[derive(Debug, Clone, Copy)]
struct Setting {
    /// Coarse meshes only.
    quick: bool,
    /// Threads at the solver's disposal.
    threads: usize,
}

/// Runs the task; `Ok(true)` when every check passes. Ends the process with status 2 when a case is
/// not known, as for any other bad argument.
pub fn run(args: &Args) -> Result<bool, Box<dyn Error>> {
    let known = verification::cases::all();
    let mut cases = select::select(&known, &args.cases).unwrap_or_else(|unknown| refuse(&unknown));
    if args.quick && args.cases.is_empty() {
        cases.retain(|case| !case.long);
    }
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| workspace::root().join("target/verify"));
    let setting = Setting {
        quick: args.quick,
        threads: threads(),
    };
    let docs = workspace::root().join("docs");
    let terminal = &mut io::stdout();
    let paint = Paint::of_stdout();
    let (verdict, runs) = verify(&cases, setting, &out, paint, &Board::of_stderr(), terminal)?;
    if args.pages {
        pages::write(&docs, &known, &runs, setting)?;
    }
    Ok(verdict.pass())
}

/// Ends the process as clap does for a bad argument of `verify`.
fn refuse(unknown: &select::UnknownCase) -> ! {
    let mut command = crate::Cli::command();
    command.build();
    let verify = command.find_subcommand("verify").cloned();
    verify
        .unwrap_or(command)
        .error(ErrorKind::InvalidValue, unknown)
        .exit()
}

/// Runs the cases, tells `terminal` about each, and writes the report to `out`.
fn verify<'a>(
    cases: &[&'a Case],
    setting: Setting,
    out: &Path,
    paint: Paint,
    board: &Board,
    terminal: &mut dyn Write,
) -> Result<(Verdict, Vec<Run<'a>>), Box<dyn Error>> {
    // An unwritable folder is told before the computation, not after it.
    files::prepare(out)?;
    writeln!(
        terminal,
        "{}\n",
        paint.faint(&terminal::preamble(cases.len(), setting))
    )?;
    let start = Instant::now();
    let runs = side_by_side::run(cases, setting, board, |run| {
        writeln!(terminal, "{}", terminal::case(run, paint))
    })?;
    let verdict = Verdict::of(&runs, start.elapsed().as_secs_f64());
    let report = write(&runs, setting, &verdict, out)?;
    writeln!(
        terminal,
        "{}",
        verdict.line(&workspace::shown(&report), paint)
    )?;
    Ok((verdict, runs))
}

/// Writes figures and tables first and the report last, so that a report that is there is complete.
fn write(
    runs: &[Run<'_>],
    setting: Setting,
    verdict: &Verdict,
    out: &Path,
) -> Result<PathBuf, Box<dyn Error>> {
    let mut figures = files::Folder::open(out, "figures", "svg")?;
    let mut tables = files::Folder::open(out, "tables", "csv")?;
    for run in runs {
        for figure in run.figures() {
            figures.write(&figure.name, run.case.name, &figure.svg)?;
        }
        for table in run.tables() {
            tables.write(&table.name, run.case.name, &table.csv())?;
        }
    }
    figures.prune()?;
    tables.prune()?;
    files::write(&out.join("summary.json"), &summary::json(runs)?)?;
    let report = out.join("report.html");
    files::write(&report, &report::html(runs, setting, verdict)?)?;
    Ok(report)
}

/// Threads at the solver's disposal: `RAYON_NUM_THREADS` if set, else those of the machine.
fn threads() -> usize {
    let asked = std::env::var("RAYON_NUM_THREADS")
        .ok()
        .and_then(|text| text.parse().ok());
    match asked {
        Some(n) if n > 0 => n,
        _ => std::thread::available_parallelism().map_or(1, usize::from),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::scratch::Scratch;

    fn verified(names: &[&str], out: &Path) -> (Verdict, String) {
        let known = samples::cases();
        let names: Vec<String> = names.iter().map(|&name| name.to_owned()).collect();
        let cases = select::select(&known, &names).unwrap();
        let setting = Setting {
            quick: true,
            threads: 2,
        };
        let mut text = Vec::new();
        let verdict = verify(
            &cases,
            setting,
            out,
            Paint::plain(),
            &Board::Silent,
            &mut text,
        );
        (verdict.unwrap().0, String::from_utf8(text).unwrap())
    }

    fn listing(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_run_writes_report_summary_figures_and_tables() {
        let out = Scratch::new().unwrap();
        let (verdict, text) = verified(&["sound"], out.path());
        assert!(verdict.pass(), "{text}");
        assert_eq!(
            listing(out.path()),
            ["figures", "report.html", "summary.json", "tables"]
        );
        assert_eq!(listing(&out.path().join("figures")), ["curve.svg"]);
        assert_eq!(
            listing(&out.path().join("tables")),
            ["curve.csv", "long.csv"]
        );
        assert!(text.contains("3 checks passed"), "{text}");
        assert!(text.contains("report.html"), "{text}");
    }

    #[test]
    fn files_of_an_earlier_run_do_not_survive() {
        let out = Scratch::new().unwrap();
        verified(&["sound"], out.path());
        out.write("figures/foreign.txt", "kept: not a figure")
            .unwrap();
        verified(&["flawed"], out.path());
        assert_eq!(listing(&out.path().join("figures")), ["foreign.txt"]);
        assert!(listing(&out.path().join("tables")).is_empty());
    }

    #[test]
    fn failed_checks_errors_and_panics_fail_the_run() {
        for name in ["flawed", "erring", "panicking"] {
            let out = Scratch::new().unwrap();
            let (verdict, text) = verified(&[name], out.path());
            assert!(!verdict.pass(), "{name}: {text}");
            assert!(text.contains('✗'), "{name}: {text}");
        }
    }

    #[test]
    fn one_failure_does_not_hide_the_others() {
        let out = Scratch::new().unwrap();
        let (verdict, _) = verified(&[], out.path());
        assert_eq!((verdict.passed, verdict.failed, verdict.erred), (4, 2, 2));
    }
}
