//! Links and files named in the documents lead somewhere in the workspace; addresses elsewhere are not
//! looked up.
//!
//! In every `*.md`: links, relative to the document. In `README.md` also the files named in code, in
//! text or in blocks: a word below one of the folders of the root, or one that ends in `.rs`, `.md` or
//! `.toml` behind a folder. What is under `target` appears only when something was run.

use super::Violation;
use super::tree::Text;

/// What of a document does not exist.
pub fn violations(document: &Text, exists: &dyn Fn(&str) -> bool) -> Vec<Violation> {
    let folder = document
        .path
        .rsplit_once('/')
        .map_or("", |(folder, _)| folder);
    let mut violations = Vec::new();
    let mut in_block = false;
    for (at, line) in document.text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
            continue;
        }
        let links = if in_block { vec![] } else { links(line) };
        let links = links.into_iter().map(|link| joined(folder, link));
        let named = if document.path == "README.md" {
            named(line, in_block, exists)
        } else {
            vec![]
        };
        for path in links.chain(named) {
            let product = path == "target" || path.starts_with("target/");
            if !product && !exists(&path) {
                let what = format!("names {path}");
                violations.push(Violation::new(
                    &document.path,
                    at + 1,
                    what,
                    "a file that exists",
                ));
            }
        }
    }
    violations
}

/// Targets of the relative links of a line, in brackets or in HTML.
fn links(line: &str) -> Vec<&str> {
    // Code is no link, a[i](x) in it least of all.
    let prose: Vec<&str> = line.split('`').collect();
    let mut found = Vec::new();
    for text in prose
        .iter()
        .enumerate()
        .filter(|(i, _)| i % 2 == 0)
        .map(|(_, text)| *text)
    {
        for (opening, closing) in [("](", ')'), ("src=\"", '"'), ("href=\"", '"'), ("]: ", ' ')] {
            for (at, _) in text.match_indices(opening) {
                let rest = &text[at + opening.len()..];
                let target = rest.split(closing).next().unwrap_or_default();
                let target = target.split([' ', '#']).next().unwrap_or_default();
                found.push(target.trim_matches(['<', '>']));
            }
        }
    }
    // Links with blanks in code, [`a`](b), are cut by the backticks: take them from the whole line.
    for (at, _) in line.match_indices("`](") {
        found.push(
            line[at + 3..]
                .split([')', ' ', '#'])
                .next()
                .unwrap_or_default(),
        );
    }
    let path = |target: &&str| target.contains(['.', '/']) && !target.contains("://");
    found.retain(|target| path(target) && !target.starts_with("mailto:"));
    found.sort_unstable();
    found.dedup();
    found
}

/// A path from the root, of a target relative to a folder.
fn joined(folder: &str, target: &str) -> String {
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

/// Files named by the code of a line.
fn named(line: &str, in_block: bool, exists: &dyn Fn(&str) -> bool) -> Vec<String> {
    let code: Vec<&str> = if in_block {
        vec![line]
    } else {
        line.split('`').skip(1).step_by(2).collect()
    };
    let mut found = Vec::new();
    for span in code {
        for word in span.split_whitespace() {
            let word = word
                .trim_end_matches([',', ';', ':', '.', ')', '/'])
                .trim_start_matches('(');
            let word = word.strip_prefix("./").unwrap_or(word);
            let Some((first, _)) = word.split_once('/') else {
                continue;
            };
            let plain = |c: char| c.is_alphanumeric() || "-_./+".contains(c);
            let alone = !in_block && span.trim() == word;
            let source = [".rs", ".md", ".toml"]
                .iter()
                .any(|end| word.ends_with(end));
            if word.chars().all(plain) && !first.is_empty() && (exists(first) || alone && source) {
                found.push(word.to_owned());
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(path: &str, text: &str) -> Vec<String> {
        let exists = |path: &str| {
            [
                "docs",
                "docs/a.md",
                "docs/b c.svg",
                "LICENSE-MIT",
                "crates",
                "crates/laws",
            ]
            .contains(&path)
        };
        let document = Text {
            path: path.to_owned(),
            text: text.to_owned(),
        };
        let list = violations(&document, &exists);
        list.into_iter()
            .map(|v| format!("{}: {}", v.line, v.what))
            .collect()
    }

    #[test]
    fn what_exists_passes() {
        for text in [
            "[a](docs/a.md), ![b](./docs/a.md \"title\"), [c](docs/a.md#part), [d](#part)",
            "[`a`](docs/a.md) and <img src=\"docs/a.md\">",
            "[e](https://example.org/a.md) `crates/laws/` `N/mm` `cargo run -- docs/a.md`",
            "`target/verify/report.html` [r](target/verify/report.html)",
            "```sh\ncargo xtask verify a/b [a](b.md)\n```",
            "f[0](x) and `a[i](b.c)` and `figures/*.svg` and `docs/*.md`",
        ] {
            assert!(
                found("README.md", text).is_empty(),
                "{text}: {:?}",
                found("README.md", text)
            );
        }
        assert!(
            found(
                "docs/x.md",
                "[a](a.md) [l](../LICENSE-MIT) `docs/missing.rs`"
            )
            .is_empty()
        );
    }

    #[test]
    fn what_does_not_exist_is_found() {
        assert_eq!(
            found("README.md", "\n[a](docs/b.md)"),
            ["2: names docs/b.md"]
        );
        assert_eq!(found("README.md", "[`a`](b.md)"), ["1: names b.md"]);
        assert_eq!(
            found("README.md", "see `crates/mesh`"),
            ["1: names crates/mesh"]
        );
        assert_eq!(
            found("README.md", "see `crate/lib.rs`"),
            ["1: names crate/lib.rs"]
        );
        assert_eq!(
            found("README.md", "```sh\nmoreau run docs/x.toml\n```"),
            ["2: names docs/x.toml"]
        );
        assert_eq!(
            found("docs/x.md", "[a](docs/a.md)"),
            ["1: names docs/docs/a.md"]
        );
        assert_eq!(found("docs/x.md", "[a]: b.md"), ["1: names docs/b.md"]);
    }
}
