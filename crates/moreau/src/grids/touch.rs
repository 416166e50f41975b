//! What happens at the contact points as it is shown; not the forces, which are the nodes' own.

use crate::driver::Driver;
use crate::laws::{Local, Status};
use nalgebra::SVector;
use std::collections::BTreeSet;

/// A contact point as it is shown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch<const D: usize> {
    /// Gap and slip of the increment.
    pub(crate) u: Local<D>,
    /// Pressure and shears.
    pub(crate) traction: Local<D>,
    pub(crate) status: Status,
}

/// All contact points. One whose multiplier went to its neighbours has what the multipliers are there:
/// the mean of theirs, by the parts in which they took it over. Nothing would be a hole in a field that
/// has none.
pub(crate) fn touches<const D: usize>(driver: &Driver<D>) -> Vec<Touch<D>> {
    let records = driver.contacts();
    let own = |k: &usize| Touch {
        u: records[*k].u,
        traction: records[*k].traction(),
        status: driver.status(*k),
    };
    let mut touches: Vec<Touch<D>> = (0..records.len()).map(|k| own(&k)).collect();
    for &point in driver.redistributed() {
        let parts = beside(driver, point);
        let sum: f64 = parts.iter().map(|p| p.1).sum();
        let nearest = parts.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let Some(&(nearest, _)) = nearest else {
            continue;
        };
        let mean = |value: &dyn Fn(Touch<D>) -> Local<D>| -> Local<D> {
            parts
                .iter()
                .map(|(k, part)| value(own(k)) * (part / sum))
                .sum()
        };
        touches[point] = Touch {
            u: mean(&|t| t.u),
            traction: mean(&|t| t.traction),
            status: driver.status(nearest),
        };
    }
    touches
}

/// The points with a multiplier on the facets around one, with the inverse squares of their distances.
fn beside<const D: usize>(driver: &Driver<D>, point: usize) -> Vec<(usize, f64)> {
    let (mesh, records) = (driver.mesh(), driver.contacts());
    let centre = &records[point];
    let surface = driver.contact_name(centre.contact).0;
    let facets = mesh.facet_group(surface).unwrap_or_default().iter();
    let around = facets.filter(|f| mesh.facet_nodes(**f).any(|n| n == centre.node));
    let nodes: BTreeSet<usize> = around.flat_map(|&f| mesh.facet_nodes(f)).collect();
    let apart = |x: &[f64; D]| SVector::from(*x) - SVector::from(centre.position);
    let is_beside = |k: &usize| {
        let other = &records[*k];
        other.contact == centre.contact && other.area > 0.0 && nodes.contains(&other.node)
    };
    (0..records.len())
        .filter(is_beside)
        .map(|k| (k, 1.0 / apart(&records[k].position).norm_squared()))
        .collect()
}
