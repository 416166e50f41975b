//! Foreign libraries that only one file may name; which package may depend on them is another check.

use super::Violation;
use super::lexer::Kind;
use super::source::Source;

/// Linear algebra: a library to be replaced in one file for each kind of matrix.
const ALGEBRA: (&str, [&str; 4]) = (
    "faer",
    [
        "crates/driver/src/cholesky.rs",
        "crates/driver/src/dense.rs",
        "crates/contact/src/dense.rs",
        "crates/contact/src/sparse.rs",
    ],
);

/// Files that name a library that is not theirs.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (path, line) in naming(sources, ALGEBRA.0) {
        if !ALGEBRA.1.contains(&path) {
            let expected = format!("only {} to", ALGEBRA.1.join(" and "));
            violations.push(Violation::new(path, line, "names faer", expected));
        }
    }
    violations
}

/// The files whose code has a word that begins so, with the first line.
fn naming<'a>(sources: &'a [Source], library: &str) -> Vec<(&'a str, usize)> {
    let named = |source: &'a Source| {
        let mut words = source
            .tokens
            .iter()
            .filter(|token| token.kind == Kind::Word);
        let word = words.find(|token| {
            token
                .text
                .strip_prefix(library)
                .is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
        })?;
        Some((source.path.as_str(), word.line))
    };
    sources.iter().filter_map(named).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(files: &[(&str, &str)]) -> Vec<(String, usize)> {
        let sources: Vec<Source> = files
            .iter()
            .map(|(path, text)| Source::new(path, text))
            .collect();
        violations(&sources)
            .into_iter()
            .map(|v| (v.file, v.line))
            .collect()
    }

    #[test]
    fn the_one_file_passes_and_comments_do() {
        let sparse = ("crates/driver/src/cholesky.rs", "use faer::Mat;");
        let comment = ("crates/laws/src/lib.rs", "// faer\nlet a = \"faer\";");
        assert!(found(&[sparse, comment]).is_empty());
    }

    #[test]
    fn other_files_are_found() {
        let system = ("crates/driver/src/system.rs", "\nuse faer_traits::X;");
        assert_eq!(found(&[system]), [(system.0.to_owned(), 2)]);
    }
}
