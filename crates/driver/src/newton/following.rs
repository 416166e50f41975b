//! Surfaces that follow a step: paired where it leads, as often as that changes its contact forces; not the step.

use crate::driver::Driver;
use crate::error::ModelError;
use crate::linear::system::System;
use crate::model::load::Loading;
use crate::model::points::Kinematics;
use crate::newton::linearised::Answer;
use crate::vector::{SparseVector, largest};
use moreau_contact::Anderson;
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Times that surfaces are paired at most before a step is taken as it is.
const LIMIT: usize = 20;

/// Part of the imbalance at which an increment is accepted that a step may leave.
const EXACT: f64 = 0.1;

/// The fixed point of a step v and the surfaces paired where it leads.
///
/// With these the contact problem of a linearised increment is that of the end of the step, and what the step leaves
/// out of balance is of the bodies alone: Newton's method is as fast as with a tool. Weights and normals are not
/// differentiated for that, but evaluated at d_u + v again and again, extrapolated by Anderson's method, with the factor
/// at hand; as long as no status changes that is the method of generalised minimal residuals for what the tangent lacks.
pub(crate) struct Following {
    anderson: Anderson,
    /// Degrees of freedom of the surfaces.
    dofs: Vec<usize>,
    /// The step that they were last paired at.
    tried: DVector<f64>,
    /// What a step may leave out of balance \[N\].
    enough: f64,
    /// Steps done.
    steps: usize,
}

/// Where a step has led.
pub(crate) struct Followed<const D: usize> {
    /// Contact forces there \[N\].
    pub(crate) contact: SparseVector,
    /// The contact points that the next step is to be found with; `None` if this one will do.
    pub(crate) next: Option<Vec<Kinematics<D>>>,
}

impl<const D: usize> Driver<D> {
    /// What a step has to follow that is to leave no more than `expected` in an increment that is accepted at
    /// `target` \[N\]: nothing where no surfaces of two bodies are large strains' to move.
    pub(crate) fn following(&self, (expected, target): (f64, f64)) -> Option<Following> {
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
                enough: expected.max(EXACT * target),
                steps: 0,
            }
        })
    }

    /// Goes to where a step from the displacement increments `d_u` leads, whose linearised increment begins at
    /// `reached`, with all that is prescribed.
    ///
    /// # Errors
    /// [`Driver::pair_at`].
    pub(crate) fn pair_along(
        &mut self,
        system: &System,
        end: &Loading<D>,
        following: &mut Following,
        (d_u, reached): (&[f64], &[f64]),
        (answer, contact): (&Answer<D>, &SparseVector),
    ) -> Result<Followed<D>, ModelError> {
        let at = |v: &DVector<f64>| {
            let mut at = d_u.to_vec();
            following
                .dofs
                .iter()
                .zip(v.iter())
                .for_each(|(&dof, v)| at[dof] += v);
            at
        };
        let dofs = following.dofs.iter().map(|&dof| answer.step[dof]);
        let image = DVector::from_iterator(following.dofs.len(), dofs);
        let there: Vec<f64> = d_u.iter().zip(&answer.step).map(|(u, v)| u + v).collect();
        self.pair_at(end, &there)?;
        let kinematics = self.kinematics(system, end, &there);
        let forces = self.contact_forces(&kinematics, &answer.solution.force);
        let changed = forces.with(contact, |a, b| a - b);
        let left = largest(changed.iter().map(|(_, f)| f));
        let left = left.max(self.law_residual(system, &kinematics, &answer.solution));
        following.steps += 1;
        let settled = left <= following.enough;
        if settled || !left.is_finite() || following.steps >= LIMIT {
            return Ok(Followed {
                contact: forces,
                next: None,
            });
        }
        let next = following.anderson.next(&following.tried, image);
        self.pair_at(end, &at(&next))?;
        following.tried = next;
        Ok(Followed {
            contact: forces,
            next: Some(self.kinematics(system, end, reached)),
        })
    }
}
