//! `moreau convert`: a mesh file in another format; the mesh stays what it is.

use super::{INPUT_ERROR, say, tell};
use crate::files::{FileError, read_mesh, write_mesh};
use crate::mesh::{Loss, Mesh, ReadError};
use std::path::{Path, PathBuf};

/// Files to read and to write.
#[derive(Debug, clap::Args)]
pub(super) struct Convert {
    /// The mesh: .msh (Gmsh 2.2 or 4.1) or .inp (Abaqus, CalculiX).
    input: PathBuf,
    /// The file to write: .vtu (for ParaView) or .msh (Gmsh 2.2).
    output: PathBuf,
    /// Overwrite a file that is there.
    #[arg(long)]
    force: bool,
}

impl Convert {
    /// Converts; the exit status.
    pub(super) fn run(&self) -> u8 {
        if self.output.exists() && !self.force {
            let file = self.output.display();
            tell!("{file} is there already: give another name, or --force to overwrite it");
            return INPUT_ERROR;
        }
        // Of the dimension of its cells: in space, unless there are none.
        let done = match read_mesh::<3>(&self.input) {
            Ok(read) => written(&self.output, &read),
            Err(error) if is_plane(&error) => {
                read_mesh::<2>(&self.input).and_then(|read| written(&self.output, &read))
            }
            Err(error) => Err(error),
        };
        match done {
            Ok(what) => {
                say!("{}: {what}", self.output.display());
                0
            }
            Err(error) => {
                tell!("{error}");
                INPUT_ERROR
            }
        }
    }
}

/// Whether a file that is no mesh in space may be one in the plane.
fn is_plane(error: &FileError) -> bool {
    matches!(
        error,
        FileError::Mesh {
            source: ReadError::NoCells { .. } | ReadError::UnsupportedElement { .. },
            ..
        }
    )
}

fn written<const D: usize>(
    path: &Path,
    (mesh, losses): &(Mesh<D>, Vec<Loss>),
) -> Result<String, FileError> {
    write_mesh(path, mesh)?;
    for loss in losses {
        tell!("warning: {loss}");
    }
    Ok(format!(
        "{} nodes, {} cells, {} groups",
        mesh.nodes().len(),
        mesh.cell_count(),
        mesh.group_names().count()
    ))
}
