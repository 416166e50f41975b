//! The files of the workspace, read once; not what is checked of them.

use std::fs;
use std::io;
use std::path::Path;

use super::source::Source;

/// Larger files are data, not text to be checked \[bytes\].
const LARGEST: u64 = 1 << 20;

/// A text file.
#[derive(Debug)]
pub struct Text {
    /// Path from the root, with `/`.
    pub path: String,
    /// What it says.
    pub text: String,
}

/// The text files below a root, by path.
#[derive(Debug, Default)]
pub struct Tree {
    /// Rust sources.
    pub sources: Vec<Source>,
    /// All text files, Rust sources as well.
    pub texts: Vec<Text>,
}

impl Tree {
    /// Reads all files but build products, hidden folders other than `.cargo` and `.ci`, and what is
    /// no text.
    pub fn read(root: &Path) -> io::Result<Self> {
        let mut tree = Self::default();
        tree.add(root, "")?;
        tree.texts.sort_by(|a, b| a.path.cmp(&b.path));
        let rust = tree.texts.iter().filter(|text| text.path.ends_with(".rs"));
        tree.sources = rust
            .map(|text| Source::new(&text.path, &text.text))
            .collect();
        Ok(tree)
    }

    fn add(&mut self, folder: &Path, prefix: &str) -> io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = format!("{prefix}{name}");
            let kind = entry.file_type()?;
            let hidden = name.starts_with('.') && ![".cargo", ".ci"].contains(&name.as_str());
            if kind.is_dir() {
                if !hidden && name != "target" {
                    self.add(&entry.path(), &format!("{path}/"))?;
                }
            } else if kind.is_file() && entry.metadata()?.len() <= LARGEST {
                // A file that another program removes in this moment is no violation.
                if let Ok(text) = fs::read_to_string(entry.path()) {
                    self.texts.push(Text { path, text });
                }
            }
        }
        Ok(())
    }

    /// What the file of this path says.
    pub fn text(&self, path: &str) -> Option<&str> {
        self.texts
            .iter()
            .find(|text| text.path == path)
            .map(|text| text.text.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::scratch::Scratch;

    #[test]
    fn build_products_and_hidden_folders_are_not_read() {
        let scratch = Scratch::new().unwrap();
        for path in [
            "a.md",
            "crates/x/src/lib.rs",
            "target/b.rs",
            ".git/c",
            ".ci/run",
            "crates/x/target/d",
        ] {
            scratch.write(path, "text").unwrap();
        }
        let tree = Tree::read(scratch.path()).unwrap();
        let paths: Vec<&str> = tree.texts.iter().map(|text| text.path.as_str()).collect();
        assert_eq!(paths, [".ci/run", "a.md", "crates/x/src/lib.rs"]);
        assert_eq!(tree.sources.len(), 1);
        assert_eq!(tree.text("a.md"), Some("text"));
    }
}
