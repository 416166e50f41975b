//! `report.html`: a run on one page that needs nothing but a browser; its template is beside it.

use super::files::read_text;
use super::grid::Array;
use super::pictures::{
    ContactLine, TRACTIONS, contact_axis, contact_labels, contact_lines, field, fields, forces,
    label, tractions, usual_field, usual_magnification,
};
use super::table::Table;
use super::vtu::{bodies, read_point_data};
use super::{RunError, pictures};
use crate::deck::Deck;
use crate::driver::Driver;
use crate::mesh::{Facet, Mesh};
use crate::recovery::split;
use minijinja::value::Value;
use minijinja::{Environment, context};
use serde_json::{Map, json};
use std::path::Path;

/// Values of all frames that a page holds at most, so that it stays below some tens of megabytes.
const MOST_VALUES: usize = 8_000_000;

/// The page of a run. `last` is the end of the run where no file has it.
pub(super) fn report<const D: usize>(
    driver: &Driver<D>,
    deck: &Deck,
    directory: &Path,
    last: Option<&[Array]>,
) -> Result<String, RunError> {
    let history = Table::read(&directory.join("history.csv"), |_, _| true)?;
    let increment = history.texts("increment").last().copied().unwrap_or("0");
    let increment = increment.parse().unwrap_or(0);
    let contacts = pictures::contact_table(directory, &[increment])?;
    let resolved = read_text(&directory.join("deck.resolved.toml"))?;
    let run = read_text(&directory.join("run.json"))?;
    let run: serde_json::Value = serde_json::from_str(&run).unwrap_or_default();
    let text = |key: &str| run[key].as_str().unwrap_or_default().to_owned();
    let summary: Vec<[String; 2]> = summary(&run, deck);
    let page = context! {
        title => if deck.title.is_empty() { "moreau" } else { &deck.title },
        status => text("status"),
        error => text("error"),
        suggestion => run["diagnosis"]["suggestion"].as_str().unwrap_or_default(),
        summary => summary,
        expectations => expectations(&run),
        warnings => list(&run["warnings"]),
        certificate => certificate(&history, deck),
        deck => resolved,
        history => forces(&history, deck),
        contact => if D == 2 { tractions(&contacts, increment, deck) } else { None },
        // No name in it may end the script.
        data => viewer(driver, deck, directory, (increment, last))?.to_string().replace("</", "<\\/"),
    };
    let mut environment = Environment::new();
    let html = environment
        .add_template("report.html", include_str!("report.html"))
        .and_then(|()| environment.get_template("report.html")?.render(page));
    html.map_err(|error| RunError::Write {
        path: directory.join("report.html"),
        source: std::io::Error::other(error),
    })
}

fn list(value: &serde_json::Value) -> Vec<String> {
    let items = value.as_array().into_iter().flatten();
    items
        .filter_map(|v| v.as_str().map(str::to_owned))
        .collect()
}

fn summary(run: &serde_json::Value, deck: &Deck) -> Vec<[String; 2]> {
    let number = |v: &serde_json::Value| match v {
        serde_json::Value::Null => "–".to_owned(),
        v if v.is_f64() => format!("{:.4}", v.as_f64().unwrap_or(f64::NAN)),
        v => v.to_string(),
    };
    let small = |key: &str| {
        let value = run["certificate"][key].as_f64();
        value.map_or("–".to_owned(), |v| format!("{v:.2e}"))
    };
    let units = deck.units;
    let collapse = &run["collapse"];
    let collapse = [
        ("load factor at collapse", "load_factor"),
        ("its kinematic bound", "upper_bound"),
    ]
    .map(|(name, key)| (name, &collapse[key]))
    .into_iter()
    .filter(|(_, v)| v.is_number())
    .map(|(name, v)| [name.to_owned(), number(v)]);
    let mut rows: Vec<[String; 2]> = [
        ("increments", "increments"),
        ("Newton iterations", "newton_iterations"),
        ("contact iterations", "contact_iterations"),
        ("factorisations", "factorisations"),
        ("cuts", "cuts"),
        ("degrees of freedom", "dofs"),
        ("seconds", "seconds"),
        ("threads", "threads"),
        ("peak memory [MB]", "peak_memory_mb"),
    ]
    .map(|(name, key)| [name.to_owned(), number(&run[key])])
    .to_vec();
    rows.splice(0..0, collapse);
    for (name, key, unit) in [
        ("largest bipotential gap", "bipotential_gap", units.energy()),
        ("the same, over the external work", "relative_gap", "–"),
        ("largest penetration", "penetration", units.length()),
        (
            "largest force outside the cone",
            "excess_force",
            units.force(),
        ),
    ] {
        rows.push([format!("{name} [{unit}]"), small(key)]);
    }
    for (name, value) in run["values"].as_object().into_iter().flatten() {
        let unit = match name.starts_with("force.") {
            true => units.force(),
            false => units.length(),
        };
        let value = value.as_f64().unwrap_or(f64::NAN);
        rows.push([format!("{name} [{unit}]"), format!("{value:.8e}")]);
    }
    rows
}

