//! Marks drawn: of a size on paper, whatever that of the body.

use super::mark::Mark;
use super::sheet::{Sheet, dot};
use crate::plot::pen::{FINE, Pen, write_text};
use std::fmt::Write;

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

/// The unit vector across a direction.
fn across([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y).max(f64::MIN_POSITIVE);
    [-y / length, x / length]
}

/// Draws marks, faint ones that are hidden, labels after all others and beside supports.
pub(super) fn draw(svg: &mut String, sheet: &Sheet, marks: &[(&Mark<2>, bool)]) {
    for &(mark, hidden) in marks {
        if hidden && !matches!(mark, Mark::Label { .. }) {
            svg.push_str(r#"<g opacity="0.3">"#);
            symbol(svg, sheet, mark);
            svg.push_str("</g>");
        } else {
            symbol(svg, sheet, mark);
        }
    }
    let mut taken: Vec<_> = (marks.iter())
        .filter_map(|(mark, _)| support(sheet, mark))
        .collect();
    for (mark, _) in marks {
        label(svg, sheet, mark, &mut taken);
    }
}

/// The box of a support, which no label may hide.
fn support(sheet: &Sheet, mark: &Mark<2>) -> Option<[f64; 4]> {
    let Mark::Support { at, from } = mark else {
        return None;
    };
    let [x, y] = off(sheet.place(*at), *from, 0.5 * SUPPORT);
    let half = 0.5 * SUPPORT;
    Some([x - half, y - half, x + half, y + half])
}

/// Draws a mark that is no label.
fn symbol(svg: &mut String, sheet: &Sheet, mark: &Mark<2>) {
    match mark {
        Mark::Support { at, from } => {
            let tip = sheet.place(*at);
            let across = across(*from);
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
            let across = across(*along);
            // A short arrow is all head.
            let length = along[0].hypot(along[1]).max(0.05);
            let neck = off(tip, *along, -(HEAD / length).min(0.8 * ARROW));
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
        Mark::Dot { at, colour } => dot(svg, sheet.place(*at), colour),
        Mark::Label { .. } => {}
    }
}

/// Draws a label where no support and none of those before is.
fn label(svg: &mut String, sheet: &Sheet, mark: &Mark<2>, taken: &mut Vec<[f64; 4]>) {
    let Mark::Label {
        at,
        towards,
        text,
        colour,
    } = mark
    else {
        return;
    };
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
    let line = |k: i32| {
        // The place itself, then those below and above it in turn.
        let rows = f64::from((k + 1) / 2) * if k % 2 == 1 { 1.0 } else { -1.0 };
        x[1] + 0.35 * LABEL + 1.25 * LABEL * rows
    };
    let room = |y: &f64| {
        let own = [
            left + shift,
            y - LABEL,
            left + shift + width,
            y + 0.3 * LABEL,
        ];
        let apart =
            |other: &[f64; 4]| (0..2).any(|i| own[i] >= other[i + 2] || other[i] >= own[i + 2]);
        own[1] >= sheet.top() && own[3] <= sheet.bottom() && taken.iter().all(apart)
    };
    let y = (0..40).map(line).find(room).unwrap_or(line(0));
    taken.push([
        left + shift,
        y - LABEL,
        left + shift + width,
        y + 0.3 * LABEL,
    ]);
    let x = [x[0] + shift, y];
    write_text(svg, x, LABEL, anchor, &more, text);
}
