//! The factor of a system, of its stiffness or with contacts tied in it: when it is made, what it costs, the signs of
//! its pivots; not what is solved with it.

use super::System;
use super::choice::SOLVE;
use crate::linear::others::Others;
use crate::timings::timed;
use moreau_algebra::{EngineError, Pattern};

/// Operations of a factorisation in the time in which a step takes up an entry of the factor.
const OPERATIONS: f64 = 200.0;

/// Pivots below this part of the diagonal are rounding, and a motion without stiffness.
const RIGID: f64 = 1e-14;

impl System {
    /// Whether the factor held is that of the elastic stiffness.
    pub(crate) fn holds_elastic_factor(&self) -> bool {
        self.elastic_factor
    }

    /// How many steps without a factorisation take about as long as one: operations of the one over
    /// what the others read of the factor.
    pub(crate) fn steps_per_factorisation(&self) -> f64 {
        let cost = self.engine.cost();
        cost.operations / (OPERATIONS * cost.entries)
    }

    /// How many solves take about as long as a factorisation.
    pub(crate) fn solves_per_factorisation(&self) -> f64 {
        let cost = self.engine.cost();
        cost.operations / (SOLVE * cost.entries)
    }

    /// Factorises the assembled K + σE, unless the factor held is already that of the elastic
    /// stiffness and the stiffness assembled is elastic too.
    ///
    /// # Errors
    /// The degree of freedom at which K + σE is not positive definite.
    pub(crate) fn factorise(&mut self, elastic: bool) -> Result<(), usize> {
        if elastic && self.elastic_factor {
            return Ok(());
        }
        self.elastic_factor = false;
        self.gave_up = None;
        self.factorisations += 1;
        let (interface, shift) = (self.interface, self.shift);
        let inertia = timed(&mut self.timings.factorisation, || {
            let matrix = match &mut self.coarse {
                Some(coarse) => {
                    self.others.iter().for_each(Others::project);
                    coarse.space.project(&self.matrix)?;
                    coarse.space.matrix_mut()
                }
                None => &mut self.matrix,
            };
            matrix.shift(interface, shift);
            self.engine.factorise(matrix.values())
        })
        .inspect_err(|error| {
            let is_of_the_matrix = matches!(
                error,
                EngineError::NotPositiveDefinite { .. } | EngineError::Singular { .. }
            );
            self.gave_up = (!is_of_the_matrix).then_some(*error);
        })
        .map_err(|error| {
            let dofs = self.coarse.as_ref().map_or(&self.dofs, |c| &c.dofs);
            match error {
                EngineError::NotPositiveDefinite { row } | EngineError::Singular { row, .. } => {
                    dofs[row]
                }
                _ => dofs.last().copied().unwrap_or(0),
            }
        })?;
        self.negative = inertia.negative;
        self.unstable |= self.is_indefinite();
        self.elastic_factor = elastic;
        self.current = true;
        Ok(())
    }

    /// Why the engine has no factor, where that is no fault of the matrix.
    pub(crate) fn gave_up(&self) -> Option<EngineError> {
        self.gave_up
    }

    /// Whether the matrix that the factor was made of has negative eigenvalues, its interface aside.
    pub(crate) fn is_indefinite(&self) -> bool {
        self.negative > 0
    }

    /// Whether some matrix of the increment had.
    pub(crate) fn was_indefinite(&self) -> bool {
        self.unstable
    }

    /// How many it has: K without its interface, or K and what is tied.
    pub(crate) fn negative(&self) -> usize {
        self.negative
    }

    /// Whether contacts are tied in the factor.
    pub(crate) fn is_tied(&self) -> bool {
        self.tied.is_some()
    }

    /// Factorises K and what `ties` adds to its values; false where the sum leaves a motion without
    /// stiffness.
    pub(crate) fn tie(&mut self, ties: impl FnOnce(&Pattern, &mut [f64])) -> bool {
        let mut sum = self.tied.take().unwrap_or_default();
        sum.clear();
        sum.extend_from_slice(self.matrix.values());
        ties(&self.matrix.pattern, &mut sum);
        self.elastic_factor = false;
        self.factorisations += 1;
        let outcome = timed(&mut self.timings.factorisation, || {
            self.engine.factorise(&sum)
        });
        let holds = outcome.is_ok() && self.engine.least_pivot() > RIGID;
        if let (Ok(inertia), true) = (outcome, holds) {
            self.negative = inertia.negative;
            self.unstable |= self.is_indefinite();
        }
        if let Some(others) = &mut self.others {
            others.factorised(holds);
        }
        match holds {
            true => sum.copy_from_slice(self.matrix.values()),
            false => sum.clear(),
        }
        self.tied = Some(sum);
        holds
    }

    /// Whether the factor at hand is that of K and of ties.
    pub(crate) fn holds_ties(&self) -> bool {
        let others = self.others.as_ref().is_none_or(Others::is_factorised);
        others && self.tied.as_deref() == Some(self.matrix.values())
    }

    /// Begins an increment, which does the same whatever factor the last one has left.
    pub(crate) fn begin(&mut self) {
        self.tied.iter_mut().for_each(Vec::clear);
        self.unstable = false;
    }

    /// The factor held is of no use to the next increment.
    pub(crate) fn forget_factor(&mut self) {
        self.elastic_factor = false;
    }
}
