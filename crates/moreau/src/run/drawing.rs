//! What is drawn of a run, from its files: at its end and again; not how.

use super::files::{contact_table, history_table, write_file};
use super::{RunError, report, vtu};
use crate::mesh::nearest;
use crate::simulation::{Array, Simulation, either, pictures};
use std::path::{Path, PathBuf};

/// What to draw of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing {
    /// Field on the body, a name in the VTU files; with `.x` and so on, a component.
    pub field: Option<String>,
    /// Increment, instead of the last.
    pub increment: Option<usize>,
    /// How many times displacements are drawn.
    pub magnification: Option<f64>,
}

/// Draws a run again from its files: history, contact line, deformed body, report; returns what
/// was written.
///
/// # Errors
/// [`RunError::Read`] for a directory without results, [`RunError::Unknown`] for a field or an
/// increment that is not in them, [`RunError::Write`].
pub fn draw(
    simulation: &Simulation,
    directory: &Path,
    drawing: &Drawing,
) -> Result<Vec<PathBuf>, RunError> {
    pictures_of(simulation, directory, None, drawing)
}

/// The pictures and the report. `last` is the end of the run where no file has it.
pub(super) fn pictures_of(
    simulation: &Simulation,
    directory: &Path,
    last: Option<&[Array]>,
    drawing: &Drawing,
) -> Result<Vec<PathBuf>, RunError> {
    let deck = simulation.deck();
    let history = history_table(directory)?;
    let increments = history.numbers("increment").into_iter();
    let increments: Vec<usize> = increments.map(|n| n as usize).collect();
    let end = increments.last().copied().unwrap_or(0);
    let number = match drawing.increment {
        Some(number) if !increments.contains(&number) => {
            return Err(RunError::Unknown {
                what: format!("increment {number}"),
                expected: format!("1 to {end}"),
            });
        }
        Some(number) => number,
        None => end,
    };
    // What was asked for is kept apart from what every run has.
    let asked = drawing.field.iter().map(|f| format!("-{f}"));
    let asked: String = asked
        .chain(drawing.increment.iter().map(|n| format!("-{n}")))
        .collect();
    let mut written = Vec::new();
    let mut write = |name: String, text: Option<String>| {
        if let Some(text) = text {
            let path = directory.join(name);
            write_file(&path, text.as_bytes())?;
            written.push(path);
        }
        Ok(())
    };
    let forces = pictures::over_time(&history, deck).and_then(|chart| chart.to_svg().ok());
    write("history.svg".into(), forces)?;
    let files = vtu::bodies(directory);
    let arrays = match files.iter().find(|f| f.0 == number) {
        Some((_, _, path)) => Some(vtu::read_point_data(path)?),
        None if drawing.increment.is_some() || drawing.field.is_some() && last.is_none() => {
            let all: Vec<String> = files.iter().map(|f| f.0.to_string()).collect();
            let field = drawing
                .field
                .iter()
                .map(|f| format!(", for the field \"{f}\""));
            return Err(RunError::Unknown {
                what: format!(
                    "the body of increment {number}{}",
                    field.collect::<String>()
                ),
                expected: match all.is_empty() {
                    true => "none, as vtu = \"none\" writes none".to_owned(),
                    false => all.join(", "),
                },
            });
        }
        None => last.map(<[_]>::to_vec),
    };
    let name = drawing.field.as_deref();
    let name = name.unwrap_or(pictures::usual_field(deck));
    if let Some(arrays) = &arrays {
        known(name, arrays)?;
    }
    let contacts = contact_table(directory, &[number])?;
    let row = increments.iter().position(|&n| n == number).unwrap_or(0);
    let (contact, deformed, still) = either!(simulation.course(), course => {
        let (mesh, arrays) = (course.driver().mesh(), arrays.as_deref());
        let of_field = |name: &str, magnification| {
            pictures::deformed(mesh, deck, arrays?, name, (&history, row), magnification)
        };
        (
            pictures::contact(mesh, deck, &contacts, number, arrays),
            of_field(name, drawing.magnification),
            of_field(pictures::usual_field(deck), None),
        )
    });
    let at = drawing.increment.map_or(String::new(), |n| format!("-{n}"));
    write(format!("contact{at}.svg"), contact.clone())?;
    write(format!("deformed{asked}.svg"), deformed)?;
    let page = either!(simulation.course(), course => {
        report::report(course.driver(), deck, directory, last, [still, contact])
    })?;
    write("report.html".into(), Some(page))?;
    Ok(written)
}

/// That a field is there.
fn known(name: &str, arrays: &[Array]) -> Result<(), RunError> {
    if pictures::field(arrays, name).is_some() {
        return Ok(());
    }
    let all = pictures::fields(arrays);
    let near = nearest(name, all.iter().map(String::as_str));
    let near = near.map_or(String::new(), |n| format!(" (did you mean {n}?)"));
    Err(RunError::Unknown {
        what: format!("the field \"{name}\"{near}"),
        expected: all.join(", "),
    })
}
