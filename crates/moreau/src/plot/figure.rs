//! Charts on paper: frame, ticks, curves, legend. The only file that knows the plotting library,
//! and no more than a wrapper of it.

use super::axis::Axis;
use super::text::{FONT, escape, printable, width, wrap};
use super::{Scale, Style};
use kuva::backend::svg::SvgBackend;
use kuva::plot::{LinePlot, LineStyle, MarkerShape, ScatterPlot};
use kuva::render::layout::{AxisLine, Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene, TextAnchor, render_multiple};
use kuva::render::render_utils::{generate_ticks_log, generate_ticks_with_step};
use kuva::render::theme::Theme;
use std::sync::Arc;

/// A series ready to draw, in parts of the axes.
pub(super) struct Curve<'a> {
    pub(super) name: &'a str,
    pub(super) style: Style,
    pub(super) lines: Vec<Vec<[f64; 2]>>,
    pub(super) points: Vec<[f64; 2]>,
}

const WIDTH: f64 = 760.0;
const HEIGHT: f64 = 480.0;
const TITLE: u32 = 16;
const LABEL: u32 = 14;
const TICK: u32 = 12;
const TITLE_LINE: f64 = 21.0;
const LEGEND_LINE: f64 = 21.0;
/// Length of a line in the legend: shows two dashes of every kind.
const SAMPLE: f64 = 38.0;
/// Widest name that the legend beside the frame has room for.
const WIDEST: f64 = 170.0;
const INK: &str = "#222222";

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
const MARKERS: [MarkerShape; 7] = [
    MarkerShape::Circle,
    MarkerShape::Square,
    MarkerShape::Triangle,
    MarkerShape::Diamond,
    MarkerShape::TriangleDown,
    MarkerShape::Star,
    MarkerShape::Cross,
];

