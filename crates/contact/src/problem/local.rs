//! The discrete frictional contact problem in its local form and how far a point is from solving it;
//! not the bodies, see [`GlobalProblem`](crate::GlobalProblem).

use super::{BlockMatrix, PAIRS, criticality, statuses};
use crate::error::{expect_finite, expect_sizes};
use crate::{ContactError, Springs};
use moreau_laws::{Friction, Local, Status};
use nalgebra::{DMatrix, DVector, Matrix3, SMatrix};

/// The discrete frictional contact problem in local form: find r and u with
///
/// ```text
/// u = W r + q,      (−u, r) extremal for [38] at every contact,
/// ```
///
/// r the contact forces \[N\] (or impulses), u the gaps and slips \[mm\] (or relative velocities),
/// W the Delassus operator \[mm/N\]: positive semi-definite, of any rank, symmetric up to rounding.
/// Where W is rank deficient the forces need not be unique.
///
/// ```
/// use moreau_contact::{Auto, BlockMatrix, LocalProblem, LocalSolver};
/// use moreau_laws::{Coulomb, Local};
/// use nalgebra::DMatrix;
///
/// // A rigid block of unit mass on two points, which cannot be told apart: W has rank two of four.
/// let w = DMatrix::from_fn(4, 4, |i, j| if i % 2 == j % 2 { 1.0 } else { 0.0 });
/// let q = vec![Local::<2>::new(-1.0, 0.5); 2];
/// let problem = LocalProblem::new(BlockMatrix::from_dense(&w)?, q, vec![Coulomb::new(0.3)?; 2])?;
/// let solution = Auto::default().solve(&problem, None)?;
/// // It slides on, slowed down by the friction of its weight.
/// assert_eq!(problem.rank(), 2);
/// assert!((solution.displacement[0] - Local::<2>::new(0.0, 0.2)).norm() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct LocalProblem<const D: usize> {
    operator: BlockMatrix<D>,
    free: Vec<Local<D>>,
    laws: Vec<Friction>,
    /// W_ii of every contact.
    own: Vec<SMatrix<f64, D, D>>,
    /// |W_ii|₂ of every contact.
    compliance: Vec<f64>,
    /// |ρ q|.
    load: f64,
}

/// Distances of a point (r, u) to the contact law, dimensionless, by the natural map of \[90′\].
///
/// F_ρ(r, u) = r − proj(r − ρ ũ, K_μ), Euclidean norms over all contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residual {
    /// |F_ρ| / max(|r|, |ρ q|) with ρ = 1/|W_ii|₂ of each contact: the same in all units.
    pub scaled: f64,
    /// |F_ρ| / |ρ q|: remains large where forces run away and make the other two small.
    pub of_load: f64,
    /// |F_1| / max(|q|, |r|, |u|), the measure of the program Siconos: adds forces to displacements,
    /// so that it depends on the units.
    pub unscaled: f64,
}

/// How much more of the load than of the forces may be left: forces may exceed the load where bodies
/// are pressed together, but not by orders of magnitude.
const LOAD: f64 = 1e3;

impl Residual {
    /// What the methods bring below their tolerance: `scaled`, and a thousandth of `of_load`.
    pub fn size(&self) -> f64 {
        self.scaled.max(self.of_load / LOAD)
    }
}

impl<const D: usize> LocalProblem<D> {
    /// A problem from W, q and the law of every contact.
    ///
    /// # Errors
    /// [`ContactError::Dimension`] if sizes disagree, [`ContactError::NotFinite`] for NaN or ∞,
    /// [`ContactError::Rigid`] where a diagonal block of W has no normal compliance.
    pub fn new(
        operator: BlockMatrix<D>,
        free: Vec<Local<D>>,
        laws: Vec<impl Into<Friction>>,
    ) -> Result<Self, ContactError> {
        let contacts = laws.len();
        expect_sizes([
            ("Delassus operator", operator.contacts(), contacts),
            ("free displacements", free.len(), contacts),
        ])?;
        expect_finite("Delassus operator", operator.entries())?;
        expect_finite("free displacements", free.iter().flatten())?;
        let own: Vec<_> = (0..contacts).map(|i| operator.diagonal(i)).collect();
        if let Some(contact) = own.iter().position(|own| own[(0, 0)] <= 0.0) {
            return Err(ContactError::Rigid {
                contact,
                compliance: own[contact][(0, 0)],
            });
        }
        let compliance: Vec<f64> = own.iter().map(spectral_norm).collect();
        let scaled = |(q, w): (&Local<D>, &f64)| (q / *w).norm_squared();
        let load = free.iter().zip(&compliance).map(scaled).sum::<f64>().sqrt();
        Ok(Self {
            own,
            operator,
            free,
            laws: laws.into_iter().map(Into::into).collect(),
            compliance,
            load,
        })
    }

    /// Number of contacts.
    pub fn contacts(&self) -> usize {
        self.laws.len()
    }

    /// The Delassus operator W.
    pub fn operator(&self) -> &BlockMatrix<D> {
        &self.operator
    }

