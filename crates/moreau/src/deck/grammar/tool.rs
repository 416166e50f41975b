//! `[[tool]]` and `[[contact]]`: surfaces and pairs as they are given.

use super::not_yet;
use crate::deck::entries::{Analysis, ContactEntry, FrictionEntry, Shape, ToolEntry};
use crate::deck::finding::At;
use crate::deck::reader::{self, Table};

const SHAPES: [&str; 4] = ["plane", "cylinder", "sphere", "polyline"];

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
            table.finish();
            Some(ToolEntry {
                name: name?,
                shape: shape?,
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
    let given: Vec<_> = SHAPES
        .iter()
        .filter_map(|key| Some((*key, table.get(key)?)))
        .collect();
    let [(key, value)] = given[..] else {
        log.borrow_mut().error(
            &table.span,
            format!(
                "a [[tool]] has {} surfaces, expected one of plane, cylinder, sphere",
                given.len()
            ),
            "one surface a tool",
        );
        return None;
    };
    if key == "polyline" {
        let instead = "use plane, cylinder or sphere";
        not_yet(log, &value.span(), "tools of polylines", instead);
        return None;
    }
    let inner = reader::table(value, key, key, log)?;
    let vector = |key: &'static str| {
        let value = inner.need(key, "[ … ]")?;
        reader::vector(value, key, dimension, log)
    };
    let shape = if key == "plane" {
        let (point, normal) = (vector("point"), vector("normal"));
        if let Some(inside) = inside.filter(|i| i.value) {
            log.borrow_mut().error(
                &inside.span,
                "a plane has no inside",
                "turn the normal round instead",
            );
        }
        Shape::Plane(point?.value, normal?.value)
    } else {
        let (center, radius) = (vector("center"), inner.number("radius"));
        if key == "cylinder" && dimension == 3 {
            let instead = "use a sphere or a plane";
            not_yet(log, &value.span(), "cylinders in a solid analysis", instead);
            return None;
        }
        if key == "sphere" && dimension == 2 {
            let on_axis = center.as_ref().is_some_and(|c| c.value[0] == 0.0);
            if analysis != Analysis::Axisymmetric || !on_axis {
                log.borrow_mut().error_with(
                    &value.span(),
                    "a sphere needs analysis = \"solid\", or \"axisymmetric\" with its center on \
                     the axis x = 0",
                    "not a sphere in this analysis",
                    "in plane strain a circle is a cylinder",
                );
                return None;
            }
        }
        Shape::Ball(center?.value, radius?.value, hollow, key)
    };
    inner.finish();
    Some(At::new(shape, value.span()))
}

pub(super) fn read_contacts(root: &Table<'_>) -> Vec<ContactEntry> {
    root.tables("contact", "[[contact]]")
        .into_iter()
        .filter_map(|table| {
            let log = table.log();
            let surface = table.text("surface");
            let against = table.text("against");
            let friction = friction(&table);
            for key in ["gap-offset", "adjust"] {
                if let Some(value) = table.get(key) {
                    let instead = "let the geometry touch, or move the tool in a first step";
                    not_yet(log, &value.span(), &format!("{key} of a contact"), instead);
                }
            }
            table.finish();
            Some(ContactEntry {
                surface: surface?,
                against: against?,
                // A stand-in for what was refused, so that the names are still looked up.
                friction: friction.unwrap_or(FrictionEntry::Coulomb(At::new(1.0, 0..0))),
            })
        })
        .collect()
}

fn friction(table: &Table<'_>) -> Option<FrictionEntry> {
    let log = table.log();
    let value = table.need("friction", "a number (0 for none)")?;
    if !value.get_ref().is_table() {
        return reader::number(value, "friction", log).map(FrictionEntry::Coulomb);
    }
    let inner = reader::table(value, "friction", "friction", log)?;
    let law = match inner.number_if("tresca") {
        Some(limit) => Some(FrictionEntry::Tresca(limit)),
        None => match (inner.number("coulomb"), inner.number_if("tau-max")) {
            (Some(mu), Some(limit)) => Some(FrictionEntry::Limited(mu, limit)),
            (mu, _) => mu.map(FrictionEntry::Coulomb),
        },
    };
    if matches!(law, Some(FrictionEntry::Tresca(_))) {
        for key in ["coulomb", "tau-max"] {
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
