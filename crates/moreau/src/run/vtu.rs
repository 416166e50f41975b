//! The VTK files of a run: bodies, contact surfaces and quadrature points of its increments, and the
//! list of all; not their format.

use super::RunError;
use super::files::{Mark, Stream, read_text, write_file};
use crate::simulation::{Array, Grid, Simulation};
use crate::vtu::{attribute, joined, pieces, point_data, whole};
use std::path::{Path, PathBuf};

/// Name of the list.
pub(super) const LIST: &str = "result.pvd";
const LIST_HEAD: &str = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" \
                         byte_order=\"LittleEndian\">\n<Collection>";
const LIST_TAIL: &str = "</Collection>\n</VTKFile>\n";

/// A grid to be made: whether it is asked for, its part and its name in the list, and how.
type Made<'a> = (bool, usize, &'a str, &'a dyn Fn() -> Option<Grid>);

/// The files written so far, listed in `result.pvd`.
pub(super) struct Collection {
    directory: PathBuf,
    list: Option<Stream>,
}

impl Collection {
    /// The collection as it was when its list had come to a mark; files that came later are
    /// removed. At 0 it is empty; the list begins with the first file.
    pub(super) fn reopen(directory: PathBuf, mark: Mark) -> Result<Self, RunError> {
        let path = directory.join(LIST);
        let mut kept = String::new();
        let mut list = None;
        if mark.length > 0 {
            let mut stream = Stream::reopen(path.clone(), mark)?;
            stream.cut()?;
            stream.tail(LIST_TAIL)?;
            list = Some(stream);
            kept = read_text(&path)?;
        } else {
            let _ = std::fs::remove_file(path);
        }
        for entry in std::fs::read_dir(&directory)
            .into_iter()
            .flatten()
            .flatten()
        {
            let name = entry.file_name().to_string_lossy().into_owned();
            let whole = whole_of(&name);
            if is_ours(&name) && !kept.contains(&format!("\"{whole}\"")) {
                // One that stays does no harm.
                let _ = std::fs::remove_file(entry.path());
            }
        }
        Ok(Self { directory, list })
    }

    /// The end of the list, without what closes it.
    pub(super) fn mark(&self) -> Mark {
        self.list.as_ref().map_or(Mark::default(), Stream::mark)
    }

    /// Writes of the state of a simulation the body with its contact surfaces and tools, the quadrature points, or both, and
    /// lists them.
    pub(super) fn add(
        &mut self,
        simulation: &Simulation,
        (bodies, at_points): (bool, bool),
    ) -> Result<(), RunError> {
        // Each is written before the next one is made.
        let made: [Made<'_>; 4] = [
            (bodies, 0, "body", &|| Some(simulation.body())),
            (bodies, 1, "contact", &|| simulation.surface()),
            (bodies, 3, "tools", &|| simulation.tools()),
            (at_points, 2, "points", &|| Some(simulation.points())),
        ];
        let asked = made.into_iter().filter(|&(asked, ..)| asked);
        let files = asked.filter_map(|(_, part, name, grid)| Some((part, name, grid()?)));
        self.list(simulation, files)
    }

    /// Writes the motion in which the body of a simulation gives way, and lists it.
    pub(super) fn add_mode(
        &mut self,
        simulation: &Simulation,
        mode: &[f64],
    ) -> Result<(), RunError> {
        let grid = simulation.mode(mode).map(|grid| (4, "mode", grid));
        self.list(simulation, grid.into_iter())
    }

    /// Writes parts of a simulation as it is, and lists them.
    fn list<'a>(
        &mut self,
        simulation: &Simulation,
        files: impl Iterator<Item = (usize, &'a str, Grid)>,
    ) -> Result<(), RunError> {
        let mut files = files.peekable();
        if files.peek().is_none() {
            return Ok(());
        }
        let number = simulation.increments();
        let time = simulation.history().numbers("time").pop().unwrap_or(0.0);
        let mut list = match self.list.take() {
            Some(list) => list,
            None => {
                let mut list = Stream::create(self.directory.join(LIST))?;
                list.line(LIST_HEAD)?;
                list
            }
        };
        for (part, name, grid) in files {
            let file = self.write(simulation, &format!("{name}_{number:05}"), &grid)?;
            list.line(&format!(
                "<DataSet timestep=\"{time}\" part=\"{part}\" name=\"{name}\" file=\"{file}\"/>"
            ))?;
        }
        list.tail(LIST_TAIL)?;
        self.list = Some(list);
        Ok(())
    }

