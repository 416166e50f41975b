//! The contact points of a converged increment as a table: a row for each; no sums.

use super::status_name;
use super::touch::{Touch, touches};
use crate::deck::Units;
use crate::driver::{ContactRecord, Driver};
use crate::mesh::NodeKind;
use crate::table::{Column, Table, Values};

/// All contact points, in a step counted from 1. Slips are those of the last increment; nodes are counted from 0.
pub(super) fn table<const D: usize>(driver: &Driver<D>, units: Units, stage: usize) -> Table {
    let records = driver.contacts();
    let touches = touches(driver);
    let (l, f, s) = (units.length(), units.force(), units.stress());
    let column = |name: &str, unit: &str, values: Values| Column {
        name: name.to_owned(),
        unit: unit.to_owned(),
        values,
    };
    let count = |name: &str, of: &dyn Fn(&ContactRecord<D>) -> usize| {
        let values = records.iter().map(|c| of(c) as i64).collect();
        column(name, "", Values::Counts(values))
    };
    let text = |name: &str, of: &dyn Fn(usize) -> &'static str| {
        let values = (0..records.len()).map(|k| of(k).to_owned()).collect();
        column(name, "", Values::Texts(values))
    };
    let surfaces = records.iter().map(|c| driver.contact_name(c.contact).0);
    let surfaces = surfaces.map(str::to_owned).collect();
    // Three components, those that the plane does not have zero.
    let vector = |names: [&str; 3], unit, of: &dyn Fn(&ContactRecord<D>, &Touch<D>) -> [f64; D]| {
        let vectors = records.iter().zip(&touches).map(|(c, t)| of(c, t));
        let vectors: Vec<[f64; D]> = vectors.collect();
        let component = |k: usize| {
            let at = |v: &[f64; D]| v.get(k).copied().unwrap_or(0.0);
            column(
                names[k],
                unit,
                Values::Numbers(vectors.iter().map(at).collect()),
            )
        };
        [component(0), component(1), component(2)]
    };
    let now = |c: &ContactRecord<D>| {
        let u = driver.displacement(c.node);
        std::array::from_fn(|i| c.position[i] + u[i])
    };
    let mut columns = vec![
        count("step", &|_| stage),
        count("increment", &|_| driver.increments()),
        column("contact", "", Values::Texts(surfaces)),
        count("node", &|c| c.node),
    ];
    columns.extend(vector(["x", "y", "z"], l, &|c, _| c.position));
    columns.push(text("kind", &|k| match records[k].kind {
        NodeKind::Corner => "corner",
        NodeKind::Midside => "midside",
        NodeKind::Face => "face",
    }));
    columns.extend(vector(["gap", "slip_1", "slip_2"], l, &|_, t| t.u.into()));
    columns.extend(vector(["t_n", "t_1", "t_2"], f, &|c, _| c.t.into()));
    columns.extend(vector(["p_n", "p_1", "p_2"], s, &|_, t| t.traction.into()));
    columns.push(text("status", &|k| status_name(touches[k].status)));
    columns.extend(vector(["x_now", "y_now", "z_now"], l, &|c, _| now(c)));
    if D == 2 {
        columns.push(column("s", l, Values::Numbers(arcs(driver))));
    }
    Table::new(columns)
}

/// Arc length along its surface at every contact point, in the undeformed body.
fn arcs<const D: usize>(driver: &Driver<D>) -> Vec<f64> {
    let (mesh, records) = (driver.mesh(), driver.contacts());
    let on = |own: &[ContactRecord<D>]| {
        let surface = driver.contact_name(own[0].contact).0;
        let arc = mesh.arc_length(mesh.facet_group(surface).unwrap_or_default());
        let at = |c: &ContactRecord<D>| arc.get(&c.node).copied().unwrap_or(f64::NAN);
        own.iter().map(at).collect::<Vec<_>>()
    };
    let contacts = records.chunk_by(|a, b| a.contact == b.contact);
    contacts.flat_map(on).collect()
}
