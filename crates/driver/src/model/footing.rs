//! What the contact points stand on: which displacements make their relative displacements, and where the surfaces were
//! paired; not how.

use crate::model::motion_row::RelativeMotionRow;
use moreau_mesh::{Fold, MultiplierChoices};
use nalgebra::SVector;
use std::collections::BTreeMap;

/// A contact point that its tool holds, as far as others follow from it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ground<const D: usize> {
    pub(crate) point: usize,
    /// Normal of the tool, along which the point is held.
    pub(crate) normal: SVector<f64, D>,
    /// Whether it is held along the tool as well.
    pub(crate) sticks: bool,
}

/// Where the contact points stand in the increment at hand: between two bodies at its start under small strains,
/// at the iterate under large ones.
#[derive(Debug, Clone, Default)]
pub(crate) struct Footing<const D: usize> {
    pub(crate) rows: Vec<RelativeMotionRow<D>>,
    /// Contact points whose multipliers their neighbours have.
    pub(crate) redistributed: Vec<usize>,
    /// Displacement increments at which the surfaces were paired, at every degree of freedom \[mm\].
    pub(crate) at: Vec<f64>,
    /// The rows at the start of the increment, where they are others.
    pub(crate) first: Vec<RelativeMotionRow<D>>,
    /// The largest weight opposite to each point when the increment was begun, before multipliers were handed over.
    pub(crate) opposite: Vec<f64>,
    /// The two sides at the start of the increment of each contact of a surface with itself.
    pub(crate) folds: BTreeMap<usize, Fold>,
    /// The points on tools of the nodes on surfaces that face another body.
    pub(crate) beside: Vec<usize>,
    /// What tools hold of these.
    pub(crate) grounds: Vec<Ground<D>>,
    /// How often these were found anew in this increment.
    pub(crate) regrounded: u8,
    /// The nodes of each contact that had a multiplier when its surfaces were last paired in this increment.
    pub(crate) multipliers: BTreeMap<usize, MultiplierChoices>,
}

impl<const D: usize> Footing<D> {
    /// Displacement increment of a node at which the surfaces were paired.
    pub(crate) fn moved(&self, node: usize) -> SVector<f64, D> {
        SVector::from_column_slice(&self.at[D * node..D * node + D])
    }
}
