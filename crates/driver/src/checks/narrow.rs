//! Round tools that bear on one node, or on one row of nodes, because they are narrower than a facet; not those that pass
//! between nodes.

use crate::driver::Driver;
use moreau_mesh::Facet;
use nalgebra::{DMatrix, DVector, SVector};
use std::collections::{BTreeMap, BTreeSet};

/// Where a tool bears on a node alone that is rounder than the nodes beside it are far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Narrow<const D: usize> {
    /// Index of the contact, in the order in which contacts and pairs were added to the model.
    pub contact: usize,
    /// The node that bears.
    pub node: usize,
    /// Where it is now \[mm\].
    pub position: [f64; D],
    /// Radius of the tool there \[mm\].
    pub radius: f64,
    /// How far the nearest node beside it is, across the tool \[mm\].
    pub beside: f64,
}

/// Cosine of the angle to the direction across the tool, from which on a node lies beside another.
const ACROSS: f64 = 0.5;

impl<const D: usize> Driver<D> {
    /// Where a tool bears on a node and on none beside it, across the direction in which it is roundest, although its radius
    /// there is less than the way to the nearest of those: what it takes to press that node in is not what the tool takes.
    pub fn narrow_tools(&self) -> Option<Narrow<D>> {
        let count = (self.points.iter()).fold(0, |most, p| most.max(p.contact + 1));
        let all = (0..count).filter_map(|contact| self.narrowest(contact));
        all.max_by(|a, b| (a.beside / a.radius).total_cmp(&(b.beside / b.radius)))
    }

    fn narrowest(&self, contact: usize) -> Option<Narrow<D>> {
        let first = self.points.iter().find(|p| p.contact == contact)?;
        let number = first.tool?;
        let (tool, turn) = (&self.tools[number], self.state.loading.turn_of(number));
        let at = self.displacement(self.tool_node(number));
        let seen = |a: usize| tool.seen(self.position(a) - at, &turn);
        let rounding = self.settings.tolerance * self.state.largest_force;
        let pairs = self.points.iter().zip(&self.state.contacts);
        let pressed = pairs.filter(|(p, c)| p.tool == Some(number) && c.t[0] > rounding);
        let bearing: BTreeSet<usize> = pressed.map(|(p, _)| p.node).collect();
        let facets = self.surfaces(contact).0;
        let neighbours = self.beside_those(facets, &bearing);
        let narrow = |(&node, beside): (&usize, &BTreeSet<usize>)| {
            let x = seen(node);
            let (curvature, across) = roundest(&tool.obstacle.curvature(&x));
            let away = |&b: &usize| {
                let way = seen(b) - x;
                let is_beside = way.dot(&across).abs() > ACROSS * way.norm();
                is_beside.then_some((b, way.norm()))
            };
            let beside: Vec<(usize, f64)> = beside.iter().filter_map(away).collect();
            let nearest = beside.iter().fold(f64::INFINITY, |near, b| near.min(b.1));
            let alone = beside.iter().all(|(b, _)| !bearing.contains(b));
            let is_narrow = nearest.is_finite() && alone && curvature * nearest > 1.0;
            is_narrow.then(|| Narrow {
                contact,
                node,
                position: self.position(node).into(),
                radius: 1.0 / curvature,
                beside: nearest,
            })
        };
        let all = neighbours.iter().filter_map(narrow);
        all.max_by(|a, b| (a.beside / a.radius).total_cmp(&(b.beside / b.radius)))
    }

    /// The nodes that some nodes share facets with.
    fn beside_those(
        &self,
        facets: &[Facet],
        of: &BTreeSet<usize>,
    ) -> BTreeMap<usize, BTreeSet<usize>> {
        let mut all: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
        for &facet in facets {
            let nodes = self.mesh.facet_nodes(facet);
            for a in nodes.clone().filter(|a| of.contains(a)) {
                let others = nodes.clone().filter(|&b| b != a);
                all.entry(a).or_default().extend(others);
            }
        }
        all
    }
}

/// The largest curvature \[1/mm\], and its direction.
fn roundest<const D: usize>(curvature: &nalgebra::SMatrix<f64, D, D>) -> (f64, SVector<f64, D>) {
    let all = DMatrix::from_iterator(D, D, curvature.iter().copied()).symmetric_eigen();
    let largest = all.eigenvalues.imax();
    let direction: DVector<f64> = all.eigenvectors.column(largest).into_owned();
    (
        all.eigenvalues[largest],
        SVector::from_iterator(direction.iter().copied()),
    )
}
