//! The driver takes its threads from one file: one that names rayon elsewhere does not compile where there are none, as in a
//! browser, and nothing else compiles it that way with every change.

use super::Violation;
use super::source::{Part, Source};

const FOLDER: &str = "crates/driver/src/";
const FILE: &str = "crates/driver/src/threads.rs";

/// Files of the driver that name rayon, but the one that may.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let others = sources
        .iter()
        .filter(|source| source.path.starts_with(FOLDER) && source.path != FILE);
    others
        .flat_map(|source| {
            let lines = source.lines_of("rayon", Part::Shipped);
            lines.into_iter().map(|line| {
                let expected = format!("threads of {FILE}");
                Violation::new(&source.path, line, "rayon named", expected)
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_that_are_no_threads_of_one_file_are_found() {
        let found = |path: &str, text: &str| violations(&[Source::new(path, text)]).len();
        let used = "fn a() { use rayon::prelude::*; }";
        assert_eq!(found("crates/driver/src/assembly/panel.rs", used), 1);
        assert_eq!(found("crates/algebra/src/sweep.rs", used), 0);
        assert_eq!(found(FILE, used), 0);
        let tests = "#[cfg(test)] mod tests { use rayon::prelude::*; }";
        assert_eq!(found("crates/driver/src/state.rs", tests), 0);
    }
}
