//! A Rust source as tokens of which it is known whether they belong to tests; not what is checked of
//! them.

use super::lexer::{Kind, Token, tokens};

/// A Rust source.
#[derive(Debug)]
pub struct Source {
    /// Path from the root of the workspace.
    pub path: String,
    /// Its first line.
    pub first_line: String,
    /// Its tokens.
    pub tokens: Vec<Token>,
    /// Which of the tokens belong to tests.
    test: Vec<bool>,
}

/// Which part of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// All code.
    All,
    /// Code that is not only for tests.
    Shipped,
}

impl Source {
    /// Reads a source.
    pub fn new(path: &str, text: &str) -> Self {
        let tokens = tokens(text);
        let test = if is_test_file(path) {
            vec![true; tokens.len()]
        } else {
            test_items(&tokens)
        };
        let first_line = text.lines().next().unwrap_or_default().to_owned();
        Self {
            path: path.to_owned(),
            first_line,
            tokens,
            test,
        }
    }

    /// The tokens that are not only for tests.
    pub fn shipped(&self) -> impl Iterator<Item = &Token> {
        self.tokens
            .iter()
            .zip(&self.test)
            .filter(|(_, test)| !**test)
            .map(|(token, _)| token)
    }

    /// Lines where a sequence of tokens occurs, written with blanks between them: `"std :: fs"`.
    /// Strings and comments do not count.
    pub fn lines_of(&self, sequence: &str, part: Part) -> Vec<usize> {
        let wanted: Vec<&str> = sequence.split(' ').collect();
        let matches = |at: usize| {
            let found = &self.tokens[at..at + wanted.len()];
            let same = |(token, text): (&Token, &&str)| {
                token.kind != Kind::Literal && token.text == **text
            };
            (part == Part::All || !self.test[at]) && found.iter().zip(&wanted).all(same)
        };
        let last = (self.tokens.len() + 1).saturating_sub(wanted.len());
        (0..last)
            .filter(|&at| matches(at))
            .map(|at| self.tokens[at].line)
            .collect()
    }

    /// The attributes `#[…]` and `#![…]`, each as its tokens between the brackets.
    pub fn attributes(&self) -> Vec<&[Token]> {
        (0..self.tokens.len())
            .filter_map(|at| attribute(&self.tokens, at))
            .collect()
    }
}

/// Whether a file below `src` holds nothing but tests: `src/…/tests.rs`, `src/…/tests/…`; and all
/// files of the folders `tests`, `benches` and `examples` of a package.
fn is_test_file(path: &str) -> bool {
    let parts: Vec<&str> = path.split('/').collect();
    match parts.iter().position(|part| *part == "src") {
        Some(src) => parts[src..]
            .iter()
            .any(|part| *part == "tests" || *part == "tests.rs"),
        None => ["tests", "benches", "examples"]
            .iter()
            .any(|folder| parts.contains(folder)),
    }
}

/// The tokens between the brackets of the attribute that begins at a token.
fn attribute(tokens: &[Token], at: usize) -> Option<&[Token]> {
    let text = |i: usize| tokens.get(i).map(|token| token.text.as_str());
    if text(at) != Some("#") {
        return None;
    }
    let open = if text(at + 1) == Some("!") {
        at + 2
    } else {
        at + 1
    };
    if text(open) != Some("[") {
        return None;
    }
    Some(&tokens[open + 1..closing(tokens, open)])
}

/// Index of the bracket that closes the one at `open`, or the end.
fn closing(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match (token.kind, token.text.as_str()) {
            (Kind::Mark, "(" | "[" | "{") => depth += 1,
            (Kind::Mark, ")" | "]" | "}") => depth = depth.saturating_sub(1),
            _ => continue,
        }
        if depth == 0 {
            return at;
        }
    }
    tokens.len()
}

/// Marks the items under `#[test]` and `#[cfg(test)]`.
fn test_items(tokens: &[Token]) -> Vec<bool> {
    let mut test = vec![false; tokens.len()];
    let mut at = 0;
    while at < tokens.len() {
        let Some(inner) = attribute(tokens, at).filter(|inner| is_for_tests(inner)) else {
            at += 1;
            continue;
        };
        let whole_file = tokens[at + 1].text == "!";
        let end = if whole_file {
            tokens.len()
        } else {
            item_end(tokens, at, inner.len())
        };
        test[at..end].fill(true);
        at = end.max(at + 1);
    }
    test
}

fn is_for_tests(attribute: &[Token]) -> bool {
    let has = |word: &str| attribute.iter().any(|token| token.text == word);
    match attribute.first().map(|token| token.text.as_str()) {
        Some("test") => attribute.len() == 1,
        Some("cfg") => has("test") && !has("not"),
        _ => false,
    }
}

/// One past the item whose first attribute begins at `at`: past its braces, or its semicolon.
fn item_end(tokens: &[Token], at: usize, length: usize) -> usize {
    let mut next = at + 3 + length;
    while next < tokens.len() {
        match tokens[next].text.as_str() {
            "{" => return (closing(tokens, next) + 1).min(tokens.len()),
            "(" | "[" => next = closing(tokens, next) + 1,
            ";" => return next + 1,
            _ => next += 1,
        }
    }
    tokens.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shipped(text: &str) -> String {
        let source = Source::new("crates/a/src/lib.rs", text);
        source
            .shipped()
            .map(|token| token.text.as_str())
            .collect::<Vec<_>>()
            .join(" ")
    }

    #[test]
    fn tests_are_not_shipped() {
        let text = "fn a() {}\n#[cfg(test)]\n#[allow(x)]\nmod tests { fn b() { {} } }\nfn c() {}";
        assert_eq!(shipped(text), "fn a ( ) { } fn c ( ) { }");
        assert_eq!(shipped("#[test] fn b(x: [u8; 2]) { } a"), "a");
        assert_eq!(shipped("#[cfg(test)] mod samples; a"), "a");
        assert_eq!(shipped("#![cfg(test)] fn a() {}"), "");
        assert_eq!(
            shipped("#[cfg(not(test))] a"),
            "# [ cfg ( not ( test ) ) ] a"
        );
    }

    #[test]
    fn sequences_are_found_where_they_are_code() {
        let text = "// std::fs\nlet a = \"std::fs\";\nstd::fs::read();\n#[cfg(test)] use std::fs;";
        let source = Source::new("crates/a/src/lib.rs", text);
        assert_eq!(source.lines_of("std :: fs", Part::Shipped), [3]);
        assert_eq!(source.lines_of("std :: fs", Part::All), [3, 4]);
        assert!(
            source
                .lines_of(
                    "std :: fs :: read ( ) ; and a lot more than there is",
                    Part::All
                )
                .is_empty()
        );
    }

    #[test]
    fn whole_files_of_tests() {
        assert!(is_test_file("crates/a/tests/b.rs"));
        assert!(is_test_file("crates/a/src/b/tests.rs"));
        assert!(!is_test_file("crates/a/src/b.rs"));
        assert!(!is_test_file("tests/src/cases.rs"));
    }
}
