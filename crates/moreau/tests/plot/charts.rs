//! Charts: well-formed, repeatable, with axes for any numbers, and errors where nothing can be drawn.

use super::{block, chart, texts};
use moreau::mesh::CellKind;
use moreau::plot::{Chart, MeshPicture, PlotError, Style};
use std::collections::BTreeSet;

#[test]
fn charts_are_well_formed_and_named() {
    let texts = texts(&chart().to_svg().expect("a chart"));
    for text in [
        "Load",
        "displacement [mm]",
        "load [N]",
        "coarse",
        "limit load",
        "0.005",
        "8000",
    ] {
        assert!(texts.iter().any(|t| t == text), "{text} in {texts:?}");
    }
}

#[test]
fn equal_charts_are_equal_text_whatever_was_drawn_between() {
    let first = chart().to_svg();
    let _ = chart().log_y().to_svg();
    assert_eq!(first, chart().to_svg());
}

#[test]
fn text_is_escaped_and_never_mathematics() {
    let name = "a & b < c > \"d\" $\\mu$ \u{1}";
    let svg = Chart::new(name, name, name).with(name, Style::Line, [[0.0, 0.0], [1.0, 1.0]]);
    let texts = texts(&svg.to_svg().expect("a chart"));
    let escaped = "a &amp; b &lt; c &gt; &quot;d&quot; $\\mu$";
    assert_eq!(
        texts.iter().filter(|t| t.trim_end() == escaped).count(),
        4,
        "{texts:?}"
    );

    let mesh = block(CellKind::Quad4);
    let svg =
        MeshPicture::new(&mesh, "σ < 1 & \"p\"").field("<MPa>", vec![1.0; mesh.nodes().len()]);
    let texts = self::texts(&svg.to_svg().expect("a picture"));
    assert!(
        texts.iter().any(|t| t == "σ &lt; 1 &amp; &quot;p&quot;"),
        "{texts:?}"
    );
    assert!(texts.iter().any(|t| t == "&lt;MPa&gt;"), "{texts:?}");
}

#[test]
fn logarithmic_axes_reach_below_what_is_resolvable_in_linear_ones() {
    let residuals = [
        [0.0, 3e3],
        [1.0, 2e1],
        [2.0, 4e-3],
        [3.0, 1e-9],
        [4.0, 2e-13],
    ];
    let chart = Chart::new("Newton", "iteration", "residual [N]").log_y();
    let svg = chart
        .with("", Style::LinePoints, residuals)
        .to_svg()
        .expect("a chart");
    let texts = texts(&svg);
    assert!(
        texts.iter().any(|t| t == "10⁻¹²") && texts.iter().any(|t| t == "10⁴"),
        "{texts:?}"
    );
    // A line and five circles; the legend is empty.
    assert_eq!(svg.matches("<circle").count(), 5);
}

#[test]
fn points_that_cannot_be_drawn_are_left_out() {
    let points = [
        [0.0, 1.0],
        [1.0, f64::NAN],
        [2.0, -1.0],
        [3.0, 0.0],
        [f64::INFINITY, 1.0],
        [4.0, 9.0],
    ];
    let chart = Chart::new("", "x", "y")
        .log_y()
        .with("", Style::Points, points);
    assert_eq!(
        chart.to_svg().expect("a chart").matches("<circle").count(),
        2
    );
    // NaN interrupts a line: two pieces of two points each.
    let line = [
        [0.0, 1.0],
        [1.0, 2.0],
        [2.0, f64::NAN],
        [3.0, 2.0],
        [4.0, 1.0],
    ];
    let svg = Chart::new("", "x", "y")
        .with("", Style::Line, line)
        .to_svg()
        .expect("a chart");
    assert_eq!(pieces(&svg), 2);
}

