//! What came of all cases, in numbers and in a line; the checks themselves are shown elsewhere.

use super::execute::Run;
use super::paint::Paint;
use super::terminal::count;

/// What came of all cases.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Verdict {
    /// Checks that hold.
    pub passed: usize,
    /// Checks that do not.
    pub failed: usize,
    /// Cases without an outcome.
    pub erred: usize,
    /// How long all of it took \[s\].
    pub seconds: f64,
}

impl Verdict {
    /// Counts; the runs took so many seconds in all.
    pub fn of(runs: &[Run<'_>], seconds: f64) -> Self {
        let passed = runs.iter().map(Run::passed).sum();
        let all: usize = runs.iter().map(|run| run.checks().len()).sum();
        Self {
            passed,
            failed: all - passed,
            erred: runs.iter().filter(|run| run.error().is_some()).count(),
            seconds,
        }
    }

    /// Whether no check failed and no case erred.
    pub fn pass(&self) -> bool {
        self.failed == 0 && self.erred == 0
    }

    /// The counts in words.
    pub fn words(&self) -> String {
        if self.passed + self.failed + self.erred == 0 {
            return "nothing was checked".to_owned();
        }
        let mut words = format!("{} passed", count(self.passed, "check"));
        if self.failed > 0 {
            words += &format!(", {} failed", self.failed);
        }
        if self.erred > 0 {
            words += &format!(", {} erred", count(self.erred, "case"));
        }
        words
    }

    /// The last line on the terminal.
    pub fn line(&self, report: &str, paint: Paint) -> String {
        let words = paint.good_or_bad(self.pass(), &self.words());
        format!(
            "{} {words} in {:.1} s; report: {report}",
            paint.mark(self.pass()),
            self.seconds
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_verdict_is_one_line() {
        let verdict = Verdict {
            passed: 1,
            failed: 2,
            erred: 1,
            seconds: 3.21,
        };
        let line = verdict.line("a.html", Paint::plain());
        assert_eq!(
            line,
            "✗ 1 check passed, 2 failed, 1 case erred in 3.2 s; report: a.html"
        );
        let verdict = Verdict {
            passed: 2,
            failed: 0,
            erred: 0,
            seconds: 0.0,
        };
        assert_eq!(verdict.words(), "2 checks passed");
    }
}
