//! `[[material]]`: moduli as they are given; whether they define a law is for the laws to say.

use super::axes;
use crate::deck::entries::{Curve, Hardening, MaterialEntry, SoilEntry};
use crate::deck::finding::At;
use crate::deck::reader::{self, Log, Table, Value};
use crate::mesh::Integration;

/// A material for each of the groups that it is on.
pub(super) fn read(table: Table<'_>, dimension: usize) -> Vec<MaterialEntry> {
    let log = table.log();
    let on = table.texts("on", "a group of cells, or an array of them");
    let axes = axes::read(&table, dimension);
    let (young, poisson) = match axes.as_ref().and_then(|a| a.elastic.as_ref()) {
        // What the size of stresses is compared with.
        Some(At {
            value: [young, ..],
            span,
        }) => {
            let largest = young.iter().fold(0.0, |a: f64, b| a.max(*b));
            (Some(At::new(largest, span.clone())), None)
        }
        None if table.get("orthotropic").is_some() => (None, None),
        None => (table.number("young"), table.number("poisson")),
    };
    let yield_stress = table.number_if("yield-stress");
    let isotropic = isotropic(&table);
    let kinematic = kinematic(&table);
    let soil = soil(&table);
    let expansion = table.number_if("expansion");
    let quadrature = table.choice_if("quadrature", &["reduced", "full", "b-bar"]);
    let quadrature = quadrature.map(|q| {
        let rule = match q.value {
            "reduced" => Integration::Reduced,
            "full" => Integration::Full,
            _ => Integration::BBar,
        };
        At::new(rule, q.span)
    });
    for key in ["hardening", "kinematic"] {
        if let (Some(given), None) = (table.get(key), table.get("yield-stress")) {
            log.borrow_mut().error(
                &given.span(),
                format!("{key} is given without a yield-stress"),
                "what has none does not harden",
            );
        }
    }
    table.finish();
    let each = |on| MaterialEntry {
        on,
        // Stand-ins for what was refused, so that the rest is still checked.
        young: young.clone().unwrap_or(At::new(1.0, 0..0)),
        poisson: poisson.clone().unwrap_or(At::new(0.0, 0..0)),
        yield_stress: yield_stress.clone(),
        isotropic: isotropic.clone(),
        kinematic: kinematic.clone(),
        soil: soil.clone(),
        axes: axes.clone(),
        expansion: expansion.clone(),
        quadrature: quadrature.clone(),
        kinds: Vec::new(),
    };
    on.into_iter().flatten().map(each).collect()
}

/// `cohesion` and the angles.
fn soil(table: &Table<'_>) -> Option<SoilEntry> {
    let log = table.log();
    let cohesion = table.number_if("cohesion");
    let friction_angle = table.number_if("friction-angle");
    let dilatancy_angle = table.number_if("dilatancy-angle");
    let refuse = |given: &At<f64>, message: &str, label: &str| {
        log.borrow_mut().error(&given.span, message, label);
    };
    let Some(cohesion) = cohesion else {
        for (key, angle) in [
            ("friction-angle", friction_angle),
            ("dilatancy-angle", dilatancy_angle),
        ] {
            if let Some(angle) = angle {
                let message = format!("{key} is given without a cohesion");
                refuse(&angle, &message, "part of the strength of a soil");
            }
        }
        return None;
    };
    if table.get("yield-stress").is_some() {
        let message = "the material has a cohesion and a yield-stress, expected one law";
        refuse(
            &cohesion,
            message,
            "yield-stress is von Mises', cohesion a soil's",
        );
    }
    let Some(friction_angle) = friction_angle else {
        let message = "cohesion is given without a friction-angle";
        refuse(
            &cohesion,
            message,
            "a clay without friction has a yield-stress",
        );
        return None;
    };
    let dilatancy_angle = dilatancy_angle.unwrap_or_else(|| friction_angle.clone());
    Some(SoilEntry {
        cohesion,
        friction_angle,
        dilatancy_angle,
    })
}

fn isotropic(table: &Table<'_>) -> Option<At<Hardening>> {
    let log = table.log();
    let value = table.get("hardening")?;
    let inner = reader::table(value, "hardening", "hardening", log)?;
    let given = ["linear", "voce", "swift", "table"].map(|key| (key, inner.get(key)));
    let given: Vec<_> = given
        .iter()
        .filter_map(|(k, v)| Some((*k, (*v)?)))
        .collect();
    let is_misspelt = given.is_empty() && !inner.entries().is_empty();
    inner.finish();
    if is_misspelt {
        // Which has been told.
        return None;
    }
    let linear = match given.first() {
        Some(&("linear", modulus)) => reader::number(modulus, "linear", log)?.value,
        _ => 0.0,
    };
    let curves: Vec<_> = given.iter().filter(|(key, _)| *key != "linear").collect();
    let &[&(key, law)] = curves.as_slice() else {
        if curves.is_empty() && !given.is_empty() {
            let curve = None;
            return Some(At::new(Hardening { linear, curve }, value.span()));
        }
        log.borrow_mut().error(
            &value.span(),
            format!("hardening has {} curves, expected one", curves.len()),
            "expected linear, one of voce, swift and table, or both",
        );
        return None;
    };
    let curve = match key {
        "voce" => Curve::Voce(row(law, "voce", "[q_inf, b]", log)?.value),
        "swift" => Curve::Swift(row(law, "swift", "[k, e0, n]", log)?.value),
        _ => {
            let rows = reader::items(law, key, "an array of [p, stress]", log)?;
            let rows = rows
                .into_iter()
                .map(|r| row(r, "a row of the table", "[p, stress]", log));
            Curve::Table(rows.collect::<Option<_>>()?)
        }
    };
    let curve = Some(curve);
    Some(At::new(Hardening { linear, curve }, value.span()))
}

/// An array of N numbers.
pub(super) fn row<const N: usize>(
    value: Value<'_>,
    what: &str,
    shown: &str,
    log: &Log,
) -> Option<At<[f64; N]>> {
    let list = reader::numbers(value, what, log)?;
    match <[f64; N]>::try_from(list.value) {
        Ok(row) => Some(At::new(row, list.span)),
        Err(_) => reader::wrong(value, what, shown, log),
    }
}

fn kinematic(table: &Table<'_>) -> Vec<[At<f64>; 2]> {
    let mut terms = Vec::new();
    for term in table.tables("kinematic", "a kinematic term") {
        let modulus = term.number("modulus");
        let recall = term.number_if("recall");
        if let Some(modulus) = modulus {
            let none = At::new(0.0, modulus.span.clone());
            terms.push([modulus, recall.unwrap_or(none)]);
        }
        term.finish();
    }
    terms
}
