//! Verification of moreau: problems with known answers, written once and run by the tests (quick)
//! and by `cargo xtask verify` (full); not the crates' own unit tests.

pub mod cases;
pub mod outcome;
pub mod paper;
pub mod problems;
pub mod siconos;

pub use outcome::{Case, Chapter, Check, Figure, Kind, Options, Outcome, Table};
