//! Runs one case and keeps what came of it, be it an outcome, an error or a panic; not how it is
//! shown.

use std::any::Any;
use std::error::Error;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use verification::{Case, Check, Figure, Options, Outcome, Table};

use super::progress::Progress;

/// A case that was run.
pub struct Run<'a> {
    /// The case.
    pub case: &'a Case,
    /// How long it took \[s\].
    pub seconds: f64,
    /// Its outcome, or why there is none.
    pub result: Result<Outcome, String>,
}

impl Run<'_> {
    /// The checks; none if the case erred.
    pub fn checks(&self) -> &[Check] {
        self.result.as_ref().map_or(&[], |outcome| &outcome.checks)
    }

    /// The tables.
    pub fn tables(&self) -> &[Table] {
        self.result.as_ref().map_or(&[], |outcome| &outcome.tables)
    }

    /// The figures.
    pub fn figures(&self) -> &[Figure] {
        self.result.as_ref().map_or(&[], |outcome| &outcome.figures)
    }

    /// The notes.
    pub fn notes(&self) -> &[String] {
        self.result.as_ref().map_or(&[], |outcome| &outcome.notes)
    }

    /// Why there is no outcome.
    pub fn error(&self) -> Option<&str> {
        self.result.as_ref().err().map(String::as_str)
    }

    /// Number of checks that hold.
    pub fn passed(&self) -> usize {
        self.checks().iter().filter(|check| check.pass).count()
    }

    /// Whether there is an outcome and all its checks hold.
    pub fn pass(&self) -> bool {
        self.result.is_ok() && self.passed() == self.checks().len()
    }
}

/// Runs a case. A panic in it is a failure of this case, and no reason to lose the others.
pub fn execute(case: &Case, quick: bool, progress: Progress) -> Run<'_> {
    let start = Instant::now();
    let report = |line: &str| progress.tell(line);
    let options = Options {
        quick,
        progress: &report,
    };
    let result = catch_unwind(AssertUnwindSafe(|| (case.run)(&options)));
    let seconds = start.elapsed().as_secs_f64();
    progress.finish();
    let result = match result {
        Ok(Ok(outcome)) => Ok(outcome),
        Ok(Err(error)) => Err(with_causes(&*error)),
        Err(panic) => Err(format!("panicked: {}", message(&*panic))),
    };
    Run {
        case,
        seconds,
        result,
    }
}

/// An error and what caused it, in one line; a cause that the error already quotes is not repeated.
fn with_causes(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        let inner_text = inner.to_string();
        if !text.contains(&inner_text) {
            text = format!("{text}: {inner_text}");
        }
        cause = inner.source();
    }
    text
}

/// The text of a panic.
fn message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::samples;

    fn run_of(name: &str) -> (bool, Option<String>) {
        let cases = samples::cases();
        let case = cases.iter().find(|case| case.name == name).unwrap();
        let run = execute(case, true, Progress::Silent);
        (run.pass(), run.error().map(str::to_owned))
    }

    #[test]
    fn outcomes_errors_and_panics_are_told_apart() {
        assert_eq!(run_of("sound"), (true, None));
        assert_eq!(run_of("flawed"), (false, None));
        let erred = (
            false,
            Some("the step failed: 12 iterations were not enough".to_owned()),
        );
        assert_eq!(run_of("erring"), erred);
        assert_eq!(
            run_of("panicking"),
            (false, Some("panicked: index 7".to_owned()))
        );
    }
}
