//! Where Newton's iteration stands: displacements, forces and what they are measured by; not how it
//! got there.

use crate::driver::Driver;
use crate::load::Loading;
use crate::norm::largest;
use crate::system::Assembly;

/// Where Newton's iteration stands.
pub(crate) struct Iterate {
    /// Displacement increments of the step.
    pub(crate) d_u: Vec<f64>,
    pub(crate) assembly: Assembly,
    /// Contact forces at every degree of freedom \[N\].
    pub(crate) contact: Vec<f64>,
    /// Part of the last Newton step that was taken: of a full one, which obeys the contact law, 1.
    pub(crate) part: f64,
}

impl Iterate {
    /// Force that nothing balances, at every degree of freedom \[N\]; zero at those not free.
    pub(crate) fn imbalance<const D: usize>(&self, end: &Loading<D>, free: &[usize]) -> Vec<f64> {
        let mut residual = vec![0.0; self.d_u.len()];
        for &d in free {
            residual[d] = end.force[d] + self.contact[d] - self.assembly.internal[d];
        }
        residual
    }
}

impl<const D: usize> Driver<D> {
    /// Size of the forces in play at the nodes, against which imbalance is judged \[N\]. What a tool
    /// carries is a sum of them.
    pub(crate) fn force_scale(
        &self,
        assembly: &Assembly,
        end: &Loading<D>,
        contact: &[f64],
    ) -> f64 {
        let nodal = |forces: &[f64]| largest(forces[..self.mesh_dofs()].iter().copied());
        let scale = nodal(&assembly.internal).max(nodal(&end.force));
        scale.max(nodal(contact)).max(f64::MIN_POSITIVE)
    }
}
