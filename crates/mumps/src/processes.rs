//! The processes that `mpirun` has started, or this one alone, as a team; not its engine.

use crate::calls;
use crate::engine::{self, Mumps, Part};
use moreau_algebra::{ENGINE, Engine, Pattern, Share, Team, TooLarge};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// How MUMPS factorises, beyond what it decides itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Options {
    /// Error that blocks of low rank may leave of those that they stand for; `None` without them.
    pub low_rank: Option<f64>,
    /// Whether unknowns are eliminated in the order in which they are given, which is of nested dissection, and not
    /// in that of METIS.
    pub as_given: bool,
    /// Part by which working space is larger than was estimated, in percent; `None` as MUMPS has it.
    pub spare: Option<i32>,
}

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
        let mut parts = self.0.parts.lock().unwrap_or_else(PoisonError::into_inner);
        parts.clear();
        calls::end();
    }

    /// Ends all processes at once.
    pub fn abort(status: u8) {
        calls::abort(status);
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

impl Team for Processes {
    fn rank(&self) -> usize {
        self.0.rank
    }

    fn size(&self) -> usize {
        self.0.size
    }

    fn send(&self, to: usize, bytes: &[u8]) {
        calls::send(to, bytes);
    }

    fn receive(&self, from: usize) -> Vec<u8> {
        calls::receive(from)
    }

    fn engine(
        &self,
        pattern: &Pattern,
        memory: Option<u64>,
        is_definite: bool,
    ) -> Result<Box<dyn Engine>, TooLarge> {
        Ok(Box::new(Mumps::new(self, pattern, memory, is_definite)?))
    }

    fn assist(&self, order: &[u8], share: Share<'_>) {
        let mut parts = self.0.parts.lock().unwrap_or_else(PoisonError::into_inner);
        engine::assist(self, &mut parts, order, share);
    }
}

/// What another process than the first does where there is nothing but engines: until the first says that it is the
/// end, by an order of no bytes.
pub fn serve(team: &Processes) {
    loop {
        let order = team.receive(0);
        match order.first() {
            Some(&ENGINE) => team.assist(&order, Share::NONE),
            _ => return,
        }
    }
}
