//! Strains of heat that make no stress, and what they do to forces and energies; not the temperatures themselves.

use crate::assembly::block::points_of;
use crate::assembly::cell_law::{Motion, Stiffness};
use crate::driver::Driver;
use crate::error::ModelError;
use crate::model::load::{Condition, Loading, Step};
use crate::model::temperature::{Field, Temperature};
use crate::vector::largest;

impl<const D: usize> Driver<D> {
    /// How much warmer every cell is in a step than when it was free of stress \[K\].
    ///
    /// # Errors
    /// Unknown groups; [`ModelError::TwoTemperatures`].
    pub(crate) fn temperature(&self, step: &Step<D>) -> Result<Temperature, ModelError> {
        let mut of_cell: Vec<Option<(&Field<D>, f64)>> = Vec::new();
        for condition in &step.conditions {
            let Condition::Temperature { on, change, share } = condition else {
                continue;
            };
            of_cell.resize(self.mesh.cell_count(), None);
            for &cell in self.mesh.cell_group(on)? {
                if of_cell[cell].replace((change, *share)).is_some() {
                    return Err(ModelError::TwoTemperatures {
                        step: step.name.clone(),
                        cell,
                        group: on.clone(),
                    });
                }
            }
        }
        if of_cell.is_empty() {
            return Ok(Temperature::default());
        }
        let points = self.points();
        let change = points.iter().map(|point| match of_cell[point.cell] {
            Some((field, share)) => share * field.at(&point.position),
            None => 0.0,
        });
        Ok(Temperature(change.collect()))
    }

    /// # Errors
    /// Those of [`Loading::check`], and temperatures that are none of this model.
    pub(crate) fn check_loading(&self, loading: &Loading<D>) -> Result<(), ModelError> {
        loading.check(&self.mesh, self.state.displacement.len())?;
        let values = loading.temperature.values();
        let points: usize = self.blocks.iter().map(|b| points_of(b.as_ref())).sum();
        if !values.is_empty() && values.len() != points {
            return Err(ModelError::Saved {
                what: "temperatures at quadrature points",
                found: values.len(),
                expected: points,
            });
        }
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(()),
            Some(k) => Err(ModelError::OutOfRange {
                what: format!("temperature of cell {}", self.cell_of(k)),
                value: values[k],
                expected: "a finite number",
            }),
        }
    }

    /// The cell of a quadrature point in the order of [`Driver::points`].
    fn cell_of(&self, mut point: usize) -> usize {
        for block in &self.blocks {
            let own = points_of(block.as_ref());
            if point < own {
                return block.cells()[point / block.points_per_cell()];
            }
            point -= own;
        }
        0
    }

    /// Free strains of all quadrature points by the change of the temperature up to a loading; empty where nothing changes.
    pub(crate) fn free_strains(&self, end: &Loading<D>) -> Vec<f64> {
        let (before, after) = (&self.state.loading.temperature, &end.temperature);
        if self.expansion.is_empty() || before == after {
            return Vec::new();
        }
        let mut free = Vec::with_capacity(after.values().len().max(before.values().len()));
        for block in &self.blocks {
            for &cell in block.cells() {
                for _ in 0..block.points_per_cell() {
                    let change = after.at(free.len()) - before.at(free.len());
                    free.push(self.expansion[cell] * change);
                }
            }
        }
        free
    }

    /// The largest force on a node that the change of the temperature up to a loading needs for nothing to move \[N\].
    pub(crate) fn thermal_force(&mut self, end: &Loading<D>) -> f64 {
        let free = self.free_strains(end);
        if free.iter().all(|&free| free == 0.0) {
            return 0.0;
        }
        let mut force: Vec<f64> = self.state.internal.iter().map(|f| -f).collect();
        let rest = vec![0.0; force.len()];
        let mut motion = Motion {
            from: &self.state.displacement,
            by: &rest,
            free: &free,
        };
        for block in &mut self.blocks {
            let own = motion.split_off(points_of(block.as_ref()));
            block.evaluate(own, Stiffness::None, &mut |cell| {
                for (&a, own) in cell.nodes.iter().zip(cell.force.chunks_exact(D)) {
                    let at = force[D * a..D * a + D].iter_mut();
                    at.zip(own).for_each(|(sum, f)| *sum += f);
                }
            });
        }
        largest(force[..self.mesh_dofs()].iter().copied())
    }

    /// ∫ tr σ ε dΩ of the committed stresses and free strains ε at these displacements \[N·mm\]: under large strains of
    /// the stresses of Kirchhoff.
    pub(crate) fn work_on_free(&self, free: &[f64], displacement: &[f64]) -> f64 {
        if free.is_empty() {
            return 0.0;
        }
        let (mut work, mut left) = (0.0, free);
        for block in &self.blocks {
            let (own, others) = left.split_at(points_of(block.as_ref()).min(left.len()));
            left = others;
            let mut of_points = own.iter();
            block.gradients(displacement, &mut |point, _| {
                let trace: f64 = (0..3).map(|i| point.stress[i]).sum();
                let free = of_points.next().unwrap_or(&0.0);
                work += point.weight * point.jacobian * trace * free;
            });
        }
        work
    }
}
