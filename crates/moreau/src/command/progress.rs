//! One line for each increment on stderr, a bar on a terminal, plain lines elsewhere; or every
//! iteration as JSON on stdout. And the wish to stop.

use super::signals::Signals;
use super::tell;
use crate::run::{Resumable, Watch};
use crate::simulation::Converged;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, ErrorKind, IsTerminal, Write};

/// Shows a run as it goes on.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
    json: bool,
    /// Why a line of the log is missing.
    unwritten: Option<io::Error>,
    signals: Signals,
}

impl Progress {
    pub(super) fn new(quiet: bool, json: bool, signals: Signals) -> Self {
        let quiet = quiet || json;
        let terminal = io::stderr().is_terminal();
        let bar = (terminal && !quiet).then(|| {
            let bar = ProgressBar::new(1000);
            let style = ProgressStyle::with_template("{elapsed:>5} {bar:24} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self {
            bar,
            quiet,
            json,
            unwritten: None,
            signals,
        }
    }

    /// Why a line of the log could not be written, if one could not.
    pub(super) fn unwritten(&self) -> Option<&io::Error> {
        self.unwritten.as_ref()
    }

    pub(super) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish();
        }
    }
}

/// A duration for a person.
fn span(seconds: f64) -> String {
    let s = seconds.max(0.0).round() as u64;
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {:02} s", s / 60, s % 60),
        _ => format!("{} h {:02} min", s / 3600, s % 3600 / 60),
    }
}

impl Watch for Progress {
    fn converged(&mut self, increment: &Converged, seconds_left: f64) {
        if self.quiet {
            return;
        }
        let r = &increment.report;
        let cuts = match r.cuts {
            0 => String::new(),
            n => format!(", {n} cuts"),
        };
        let astray = match r.astray_iterations {
            0 => String::new(),
            n => format!(" ({n} of them on ways that led to no balance)"),
        };
        let line = format!(
            "step {}/{} {}, increment {} ({:.4} % of the step{cuts}): {} Newton{astray}, {} contact; \
             {} open, {} stick, {} slip; {:.1} % plastic; gap {:.1e}; {} left",
            increment.stage,
            increment.stages,
            increment.step,
            r.increment,
            100.0 * r.fraction,
            r.newton_iterations,
            r.contact_iterations,
            r.open,
            r.stick,
            r.slip,
            100.0 * r.plastic_fraction,
            r.certificate.bipotential_gap,
            span(seconds_left)
        );
        match &self.bar {
            None => tell!("{line}"),
            Some(bar) => {
                bar.set_position((1000.0 * increment.done) as u64);
                bar.set_message(line);
            }
        }
    }

    fn iterated(&mut self, line: &str) {
        if self.json
            && let Err(error) = writeln!(io::stdout(), "{line}")
            // A reader that has gone misses nothing.
            && error.kind() != ErrorKind::BrokenPipe
        {
            self.unwritten.get_or_insert(error);
        }
    }

    fn reached(&mut self, state: &dyn Fn() -> Resumable) {
        self.signals.keep(state());
    }

    fn stops(&self) -> bool {
        self.signals.raised()
    }
}
