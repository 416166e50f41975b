//! `[[initial]]`: the stress and the plastic strain that bodies start with, as they are given.

use crate::deck::entries::{Analysis, FieldEntry, InitialEntry};
use crate::deck::finding::At;
use crate::deck::reader::{self, Table};

/// Components of a stress; those that leave the plane are of a solid.
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "xz"];

pub(super) fn read(table: Table<'_>, analysis: Analysis) -> Option<InitialEntry> {
    let log = table.log();
    let dimension = analysis.dimension();
    let on = table.text("on");
    let field = |value, what| {
        let field = reader::field(value, what, dimension, log)?;
        Some(At::new(field, value.span()))
    };
    let stress = table.get("stress").and_then(|value| {
        let inner = reader::table(value, "stress", "stress", log)?;
        let known = if dimension == 3 { 6 } else { 4 };
        let given = COMPONENTS[..known].iter().map(|key| {
            let value = inner.get(key)?;
            field(value, key)
        });
        let given: Vec<Option<At<FieldEntry>>> = given.collect();
        let empty = inner.entries().is_empty();
        inner.finish();
        if empty {
            return reader::wrong(
                value,
                "stress",
                "at least one component, as in { yy = -10 }",
                log,
            );
        }
        Some(At::new(given, value.span()))
    });
    let p = table.get("p").and_then(|value| field(value, "p"));
    let through = stress.as_ref().and_then(|s| s.value.get(2)?.as_ref());
    if let (Analysis::PlaneStress, Some(zz)) = (analysis, through)
        && zz.value != FieldEntry::Constant(0.0)
    {
        let message = "zz is a stress through the thickness, and in plane stress there is none";
        log.borrow_mut()
            .error(&zz.span, message, "expected 0, or no zz");
    }
    if let Some(At {
        value: FieldEntry::Constant(value),
        span,
    }) = &p
        && *value < 0.0
    {
        let message = format!("p is {value}, expected an equivalent plastic strain of 0 or more");
        log.borrow_mut().error(span, message, "out of range");
    }
    if table.given(&["stress", "p"]).is_empty() {
        let message = "[[initial]] has neither a stress nor a p, expected one of both";
        log.borrow_mut()
            .error(&table.span, message, "what the body starts with");
    }
    let span = table.span.clone();
    table.finish();
    Some(InitialEntry {
        on: on?,
        stress: stress.map_or(Vec::new(), |s| s.value),
        p,
        span,
    })
}
