//! Libraries neither print nor touch files; commands, verification and tests may.

use super::Violation;
use super::lexer::Token;
use super::source::{Part, Source};

/// Folders of the libraries.
const LIBRARIES: [&str; 6] = ["mandel", "algebra", "mesh", "laws", "contact", "driver"];
/// What they may not do, as tokens.
const FORBIDDEN: [&str; 7] = [
    "println !",
    "eprintln !",
    "print !",
    "eprint !",
    "dbg !",
    "std :: fs",
    "std :: io",
];
/// What of it reads bytes in memory.
const IN_MEMORY: &str = "std :: io :: Cursor";

/// Printing and access to files in libraries, outside of their tests.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let mut violations = Vec::new();
    let of_library = |source: &&Source| {
        let folder = source
            .path
            .strip_prefix("crates/")
            .and_then(|rest| rest.split_once('/'));
        folder.is_some_and(|(name, rest)| LIBRARIES.contains(&name) && rest.starts_with("src/"))
    };
    for source in sources.iter().filter(of_library) {
        let mut add = |line, what: &str| {
            let what = format!("{} in a library", what.replace(' ', ""));
            let expected = "values and errors returned to the caller";
            violations.push(Violation::new(&source.path, line, what, expected));
        };
        let in_memory = source.lines_of(IN_MEMORY, Part::Shipped);
        for sequence in FORBIDDEN {
            source
                .lines_of(sequence, Part::Shipped)
                .into_iter()
                .filter(|at| !in_memory.contains(at))
                .for_each(|at| add(at, sequence));
        }
        for (line, module) in grouped(source) {
            add(line, &format!("std::{module}"));
        }
    }
    violations
}

/// `fs` and `io` imported as `std::{…}`.
fn grouped(source: &Source) -> Vec<(usize, String)> {
    let tokens: Vec<&Token> = source.shipped().collect();
    let mut found = Vec::new();
    for at in 0..tokens.len().saturating_sub(2) {
        if [0, 1, 2].map(|i| tokens[at + i].text.as_str()) != ["std", "::", "{"] {
            continue;
        }
        let mut depth = 0_usize;
        for pair in tokens[at + 2..].windows(2) {
            match pair[0].text.as_str() {
                "{" => depth += 1,
                "}" => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                break;
            }
            let begins = depth == 1 && ["{", ","].contains(&pair[0].text.as_str());
            if begins && ["fs", "io"].contains(&pair[1].text.as_str()) {
                found.push((pair[1].line, pair[1].text.clone()));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(path: &str, text: &str) -> Vec<usize> {
        violations(&[Source::new(path, text)])
            .into_iter()
            .map(|v| v.line)
            .collect()
    }

    const LIBRARY: &str = "crates/laws/src/lib.rs";

    #[test]
    fn printing_and_files_are_found() {
        assert_eq!(
            lines(LIBRARY, "fn a() {\n println!(\"x\");\n dbg!(1);\n}"),
            [2, 3]
        );
        assert_eq!(
            lines(LIBRARY, "use std::fs::File;\nfn a(_: std::io::Error) {}"),
            [1, 2]
        );
        assert_eq!(lines(LIBRARY, "use std::{fmt, io};"), [1]);
        assert_eq!(lines(LIBRARY, "use std::io::Cursor;\nuse std::io;"), [2]);
        assert_eq!(
            lines(LIBRARY, "use std::{\n fmt::{self},\n fs::File};"),
            [3]
        );
    }

    #[test]
    fn tests_comments_and_commands_may() {
        assert!(
            lines(
                LIBRARY,
                "/// println!\n#[cfg(test)]\nmod tests { use std::fs; }"
            )
            .is_empty()
        );
        assert!(lines(LIBRARY, "use std::{fmt, ops::{Add, io}};").is_empty());
        assert!(lines("crates/laws/tests/a.rs", "println!();").is_empty());
        assert!(lines("crates/moreau/src/main.rs", "println!();").is_empty());
    }
}
