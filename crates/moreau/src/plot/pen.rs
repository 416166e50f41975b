//! The pen of pictures: paths and texts as SVG; not what they show.

use super::text::escape;
use std::fmt::Write;

/// Units of coordinates in a pixel.
pub(super) const COARSE: f64 = 10.0;
pub(super) const FINE: f64 = 100.0;

pub(super) fn write_text(
    svg: &mut String,
    at: [f64; 2],
    size: f64,
    anchor: &str,
    more: &str,
    text: &str,
) {
    let _ = write!(
        svg,
        r#"<text x="{}" y="{}" font-size="{size}" text-anchor="{anchor}"{more}>{}</text>"#,
        number(at[0]),
        number(at[1]),
        escape(text),
    );
}

/// A coordinate to hundredths, as short as possible.
pub(super) fn number(v: f64) -> String {
    format!("{}", (v * 100.0).round() / 100.0)
}

/// Writes the data of a path, in whole units relative to the last place: errors do not add up.
#[derive(Debug, Clone)]
pub(super) struct Pen {
    path: String,
    unit: f64,
    last: [i64; 2],
    start: [i64; 2],
    command: char,
}

impl Pen {
    pub(super) fn new(unit: f64) -> Self {
        Self {
            path: String::new(),
            unit,
            last: [0; 2],
            start: [0; 2],
            command: ' ',
        }
    }

    fn round(&self, x: [f64; 2]) -> [i64; 2] {
        x.map(|v| (v * self.unit).round() as i64)
    }

    fn write(&mut self, command: char, places: &[[i64; 2]]) {
        let mut first = self.command != command;
        if first {
            self.path.push(command);
            self.command = command;
        }
        for place in places {
            for (to, from) in place.iter().zip(self.last) {
                let v = (to - from) as f64 / self.unit;
                if !first && v >= 0.0 {
                    self.path.push(' ');
                }
                first = false;
                let text = format!("{v}");
                if text.starts_with("0.") || text.starts_with("-0.") {
                    self.path.push_str(&text.replacen("0.", ".", 1));
                } else {
                    self.path.push_str(&text);
                }
            }
        }
        if let Some(&last) = places.last() {
            self.last = last;
        }
    }

    pub(super) fn move_to(&mut self, x: [f64; 2]) {
        let x = self.round(x);
        self.command = ' ';
        self.write('m', &[x]);
        self.start = x;
    }

    pub(super) fn line_to(&mut self, x: [f64; 2]) {
        let x = self.round(x);
        if x != self.last {
            self.write('l', &[x]);
        }
    }

    /// The edge from the last place, which is a, to b, through a middle at half its parameter.
    pub(super) fn edge(&mut self, [a, b]: [[f64; 2]; 2], middle: Option<[f64; 2]>) {
        let Some(middle) = middle else {
            return self.line_to(b);
        };
        // The parabola of a quadratic edge is a Bézier curve.
        let control = [0, 1].map(|i| 2.0 * middle[i] - 0.5 * (a[i] + b[i]));
        let bend = [0, 1].map(|i| middle[i] - 0.5 * (a[i] + b[i]));
        if bend.iter().all(|v| v.abs() < 0.03) {
            self.line_to(b);
        } else {
            let places = [self.round(control), self.round(b)];
            // Both are relative to the last place.
            let last = self.last;
            self.write('q', &places[..1]);
            self.last = last;
            self.write('q', &places[1..]);
        }
    }

    pub(super) fn polyline(&mut self, points: impl Iterator<Item = [f64; 2]>) {
        for (k, x) in points.enumerate() {
            if k == 0 {
                self.move_to(x)
            } else {
                self.line_to(x)
            }
        }
    }

    pub(super) fn close(&mut self) {
        self.path.push('z');
        self.command = ' ';
        self.last = self.start;
    }

    /// Fills the path; a stroke of its colour closes the seams between neighbours.
    pub(super) fn fill(&self, svg: &mut String, colour: &str) {
        if !self.path.is_empty() {
            let _ = write!(
                svg,
                r#"<path fill="{colour}" stroke="{colour}" stroke-width=".6" stroke-linejoin="round" d="{}"/>"#,
                self.path,
            );
        }
    }

    /// Fills the path so that what is behind is still seen.
    pub(super) fn veil(&self, svg: &mut String, colour: &str) {
        if !self.path.is_empty() {
            let _ = write!(
                svg,
                r#"<path fill="{colour}" fill-opacity=".16" stroke="{colour}" stroke-opacity=".35" stroke-width=".5" stroke-linejoin="round" d="{}"/>"#,
                self.path,
            );
        }
    }

    pub(super) fn stroke(&self, svg: &mut String, colour: &str, width: f64, more: &str) {
        if !self.path.is_empty() {
            let _ = write!(
                svg,
                r#"<path fill="none" stroke="{colour}" stroke-width="{}" stroke-linejoin="round" stroke-linecap="round"{more} d="{}"/>"#,
                number(width),
                self.path,
            );
        }
    }
}
