//! Linear algebra of `moreau`: sparse symmetric systems whose last unknowns are condensed on, and the
//! dense ones that this leaves. No mesh, no law, no contact.
//!
//! | what | here |
//! |---|---|
//! | order of the unknowns | [`nested_dissection`] |
//! | where the entries are | [`Pattern`] |
//! | their values, products and sweeps | [`Matrix`] |
//! | L Lᵀ = A, and the Schur complement of the last unknowns out of L | [`Cholesky`] |
//! | the same of a dense matrix | [`DenseCholesky`], [`square`] |
//! | L U = P A, dense and sparse | [`Lu`], [`SparseLu`] of [`Rows`] |
//!
//! ```
//! use moreau_algebra::{Cholesky, Matrix, Pattern, square};
//!
//! // Three springs in a row between a wall and a fourth node, which comes last.
//! let pattern = Pattern::new(vec![0, 2, 4, 6, 7], vec![0, 1, 1, 2, 2, 3, 3]);
//! let mut stiffness = Matrix::new(pattern);
//! let springs = [2.0, -1.0, 2.0, -1.0, 2.0, -1.0, 1.0];
//! stiffness.values_mut().1.copy_from_slice(&springs);
//! let mut factor = Cholesky::analyse(&stiffness.pattern, None, |_| true)?;
//! factor.factorise(&stiffness.pattern, stiffness.values())?;
//! // Seen from the last node they are one spring: four in series.
//! assert!((square(&factor.trailing(1))[(0, 0)] - 0.25).abs() < 1e-15);
//! // Pulled there by one, it moves by four.
//! let mut u = [0.0, 0.0, 0.0, 1.0];
//! factor.forward(&mut u);
//! factor.backward(&mut u);
//! assert!((u[3] - 4.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Nothing here depends on the number of threads: the same bits for any.

mod cholesky;
mod coarse;
mod conjugate;
mod dense;
mod engine;
mod ldlt;
mod lu;
mod matrix;
mod ordering;
mod panel;
mod pattern;
mod sparse_lu;
mod symbolic;

pub use cholesky::Cholesky;
pub use coarse::{CoarseError, CoarseSpace};
pub use conjugate::{ConjugateGradients, Interface, Stop};
pub use dense::{DenseCholesky, square};
pub use engine::{Cost, Engine, EngineError, Inertia, TooLarge};
pub use ldlt::Ldlt;
pub use lu::Lu;
pub use matrix::Matrix;
pub use ordering::nested_dissection;
pub use pattern::{Pattern, PatternError};
pub use sparse_lu::{Rows, SparseLu};
