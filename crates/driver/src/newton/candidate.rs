//! A converged increment and what it took; not what it makes of the state.

use crate::model::points::Kinematics;
use crate::report::counts::Counts;
use moreau_contact::ContactSolution;

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