    /// Displacements q without contact forces.
    pub fn free(&self) -> &[Local<D>] {
        &self.free
    }

    /// The law of every contact.
    pub fn laws(&self) -> &[Friction] {
        &self.laws
    }

    /// W_ii of contact i.
    #[inline]
    pub(crate) fn own(&self, i: usize) -> &SMatrix<f64, D, D> {
        &self.own[i]
    }

    /// |W_ii|₂ of contact i, the unit of everything that would otherwise need one.
    ///
    /// # Panics
    /// If there is no contact i.
    #[inline]
    pub fn compliance(&self, i: usize) -> f64 {
        self.compliance[i]
    }

    /// u = W r + q.
    ///
    /// # Panics
    /// If there are not as many forces as contacts.
    pub fn displacement(&self, r: &[Local<D>]) -> Vec<Local<D>> {
        assert_eq!(r.len(), self.contacts(), "a force a contact");
        (0..self.contacts())
            .map(|i| self.operator.row_times(i, r) + self.free[i])
            .collect()
    }

    /// Natural-map residual of forces r at u = W r + q.
    ///
    /// # Panics
    /// If there are not as many forces and displacements as contacts.
    pub fn residual(&self, r: &[Local<D>], u: &[Local<D>]) -> Residual {
        let norms = self.norms(r, u);
        Residual {
            scaled: over(norms.scaled, norms.forces.max(norms.scaled_loads)),
            of_load: over(norms.scaled, norms.scaled_loads),
            unscaled: over(
                norms.unscaled,
                norms.forces.max(norms.displacements).max(norms.loads),
            ),
        }
    }

    /// [`Residual::size`] alone, for those who ask often.
    pub(crate) fn size(&self, r: &[Local<D>], u: &[Local<D>]) -> f64 {
        let (mut map, mut forces) = (0.0, 0.0);
        for (i, law) in self.laws.iter().enumerate() {
            let rho = 1.0 / self.compliance[i];
            map += law.natural_map(&u[i], &r[i], rho).norm_squared();
            forces += r[i].norm_squared();
        }
        let (map, forces): (f64, f64) = (map.sqrt(), forces.sqrt());
        over(map, forces.max(self.load)).max(over(map, self.load) / LOAD)
    }

    /// The norms of which residuals are made.
    pub(crate) fn norms(&self, r: &[Local<D>], u: &[Local<D>]) -> Norms {
        assert_eq!([u.len(), r.len()], [self.contacts(); 2], "{PAIRS}");
        let mut squares = Norms::default();
        for (i, law) in self.laws.iter().enumerate() {
            let rho = 1.0 / self.compliance[i];
            squares.scaled += law.natural_map(&u[i], &r[i], rho).norm_squared();
            squares.unscaled += law.natural_map(&u[i], &r[i], 1.0).norm_squared();
            squares.forces += r[i].norm_squared();
            squares.displacements += u[i].norm_squared();
            squares.loads += self.free[i].norm_squared();
        }
        Norms {
            scaled: squares.scaled.sqrt(),
            unscaled: squares.unscaled.sqrt(),
            forces: squares.forces.sqrt(),
            displacements: squares.displacements.sqrt(),
            loads: squares.loads.sqrt(),
            scaled_loads: self.load,
        }
    }

    /// Status of every contact at (r, u), \[35\].
    ///
    /// # Panics
    /// If there are not as many forces and displacements as contacts.
    pub fn statuses(&self, r: &[Local<D>], u: &[Local<D>]) -> Vec<Status> {
        statuses(&self.laws, u, r, |i| 1.0 / self.compliance[i])
    }

    /// Numerical rank of W, by Cholesky's factorisation of its symmetric part with pivots down to
    /// 10⁻¹⁰ of the largest diagonal entry. Where it is less than the number of components the forces
    /// need not be unique. The cost is that of `components · rank²`.
    pub fn rank(&self) -> usize {
        let n = D * self.contacts();
        let mut half = DMatrix::<f64>::zeros(n, n);
        for i in 0..self.contacts() {
            for (j, block) in self.operator.row(i) {
                for (k, l) in (0..D).flat_map(|k| (0..D).map(move |l| (k, l))) {
                    half[(D * i + k, D * j + l)] += 0.5 * block[(k, l)];
                    half[(D * j + l, D * i + k)] += 0.5 * block[(k, l)];
                }
            }
        }
        let mut left = half.diagonal();
        let least = 1e-10 * left.max();
        let mut columns: Vec<DVector<f64>> = Vec::new();
        while columns.len() < n {
            let pivot = left.imax();
            if left[pivot] <= least {
                break;
            }
            let root = left[pivot].sqrt();
            let mut column = half.column(pivot).into_owned();
            for earlier in &columns {
                column.axpy(-earlier[pivot], earlier, 1.0);
            }
            column /= root;
            left.zip_apply(&column, |left, c| *left -= c * c);
            left[pivot] = 0.0;
            columns.push(column);
        }
        columns.len()
    }

