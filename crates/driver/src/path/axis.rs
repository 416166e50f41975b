//! The axis of symmetry, across which nothing moves and on which nothing can press; not what holds elsewhere.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::load::Step;
use crate::path::along::is_axis;
use nalgebra::SVector;
use std::collections::BTreeMap;

/// A distance from the axis of symmetry below this part of the size of the mesh is none.
const ON_AXIS: f64 = 1e-9;

impl<const D: usize> Driver<D> {
    /// Whether a node of a body is on the axis of symmetry.
    fn is_on_axis(&self, node: usize) -> bool {
        // Under axial symmetry nothing is rigid but the translation along the axis.
        self.measure.rigid_modes(&[0.0; D]).len() == 1
            && self.mesh.nodes()[node][0].abs() <= ON_AXIS * self.mesh.size()
    }

    /// Prescribes that nodes on the axis of symmetry stay there, beside what is `moved` along axes, by degree of freedom.
    ///
    /// # Errors
    /// [`ModelError::LeavesAxis`].
    pub(super) fn hold_axis(
        &self,
        step: &Step<D>,
        moved: &mut BTreeMap<usize, f64>,
    ) -> Result<(), ModelError> {
        for node in (0..self.mesh.nodes().len()).filter(|&node| self.is_on_axis(node)) {
            let radial = moved.entry(D * node).or_insert(0.0);
            if *radial != 0.0 {
                return Err(ModelError::LeavesAxis {
                    step: step.name.clone(),
                    groups: self.prescribing(step, node),
                    node,
                    value: *radial,
                });
            }
        }
        Ok(())
    }

    /// # Errors
    /// [`ModelError::DirectionAtAxis`] for a node on the axis of symmetry and a direction that is none of the axes.
    pub(super) fn check_axis(
        &self,
        step: &Step<D>,
        (on, node): (&str, usize),
        n: &SVector<f64, D>,
    ) -> Result<(), ModelError> {
        if self.is_on_axis(node) && !is_axis(n) {
            return Err(ModelError::DirectionAtAxis {
                step: step.name.clone(),
                group: on.to_owned(),
                node,
                direction: n.iter().copied().collect(),
            });
        }
        Ok(())
    }

    /// # Errors
    /// [`ModelError::LoadOnAxis`] for a group that is on the axis of symmetry as a whole, which has no area.
    pub(super) fn check_area(&self, step: &Step<D>, on: &str) -> Result<(), ModelError> {
        let nodes = self.mesh.node_group(on)?;
        if !nodes.is_empty() && nodes.iter().all(|&node| self.is_on_axis(node)) {
            return Err(ModelError::LoadOnAxis {
                step: step.name.clone(),
                group: on.to_owned(),
            });
        }
        Ok(())
    }
}
