//! Contact components that follow from others, as where a node touches several tools or conditions prescribe a slip: a
//! spring whose force starts from the last multiplier; not the contact problem.

use crate::model::points::Kinematics;
use crate::vector::Combination;
use moreau_laws::{Friction, Local};
use nalgebra::{DMatrix, DVector};

/// A component of a relative displacement that is a combination R x of unknowns which others have
/// determined already.
///
/// A node in a corner between two tools has four gaps and slips, and two displacements: the multipliers
/// need not be unique, and as unknowns the components are too many. This one becomes an unknown u of
/// its own, on a spring to the displacement that it follows:
///
/// ```text
/// e = u − R x,   t = t₀ + k e
/// ```
///
/// with t₀ the multiplier of the last iteration. That is the augmented Lagrangian of \[83\] to \[90\], its
/// correction repeated with the bulk: e vanishes as t converges, whatever k is.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Suspended {
    /// Index of the component among those of all contacts.
    pub(crate) component: usize,
    /// R, by unknown.
    pub(crate) row: Combination,
    /// t₀ \[N\].
    pub(crate) force: f64,
    /// The row whose stiffness the spring has a multiple of: R, or where that may be empty that of the normal.
    pub(crate) measure: Combination,
    /// Least stiffness of the spring, [`steepness`] \[N/mm\].
    pub(crate) steepness: f64,
}

/// k over the stiffness of the unknowns: e shrinks by about its inverse with every iteration, and the
/// rounding of forces grows with it.
const STIFFER: f64 = 30.0;

/// The same at most, where contacts answer steeply.
const STIFFEST: f64 = 1e6;

/// Distance of a shear from its limit, over that, which is rounding: it slips.
const AT_LIMIT: f64 = 1e-9;

/// Least stiffness of the unknowns that a spring is measured by, over that of a node: a tool that a force drives has none
/// of its own, or that of its turning forces, which may be negative.
const SOFTEST: f64 = 0.01;

/// k \[N/mm\] for a positive stiffness of the unknowns and the [`steepness`] of friction.
pub(crate) fn spring(stiffness: f64, steepness: f64) -> f64 {
    STIFFER * steepness.clamp(stiffness, STIFFEST / STIFFER * stiffness)
}

/// How steeply a contact answers an elongation of the spring, which vanishes as fast as the spring is stiffer than that: as
/// the stiffness 1/C of a penalty of compliance C in series with it, and as g / ‖u_t‖, by which friction turns with a slip
/// that is known, or in space with that of a point that slips \[N/mm\].
pub(crate) fn steepness<const D: usize>(
    kinematics: &Kinematics<D>,
    force: &Local<D>,
    compliance: f64,
) -> f64 {
    let bound = kinematics.law.bound(force[0].max(0.0));
    let slips = D > 2 && force.rows(1, D - 1).norm() >= (1.0 - AT_LIMIT) * bound;
    let own = slips.then(|| kinematics.u.rows(1, D - 1).norm());
    let slip = kinematics.known_slip.or(own).filter(|&slip| slip > 0.0);
    let turns = slip.map_or(0.0, |slip| bound / slip);
    match compliance > 0.0 {
        true => turns.max(compliance.recip()),
        false => turns,
    }
}

/// Which components are unknowns of the bodies first, where not all can be: those that forces hold, then those of which the
/// force is known as the others are. The spring of one that is free to open or to slip rests as soon as statuses do.
pub(crate) fn precedence<const D: usize>(law: &Friction, force: &Local<D>, j: usize) -> u8 {
    let shear = force.rows(1, D - 1).norm();
    let presses = law.is_tie() || force[0] > 0.0;
    let sticks = law.is_tie() || shear < (1.0 - AT_LIMIT) * law.bound(force[0].max(0.0));
    match (j, presses) {
        (0, true) => 0,
        (_, true) if sticks => 0,
        (0, false) => 1,
        _ => 2,
    }
}

impl Suspended {
    /// k \[N/mm\], from the diagonal of the stiffness of the unknowns, and that of a node.
    pub(crate) fn spring(&self, stiffness: &DMatrix<f64>, of_node: f64) -> f64 {
        let entries = self.measure.iter();
        let own: f64 = entries.map(|&(x, c)| c * c * stiffness[(x, x)]).sum();
        spring(own.abs().max(SOFTEST * of_node), self.steepness)
    }

    /// Adds ½ k e² + t₀ e to a stiffness and a load whose first unknowns are the components of all
    /// contacts; `row` is R by these unknowns.
    pub(crate) fn add(
        &self,
        k: f64,
        row: &Combination,
        (stiffness, load): (&mut DMatrix<f64>, &mut DVector<f64>),
    ) {
        let mut elongation: Vec<(usize, f64)> = row.iter().map(|&(z, c)| (z, -c)).collect();
        elongation.push((self.component, 1.0));
        for &(i, a) in &elongation {
            load[i] -= self.force * a;
            for &(j, b) in &elongation {
                stiffness[(i, j)] += k * a * b;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tool that a force drives has no stiffness, or a negative one; its spring holds all the same, and is the stiffer the
    /// steeper friction is.
    #[test]
    fn a_spring_is_stiffer_than_what_has_no_stiffness() {
        let of = |own: f64, steepness: f64| {
            let suspended = Suspended {
                component: 0,
                row: vec![(0, 2.0)],
                force: 0.0,
                measure: vec![(0, 2.0)],
                steepness,
            };
            suspended.spring(&DMatrix::from_element(1, 1, own), 1e5)
        };
        let near = |k: f64, expected: f64| assert!((k / expected - 1.0).abs() < 1e-14, "{k}");
        for own in [0.0, -1e-11, 1e-11, -27.0] {
            near(of(own, 0.0), STIFFER * SOFTEST * 1e5);
            near(of(own, 1e4), STIFFER * 1e4);
        }
        for own in [1e4, -1e4] {
            near(of(own, 0.0), STIFFER * 4e4);
            near(of(own, 1e99), STIFFEST * 4e4);
        }
    }
}