fn expectations(run: &serde_json::Value) -> Vec<Value> {
    let row = |v: &serde_json::Value| {
        let number = |key: &str| v[key].as_f64().unwrap_or(f64::NAN);
        context! {
            column => v["column"].as_str().unwrap_or_default(),
            expected => format!("{:.8e}", number("expected")),
            tolerance => format!("{:.1e}", number("tolerance")),
            found => format!("{:.8e}", number("found")),
            passed => v["passed"] == true,
        }
    };
    let verdicts = run["expectations"].as_array().into_iter().flatten();
    verdicts.map(row).collect()
}

/// Header and rows of the certificate of every increment.
fn certificate(history: &Table, deck: &Deck) -> Value {
    let units = deck.units;
    let columns = [
        ("step", "step", ""),
        ("increment", "increment", ""),
        ("time", "time", ""),
        ("newton_iterations", "Newton", ""),
        ("contact_iterations", "contact", ""),
        ("cuts", "cuts", ""),
        ("open", "open", ""),
        ("stick", "stick", ""),
        ("slip", "slip", ""),
        ("plastic_fraction", "plastic", "–"),
        ("bipotential_gap", "gap", units.energy()),
        ("external_work", "external work", units.energy()),
        ("penetration", "penetration", units.length()),
        ("excess_force", "outside the cone", units.force()),
        ("out_of_balance", "out of balance", units.force()),
    ];
    let header = |&(_, name, unit): &(&str, &str, &str)| match unit {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    };
    let values: Vec<Vec<f64>> = columns.iter().map(|c| history.numbers(c.0)).collect();
    let show = |v: f64| match v.fract() == 0.0 && v.abs() < 1e9 {
        true => format!("{v}"),
        false if v.abs() >= 1e-3 && v.abs() < 1e6 => format!("{v:.4}"),
        false => format!("{v:.2e}"),
    };
    let rows: Vec<Vec<String>> = (0..values[0].len())
        .map(|row| values.iter().map(|c| show(c[row])).collect())
        .collect();
    context! {
        header => columns.iter().map(header).collect::<Vec<_>>(),
        rows => rows,
    }
}

