//! SVG text as pixels, with a font of its own so that every machine draws the same; not how it is
//! drawn.

use super::PlotError;
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree};

/// DejaVu Sans, whose licence is beside it.
const FACE: &[u8] = include_bytes!("../../assets/DejaVuSans.ttf");
const FAMILY: &str = "DejaVu Sans";
/// Most pixels of a picture: 400 MB of them.
const MOST: u64 = 100_000_000;

/// An SVG document as PNG, on white, with `zoom` pixels for a unit of the document. The only font is
/// one within the program. Needs the feature `png`.
///
/// # Errors
/// [`PlotError::Raster`] for a text that is no SVG, and for a picture without pixels or with more
/// than 10⁸ of them.
pub fn png(svg: &str, zoom: f32) -> Result<Vec<u8>, PlotError> {
    let failed = |reason: String| PlotError::Raster { reason };
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    fonts.load_font_data(FACE.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let tree = Tree::from_str(svg, &options).map_err(|e| failed(e.to_string()))?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|s| (s * zoom).ceil() as u32);
    let fits = u64::from(width) * u64::from(height) <= MOST;
    let mut pixels = fits
        .then(|| Pixmap::new(width, height))
        .flatten()
        .ok_or_else(|| failed(format!("{width} × {height} pixels cannot be drawn")))?;
    pixels.fill(Color::WHITE);
    resvg::render(
        &tree,
        Transform::from_scale(zoom, zoom),
        &mut pixels.as_mut(),
    );
    pixels.encode_png().map_err(|e| failed(e.to_string()))
}
