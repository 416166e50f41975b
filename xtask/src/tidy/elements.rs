//! An element is a short file; how long other files are is left to taste.
//!
//! Counted are the lines on which code begins, that is any token outside of comments and of items for
//! tests. Blank lines, comments, doc comments (with the drawing of the element) are free.

use std::collections::BTreeSet;

use super::Violation;
use super::source::Source;

const FOLDER: &str = "crates/mesh/src/element/";
const MOST: usize = 80;

/// Elements with too many lines of code.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let elements = sources
        .iter()
        .filter(|source| source.path.starts_with(FOLDER));
    elements
        .filter_map(|source| {
            let lines: BTreeSet<usize> = source.shipped().map(|token| token.line).collect();
            let first_too_many = lines.iter().nth(MOST)?;
            let what = format!("{} lines of code in an element", lines.len());
            Some(Violation::new(
                &source.path,
                *first_too_many,
                what,
                format!("at most {MOST}"),
            ))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, lines: usize) -> Vec<Violation> {
        let free = "//! A cell.\n\n/// ```text\n/// 0 ─ 1\n/// ```\n";
        let tests = "#[cfg(test)]\nmod tests {\n fn a() {}\n}\n";
        let text = format!("{free}{}{tests}", "let a = 1; // so\n".repeat(lines));
        violations(&[Source::new(path, &text)])
    }

    #[test]
    fn long_elements_are_found() {
        assert!(found("crates/mesh/src/element/tri3.rs", 80).is_empty());
        let list = found("crates/mesh/src/element/tri3.rs", 81);
        assert_eq!(list[0].what, "81 lines of code in an element");
        assert_eq!(list[0].line, 5 + 81);
    }

    #[test]
    fn other_files_may_be_long() {
        assert!(found("crates/mesh/src/element.rs", 200).is_empty());
    }
}