    /// Writes a grid, in pieces where several processes hold its cells; the file to be listed.
    fn write(&self, simulation: &Simulation, name: &str, grid: &Grid) -> Result<String, RunError> {
        let parts = simulation.processes().and_then(|of| pieces(grid, of));
        let Some(mut parts) = parts.filter(|parts| parts.len() > 1) else {
            let file = format!("{name}.vtu");
            write_file(&self.directory.join(&file), &grid.vtu())?;
            return Ok(file);
        };
        let files: Vec<String> = (0..parts.len())
            .map(|p| format!("{name}_{p}.vtu"))
            .collect();
        let listed = parts.next().map(|first| (whole(&first, &files), first));
        let (listed, first) = listed.unzip();
        for (piece, file) in first.into_iter().chain(parts).zip(&files) {
            write_file(&self.directory.join(file), &piece.vtu())?;
        }
        let file = format!("{name}.pvtu");
        write_file(&self.directory.join(&file), &listed.unwrap_or_default())?;
        Ok(file)
    }
}

/// The file in the list that a file belongs to: itself, unless it is a piece.
fn whole_of(name: &str) -> String {
    let piece = name.strip_suffix(".vtu").and_then(|n| n.rsplit_once('_'));
    match piece {
        Some((whole, _)) if whole.contains('_') => format!("{whole}.pvtu"),
        _ => name.to_owned(),
    }
}

/// Whether a name is that of a file that a collection may write.
pub(super) fn is_ours(name: &str) -> bool {
    let number = |kind: &str| {
        let rest = name.strip_prefix(kind)?;
        rest.strip_suffix(".vtu").or(rest.strip_suffix(".pvtu"))
    };
    let numbered = ["body_", "contact_", "points_", "tools_", "mode_"]
        .into_iter()
        .find_map(number);
    let all_digits = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
    let digits = |n: &str| {
        let (increment, piece) = n.split_once('_').unwrap_or((n, "0"));
        increment.len() >= 5 && all_digits(increment) && all_digits(piece)
    };
    name == "failed.vtu" || numbered.is_some_and(digits)
}

/// Number, time and file of the bodies listed in a directory that are still there; none without a list.
pub(super) fn bodies(directory: &Path) -> Vec<(usize, f64, PathBuf)> {
    let text = std::fs::read_to_string(directory.join(LIST)).unwrap_or_default();
    let body = |line: &str| {
        let file = attribute(line, "file")?;
        let (number, _) = file.strip_prefix("body_")?.split_once('.')?;
        let number = number.parse();
        let time = attribute(line, "timestep")?.parse().ok()?;
        let file = directory.join(file);
        // Who has removed some to make room still has pictures of the others.
        file.exists().then_some((number.ok()?, time, file))
    };
    text.lines().filter_map(body).collect()
}

/// The values at the nodes in a file that a run wrote.
pub(super) fn read_point_data(path: &Path) -> Result<Vec<Array>, RunError> {
    let error = |source| RunError::Read {
        path: path.to_owned(),
        source,
    };
    let bytes = std::fs::read(path).map_err(error)?;
    let arrays = match path.extension().is_some_and(|e| e == "pvtu") {
        false => point_data(&bytes),
        true => {
            let text = String::from_utf8_lossy(&bytes);
            let sources = text.lines().filter(|l| l.starts_with("<Piece"));
            let sources = sources.filter_map(|piece| attribute(piece, "Source"));
            let read = sources.map(|file| std::fs::read(path.with_file_name(file)));
            joined(&read.collect::<Result<Vec<_>, _>>().map_err(error)?)
        }
    };
    arrays.ok_or_else(|| error(std::io::Error::other("it is not a file of a run, or torn")))
}
