//! What no source of the workspace may contain, tests included; style is left to clippy.

use super::Violation;
use super::source::{Part, Source};

/// Sequences of tokens that may not occur, what they are, and what is expected instead.
const FORBIDDEN: [(&str, &str, &str); 3] = [
    ("unsafe", "unsafe code", "safe code"),
    ("todo !", "todo!", "an implementation"),
    ("unimplemented !", "unimplemented!", "an implementation"),
];

/// The file that calls C, and says of every call why it may, and the one whose functions have names of C.
const CALLS: [&str; 2] = ["crates/browser/src/calls.rs", "crates/mumps/src/calls.rs"];

/// Unsafe code, unwritten code and tests that do not run.
pub fn violations(sources: &[Source]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for source in sources {
        let allowed =
            |sequence: &str| sequence == "unsafe" && CALLS.contains(&source.path.as_str());
        for (sequence, what, expected) in FORBIDDEN.into_iter().filter(|(s, ..)| !allowed(s)) {
            for line in source.lines_of(sequence, Part::All) {
                violations.push(Violation::new(&source.path, line, what, expected));
            }
        }
        for word in source
            .attributes()
            .into_iter()
            .flatten()
            .filter(|t| t.text == "ignore")
        {
            let expected = "a test that runs, or none";
            violations.push(Violation::new(
                &source.path,
                word.line,
                "an ignored test",
                expected,
            ));
        }
    }
    violations
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<(usize, String)> {
        let list = violations(&[Source::new("tests/src/a.rs", text)]);
        list.into_iter().map(|v| (v.line, v.what)).collect()
    }

    #[test]
    fn forbidden_code_is_found_in_tests_as_well() {
        assert_eq!(
            found("fn a() {\n unsafe { b() } }"),
            [(2, "unsafe code".to_owned())]
        );
        assert_eq!(
            found("#[cfg(test)] mod a { fn b() { todo!() } }"),
            [(1, "todo!".to_owned())]
        );
        assert_eq!(
            found("\n\nunimplemented!(\"x\")"),
            [(3, "unimplemented!".to_owned())]
        );
    }

    #[test]
    fn ignored_tests_are_found_in_all_spellings() {
        for attribute in [
            "#[ignore]",
            "#[ignore = \"slow\"]",
            "#[cfg_attr(a, ignore)]",
        ] {
            assert_eq!(
                found(&format!("#[test]\n{attribute}\nfn a() {{}}")).len(),
                1,
                "{attribute}"
            );
        }
    }

    #[test]
    fn words_are_no_code() {
        let text =
            "#![forbid(unsafe_code)]\n// unsafe, todo!()\nlet ignore = \"unsafe\"; a(ignore);";
        assert!(found(text).is_empty());
    }
}