    /// Largest ratio μ/μ_c over the contacts with its contact, μ_c = W_nn/|W_nt| of the diagonal
    /// block; `None` without contacts.
    ///
    /// A single plane contact has exactly one solution for μ < μ_c. From μ_c on it may have several,
    /// or wedge (A. Klarbring, *Ingenieur-Archiv* 60 (1990) 529-541); in space and for several
    /// contacts the ratio is an indicator, not a bound.
    pub fn criticality(&self) -> Option<(usize, f64)> {
        let moved_along = |i: usize| {
            let own = self.own(i);
            Local::<D>::from_fn(|k, _| {
                if k == 0 {
                    0.0
                } else {
                    own[(0, k)] / own[(0, 0)]
                }
            })
        };
        criticality(&self.laws, 0..self.contacts(), moved_along)
    }

    /// The problem with springs in series: u = (W + C) t + q − C t*, whose u is the part of the
    /// displacement that obeys the law. Residuals are measured as those of the problem without them.
    pub(crate) fn in_series(&self, springs: impl Fn(usize) -> Springs<D>) -> Self {
        let mut problem = self.clone();
        for i in 0..self.contacts() {
            let Springs { compliance, force } = springs(i);
            problem.operator.add_to_diagonal(i, &compliance);
            problem.own[i] += SMatrix::from_diagonal(&compliance);
            problem.free[i] -= compliance.component_mul(&force);
        }
        problem
    }
}

/// Euclidean norms over all contacts.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Norms {
    /// |F_ρ| with ρ = 1/|W_ii|₂.
    pub(crate) scaled: f64,
    /// |F_1|.
    pub(crate) unscaled: f64,
    /// |r|.
    pub(crate) forces: f64,
    /// |u|.
    pub(crate) displacements: f64,
    /// |q|.
    pub(crate) loads: f64,
    /// |ρ q|.
    pub(crate) scaled_loads: f64,
}

/// A ratio of norms; zero over zero is zero, and what has overflowed solves nothing.
pub(crate) fn over(norm: f64, scale: f64) -> f64 {
    if norm == 0.0 && scale.is_finite() {
        0.0
    } else if norm.is_finite() && scale.is_finite() {
        norm / scale
    } else {
        f64::INFINITY
    }
}

/// Largest singular value.
fn spectral_norm<const D: usize>(block: &SMatrix<f64, D, D>) -> f64 {
    let entry = |i, j| if i < D && j < D { block[(i, j)] } else { 0.0 };
    Matrix3::from_fn(entry).singular_values().max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use moreau_laws::Coulomb;

    #[test]
    fn springs_in_series_are_part_of_the_compliance() {
        let w = DMatrix::from_row_slice(
            4,
            4,
            &[
                2.0, 0.1, 0.5, 0.0, 0.1, 3.0, 0.0, 0.2, 0.5, 0.0, 2.5, 0.3, 0.0, 0.2, 0.3, 1.5,
            ],
        );
        let q = vec![Local::<2>::new(-1.0, 0.2), Local::<2>::new(0.3, -0.4)];
        let laws = vec![Coulomb::new(0.3).expect("valid"); 2];
        let w = BlockMatrix::from_dense(&w).expect("square");
        let problem = LocalProblem::new(w, q.clone(), laws).expect("valid");
        let springs = [0.5, 2.0].map(|c| Springs {
            compliance: Local::<2>::new(c, 0.1),
            force: Local::<2>::new(1.0, -2.0 * c),
        });
        let softened = problem.in_series(|i| springs[i]);
        let t = [Local::<2>::new(1.0, 0.5), Local::<2>::new(2.0, -0.5)];
        let (u, v) = (problem.displacement(&t), softened.displacement(&t));
        for i in 0..2 {
            let stretched = springs[i].elongation(&t[i]);
            assert!((v[i] - u[i] - stretched).norm() < 1e-15);
            assert_eq!(*softened.own(i), softened.operator().diagonal(i));
            assert_eq!(softened.compliance(i), problem.compliance(i));
        }
    }

    /// The quick reading of the residual is the residual, also where forces run away from the load.
    #[test]
    fn the_size_of_a_residual_is_read_alike() {
        let w = BlockMatrix::from_dense(&DMatrix::identity(4, 4)).expect("square");
        let q = vec![Local::<2>::new(-1.0, 0.2), Local::<2>::new(0.3, -0.4)];
        let laws = vec![Coulomb::new(0.3).expect("valid"); 2];
        let problem = LocalProblem::new(w, q, laws).expect("valid");
        for far in [0.0, 1.0, 1e6, 1e12] {
            let r = [Local::<2>::new(far, 0.5), Local::<2>::new(2.0, -0.5)];
            let u = problem.displacement(&r);
            let residual = problem.residual(&r, &u);
            assert!((problem.size(&r, &u) / residual.size() - 1.0).abs() < 1e-14);
            if far > 1e6 {
                assert!(residual.size() > 1e3 * residual.scaled);
            }
        }
    }
}
