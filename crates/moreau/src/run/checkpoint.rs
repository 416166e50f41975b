//! Checkpoints: states in files that are whole or known not to be, the last two of a directory; not what is in
//! them.
//!
//! A file is written beside its place, forced to the disk and renamed, so that a crash leaves the one before.

use super::RunError;
use super::files::beside;
use crate::simulation::{sealed, unsealed};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Checkpoints that are kept.
const KEPT: usize = 2;

/// Writes the checkpoint of an increment and removes the oldest.
pub(super) fn write(
    directory: &Path,
    increment: usize,
    deck: &str,
    numbers: &[f64],
) -> Result<(), RunError> {
    let path = directory.join(format!("increment-{increment:06}.ckpt"));
    let bytes = sealed(deck, numbers);
    let beside = beside(&path);
    let place = || {
        fs::create_dir_all(directory)?;
        let mut file = File::create(&beside)?;
        file.write_all(&bytes)?;
        file.sync_all()?;
        fs::rename(&beside, &path)?;
        // The name, too, where a directory can be synchronised.
        let _ = File::open(directory).and_then(|d| d.sync_all());
        for old in list(directory).iter().skip(KEPT) {
            // Another thread may have been there first.
            let _ = fs::remove_file(old);
        }
        Ok(())
    };
    place().map_err(|source| {
        // What there is of it only takes room.
        let _ = fs::remove_file(&beside);
        RunError::Write {
            path: path.clone(),
            source,
        }
    })
}

/// The checkpoints of a directory, newest first.
pub(super) fn list(directory: &Path) -> Vec<PathBuf> {
    let mut list = ours(directory);
    list.retain(|p| p.extension().is_some_and(|e| e == "ckpt"));
    // Numbers above six digits are longer.
    list.sort_by_key(|p| std::cmp::Reverse((p.as_os_str().len(), p.clone())));
    list
}

/// Files of a directory that [`write`] made or began.
fn ours(directory: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let ours = |e: &fs::DirEntry| e.file_name().to_string_lossy().starts_with("increment-");
    entries.filter(ours).map(|e| e.path()).collect()
}

/// Removes all checkpoints of a directory, and nothing else.
pub(super) fn clear(directory: &Path) -> Result<(), RunError> {
    for path in ours(directory) {
        fs::remove_file(&path).map_err(|source| RunError::Write { path, source })?;
    }
    Ok(())
}

/// The numbers of a checkpoint, or why it cannot be used.
pub(super) fn read(path: &Path, deck: &str) -> Result<Vec<f64>, String> {
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    unsealed(&bytes, deck)
}
