//! Verification of moreau: problems with known answers, written once and run by the tests (quick)
//! and by `cargo xtask verify` (full); not the crates' own unit tests.

pub mod cases;
mod csv;
pub mod curves;
pub mod outcome;
pub mod paper;
pub mod problems;
pub mod scratch;
pub mod siconos;
pub mod workspace;

pub use outcome::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
