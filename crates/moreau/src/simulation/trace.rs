//! The last iterations of an attempt, for a diagnosis; not what is written of them.

use crate::driver::{Driver, Iteration};
use crate::laws::Status;
use std::collections::VecDeque;

/// Iterations whose statuses are remembered.
const REMEMBERED: usize = 5;

/// What an attempt has come to.
#[derive(Debug)]
pub(super) struct Trace {
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
            increment: 0,
            d_u: Vec::new(),
            residual: Vec::new(),
            statuses: VecDeque::new(),
        }
    }

    /// Remembers an iteration.
    pub(super) fn note(&mut self, i: &Iteration<'_>) {
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
    }

    /// Whether it is of the increment after those that converged: an attempt may fail before it has
    /// an iterate to tell of.
    pub(super) fn is_of_next<const D: usize>(&self, driver: &Driver<D>) -> bool {
        self.increment == driver.increments() + 1
    }

    /// Displacement of the last iterate, at every degree of freedom.
    pub(super) fn displacement<const D: usize>(&self, driver: &Driver<D>) -> Vec<f64> {
        let committed = driver.displacements().iter();
        committed.zip(&self.d_u).map(|(u, d)| u + d).collect()
    }
}
