//! How a step is divided into increments; not how one is solved.

use crate::error::ModelError;

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

    /// Whether the lengths are parts of a step, that of the first between the others.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] of the first that is not.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        let Self { start, min, max } = *self;
        let least = min.unwrap_or(start);
        let wrong = |what: &str, value: f64, expected: &'static str| {
            let what = what.into();
            Err(ModelError::OutOfRange {
                what,
                value,
                expected,
            })
        };
        if !(start > 0.0 && start.is_finite()) {
            return wrong(
                "length of the first increment",
                start,
                "a positive part of the step",
            );
        }
        if !(least > 0.0 && least <= start) {
            return wrong(
                "least length of an increment",
                least,
                "a positive one, at most that of the first",
            );
        }
        if max.is_nan() || max < start {
            return wrong(
                "greatest length of an increment",
                max,
                "at least that of the first",
            );
        }
        Ok(())
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Of other lengths a step would never end, or be over before it has begun.
    #[test]
    fn lengths_are_parts_of_a_step() {
        for count in [0, 1, 7] {
            assert_eq!(Increments::equal(count).check(), Ok(()));
        }
        let of = |start, min, max| Increments { start, min, max }.check();
        assert_eq!(of(0.1, Some(0.1), 1.0), Ok(()));
        for (start, min, max) in [
            (0.0, None, 1.0),
            (-1.0, None, 1.0),
            (f64::NAN, None, 1.0),
            (f64::INFINITY, None, f64::INFINITY),
            (0.5, Some(0.0), 1.0),
            (0.5, Some(0.6), 1.0),
            (0.5, Some(f64::NAN), 1.0),
            (0.5, None, 0.1),
            (0.5, None, f64::NAN),
        ] {
            let refused = matches!(of(start, min, max), Err(ModelError::OutOfRange { .. }));
            assert!(refused, "{start}, {min:?}, {max}");
        }
    }
}
