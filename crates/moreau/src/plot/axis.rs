//! An axis with its ends settled: where values lie on it and how its ticks are labelled; not the
//! lines and the text.

use super::PlotError;
use super::number::{Number, nice_step, power};

/// Least ratio of the length of a linear axis to the size of its values: below, ticks would not be
/// distinct numbers.
const NARROW: f64 = 1e-12;

/// Most decades of a logarithmic axis: values on it are finite numbers whatever its unit.
const DECADES: f64 = 300.0;

/// Scale of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Equal distances are equal differences.
    #[default]
    Linear,
    /// Equal distances are equal ratios.
    Logarithmic,
}

/// An axis of a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartAxis {
    /// Label, with the unit.
    pub label: String,
    /// Scale.
    pub scale: Scale,
    /// Ends, lower first; what lies outside is cut off. `None`: around the data.
    pub range: Option<[f64; 2]>,
}

/// An axis between two ends.
#[derive(Debug, Clone)]
pub(super) struct Axis {
    pub(super) label: String,
    pub(super) scale: Scale,
    /// Ends, lower first; of the decimal logarithm if the scale is logarithmic.
    pub(super) ends: [f64; 2],
    /// Distance of the ticks of a linear axis.
    pub(super) step: f64,
    number: Number,
}

impl Axis {
    /// The axis around admissible values (at least one), with about so many ticks and a part of
    /// its length left free at either end, except at zero.
    pub(super) fn new(
        axis: &ChartAxis,
        values: impl Iterator<Item = f64> + Clone,
        ticks: f64,
        padding: f64,
    ) -> Result<Self, PlotError> {
        let ends = match axis.range {
            Some(range) => {
                let admitted = range.iter().all(|&v| axis.scale.admits(v));
                if !admitted || range[0] >= range[1] {
                    return Err(PlotError::Range {
                        label: axis.label.clone(),
                        range,
                    });
                }
                match axis.scale {
                    Scale::Linear => range,
                    Scale::Logarithmic => range.map(f64::log10),
                }
            }
            None => {
                let [low, high] = values
                    .clone()
                    .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| {
                        [l.min(v), h.max(v)]
                    });
                match axis.scale {
                    Scale::Linear => around([low, high], ticks, padding),
                    Scale::Logarithmic => around_log([low.log10(), high.log10()]),
                }
            }
        };
        let span = ends[1] - ends[0];
        let size = ends[0].abs().max(ends[1].abs());
        let longest = if axis.scale == Scale::Linear {
            f64::INFINITY
        } else {
            DECADES
        };
        if !span.is_finite() || span <= NARROW * size || span > longest {
            return Err(PlotError::Range {
                label: axis.label.clone(),
                range: match axis.scale {
                    Scale::Linear => ends,
                    Scale::Logarithmic => ends.map(|v| 10f64.powf(v)),
                },
            });
        }
        // Numbers of things have no halves.
        let whole = values.clone().all(|v| v.fract() == 0.0) && (2.0..1e5).contains(&span);
        let step = nice_step(span, ticks).max(if whole { 1.0 } else { 0.0 });
        let number = Number::new(size, step);
        Ok(Self {
            label: axis.label.clone(),
            scale: axis.scale,
            ends,
            step,
            number,
        })
    }

    /// Part of the axis below a value, in [0, 1] between the ends; `None` if it has no place.
    pub(super) fn position(&self, value: f64) -> Option<f64> {
        let v = match self.scale {
            _ if !self.scale.admits(value) => return None,
            Scale::Linear => value,
            Scale::Logarithmic => value.log10(),
        };
        let t = (v - self.ends[0]) / (self.ends[1] - self.ends[0]);
        t.is_finite().then_some(t)
    }

    /// Decades of a logarithmic axis.
    fn decades(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }

    /// Ticks as parts of the axis with their labels: at multiples of the step, or at powers of ten and, if
    /// these are few, at 2 and 5 times them.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.ends;
        let slack = 1e-9 * (high - low);
        let candidates: Vec<f64> = match self.scale {
            Scale::Linear => {
                let first = ((low - slack) / self.step).ceil();
                let count = ((high + slack) / self.step).floor() - first;
                (0..=count as usize)
                    .map(|k| (first + k as f64) * self.step)
                    .collect()
            }
            Scale::Logarithmic => {
                let powers = low.floor() as i32..=high.ceil() as i32;
                let marks = |n| [1.0f64, 2.0, 5.0].map(|m| f64::from(n) + m.log10());
                powers.flat_map(marks).collect()
            }
        };
        let within = candidates
            .into_iter()
            .filter(|&v| v >= low - slack && v <= high + slack);
        within
            .map(|v| ((v - low) / (high - low), self.tick(v)))
            .filter(|(_, label)| !label.is_empty())
            .collect()
    }

    /// Parts of a logarithmic axis at 2, 3, … 9 times a power of ten.
    pub(super) fn minor(&self) -> Vec<f64> {
        if self.scale == Scale::Linear || self.decades() > 12.0 {
            return Vec::new();
        }
        let powers = self.ends[0].floor() as i32..=self.ends[1].ceil() as i32;
        powers
            .flat_map(|n| (2..10).map(move |m| f64::from(n) + f64::from(m).log10()))
            .map(|v| (v - self.ends[0]) / self.decades())
            .filter(|t| (0.0..=1.0).contains(t))
            .collect()
    }

    /// Label of a tick, at the value or at its decimal logarithm; empty if it should have none.
    fn tick(&self, at: f64) -> String {
        if self.scale == Scale::Linear {
            // Rounding leaves a multiple of the step near zero where zero is meant.
            return self
                .number
                .text(if at.abs() < 1e-6 * self.step { 0.0 } else { at });
        }
        let powers = (self.ends[1] + 1e-9).floor() - (self.ends[0] - 1e-9).ceil() + 1.0;
        let plain = self.ends[0] > -3.001 && self.ends[1] < 4.7;
        if powers < 2.0 || (self.decades() < 2.01 && plain) {
            let value = 10f64.powf(at);
            return if plain {
                format!("{}", round(value))
            } else {
                power(at)
            };
        }
        let stride = (self.decades() / 10.0).ceil().max(1.0);
        let whole = (at - at.round()).abs() < 1e-6 && at.round() % stride == 0.0;
        if whole { power(at) } else { String::new() }
    }
}

