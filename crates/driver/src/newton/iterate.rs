//! Where Newton's iteration stands: displacements, forces and what they are measured by; not how it
//! got there.

use crate::linear::system::Assembly;
use crate::model::load::Loading;
use crate::vector::SparseVector;
use crate::vector::largest;
use crate::vector::prescribed::Prescribed;
use crate::vector::prescribed::residual;

/// Where Newton's iteration stands.
pub(crate) struct Iterate {
    /// Displacement increments of the step.
    pub(crate) d_u: Vec<f64>,
    pub(crate) assembly: Assembly,
    /// Contact forces \[N\].
    pub(crate) contact: SparseVector,
    /// The largest force on a node if it were not to move while the temperature changes \[N\].
    pub(crate) heated: f64,
    /// Part of the last Newton step that was taken: of a full one, which obeys the contact law, 1.
    pub(crate) part: f64,
}

impl Iterate {
    /// Out-of-balance force at every degree of freedom \[N\]; zero at those prescribed.
    pub(crate) fn residual<const D: usize>(
        &self,
        end: &Loading<D>,
        prescribed: &Prescribed,
    ) -> Vec<f64> {
        residual(
            &self.assembly.internal,
            &[&end.force, &self.contact],
            prescribed,
        )
    }

    /// The largest entry of a residual once missing displacements are made up for, by the tangent \[N\].
    pub(crate) fn once_arrived(&self, residual: &[f64]) -> f64 {
        let pairs = residual.iter().zip(&self.assembly.prescribed_load);
        largest(pairs.map(|(force, prescribed)| force - prescribed))
    }
}
