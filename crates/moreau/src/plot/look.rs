//! How the curves of a chart look: colours, dashes and markers; not where they go.

use super::pen::{FINE, Pen, number};
use std::fmt::Write;

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A line; the first of a chart is solid, the others have dots and dashes of their own.
    Line,
    /// A thinner line of plain dashes: for what a chart compares with.
    Dashed,
    /// Markers.
    Points,
    /// Markers on a thin line.
    LinePoints,
}

/// Colours that remain distinct for the colour-blind (Okabe and Ito, and a brown).
const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a4a2b",
];
/// What a chart compares with, in greys.
const REFERENCES: [(&str, &str); 3] = [("#333333", "6 4"), ("#777777", "3 3"), ("#333333", "1 4")];
const DASHES: [Option<&str>; 6] = [
    None,
    Some("12 3 2 3"),
    Some("2 3"),
    Some("16 4"),
    Some("8 3 2 3 2 3"),
    Some("4 2 1 2"),
];
const MARKERS: [Marker; 7] = [
    Marker::Circle,
    Marker::Polygon(&SQUARE),
    Marker::Polygon(&[[0.0, -1.15], [1.0, 0.75], [-1.0, 0.75]]),
    Marker::Polygon(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
    Marker::Polygon(&[[0.0, 1.15], [1.0, -0.75], [-1.0, -0.75]]),
    Marker::Polygon(&STAR),
    Marker::Cross,
];
const SQUARE: [[f64; 2]; 4] = [[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]];
const STAR: [[f64; 2]; 10] = [
    [0.0, -1.3],
    [0.31, -0.43],
    [1.24, -0.4],
    [0.5, 0.16],
    [0.76, 1.05],
    [0.0, 0.53],
    [-0.76, 1.05],
    [-0.5, 0.16],
    [-1.24, -0.4],
    [-0.31, -0.43],
];

/// A shape around a point, of radius one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Marker {
    Circle,
    /// By its corners.
    Polygon(&'static [[f64; 2]]),
    Cross,
}

/// How a curve looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Look {
    colour: &'static str,
    /// Dashes, if any, and width.
    line: Option<(Option<&'static str>, f64)>,
    /// Shape and radius.
    marker: Option<(Marker, f64)>,
}

/// The looks of curves of these styles and numbers of points.
pub(super) fn looks(curves: impl Iterator<Item = (Style, usize)>) -> Vec<Look> {
    let mut colours = COLOURS.into_iter().cycle();
    let mut references = REFERENCES.into_iter().cycle();
    let mut dashes = DASHES.iter().cycle();
    // As many as there are colours: one further each time round, so that no two series are alike.
    let rounds = (0..MARKERS.len()).flat_map(|r| (r..r + COLOURS.len()).map(|k| k % MARKERS.len()));
    let mut markers = rounds.map(|k| MARKERS[k]).cycle();
    let look = |(style, points)| {
        let size = match points {
            0..=60 => 4.0,
            61..=200 => 3.0,
            _ => 2.0,
        };
        let mut marker = || markers.next().map(|shape| (shape, size));
        let (reference, line, marker) = match style {
            Style::Line => (None, Some((dashes.next().copied().flatten(), 2.0)), None),
            Style::LinePoints => (None, Some((None, 1.5)), marker()),
            Style::Points => (None, None, marker()),
            Style::Dashed => {
                let reference = references.next();
                (reference, Some((reference.map(|r| r.1), 1.5)), None)
            }
        };
        let colour = reference.map(|r| r.0).or_else(|| colours.next());
        Look {
            colour: colour.unwrap_or(COLOURS[0]),
            line,
            marker,
        }
    };
    curves.map(look).collect()
}

impl Look {
    /// Draws pieces of a line through these places; a piece of one place is a dot.
    pub(super) fn draw_lines<'a>(
        &self,
        svg: &mut String,
        pieces: impl Iterator<Item = &'a [[f64; 2]]>,
    ) {
        let Some((dashes, width)) = self.line else {
            return;
        };
        let mut pen = Pen::new(FINE);
        let mut dots = Vec::new();
        for piece in pieces {
            match piece {
                [dot] => dots.push(*dot),
                _ => pen.polyline(piece.iter().copied()),
            }
        }
        match dashes {
            None => pen.stroke(svg, self.colour, width, ""),
            Some(dashes) => {
                // Round caps would close the gaps.
                let more = format!(r#" style="stroke-linecap:butt" stroke-dasharray="{dashes}""#);
                pen.stroke(svg, self.colour, width, &more);
            }
        }
        draw_markers(svg, self.colour, (Marker::Circle, width), &dots);
    }

    /// Draws a marker at each of these places.
    pub(super) fn draw_points(&self, svg: &mut String, places: &[[f64; 2]]) {
        if let Some(marker) = self.marker {
            draw_markers(svg, self.colour, marker, places);
        }
    }

    /// The sample of a legend around a place, so long.
    pub(super) fn draw_sample(&self, svg: &mut String, [x, y]: [f64; 2], length: f64) {
        let ends = [[x - 0.5 * length, y], [x + 0.5 * length, y]];
        self.draw_lines(svg, std::iter::once(&ends[..]));
        if let Some((shape, size)) = self.marker {
            draw_markers(svg, self.colour, (shape, size.max(4.0)), &[[x, y]]);
        }
    }
}

fn draw_markers(
    svg: &mut String,
    colour: &str,
    (shape, radius): (Marker, f64),
    places: &[[f64; 2]],
) {
    let mut pen = Pen::new(FINE);
    for &[x, y] in places {
        let at = |[dx, dy]: [f64; 2]| [x + radius * dx, y + radius * dy];
        match shape {
            // Writing to a string does not fail.
            Marker::Circle => {
                let [x, y, r] = [x, y, radius].map(number);
                let _ = write!(
                    svg,
                    r#"<circle cx="{x}" cy="{y}" r="{r}" fill="{colour}"/>"#
                );
            }
            Marker::Polygon(corners) => {
                pen.polyline(corners.iter().map(|&c| at(c)));
                pen.close();
            }
            Marker::Cross => {
                for c in [[-1.0, -1.0], [-1.0, 1.0]] {
                    pen.polyline([c, c.map(|v| -v)].into_iter().map(at));
                }
            }
        }
    }
    match shape {
        Marker::Cross => pen.stroke(svg, colour, 1.5, ""),
        _ => pen.fill(svg, colour),
    }
}
