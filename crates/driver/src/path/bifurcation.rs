//! How a structure gives way where its equilibrium is unstable; not whether it is.

use super::buckling::noise;
use crate::driver::Driver;
use crate::interface::free::Free;
use crate::linear::system::System;
use crate::newton::iterate::Candidate;
use crate::vector::SparseVector;
use moreau_algebra::{DenseLdlt, Interface};
use nalgebra::{DMatrix, DVector};

/// Directions of Lanczos' method at most: past a bifurcation one eigenvalue is far nearer to zero than the others.
const MOST: usize = 30;
/// Relative change of 1/λ at which it has settled.
const SETTLED: f64 = 1e-9;

impl<const D: usize> Driver<D> {
    /// The eigenvector v of the negative eigenvalue nearest to zero of the factorised tangent, K v = λ v with what
    /// the statuses of a converged increment leave free: displacement at every degree of freedom, of size 1 at the node that moves most. By
    /// Lanczos' method on K⁻¹; `None` where it finds no negative eigenvalue.
    pub(crate) fn unstable_mode(
        &self,
        system: &mut System,
        candidate: &Candidate<D>,
    ) -> Option<Vec<f64>> {
        let status = &candidate.solution.status;
        let free = match system.is_tied() {
            true => None,
            false => self.free(system, &candidate.kinematics, status),
        };
        let factor = free.as_ref().and_then(Free::factor);
        let interface = free.as_ref().zip(factor.as_ref());
        let (n, dofs) = (self.state.displacement.len(), self.mesh_dofs());
        let mut directions: Vec<DVector<f64>> = Vec::new();
        let mut projected = DMatrix::zeros(MOST, MOST);
        let mut q = DVector::from_vec(noise(n, dofs)).try_normalize(0.0)?;
        let mut least = 0.0;
        let mut weights = DVector::zeros(0);
        for k in 0..MOST {
            let mut next = self.compliance(system, interface, q.as_slice().to_vec())?;
            directions.push(q);
            // Twice is enough for directions that stay orthogonal to rounding.
            for pass in 0..2 {
                for (j, direction) in directions.iter().enumerate() {
                    let part = direction.dot(&next);
                    next.axpy(-part, direction, 1.0);
                    if pass == 0 && j + 1 >= k {
                        projected[(j, k)] = part;
                        projected[(k, j)] = part;
                    }
                }
            }
            let eigen = projected
                .view((0, 0), (k + 1, k + 1))
                .into_owned()
                .symmetric_eigen();
            let before = least;
            let (at, value) = eigen.eigenvalues.argmin();
            (least, weights) = (value, eigen.eigenvectors.column(at).into_owned());
            let settled = k > 2 && (least - before).abs() <= SETTLED * least.abs();
            match next.try_normalize(f64::EPSILON * least.abs()) {
                Some(normed) if !settled => q = normed,
                _ => break,
            }
        }
        if least >= 0.0 {
            return None;
        }
        let mut mode = DVector::zeros(n);
        for (direction, &weight) in directions.iter().zip(&weights) {
            mode.axpy(weight, direction, 1.0);
        }
        self.normalised(mode.as_slice())
    }

    /// How the body moves along its path of equilibria: at a limit of the load the mode in which it gives way.
    pub(crate) fn path_mode(&self) -> Option<Vec<f64>> {
        let (last, _) = self.state.last.as_ref()?;
        self.normalised(last)
    }

    /// A motion of size 1 at the node that moves most.
    fn normalised(&self, motion: &[f64]) -> Option<Vec<f64>> {
        let motion = &motion[..self.mesh_dofs()];
        let size = |v: &[f64]| v.iter().fold(0.0, |l: f64, x| l.hypot(*x));
        let largest = motion.chunks_exact(D).map(size).fold(0.0, f64::max);
        (largest > 0.0).then(|| motion.iter().map(|x| x / largest).collect())
    }

    /// K⁻¹ f on what the interface leaves free, or with contacts tied as they are.
    pub(crate) fn compliance(
        &self,
        system: &mut System,
        interface: Option<(&Free, &DenseLdlt)>,
        force: Vec<f64>,
    ) -> Option<DVector<f64>> {
        let mut v = vec![0.0; force.len()];
        if system.is_tied() {
            let mut x = system.at_unknowns(|dof| force[dof]);
            system.solve_tied(&mut x);
            system.spread(&x, &mut v);
        } else {
            let condensed = system.condense(force);
            let x = match interface {
                Some((free, factor)) => free.displacement(factor, &condensed.load),
                None => DVector::zeros(condensed.load.len()),
            };
            let nothing = (&SparseVector::default(), Interface::Held);
            system.expand(condensed, &x, nothing, &mut v).ok()?;
        }
        v.iter()
            .all(|x| x.is_finite())
            .then(|| DVector::from_vec(v))
    }
}
