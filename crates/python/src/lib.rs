//! `moreau_fem._core`: what Python cannot do itself. Numbers go over as bytes, which arrays take as they are; what a
//! user meets is in `python/moreau_fem`.

mod law;
mod simulation;

use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The module.
#[pymodule(name = "_core")]
mod core {
    #[pymodule_export]
    use super::simulation::Simulation;
    #[pymodule_export]
    use super::{checksum, command};
}

/// Does what the arguments of a command line say, the name of the program first; the exit status.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| moreau::command::main(arguments))
}

/// The checksum of the files that a deck reads, with meshes that are not on disk; none without files, or where one cannot
/// be read.
#[pyfunction]
fn checksum(
    py: Python<'_>,
    text: &str,
    folder: PathBuf,
    meshes: BTreeMap<PathBuf, Vec<u8>>,
) -> Option<String> {
    py.detach(|| moreau::deck::checksum_of(text, &folder, &meshes))
}
