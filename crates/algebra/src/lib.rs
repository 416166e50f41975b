//! Sparse symmetric systems: their order, their factors, definite or not, for any number of right-hand
//! sides, their Schur complements on the last unknowns, coarse spaces and conjugate gradients; and the dense
//! systems that this leaves. No mesh, no law, no contact.
//!
//! | what | here |
//! |---|---|
//! | order of the unknowns, by nested dissection of their graph | [`nested_dissection`] |
//! | where the entries are, and which unknowns are kept | [`Pattern`] |
//! | their values, products and sweeps | [`Matrix`] |
//! | what a direct solver offers: factorise, solve, condense, expand, inertia | [`Engine`] |
//! | L Lᵀ = A of positive definite matrices | [`Cholesky`] |
//! | L D Lᵀ = A of any symmetric matrix, and the signs of its eigenvalues | [`Ldlt`] |
//! | whichever of both a matrix has, matrix by matrix | [`Either`] |
//! | what a factor will take, before there is one | [`Cost`] |
//! | fewer unknowns that the others follow, and Pᵀ A P | [`CoarseSpace`] |
//! | conjugate gradients, preconditioned by sweeps and the factor of a coarse space | [`ConjugateGradients`] |
//! | Tᵀ S T of dense matrices and sparse transformations | [`congruence`] |
//! | factors of dense matrices | [`DenseCholesky`], [`DenseLdlt`], [`Lu`] |
//! | L U = P A of sparse unsymmetric matrices | [`SparseLu`] of [`Rows`] |
//! | processes that hold one matrix together, and factorise it | [`Team`] |
//!
//! ```
//! use moreau_algebra::{Cholesky, Engine, Inertia, Ldlt, Matrix, Pattern};
//!
//! // Three springs in a row between a wall and a fourth node, which comes last and is kept.
//! let pattern = Pattern::new(vec![0, 2, 4, 6, 7], vec![0, 1, 1, 2, 2, 3, 3])?.keeping(1)?;
//! let mut stiffness = Matrix::new(pattern);
//! let springs = [2.0, -1.0, 2.0, -1.0, 2.0, -1.0, 1.0];
//! stiffness.values_mut().1.copy_from_slice(&springs);
//! let mut engine = Cholesky::analyse(&stiffness.pattern, None)?;
//! engine.factorise(stiffness.values())?;
//! // Seen from the last node they are one spring: four in series.
//! assert!((engine.schur()?[(0, 0)] - 0.25).abs() < 1e-15);
//! // Pulled there by one, it moves by four; by two, by eight: as many right-hand sides as there are.
//! let mut u = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0];
//! engine.solve(&mut u)?;
//! assert!((u[3] - 4.0).abs() < 1e-14 && (u[7] - 8.0).abs() < 1e-14);
//!
//! // A negative spring at the wall: no Cholesky factor, and one negative eigenvalue.
//! stiffness.values_mut().1[0] = 0.5;
//! assert!(engine.factorise(stiffness.values()).is_err());
//! let mut engine = Ldlt::analyse(&stiffness.pattern, None)?;
//! let inertia = engine.factorise(stiffness.values())?;
//! assert_eq!(inertia, Inertia { positive: 2, negative: 1, zero: 0 });
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Nothing here depends on the number of threads: the same bits for any. Nor does what one right-hand side
//! becomes depend on the others.

mod cholesky;
mod coarse;
mod congruence;
mod conjugate;
mod dense;
mod either;
mod engine;
mod ldlt;
mod lu;
mod matrix;
mod ordering;
mod panel;
mod pattern;
mod sparse_lu;
mod symbolic;
mod team;

pub use cholesky::Cholesky;
pub use coarse::{CoarseError, CoarseSpace};
pub use congruence::congruence;
pub use conjugate::{ConjugateGradients, Interface, Operator, Stop};
pub use dense::{DenseCholesky, DenseLdlt, less_gram, mirror, square, transposed_product};
pub use either::Either;
pub use engine::{Cost, Engine, EngineError, Inertia, TooLarge};
pub use ldlt::Ldlt;
pub use lu::Lu;
pub use matrix::Matrix;
pub use ordering::nested_dissection;
pub use pattern::{Pattern, PatternError};
pub use sparse_lu::{Rows, SparseLu};
pub use team::{ENGINE, Parcel, Share, SharedTeam, Team, Unpacked};

#[cfg(test)]
extern crate self as moreau_algebra;
#[cfg(test)]
#[path = "../tests/algebra/common/mod.rs"]
mod common;
