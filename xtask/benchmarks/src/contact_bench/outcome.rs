//! What came of a method on a problem, as a line of the terminal and a row of the table; not how it
//! was run.

use std::fs;
use std::path::Path;

use moreau::contact::Residual;
use verification::Table;

/// Bounds that a solution has to meet: on Siconos' measure, and on the one without units.
const UNSCALED: f64 = 1e-8;
const SCALED: f64 = 1e-6;

/// One method on one problem.
pub struct Run {
    /// File of the problem.
    pub file: String,
    /// Method, of ours or of Siconos.
    pub method: String,
    /// Number of contacts.
    pub contacts: usize,
    /// Rank of W, if it was computed.
    pub rank: Option<usize>,
    /// Distance from the contact law.
    pub residual: Residual,
    /// Iterations of the method.
    pub iterations: usize,
    /// Processor seconds.
    pub seconds: f64,
    /// The method that arrived, or why none did.
    pub end: String,
}

impl Run {
    /// Whether both bounds are met.
    pub fn solved(&self) -> bool {
        self.residual.unscaled <= UNSCALED && self.residual.scaled <= SCALED
    }

    /// The seconds, if it was solved.
    pub fn success(&self) -> Option<f64> {
        self.solved().then_some(self.seconds)
    }
}

/// Header of [`line()`].
pub const HEADER: &str = "  file                                     contacts  rank method              \
                          iterations   seconds   error     scaled    by";

/// A run as a line of the terminal.
pub fn line(run: &Run) -> String {
    let short: String = run.file.chars().take(40).collect();
    let rank = run.rank.map_or_else(|| "–".to_owned(), |r| r.to_string());
    format!(
        "{} {short:<40} {:>8} {rank:>5} {:<20} {:>9} {:>9.2e} {:>9.1e} {:>9.1e}  {}",
        if run.solved() { '✓' } else { '✗' },
        run.contacts,
        run.method,
        run.iterations,
        run.seconds,
        run.residual.unscaled,
        run.residual.scaled,
        run.end
    )
}

/// Best time known of a problem, and whose.
pub struct Best {
    /// File of the problem.
    pub file: String,
    /// Processor seconds.
    pub seconds: f64,
    /// The method that took them.
    pub by: String,
}

/// The fastest solver of Siconos on every problem that one of them solves.
pub fn best_of_siconos(runs: &[Run]) -> Vec<Best> {
    let mut all: Vec<Best> = Vec::new();
    for run in runs.iter().filter(|run| run.method.starts_with("Siconos")) {
        let Some(seconds) = run.success() else {
            continue;
        };
        let best = Best {
            file: run.file.clone(),
            seconds,
            by: run.method.clone(),
        };
        match all.iter_mut().find(|known| known.file == run.file) {
            Some(known) if known.seconds <= seconds => {}
            Some(known) => *known = best,
            None => all.push(best),
        }
    }
    all
}

/// Columns `file`, `best_seconds` and `best_solver` of `MANIFEST.csv`, where the folder has one.
pub fn manifest(folder: &Path) -> Vec<Best> {
    let text = fs::read_to_string(folder.join("MANIFEST.csv")).unwrap_or_default();
    let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next().unwrap_or_default();
    let column = |name: &str| header.iter().position(|cell| *cell == name);
    let (Some(file), Some(seconds)) = (column("file"), column("best_seconds")) else {
        return Vec::new();
    };
    let solver = column("best_solver");
    let entry = |cells: Vec<&str>| {
        Some(Best {
            file: cells.get(file)?.to_string(),
            seconds: cells.get(seconds)?.parse().ok()?,
            by: solver
                .and_then(|at| cells.get(at))
                .map_or_else(String::new, |by| by.to_string()),
        })
    };
    lines.filter_map(entry).collect()
}

/// Seconds of a run over the best known: infinite where it failed.
pub fn ratio(run: &Run, known: &[Best]) -> Option<f64> {
    let best = known.iter().find(|best| best.file == run.file)?;
    Some(run.success().unwrap_or(f64::INFINITY) / best.seconds)
}

/// All runs, one a row.
pub fn table(runs: &[Run], known: &[Best]) -> Table {
    let header = [
        "file",
        "contacts",
        "rank",
        "method",
        "solved",
        "error",
        "error_scaled",
        "iterations",
        "processor seconds",
        "over best known",
        "best known by",
        "by",
    ];
    let row = |run: &Run| {
        let best = known.iter().find(|best| best.file == run.file);
        vec![
            run.file.clone(),
            run.contacts.to_string(),
            run.rank.map_or_else(String::new, |rank| rank.to_string()),
            run.method.clone(),
            if run.solved() { "yes" } else { "no" }.to_owned(),
            format!("{:.2e}", run.residual.unscaled),
            format!("{:.2e}", run.residual.scaled),
            run.iterations.to_string(),
            format!("{:.3e}", run.seconds),
            ratio(run, known).map_or_else(String::new, |ratio| format!("{ratio:.2}")),
            best.map_or_else(String::new, |best| best.by.clone()),
            run.end.clone(),
        ]
    };
    Table {
        name: "contact-bench".to_owned(),
        title: "Methods for the discrete frictional contact problem".to_owned(),
        header: header.map(str::to_owned).to_vec(),
        rows: runs.iter().map(row).collect(),
    }
}

/// How many problems a method solves and how fast, as a line; `None` if it was not run.
pub fn summary(method: &str, runs: &[Run], known: &[Best]) -> Option<String> {
    let own: Vec<&Run> = runs.iter().filter(|run| run.method == method).collect();
    let first = own.first()?;
    let solved = own.iter().filter(|run| run.solved()).count();
    let mut line = format!("{:<24} solves {solved} of {}", first.method, own.len());
    let ratios: Vec<f64> = own.iter().filter_map(|run| ratio(run, known)).collect();
    if !ratios.is_empty() {
        let within = |bound: f64| ratios.iter().filter(|ratio| **ratio <= bound).count();
        line += &format!(
            "; of {} with a time to compare {} within it, {} within 2 ×, {} within 4 ×",
            ratios.len(),
            within(1.0),
            within(2.0),
            within(4.0)
        );
    }
    Some(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(file: &str, seconds: f64, error: f64) -> Run {
        Run {
            file: file.to_owned(),
            method: "Auto".to_owned(),
            contacts: 1,
            rank: None,
            residual: Residual {
                scaled: error,
                of_load: error,
                unscaled: error,
            },
            iterations: 1,
            seconds,
            end: String::new(),
        }
    }

    #[test]
    fn what_fails_is_infinitely_slow() {
        let known = [("a", 1.0), ("b", 1.0)].map(|(file, seconds)| Best {
            file: file.to_owned(),
            seconds,
            by: "NSGS".to_owned(),
        });
        let runs = [
            run("a", 1.5, 1e-9),
            run("b", 0.5, 1e-7),
            run("c", 1.0, 1e-9),
        ];
        let ratios: Vec<_> = runs.iter().map(|run| ratio(run, &known)).collect();
        assert_eq!(ratios, [Some(1.5), Some(f64::INFINITY), None]);
        let line = summary("Auto", &runs, &known).unwrap();
        assert!(
            line.ends_with(
                "solves 2 of 3; of 2 with a time to compare 0 within it, 1 within 2 ×, 1 within 4 ×"
            ),
            "{line}"
        );
        assert!(summary("Uzawa", &runs, &known).is_none());
    }
}
