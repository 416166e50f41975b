//! `orthotropic`, `hill` and `axes` of a `[[material]]`: what has directions; whether the numbers define a law is for the
//! laws to say.

use crate::deck::entries::{AxesEntry, DirectionsEntry, HillEntry};
use crate::deck::finding::At;
use crate::deck::reader::{self, Log, Table, Value};

const COEFFICIENTS: [&str; 6] = ["f", "g", "h", "l", "m", "n"];
const LANKFORD: [&str; 3] = ["r0", "r45", "r90"];

/// What the material has of axes; `None` of one without.
pub(super) fn read(table: &Table<'_>, dimension: usize) -> Option<AxesEntry> {
    let log = table.log();
    let [elastic, hill, axes] = ["orthotropic", "hill", "axes"].map(|key| table.get(key));
    if elastic.is_none() && hill.is_none() {
        if let Some(axes) = axes {
            let message = "axes are given without orthotropic or hill";
            log.borrow_mut()
                .error(&axes.span(), message, "the material has no directions");
        }
        return None;
    }
    for key in ["cohesion", "kinematic"] {
        if let Some(given) = table.get(key) {
            let message =
                format!("a material with axes has {key}, expected isotropic hardening alone");
            log.borrow_mut()
                .error(&given.span(), message, "not with orthotropic or hill");
        }
    }
    if let Some(hill) = hill.filter(|_| table.get("yield-stress").is_none()) {
        let message = "hill is given without a yield-stress";
        log.borrow_mut()
            .error(&hill.span(), message, "what has none does not yield");
    }
    for key in ["young", "poisson"] {
        if let (Some(given), Some(_)) = (table.get(key), elastic) {
            let message =
                format!("the material has orthotropic and {key}, expected one elasticity");
            log.borrow_mut()
                .error(&given.span(), message, "orthotropic has moduli of its own");
        }
    }
    Some(AxesEntry {
        elastic: elastic.and_then(|value| moduli(value, log)),
        hill: hill.and_then(|value| criterion(value, log)),
        directions: axes.and_then(|value| directions(value, dimension, log)),
    })
}

/// `{ young = [E1, E2, E3], poisson = [nu12, nu13, nu23], shear = [G12, G13, G23] }`.
fn moduli(value: Value<'_>, log: &Log) -> Option<At<[[f64; 3]; 3]>> {
    let inner = reader::table(value, "orthotropic", "orthotropic", log)?;
    let [young, poisson, shear] = [
        ("young", "[E1, E2, E3]"),
        ("poisson", "[nu12, nu13, nu23]"),
        ("shear", "[G12, G13, G23]"),
    ]
    .map(|(key, shown)| three(inner.need(key, shown)?, key, shown, log));
    inner.finish();
    Some(At::new([young?, poisson?, shear?], value.span()))
}

fn three(value: Value<'_>, what: &str, shown: &str, log: &Log) -> Option<[f64; 3]> {
    let list = reader::numbers(value, what, log)?;
    match <[f64; 3]>::try_from(list.value) {
        Ok(three) => Some(three),
        Err(_) => reader::wrong(value, what, shown, log),
    }
}

/// `{ f, g, h, l, m, n }` or `{ r0, r45, r90 }`.
fn criterion(value: Value<'_>, log: &Log) -> Option<At<HillEntry>> {
    let inner = reader::table(value, "hill", "hill", log)?;
    let given = [inner.given(&COEFFICIENTS), inner.given(&LANKFORD)];
    let entry = match given {
        [some, none] if none.is_empty() && !some.is_empty() => {
            let all = COEFFICIENTS.map(|key| inner.number(key).map(|n| n.value));
            let all: Option<Vec<f64>> = all.into_iter().collect();
            let all = all.and_then(|all| <[f64; 6]>::try_from(all).ok());
            all.map(HillEntry::Coefficients)
        }
        [none, some] if none.is_empty() && !some.is_empty() => {
            let [r0, r45, r90] = LANKFORD.map(|key| inner.number(key).map(|n| n.value));
            r0.zip(r45)
                .zip(r90)
                .map(|((r0, r45), r90)| HillEntry::Lankford([r0, r45, r90]))
        }
        _ => reader::wrong(
            value,
            "hill",
            "{ f, g, h, l, m, n } or Lankford's { r0, r45, r90 }",
            log,
        ),
    };
    inner.finish();
    Some(At::new(entry?, value.span()))
}

/// In the plane an angle in degrees, in space the first two directions.
fn directions(value: Value<'_>, dimension: usize, log: &Log) -> Option<At<DirectionsEntry>> {
    if dimension == 2 {
        let angle = reader::number(value, "axes", log)?;
        return Some(At::new(DirectionsEntry::Angle(angle.value), angle.span));
    }
    const SHOWN: &str = "the first two directions, [[x, y, z], [x, y, z]]";
    let list = reader::items(value, "axes", SHOWN, log)?;
    let [first, second] = list[..] else {
        return reader::wrong(value, "axes", SHOWN, log);
    };
    let first = three(first, "direction", "[x, y, z]", log)?;
    let second = three(second, "direction", "[x, y, z]", log)?;
    let entry = DirectionsEntry::Along([first, second]);
    if entry.rotation().is_none() {
        let message = format!("the axes {first:?} and {second:?} span no plane");
        log.borrow_mut().error(
            &value.span(),
            message,
            "expected two directions across each other",
        );
        return None;
    }
    Some(At::new(entry, value.span()))
}
