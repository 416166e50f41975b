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
/// Plots: one file, somewhere below this.
const PLOTS: (&str, &str) = ("kuva", "crates/moreau/src/plot");

/// Files that name a library that is not theirs.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (path, line) in naming(sources, ALGEBRA.0) {
        if !ALGEBRA.1.contains(&path) {
            let expected = format!("only {} to", ALGEBRA.1.join(" and "));
            violations.push(Violation::new(path, line, "names faer", expected));
        }
    }
    let mut home: Option<&str> = None;
    for (path, line) in naming(sources, PLOTS.0) {
        let below = path
            .strip_prefix(PLOTS.1)
            .is_some_and(|rest| rest.starts_with(['/', '.']));
        if !below {
            let expected = format!("only one file of {} to", PLOTS.1);
            violations.push(Violation::new(path, line, "names kuva", expected));
        } else if let Some(first) = home {
            violations.push(Violation::new(
                path,
                line,
                "names kuva",
                format!("only {first} to"),
            ));
        } else {
            home = Some(path);
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
        let plots = ("crates/moreau/src/plot/backend.rs", "use kuva::Plot;");
        let comment = (
            "crates/laws/src/lib.rs",
            "// faer and kuva\nlet a = \"faer\";",
        );
        assert!(found(&[sparse, plots, comment]).is_empty());
    }

    #[test]
    fn other_files_are_found() {
        let system = ("crates/driver/src/system.rs", "\nuse faer_traits::X;");
        assert_eq!(found(&[system]), [(system.0.to_owned(), 2)]);
        let first = ("crates/moreau/src/plot.rs", "kuva::plot();");
        let second = ("crates/moreau/src/plot/mesh.rs", "kuva::plot();");
        assert_eq!(found(&[first, second]), [(second.0.to_owned(), 1)]);
        let elsewhere = ("crates/moreau/src/plotting.rs", "kuva::plot();");
        assert_eq!(found(&[elsewhere]), [(elsewhere.0.to_owned(), 1)]);
    }
}
