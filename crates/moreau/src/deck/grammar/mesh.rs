//! `[mesh]`, `[[mesh.part]]`, `[[mesh.block]]` and `[[mesh.group]]`; no mesh is made here.

use super::step::turn as turn_of;
use crate::deck::entries::{BlockEntry, FileEntry, Grid, GroupEntry, Part, TurnEntry};
use crate::deck::finding::{At, Class};
use crate::deck::reader::{self, Log, Table, Value};
use crate::mesh::CellKind;
use std::ops::Range;

/// Most cells of all blocks together that a deck may ask for.
const MOST_CELLS: f64 = 2e6;

const PLANE: [&str; 5] = ["tri3", "tri6", "quad4", "quad8", "quad9"];
const SOLID: [&str; 5] = ["tet4", "tet10", "hex8", "hex20", "hex27"];
const AXES: [&str; 3] = ["x", "y", "z"];

/// What a deck says of its mesh.
#[derive(Default)]
pub(super) struct MeshEntries {
    pub(super) files: Vec<FileEntry>,
    pub(super) blocks: Vec<BlockEntry>,
    pub(super) groups: Vec<GroupEntry>,
}

pub(super) fn read(root: &Table<'_>, dimension: usize) -> MeshEntries {
    let log = root.log();
    let Some(value) = root.need("mesh", "{ file = \"…\" }, or [[mesh.block]]") else {
        return MeshEntries::default();
    };
    let Some(mesh) = reader::table(value, "mesh", "[mesh]", log) else {
        return MeshEntries::default();
    };
    let file = mesh.get("file");
    let plain = file.and_then(|v| path(v, dimension, log));
    let parts = mesh.tables("part", "[[mesh.part]]").into_iter();
    let parts = parts.filter_map(|t| part(t, dimension));
    let files = plain.into_iter().chain(parts).collect();
    let given = ["block", "part"].iter().any(|key| mesh.get(key).is_some());
    let blocks: Vec<BlockEntry> = mesh
        .tables("block", "[[mesh.block]]")
        .into_iter()
        .filter_map(|t| block(t, dimension))
        .collect();
    let groups = mesh
        .tables("group", "[[mesh.group]]")
        .into_iter()
        .filter_map(|t| group(t, dimension))
        .collect();
    if !given && file.is_none() {
        log.borrow_mut().error(
            &mesh.span,
            "the mesh has neither a file nor a [[mesh.block]] nor a [[mesh.part]], expected at least one of them",
            "file = \"…\", [[mesh.block]] or [[mesh.part]] is missing",
        );
    }
    let cells = |b: &BlockEntry| {
        b.grid
            .iter()
            .map(|g| g.value.cells() as f64)
            .product::<f64>()
    };
    let total: f64 = blocks.iter().map(cells).sum();
    if total > MOST_CELLS {
        log.borrow_mut()
            .error(
                &mesh.span,
                format!("the blocks have {total:.0} cells, expected at most {MOST_CELLS:.0}"),
                "too many cells",
            )
            .about(Class::Meshes);
    }
    mesh.finish();
    MeshEntries {
        files,
        blocks,
        groups,
    }
}

/// A file that is taken as it is.
fn path(value: Value<'_>, dimension: usize, log: &Log) -> Option<FileEntry> {
    let given = reader::text(value, "file", log)?;
    let file = At::new(log.path(&given), given.span);
    Some(FileEntry::plain(file, dimension))
}

fn part(table: Table<'_>, dimension: usize) -> Option<FileEntry> {
    let log = table.log();
    let file = table.need("file", "\"…\"");
    let plain = file.and_then(|v| path(v, dimension, log));
    let name = table.get("name").map(|_| table.name("name"));
    let scale = table.number_if("scale");
    if let Some(scale) = scale.as_ref().filter(|s| s.value <= 0.0) {
        let message = format!("scale is {}, expected a positive number", scale.value);
        log.borrow_mut().error(
            &scale.span,
            message,
            "of another sign: a part is not mirrored",
        );
    }
    let turn = table.get("turn");
    let turn = turn.map(|v| (turn_of(v, dimension, log), v.span()));
    let position = table.get("position");
    let position = position.map(|v| reader::vector(v, "position", dimension, log));
    table.finish();
    let plain = plain?;
    Some(FileEntry {
        name: name.map_or(Some(None), |name| name.map(Some))?,
        scale: scale.map_or(1.0, |s| s.value),
        turn: match turn {
            Some((turn, span)) => Some(about_an_axis(turn?, &span, log)?),
            None => None,
        },
        position: match position {
            Some(position) => position?.value,
            None => plain.position,
        },
        ..plain
    })
}

fn about_an_axis(turn: TurnEntry, span: &Range<usize>, log: &Log) -> Option<TurnEntry> {
    if turn.rotation().is_some() {
        return Some(turn);
    }
    let message = "turn has an axis of no length, expected a direction";
    log.borrow_mut().error(span, message, "no direction");
    None
}

