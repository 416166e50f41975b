//! Charts of series over two axes: what to draw and whether it can be drawn; how it is drawn is
//! settled in `figure`.

use super::PlotError;
use super::axis::{Axis, ChartAxis, Scale};
use super::clip::clip;
use super::figure::{Curve, draw};
use super::look::Style;

/// A line, markers, or both, in a chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend; without one the series is not in the legend.
    pub name: String,
    /// Points (x, y). One that cannot be drawn (not finite, or not positive along a logarithmic
    /// axis) is left out and interrupts the line.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub style: Style,
}

/// A chart of series over two axes.
///
/// Series are told apart by colour and, for print without colours, by dashes and the shape of
/// markers. The legend stands beside the data or below them, never on them.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Title; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub x: ChartAxis,
    /// The vertical axis.
    pub y: ChartAxis,
    /// The series, drawn in this order.
    pub series: Vec<Series>,
}

impl Chart {
    /// A chart without series, linear along both axes.
    pub fn new(
        title: impl Into<String>,
        x_label: impl Into<String>,
        y_label: impl Into<String>,
    ) -> Self {
        let axis = |label| ChartAxis {
            label,
            scale: Scale::Linear,
            range: None,
        };
        Self {
            title: title.into(),
            x: axis(x_label.into()),
            y: axis(y_label.into()),
            series: Vec::new(),
        }
    }

    /// With a logarithmic horizontal axis.
    pub fn log_x(mut self) -> Self {
        self.x.scale = Scale::Logarithmic;
        self
    }

    /// With a logarithmic vertical axis.
    pub fn log_y(mut self) -> Self {
        self.y.scale = Scale::Logarithmic;
        self
    }

    /// With a horizontal axis from `low` to `high`.
    pub fn x_range(mut self, low: f64, high: f64) -> Self {
        self.x.range = Some([low, high]);
        self
    }

    /// With a vertical axis from `low` to `high`.
    pub fn y_range(mut self, low: f64, high: f64) -> Self {
        self.y.range = Some([low, high]);
        self
    }

    /// With a further series.
    pub fn with(
        mut self,
        name: impl Into<String>,
        style: Style,
        points: impl Into<Vec<[f64; 2]>>,
    ) -> Self {
        self.series.push(Series {
            name: name.into(),
            points: points.into(),
            style,
        });
        self
    }

    /// The chart as a standalone SVG document, 760 wide and 480 high, or higher for a legend below.
    ///
    /// # Errors
    ///
    /// [`PlotError::NoPoints`] if no series has a point that can be drawn; [`PlotError::Range`] for
    /// an axis with impossible ends.
    pub fn to_svg(&self) -> Result<String, PlotError> {
        let drawable: Vec<[f64; 2]> = self
            .series
            .iter()
            .flat_map(|series| &series.points)
            .copied()
            .filter(|&[x, y]| self.x.scale.admits(x) && self.y.scale.admits(y))
            .collect();
        if drawable.is_empty() {
            return Err(PlotError::NoPoints {
                title: self.title.clone(),
            });
        }
        let x = Axis::new(&self.x, drawable.iter().map(|p| p[0]), 8.0, 0.0)?;
        let y = Axis::new(&self.y, drawable.iter().map(|p| p[1]), 6.0, 0.02)?;
        let curves = self
            .series
            .iter()
            .map(|series| {
                let unit: Vec<Option<[f64; 2]>> = series
                    .points
                    .iter()
                    .map(|p| Some([x.position(p[0])?, y.position(p[1])?]))
                    .collect();
                Curve {
                    name: &series.name,
                    style: series.style,
                    lines: unit
                        .split(Option::is_none)
                        .map(|piece| piece.iter().flatten().copied().collect::<Vec<_>>())
                        .flat_map(|piece| clip(&piece, [-ROUNDING; 2], [1.0 + ROUNDING; 2]))
                        .collect(),
                    points: unit
                        .into_iter()
                        .flatten()
                        .filter(|p| p.iter().all(|t| (-ROUNDING..=1.0 + ROUNDING).contains(t)))
                        .collect(),
                }
            })
            .collect::<Vec<_>>();
        Ok(draw(&self.title, &x, &y, &curves))
    }
}

/// How far beyond the ends of an axis, in parts of it, a point still lies on them.
const ROUNDING: f64 = 1e-9;

impl Scale {
    /// Whether a value has a place on an axis of this scale.
    pub(super) fn admits(self, value: f64) -> bool {
        value.is_finite() && (self == Self::Linear || value > 0.0)
    }
}
