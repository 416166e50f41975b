//! The contact surfaces with gaps, slips, tractions and statuses as a grid.

use super::body::place;
use super::touch::{Touch, touches};
use crate::driver::{ContactRecord, Driver};
use crate::laws::{Local, Status};
use crate::mesh::Facet;
use crate::vtu::{Array, Grid, facet_type, three};
use std::collections::BTreeMap;

/// The contact surfaces with gaps, slips, tractions and statuses; `None` without contacts.
pub fn surface<const D: usize>(driver: &Driver<D>) -> Option<Grid> {
    let records = driver.contacts();
    let last = records.iter().map(|c| c.contact).max()?;
    // Of a node with several records in a contact, the one that presses most.
    let mut order: Vec<usize> = (0..records.len()).collect();
    order.sort_by(|&a, &b| records[a].t[0].total_cmp(&records[b].t[0]));
    let of = |k: usize| ((records[k].contact, records[k].node), k as i64);
    let index: BTreeMap<(usize, usize), i64> = order.into_iter().map(of).collect();
    let mesh = driver.mesh();
    let mut cells = Vec::new();
    let mut contact = Vec::new();
    for k in 0..=last {
        let facets: &[Facet] = mesh
            .facet_group(driver.contact_name(k).0)
            .unwrap_or_default();
        for &facet in facets {
            let nodes = mesh.facet_nodes(facet);
            let points = nodes.map(|n| index.get(&(k, n)).copied());
            // Beyond what it is tied to, a surface has no points.
            if let Some(points) = points.collect() {
                cells.push((points, facet_type(mesh.facet_kind(facet))));
                contact.push(k as f64);
            }
        }
    }
    let array = |name: &str, values: Vec<Vec<f64>>| Array {
        name: name.to_owned(),
        components: values.first().map_or(1, Vec::len),
        values: values.concat(),
    };
    let touches = touches(driver);
    let nodal = |value: &dyn Fn(&ContactRecord<D>) -> [f64; 3]| {
        records.iter().map(|c| value(c).to_vec()).collect()
    };
    let shown = |value: &dyn Fn(&Touch<D>) -> Vec<f64>| touches.iter().map(value).collect();
    let tangents = |v: &Local<D>| v.iter().skip(1).copied().collect();
    Some(Grid {
        points: records
            .iter()
            .map(|c| three(&place(driver, c.node)))
            .collect(),
        cells,
        point_data: vec![
            array(
                "displacement",
                nodal(&|c| three(driver.displacement(c.node).as_slice())),
            ),
            array("gap", shown(&|t| vec![t.u[0]])),
            array("slip", shown(&|t| tangents(&t.u))),
            array("pressure", shown(&|t| vec![t.traction[0]])),
            array("shear", shown(&|t| tangents(&t.traction))),
            array("force", nodal(&|c| three(c.force.as_slice()))),
            array(
                "status",
                shown(&|t| {
                    vec![match t.status {
                        Status::Open => 0.0,
                        Status::Stick => 1.0,
                        Status::Slip => 2.0,
                        Status::Tied => 3.0,
                    }]
                }),
            ),
        ],
        cell_data: vec![Array {
            name: "contact".into(),
            components: 1,
            values: contact,
        }],
    })
}
