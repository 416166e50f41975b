//! `[[tool]]` and `[[contact]]`: surfaces and pairs as they are given.

use crate::deck::entries::{
    Adjust, Analysis, ContactEntry, FrictionEntry, Shape, SkinEntry, TieEntry, ToolEntry,
};
use crate::deck::finding::{At, Class};
use crate::deck::grammar::material::row;
use crate::deck::reader::{self, Table, Value};
use crate::files::read_skin;
use toml::de::DeTable;

const SHAPES: [&str; 6] = [
    "plane", "cylinder", "sphere", "polyline", "profile", "surface",
];

/// Angle between triangles above which their edge is sharp \[degrees\].
const SHARP: f64 = 30.0;

/// The tools, and the names of all of them.
pub(super) fn read_tools(root: &Table<'_>, analysis: Analysis) -> (Vec<ToolEntry>, Vec<String>) {
    let mut names = Vec::new();
    let tools = root
        .tables("tool", "[[tool]]")
        .into_iter()
        .filter_map(|table| {
            let name = table.name("name");
            names.extend(name.iter().map(|n| n.value.clone()));
            let shape = shape(&table, analysis);
            let reference = table.get("reference").and_then(|value| {
                reader::vector(value, "reference", analysis.dimension(), table.log())
            });
            table.finish();
            Some(ToolEntry {
                name: name?,
                shape: shape?,
                reference,
            })
        })
        .collect();
    (tools, names)
}

fn shape(table: &Table<'_>, analysis: Analysis) -> Option<At<Shape>> {
    let log = table.log();
    let dimension = analysis.dimension();
    let inside = table.boolean_if("inside");
    let hollow = inside.as_ref().is_some_and(|i| i.value);
    let given = table.given(&SHAPES);
    let [(key, value)] = given[..] else {
        log.borrow_mut().error(
            &table.span,
            format!(
                "a [[tool]] has {} surfaces, expected one of {}",
                given.len(),
                SHAPES.join(", ")
            ),
            "one surface a tool",
        );
        return None;
    };
    let sided = ["cylinder", "sphere", "surface"].contains(&key);
    if let Some(inside) = inside.filter(|i| i.value && !sided) {
        log.borrow_mut().error(
            &inside.span,
            format!("a {key} has no inside"),
            match key {
                "plane" => "turn the normal round instead",
                _ => "reverse the order of the points instead",
            },
        );
    }
    let lines = key == "polyline" || key == "profile";
    if lines && dimension == 3 {
        return reader::wrong(value, key, "a tool of a plane analysis", log);
    }
    if key == "polyline" {
        let points = points(value, key, log)?;
        return Some(At::new(Shape::Polyline(points, Vec::new()), value.span()));
    }
    if key == "surface" && dimension == 2 {
        return reader::wrong(value, key, "a tool of analysis = \"solid\"", log);
    }
    let inner = reader::table(value, key, key, log)?;
    if key == "surface" {
        let entry = skin(&inner, hollow);
        inner.finish();
        return Some(At::new(Shape::Triangles(entry?), value.span()));
    }
    if key == "profile" {
        let shape = profile(&inner);
        inner.finish();
        return Some(At::new(shape?, value.span()));
    }
    let vector = |key: &'static str| {
        let value = inner.need(key, "[ … ]")?;
        reader::vector(value, key, dimension, log)
    };
    let shape = if key == "plane" {
        let (point, normal) = (vector("point"), vector("normal"));
        Shape::Plane(point?.value, normal?.value)
    } else if key == "cylinder" && dimension == 3 {
        let (center, axis, radius) = (vector("center"), vector("axis"), inner.number("radius"));
        Shape::Cylinder(center?.value, axis?.value, radius?.value, hollow)
    } else {
        let (center, radius) = (vector("center"), inner.number("radius"));
        if key == "sphere" && dimension == 2 {
            let on_axis = center.as_ref().is_some_and(|c| c.value[0] == 0.0);
            if analysis != Analysis::Axisymmetric || !on_axis {
                log.borrow_mut().error_with(
                    &value.span(),
                    "a sphere needs analysis = \"solid\", or \"axisymmetric\" with its center on \
                     the axis x = 0",
                    "not a sphere in this analysis",
                    "in the plane a circle is a cylinder",
                );
                return None;
            }
        }
        Shape::Ball(center?.value, radius?.value, hollow, key)
    };
    inner.finish();
    Some(At::new(shape, value.span()))
}

