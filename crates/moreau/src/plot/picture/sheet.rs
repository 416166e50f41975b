//! The sheet that a picture is drawn on: its size, what stands beside the drawing, and the places
//! of nodes; not the cells.

use super::Field;
use super::flat::Flat;
use crate::plot::clip::clip;
use crate::plot::colour::{INK, LEVELS, colour};
use crate::plot::error::PlotError;
use crate::plot::number::{Number, nice_step};
use crate::plot::pen::{FINE, Pen, number, write_text};
use crate::plot::text::{FONT, escape, width, wrap};
use std::fmt::Write;

const WIDTH: f64 = 760.0;
const MARGIN: f64 = 16.0;
const TITLE: f64 = 16.0;
const TITLE_LINE: f64 = 21.0;
const LABEL: f64 = 13.0;
const LABEL_LINE: f64 = 17.0;
const TICK: f64 = 12.0;
/// Axes with their colours.
const COLOURS: [(&str, &str); 3] = [("x", "#b3261e"), ("y", "#1a7f4b"), ("z", "#1f5fbf")];
/// Steps of a colour bar, about.
const STEPS: f64 = 5.0;
/// Least distance of its labels, in parts of the bar: that they do not touch on the lowest.
const APART: f64 = 0.11;
/// Greatest height of the drawing.
const TALL: f64 = 540.0;
/// Least width and height of the drawing: room for captions and a colour bar.
const LEAST: [f64; 2] = [320.0, 130.0];
const BAR: f64 = 16.0;
/// Height of the directions of the axes, and their length.
const AXES: f64 = 46.0;
const AXIS: f64 = 24.0;
/// How far polylines go beyond the body, in parts of its size.
const BEYOND: f64 = 0.12;

pub(super) fn check_length(what: &str, found: usize, nodes: usize) -> Result<(), PlotError> {
    if found == nodes {
        Ok(())
    } else {
        Err(PlotError::Length {
            what: what.into(),
            found,
            nodes,
        })
    }
}

/// A colour bar.
pub(super) struct Bar<'a> {
    pub(super) values: &'a [f64],
    range: [f64; 2],
    label: &'a str,
    /// Values with their labels: both ends, and round ones between.
    ticks: Vec<(f64, String)>,
}

impl<'a> Bar<'a> {
    pub(super) fn new(field: &'a Field, nodes: usize) -> Result<Self, PlotError> {
        check_length(
            &format!("the field {:?}", field.label),
            field.values.len(),
            nodes,
        )?;
        let [mut low, mut high] = field
            .values
            .iter()
            .filter(|v| v.is_finite())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], &v| {
                [l.min(v), h.max(v)]
            });
        let size = low.abs().max(high.abs());
        if high - low <= 1e-9 * size {
            // A constant, but for rounding.
            let margin = if size > 0.0 { 0.1 * size } else { 1.0 };
            (low, high) = (low - margin, high + margin);
        }
        let step = nice_step(high - low, STEPS);
        if low >= high || !step.is_finite() {
            return Err(PlotError::NoValues {
                label: field.label.clone(),
            });
        }
        let round = Number::new(low.abs().max(high.abs()), step);
        let first = (low / step).ceil();
        let inner = (0..2 * STEPS as usize).map(|k| (first + k as f64) * step);
        let margin = APART * (high - low);
        let inner = inner.filter(|v| (low + margin..=high - margin).contains(v));
        let ends = [low, high].map(|v| (v, round.finer().text(v)));
        let ticks = inner.map(|v| (v, round.text(v))).chain(ends).collect();
        Ok(Self {
            values: &field.values,
            range: [low, high],
            label: &field.label,
            ticks,
        })
    }

    /// Part of the bar below a value.
    pub(super) fn part(&self, value: f64) -> f64 {
        ((value - self.range[0]) / (self.range[1] - self.range[0])).clamp(0.0, 1.0)
    }
}

/// Where things are on paper.
pub(super) struct Sheet {
    width: f64,
    height: f64,
    title: Vec<String>,
    /// What is drawn: least and greatest corner \[mm\].
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// Least corner of the drawing on paper, and its size.
    corner: [f64; 2],
    size: [f64; 2],
    /// Pixels a millimetre.
    pub(super) scale: f64,
    /// Label of the bar.
    label: Vec<String>,
    tick_width: f64,
}

