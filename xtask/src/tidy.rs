//! `cargo xtask tidy`: the architecture of the workspace as absences, checked from manifests and
//! sources; neither a formatter nor a linter of Rust.

mod arrows;
mod documents;
mod elements;
mod equations;
mod forbidden;
mod headers;
mod items;
mod lexer;
mod licences;
mod links;
mod locked;
mod quiet;
mod rooms;
mod source;
mod threads;
mod tree;

use std::error::Error;
use std::fmt;
use std::path::Path;

use tree::Tree;
use verification::workspace;

/// Something that is not as it should be, and where.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Violation {
    /// Path from the root of the workspace.
    file: String,
    /// Line, from 1.
    line: usize,
    /// What is there.
    what: String,
    /// What should be there.
    expected: String,
}

impl Violation {
    /// Says what is found and what is expected.
    fn new(
        file: impl Into<String>,
        line: usize,
        what: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        let (file, what, expected) = (file.into(), what.into(), expected.into());
        Self {
            file,
            line,
            what,
            expected,
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}, expected {}",
            self.file, self.line, self.what, self.expected
        )
    }
}

/// Runs the task; `Ok(true)` when the workspace is tidy.
pub fn run() -> Result<bool, Box<dyn Error>> {
    let root = workspace::root();
    let (tree, mut violations) = violations(&root)?;
    violations.extend(licences::violations(&root)?);
    for violation in &violations {
        println!("{violation}");
    }
    if violations.is_empty() {
        println!(
            "✓ tidy: {} sources, {} files in all",
            tree.sources.len(),
            tree.texts.len()
        );
    } else {
        let plural = if violations.len() == 1 { "" } else { "s" };
        println!("✗ {} violation{plural}", violations.len());
    }
    Ok(violations.is_empty())
}

/// All violations in a workspace, by file and line.
fn violations(root: &Path) -> Result<(Tree, Vec<Violation>), Box<dyn Error>> {
    let tree = Tree::read(root)?;
    let exists = |path: &str| root.join(path).exists();
    let mut found = arrows::violations(&arrows::packages(root)?, &tree);
    found.extend(quiet::violations(&tree.sources));
    found.extend(forbidden::violations(&tree.sources));
    found.extend(headers::violations(&tree.sources));
    found.extend(elements::violations(&tree.sources));
    found.extend(rooms::violations(&tree.sources));
    found.extend(threads::violations(&tree.sources));
    if let Some(text) = tree.text("Cargo.lock") {
        found.extend(locked::violations(text));
    }
    if let Some(text) = tree.text(equations::FILE) {
        found.extend(equations::violations(
            text,
            &items::Items::of(&tree.sources),
        ));
    }
    for text in tree.texts.iter().filter(|text| text.path.ends_with(".md")) {
        found.extend(links::violations(text, &exists));
    }
    found.extend(documents::violations(&tree.texts));
    found.sort();
    found.dedup();
    Ok((tree, found))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_workspace_is_tidy() {
        let (_, violations) = violations(&workspace::root()).unwrap();
        let list: Vec<String> = violations.iter().map(Violation::to_string).collect();
        assert!(list.is_empty(), "\n{}\n", list.join("\n"));
    }

    #[test]
    fn a_violation_is_one_line() {
        let violation = Violation::new("a/b.rs", 3, "unsafe code", "none");
        assert_eq!(
            violation.to_string(),
            "a/b.rs:3: unsafe code, expected none"
        );
    }
}
