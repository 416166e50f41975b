//! Charts on paper: frame, ticks, curves, legend; not where values lie on an axis.

use super::axis::Axis;
use super::colour::INK;
use super::look::{Look, Style, looks};
use super::pen::{FINE, Pen, number, write_text};
use super::text::{FONT, escape, width, wrap};

/// A series ready to draw, in parts of the axes.
pub(super) struct Curve<'a> {
    pub(super) name: &'a str,
    pub(super) style: Style,
    pub(super) lines: Vec<Vec<[f64; 2]>>,
    pub(super) points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 480.0;
const TITLE: f64 = 16.0;
const LABEL: f64 = 14.0;
const TICK: f64 = 12.0;
const TITLE_LINE: f64 = 21.0;
const LEGEND_LINE: f64 = 21.0;
/// Length of a line in the legend: shows two dashes of every kind.
const SAMPLE: f64 = 38.0;
/// Widest name that the legend beside the frame has room for.
const WIDEST: f64 = 170.0;
const GRID: &str = "#e6e6e6";
/// Lengths of the ticks.
const MAJOR: f64 = 5.0;
const MINOR: f64 = 3.0;

/// Where things are on paper.
struct Sheet {
    height: f64,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    title: Vec<String>,
}

impl Sheet {
    fn frame_width(&self) -> f64 {
        WIDTH - self.left - self.right
    }

    fn frame_height(&self) -> f64 {
        self.height - self.top - self.bottom
    }

    /// The place on paper of parts of the axes.
    fn at(&self, [s, t]: [f64; 2]) -> [f64; 2] {
        [
            self.left + s * self.frame_width(),
            self.top + (1.0 - t) * self.frame_height(),
        ]
    }
}

/// Where the legend is: beside the frame, or below it in columns.
enum Legend {
    Beside,
    Below { columns: usize },
}

