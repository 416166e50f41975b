//! What a factorisation of sparse symmetric matrices offers, whoever does it; no algorithm.

use nalgebra::DMatrix;
use std::fmt;

use crate::pattern::Pattern;

/// What a factor takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Entries.
    pub entries: f64,
    /// Multiplications of a factorisation.
    pub operations: f64,
}

/// Signs of the eigenvalues of a symmetric matrix: by Sylvester's law those of the pivots.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Inertia {
    /// Positive eigenvalues.
    pub positive: usize,
    /// Negative eigenvalues.
    pub negative: usize,
    /// Eigenvalues that are zero to rounding.
    pub zero: usize,
}

/// A factor that is not made, or that there is no room for.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("the factor has {entries:.3e} entries, and there is room for {room:.3e}")]
pub struct TooLarge {
    /// Entries of the factor.
    pub entries: f64,
    /// Entries that there is room for.
    pub room: f64,
}

/// Why there is no factor, or no solution.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum EngineError {
    /// A pivot is not positive, in an engine that needs them positive.
    #[error("the matrix is not positive definite: the pivot of row {row} is not positive")]
    NotPositiveDefinite {
        /// Row of the pivot in the order of the matrix.
        row: usize,
    },
    /// Pivots are zero to rounding.
    #[error(
        "the matrix is singular: the pivot of row {row} is zero to rounding ({} positive, {} negative, {} zero)",
        .inertia.positive, .inertia.negative, .inertia.zero
    )]
    Singular {
        /// Row of the first such pivot in the order of the matrix.
        row: usize,
        /// Signs of all pivots.
        inertia: Inertia,
    },
    /// An entry is infinite or not a number.
    #[error("an entry of column {column} is not finite")]
    NotFinite {
        /// Column of the entry.
        column: usize,
    },
    /// Numbers of another count than the analysed pattern has.
    #[error("{found} {what} where {expected} were expected")]
    Length {
        /// What they are.
        what: &'static str,
        /// Their number.
        found: usize,
        /// What it should be, or be a multiple of.
        expected: usize,
    },
    /// The factor grew beyond its room.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// There is no factor to solve with: none was made yet, or the last one failed.
    #[error("nothing is factorised")]
    NotFactorised,
    /// A solver that is not of this crate has given up, for a reason of its own.
    #[error("the solver of the linear system gave up with its error {code} ({detail})")]
    GaveUp {
        /// The number of its error.
        code: i32,
        /// What it tells beside it.
        detail: i32,
    },
}

/// A direct solver of sparse symmetric systems of one pattern.
///
/// The pattern is analysed once; its values are factorised as often as they change; with a factor any
/// number of right-hand sides are solved for. They are columns one after the other: `x` holds a multiple of
/// [`size`](Self::size) numbers, and what a column becomes does not depend on how many go along with it.
///
/// With the last unknowns c of the pattern kept ([`Pattern::keeping`]) and i the others,
///
/// ```text
/// [K_ii K_ic] [u_i]   [f_i]
/// [K_ci K_cc] [u_c] = [f_c]
///
/// S = K_cc − K_ci K_ii⁻¹ K_ic,   g = f_c − K_ci K_ii⁻¹ f_i,   u_i = K_ii⁻¹ (f_i − K_ic u_c)
/// ```
///
/// [`schur`](Self::schur) is S, [`condense`](Self::condense) leads from f to g and
/// [`expand`](Self::expand) from u_c to u_i. An engine that must factorise all of K may refuse one
/// whose S is singular or indefinite; one that does not leaves K_cc out of the inertia.
pub trait Engine: fmt::Debug + Send + Sync {
    /// Analyses a pattern, for factors that may take `memory` \[bytes\].
    ///
    /// # Errors
    /// [`TooLarge`] if they take more.
    fn analyse(pattern: &Pattern, memory: Option<u64>) -> Result<Self, TooLarge>
    where
        Self: Sized;

    /// Number of unknowns.
    fn size(&self) -> usize;

    /// Number of last unknowns that are kept.
    fn kept(&self) -> usize;

    /// What a factor takes, with what is stored for convenience.
    fn cost(&self) -> Cost;

