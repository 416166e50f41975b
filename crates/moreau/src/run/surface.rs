//! The contact surfaces with gaps, slips, tractions and statuses as a grid.

use super::grid::{Array, Grid, facet_type, three};
use crate::driver::{ContactRecord, Driver};
use crate::laws::Status;
use crate::mesh::Facet;
use std::collections::BTreeMap;

/// All contact surfaces; none without contacts.
pub(super) fn surface<const D: usize>(driver: &Driver<D>) -> Option<Grid> {
    let records = driver.contacts();
    let last = records.iter().map(|c| c.contact).max()?;
    let index: BTreeMap<usize, i64> = (0..).zip(records).map(|(k, c)| (c.node, k)).collect();
    let mesh = driver.mesh();
    let mut cells = Vec::new();
    let mut contact = Vec::new();
    for k in 0..=last {
        let facets: &[Facet] = mesh
            .facet_group(driver.contact_name(k).0)
            .unwrap_or_default();
        for &facet in facets {
            let nodes = mesh
                .facet_nodes(facet)
                .filter_map(|n| index.get(&n).copied());
            cells.push((nodes.collect(), facet_type(mesh.facet_kind(facet))));
            contact.push(k as f64);
        }
    }
    let array = |name: &str, value: &dyn Fn(&ContactRecord<D>) -> Vec<f64>| {
        let values: Vec<Vec<f64>> = records.iter().map(value).collect();
        Array {
            name: name.to_owned(),
            components: values.first().map_or(1, Vec::len),
            values: values.concat(),
        }
    };
    Some(Grid {
        points: records.iter().map(|c| three(&c.position)).collect(),
        cells,
        point_data: vec![
            array("displacement", &|c| {
                three(driver.displacement(c.node).as_slice()).to_vec()
            }),
            array("gap", &|c| vec![c.u[0]]),
            array("slip", &|c| c.u.iter().skip(1).copied().collect()),
            array("pressure", &|c| vec![c.traction()[0]]),
            array("shear", &|c| c.traction().iter().skip(1).copied().collect()),
            array("force", &|c| three(c.force.as_slice()).to_vec()),
            array("status", &|c| {
                vec![match c.status {
                    Status::Open => 0.0,
                    Status::Stick => 1.0,
                    Status::Slip => 2.0,
                }]
            }),
        ],
        cell_data: vec![Array {
            name: "contact".into(),
            components: 1,
            values: contact,
        }],
    })
}
