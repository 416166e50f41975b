//! Text speaks of the project alone: of no machine it was written on, and of no way it came about;
//! style and spelling are for the reader.

use super::Violation;
use super::tree::Text;

/// Folders of a machine, at the root of its file system.
const ROOTS: [&str; 8] = [
    "home",
    "root",
    "work",
    "tmp",
    "Users",
    "mnt",
    "workspace",
    "private",
];
/// Hosts of package registries; put together here, so that this file does not name them.
const REGISTRIES: [&str; 4] = [
    concat!("crates", ".io"),
    concat!("pypi", ".org"),
    concat!("npmjs", ".com"),
    concat!("npmjs", ".org"),
];
/// Words about how a text came about.
const WORDS: [&str; 7] = [
    "session",
    "sessions",
    "sandbox",
    "assistant",
    "transcript",
    "subagent",
    "chatbot",
];

/// Paths of machines and hosts of registries in any text, words of the workshop in `*.md`.
/// `Cargo.lock` is written by cargo, which names its registry.
pub fn violations(texts: &[Text]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for text in texts
        .iter()
        .filter(|text| !text.path.ends_with("Cargo.lock"))
    {
        for (at, line) in text.text.lines().enumerate() {
            let mut add = |what: String, expected: &str| {
                violations.push(Violation::new(&text.path, at + 1, what, expected));
            };
            if let Some(path) = machine_path(line) {
                add(
                    format!("absolute path {path}…"),
                    "a path from the root of the workspace",
                );
            }
            for host in REGISTRIES.iter().filter(|host| line.contains(*host)) {
                add(format!("host {host}"), "no registry named");
            }
            if text.path.ends_with(".md") {
                for word in workshop_words(line) {
                    add(format!("\"{word}\""), "text about the project alone");
                }
            }
        }
    }
    violations
}

/// The beginning of a path such as `/⟨root⟩/…`.
fn machine_path(line: &str) -> Option<String> {
    let path = |root: &str, separator: char| {
        let start = format!("{separator}{root}{separator}");
        let mut places = line.match_indices(&start);
        // a/work/b is a relative path.
        let begins = |at: usize| {
            let before = line[..at].chars().next_back();
            !before.is_some_and(|c| c.is_alphanumeric() || "._-~})>*\\".contains(c))
        };
        places.find(|(at, _)| begins(*at)).map(|_| start)
    };
    let unix = ROOTS.iter().find_map(|root| path(root, '/'));
    unix.or_else(|| {
        line.contains(":\\Users\\")
            .then(|| "C:\\Users\\".to_owned())
    })
}

/// The words of a line that are about how it came about.
fn workshop_words(line: &str) -> Vec<String> {
    let words = line
        .split(|c: char| !c.is_alphanumeric())
        .map(str::to_lowercase);
    words
        .filter(|word| WORDS.contains(&word.as_str()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<usize> {
        let text = Text {
            path: path.to_owned(),
            text: text.to_owned(),
        };
        violations(&[text]).into_iter().map(|v| v.line).collect()
    }

    #[test]
    fn machine_paths_are_found() {
        for root in ["home", "root", "work", "tmp", "Users"] {
            assert_eq!(
                found("a.rs", &format!("x\nlet a = \"/{root}/b\";")),
                [2],
                "{root}"
            );
        }
        assert_eq!(found("a.md", &format!("see C:{}Users{0}me", '\\')), [1]);
    }

    #[test]
    fn relative_paths_pass() {
        for text in [
            "crates/work/a",
            "../home/a",
            "force/work/energy",
            "#!/usr/bin/env bash",
            "~/tmp/a",
        ] {
            assert!(found("a.md", text).is_empty(), "{text}");
        }
    }

    #[test]
    fn registries_are_found_but_in_the_lock_file() {
        let text = format!("from https://{}/x", REGISTRIES[0]);
        assert_eq!(found("docs/a.md", &text), [1]);
        assert!(found("Cargo.lock", &text).is_empty());
    }

    #[test]
    fn words_of_the_workshop_are_found_in_documents() {
        assert_eq!(found("docs/a.md", "\nas in an earlier Session."), [2]);
        assert!(found("docs/a.md", "obsessions and sessional").is_empty());
        assert!(found("src/a.rs", "// session").is_empty());
    }
}
