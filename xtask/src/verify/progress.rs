//! Tells on standard error where the running cases are; not what came of them.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// Where the progress of all cases is shown.
pub enum Board {
    /// A line a case that turns and tells the time, below what is written to the terminal.
    Spinners(MultiProgress),
    /// Standard error is a file or a pipe: one plain line per message.
    Lines,
    /// Nothing.
    #[cfg(test)]
    Silent,
}

impl Board {
    /// The one that suits standard error.
    pub fn of_stderr() -> Self {
        if std::io::stderr().is_terminal() {
            Self::Spinners(MultiProgress::new())
        } else {
            Self::Lines
        }
    }

    /// Begins to tell about the case of this name.
    pub fn case(&self, name: &str) -> Progress {
        match self {
            Self::Spinners(lines) => Progress::Spinner(lines.add(spinner(name))),
            Self::Lines => Progress::Lines {
                name: name.to_owned(),
                start: Instant::now(),
            },
            #[cfg(test)]
            Self::Silent => Progress::Silent,
        }
    }

    /// Takes the lines away while something is written to the terminal.
    pub fn pause<T>(&self, write: impl FnOnce() -> T) -> T {
        match self {
            Self::Spinners(lines) => lines.suspend(write),
            _ => write(),
        }
    }
}

fn spinner(name: &str) -> ProgressBar {
    let bar = ProgressBar::new_spinner().with_prefix(name.to_owned());
    if let Ok(style) = ProgressStyle::with_template(
        "{spinner:.cyan} {prefix:.bold} {elapsed:>5.dim} {wide_msg:.dim}",
    ) {
        bar.set_style(style.tick_chars("⠋⠙⠹⠸⠼⠴⠦⠧⠇⠏ "));
    }
    bar.enable_steady_tick(Duration::from_millis(100));
    bar
}

/// Progress of one case.
pub enum Progress {
    /// Its line; gone when the case ends.
    Spinner(ProgressBar),
    /// Plain lines.
    Lines { name: String, start: Instant },
    /// Nothing.
    #[cfg(test)]
    Silent,
}

impl Progress {
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
