//! A converged state apart from the run that made it, so that any thread can write it while the run
//! is busy with the next increment.

use super::files::{replace_file, sync};
use super::{CHECKPOINTS, RUN, RunError, checkpoint};
use std::path::{Path, PathBuf};

/// All that it takes to go on from a converged increment.
#[derive(Debug, Clone)]
pub struct Resumable {
    pub(super) directory: PathBuf,
    /// The files that the numbers tell how much of is valid.
    pub(super) streams: Vec<PathBuf>,
    pub(super) increment: usize,
    pub(super) resolved: String,
    pub(super) numbers: Vec<f64>,
    /// `run.json` of a run that was interrupted here; none is written where it is empty.
    pub(super) summary: String,
}

impl Resumable {
    /// Increments that have converged.
    pub fn increment(&self) -> usize {
        self.increment
    }

    /// The directory of the results.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// Writes a checkpoint of it, and a `run.json` that tells of a run interrupted there. The files
    /// of the run stay as they are: a resumed run cuts them back.
    ///
    /// # Errors
    /// [`RunError::Write`].
    pub fn write(&self) -> Result<(), RunError> {
        self.streams.iter().try_for_each(|path| sync(path))?;
        let directory = self.directory.join(CHECKPOINTS);
        checkpoint::write(&directory, self.increment, &self.resolved, &self.numbers)?;
        match self.summary.as_str() {
            "" => Ok(()),
            json => replace_file(&self.directory.join(RUN), json.as_bytes()),
        }
    }
}
