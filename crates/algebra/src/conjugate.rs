//! Conjugate gradients for a system that has no factor of its own; not its coarse space.

use nalgebra::DVector;

use crate::coarse::{CoarseSpace, check};
use crate::engine::{Engine, EngineError};
use crate::matrix::Matrix;

/// What the interface does: the unknowns that are kept, the last of all.
pub enum Interface<'a> {
    /// It is as free as the other unknowns.
    Free,
    /// It stays where it is.
    Held,
    /// It moves as far as it is let: so under forces condensed on it.
    Yields(&'a dyn Fn(&DVector<f64>) -> DVector<f64>),
}

/// A symmetric matrix as the iteration sees it, whoever holds its entries.
pub trait Operator {
    /// Number of rows.
    fn size(&self) -> usize;

    /// r ← r − A x.
    fn subtract_product(&self, x: &[f64], r: &mut [f64]);

    /// A sweep of Gauss and Seidel over the first `rows` of A x = b, from nothing, in an order of its own; writes to
    /// `left` what that leaves of b.
    fn sweep_down(&self, b: &[f64], rows: usize, x: &mut [f64], left: &mut [f64]);

    /// The sweep back, in the order that is the reverse of that; `b` is overwritten.
    fn sweep_up(&self, b: &mut [f64], rows: usize, x: &mut [f64]);

    /// b − A x.
    fn residual(&self, x: &[f64], b: &[f64]) -> Vec<f64> {
        let mut r = b.to_vec();
        self.subtract_product(x, &mut r);
        r
    }
}

impl Operator for Matrix {
    fn size(&self) -> usize {
        self.pattern.size()
    }

    fn subtract_product(&self, x: &[f64], r: &mut [f64]) {
        self.subtract_product(x, r);
    }

    fn sweep_down(&self, b: &[f64], rows: usize, x: &mut [f64], left: &mut [f64]) {
        self.sweep_down(b, |row| row < rows, x, left);
    }

    fn sweep_up(&self, b: &mut [f64], rows: usize, x: &mut [f64]) {
        self.sweep_up(b, |row| row < rows, x);
    }
}

/// When an iteration ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Part of the first residual, in the norm of the preconditioner.
    pub part: f64,
    /// Iterations after which it ends wherever it is.
    pub limit: usize,
}

/// A u = f as far as the interface lets it.
///
/// Preconditioned from below and above by sweeps of Gauss and Seidel, and between them by the factor of
/// the coarse space: an error that is smooth is one of the coarse space, what is left of it is local. With
/// a coarse space that is as fine as the system but for a factor, the number of iterations does not depend
/// on its size.
pub struct ConjugateGradients<'a> {
    /// A, positive definite but for what the interface holds.
    pub matrix: &'a dyn Operator,
    /// Its coarse space.
    pub space: &'a CoarseSpace,
    /// Holds the factor of the matrix of that.
    pub engine: &'a mut dyn Engine,
    /// What the unknowns do that the coarse space keeps.
    pub interface: Interface<'a>,
    /// When it ends.
    pub stop: Stop,
}

impl ConjugateGradients<'_> {
    /// Brings u nearer to the solution; returns the number of iterations: none, and u as it was, where an entry is no number.
    ///
    /// # Errors
    /// [`EngineError`]: matrix, space, engine and vectors of other sizes, or nothing factorised.
    pub fn improve(&mut self, f: &[f64], u: &mut [f64]) -> Result<usize, EngineError> {
        let n = self.matrix.size();
        check("unknowns of a solution", u.len(), n)?;
        check("numbers of a right-hand side", f.len(), n)?;
        check("unknowns of a coarse space", self.space.fine_size(), n)?;
        check(
            "unknowns of a factor",
            self.engine.size(),
            self.space.size(),
        )?;
        let mut r = self.matrix.residual(u, f);
        let (mut z, mut p, mut room) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let (mut before, mut target) = (f64::INFINITY, f64::NAN);
        for iteration in 0..self.stop.limit {
            self.precondition(&r, &mut z, &mut room)?;
            let now = dot(&r, &z);
            if iteration == 0 {
                target = self.stop.part.powi(2) * now;
            }
            if now <= target || now.is_nan() {
                return Ok(iteration);
            }
            let beta = now / before;
            for (p, z) in p.iter_mut().zip(&z) {
                *p = z + beta * *p;
            }
            before = now;
            // −A p.
            let q = &mut room;
            q.fill(0.0);
            self.matrix.subtract_product(&p, q);
            let curvature = -dot(&p, q);
            // A direction without stiffness is none to go along; what is found so far leads downhill.
            if curvature <= 0.0 || curvature.is_nan() {
                return Ok(iteration);
            }
            let alpha = now / curvature;
            for (u, p) in u.iter_mut().zip(&p) {
                *u += alpha * p;
            }
            for (r, q) in r.iter_mut().zip(&*q) {
                *r += alpha * q;
            }
        }
        Ok(self.stop.limit)
    }

    /// z ← M⁻¹ r: a sweep down, the coarse solution for what that leaves, a sweep up. The sweeps leave
    /// the interface alone unless it is free. `room` is as long as both.
    ///
    /// # Errors
    /// As [`improve`](Self::improve), whose checks of sizes it leaves to the caller.
    fn precondition(
        &mut self,
        r: &[f64],
        z: &mut [f64],
        room: &mut [f64],
    ) -> Result<(), EngineError> {
        let rows = match self.interface {
            Interface::Free => r.len(),
            Interface::Held | Interface::Yields(_) => r.len() - self.engine.kept(),
        };
        self.matrix.sweep_down(r, rows, z, room);
        let mut w = self.space.restrict(room);
        let inner = w.len() - self.engine.kept();
        match self.interface {
            Interface::Free => self.engine.solve(&mut w)?,
            Interface::Held => {
                self.engine.condense(&mut w)?;
                w[inner..].fill(0.0);
                self.engine.expand(&mut w)?;
            }
            Interface::Yields(displacement) => {
                self.engine.condense(&mut w)?;
                let x = displacement(&DVector::from_column_slice(&w[inner..]));
                check("displacements of the interface", x.len(), w.len() - inner)?;
                w[inner..].copy_from_slice(x.as_slice());
                self.engine.expand(&mut w)?;
            }
        }
        self.space.prolong(&w, z);
        room.copy_from_slice(r);
        self.matrix.sweep_up(room, rows, z);
        Ok(())
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests;
