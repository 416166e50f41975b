//! What the report draws by itself in a browser: the body and its contacts in every frame, as numbers;
//! the drawing is in `report.html`.

use crate::deck::Deck;
use crate::driver::{Driver, points_by_material};
use crate::grids;
use crate::laws::Status;
use crate::mesh::{Facet, Mesh};
use crate::plot::{Chart, Series};
use crate::run::RunError;
use crate::run::files::contact_table;
use crate::run::vtu::{bodies, read_point_data};
use crate::simulation::pictures::{
    ContactLine, TRACTIONS, contact_labels, contact_lines, field, fields, foremost, label,
    usual_field, usual_magnification,
};
use crate::simulation::status_name;
use crate::vtu::Array;
use serde_json::{Map, json};
use std::collections::BTreeSet;
use std::path::Path;

/// Values of all frames that a page holds at most, so that it stays below some tens of megabytes.
const MOST_VALUES: usize = 8_000_000;

/// What the viewer draws: nodes, faces and, for each frame, displacements and fields in 16 bits
/// between their extremes.
pub(super) fn viewer<const D: usize>(
    driver: &Driver<D>,
    deck: &Deck,
    directory: &Path,
    history: Option<&Chart>,
    (end, last): (usize, Option<&[Array]>),
) -> Result<serde_json::Value, RunError> {
    let all = bodies(directory);
    let mesh = driver.mesh();
    let (points, cells) = points_by_material(mesh, driver.materials());
    let of_laws = driver.fields().into_iter().chain(driver.temperatures());
    let of_laws: usize = of_laws.map(|f| f.components).sum();
    let per_frame = points.len() * (D + 9 + of_laws);
    let stride = (all.len() * per_frame).div_ceil(MOST_VALUES).max(1);
    let mut frames = Vec::new();
    let mut largest = 0.0f64;
    let mut names: Vec<String> = Vec::new();
    let mut add = |label: String, time: Option<f64>, arrays: &[Array]| {
        let fits = |a: &Array| a.values.len() == a.components * points.len();
        if !arrays.iter().all(fits) {
            return;
        }
        let mut values = Map::new();
        for name in fields(arrays) {
            // What is always zero in the plane.
            let out_of_plane = ["displacement.z", "stress.yz", "stress.xz"];
            if D == 2 && out_of_plane.iter().any(|&none| name.ends_with(none)) {
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
        frames.push(json!({ "label": label, "time": time, "values": values }));
    };
    let count = all.len();
    let mut increments = Vec::new();
    for (k, (number, time, path)) in all.into_iter().enumerate() {
        // The last frame is always there.
        if (count - 1 - k).is_multiple_of(stride) {
            let arrays = read_point_data(&path)?;
            increments.push(number);
            add(
                format!("increment {number}, time {time:.4}"),
                Some(time),
                &arrays,
            );
        }
    }
    if let (0, Some(arrays)) = (count, last) {
        increments.push(end);
        add("end".into(), None, arrays);
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
        "magnification": usual_magnification(deck, mesh.size(), largest),
        "colours": crate::plot::colours(),
        "length": deck.units.length(),
        "frames": frames,
        "tools": tools(driver, deck, directory, &increments),
        "history": history.map(chart),
        "contact": match D {
            2 => contact_line(deck, directory, &increments)?,
            _ => contact_surface(mesh, deck, directory, (&points, &cells), &increments)?,
        },
    }))
}

/// The labels and the series of a chart.
fn chart(chart: &Chart) -> serde_json::Value {
    let series = |s: &Series| {
        let axis = |k: usize| packed(&s.points.iter().map(|p| p[k]).collect::<Vec<_>>());
        json!({ "name": s.name, "at": axis(0), "values": axis(1) })
    };
    json!({
        "labels": [chart.x.label, chart.y.label],
        "series": chart.series.iter().map(series).collect::<Vec<_>>(),
    })
}

/// The surfaces of the tools where they were at first, and how far their points have gone in every frame; null without
/// tools.
fn tools<const D: usize>(
    driver: &Driver<D>,
    deck: &Deck,
    directory: &Path,
    increments: &[usize],
) -> serde_json::Value {
    let Some(grid) = grids::tools(driver, deck) else {
        return json!(null);
    };
    let displacement = |arrays: &[Array]| arrays.iter().find(|a| a.name == "displacement").cloned();
    let Some(now) = displacement(&grid.point_data) else {
        return json!(null);
    };
    let axis = |array: &Array, i: usize| -> Vec<f64> {
        array.values.iter().skip(i).step_by(3).copied().collect()
    };
    let first = |i: usize| -> Vec<f64> {
        let moved = axis(&now, i).into_iter().zip(&grid.points);
        let large = f64::from(u8::from(driver.has_large_strains()));
        moved.map(|(u, x)| x[i] - large * u).collect()
    };
    let frame = |&increment: &usize| {
        let path = directory.join(format!("tools_{increment:05}.vtu"));
        let read = read_point_data(&path)
            .ok()
            .and_then(|arrays| displacement(&arrays));
        let array = read.unwrap_or_else(|| now.clone());
        (0..D).map(|i| packed(&axis(&array, i))).collect::<Vec<_>>()
    };
    json!({
        "nodes": (0..D).map(|i| packed(&first(i))).collect::<Vec<_>>(),
        "pieces": grid.cells.iter().map(|(nodes, _)| nodes).collect::<Vec<_>>(),
        "frames": increments.iter().map(frame).collect::<Vec<_>>(),
    })
}