/// `{ file = "…", group = "…", sharp = 30 }`, and what is in the file.
fn skin(table: &Table<'_>, hollow: bool) -> Option<SkinEntry> {
    let log = table.log();
    let file = table.text("file");
    let group = table.get("group");
    let group = group.and_then(|v| reader::text(v, "group", log));
    let sharp = table.number_if("sharp").map_or(SHARP, |s| s.value);
    let file = file?;
    let path = log.path(&file);
    if let Some(group) = group.as_ref().filter(|_| !file.value.ends_with(".msh")) {
        let message = "only a file of Gmsh has groups: of others all is the surface";
        log.borrow_mut()
            .error(&group.span, message, "no group here");
        return None;
    }
    match read_skin(&path, group.as_ref().map(|g| g.value.as_str())) {
        Ok(skin) => Some(SkinEntry {
            file: path,
            group: group.map(|g| g.value),
            sharp,
            hollow,
            skin,
        }),
        Err(error) => {
            let mut log = log.borrow_mut();
            let message = error.to_string();
            match error.help() {
                Some(help) => log.error_with(&file.span, message, "this file", help),
                None => log.error(&file.span, message, "this file"),
            };
            None
        }
    }
}

/// `[[x, y], …]`.
fn points(value: reader::Value<'_>, key: &str, log: &reader::Log) -> Option<Vec<[f64; 2]>> {
    let point = |value| {
        let point = reader::vector(value, "a point", 2, log)?;
        Some([point.value[0], point.value[1]])
    };
    let points = reader::items(value, key, "[[x, y], …]", log)?.into_iter();
    points.map(point).collect()
}

/// `{ points = [[x, y], …], radii = [r, …] }`, a radius for each corner; ends may be given one of zero.
fn profile(table: &Table<'_>) -> Option<Shape> {
    let log = table.log();
    let points = points(table.need("points", "[[x, y], …]")?, "points", log);
    let given = table.need("radii", "[r, …]")?;
    let radii = reader::items(given, "radii", "[r, …]", log)?.into_iter();
    let mut radii: Vec<f64> = radii
        .map(|r| reader::number(r, "a radius", log).map(|r| r.value))
        .collect::<Option<_>>()?;
    let points = points?;
    if let [0.0, corners @ .., 0.0] = &radii[..]
        && radii.len() == points.len()
    {
        radii = corners.to_vec();
    }
    let corners = points.len().saturating_sub(2);
    if radii.len() != corners {
        let expected = format!("{corners} radii, one for each corner between the ends");
        return reader::wrong(given, "radii", &expected, log);
    }
    Some(Shape::Polyline(points, radii))
}

pub(super) fn read_contacts(root: &Table<'_>, dimension: usize) -> Vec<ContactEntry> {
    root.tables("contact", "[[contact]]")
        .into_iter()
        .filter_map(|table| {
            let parts = table.texts("surface", "a group of facets, or an array of them");
            let against = table.text("against");
            let friction = friction(&table, dimension);
            let gap_offset = table.number_if("gap-offset");
            let adjust = adjust(&table);
            table.finish();
            let parts = parts?;
            Some(ContactEntry {
                surface: whole(&parts)?,
                parts,
                against: against?,
                // A stand-in for what was refused, so that the names are still looked up.
                friction: friction.unwrap_or(FrictionEntry::Coulomb(At::new(1.0, 0..0))),
                gap_offset,
                adjust,
            })
        })
        .collect()
}

pub(super) fn read_ties(root: &Table<'_>) -> Vec<TieEntry> {
    let read = |table: Table<'_>| {
        let parts = table.texts("surface", "a group of facets, or an array of them");
        let to = table.text("to");
        table.finish();
        let parts = parts?;
        Some(TieEntry {
            surface: whole(&parts)?,
            parts,
            to: to?,
        })
    };
    let tables = root.tables("tie", "[[tie]]").into_iter();
    tables.filter_map(read).collect()
}

/// The name of a surface of these parts.
fn whole(parts: &[At<String>]) -> Option<At<String>> {
    let names: Vec<&str> = parts.iter().map(|p| p.value.as_str()).collect();
    Some(At::new(names.join("+"), parts.first()?.span.clone()))
}

