//! Where the time of a run goes; no part of a result.

use std::ops::AddAssign;
use std::time::Duration;
#[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
use std::time::Instant;

/// Time spent since the driver was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Timings {
    /// Internal forces and stiffness: the laws, the elements and their scatter.
    pub assembly: Duration,
    /// Numbering, pattern and symbolic factorisation.
    pub ordering: Duration,
    /// Numeric factorisations of the stiffness.
    pub factorisation: Duration,
    /// Condensation on the interface and the contact problem.
    pub contact: Duration,
    /// Triangular solves with the factor.
    pub solution: Duration,
}

impl Timings {
    /// All of the above.
    pub fn sum(&self) -> Duration {
        self.assembly + self.ordering + self.factorisation + self.contact + self.solution
    }
}

impl AddAssign for Timings {
    fn add_assign(&mut self, other: Self) {
        self.assembly += other.assembly;
        self.ordering += other.ordering;
        self.factorisation += other.factorisation;
        self.contact += other.contact;
        self.solution += other.solution;
    }
}

/// A clock that has run since it was started. WebAssembly on its own knows no time: no time passes there.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    started: Instant,
}

impl Clock {
    /// Starts it.
    pub fn start() -> Self {
        Self {
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            started: Instant::now(),
        }
    }

    /// Time since it was started.
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    pub fn elapsed(&self) -> Duration {
        self.started.elapsed()
    }

    /// Time since it was started: none that is known.
    #[cfg(all(target_family = "wasm", target_os = "unknown"))]
    pub fn elapsed(&self) -> Duration {
        Duration::ZERO
    }
}

/// Adds the time that `work` takes to `total`.
pub(crate) fn timed<T>(total: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Clock::start();
    let result = work();
    *total += start.elapsed();
    result
}
