//! Whether an equilibrium is stable: the signs of the eigenvalues of its tangent on what the statuses of its
//! contacts leave free; not how the structure gives way.

use crate::driver::Driver;
use crate::interface::condensation::{InFrames, gives_way};
use crate::interface::free::Free;
use crate::interface::tied::{Held, Tied};
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use moreau_laws::{Local, Status};
use nalgebra::DVector;

/// A negative pivot below this part of the largest diagonal is rounding, and a motion without stiffness: of a body that
/// is held, and of one that may move as a rigid one, whose motions all terms of the stiffness cancel in.
const NONE: [f64; 2] = [1e-12, 1e-9];

impl<const D: usize> Driver<D> {
    /// Negative eigenvalues of the factorised tangent K on the displacements that statuses leave free: what is open
    /// moves as it will, what slips along its surface, what sticks not at all but by the spring of a penalty. By
    /// Haynsworth's law they are those of K_ii and those of S on the free directions of the interface, with S the
    /// stiffness condensed on it.
    ///
    /// Slip under friction has no symmetric tangent. Shears are taken for forces that stay what they are, which
    /// resist nothing: the tangent is that of a surface without friction that is loaded by them.
    ///
    /// Where contacts are tied in the factor that counts itself, if its ties are those of the statuses; else they are
    /// made so, by one factorisation. Where that leaves a motion without stiffness, none is known and none is counted.
    pub(crate) fn negative_eigenvalues(
        &self,
        system: &mut System,
        loading: &Loading<D>,
        (kinematics, status): (&[Kinematics<D>], &[Status]),
        held: &mut Held<D>,
    ) -> usize {
        if !self.has_large_strains() {
            return 0;
        }
        if system.is_tied() {
            let holds = held.factor.holds_just(status)
                || self.hold_statuses(system, (kinematics, status), held);
            return if holds { system.negative() } else { 0 };
        }
        let free = self.free(system, kinematics, status);
        let moves_rigidly = system.floats && !self.is_held(loading, status);
        let none = NONE[usize::from(moves_rigidly)];
        system.negative() + free.map_or(0, |free| free.negative(none))
    }

    /// Ties the contacts as the statuses tell, springs of a penalty in series; false where that leaves a motion
    /// without stiffness.
    fn hold_statuses(
        &self,
        system: &mut System,
        (kinematics, status): (&[Kinematics<D>], &[Status]),
        Held { rows, factor }: &mut Held<D>,
    ) -> bool {
        let rest = vec![0.0; self.state.displacement.len()];
        let springs = self.compliances(kinematics);
        let mut tied = Tied::new(self, system, kinematics, &rest, None, (rows, factor));
        tied.hold_statuses(status, |i| springs[i])
    }

    /// Compliances of the springs of a penalty in series with every contact, which ties have not \[mm/N\].
    pub(crate) fn compliances(&self, kinematics: &[Kinematics<D>]) -> Vec<Local<D>> {
        let method = self.settings.contact.springs();
        let compliance = method.map_or_else(Local::zeros, |(compliance, _)| compliance);
        let of = |k: &Kinematics<D>| match k.law.is_tie() {
            true => Local::zeros(),
            false => compliance,
        };
        kinematics.iter().map(of).collect()
    }

    /// What statuses leave free of a factorised system that is condensed; `None` without an interface.
    pub(crate) fn free(
        &self,
        system: &mut System,
        kinematics: &[Kinematics<D>],
        status: &[Status],
    ) -> Option<Free> {
        let stiffness = system.schur();
        if stiffness.is_empty() {
            return None;
        }
        let load = DVector::zeros(stiffness.nrows());
        let contacts = (self.points.as_slice(), self.footing.rows.as_slice());
        let rest = vec![Local::zeros(); kinematics.len()];
        let springs = self.compliances(kinematics);
        let given = (rest.as_slice(), springs.as_slice());
        let frames = InFrames::new(system, (stiffness, &load), contacts, kinematics, given).ok()?;
        let gives = |k: usize| {
            let (i, j) = (k / D, k % D);
            match kinematics[i].active[j] {
                true if gives_way(status[i], j) => Some(0.0),
                true if springs[i][j] > 0.0 => Some(1.0 / springs[i][j]),
                _ => None,
            }
        };
        Some(Free::new(frames, D * kinematics.len(), gives))
    }
}
