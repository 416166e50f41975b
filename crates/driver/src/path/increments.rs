//! How a step is divided into increments; not how one is solved.

/// Lengths of the increments of a step, in parts of it.
///
/// An increment that fails is halved, down to `min`; one that converges after that is doubled, up
/// to `start`. After two easy increments in a row the next is half as long again, up to `max`.
/// Equal increments are `start = max`; their ends are whole multiples of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Increments {
    /// Length of the first.
    pub start: f64,
    /// Least length; none: `start` halved as often as the settings allow.
    pub min: Option<f64>,
    /// Greatest length.
    pub max: f64,
}

impl Increments {
    /// Newton iterations up to which an increment is easy.
    pub const EASY: usize = 6;

    /// Equal increments, at least one.
    pub fn equal(count: usize) -> Self {
        let start = 1.0 / count.max(1) as f64;
        Self {
            start,
            min: None,
            max: start,
        }
    }

    /// Number of increments, if all converge at the first length.
    pub fn count(&self) -> usize {
        (1.0 / self.start - 1e-9).ceil().clamp(1.0, 1e9) as usize
    }

    /// Number of equal pieces whose ends are met: that of the increments, if these do not grow.
    pub(crate) fn pieces(&self) -> usize {
        if self.max > self.start {
            1
        } else {
            self.count()
        }
    }

    /// The length after an increment that converged; `easy` counts the easy ones in a row.
    pub(crate) fn next(&self, length: f64, easy: &mut usize, iterations: usize) -> f64 {
        *easy = if iterations <= Self::EASY {
            *easy + 1
        } else {
            0
        };
        if length < self.start {
            return (2.0 * length).min(self.start);
        }
        if *easy < 2 {
            return length;
        }
        *easy = 0;
        (1.5 * length).min(self.max)
    }
}

impl From<usize> for Increments {
    fn from(count: usize) -> Self {
        Self::equal(count)
    }
}