    /// Factorises the matrix with these values on the analysed pattern; returns the inertia of K_ii.
    ///
    /// # Errors
    /// [`EngineError`]: as many values as the pattern has entries, a matrix that this engine does not
    /// factorise, or no room. The last factor is lost.
    fn factorise(&mut self, values: &[f64]) -> Result<Inertia, EngineError>;

    /// The least pivot of the last factor beside the size of its row in the matrix: of the size of rounding
    /// where the matrix is all but singular; infinite where there is no pivot.
    fn least_pivot(&self) -> f64;

    /// x ← K⁻¹ x, of any number of columns.
    ///
    /// # Errors
    /// [`EngineError`]: without a factor, for another number of unknowns, or where S is singular.
    fn solve(&mut self, x: &mut [f64]) -> Result<(), EngineError>;

    /// Condenses loads on the kept unknowns: (f_i, f_c) becomes (f*, g), of any number of columns. What f* is,
    /// is the engine's own affair but for being linear in f_i; [`expand`](Self::expand) takes it.
    ///
    /// # Errors
    /// As [`solve`](Self::solve), but for S.
    fn condense(&mut self, x: &mut [f64]) -> Result<(), EngineError>;

    /// Expands solutions of the kept unknowns: (f*, u_c) becomes (u_i, u_c), of any number of columns.
    ///
    /// # Errors
    /// As [`condense`](Self::condense).
    fn expand(&mut self, x: &mut [f64]) -> Result<(), EngineError>;

    /// S, both of its triangles.
    ///
    /// # Errors
    /// [`EngineError::NotFactorised`].
    fn schur(&self) -> Result<DMatrix<f64>, EngineError>;
}

/// Whether so many values are those of a pattern, and numbers.
pub(crate) fn check_values(values: &[f64], pattern: &Pattern) -> Result<(), EngineError> {
    let (found, expected) = (values.len(), pattern.entries());
    let what = "values";
    if found != expected {
        return Err(EngineError::Length {
            what,
            found,
            expected,
        });
    }
    let is_finite = |j: &usize| values[pattern.range(*j)].iter().all(|v| v.is_finite());
    match (0..pattern.size()).find(|j| !is_finite(j)) {
        Some(column) => Err(EngineError::NotFinite { column }),
        None => Ok(()),
    }
}

/// Whether so many numbers are columns of so many unknowns.
pub(crate) fn check_columns(x: &[f64], size: usize) -> Result<(), EngineError> {
    let (found, expected) = (x.len(), size);
    let what = "numbers in columns of a right-hand side";
    if found == 0 || (expected > 0 && found % expected == 0) {
        Ok(())
    } else {
        Err(EngineError::Length {
            what,
            found,
            expected,
        })
    }
}

#[cfg(all(test, feature = "parallel"))]
mod tests {
    use super::*;
    use crate::common::laplacian;
    use crate::{Cholesky, Ldlt};
    use faer::Par;

    /// What the factor makes of numbers, on threads of their own.
    fn on_threads<E: Engine>(
        mut engine: E,
        values: &[f64],
        threads: usize,
    ) -> (Vec<f64>, DMatrix<f64>) {
        assert!(engine.cost().operations > 1e8);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        pool.install(|| {
            engine.factorise(values).expect("regular");
            let mut x: Vec<f64> = (0..engine.size()).map(|i| (i as f64).sin()).collect();
            engine.solve(&mut x).expect("regular");
            (x, engine.schur().expect("factorised"))
        })
    }

    #[test]
    fn a_factor_is_the_same_to_the_bit_on_any_number_of_threads() {
        for held in [0.2, -3.3] {
            let (pattern, values) = laplacian(22, held);
            let pattern = pattern.keeping(10).expect("so many");
            let ldlt = |par| Ldlt::analyse_for(&pattern, None, Some(par)).expect("small");
            let cholesky = || Cholesky::analyse(&pattern, None).expect("small");
            let one = on_threads(ldlt(Par::Seq), &values, 1);
            for threads in [1, 2, 3] {
                assert!(
                    one == on_threads(ldlt(Par::rayon(0)), &values, threads),
                    "{threads}"
                );
            }
            if held < 0.0 {
                continue;
            }
            let one = on_threads(cholesky(), &values, 1);
            for threads in [2, 3] {
                assert!(one == on_threads(cholesky(), &values, threads), "{threads}");
            }
        }
    }
}