fn block(table: Table<'_>, dimension: usize) -> Option<BlockEntry> {
    let log = table.log();
    let name = table.name("name");
    let element = element(&table, dimension);
    let cells = table.get("cells");
    let counts = cells.and_then(|value| {
        let list: Option<Vec<At<usize>>> = reader::items(value, "cells", "integers", log)?
            .into_iter()
            .map(|v| reader::integer(v, "cells", 0..=1_000_000, log))
            .collect();
        let list = list?;
        match list.len() == dimension {
            true => Some(list),
            false => {
                let expected = format!("{dimension} integers, one a direction");
                reader::wrong(value, "cells", &expected, log)
            }
        }
    });
    let grid: Vec<Option<At<Grid>>> = AXES[..dimension]
        .iter()
        .enumerate()
        .map(|(axis, key)| {
            let value = table.need(key, "[from, to] or { lines = [ … ] }")?;
            let count = counts.as_ref().map(|c| c[axis].clone());
            if value.get_ref().is_array() && cells.is_none() {
                let expected = format!("{dimension} integers, one a direction");
                table.need("cells", &expected);
                return None;
            }
            grid(value, key, count, &table)
        })
        .collect();
    if dimension == 2
        && let Some(value) = table.get("z")
    {
        log.borrow_mut().error(
            &value.span(),
            "a plane block has no z",
            "remove this key, or use analysis = \"solid\"",
        );
    }
    table.finish();
    Some(BlockEntry {
        name: name?,
        element: element?,
        grid: grid.into_iter().collect::<Option<_>>()?,
    })
}

fn element(table: &Table<'_>, dimension: usize) -> Option<At<CellKind>> {
    let all: Vec<&'static str> = PLANE.iter().chain(&SOLID).copied().collect();
    let element = table.choice("element", &all)?;
    let (mine, analysis) = match dimension {
        2 => (&PLANE[..], "a plane analysis"),
        _ => (&SOLID[..], "analysis = \"solid\""),
    };
    let kind = CellKind::ALL
        .into_iter()
        .find(|k| k.name() == element.value);
    match kind {
        None => None,
        Some(kind) if kind.dimension() != dimension => {
            table.log().borrow_mut().error(
                &element.span,
                format!(
                    "element is \"{}\", expected for {analysis} one of {}",
                    element.value,
                    mine.join(", ")
                ),
                "of another dimension than the analysis",
            );
            None
        }
        Some(kind) => Some(At::new(kind, element.span)),
    }
}

fn grid(
    value: Value<'_>,
    key: &'static str,
    count: Option<At<usize>>,
    table: &Table<'_>,
) -> Option<At<Grid>> {
    let log = table.log();
    if value.get_ref().is_array() {
        let ends = reader::vector(value, key, 2, log)?;
        let [a, b] = [ends.value[0], ends.value[1]];
        if a >= b {
            return reader::wrong(value, key, "[from, to] with from < to", log);
        }
        let count = count?;
        if count.value == 0 {
            log.borrow_mut().error(
                &count.span,
                format!("0 cells along {key}, expected at least 1 for a range"),
                "0 is for directions whose grid lines are given",
            );
            return None;
        }
        return Some(At::new(Grid::Range([a, b], count.value), ends.span));
    }
    let inner = reader::table(value, key, format!("the grid {key}"), log)?;
    let lines = inner
        .need("lines", "[ … ]")
        .and_then(|v| reader::numbers(v, "lines", log));
    inner.finish();
    let lines = lines?;
    if lines.value.len() < 2 || !lines.value.windows(2).all(|w| w[0] < w[1]) {
        log.borrow_mut().error(
            &lines.span,
            format!("the lines along {key} do not increase, expected at least two that do"),
            "must increase",
        );
        return None;
    }
    let cells = lines.value.len() - 1;
    if let Some(count) = count.filter(|count| ![0, cells].contains(&count.value)) {
        log.borrow_mut().error(
            &count.span,
            format!(
                "{} cells along {key}, expected the {cells} between its lines",
                count.value
            ),
            "0 where grid lines are given",
        );
        return None;
    }
    Some(At::new(Grid::Lines(lines.value), lines.span))
}

fn group(table: Table<'_>, dimension: usize) -> Option<GroupEntry> {
    let log = table.log();
    let name = table.name("name");
    let on = table.text("on");
    let limits: Vec<Option<[f64; 2]>> = AXES
        .iter()
        .enumerate()
        .map(|(axis, key)| {
            let value = table.get(key)?;
            if axis >= dimension {
                return reader::wrong(value, key, "no z in a plane analysis", log);
            }
            let ends = reader::vector(value, key, 2, log)?;
            match ends.value[0] <= ends.value[1] {
                true => Some([ends.value[0], ends.value[1]]),
                false => reader::wrong(value, key, "[from, to] with from ≤ to", log),
            }
        })
        .collect();
    let given = AXES.iter().any(|key| table.get(key).is_some());
    let nearest = table.get("nearest");
    let point = nearest.and_then(|v| reader::vector(v, "nearest", dimension, log));
    let span = table.span.clone();
    let both = given && nearest.is_some();
    if both || !(given || nearest.is_some()) {
        log.borrow_mut().error(
            &span,
            "a [[mesh.group]] needs either limits (x, y, z) or nearest = [ … ]",
            if both { "has both" } else { "has neither" },
        );
    }
    table.finish();
    let part = match point {
        Some(point) => Part::Nearest(point.value),
        None if nearest.is_some() => return None,
        None => Part::Box(limits[..dimension].to_vec()),
    };
    Some(GroupEntry {
        name: name?,
        on: on?,
        part: At::new(part, span),
    })
}
