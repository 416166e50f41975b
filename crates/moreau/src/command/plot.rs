//! `moreau plot`: the pictures of a run, drawn again from its files.

use super::{INPUT_ERROR, run, say, tell};
use crate::plot::PlotError;
use crate::run::{Drawing, draw};
use std::fmt::Display;
use std::fs;
use std::path::{Path, PathBuf};

/// Makes a PNG of an SVG, so many times as large.
type Raster = fn(&str, f32) -> Result<Vec<u8>, PlotError>;

#[cfg(feature = "png")]
const RASTER: Option<Raster> = Some(crate::plot::png);
#[cfg(not(feature = "png"))]
const RASTER: Option<Raster> = None;

const NO_RASTER: &str = "--png: this command was built without the feature `png`; to have it:
  cargo install --locked --path crates/moreau --features png
Without --png, pictures are drawn as SVG, which browsers show and print.";

/// Pixels for a unit of a picture: sharp on paper and on dense screens.
const ZOOM: f32 = 2.0;

/// Draws a run, as PNG too if asked for; the exit status.
pub(super) fn plot(directory: &Path, drawing: &Drawing, png: bool) -> u8 {
    let raster = RASTER.filter(|_| png);
    if png && raster.is_none() {
        tell!("{NO_RASTER}");
        return INPUT_ERROR;
    }
    let Some(simulation) = run::results(directory) else {
        return INPUT_ERROR;
    };
    let drawn = draw(&simulation, directory, drawing);
    let written = drawn.map_err(|e| e.to_string()).and_then(|mut files| {
        if let Some(raster) = raster {
            files.extend(pixels(&files, raster)?);
        }
        Ok(files)
    });
    match written {
        Ok(files) => {
            files.iter().for_each(|f| say!("{}", f.display()));
            0
        }
        Err(message) => {
            tell!("{message}");
            INPUT_ERROR
        }
    }
}

/// Writes every SVG of some files beside it as PNG; what was written, or a message.
fn pixels(files: &[PathBuf], raster: Raster) -> Result<Vec<PathBuf>, String> {
    let svg = |f: &&PathBuf| f.extension().is_some_and(|e| e == "svg");
    let one = |file: &PathBuf| {
        let told = |e: &dyn Display| format!("{}: {e}", file.display());
        let text = fs::read_to_string(file).map_err(|e| told(&e))?;
        let picture = raster(&text, ZOOM).map_err(|e| told(&e))?;
        let path = file.with_extension("png");
        fs::write(&path, picture).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(path)
    };
    files.iter().filter(svg).map(one).collect()
}
