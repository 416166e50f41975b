//! The algebra as who uses it sees it, against dense matrices and definitions.

mod common;
mod dense;
mod engines;
mod lu;
mod ordering;
mod sparse_lu;