impl Sheet {
    pub(super) fn new(picture: &Flat<'_>, bar: Option<&Bar<'_>>) -> Self {
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        let include = |[low, high]: &mut [[f64; 2]; 2], x: &[f64]| {
            for i in 0..2 {
                low[i] = low[i].min(x[i]);
                high[i] = high[i].max(x[i]);
            }
        };
        for &n in picture.faces.iter().flat_map(|face| &face.nodes) {
            include(&mut bounds, &picture.nodes[n]);
            picture
                .still
                .iter()
                .for_each(|still| include(&mut bounds, &still[n]));
        }
        let [low, high] = bounds;
        let beyond = BEYOND * (high[0] - low[0]).max(high[1] - low[1]);
        let limits = [low.map(|v| v - beyond), high.map(|v| v + beyond)];
        for points in &picture.polylines {
            for piece in points.split(|x| !x.iter().all(|v| v.is_finite())) {
                let parts = clip(piece, limits[0], limits[1]);
                parts.iter().flatten().for_each(|x| include(&mut bounds, x));
            }
        }
        for veil in &picture.veils {
            let within = |v: f64, i: usize| v.clamp(limits[0][i], limits[1][i]);
            let veil = veil.iter().filter(|x| x.iter().all(|v| v.is_finite()));
            veil.for_each(|x| include(&mut bounds, &[within(x[0], 0), within(x[1], 1)]));
        }
        let [mut low, mut high] = bounds;
        if !picture.marks.is_empty() {
            low = [0, 1].map(|i| low[i].min(limits[0][i]));
            high = [0, 1].map(|i| high[i].max(limits[1][i]));
        }
        let mut span = [high[0] - low[0], high[1] - low[1]];
        let longest = span[0].max(span[1]);
        // A displacement may flatten a body.
        span = span.map(|v| {
            if longest > 0.0 {
                v.max(1e-6 * longest)
            } else {
                1.0
            }
        });

        let tick_width = bar.map_or(0.0, |bar| {
            bar.ticks
                .iter()
                .map(|(_, tick)| width(tick, TICK))
                .fold(0.0, f64::max)
        });
        let beside = |lines: usize| match bar {
            Some(_) => 22.0 + BAR + 9.0 + tick_width + 6.0 + lines as f64 * LABEL_LINE,
            None => 0.0,
        };
        let room = WIDTH - 2.0 * MARGIN - beside(1);
        let scale = (room / span[0]).min(TALL / span[1]);
        let size = [0, 1].map(|i| (scale * span[i]).max(LEAST[i]));
        let label = bar.map_or_else(Vec::new, |bar| wrap(bar.label, LABEL, size[1] + 24.0));
        let sheet_width = 2.0 * MARGIN + size[0] + beside(label.len());
        let title = wrap(picture.title, TITLE, sheet_width - 2.0 * MARGIN);
        let below = match picture.axes {
            None => 38.0,
            Some(_) => 38.0 + AXES,
        };
        let top = 16.0 + TITLE_LINE * title.len() as f64;
        Self {
            width: sheet_width,
            height: top + size[1] + below,
            title,
            low,
            high,
            corner: [MARGIN, top],
            size,
            scale,
            label,
            tick_width,
        }
    }

    pub(super) fn width(&self) -> f64 {
        self.width
    }

    /// Between these a label has room.
    pub(super) fn top(&self) -> f64 {
        self.corner[1] - 6.0
    }

    pub(super) fn bottom(&self) -> f64 {
        self.corner[1] + self.size[1] + 8.0
    }