/// What the viewer draws: nodes, faces and, for each frame, displacements and fields in 16 bits
/// between their extremes.
fn viewer<const D: usize>(
    driver: &Driver<D>,
    deck: &Deck,
    directory: &Path,
    (end, last): (usize, Option<&[Array]>),
) -> Result<serde_json::Value, RunError> {
    let all = bodies(directory);
    let mesh = driver.mesh();
    let (points, cells) = split(mesh, driver.materials());
    let per_frame = points.len() * (D + 9);
    let stride = (all.len() * per_frame).div_ceil(MOST_VALUES).max(1);
    let mut frames = Vec::new();
    let mut largest = 0.0f64;
    let mut names: Vec<String> = Vec::new();
    let mut add = |label: String, arrays: &[Array]| {
        let fits = |a: &Array| a.values.len() == a.components * points.len();
        if !arrays.iter().all(fits) {
            return;
        }
        let mut values = Map::new();
        for name in fields(arrays) {
            // What is always zero in the plane.
            let out_of_plane = ["displacement.z", "stress.yz", "stress.xz"];
            if D == 2 && out_of_plane.contains(&name.as_str()) {
                continue;
            }
            let v = field(arrays, &name).unwrap_or_default();
            if name.starts_with("displacement.") {
                largest = v.iter().fold(largest, |m, v| m.max(v.abs()));
            }
            values.insert(name, packed(&v));
        }
        for name in values.keys() {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        frames.push(json!({ "label": label, "values": values }));
    };
    let count = all.len();
    let mut increments = Vec::new();
    for (k, (number, time, path)) in all.into_iter().enumerate() {
        // The last frame is always there.
        if (count - 1 - k).is_multiple_of(stride) {
            let arrays = read_point_data(&path)?;
            increments.push(number);
            add(format!("increment {number}, time {time:.4}"), &arrays);
        }
    }
    if let (0, Some(arrays)) = (count, last) {
        increments.push(end);
        add("end".into(), arrays);
    }
    let labels: Map<String, serde_json::Value> = names
        .iter()
        .map(|n| (n.clone(), label(n, deck.units).into()))
        .collect();
    Ok(json!({
        "dimension": D,
        "nodes": (0..D).map(|i| packed(&points.iter().map(|&n| mesh.nodes()[n][i]).collect::<Vec<_>>()))
            .collect::<Vec<_>>(),
        "faces": faces(mesh, &cells),
        "fields": names,
        "labels": labels,
        "usual": usual_field(deck),
        "magnification": usual_magnification(mesh.size(), largest),
        "colours": crate::plot::colours(),
        "length": deck.units.length(),
        "frames": frames,
        "contact": if D == 2 { contact(deck, directory, &increments)? } else { json!(null) },
    }))
}

/// Tractions along the contact surfaces in every frame; null without contact.
fn contact(
    deck: &Deck,
    directory: &Path,
    increments: &[usize],
) -> Result<serde_json::Value, RunError> {
    let table = pictures::contact_table(directory, increments)?;
    let axis = contact_axis(&table);
    let frame = |&increment: &usize| contact_lines(&table, increment, axis);
    let frames: Vec<Vec<ContactLine>> = increments.iter().map(frame).collect();
    // The points of a surface are the same in all frames.
    let Some(first) = frames.first().filter(|lines| !lines.is_empty()) else {
        return Ok(json!(null));
    };
    let surface = |line: &ContactLine| json!({ "name": line.name, "at": packed(&line.at) });
    let values = |line: &ContactLine| line.tractions.each_ref().map(|v| packed(v));
    let values = |lines: &Vec<ContactLine>| lines.iter().map(values).collect::<Vec<_>>();
    Ok(json!({
        "labels": contact_labels(axis, deck.units),
        "tractions": TRACTIONS,
        "surfaces": first.iter().map(surface).collect::<Vec<_>>(),
        "frames": frames.iter().map(values).collect::<Vec<_>>(),
    }))
}

/// Numbers in 16 bits each between the least and the largest, as base64; a number that is not
/// finite is the last code.
fn packed(values: &[f64]) -> serde_json::Value {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
    let scale = if high > low {
        65534.0 / (high - low)
    } else {
        0.0
    };
    let code = |v: &f64| match v.is_finite() {
        true => ((v - low) * scale).round() as u16,
        false => u16::MAX,
    };
    let bytes: Vec<u8> = values.iter().flat_map(|v| code(v).to_le_bytes()).collect();
    json!({ "low": low, "high": high, "data": base64(&bytes) })
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let bits = (byte(0) << 16) | (byte(1) << 8) | byte(2);
        for k in 0..4 {
            match k <= three.len() {
                true => text.push(char::from(DIGITS[(bits >> (18 - 6 * k)) as usize & 63])),
                false => text.push('='),
            }
        }
    }
    text
}

/// What is seen of the cells, by their points: in the plane all of them, in space those of their facets that belong
/// to one cell only. Nodes around each face, mid-side nodes between their corners, and the node in
/// its middle after them if it has one.
fn faces<const D: usize>(mesh: &Mesh<D>, cells: &[Vec<usize>]) -> Vec<Vec<usize>> {
    if D == 2 {
        let face = |cell: usize| {
            let nodes = &cells[cell];
            let mut face: Vec<usize> = Vec::new();
            for facet in mesh.kind(cell).facets() {
                face.push(nodes[facet[0]]);
                face.extend(facet.get(2).map(|&m| nodes[m]));
            }
            face.extend(nodes.get(face.len()));
            face
        };
        return (0..mesh.cell_count()).map(face).collect();
    }
    let face = |facet: Facet| {
        let own = mesh.kind(facet.cell).facets()[facet.facet].iter();
        let nodes: Vec<usize> = own.map(|&k| cells[facet.cell][k]).collect();
        let corners = if nodes.len().is_multiple_of(3) && nodes.len() < 9 {
            3
        } else {
            4
        };
        let mut face: Vec<usize> = Vec::new();
        for k in 0..corners {
            face.push(nodes[k]);
            face.extend(nodes.get(corners + k));
        }
        face.extend(nodes.get(2 * corners));
        face
    };
    mesh.boundary_facets().into_iter().map(face).collect()
}

#[cfg(test)]
mod tests {
    use super::base64;

    #[test]
    fn base64_of_the_standard() {
        // RFC 4648, section 10.
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }
}