/// A chart as SVG.
pub(super) fn draw(title: &str, x: &Axis, y: &Axis, curves: &[Curve<'_>]) -> String {
    let looks = looks(curves.iter().map(|c| (c.style, c.points.len())));
    let named: Vec<(&Look, &str)> = looks
        .iter()
        .zip(curves.iter().map(|c| c.name))
        .filter(|(_, name)| !name.is_empty())
        .collect();
    let (sheet, legend) = arrange(title, [x, y], &named);
    // Scales with the page that it is in.
    let mut svg = format!(
        r#"<svg viewBox="0 0 {WIDTH} {0}" role="img" aria-label="{1}" xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{0}" font-family="{FONT}" fill="{INK}"><rect width="{WIDTH}" height="{0}" fill="white"/>"#,
        number(sheet.height),
        escape(&sheet.title.join(" ")),
    );
    draw_frame(&mut svg, &sheet, x, y);
    for (look, curve) in looks.iter().zip(curves) {
        let lines = curve.lines.iter();
        let lines: Vec<Vec<[f64; 2]>> = lines
            .map(|line| line.iter().map(|&p| sheet.at(p)).collect())
            .collect();
        look.draw_lines(&mut svg, lines.iter().map(Vec::as_slice));
        let points: Vec<[f64; 2]> = curve.points.iter().map(|&p| sheet.at(p)).collect();
        look.draw_points(&mut svg, &points);
    }
    draw_legend(&mut svg, &sheet, &legend, &named);
    draw_labels(&mut svg, &sheet, x, y);
    svg.push_str("</svg>");
    svg
}

/// Room for what stands around the frame.
fn arrange(title: &str, [x, y]: [&Axis; 2], named: &[(&Look, &str)]) -> (Sheet, Legend) {
    let widest = |texts: &mut dyn Iterator<Item = &str>| {
        texts.map(|text| width(text, TICK)).fold(0.0, f64::max)
    };
    let names = widest(&mut named.iter().map(|n| n.1));
    let (x_ticks, y_ticks) = (x.ticks(), y.ticks());
    let y_labels = widest(&mut y_ticks.iter().map(|t| t.1.as_str()));
    let last = x_ticks.last().map_or(0.0, |t| width(&t.1, TICK));
    let title = wrap(title, TITLE, WIDTH - 80.0);
    let mut sheet = Sheet {
        height: HEIGHT,
        left: 24.0 + LABEL + y_labels,
        right: (0.5 * last + 6.0).max(24.0),
        top: 18.0 + TITLE_LINE * title.len() as f64,
        bottom: 56.0,
        title,
    };
    let fits = named.len() as f64 * LEGEND_LINE <= sheet.frame_height();
    if named.is_empty() {
        return (sheet, Legend::Beside);
    }
    if names <= WIDEST && fits {
        sheet.right = 12.0 + SAMPLE + 8.0 + names + 8.0;
        return (sheet, Legend::Beside);
    }
    let room = sheet.frame_width() / (SAMPLE + 8.0 + names + 24.0);
    let columns = (room as usize).clamp(1, named.len());
    let below = named.len().div_ceil(columns) as f64 * LEGEND_LINE + 6.0;
    sheet.height += below;
    sheet.bottom += below;
    (sheet, Legend::Below { columns })
}

/// The frame with grid, ticks and their labels.
fn draw_frame(svg: &mut String, sheet: &Sheet, x: &Axis, y: &Axis) {
    let [mut grid, mut major, mut minor] = [(); 3].map(|()| Pen::new(FINE));
    let line = |pen: &mut Pen, [x, y]: [f64; 2], [dx, dy]: [f64; 2]| {
        pen.polyline([[x, y], [x + dx, y + dy]].into_iter());
    };
    let (x_ticks, y_ticks) = (x.ticks(), y.ticks());
    for (s, _) in &x_ticks {
        line(&mut grid, sheet.at([*s, 0.0]), [0.0, -sheet.frame_height()]);
        line(&mut major, sheet.at([*s, 0.0]), [0.0, MAJOR]);
    }
    for (t, _) in &y_ticks {
        line(&mut grid, sheet.at([0.0, *t]), [sheet.frame_width(), 0.0]);
        line(&mut major, sheet.at([0.0, *t]), [-MAJOR, 0.0]);
    }
    for s in x.minor() {
        line(&mut minor, sheet.at([s, 0.0]), [0.0, MINOR]);
    }
    for t in y.minor() {
        line(&mut minor, sheet.at([0.0, t]), [-MINOR, 0.0]);
    }
    let mut frame = Pen::new(FINE);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    frame.polyline(corners.into_iter().map(|c| sheet.at(c)));
    frame.close();
    grid.stroke(svg, GRID, 1.0, "");
    frame.stroke(svg, INK, 1.0, "");
    major.stroke(svg, INK, 1.0, "");
    minor.stroke(svg, INK, 0.6, "");
    for (s, label) in &x_ticks {
        let [x, y] = sheet.at([*s, 0.0]);
        write_text(svg, [x, y + MAJOR + TICK], TICK, "middle", "", label);
    }
    for (t, label) in &y_ticks {
        let [x, y] = sheet.at([0.0, *t]);
        write_text(
            svg,
            [x - MAJOR - 3.0, y + 0.35 * TICK],
            TICK,
            "end",
            "",
            label,
        );
    }
}

fn draw_legend(svg: &mut String, sheet: &Sheet, legend: &Legend, named: &[(&Look, &str)]) {
    for (k, (look, name)) in named.iter().enumerate() {
        let (left, middle) = match legend {
            Legend::Beside => {
                let left = WIDTH - sheet.right + 12.0;
                (left, sheet.top + (k as f64 + 0.5) * LEGEND_LINE)
            }
            Legend::Below { columns } => {
                let rows = named.len().div_ceil(*columns);
                let column = sheet.frame_width() / *columns as f64;
                let top = sheet.height - rows as f64 * LEGEND_LINE - 8.0;
                let left = sheet.left + (k % columns) as f64 * column;
                (left, top + ((k / columns) as f64 + 0.5) * LEGEND_LINE)
            }
        };
        look.draw_sample(svg, [left + 0.5 * SAMPLE, middle], SAMPLE);
        let at = [left + SAMPLE + 8.0, middle + 4.3];
        write_text(svg, at, TICK, "start", "", name);
    }
}

/// Title and labels of the axes.
fn draw_labels(svg: &mut String, sheet: &Sheet, x: &Axis, y: &Axis) {
    let [centre, middle] = sheet.at([0.5, 0.5]);
    for (k, line) in sheet.title.iter().enumerate() {
        let baseline = 25.0 + k as f64 * TITLE_LINE;
        write_text(svg, [centre, baseline], TITLE, "middle", "", line);
    }
    let below = sheet.height - sheet.bottom + 42.0;
    write_text(svg, [centre, below], LABEL, "middle", "", &x.label);
    let turned = format!(r#" transform="rotate(-90 20 {})""#, number(middle));
    write_text(svg, [20.0, middle], LABEL, "middle", &turned, &y.label);
}

/// Pictures below each other as one.
pub fn below_each_other(pictures: &[String]) -> String {
    if let [one] = pictures {
        return one.clone();
    }
    let size = |svg: &str, name: &str| -> f64 {
        let value = svg.split(&format!(" {name}=\"")).nth(1);
        let value = value.and_then(|v| v.split('"').next());
        value.and_then(|v| v.parse().ok()).unwrap_or(0.0)
    };
    let width = pictures
        .iter()
        .map(|p| size(p, "width"))
        .fold(0.0, f64::max);
    let (mut inner, mut top) = (String::new(), 0.0);
    for picture in pictures {
        let place = format!("<svg y=\"{}\" ", number(top));
        inner.push_str(&picture.replacen("<svg ", &place, 1));
        top += size(picture, "height");
    }
    let [w, h] = [width, top].map(number);
    format!(
        r#"<svg viewBox="0 0 {w} {h}" role="img" xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}">{inner}</svg>"#
    )
}
