//! One line for each increment on stderr: a bar on a terminal, plain lines elsewhere.

use indicatif::{ProgressBar, ProgressStyle};
use moreau::run::Event;
use std::io::IsTerminal;

/// Shows increments as they converge.
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    pub(crate) fn new(quiet: bool) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = (terminal && !quiet).then(|| {
            let bar = ProgressBar::new(1000);
            let style = ProgressStyle::with_template("{elapsed:>5} {bar:24} {msg}");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
            bar
        });
        Self { bar, quiet }
    }

    pub(crate) fn show(&self, event: &Event<'_>) {
        if self.quiet {
            return;
        }
        let r = event.report;
        let cuts = match r.cuts {
            0 => String::new(),
            n => format!(", {n} cuts"),
        };
        let line = format!(
            "step {}/{} {}, increment {} ({:.4} % of the step{cuts}): {} Newton, {} contact; \
             {} open, {} stick, {} slip; {:.1} % plastic; gap {:.1e}",
            event.stage,
            event.stages,
            event.step,
            r.increment,
            100.0 * r.fraction,
            r.newton_iterations,
            r.contact_iterations,
            r.open,
            r.stick,
            r.slip,
            100.0 * r.plastic_fraction,
            r.certificate.bipotential_gap
        );
        match &self.bar {
            None => eprintln!("{line}"),
            Some(bar) => {
                let done = (event.stage - 1) as f64 + r.fraction;
                bar.set_position((1000.0 * done / event.stages as f64) as u64);
                bar.set_message(line);
            }
        }
    }

    pub(crate) fn end(&self) {
        if let Some(bar) = &self.bar {
            bar.finish();
        }
    }
}
