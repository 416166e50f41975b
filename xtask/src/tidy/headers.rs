//! Every source says on its first line what it is; whether it says the truth is for the reader.

use super::Violation;
use super::source::Source;

/// Sources of packages, not of their tests, that do not begin with `//!`.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let begins = |source: &Source| source.first_line.starts_with("//! ");
    sources
        .iter()
        .filter(|source| of_package(&source.path) && !begins(source))
        .map(|source| {
            Violation::new(
                &source.path,
                1,
                "no header",
                "`//! …`: what it is, what not",
            )
        })
        .collect()
}

/// Whether a file is one of `crates/*/src`, `tests/src`, `xtask/src` and `xtask/benchmarks/src`.
fn of_package(path: &str) -> bool {
    let in_crate = path
        .strip_prefix("crates/")
        .and_then(|rest| rest.split_once('/'));
    let rest = in_crate.map(|(_, rest)| rest);
    let rest = rest
        .or_else(|| path.strip_prefix("tests/"))
        .or_else(|| path.strip_prefix("xtask/benchmarks/"))
        .or_else(|| path.strip_prefix("xtask/"));
    rest.is_some_and(|rest| rest.starts_with("src/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn count(path: &str, text: &str) -> usize {
        violations(&[Source::new(path, text)]).len()
    }

    #[test]
    fn sources_without_header_are_found() {
        for path in [
            "crates/a/src/b.rs",
            "crates/a/src/b/c.rs",
            "tests/src/b.rs",
            "xtask/src/b.rs",
            "xtask/benchmarks/src/b.rs",
        ] {
            assert_eq!(count(path, "//! A thing; not another.\n"), 0);
            assert_eq!(count(path, "use std::fmt;\n//! A thing.\n"), 1);
            assert_eq!(count(path, ""), 1);
        }
    }

    #[test]
    fn other_sources_need_none() {
        assert_eq!(count("crates/a/tests/b.rs", "use a;"), 0);
        assert_eq!(count("crates/a/build.rs", "use a;"), 0);
    }
}
