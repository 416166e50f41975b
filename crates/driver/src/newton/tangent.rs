//! The tangent at an iterate, made definite where it is that of a mechanism; not the step that it gives.

use crate::assembly::cell_law::Stiffness;
use crate::driver::Driver;
use crate::error::{IncrementError, ModelError};
use crate::linear::system::System;
use crate::model::load::axis_letter;
use crate::newton::iterate::Iterate;
use crate::vector::SparseVector;

/// Parts of what flow adds to the stiffness that are tried in turn where the tangent is a mechanism.
const BLENDS: [f64; 4] = [1.0 - 1e-4, 0.99, 0.8, 0.0];

impl<const D: usize> Driver<D> {
    /// Makes the system that of the tangent at an iterate: factorised, where contacts are not tied in its
    /// factor.
    pub(crate) fn linearise(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        missing: &SparseVector,
    ) -> Result<(), IncrementError> {
        if !system.is_tied() {
            return self.factorise(system, now, missing);
        }
        if !now.assembly.stiffness {
            let tangent = Stiffness::Plastic(1.0);
            now.assembly = self.assemble(system, &now.d_u, missing, tangent);
        }
        Ok(())
    }

    /// Factorises the tangent at an iterate. Where that is a mechanism, as a plastic tangent may be
    /// far from the solution, more and more of the elastic stiffness is blended in: the step is
    /// then shorter and still downhill.
    pub(crate) fn factorise(
        &mut self,
        system: &mut System,
        now: &mut Iterate,
        missing: &SparseVector,
    ) -> Result<(), IncrementError> {
        let elastic = !now.assembly.flows;
        if !(now.assembly.stiffness || elastic && system.holds_elastic_factor()) {
            let tangent = Stiffness::Plastic(1.0);
            now.assembly = self.assemble(system, &now.d_u, missing, tangent);
        }
        let mut outcome = system.factorise(elastic);
        for part in BLENDS {
            if outcome.is_ok() {
                break;
            }
            let blended = Stiffness::Plastic(part);
            now.assembly = self.assemble(system, &now.d_u, missing, blended);
            outcome = system.factorise(false);
        }
        if let Err(dof) = outcome
            && let Some(tool) = (dof / D).checked_sub(self.mesh.nodes().len())
        {
            let tool = self.tools[tool].name.clone();
            let motion = format!("translation along {}", axis_letter(dof % D));
            return Err(ModelError::FreeTool { tool, motion }.into());
        }
        outcome.map_err(|dof| IncrementError::Mechanism {
            node: dof / D,
            axis: axis_letter(dof % D),
            position: self.mesh.nodes()[dof / D].to_vec(),
        })
    }
}