/// `adjust = true`, or a distance.
fn adjust(table: &Table<'_>) -> Option<At<Adjust>> {
    let log = table.log();
    let value = table.get("adjust")?;
    let adjust = match value.get_ref().as_bool() {
        Some(false) => return None,
        Some(true) => Adjust::Near,
        None => {
            let within = reader::number(value, "adjust", log)?.value;
            if within < 0.0 {
                return reader::wrong(value, "adjust", "true, or a distance ≥ 0", log);
            }
            Adjust::Within(within)
        }
    };
    Some(At::new(adjust, value.span()))
}

fn friction(table: &Table<'_>, dimension: usize) -> Option<FrictionEntry> {
    let log = table.log();
    let value = table.need("friction", "a number (0 for none)")?;
    if value.get_ref().is_array() {
        let expected = "a number, or in a solid { coulomb = [along, across], axis = [x, y, z] }";
        return reader::wrong(value, "friction", expected, log);
    }
    if !value.get_ref().is_table() {
        return reader::number(value, "friction", log).map(FrictionEntry::Coulomb);
    }
    let angle = |table: &DeTable<'_>| ["angle", "phi"].iter().any(|key| table.contains_key(*key));
    if value.get_ref().as_table().is_some_and(angle) {
        let message = "friction has an angle, expected coulomb, the tangent of that";
        let label = "10° are a coulomb of 0.176";
        let mut findings = log.borrow_mut();
        findings
            .error(&value.span(), message, label)
            .about(Class::Keys);
        return None;
    }
    let inner = reader::table(value, "friction", "friction", log)?;
    let axis = inner.get("axis");
    let two = inner.get("coulomb").filter(|v| v.get_ref().is_array());
    if let Some(value) = inner.get("table") {
        let law = shear_table(&inner, value);
        inner.finish();
        return law;
    }
    let law = match inner.number_if("tresca") {
        Some(limit) => Some(FrictionEntry::Tresca(limit)),
        None if two.is_some() || axis.is_some() => orthotropic(&inner, dimension),
        None => match (inner.number("coulomb"), inner.number_if("tau-max")) {
            (Some(mu), Some(limit)) => Some(FrictionEntry::Limited(mu, limit)),
            (mu, _) => mu.map(FrictionEntry::Coulomb),
        },
    };
    if matches!(law, Some(FrictionEntry::Tresca(_))) {
        for key in ["coulomb", "tau-max", "axis"] {
            if let Some(value) = inner.get(key) {
                log.borrow_mut().error(
                    &value.span(),
                    format!("friction has tresca and {key}, expected one law"),
                    "a limit of Coulomb friction is tau-max, tresca stands alone",
                );
            }
        }
    }
    inner.finish();
    law
}

/// `{ table = [[pressure, shear], …] }`.
fn shear_table(table: &Table<'_>, value: Value<'_>) -> Option<FrictionEntry> {
    let log = table.log();
    for key in ["coulomb", "tau-max", "tresca", "axis"] {
        if let Some(value) = table.get(key) {
            log.borrow_mut().error(
                &value.span(),
                format!("friction has table and {key}, expected one law"),
                "a table is the whole bound of the shear",
            );
        }
    }
    let rows = reader::items(value, "table", "an array of [pressure, shear]", log)?;
    let rows = rows
        .into_iter()
        .map(|r| row(r, "a row of the table", "[pressure, shear]", log));
    let rows = rows.collect::<Option<Vec<_>>>()?;
    Some(FrictionEntry::Table(At::new(rows, value.span())))
}

/// `{ coulomb = [μ along, μ across], axis = [x, y, z] }`.
fn orthotropic(table: &Table<'_>, dimension: usize) -> Option<FrictionEntry> {
    let log = table.log();
    if dimension == 2 {
        log.borrow_mut().error(
            &table.span,
            "friction along two directions needs analysis = \"solid\": in the plane there is one",
            "expected one coefficient",
        );
        return None;
    }
    if let Some(limit) = table.get("tau-max") {
        log.borrow_mut().error(
            &limit.span(),
            "tau-max limits friction of one coefficient, not of two",
            "no limit here",
        );
    }
    let expected = "[along the axis, across]";
    let mu = reader::vector(table.need("coulomb", expected)?, "coulomb", 2, log);
    let axis = reader::vector(table.need("axis", "[x, y, z]")?, "axis", dimension, log)?;
    let mu = mu?;
    let pair = [mu.value[0], mu.value[1]];
    Some(FrictionEntry::Orthotropic(At::new(pair, mu.span), axis))
}
