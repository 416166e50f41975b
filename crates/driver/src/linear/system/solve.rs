//! Solves with a factorised system: condensed on its interface, bordered, and expanded again; not its
//! assembly.

use super::System;
use crate::error::Inaccurate;
use crate::linear::everywhere::Everywhere;
use crate::timings::{Clock, timed};
use crate::vector::SparseVector;
use crate::vector::largest;
use moreau_algebra::{ConjugateGradients, EngineError, Interface, Stop};
use nalgebra::{DMatrix, DVector};

/// Residual of a solve with the factor, over the size of the terms that it is a difference of, up
/// to which the factor is right: a thousand times what rounding leaves.
const ACCURATE: f64 = 1e-12;

/// Where conjugate gradients end: Newton's method, which they serve, loses little of its speed.
const STOP: Stop = Stop {
    part: 1e-2,
    limit: 400,
};

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

/// A solution that there is none of is no number, which the check of the residual tells.
fn told(outcome: Result<(), EngineError>, x: &mut [f64]) {
    if outcome.is_err() {
        x.fill(f64::NAN);
    }
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

    /// Solves the factorised system, without a shift, for a load at every degree of freedom \[N\];
    /// prescribed displacements in `d_u` are left as they are.
    ///
    /// # Errors
    /// [`Inaccurate`] where the factor does not solve the system.
    pub(crate) fn solve(&mut self, load: &[f64], d_u: &mut [f64]) -> Result<(), Inaccurate> {
        let applied = self.at_unknowns(|dof| load[dof]);
        let mut solution = self.restricted(&applied);
        let clock = Clock::start();
        told(self.engine.solve(&mut solution), &mut solution);
        let mut solution = self.prolonged(solution);
        let outcome = self.improve(&applied, &mut solution, Interface::Free);
        self.timings.solution += clock.elapsed();
        self.spread(&solution, d_u);
        outcome
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

    /// x ← (K + what is tied)⁻¹ x, at the unknowns.
    pub(crate) fn solve_tied(&mut self, x: &mut [f64]) {
        let clock = Clock::start();
        told(self.engine.solve(x), x);
        self.timings.solution += clock.elapsed();
    }

    /// f − K u at the unknowns, and what rounding leaves of it, with f a sum of forces as large as `given`.
    pub(crate) fn left(&self, f: &[f64], u: &[f64], given: f64) -> (Vec<f64>, f64) {
        let rounding = given + self.stiffest * largest(u.iter().copied());
        (self.residual(u, f), ACCURATE * rounding)
    }

    /// Writes displacements of the unknowns to `d_u` at every degree of freedom; prescribed ones are left as they are.
    pub(crate) fn spread(&self, u: &[f64], d_u: &mut [f64]) {
        for (&dof, &u) in self.dofs.iter().zip(u) {
            self.prescribed.directions.set(dof, u, d_u);
        }
    }

    /// A load on the unknowns that are factorised.
    fn restricted(&self, load: &[f64]) -> Vec<f64> {
        let coarse = self.coarse.as_ref();
        coarse.map_or_else(|| load.to_vec(), |c| c.space.restrict(load))
    }

    /// Displacements of all unknowns by those that are factorised.
    fn prolonged(&self, solution: Vec<f64>) -> Vec<f64> {
        let Some(coarse) = &self.coarse else {
            return solution;
        };
        let mut all = vec![0.0; self.size()];
        coarse.space.prolong(&solution, &mut all);
        all
    }

    /// Makes u solve K u = f but for what the factor lacks: rounding, or what the coarse space does
    /// not have.
    fn improve(
        &mut self,
        f: &[f64],
        u: &mut [f64],
        interface: Interface<'_>,
    ) -> Result<(), Inaccurate> {
        let Some(coarse) = &self.coarse else {
            let rows = match interface {
                Interface::Free => self.size(),
                // Down there x is given, and the forces are those of the contact problem.
                Interface::Held | Interface::Yields(_) => self.size() - self.interface,
            };
            return self.refine(f, u, rows);
        };
        let mut system = ConjugateGradients {
            matrix: &Everywhere {
                matrix: &self.matrix,
                others: self.others.as_ref(),
            },
            space: &coarse.space,
            engine: self.engine.as_mut(),
            interface,
            stop: STOP,
        };
        let iterations = system.improve(f, u);
        self.conjugate += iterations.unwrap_or(0);
        told(iterations.map(|_| ()), u);
        Ok(())
    }

    /// Checks the first `rows` rows of K u = f, with the others of u given, and corrects u once
    /// where they do not hold: faults of memory and of kernels corrupt a factor silently. The first
    /// solve with a factor tells; later ones are of another matrix.
    fn refine(&mut self, f: &[f64], u: &mut [f64], rows: usize) -> Result<(), Inaccurate> {
        if !self.current {
            return Ok(());
        }
        let mut refined = false;
        loop {
            let mut residual = self.residual(u, f);
            residual[rows..].fill(0.0);
            let found = largest(residual.iter().copied());
            let motion = largest(u.iter().copied());
            let expected = ACCURATE * (largest(f.iter().copied()) + self.stiffest * motion);
            // A displacement that is not finite has no bound.
            if found.is_finite() && found <= expected {
                return Ok(());
            }
            if refined {
                self.elastic_factor = false;
                return Err(Inaccurate { found, expected });
            }
            if rows == residual.len() {
                told(self.engine.solve(&mut residual), &mut residual);
            } else {
                told(self.engine.condense(&mut residual), &mut residual);
                residual[rows..].fill(0.0);
                told(self.engine.expand(&mut residual), &mut residual);
            }
            for (u, correction) in u.iter_mut().zip(residual) {
                *u += correction;
            }
            refined = true;
        }
    }
}
