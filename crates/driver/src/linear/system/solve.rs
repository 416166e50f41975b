//! Solves with a factorised system, and whether they are accurate; not its condensation.

use super::System;
use crate::error::Inaccurate;
use crate::linear::everywhere::Everywhere;
use crate::timings::Clock;
use crate::vector::largest;
use moreau_algebra::{ConjugateGradients, EngineError, Interface, Stop};

/// Residual of a solve with the factor, over the size of the terms that it is a difference of, up
/// to which the factor is right: a thousand times what rounding leaves.
const ACCURATE: f64 = 1e-12;

/// Where conjugate gradients end: Newton's method, which they serve, loses little of its speed.
const STOP: Stop = Stop {
    part: 1e-2,
    limit: 400,
};

/// A solution that there is none of is no number, which the check of the residual tells.
pub(super) fn told(outcome: Result<(), EngineError>, x: &mut [f64]) {
    if outcome.is_err() {
        x.fill(f64::NAN);
    }
}

impl System {
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

    /// x ← (K + what is tied)⁻¹ x, at the unknowns.
    pub(crate) fn solve_tied(&mut self, x: &mut [f64]) {
        let clock = Clock::start();
        told(self.engine.solve(x), x);
        self.timings.solution += clock.elapsed();
    }

    /// f − K u.
    fn residual(&self, u: &[f64], f: &[f64]) -> Vec<f64> {
        let mut r = self.matrix.residual(u, f);
        if let Some(others) = &self.others {
            others.subtract_product(u, &mut r);
        }
        r
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
    pub(super) fn restricted(&self, load: &[f64]) -> Vec<f64> {
        let coarse = self.coarse.as_ref();
        coarse.map_or_else(|| load.to_vec(), |c| c.space.restrict(load))
    }

    /// Displacements of all unknowns by those that are factorised.
    pub(super) fn prolonged(&self, solution: Vec<f64>) -> Vec<f64> {
        let Some(coarse) = &self.coarse else {
            return solution;
        };
        let mut all = vec![0.0; self.size()];
        coarse.space.prolong(&solution, &mut all);
        all
    }

    /// Makes u solve K u = f but for what the factor lacks: rounding, or what the coarse space does
    /// not have.
    pub(super) fn improve(
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
