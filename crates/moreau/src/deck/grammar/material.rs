//! `[[material]]`: moduli as they are given; whether they define a law is for the laws to say.

use super::not_yet;
use crate::deck::entries::MaterialEntry;
use crate::deck::finding::At;
use crate::deck::reader::{self, Table};
use crate::mesh::Integration;

pub(super) fn read(table: Table<'_>) -> Option<MaterialEntry> {
    let log = table.log();
    let on = table.text("on");
    let young = table.number("young");
    let poisson = table.number("poisson");
    let yield_stress = table.number_if("yield-stress");
    let isotropic = isotropic(&table);
    let kinematic = kinematic(&table);
    let quadrature = table.choice_if("quadrature", &["reduced", "full", "b-bar"]);
    let quadrature = quadrature.and_then(|q| match q.value {
        "reduced" => Some(At::new(Integration::Reduced, q.span)),
        "full" => Some(At::new(Integration::Full, q.span)),
        _ => {
            let instead = "use a quadratic element with quadrature = \"reduced\"";
            not_yet(log, &q.span, "quadrature = \"b-bar\"", instead);
            None
        }
    });
    for (key, given) in [("hardening", &isotropic), ("kinematic", &kinematic)] {
        if let (Some(given), None) = (given, table.get("yield-stress")) {
            log.borrow_mut().error(
                &given.span,
                format!("{key} is given without a yield-stress"),
                "an elastic material does not harden",
            );
        }
    }
    table.finish();
    Some(MaterialEntry {
        on: on?,
        // Stand-ins for what was refused, so that the rest is still checked.
        young: young.unwrap_or(At::new(1.0, 0..0)),
        poisson: poisson.unwrap_or(At::new(0.0, 0..0)),
        yield_stress,
        isotropic,
        kinematic,
        quadrature,
        kinds: Vec::new(),
    })
}

fn isotropic(table: &Table<'_>) -> Option<At<f64>> {
    let log = table.log();
    let value = table.get("hardening")?;
    let inner = reader::table(value, "hardening", "hardening", log)?;
    for key in ["voce", "swift", "table"] {
        if let Some(value) = inner.get(key) {
            let what = format!("hardening = {{ {key} = … }}");
            not_yet(log, &value.span(), &what, "use hardening = { linear = H }");
            return None;
        }
    }
    let linear = inner.number("linear");
    inner.finish();
    linear
}

fn kinematic(table: &Table<'_>) -> Option<At<f64>> {
    let log = table.log();
    let value = table.get("kinematic")?;
    let terms = reader::tables(value, "kinematic", "a kinematic term", log);
    if terms.len() > 1 {
        let instead = "use one term, kinematic = [ { modulus = H, recall = 0.0 } ]";
        not_yet(log, &value.span(), "several kinematic terms", instead);
        return None;
    }
    let term = terms.into_iter().next()?;
    let modulus = term.number("modulus");
    let recall = term.number_if("recall");
    term.finish();
    if let Some(recall) = recall.filter(|r| r.value != 0.0) {
        let instead = "use recall = 0.0 (linear kinematic hardening)";
        not_yet(
            log,
            &recall.span,
            "kinematic hardening with recall",
            instead,
        );
        return None;
    }
    modulus
}