/// Tractions along the contact surfaces of a plane body in every frame; null without contact.
fn contact_line(
    deck: &Deck,
    directory: &Path,
    increments: &[usize],
) -> Result<serde_json::Value, RunError> {
    let table = contact_table(directory, increments)?;
    let frame = |&increment: &usize| contact_lines(&table, increment);
    let frames: Vec<Vec<ContactLine>> = increments.iter().map(frame).collect();
    // The points of a surface are the same in all frames.
    let Some(first) = frames.first().filter(|lines| !lines.is_empty()) else {
        return Ok(json!(null));
    };
    let surface = |line: &ContactLine| json!({ "name": line.name, "at": packed(&line.at) });
    let values = |line: &ContactLine| line.tractions.each_ref().map(|v| packed(v));
    let values = |lines: &Vec<ContactLine>| lines.iter().map(values).collect::<Vec<_>>();
    Ok(json!({
        "labels": contact_labels(deck.units),
        "tractions": TRACTIONS,
        "surfaces": first.iter().map(surface).collect::<Vec<_>>(),
        "frames": frames.iter().map(values).collect::<Vec<_>>(),
    }))
}

/// Fields on the contact surfaces of a body in space in every frame: facets by their points, and values
/// at those that have a contact; null without contact.
fn contact_surface<const D: usize>(
    mesh: &Mesh<D>,
    deck: &Deck,
    directory: &Path,
    (points, cells): (&[usize], &[Vec<usize>]),
    increments: &[usize],
) -> Result<serde_json::Value, RunError> {
    let table = contact_table(directory, increments)?;
    let surfaces: BTreeSet<&str> = table.texts("contact").into_iter().collect();
    let facets = surfaces
        .iter()
        .filter_map(|name| mesh.facet_group(name).ok());
    let faces: Vec<Vec<usize>> = facets.flatten().map(|&f| face(mesh, cells, f)).collect();
    if faces.is_empty() {
        return Ok(json!(null));
    }
    let node = table.numbers("node");
    let touching: BTreeSet<usize> = node.iter().map(|&n| n as usize).collect();
    let seen: BTreeSet<usize> = faces.iter().flatten().copied().collect();
    let seen: Vec<usize> = seen
        .into_iter()
        .filter(|&p| touching.contains(&points[p]))
        .collect();
    let [pressure, t_1, t_2, gap] = ["p_n", "p_1", "p_2", "gap"].map(|name| table.numbers(name));
    let shear: Vec<f64> = t_1.iter().zip(&t_2).map(|(a, b)| a.hypot(*b)).collect();
    let status = table.texts("status");
    let mut statuses = [Status::Open, Status::Stick, Status::Slip]
        .map(status_name)
        .to_vec();
    let tied = status_name(Status::Tied);
    statuses.extend(status.contains(&tied).then_some(tied));
    let status: Vec<f64> = status
        .iter()
        .map(|name| {
            statuses
                .iter()
                .position(|s| s == name)
                .map_or(f64::NAN, |k| k as f64)
        })
        .collect();
    let rows = table.numbers("increment");
    let frame = |increment: &usize| {
        let own = (0..rows.len()).filter(|&k| rows[k] == *increment as f64);
        let row = foremost(own, &node, &pressure);
        let values = |column: &[f64]| {
            let at = |p: &usize| row.get(&points[*p]).map_or(f64::NAN, |&k| column[k]);
            packed(&seen.iter().map(at).collect::<Vec<_>>())
        };
        json!({
            "pressure": values(&pressure),
            "shear": values(&shear),
            "gap": values(&gap),
            "status": values(&status),
        })
    };
    let (stress, length) = (deck.units.stress(), deck.units.length());
    Ok(json!({
        "faces": faces,
        "points": seen,
        "fields": ["pressure", "shear", "gap", "status"],
        "labels": {
            "pressure": format!("contact pressure [{stress}]"),
            "shear": format!("contact shear [{stress}]"),
            "gap": format!("gap [{length}]"),
            "status": "status",
        },
        "statuses": statuses,
        "usual": "pressure",
        "frames": increments.iter().map(frame).collect::<Vec<_>>(),
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
    let boundary = mesh.boundary_facets().into_iter();
    boundary.map(|facet| face(mesh, cells, facet)).collect()
}

/// The points around a facet of a body in space, as [`faces`] has them.
fn face<const D: usize>(mesh: &Mesh<D>, cells: &[Vec<usize>], facet: Facet) -> Vec<usize> {
    let own = mesh.kind(facet.cell).facets()[facet.facet].iter();
    let nodes: Vec<usize> = own.map(|&k| cells[facet.cell][k]).collect();
    let corners = mesh.facet_kind(facet).corner_count();
    let mut face: Vec<usize> = Vec::new();
    for k in 0..corners {
        face.push(nodes[k]);
        face.extend(nodes.get(corners + k));
    }
    face.extend(nodes.get(2 * corners));
    face
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
