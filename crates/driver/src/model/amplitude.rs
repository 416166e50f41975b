//! How a value of a step varies over its time.

use crate::error::ModelError;
use std::cmp::Ordering;

/// The share of a value that acts over the time of a step: linear between rows of time and share, of which the first
/// is at time 0 and the last at time 1.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Amplitude {
    rows: Vec<[f64; 2]>,
}

impl Amplitude {
    /// From its rows, which [`Amplitude::check`] looks at.
    pub(crate) fn new(rows: &[[f64; 2]]) -> Self {
        Self {
            rows: rows.to_vec(),
        }
    }

    /// The share at a time in [0, 1].
    pub(crate) fn at(&self, time: f64) -> f64 {
        let next = self.rows.iter().position(|row| time <= row[0]);
        match next {
            None => self.rows.last().map_or(1.0, |row| row[1]),
            Some(0) => self.rows[0][1],
            Some(k) => {
                let ([t0, a], [t1, b]) = (self.rows[k - 1], self.rows[k]);
                a + (b - a) * ((time - t0) / (t1 - t0))
            }
        }
    }

    /// How far it is off the straight way between its ends at a time.
    pub(crate) fn bend(&self, time: f64) -> f64 {
        let [start, end] = [0.0, 1.0].map(|end| self.at(end));
        self.at(time) - (start + (end - start) * time)
    }

    /// Times strictly within the step at which it has a row.
    pub(crate) fn breaks(&self) -> impl Iterator<Item = f64> {
        let times = self.rows.iter().map(|row| row[0]);
        times.filter(|time| 0.0 < *time && *time < 1.0)
    }

    /// Whether its times rise from 0 to 1 and its shares are numbers.
    ///
    /// # Errors
    /// The step by its name and the first time that does not belong.
    pub(crate) fn check(&self, step: &str) -> Result<(), ModelError> {
        let wrong = |value: f64| ModelError::OutOfRange {
            what: format!("amplitude in step {step:?}"),
            value,
            expected: "times that rise from 0 to 1, and shares that are finite",
        };
        let [first, .., last] = self.rows.as_slice() else {
            return Err(wrong(f64::NAN));
        };
        let ends = [(first[0], 0.0), (last[0], 1.0)];
        let shares = self.rows.iter().map(|row| row[1]);
        let falls = self
            .rows
            .windows(2)
            .find(|pair| pair[0][0].partial_cmp(&pair[1][0]) != Some(Ordering::Less));
        let odd = ends.into_iter().find(|(time, end)| time != end);
        let odd = odd.map(|(time, _)| time);
        let odd = odd.or(falls.map(|pair| pair[1][0]));
        match odd.or(shares.into_iter().find(|share| !share.is_finite())) {
            Some(value) => Err(wrong(value)),
            None => Ok(()),
        }
    }
}
