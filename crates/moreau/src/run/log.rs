//! `log.jsonl`: a line for each iteration; and the last iterations, for a diagnosis.

use crate::driver::{Driver, Iteration};
use crate::laws::Status;
use std::collections::VecDeque;
use std::time::Instant;

/// Iterations whose statuses are remembered.
const REMEMBERED: usize = 5;

/// What an attempt has come to.
pub(super) struct Trace {
    started: Instant,
    /// Number of the increment that was attempted.
    increment: usize,
    /// Displacement increments of the last iterate.
    pub(super) d_u: Vec<f64>,
    /// Force that nothing balances in it.
    pub(super) residual: Vec<f64>,
    /// Statuses in the last iterations of the attempt, oldest first.
    pub(super) statuses: VecDeque<Vec<Status>>,
}

impl Trace {
    pub(super) fn new() -> Self {
        Self {
            started: Instant::now(),
            increment: 0,
            d_u: Vec::new(),
            residual: Vec::new(),
            statuses: VecDeque::new(),
        }
    }

    /// Remembers an iteration, and tells it as a line of JSON.
    pub(super) fn note(&mut self, step: &str, i: &Iteration<'_>) -> String {
        self.increment = i.increment;
        self.d_u.clear();
        self.d_u.extend_from_slice(i.d_u);
        self.residual.clear();
        self.residual.extend_from_slice(i.residual);
        if i.newton == 0 {
            self.statuses.clear();
        }
        if !i.status.is_empty() {
            let mut oldest = match self.statuses.len() < REMEMBERED {
                true => Vec::new(),
                false => self.statuses.pop_front().unwrap_or_default(),
            };
            oldest.clear();
            oldest.extend_from_slice(i.status);
            self.statuses.push_back(oldest);
        }
        serde_json::json!({
            "step": step,
            "increment": i.increment,
            "cut": i.cuts,
            "iteration": i.newton,
            "residual": i.out_of_balance,
            "relative_residual": i.out_of_balance / i.scale,
            "contact_iterations": i.contact_iterations,
            "seconds": self.started.elapsed().as_secs_f64(),
        })
        .to_string()
    }

    /// Whether it is of the increment after those that converged: an attempt may fail before it has
    /// an iterate to tell of.
    pub(super) fn is_of_next<const D: usize>(&self, driver: &Driver<D>) -> bool {
        self.increment == driver.increments() + 1
    }

    /// Displacement of the last iterate, at every degree of freedom.
    pub(super) fn displacement<const D: usize>(&self, driver: &Driver<D>) -> Vec<f64> {
        let nodes = 0..driver.mesh().nodes().len();
        let committed = nodes.flat_map(|n| -> [f64; D] { driver.displacement(n).into() });
        committed.zip(&self.d_u).map(|(u, d)| u + d).collect()
    }
}
