//! How an iteration went so far, and what its next step may do; not the step.

/// Iterates of which the worst bounds the merit of the next.
const MEMORY: usize = 6;

/// How far below the worst of them it has to be.
const CLEARLY: f64 = 0.7;

/// Iterations without progress after which a residual may be rounding.
const STALLED: usize = 3;

/// How the iteration went so far.
pub(super) struct Progress {
    merits: Vec<f64>,
    least: f64,
    /// Iterations since the residual was last halved.
    stalled: usize,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            merits: Vec::new(),
            least: f64::INFINITY,
            stalled: 0,
        }
    }
}

impl Progress {
    /// Takes note of a residual; whether the last ones were no smaller.
    pub(super) fn stalls(&mut self, residual: f64) -> bool {
        self.stalled = match residual < 0.5 * self.least {
            true => 0,
            false => self.stalled + 1,
        };
        self.least = self.least.min(residual);
        self.stalled >= STALLED
    }

    /// Takes note of a merit; what that of the next iterate may be.
    pub(super) fn allowed(&mut self, merit: f64) -> f64 {
        self.merits.push(merit);
        let recent = &self.merits[self.merits.len().saturating_sub(MEMORY)..];
        let worst = recent.iter().copied().fold(0.0, f64::max);
        merit.max(CLEARLY * worst)
    }

    /// Merits and residuals of another α are no measure.
    pub(super) fn forget(&mut self) {
        *self = Self::default();
    }
}
