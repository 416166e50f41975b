//! Pictures as pixels: their size, their ink and their letters, without any font of the machine.

use super::{block, chart};
use moreau::mesh::CellKind;
use moreau::plot::{Chart, MeshPicture, PlotError, Style, png};
use resvg::tiny_skia::Pixmap;

fn pixels(svg: &str, zoom: f32) -> Pixmap {
    let png = png(svg, zoom).expect("a picture");
    Pixmap::decode_png(&png).expect("a PNG")
}

/// Dark pixels above a height of the picture, in units of the SVG.
fn ink(svg: &str, zoom: f32, height: f32) -> usize {
    let pixels = pixels(svg, zoom);
    let above = (height * zoom) as usize * pixels.width() as usize;
    let dark = pixels.pixels()[..above].iter();
    dark.filter(|p| p.red().max(p.green()).max(p.blue()) < 128)
        .count()
}

/// A small document.
fn page(inside: &str) -> String {
    format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">{inside}</svg>"#)
}

/// Twice as large is four times the pixels, not those of half the size.
#[test]
fn pictures_have_the_size_that_is_asked_for() {
    let mesh = block(CellKind::Quad8);
    let body = MeshPicture::new(&mesh, "a body").to_svg();
    for svg in [chart().to_svg(), body].map(|svg| svg.expect("a picture")) {
        let number = |name: &str| -> f32 {
            let (_, after) = svg.split_once(&format!(" {name}=\"")).expect("given");
            let (value, _) = after.split_once('"').expect("a quote");
            value.parse().expect("a number")
        };
        for zoom in [1.0, 2.0] {
            let pixels = pixels(&svg, zoom);
            let size = ["width", "height"].map(|name| (zoom * number(name)).ceil() as u32);
            assert_eq!([pixels.width(), pixels.height()], size);
            let corner = pixels.pixels()[0];
            assert_eq!([corner.red(), corner.green(), corner.blue()], [255; 3]);
        }
        assert!(ink(&svg, 2.0, number("height")) > 3 * ink(&svg, 1.0, number("height")));
    }
}

/// Above the frame of a chart there is its title, and nothing if it has none.
#[test]
fn titles_are_drawn() {
    let titled = |title: &str| {
        let chart = Chart::new(title, "x", "y").with("", Style::Line, [[0.0, 0.0], [1.0, 1.0]]);
        chart.to_svg().expect("a chart")
    };
    assert!(ink(&titled("Load of the punch"), 2.0, 36.0) > 500);
    assert_eq!(ink(&titled(""), 2.0, 12.0), 0);
}

/// Every letter, sign and power of a picture has a shape of its own: none is the box of a character
/// that a font does not have.
#[test]
fn letters_and_lines_leave_ink() {
    assert_eq!(ink(&page(""), 2.0, 20.0), 0);
    let line = page(r#"<path d="M0 10H40" stroke="black"/>"#);
    assert!(ink(&line, 2.0, 20.0) >= 160);
    let mut shapes = Vec::new();
    for sign in ["M", "μ", "·", "⁻", "²", "–", "σ", "×", "−", "\u{e000}"] {
        let text = format!(r#"<text x="5" y="15" font-family="sans-serif">{sign}</text>"#);
        let pixels = pixels(&page(&text), 2.0);
        shapes.push((sign, pixels.data().to_vec()));
    }
    let empty = pixels(&page(""), 2.0).data().to_vec();
    for (k, (sign, shape)) in shapes.iter().enumerate() {
        let same = shapes[..k].iter().find(|(_, other)| other == shape);
        assert!(same.is_none(), "{sign} is drawn as {same:?}");
        assert!(*shape != empty || *sign == "\u{e000}", "{sign}");
    }
}

#[test]
fn what_is_no_picture_is_an_error() {
    let reason = |svg: &str, zoom: f32| match png(svg, zoom) {
        Err(PlotError::Raster { reason }) => reason,
        other => panic!("{other:?}"),
    };
    assert!(!reason("<svg", 1.0).is_empty());
    for zoom in [0.0, -1.0, 1e9, f32::NAN, f32::INFINITY] {
        assert!(
            reason(&page(""), zoom).contains("cannot be drawn"),
            "{zoom}"
        );
    }
}
