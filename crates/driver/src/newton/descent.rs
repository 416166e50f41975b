//! Steps that begin downhill, where the bodies are unstable under what touches; not the equations of a step.

use crate::driver::Driver;
use crate::linear::system::System;
use crate::newton::linearised::Answer;
use crate::vector::SparseVector;

/// A slope below this part of the sum of its terms is rounding.
const ROUNDING: f64 = 1e-9;

/// The proximal term over that which would make up for the negative stiffness along the step, if the step were the same.
const MARGIN: f64 = 2.0;

/// How much stiffer the next proximal term is at least.
const STIFFER: f64 = 10.0;

/// Proximal terms that are tried at most.
pub(crate) const TERMS: usize = 8;

impl<const D: usize> Driver<D> {
    /// Whether steps can be asked to begin downhill: along those of a symmetric tangent ΔΦ has the slope −vᵀKv under the
    /// contact forces of their end. Where contacts are tied in the factor their problem is not solved past a limit point.
    pub(crate) fn asks_for_descent(&self, system: &System) -> bool {
        self.has_large_strains() && self.is_symmetric() && system.is_direct() && !system.is_tied()
    }
}

/// The proximal term c of the contact problem, c/2 |x|² with the motions x of the contacts \[N/mm\], with which a step is to
/// be found anew that goes uphill, found under a load at every degree of freedom with the term `held`; `None` of a step
/// that goes downhill.
///
/// Past a limit point stresses make the bodies unstable under the contacts that are left: Newton's step then leads up to
/// an equilibrium that does not last. Held by the term it goes down, and the line search tells how far.
pub(crate) fn stiffer<const D: usize>(
    load: &[f64],
    (answer, contact): (&Answer<D>, &SparseVector),
    held: f64,
) -> Option<f64> {
    let own = load.iter().zip(&answer.step).map(|(r, v)| r * v);
    let of_contact = contact.iter().map(|(dof, f)| f * answer.step[dof]);
    let (mut slope, mut size) = (0.0, 0.0);
    for power in own.chain(of_contact) {
        slope -= power;
        size += power.abs();
    }
    let motions = answer.solution.motion.iter();
    let motion: f64 = motions.map(|x| x.norm_squared()).sum();
    let uphill = slope > ROUNDING * size && motion > 0.0;
    uphill.then(|| (STIFFER * held).max(MARGIN * slope / motion))
}
