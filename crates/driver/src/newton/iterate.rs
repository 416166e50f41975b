//! Where Newton's iteration stands, and ends: displacements, forces and what they are measured by; not how it
//! got there.

use crate::linear::system::Assembly;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::report::counts::Counts;
use crate::vector::SparseVector;
use crate::vector::largest;
use crate::vector::prescribed::Prescribed;
use crate::vector::prescribed::residual;
use moreau_contact::ContactSolution;

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

/// A converged increment, not yet committed.
pub(crate) struct Candidate<const D: usize> {
    pub(crate) d_u: Vec<f64>,
    pub(crate) internal: Vec<f64>,
    pub(crate) kinematics: Vec<Kinematics<D>>,
    /// Forces and statuses; the displacements are those of the linearised problem.
    pub(crate) solution: ContactSolution<D>,
    pub(crate) out_of_balance: f64,
    pub(crate) counts: Counts,
}
