//! The contact problem with Coulomb friction and its solvers; not the bodies it comes from.
//!
//! | problem | form | solvers |
//! |---|---|---|
//! | [`CondensedProblem`] | t = S (u − g) − f, a structure condensed on its interface | [`ContactSolver`], and by [`Dual`] any of those for the local one |
//! | [`TiedProblem`] | K Δu = f + Bᵀ t, a structure known by factors of K + BᵀRB | [`solve_tied`] |
//! | [`LocalProblem`] | u = W r + q, W of any rank, dense or sparse | [`LocalSolver`], above all [`Auto`] |
//! | [`GlobalProblem`] | M v = H r + f, u = Hᵀ v + w | the same, by reduction |
//!
//! All methods for a problem are judged by the same residual and by the same certificate: the
//! bipotential gap Σ b_c(−u, t) + t·u, which is zero exactly at the solution.
//!
//! ```
//! use moreau_contact::{Certificate, CondensedProblem, ContactSolver, SemismoothNewton};
//! use moreau_laws::{Coulomb, Local};
//! use nalgebra::DMatrix;
//!
//! // One contact, u = W t + q: pressed by q_n < 0 and dragged by q_t.
//! let w = DMatrix::from_row_slice(2, 2, &[1.0, 0.2, 0.2, 0.8]);
//! let problem =
//!     CondensedProblem::<2>::from_delassus(w, &[Local::<2>::new(-1.0, 0.5)], vec![Coulomb::new(0.3)?])?;
//! let solution = SemismoothNewton::default().solve(&problem, None)?;
//! let (u, t) = (&solution.displacement, &solution.force);
//! // It slips against the friction force, and the certificate says that this is the solution.
//! assert!((t[0][1] + 0.3 * t[0][0]).abs() < 1e-12 && u[0][1] > 0.0);
//! assert!(Certificate::new(problem.laws(), u, t).bipotential_gap < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod global;
mod obstacle;
mod polyline;
mod problem;
mod solvers;
mod tied;
mod triangulated;

pub use error::ContactError;
pub use global::{GlobalProblem, GlobalSolution};
pub use obstacle::{Ball, Corner, Cylinder, Obstacle, Plane, arc, frame};
pub use polyline::Polyline;
pub use problem::{BlockMatrix, Certificate, CondensedProblem, LocalProblem, Residual};
pub use solvers::{
    Admm, Anderson, Auto, ContactSolution, ContactSolver, Dual, GaussSeidel, LocalSolution,
    LocalSolver, Newton, NewtonMap, Penalty, ProximalNewton, Reason, SemismoothNewton, TiedFactor,
    Tolerance, TrescaFixedPoint, Unsolved, Uzawa, solve_tied, uzawa_steps,
};
pub use tied::{Springs, Structure, TiedProblem};
pub use triangulated::Triangulated;
