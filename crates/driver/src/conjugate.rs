//! Conjugate gradients for a system that has no factor of its own; not its coarse space.

use crate::cholesky::Cholesky;
use crate::coarse::Coarse;
use crate::matrix::Matrix;

/// Part of the residual at which the iteration ends: Newton's method, which it serves, loses little of
/// its speed.
const PART: f64 = 1e-2;

/// Iterations after which it ends wherever it is.
const LIMIT: usize = 400;

/// The first `rows` of K u = f, with the other u given.
///
/// Preconditioned from below and above by sweeps of Gauss and Seidel, and between them by the factor
/// of the coarse space: an error that is smooth is one of linear cells, what is left of it is local.
/// The number of iterations does not depend on the size of the mesh.
pub(crate) struct Conjugate<'a> {
    pub(crate) matrix: &'a Matrix,
    pub(crate) coarse: &'a Coarse,
    /// The factor of the coarse matrix.
    pub(crate) cholesky: &'a mut Cholesky,
    pub(crate) rows: usize,
    /// Number of the coarse unknowns that the given u are: the last.
    pub(crate) given: usize,
}

impl Conjugate<'_> {
    /// Brings u nearer to the solution; returns the number of iterations.
    pub(crate) fn improve(&mut self, f: &[f64], u: &mut [f64]) -> usize {
        let n = u.len();
        let mut r = self.matrix.residual(u, f);
        r[self.rows..].fill(0.0);
        let mut z = vec![0.0; n];
        let mut room = vec![0.0; n];
        let mut p = vec![0.0; n];
        let mut before = f64::INFINITY;
        let target = PART * dot(&r, &r).sqrt();
        for iteration in 0..LIMIT {
            if dot(&r, &r).sqrt() <= target {
                return iteration;
            }
            self.precondition(&r, &mut z, &mut room);
            let now = dot(&r, &z);
            let beta = now / before;
            for (p, z) in p.iter_mut().zip(&z) {
                *p = z + beta * *p;
            }
            before = now;
            // −K p.
            let q = &mut room;
            q.fill(0.0);
            self.matrix.subtract_product(&p, q);
            q[self.rows..].fill(0.0);
            let curvature = -dot(&p, q);
            // A direction without stiffness is none to go along; what is found so far leads downhill.
            if !(curvature > 0.0 && now > 0.0) {
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

    /// z ← M⁻¹ r: a sweep down, the coarse solution for what that leaves, a sweep up.
    fn precondition(&mut self, r: &[f64], z: &mut [f64], room: &mut [f64]) {
        self.matrix.sweep_down(r, self.rows, z);
        self.matrix.left(z, self.rows, room);
        let mut w = self.coarse.restrict(room);
        let free = w.len() - self.given;
        self.cholesky.forward(&mut w);
        w[free..].fill(0.0);
        self.cholesky.backward(&mut w);
        self.coarse.prolong(&w, z);
        room.copy_from_slice(r);
        self.matrix.sweep_up(room, self.rows, z);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