/// How a curve looks.
#[derive(Clone, Copy)]
struct Look {
    colour: &'static str,
    /// Dashes, if any, and width.
    line: Option<(Option<&'static str>, f64)>,
    /// Shape and radius.
    marker: Option<(MarkerShape, f64)>,
}

/// The looks of the curves of a chart.
fn looks(curves: &[Curve<'_>]) -> Vec<Look> {
    let mut colours = COLOURS.into_iter().cycle();
    let mut references = REFERENCES.into_iter().cycle();
    let mut dashes = DASHES.iter().cycle();
    // As many as there are colours: one further each time round, so that no two series are alike.
    let rounds = (0..MARKERS.len()).flat_map(|r| (r..r + COLOURS.len()).map(|k| k % MARKERS.len()));
    let mut markers = rounds.map(|k| MARKERS[k]).cycle();
    let mut looks = Vec::with_capacity(curves.len());
    for curve in curves {
        let size = match curve.points.len() {
            0..=60 => 4.0,
            61..=200 => 3.0,
            _ => 2.0,
        };
        let mut marker = || markers.next().map(|shape| (shape, size));
        let (reference, line, marker) = match curve.style {
            Style::Line => (None, Some((dashes.next().copied().flatten(), 2.0)), None),
            Style::LinePoints => (None, Some((None, 1.5)), marker()),
            Style::Points => (None, None, marker()),
            Style::Dashed => {
                let reference = references.next();
                (reference, Some((reference.map(|r| r.1), 1.5)), None)
            }
        };
        let colour = reference
            .map(|r| r.0)
            .or_else(|| colours.next())
            .unwrap_or(INK);
        looks.push(Look {
            colour,
            line,
            marker,
        });
    }
    looks
}

impl Look {
    fn lines(&self, points: Vec<(f64, f64)>) -> Plot {
        let (dash, width) = self.line.unwrap_or((None, 1.5));
        let style = dash.map_or(LineStyle::Solid, |dash| LineStyle::Custom(dash.into()));
        LinePlot::new()
            .with_data(points)
            .with_color(self.colour)
            .with_stroke_width(width)
            .with_line_style(style)
            .into()
    }

    fn markers(&self, points: Vec<(f64, f64)>) -> Plot {
        // A line of one point is a dot.
        let (shape, size) = self.marker.unwrap_or((MarkerShape::Circle, 2.0));
        ScatterPlot::new()
            .with_data(points)
            .with_color(self.colour)
            .with_marker(shape)
            .with_size(size)
            .into()
    }
}

impl Axis {
    /// Decades by which the library's values of a logarithmic axis are less, so that they start
    /// between 1 and 10 whatever the data: the library takes 1e-10 for the least positive number.
    fn shift(&self) -> f64 {
        match self.scale {
            Scale::Linear => 0.0,
            Scale::Logarithmic => (self.ends[0] + 1e-9).floor(),
        }
    }

    /// The library's value at a part of the axis.
    fn value(&self, t: f64) -> f64 {
        let v = self.ends[0] + t * (self.ends[1] - self.ends[0]) - self.shift();
        match self.scale {
            Scale::Linear => v,
            Scale::Logarithmic => 10f64.powf(v),
        }
    }

    /// The library's values of the ends.
    fn range(&self) -> (f64, f64) {
        (self.value(0.0), self.value(1.0))
    }

    /// Label at the library's value.
    fn label_at(&self, value: f64) -> String {
        match self.scale {
            Scale::Linear => self.tick(value),
            Scale::Logarithmic => self.tick(value.log10() + self.shift()),
        }
    }

    /// Width of the widest label of a tick, and of the last.
    fn label_widths(&self) -> (f64, f64) {
        let (low, high) = self.range();
        let ticks = match self.scale {
            Scale::Linear => generate_ticks_with_step(low, high, self.step),
            Scale::Logarithmic => generate_ticks_log(low, high),
        };
        let size = f64::from(TICK);
        let widths = ticks.iter().map(|&v| width(&self.label_at(v), size));
        let last = widths.clone().next_back().unwrap_or(0.0);
        (widths.fold(0.0, f64::max), last)
    }

    /// Parts of a logarithmic axis at 2, 3, … 9 times a power of ten.
    fn minor(&self) -> Vec<f64> {
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

    fn format(&self) -> TickFormat {
        let axis = self.clone();
        TickFormat::Custom(Arc::new(move |value| plain(&axis.label_at(value))))
    }
}

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

    /// The parts of the axes at a place on paper.
    fn unit(&self, x: f64, y: f64) -> [f64; 2] {
        [
            (x - self.left) / self.frame_width(),
            (self.height - self.bottom - y) / self.frame_height(),
        ]
    }
}

/// A chart as SVG.
pub(super) fn draw(title: &str, x: &Axis, y: &Axis, curves: &[Curve<'_>]) -> String {
    let looks = looks(curves);
    let named: Vec<(&Look, &Curve<'_>)> = looks
        .iter()
        .zip(curves)
        .filter(|(_, curve)| !curve.name.is_empty())
        .collect();
    let widest = named
        .iter()
        .map(|(_, curve)| width(curve.name, f64::from(TICK)))
        .fold(0.0, f64::max);
    let title = wrap(title, f64::from(TITLE), WIDTH - 80.0);
    let (y_labels, _) = y.label_widths();
    let mut sheet = Sheet {
        height: HEIGHT,
        left: 24.0 + f64::from(LABEL) + y_labels,
        right: (0.5 * x.label_widths().1 + 6.0).max(24.0),
        top: 18.0 + TITLE_LINE * title.len() as f64,
        bottom: 56.0,
        title,
    };
    let beside =
        widest <= WIDEST && named.len() as f64 * LEGEND_LINE <= HEIGHT - sheet.top - sheet.bottom;
    let mut columns = 1;
    if beside && !named.is_empty() {
        sheet.right = 12.0 + SAMPLE + 8.0 + widest + 8.0;
    } else if !named.is_empty() {
        let room = sheet.frame_width() / (SAMPLE + 8.0 + widest + 24.0);
        columns = (room as usize).clamp(1, named.len());
        let below = named.len().div_ceil(columns) as f64 * LEGEND_LINE + 6.0;
        sheet.height += below;
        sheet.bottom += below;
    }

    let mut plots = Vec::new();
    let at = |[s, t]: [f64; 2]| (x.value(s), y.value(t));
    for (look, curve) in looks.iter().zip(curves) {
        if look.line.is_some() {
            for line in &curve.lines {
                let points = line.iter().copied().map(at).collect();
                plots.push(if line.len() > 1 {
                    look.lines(points)
                } else {
                    look.markers(points)
                });
            }
        }
        if look.marker.is_some() {
            plots.push(look.markers(curve.points.iter().copied().map(at).collect()));
        }
    }

    let mut texts = labels(&sheet, x, y);
    for (k, (look, curve)) in named.iter().enumerate() {
        let (left, middle) = if beside {
            let left = WIDTH - sheet.right + 12.0;
            (left, sheet.top + (k as f64 + 0.5) * LEGEND_LINE)
        } else {
            let rows = named.len().div_ceil(columns);
            let column = sheet.frame_width() / columns as f64;
            let top = sheet.height - rows as f64 * LEGEND_LINE - 8.0;
            let row = (k / columns) as f64;
            let left = sheet.left + (k % columns) as f64 * column;
            (left, top + (row + 0.5) * LEGEND_LINE)
        };
        // Samples are data outside the frame: drawn like the curves, whatever their look.
        if look.line.is_some() {
            let ends = [left, left + SAMPLE].map(|x| at(sheet.unit(x, middle)));
            plots.push(look.lines(ends.to_vec()));
        }
        if let Some((shape, size)) = look.marker {
            let sample = Look {
                marker: Some((shape, size.max(4.0))),
                ..**look
            };
            plots.push(sample.markers(vec![at(sheet.unit(left + 0.5 * SAMPLE, middle))]));
        }
        texts.push(text(
            left + SAMPLE + 8.0,
            middle + 4.3,
            curve.name,
            TICK,
            TextAnchor::Start,
        ));
    }

    let mut scene = render_multiple(plots, layout(&sheet, x, y));
    // Curves have been cut off at the frame already, and paths for clipping would need ids.
    scene.defs.clear();
    scene
        .elements
        .retain(|e| !matches!(e, Primitive::ClipStart { .. } | Primitive::ClipEnd));
    minor_ticks(&mut scene, &sheet, x, y);
    scene.elements.extend(texts);
    let svg = SvgBackend::new().render_scene(&scene);
    // Scales with the page that it is in.
    let head = format!(
        r#"<svg viewBox="0 0 {WIDTH} {}" role="img" aria-label="{}" "#,
        sheet.height,
        escape(&sheet.title.join(" ")),
    );
    svg.find("<svg ").map_or_else(String::new, |start| {
        svg[start..].replacen("<svg ", &head, 1)
    })
}

fn layout(sheet: &Sheet, x: &Axis, y: &Axis) -> Layout {
    let theme = Theme {
        axis_color: INK.into(),
        tick_color: INK.into(),
        text_color: INK.into(),
        grid_color: "#e6e6e6".into(),
        ..Theme::light()
    };
    let (x_range, y_range) = (x.range(), y.range());
    let mut layout = Layout::new(x_range, y_range)
        .with_width(WIDTH)
        .with_height(sheet.height)
        .with_force_margins(sheet.left, sheet.right)
        .with_force_margins_y(sheet.top, sheet.bottom)
        .with_x_axis_min(x_range.0)
        .with_x_axis_max(x_range.1)
        .with_y_axis_min(y_range.0)
        .with_y_axis_max(y_range.1)
        .with_x_tick_format(x.format())
        .with_y_tick_format(y.format())
        .with_axis_line(AxisLine::Box)
        .with_tick_size(TICK)
        .with_font_family(FONT)
        .with_theme(theme);
    match x.scale {
        Scale::Linear => layout = layout.with_x_tick_step(x.step),
        Scale::Logarithmic => layout = layout.with_log_x(),
    }
    match y.scale {
        Scale::Linear => layout.with_y_tick_step(y.step),
        Scale::Logarithmic => layout.with_log_y(),
    }
}

/// Title and labels of the axes.
fn labels(sheet: &Sheet, x: &Axis, y: &Axis) -> Vec<Primitive> {
    let centre = [
        sheet.left + 0.5 * sheet.frame_width(),
        sheet.top + 0.5 * sheet.frame_height(),
    ];
    let mut texts: Vec<Primitive> = sheet
        .title
        .iter()
        .enumerate()
        .map(|(k, line)| {
            let baseline = 25.0 + k as f64 * TITLE_LINE;
            text(centre[0], baseline, line, TITLE, TextAnchor::Middle)
        })
        .collect();
    let below = sheet.height - sheet.bottom + 42.0;
    texts.push(text(centre[0], below, &x.label, LABEL, TextAnchor::Middle));
    texts.push(Primitive::Text {
        x: 20.0,
        y: centre[1],
        content: plain(&y.label),
        size: LABEL,
        anchor: TextAnchor::Middle,
        rotate: Some(-90.0),
        bold: false,
        color: None,
    });
    texts
}

fn minor_ticks(scene: &mut Scene, sheet: &Sheet, x: &Axis, y: &Axis) {
    let mut line = |x1: f64, y1: f64, x2: f64, y2: f64| {
        scene.elements.push(Primitive::Line {
            x1,
            y1,
            x2,
            y2,
            stroke: INK.into(),
            stroke_width: 0.6,
            stroke_dasharray: None,
        });
    };
    let base = sheet.height - sheet.bottom;
    for t in x.minor() {
        let place = sheet.left + t * sheet.frame_width();
        line(place, base, place, base + 3.0);
    }
    for t in y.minor() {
        let place = base - t * sheet.frame_height();
        line(sheet.left - 3.0, place, sheet.left, place);
    }
}

fn text(x: f64, y: f64, content: &str, size: u32, anchor: TextAnchor) -> Primitive {
    Primitive::Text {
        x,
        y,
        content: plain(content),
        size,
        anchor,
        rotate: None,
        bold: false,
        color: None,
    }
}

/// Text that the library does not take for mathematics.
fn plain(text: &str) -> String {
    printable(text).replace('$', "\\$")
}