/// Rounds to three significant digits.
fn round(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Ends on multiples of the step of the ticks, around values from `low` to `high`.
fn around([mut low, mut high]: [f64; 2], ticks: f64, padding: f64) -> [f64; 2] {
    let size = low.abs().max(high.abs());
    if high - low <= NARROW * 10.0 * size {
        let margin = if size > 0.0 { 0.1 * size } else { 1.0 };
        (low, high) = (low - margin, high + margin);
    } else {
        let margin = padding * (high - low);
        low -= if low == 0.0 { 0.0 } else { margin };
        high += if high == 0.0 { 0.0 } else { margin };
    }
    let step = nice_step(high - low, ticks);
    [
        (low / step + 1e-9).floor() * step,
        (high / step - 1e-9).ceil() * step,
    ]
}

/// Ends on powers of ten, or for a short axis on 1, 2 or 5 times one, around logarithms from `low`
/// to `high`.
fn around_log([low, high]: [f64; 2]) -> [f64; 2] {
    let marks: &[f64] = if high - low > 2.5 {
        &[0.0]
    } else {
        &[0.0, 2f64.log10(), 5f64.log10()]
    };
    let below = |v: f64| {
        let floor = (v + 1e-9).floor();
        let mark = marks.iter().rev().find(|&&m| floor + m <= v + 1e-9);
        floor + mark.copied().unwrap_or(0.0)
    };
    let above = |v: f64| {
        let floor = (v - 1e-9).floor();
        let mark = marks.iter().find(|&&m| floor + m >= v - 1e-9);
        floor + mark.copied().unwrap_or(1.0)
    };
    if high - low < 1e-6 {
        return [below(low - 0.3), above(high + 0.3)];
    }
    [below(low), above(high)]
}
