//! The texts of a deck, one behind the other: its own and those of the files that it includes. Which of them a place
//! is in; not what they say.

use std::ops::Range;
use std::path::{Path, PathBuf};

/// A file that a deck includes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Included {
    /// Its path.
    pub(super) file: PathBuf,
    /// What is in it.
    pub(super) text: String,
    /// Where its text begins among the places of the deck, whose own begins at 0.
    pub(super) start: usize,
    /// Its turn in the order in which files are joined, the deck last.
    pub(super) turn: usize,
}

impl Included {
    /// The folder that paths in it are relative to.
    pub(super) fn folder(&self) -> &Path {
        self.file.parent().unwrap_or(Path::new(""))
    }
}

/// The file that a place is in; `None` for the deck itself.
pub(super) fn file_at(files: &[Included], place: usize) -> Option<&Included> {
    let before = files.iter().filter(|file| file.start <= place);
    before.max_by_key(|file| file.start)
}

/// The text that a place is in, and where in that text.
pub(super) fn text_at<'a>(
    own: &'a str,
    files: &'a [Included],
    place: &Range<usize>,
) -> (&'a str, Range<usize>) {
    match file_at(files, place.start) {
        Some(file) => {
            let within = |at: usize| at.saturating_sub(file.start);
            (&file.text, within(place.start)..within(place.end))
        }
        None => (own, place.clone()),
    }
}
