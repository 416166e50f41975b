//! MUMPS and MPI behind the seam of the sparse symmetric systems, `moreau_algebra::Engine` and
//! `moreau_algebra::Team`: no algorithm of its own, and nothing at all without the feature `native`, which
//! needs both on the system.
//!
//! `docs/cluster.md` tells what to install. The calls of C are in `calls.c`, their `unsafe` in one file.

#[cfg(feature = "native")]
mod calls;
#[cfg(feature = "native")]
mod engine;
#[cfg(feature = "native")]
mod options;
#[cfg(feature = "native")]
mod part;
#[cfg(feature = "native")]
mod processes;

#[cfg(feature = "native")]
pub use engine::{Definite, Indefinite, serve};
#[cfg(feature = "native")]
pub use options::Options;
#[cfg(feature = "native")]
pub use processes::Processes;
