//! Where Newton's iteration stands: displacements, forces and what they are measured by; not how it
//! got there.

use crate::driver::Driver;
use crate::linear::system::Assembly;
use crate::model::load::Loading;
use crate::vector::SparseVector;
use crate::vector::{imbalance, largest};
use moreau_contact::ContactSolution;

/// Where Newton's iteration stands.
pub(crate) struct Iterate {
    /// Displacement increments of the step.
    pub(crate) d_u: Vec<f64>,
    pub(crate) assembly: Assembly,
    /// Contact forces \[N\].
    pub(crate) contact: SparseVector,
    /// Part of the last Newton step that was taken: of a full one, which obeys the contact law, 1.
    pub(crate) part: f64,
}

impl Iterate {
    /// Force that nothing balances, at every degree of freedom \[N\]; zero at those held.
    pub(crate) fn imbalance<const D: usize>(&self, end: &Loading<D>, held: &[usize]) -> Vec<f64> {
        imbalance(&self.assembly.internal, &[&end.force, &self.contact], held)
    }

    /// The largest of a force that nothing balances once missing displacements are made up for, by the
    /// tangent \[N\].
    pub(crate) fn once_arrived(&self, imbalance: &[f64]) -> f64 {
        let pairs = imbalance.iter().zip(&self.assembly.coupling);
        largest(pairs.map(|(force, coupling)| force - coupling))
    }
}

/// What an increment may be off by, over the residual of its contact solution: that weighs
/// displacements with a somewhat smaller α.
const CONTACT_SLACK: f64 = 10.0;

/// What an increment may be off by for its contact solution \[N\]. One that is not exact excuses
/// nothing.
pub(crate) fn slack<const D: usize>(solution: &ContactSolution<D>) -> f64 {
    match solution.exact {
        true => CONTACT_SLACK * solution.residual,
        false => 0.0,
    }
}

impl<const D: usize> Driver<D> {
    /// Size of the forces in play at the nodes, against which imbalance is judged \[N\]. What a tool
    /// carries is a sum of them.
    pub(crate) fn force_scale(
        &self,
        assembly: &Assembly,
        end: &Loading<D>,
        contact: &SparseVector,
    ) -> f64 {
        let nodes = self.mesh_dofs();
        let given = end.force.iter().chain(contact.iter());
        let given = given.filter(|&(dof, _)| dof < nodes).map(|(_, f)| f);
        let internal = assembly.internal[..nodes].iter().copied();
        largest(given.chain(internal)).max(f64::MIN_POSITIVE)
    }
}
