//! Marks on a picture: supports, arrows, surfaces, labels, of a size on paper; not what they stand for.

use super::sheet::Sheet;
use crate::plot::pen::{FINE, Pen, write_text};
use std::fmt::Write;

/// A mark on a picture, at places of the body.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A point that is held along a direction, from the side that `from` points to.
    Support {
        /// Where \[mm\].
        at: [f64; 2],
        /// Unit vector along it, out of the body.
        from: [f64; 2],
    },
    /// A motion or a force.
    Arrow {
        /// Where \[mm\].
        at: [f64; 2],
        /// Unit vector.
        along: [f64; 2],
        /// Whether it ends there, as what presses, or begins.
        ends: bool,
        /// Colour, as `#1f5fbf`.
        colour: &'static str,
    },
    /// A line along a surface.
    Line {
        /// Its points \[mm\].
        points: Vec<[f64; 2]>,
        /// Colour.
        colour: &'static str,
    },
    /// A text beside a point.
    Label {
        /// Where \[mm\].
        at: [f64; 2],
        /// Unit vector from there to the text.
        towards: [f64; 2],
        /// The text.
        text: String,
        /// Colour.
        colour: &'static str,
    },
}

/// Pixels of a support, of an arrow, and of its head.
const SUPPORT: f64 = 8.0;
const ARROW: f64 = 26.0;
const HEAD: f64 = 7.0;
const LABEL: f64 = 12.0;
/// Colour of supports.
const HELD: &str = "#1a7f4b";

/// A place on paper, so many pixels off along a direction in the plane of the body, whose y points upwards.
fn off(x: [f64; 2], along: [f64; 2], pixels: f64) -> [f64; 2] {
    [x[0] + pixels * along[0], x[1] - pixels * along[1]]
}

/// Draws marks.
pub(super) fn draw(svg: &mut String, sheet: &Sheet, marks: &[Mark]) {
    for mark in marks {
        match mark {
            Mark::Support { at, from } => {
                let tip = sheet.place(*at);
                let across = [-from[1], from[0]];
                let base = off(tip, *from, SUPPORT);
                let mut pen = Pen::new(FINE);
                pen.move_to(tip);
                for side in [0.5, -0.5] {
                    pen.line_to(off(base, across, side * SUPPORT));
                }
                pen.close();
                pen.stroke(svg, HELD, 1.3, "");
            }
            Mark::Arrow {
                at,
                along,
                ends,
                colour,
            } => {
                let at = sheet.place(*at);
                let (tail, tip) = match ends {
                    true => (off(at, *along, -ARROW), at),
                    false => (at, off(at, *along, ARROW)),
                };
                let across = [-along[1], along[0]];
                let neck = off(tip, *along, -HEAD);
                let mut shaft = Pen::new(FINE);
                shaft.polyline([tail, neck].into_iter());
                shaft.stroke(svg, colour, 1.6, "");
                let mut head = Pen::new(FINE);
                head.move_to(tip);
                for side in [0.4, -0.4] {
                    head.line_to(off(neck, across, side * HEAD));
                }
                head.close();
                head.fill(svg, colour);
            }
            Mark::Line { points, colour } => {
                let mut pen = Pen::new(FINE);
                pen.polyline(points.iter().map(|&x| sheet.place(x)));
                pen.stroke(svg, colour, 4.0, r#" stroke-opacity="0.55""#);
            }
            Mark::Label {
                at,
                towards,
                text,
                colour,
            } => {
                let x = off(sheet.place(*at), *towards, 1.25 * ARROW);
                // Beside an arrow, not on it.
                let x = [x[0], x[1] - LABEL * towards[0].abs()];
                let anchor = match towards[0] {
                    t if t > 0.5 => "start",
                    t if t < -0.5 => "end",
                    _ => "middle",
                };
                let halo = r##" stroke="#ffffff" stroke-width="3" paint-order="stroke""##;
                let mut more = String::from(halo);
                let _ = write!(more, r#" fill="{colour}""#);
                let width = crate::plot::text::width(text, LABEL);
                // Within the sheet.
                let left = match anchor {
                    "start" => x[0],
                    "end" => x[0] - width,
                    _ => x[0] - 0.5 * width,
                };
                let shift = (4.0 - left).max(0.0) + (sheet.width() - 4.0 - left - width).min(0.0);
                let x = [x[0] + shift, x[1] + 0.35 * LABEL];
                write_text(svg, x, LABEL, anchor, &more, text);
            }
        }
    }
}
