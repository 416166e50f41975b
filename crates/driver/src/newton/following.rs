//! Surfaces that follow a step: paired where it leads, as often as that changes its contact forces; not the step.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::newton::criteria::CONTACT_SLACK;
use crate::newton::linearised::Answer;
use crate::vector::{SparseVector, largest};
use moreau_contact::Anderson;
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Times that surfaces are paired at most before a step is taken as it is.
const LIMIT: usize = 20;

/// Steps in a row that leave more than the best, after which that is taken.
const WORSE: usize = 4;

/// Change of what a step leaves, over that, with which it is nothing that surfaces could make less.
const SAME: f64 = 0.01;

/// Part of the imbalance at which an increment is accepted that a step may leave.
const EXACT: f64 = 0.1;

/// The fixed point of a step v and the surfaces paired where it leads.
///
/// With these the contact problem of a linearised increment is that of the end of the step, and what the step leaves
/// out of balance is of the bodies alone: Newton's method is as fast as with a tool. Weights and normals are not
/// differentiated for that, but evaluated at d_u + v again and again, extrapolated by Anderson's method, with the factor
/// at hand; as long as no status changes that is the method of generalised minimal residuals for what the tangent lacks.
pub(crate) struct Following<const D: usize> {
    anderson: Anderson,
    /// Degrees of freedom of the surfaces.
    dofs: Vec<usize>,
    /// The step that they were last paired at.
    tried: DVector<f64>,
    /// What a step may leave out of balance \[N\].
    enough: f64,
    /// Steps done.
    steps: usize,
    /// Steps since the best.
    worse: usize,
    /// What the best step leaves, and the last \[N\].
    left: f64,
    last: f64,
    /// The best step, with the contact forces of where it leads \[N\].
    pub(crate) best: Option<(Answer<D>, SparseVector)>,
}

impl<const D: usize> Following<D> {
    /// Takes the next step for better than the best so far, which is one under forces that are others then.
    pub(crate) fn asks_for_others(&mut self) {
        self.left = f64::INFINITY;
        self.last = f64::INFINITY;
    }
}

impl<const D: usize> Driver<D> {
    /// What a step has to follow that is to leave no more than `expected` in an increment that is accepted at
    /// `target` \[N\]: nothing where no surfaces of two bodies are large strains' to move.
    pub(crate) fn following(
        &self,
        system: &System,
        (expected, target): (f64, f64),
    ) -> Option<Following<D>> {
        self.repairs().then(|| {
            let paired = self.contacts.iter().filter(|c| c.pairing.is_some());
            let groups = paired.flat_map(|c| [&c.surface, &c.opposite]);
            let nodes = groups
                .filter_map(|g| self.mesh.node_group(g).ok())
                .flatten();
            let nodes: BTreeSet<usize> = nodes.collect();
            let dofs: Vec<usize> = nodes.into_iter().flat_map(|a| D * a..D * a + D).collect();
            Following {
                anderson: Anderson::default(),
                tried: DVector::zeros(dofs.len()),
                dofs,
                enough: expected.max(EXACT * target) + self.law_rounding(system),
                steps: 0,
                worse: 0,
                left: f64::INFINITY,
                last: f64::INFINITY,
                best: None,
            }
        })
    }

    /// Takes note of a step from the displacement increments `d_u` and pairs the surfaces where the next one is to be
    /// found: the contact points there, in a linearised increment that begins at `reached`, with all that is
    /// prescribed; `None` where the best step will do, or none is better.
    ///
    /// # Errors
    /// [`Driver::pair_at`].
    pub(crate) fn pair_along(
        &mut self,
        (system, end): (&System, &Loading<D>),
        following: &mut Following<D>,
        (d_u, reached): (&[f64], &[f64]),
        (answer, contact): (Answer<D>, &SparseVector),
    ) -> Result<Option<Vec<Kinematics<D>>>, ModelError> {
        let dofs = following.dofs.iter().map(|&dof| answer.step[dof]);
        let image = DVector::from_iterator(following.dofs.len(), dofs);
        let there: Vec<f64> = d_u.iter().zip(&answer.step).map(|(u, v)| u + v).collect();
        self.pair_at(end, &there)?;
        let kinematics = self.kinematics(system, end, &there);
        let forces = self.contact_forces(&kinematics, &answer.solution.force);
        let changed = forces.with(contact, |a, b| a - b);
        let left = largest(changed.iter().map(|(_, f)| f));
        let left = left.max(self.law_residual(system, &kinematics, &answer.solution));
        // What the contact solution itself keeps.
        let enough = following
            .enough
            .max(CONTACT_SLACK * answer.solution.residual);
        following.steps += 1;
        following.worse += 1;
        if left < following.left || following.best.is_none() {
            following.worse = 0;
            following.left = left;
            following.best = Some((answer, forces));
        }
        let stays = (left - std::mem::replace(&mut following.last, left)).abs() <= SAME * left;
        let ends = stays || following.steps >= LIMIT || following.worse >= WORSE;
        if left <= enough || !left.is_finite() || ends {
            return Ok(None);
        }
        let next = following.anderson.next(&following.tried, image);
        let mut there = d_u.to_vec();
        let pairs = following.dofs.iter().zip(next.iter());
        pairs.for_each(|(&dof, v)| there[dof] += v);
        self.follow_surfaces(end, &there)?;
        following.tried = next;
        Ok(Some(self.kinematics(system, end, reached)))
    }
}
