//! Tells on standard error where a running case is; not what came of it.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Progress of one case.
pub enum Progress {
    /// A line that turns and tells the time; gone when the case ends.
    Spinner(ProgressBar),
    /// Standard error is a file or a pipe: one plain line per message.
    Lines { name: String, start: Instant },
    /// Nothing.
    #[cfg(test)]
    Silent,
}

impl Progress {
    /// Begins to tell about the case of this name.
    pub fn new(name: &str) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self::Lines {
                name: name.to_owned(),
                start: Instant::now(),
            };
        }
        let bar = ProgressBar::new_spinner().with_prefix(name.to_owned());
        if let Ok(style) = ProgressStyle::with_template(
            "{spinner:.cyan} {prefix:.bold} {elapsed:>5.dim} {wide_msg:.dim}",
        ) {
            bar.set_style(style.tick_chars("⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏ "));
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self::Spinner(bar)
    }

    /// Tells nothing.
    #[cfg(test)]
    pub fn silent() -> Self {
        Self::Silent
    }

    /// Shows what the case is doing now.
    pub fn tell(&self, message: &str) {
        match self {
            Self::Spinner(bar) => bar.set_message(message.to_owned()),
            Self::Lines { name, start } => {
                eprintln!("{name} {:6.1} s  {message}", start.elapsed().as_secs_f64());
            }
            #[cfg(test)]
            Self::Silent => {}
        }
    }

    /// Ends; the line of the spinner disappears.
    pub fn finish(self) {
        if let Self::Spinner(bar) = self {
            bar.finish_and_clear();
        }
    }
}
