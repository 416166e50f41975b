//! Writes files whole or not at all, and removes those of earlier runs; not what is in them.

use std::collections::BTreeSet;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file or folder that could not be written, and why.
#[derive(Debug)]
pub struct FileError {
    path: PathBuf,
    source: io::Error,
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write {}: {}", self.path.display(), self.source)
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Names the path in an error of the file system.
fn at(path: &Path) -> impl FnOnce(io::Error) -> FileError {
    let path = path.to_path_buf();
    move |source| FileError { path, source }
}

/// Makes sure that the folder exists and can be written to.
pub fn prepare(folder: &Path) -> Result<(), FileError> {
    fs::create_dir_all(folder).map_err(at(folder))?;
    let probe = folder.join(".writable.part");
    fs::write(&probe, "")
        .and_then(|()| fs::remove_file(&probe))
        .map_err(at(folder))
}

/// Writes a file under a temporary name in the same folder, then renames it.
pub fn write(path: &Path, text: &str) -> Result<(), FileError> {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let temporary = path.with_file_name(name);
    let written = File::create(&temporary).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.sync_all()
    });
    written
        .and_then(|()| fs::rename(&temporary, path))
        .map_err(at(path))
}

/// A folder of files of one kind that all come from one run.
pub struct Folder {
    path: PathBuf,
    extension: &'static str,
    written: BTreeSet<String>,
}

impl Folder {
    /// Creates the folder if need be.
    pub fn open(parent: &Path, name: &str, extension: &'static str) -> Result<Self, FileError> {
        let path = parent.join(name);
        fs::create_dir_all(&path).map_err(at(&path))?;
        Ok(Self {
            path,
            extension,
            written: BTreeSet::new(),
        })
    }

    /// Writes a file named after its stem, or after case and stem if another case was there first.
    pub fn write(&mut self, stem: &str, case: &str, text: &str) -> Result<(), FileError> {
        let numbered = (2..).map(|n| format!("{case}-{stem}-{n}"));
        let name = [stem.to_owned(), format!("{case}-{stem}")]
            .into_iter()
            .chain(numbered)
            .map(|stem| format!("{}.{}", file_name(&stem), self.extension))
            .find(|name| !self.written.contains(name))
            .unwrap_or_default();
        write(&self.path.join(&name), text)?;
        self.written.insert(name);
        Ok(())
    }

    /// Removes the files of this kind that were not written, and the rests of a run that crashed.
    pub fn prune(&self) -> Result<(), FileError> {
        for entry in fs::read_dir(&self.path).map_err(at(&self.path))? {
            let path = entry.map_err(at(&self.path))?.path();
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let ours = name.ends_with(&format!(".{}", self.extension)) || name.ends_with(".part");
            if ours && path.is_file() && !self.written.contains(&name) {
                fs::remove_file(&path).map_err(at(&path))?;
            }
        }
        Ok(())
    }
}

/// A stem without characters that mean something to a file system.
pub fn file_name(stem: &str) -> String {
    let safe = |c: char| {
        if c.is_alphanumeric() || "-_.+=".contains(c) {
            c
        } else {
            '-'
        }
    };
    stem.chars()
        .map(safe)
        .collect::<String>()
        .trim_start_matches('.')
        .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use verification::scratch::Scratch;

    #[test]
    fn a_file_is_replaced_and_leaves_nothing_behind() {
        let scratch = Scratch::new().unwrap();
        let path = scratch.path().join("a.txt");
        write(&path, "one").unwrap();
        write(&path, "two").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        assert_eq!(fs::read_dir(scratch.path()).unwrap().count(), 1);
    }

    #[test]
    fn an_error_names_the_path() {
        let scratch = Scratch::new().unwrap();
        scratch.write("file", "").unwrap();
        let error = prepare(&scratch.path().join("file"))
            .unwrap_err()
            .to_string();
        assert!(error.contains("file"), "{error}");
    }

    #[test]
    fn cases_that_chose_the_same_name_do_not_overwrite_each_other() {
        let scratch = Scratch::new().unwrap();
        let mut folder = Folder::open(scratch.path(), "tables", "csv").unwrap();
        for (case, text) in [("one", "1"), ("two", "2"), ("two", "3")] {
            folder.write("curve", case, text).unwrap();
        }
        let read = |name: &str| fs::read_to_string(scratch.path().join("tables").join(name));
        assert_eq!(read("curve.csv").unwrap(), "1");
        assert_eq!(read("two-curve.csv").unwrap(), "2");
        assert_eq!(read("two-curve-2.csv").unwrap(), "3");
    }

    #[test]
    fn names_stay_inside_the_folder() {
        assert_eq!(file_name("../mesh 8x8/σ"), "-mesh-8x8-σ");
    }

    #[test]
    fn what_this_run_did_not_write_is_removed() {
        let scratch = Scratch::new().unwrap();
        scratch.write("figures/old.svg", "").unwrap();
        scratch.write("figures/half.svg.part", "").unwrap();
        scratch.write("figures/readme.txt", "").unwrap();
        let mut folder = Folder::open(scratch.path(), "figures", "svg").unwrap();
        folder.write("new", "case", "").unwrap();
        folder.prune().unwrap();
        let exists = |name: &str| scratch.path().join("figures").join(name).exists();
        assert!(exists("new.svg") && exists("readme.txt"));
        assert!(!exists("old.svg") && !exists("half.svg.part"));
    }
}
