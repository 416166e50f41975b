//! The contact points of a converged increment as a table: a row for each; no sums.

use super::status_name;
use crate::deck::{Described, Unit, Units};
use crate::driver::{ContactRecord, Driver};
use crate::grids::{Touch, touches};
use crate::mesh::NodeKind;
use crate::table::{Column, Table, Values};

/// The columns of `contact.csv`, in their order.
pub(super) const COLUMNS: [Described; 23] = [
    Described::new("step", Unit::Count, "Number of the step, from 1."),
    Described::new(
        "increment",
        Unit::Count,
        "Number of the increment since the virgin state, from 1.",
    ),
    Described::new(
        "contact",
        Unit::None,
        "Name of the surface that the point is on.",
    ),
    Described::new(
        "against",
        Unit::None,
        "Name of the tool or surface opposite; a node has a row for each part of a polyline or of a surface between its concave corners.",
    ),
    Described::new(
        "node",
        Unit::Count,
        "Number of the node in the mesh, from 0.",
    ),
    Described::new(
        "x",
        Unit::Length,
        "Place of the node in the undeformed body.",
    ),
    Described::new("y", Unit::Length, "The same along y."),
    Described::new("z", Unit::Length, "The same along z."),
    Described::new(
        "kind",
        Unit::None,
        "Place of the node on the facets of its surface: `corner`, `midside` or `face`.",
    ),
    Described::new(
        "gap",
        Unit::Length,
        "Gap along the normal; where nothing is opposite it is the size of the mesh.",
    ),
    Described::new(
        "slip_1",
        Unit::Length,
        "Slip in the increment along the first tangent.",
    ),
    Described::new(
        "slip_2",
        Unit::Length,
        "Slip in the increment along the second tangent.",
    ),
    Described::new(
        "t_n",
        Unit::Force,
        "Force on the body along the normal, positive where it presses.",
    ),
    Described::new(
        "t_1",
        Unit::Force,
        "Force on the body along the first tangent.",
    ),
    Described::new(
        "t_2",
        Unit::Force,
        "Force on the body along the second tangent.",
    ),
    Described::new(
        "p_n",
        Unit::Stress,
        "Pressure: `t_n` over the share of the surface that the node has.",
    ),
    Described::new(
        "p_1",
        Unit::Stress,
        "Shear traction along the first tangent: `t_1` over the same share.",
    ),
    Described::new(
        "p_2",
        Unit::Stress,
        "Shear traction along the second tangent: `t_2` over the same share.",
    ),
    Described::new(
        "status",
        Unit::None,
        "`open`, `stick` or `slip`; of a tie `tied`. What bears no more than rounding is open.",
    ),
    Described::new(
        "x_now",
        Unit::Length,
        "Place of the node in the deformed body.",
    ),
    Described::new("y_now", Unit::Length, "The same along y."),
    Described::new("z_now", Unit::Length, "The same along z."),
    Described::new(
        "s",
        Unit::Length,
        "Arc length along the surface of the undeformed body.",
    )
    .when("in the plane"),
];

/// All contact points, in a step counted from 1. Slips are those of the last increment; nodes are counted from 0.
pub(super) fn table<const D: usize>(driver: &Driver<D>, units: Units, stage: usize) -> Table {
    let records = driver.contacts();
    let touches = touches(driver);
    let count = |of: &dyn Fn(&ContactRecord<D>) -> usize| {
        Values::Counts(records.iter().map(|c| of(c) as i64).collect())
    };
    let text = |of: &dyn Fn(usize) -> &'static str| {
        Values::Texts((0..records.len()).map(|k| of(k).to_owned()).collect())
    };
    let names = records.iter().map(|c| driver.contact_name(c.contact));
    let (surfaces, opposites) = names.map(|(a, b)| (a.to_owned(), b.to_owned())).unzip();
    // Three components, those that the plane does not have zero.
    let vector = |of: &dyn Fn(&ContactRecord<D>, &Touch<D>) -> [f64; D]| {
        let vectors = records.iter().zip(&touches).map(|(c, t)| of(c, t));
        let vectors: Vec<[f64; D]> = vectors.collect();
        [0, 1, 2].map(|k| {
            let at = |v: &[f64; D]| v.get(k).copied().unwrap_or(0.0);
            Values::Numbers(vectors.iter().map(at).collect())
        })
    };
    let now = |c: &ContactRecord<D>| {
        let u = driver.displacement(c.node);
        std::array::from_fn(|i| c.position[i] + u[i])
    };
    let mut values = vec![
        count(&|_| stage),
        count(&|_| driver.increments()),
        Values::Texts(surfaces),
        Values::Texts(opposites),
        count(&|c| c.node),
    ];
    values.extend(vector(&|c, _| c.position));
    values.push(text(&|k| match records[k].kind {
        NodeKind::Corner => "corner",
        NodeKind::Midside => "midside",
        NodeKind::Face => "face",
    }));
    values.extend(vector(&|_, t| t.u.into()));
    values.extend(vector(&|c, _| c.t.into()));
    values.extend(vector(&|_, t| t.traction.into()));
    values.push(text(&|k| status_name(touches[k].status)));
    values.extend(vector(&|c, _| now(c)));
    if D == 2 {
        values.push(Values::Numbers(arcs(driver)));
    }
    let column = |(column, values): (&Described, Values)| Column {
        name: column.name.to_owned(),
        unit: column.unit.symbol(units).to_owned(),
        values,
    };
    // The last column is one of the plane alone.
    assert_eq!(values.len(), COLUMNS.len() - usize::from(D == 3));
    Table::new(COLUMNS.iter().zip(values).map(column).collect())
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
