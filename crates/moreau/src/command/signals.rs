//! Signals that end a run: the increment under way is given a moment, then what had converged before
//! it is written in its place.

use super::{NOT_CONVERGED, tell};
use crate::run::Resumable;
use signal_hook::{consts, flag};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// How long an increment may take to end by itself once that is asked for.
const GRACE: Duration = Duration::from_millis(500);
/// Signals that come within are one, as those that are sent to a process and to its group.
const TOGETHER: Duration = Duration::from_millis(200);
/// Between two looks at whether it is.
const LOOK: Duration = Duration::from_millis(20);

/// Whether a run is to end, and what it leaves if it does not end in time.
#[derive(Clone)]
pub(super) struct Signals {
    raised: Arc<AtomicBool>,
    /// Whether another signal ends the process.
    once_more: Arc<AtomicBool>,
    last: Arc<Mutex<Option<Resumable>>>,
}

impl Signals {
    /// Listens for Ctrl-C, and for what ends a process politely: the first ends the run, the second the
    /// process.
    pub(super) fn listen() -> Self {
        let signals = Self {
            raised: Arc::default(),
            once_more: Arc::default(),
            last: Arc::default(),
        };
        for signal in ending() {
            // Without, it ends the process, and checkpoints are there all the same.
            let status = i32::from(NOT_CONVERGED);
            let _ = flag::register_conditional_shutdown(signal, status, signals.once_more.clone());
            let _ = flag::register(signal, signals.raised.clone());
        }
        let watched = signals.clone();
        // Without, a run ends after its increment.
        let _ = std::thread::Builder::new().spawn(move || watched.wait());
        signals
    }

    /// Whether the run is to end.
    pub(super) fn raised(&self) -> bool {
        self.raised.load(Ordering::SeqCst)
    }

    /// Keeps what is written if the next increment is cut off.
    pub(super) fn keep(&self, state: Resumable) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = Some(state);
    }

    fn wait(&self) {
        while !self.raised() {
            std::thread::sleep(LOOK);
        }
        tell!("stopping; once more to stop now");
        std::thread::sleep(TOGETHER);
        self.once_more.store(true, Ordering::SeqCst);
        std::thread::sleep(GRACE - TOGETHER);
        // Not released again: the run that comes for it waits for the end.
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        match last.as_ref().map(|state| (state, state.write())) {
            None => tell!("interrupted before the first increment"),
            Some((_, Err(error))) => tell!("{error}"),
            Some((state, Ok(()))) => {
                tell!("{}", interrupted(state.increment(), state.directory()));
            }
        }
        std::process::exit(i32::from(NOT_CONVERGED));
    }
}

/// What is said of a run that was ended.
pub(super) fn interrupted(increment: usize, directory: &std::path::Path) -> String {
    let place = directory.display();
    format!("interrupted after increment {increment}; to go on: moreau resume \"{place}\"")
}

/// A file that has grown to the limit of the system is an error of writing, not the end of the process.
pub(super) fn survive_limits() {
    #[cfg(unix)]
    let _ = flag::register(consts::SIGXFSZ, Arc::default());
}

/// The signals that end a run. A terminal that closes does not end what was started to survive it.
fn ending() -> Vec<i32> {
    let mut list = vec![consts::SIGINT, consts::SIGTERM];
    #[cfg(unix)]
    if !is_ignored(consts::SIGHUP) {
        list.push(consts::SIGHUP);
    }
    list
}

/// Whether a signal was to be ignored when the process was started, as `nohup` does.
#[cfg(unix)]
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok());
    mask.is_some_and(|m| m >> (signal - 1) & 1 == 1)
}
