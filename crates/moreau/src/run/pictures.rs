//! The pictures of a run, from the files that it has left: forces over time, tractions along the
//! contact, the deformed body with a field.

use super::RunError;
use super::table::Table;
use super::vtu::Array;
use crate::deck::{Deck, Units};
use crate::mesh::Mesh;
use crate::plot::{Chart, MeshPicture, Style};
use std::path::Path;

/// All forces that are not zero throughout, over time; nothing if there is nothing to draw.
pub(super) fn forces(history: &Table, deck: &Deck) -> Option<String> {
    let time = history.numbers("time");
    let label = format!("force [{}]", deck.units.force());
    let mut chart = Chart::new(&deck.title, "steps [–]", label);
    let names = history.names().iter().filter(|n| n.starts_with("force."));
    let columns: Vec<_> = names.map(|n| (n, history.numbers(n))).collect();
    let largest = |c: &[f64]| c.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let scale = columns.iter().map(|(_, c)| largest(c)).fold(0.0, f64::max);
    // Markers tell increments apart as long as they are not too many.
    let style = match time.len() <= 200 {
        true => Style::LinePoints,
        false => Style::Line,
    };
    for (name, column) in columns {
        if largest(&column) > 1e-9 * scale {
            let start = std::iter::once([0.0, 0.0]);
            let points = time.iter().zip(&column).map(|(&t, &f)| [t, f]);
            let points: Vec<_> = start.chain(points).collect();
            let short = name.trim_start_matches("force.");
            chart = chart.with(short, style, points);
        }
    }
    chart.to_svg().ok()
}

/// Rows of `contact.csv` of one increment.
pub(super) fn contact_table(directory: &Path, increment: usize) -> Result<Table, RunError> {
    let wanted = increment.to_string();
    Table::read(&directory.join("contact.csv"), |names, fields| {
        let column = names.iter().position(|n| n == "increment");
        column.is_some_and(|k| fields[k] == wanted)
    })
}

/// Pressure and shear along the contact surfaces, by the coordinate along which they extend.
pub(super) fn tractions(contacts: &Table, deck: &Deck) -> Option<String> {
    let places = [contacts.numbers("x"), contacts.numbers("y")];
    let extent = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
    };
    let axis = usize::from(extent(&places[1]) > extent(&places[0]));
    let label = format!("{} [{}]", ["x", "y"][axis], deck.units.length());
    let traction = format!("traction [{}]", deck.units.stress());
    let mut chart = Chart::new(&deck.title, label, traction);
    let surfaces = contacts.texts("contact");
    let mut names = surfaces.clone();
    names.dedup();
    for surface in names {
        let mut line: Vec<usize> = (0..surfaces.len())
            .filter(|&k| surfaces[k] == surface)
            .collect();
        line.sort_by(|&a, &b| places[axis][a].total_cmp(&places[axis][b]));
        for (column, name) in [("p_n", "pressure"), ("p_1", "shear")] {
            let values = contacts.numbers(column);
            let points: Vec<[f64; 2]> =
                line.iter().map(|&k| [places[axis][k], values[k]]).collect();
            chart = chart.with(format!("{surface}, {name}"), Style::LinePoints, points);
        }
    }
    chart.to_svg().ok()
}

/// Name of the field that is drawn if none is asked for.
pub(super) fn usual_field(deck: &Deck) -> &'static str {
    match deck.materials.iter().any(|m| m.yield_stress.is_some()) {
        true => "equivalent_plastic_strain",
        false => "von_mises",
    }
}

/// A field in words, with its unit.
pub(super) fn label(name: &str, units: Units) -> String {
    let unit = match name {
        n if n.contains("strain") => "–",
        n if n.contains("stress") || n == "von_mises" || n.starts_with("pressure") => {
            units.stress()
        }
        n if n.starts_with("displacement") => units.length(),
        n if n.contains("force") || n == "out_of_balance" => units.force(),
        _ => return name.replace('_', " "),
    };
    let name = match name {
        "von_mises" => "von Mises stress".into(),
        other => other.replace('_', " "),
    };
    format!("{name} [{unit}]")
}

/// A field at every node, by name: a scalar; the length of a vector; or a component, as in
/// `displacement.x`.
pub(super) fn field(arrays: &[Array], name: &str) -> Option<Vec<f64>> {
    let of = |name: &str| arrays.iter().find(|a| a.name == name);
    if let Some(array) = of(name) {
        let length = |v: &[f64]| match v {
            [x] => *x,
            v => v.iter().map(|x| x * x).sum::<f64>().sqrt(),
        };
        return Some(array.values.chunks(array.components).map(length).collect());
    }
    let (name, component) = name.rsplit_once('.')?;
    let array = of(name)?;
    let k = ["x", "y", "z"].iter().position(|c| *c == component)?;
    let value = |v: &[f64]| v.get(k).copied().unwrap_or(0.0);
    (k < array.components).then(|| array.values.chunks(array.components).map(value).collect())
}

/// Displacement of every node in the plane.
fn displacement(arrays: &[Array]) -> Option<Vec<[f64; 2]>> {
    let array = arrays.iter().find(|a| a.name == "displacement")?;
    let plane = |v: &[f64]| Some([*v.first()?, *v.get(1)?]);
    array.values.chunks(array.components).map(plane).collect()
}

/// How many times displacements are drawn so that they are seen but not out of shape.
pub(super) fn usual_magnification(size: f64, largest: f64) -> f64 {
    match largest > 0.0 && largest.is_finite() {
        true => round(0.05 * size / largest),
        false => 1.0,
    }
}

/// The deformed body with a field on it; nothing if the arrays do not have what it takes.
pub(super) fn deformed(
    mesh: &Mesh<2>,
    deck: &Deck,
    arrays: &[Array],
    name: &str,
    magnification: Option<f64>,
) -> Option<String> {
    let displacement = displacement(arrays)?;
    let largest = displacement
        .iter()
        .map(|u| u[0].hypot(u[1]))
        .fold(0.0, f64::max);
    let magnification = magnification.unwrap_or(usual_magnification(mesh.size(), largest));
    MeshPicture::new(mesh, &deck.title)
        .deformed(displacement, magnification)
        .field(label(name, deck.units), field(arrays, name)?)
        .outline()
        .to_svg()
        .ok()
}

/// 1, 2 or 5 times a power of ten, at most the value.
fn round(value: f64) -> f64 {
    let power = 10f64.powf(value.log10().floor());
    let digit = value / power;
    let digit = [5.0, 2.0].into_iter().find(|d| *d <= digit).unwrap_or(1.0);
    digit * power
}
