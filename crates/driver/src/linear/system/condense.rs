//! A factorised system condensed on its interface, bordered, and expanded again; not what is solved there.

use super::System;
use super::solve::told;
use crate::error::Inaccurate;
use crate::timings::{Clock, timed};
use crate::vector::SparseVector;
use moreau_algebra::Interface;
use nalgebra::{DMatrix, DVector};

/// A load q of unknown factor in a condensed system, and the equation that decides it:
/// q·u + c λ = m.
#[derive(Debug)]
pub(crate) struct Border {
    /// q at the unknowns \[N\].
    applied: Vec<f64>,
    /// q as it is condensed.
    inner: Vec<f64>,
    /// q̃, q condensed on the interface \[N\].
    load: DVector<f64>,
    /// c + q·u of the interior under q alone, the interface held \[N·mm\].
    compliance: f64,
    /// m less what the interior does under the other loads, the interface held \[N·mm\].
    missing: f64,
}

/// A load condensed on the interface of a system.
#[derive(Debug)]
pub(crate) struct Condensed {
    /// f̃ \[N\], in the order of the interface unknowns.
    pub(crate) load: DVector<f64>,
    /// The load of the system \[N\].
    applied: Vec<f64>,
    /// The same as it is condensed, which is to be expanded.
    inner: Vec<f64>,
}

impl System {
    /// Condenses the factorised system under a load given at every degree of freedom \[N\].
    pub(crate) fn condense(&mut self, load: Vec<f64>) -> Condensed {
        let applied = self.at_unknowns(|dof| load[dof]);
        drop(load);
        let mut inner = self.restricted(&applied);
        timed(&mut self.timings.solution, || {
            told(self.engine.condense(&mut inner), &mut inner)
        });
        let first = inner.len() - self.interface;
        Condensed {
            load: DVector::from_column_slice(&inner[first..]),
            applied,
            inner,
        }
    }

    /// S \[N/mm\], the stiffness condensed on the interface: that of K + σE less σ 1.
    pub(crate) fn schur(&mut self) -> DMatrix<f64> {
        let clock = Clock::start();
        let size = self.interface;
        let unknown = |_| DMatrix::from_element(size, size, f64::NAN);
        let mut stiffness = self.engine.schur().unwrap_or_else(unknown);
        for i in 0..size {
            stiffness[(i, i)] -= self.shift;
        }
        self.timings.contact += clock.elapsed();
        stiffness
    }

    /// Borders the condensed system, its stiffness and its load, with the load q of unknown factor λ and the equation
    /// q·u + c λ = m; λ is eliminated, which leaves the system as symmetric as it was:
    /// S + q̃ q̃ᵀ / (c + κ) with κ = q_i·K_ii⁻¹ q_i.
    pub(crate) fn border(
        &mut self,
        (stiffness, condensed): (&mut DMatrix<f64>, &mut Condensed),
        load: &SparseVector,
        (compliance, missing): (f64, f64),
    ) -> Border {
        let applied = self.at_unknowns(|dof| load.at(dof));
        let restricted = self.restricted(&applied);
        let mut inner = restricted.clone();
        let first = inner.len() - self.interface;
        // K_ii⁻¹ q_i, the interface held.
        let mut held = Vec::new();
        timed(&mut self.timings.solution, || {
            told(self.engine.condense(&mut inner), &mut inner);
            held.clone_from(&inner);
            held[first..].fill(0.0);
            told(self.engine.expand(&mut held), &mut held);
        });
        let work = |load: &[f64]| -> f64 {
            let pairs = load[..first].iter().zip(&held[..first]);
            pairs.map(|(f, u)| f * u).sum()
        };
        let border = Border {
            load: DVector::from_column_slice(&inner[first..]),
            compliance: compliance + work(&restricted),
            missing: missing - work(&self.restricted(&condensed.applied)),
            applied,
            inner,
        };
        let scale = 1.0 / border.compliance;
        stiffness.ger(scale, &border.load, &border.load, 1.0);
        condensed
            .load
            .axpy(scale * border.missing, &border.load, 1.0);
        border
    }

    /// The factor of the load of a bordered system for the interface displacements x; the load
    /// takes its part in what [`System::expand`] makes of them.
    pub(crate) fn factor(
        &self,
        border: &Border,
        condensed: &mut Condensed,
        x: &DVector<f64>,
    ) -> f64 {
        let factor = (border.missing - border.load.dot(x)) / border.compliance;
        let interior = condensed.inner.len() - self.interface;
        let pairs = condensed.inner.iter_mut().zip(&border.inner);
        pairs.take(interior).for_each(|(f, w)| *f += factor * w);
        let pairs = condensed.applied.iter_mut().zip(&border.applied);
        pairs.for_each(|(f, q)| *f += factor * q);
        factor
    }

    /// Displacement of all free degrees of freedom for the interface displacements x, written to
    /// `d_u` at every degree of freedom; prescribed ones are left as they are. `contact` are the
    /// contact forces \[N\], under which the interface may do what it does.
    ///
    /// # Errors
    /// [`Inaccurate`] where the factor does not solve the system.
    pub(crate) fn expand(
        &mut self,
        condensed: Condensed,
        x: &DVector<f64>,
        (contact, interface): (&SparseVector, Interface<'_>),
        d_u: &mut [f64],
    ) -> Result<(), Inaccurate> {
        let mut solution = condensed.inner;
        let first = solution.len() - self.interface;
        solution[first..].copy_from_slice(x.as_slice());
        let clock = Clock::start();
        told(self.engine.expand(&mut solution), &mut solution);
        let mut solution = self.prolonged(solution);
        let mut applied = condensed.applied;
        for (dof, f) in contact.iter() {
            let parts = self.prescribed.directions.parts(dof);
            for (dof, part) in parts.filter(|&(dof, _)| self.is_free(dof)) {
                applied[self.position[dof] as usize] += part * f;
            }
        }
        let outcome = self.improve(&applied, &mut solution, interface);
        self.timings.solution += clock.elapsed();
        self.spread(&solution, d_u);
        outcome
    }
}
