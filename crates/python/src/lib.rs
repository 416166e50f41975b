//! `moreau_fem._core`: what Python cannot do itself. Numbers go over as bytes, which arrays take as they are; what a
//! user meets is in `python/moreau_fem`.

mod law;
mod simulation;

use pyo3::prelude::*;

/// The module.
#[pymodule(name = "_core")]
mod core {
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::simulation::Simulation;
}

/// Does what the arguments of a command line say, the name of the program first; the exit status.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| moreau::command::main(arguments))
}
