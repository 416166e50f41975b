//! Colours of the terminal and when to use them; not what is written in them.

use std::io::IsTerminal;

/// Colours, or none.
#[derive(Debug, Clone, Copy)]
pub struct Paint {
    coloured: bool,
}

impl Paint {
    /// Colours if standard output is a terminal and `NO_COLOR` is not set.
    pub fn of_stdout() -> Self {
        let refused = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
        Self {
            coloured: std::io::stdout().is_terminal() && !refused,
        }
    }

    /// No colours.
    #[cfg(test)]
    pub fn plain() -> Self {
        Self { coloured: false }
    }

    fn with(self, code: &str, text: &str) -> String {
        if self.coloured {
            format!("\x1b[{code}m{text}\x1b[0m")
        } else {
            text.to_owned()
        }
    }

    /// Text that should not draw attention.
    pub fn faint(self, text: &str) -> String {
        self.with("2", text)
    }

    /// Text that should.
    pub fn bold(self, text: &str) -> String {
        self.with("1", text)
    }

    /// Green or red.
    pub fn good_or_bad(self, good: bool, text: &str) -> String {
        self.with(if good { "32" } else { "31;1" }, text)
    }

    /// ✓ or ✗.
    pub fn mark(self, pass: bool) -> String {
        self.good_or_bad(pass, if pass { "✓" } else { "✗" })
    }
}
