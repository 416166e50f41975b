//! `moreau plot`: the pictures of a run, drawn again from its files.

use super::{INPUT_ERROR, run, say, tell};
use moreau::deck::Problem;
use moreau::run::{Drawing, draw};
use std::path::Path;

/// Draws a run; the exit status.
pub(crate) fn plot(directory: &Path, drawing: &Drawing) -> u8 {
    let Some((deck, problem)) = run::problem(&directory.join("deck.resolved.toml")) else {
        return INPUT_ERROR;
    };
    let written = match &problem {
        Problem::Plane(setup) => draw(setup, &deck, directory, drawing),
        Problem::Solid(setup) => draw(setup, &deck, directory, drawing),
    };
    match written {
        Ok(files) => {
            files.iter().for_each(|f| say!("{}", f.display()));
            0
        }
        Err(error) => {
            tell!("{error}");
            INPUT_ERROR
        }
    }
}
