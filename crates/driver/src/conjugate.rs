//! Conjugate gradients for a system that has no factor of its own; not its coarse space.

use crate::coarse::Coarse;
use moreau_algebra::{Engine, Matrix};
use nalgebra::DVector;

/// Part of the residual, in the norm of the preconditioner, at which the iteration ends: Newton's
/// method, which it serves, loses little of its speed.
const PART: f64 = 1e-2;

/// Iterations after which it ends wherever it is.
const LIMIT: usize = 400;

/// What the interface does, the last of the unknowns.
pub(crate) enum Interface<'a> {
    /// It is as free as the other unknowns.
    Free,
    /// It stays where it is.
    Held,
    /// It moves as far as its contacts let it: so under forces condensed on it.
    Yields(&'a dyn Fn(&DVector<f64>) -> DVector<f64>),
}

/// K u = f as far as the interface lets it.
///
/// Preconditioned from below and above by sweeps of Gauss and Seidel, and between them by the factor
/// of the coarse space: an error that is smooth is one of linear cells, what is left of it is local.
/// The number of iterations does not depend on the size of the mesh.
pub(crate) struct Conjugate<'a> {
    pub(crate) matrix: &'a Matrix,
    pub(crate) coarse: &'a Coarse,
    /// Holds the factor of the coarse matrix.
    pub(crate) engine: &'a mut dyn Engine,
    pub(crate) interface: Interface<'a>,
    /// Its size.
    pub(crate) size: usize,
}

impl Conjugate<'_> {
    /// Brings u nearer to the solution; returns the number of iterations.
    pub(crate) fn improve(&mut self, f: &[f64], u: &mut [f64]) -> usize {
        let n = u.len();
        let mut r = self.matrix.residual(u, f);
        let (mut z, mut p, mut room) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let (mut before, mut target) = (f64::INFINITY, f64::NAN);
        for iteration in 0..LIMIT {
            self.precondition(&r, &mut z, &mut room);
            let now = dot(&r, &z);
            if iteration == 0 {
                target = PART * PART * now;
            }
            if now <= target || now.is_nan() {
                return iteration;
            }
            let beta = now / before;
            for (p, z) in p.iter_mut().zip(&z) {
                *p = z + beta * *p;
            }
            before = now;
            // −K p.
            let q = &mut room;
            q.fill(0.0);
            self.matrix.subtract_product(&p, q);
            let curvature = -dot(&p, q);
            // A direction without stiffness is none to go along; what is found so far leads downhill.
            if curvature <= 0.0 || curvature.is_nan() {
                return iteration;
            }
            let alpha = now / curvature;
            for (u, p) in u.iter_mut().zip(&p) {
                *u += alpha * p;
            }
            for (r, q) in r.iter_mut().zip(&*q) {
                *r += alpha * q;
            }
        }
        LIMIT
    }

    /// z ← M⁻¹ r: a sweep down, the coarse solution for what that leaves, a sweep up. The sweeps leave
    /// the interface alone unless it is free.
    fn precondition(&mut self, r: &[f64], z: &mut [f64], room: &mut [f64]) {
        let rows = match self.interface {
            Interface::Free => r.len(),
            Interface::Held | Interface::Yields(_) => r.len() - self.size,
        };
        self.matrix.sweep_down(r, rows, z, room);
        let mut w = self.coarse.restrict(room);
        let interior = w.len() - self.size;
        let solved = match self.interface {
            Interface::Free => self.engine.solve(&mut w),
            Interface::Held | Interface::Yields(_) => {
                let condensed = self.engine.condense(&mut w);
                let tail = &mut w[interior..];
                match self.interface {
                    Interface::Yields(displacement) => {
                        let x = displacement(&DVector::from_column_slice(tail));
                        tail.copy_from_slice(x.as_slice());
                    }
                    _ => tail.fill(0.0),
                }
                condensed.and(self.engine.expand(&mut w))
            }
        };
        if solved.is_err() {
            w.fill(f64::NAN);
        }
        self.coarse.prolong(&w, z);
        room.copy_from_slice(r);
        self.matrix.sweep_up(room, rows, z);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
