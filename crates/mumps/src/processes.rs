//! The processes that `mpirun` has started, or this one alone; not what they do together.

use crate::calls;
use crate::options::Options;
use crate::part::Part;
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// All processes of a run under MPI.
#[derive(Debug, Clone)]
pub struct Processes(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    rank: usize,
    size: usize,
    options: Options,
    /// What other processes than the first have of the engines, by their numbers.
    parts: Mutex<BTreeMap<usize, Part>>,
}

impl Processes {
    /// Begins MPI; `None` where it refuses.
    pub fn begin(options: Options) -> Option<Self> {
        let (rank, size) = calls::begin()?;
        Some(Self(Arc::new(Inner {
            rank,
            size,
            options,
            parts: Mutex::default(),
        })))
    }

    /// Ends MPI, when all processes come here; there is no team any more.
    pub fn end(self) {
        self.parts().clear();
        calls::end();
    }

    /// Ends all processes at once.
    pub fn abort(status: u8) {
        calls::abort(status);
    }

    /// Ends all processes where this one cannot do its part of what they do together: the others would wait for it.
    pub(crate) fn refuse(&self, what: &str) {
        let _ = writeln!(
            std::io::stderr(),
            "process {}: asked for {what}",
            self.0.rank
        );
        Self::abort(1);
    }

    pub(crate) fn number(&self) -> usize {
        self.0.rank
    }

    pub(crate) fn count(&self) -> usize {
        self.0.size
    }

    pub(crate) fn parts(&self) -> MutexGuard<'_, BTreeMap<usize, Part>> {
        self.0.parts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn options(&self) -> Options {
        self.0.options
    }

    /// Number of another engine, of whatever team: all are of the same processes.
    pub(crate) fn next() -> usize {
        static ENGINES: AtomicUsize = AtomicUsize::new(0);
        ENGINES.fetch_add(1, Ordering::Relaxed)
    }

    /// Processes on this computer.
    pub(crate) fn on_this_computer(&self) -> usize {
        let told = std::env::var("OMPI_COMM_WORLD_LOCAL_SIZE").ok();
        told.and_then(|n| n.parse().ok()).unwrap_or(1)
    }
}