    /// Place on paper.
    pub(super) fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let free = [0, 1].map(|i| 0.5 * (self.size[i] - self.scale * (self.high[i] - self.low[i])));
        [
            self.corner[0] + free[0] + self.scale * (x[0] - self.low[0]),
            self.corner[1] + free[1] + self.scale * (self.high[1] - x[1]),
        ]
    }

    /// Width of a cell if all were squares.
    pub(super) fn typical_cell(&self, cells: usize) -> f64 {
        let area = (self.high[0] - self.low[0]) * (self.high[1] - self.low[1]);
        self.scale * (area / cells as f64).sqrt()
    }

    pub(super) fn head(&self) -> String {
        let (w, h) = (number(self.width), number(self.height));
        let name = escape(&self.title.join(" "));
        let mut svg = format!(
            r#"<svg viewBox="0 0 {w} {h}" role="img" aria-label="{name}" xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" font-family="{FONT}" fill="{INK}">"#
        );
        svg.push_str(r##"<rect width="100%" height="100%" fill="#ffffff"/>"##);
        for (k, line) in self.title.iter().enumerate() {
            let place = [0.5 * self.width, 25.0 + k as f64 * TITLE_LINE];
            write_text(&mut svg, place, TITLE, "middle", "", line);
        }
        svg
    }

    pub(super) fn bar(&self, svg: &mut String, bar: &Bar<'_>) {
        let left = self.corner[0] + self.size[0] + 22.0;
        let (top, height) = (self.corner[1] + 1.0, self.size[1] - 2.0);
        // Each colour up to the top, the next one on it: no seams.
        for k in 0..LEVELS {
            let part = height * (LEVELS - k) as f64 / LEVELS as f64;
            let _ = write!(
                svg,
                r#"<rect x="{}" y="{}" width="{BAR}" height="{}" fill="{}"/>"#,
                number(left),
                number(top),
                number(part),
                colour(k),
            );
        }
        let mut pen = Pen::new(FINE);
        pen.move_to([left, top]);
        for corner in [[BAR, 0.0], [BAR, height], [0.0, height]] {
            pen.line_to([left + corner[0], top + corner[1]]);
        }
        pen.close();
        for (value, tick) in &bar.ticks {
            let y = top + height * (1.0 - bar.part(*value));
            pen.move_to([left + BAR, y]);
            pen.line_to([left + BAR + 5.0, y]);
            write_text(svg, [left + BAR + 9.0, y + 4.3], TICK, "start", "", tick);
        }
        pen.stroke(svg, INK, 0.9, "");
        for (k, line) in self.label.iter().enumerate() {
            let x = left + BAR + 9.0 + self.tick_width + 6.0 + (k as f64 + 0.7) * LABEL_LINE;
            let y = top + 0.5 * height;
            let turn = format!(r#" transform="rotate(-90,{},{})""#, number(x), number(y));
            write_text(svg, [x, y], LABEL, "middle", &turn, line);
        }
    }

    /// Magnification and a scale.
    pub(super) fn captions(&self, svg: &mut String, picture: &Flat<'_>) {
        let y = self.height - 12.0;
        if let Some(m) = picture.magnification.filter(|m| *m != 1.0) {
            let times = if (1e-3..1e5).contains(&m.abs()) {
                format!("displacement × {m}")
            } else {
                format!("displacement × {m:.2e}")
            };
            let times = times.replace('-', "−");
            write_text(svg, [self.corner[0], y], TICK, "start", "", &times);
        }
        let length = nice_step(50.0 / self.scale, 1.0);
        let right = self.corner[0] + self.size[0];
        let left = right - self.scale * length;
        let mut pen = Pen::new(FINE);
        for x in [left, right] {
            pen.move_to([x, y - 8.0]);
            pen.line_to([x, y]);
        }
        pen.move_to([left, y - 4.0]);
        pen.line_to([right, y - 4.0]);
        pen.stroke(svg, INK, 1.0, "");
        let text = format!(
            "{} {}",
            Number::new(length, length).text(length),
            picture.unit
        );
        write_text(svg, [left - 7.0, y], TICK, "end", "", &text);
        self.axes(svg, picture);
        let mut x = self.corner[0] + 3.6 * AXIS;
        for (meaning, colour) in picture.keys {
            dot(svg, [x, y - AXES + 8.0], colour);
            write_text(svg, [x + 9.0, y - AXES + 12.3], TICK, "start", "", meaning);
            x += 30.0 + width(meaning, TICK);
        }
    }

    /// Directions of the axes, in the order of their nearness to the eye.
    fn axes(&self, svg: &mut String, picture: &Flat<'_>) {
        let Some(axes) = picture.axes else {
            return;
        };
        let [left, top] = [self.corner[0] + AXIS, self.height - 12.0 - 0.72 * AXES];
        for ([x, y], (name, colour)) in axes.into_iter().zip(COLOURS) {
            // One that points at the eye has no length.
            if x.hypot(y) < 0.05 {
                continue;
            }
            let tip = |length: f64| [left + length * x, top - length * y];
            let mut pen = Pen::new(FINE);
            pen.polyline([[left, top], tip(AXIS)].into_iter());
            pen.stroke(svg, colour, 1.6, "");
            let at = tip(AXIS + 8.0 / x.hypot(y));
            let more = format!(r#" fill="{colour}""#);
            write_text(svg, [at[0], at[1] + 4.0], TICK, "middle", &more, name);
        }
    }
}

/// A dot at a place on paper.
pub(super) fn dot(svg: &mut String, at: [f64; 2], colour: &str) {
    let [x, y] = at.map(number);
    let _ = write!(
        svg,
        r##"<circle cx="{x}" cy="{y}" r="3.6" fill="{colour}" stroke="#ffffff" stroke-width="1.1"/>"##
    );
}