/// Pieces of the first curve of a chart.
fn pieces(svg: &str) -> usize {
    let path = svg.split(r##"stroke="#0072b2""##).nth(1);
    let data = path.and_then(|path| path.split(r#" d=""#).nth(1)?.split('"').next());
    data.unwrap_or_default().matches('m').count()
}

#[test]
fn ranges_cut_off_what_is_outside() {
    let line = [[0.0, 0.0], [1.0, 10.0], [2.0, 0.0]];
    let chart = Chart::new("", "x", "y")
        .y_range(0.0, 5.0)
        .with("", Style::LinePoints, line);
    let svg = chart.to_svg().expect("a chart");
    assert_eq!((pieces(&svg), svg.matches("<circle").count()), (2, 2));
}

#[test]
fn constant_tiny_and_huge_data_have_axes() {
    for value in [0.0, 1.0, -3e-9, 1e17, 1e300, -1e300, 1e-300] {
        let chart = Chart::new("", "x", "y").with("c", Style::Line, [[value, value]]);
        texts(&chart.to_svg().expect("a chart"));
        let line = [[0.0, value], [1.0, value], [2.0, 2.0 * value]];
        let chart = Chart::new("", "x", "y").with("c", Style::LinePoints, line);
        texts(&chart.to_svg().expect("a chart"));
        if value > 0.0 {
            let chart = Chart::new("", "x", "y").log_x().log_y();
            texts(
                &chart
                    .with("c", Style::Line, [[value, value]])
                    .to_svg()
                    .expect("a chart"),
            );
        }
    }
    for decades in [1e1, 1e2, 1e3, 1e20, 1e150] {
        let line = [[1.0 / decades, 1.0], [decades, 2.0]];
        let chart = Chart::new("", "x", "y")
            .log_x()
            .log_y()
            .with("c", Style::Line, line);
        texts(&chart.to_svg().expect("a chart"));
    }
}

#[test]
fn many_and_long_names_find_room() {
    let mut chart = Chart::new("words ".repeat(60), "x", "y");
    for k in 0..40 {
        let name = format!("a series with a rather long name, number {k}");
        chart = chart.with(name, Style::LinePoints, [[0.0, f64::from(k)], [1.0, 0.0]]);
    }
    texts(&chart.to_svg().expect("a chart"));
}

#[test]
fn charts_of_nothing_are_errors() {
    let empty = Chart::new("empty", "x", "y");
    let error = empty.to_svg().unwrap_err();
    assert_eq!(
        error,
        PlotError::NoPoints {
            title: "empty".into()
        }
    );
    assert!(empty.clone().with("", Style::Line, []).to_svg().is_err());
    let negative = empty
        .clone()
        .log_x()
        .with("", Style::Line, [[-1.0, 1.0], [0.0, 1.0]]);
    assert!(matches!(negative.to_svg(), Err(PlotError::NoPoints { .. })));
    let infinite = empty.with("", Style::Line, [[f64::NAN, 1.0], [1.0, f64::INFINITY]]);
    assert!(matches!(infinite.to_svg(), Err(PlotError::NoPoints { .. })));
}

#[test]
fn impossible_ranges_are_errors() {
    let range = |low, high| chart().y_range(low, high).to_svg();
    for (low, high) in [
        (1.0, 1.0),
        (2.0, 1.0),
        (f64::NAN, 1.0),
        (0.0, f64::INFINITY),
    ] {
        assert!(
            matches!(range(low, high), Err(PlotError::Range { .. })),
            "{low} {high}"
        );
    }
    assert!(chart().log_y().y_range(0.0, 1.0).to_svg().is_err());
    assert!(chart().log_y().y_range(1.0, 10.0).to_svg().is_ok());
    let wide = Chart::new("", "x", "y").with("", Style::Line, [[-1e308, 0.0], [1e308, 1.0]]);
    assert!(matches!(wide.to_svg(), Err(PlotError::Range { .. })));
}

/// Of as many series as there are colours times markers, each seen alone: no two are drawn alike.
#[test]
fn no_two_series_look_alike() {
    let alone = |series: i32| {
        let chart = Chart::new("", "x", "y").x_range(0.0, 2.0).y_range(0.0, 2.0);
        let point = |k| if k == series { [1.0, 1.0] } else { [1.0, 9.0] };
        let chart = (0..=series).fold(chart, |c, k| c.with("", Style::Points, [point(k)]));
        chart.to_svg().expect("a chart")
    };
    let looks: BTreeSet<String> = (0..49).map(alone).collect();
    assert_eq!(looks.len(), 49);
}
