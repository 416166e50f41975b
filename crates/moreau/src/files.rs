//! Mesh files on disk: read and written by the ending of their names; no mesh is changed.

use crate::mesh::{
    Loss, Mesh, ReadError, Skin, nearest, read_abaqus_noting, read_gmsh_noting, read_gmsh_skin,
    read_stl, write_gmsh,
};
use std::fs;
use std::path::{Path, PathBuf};

/// Largest file that is read \[bytes\]: some ten million cells.
const LARGEST: u64 = 2 << 30;

/// A mesh file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The operating system does not give it.
    #[error("cannot read the mesh {}: {source}{}", path.display(), beside(nearest))]
    Read {
        /// The path that was tried.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
        /// The file of its folder with the nearest name, if that is what is missing.
        nearest: Option<String>,
    },
    /// More bytes than are taken into memory.
    #[error("the mesh {} has {bytes} bytes, expected at most {LARGEST}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// An ending that is not known.
    #[error("the mesh {} is of no known format, expected a name that ends in {expected}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// The endings, in words.
        expected: &'static str,
    },
    /// What it says is no mesh.
    #[error("the mesh {}: {source}", path.display())]
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ReadError,
    },
    /// The operating system does not take it.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl FileError {
    /// What to do about it, where that is not plain.
    pub fn help(&self) -> Option<&'static str> {
        let Self::Mesh { source, .. } = self else {
            return match self {
                Self::Read { .. } => Some("a path is relative to the folder of the deck"),
                _ => None,
            };
        };
        match source {
            ReadError::Dimension { .. } => {
                Some("a mesh with volume cells needs analysis = \"solid\"")
            }
            ReadError::NoCells { dimension: 3, .. } => Some(
                "a plane mesh needs analysis = \"plane-strain\", \"plane-stress\" or \"axisymmetric\"; a \
                 mesh of volumes must be saved with its volume cells",
            ),
            ReadError::NoCells { .. } => Some(
                "give the surface a physical group, or save all elements (in Gmsh: Mesh.SaveAll)",
            ),
            _ => None,
        }
    }
}

fn beside(nearest: &Option<String>) -> String {
    let hint = |name| format!("; beside it is \"{name}\"");
    nearest.as_ref().map_or_else(String::new, hint)
}

/// Lower-case ending of a file name.
fn ending(path: &Path) -> String {
    path.extension()
        .map_or_else(String::new, |e| e.to_string_lossy().to_lowercase())
}

/// The mesh of a file, `.msh` (Gmsh) or `.inp` (Abaqus, CalculiX), and what of the file is not in it.
///
/// # Errors
/// [`FileError`], with the file of the folder whose name is nearest if there is no such file.
pub fn read_mesh<const D: usize>(path: &Path) -> Result<(Mesh<D>, Vec<Loss>), FileError> {
    known(path)?;
    mesh_of(path, &read_bytes(path)?)
}

/// An error for a file that is not read by its name, whatever is in it.
fn known(path: &Path) -> Result<(), FileError> {
    match ending(path).as_str() {
        "msh" | "inp" => Ok(()),
        _ => Err(FileError::Format {
            path: path.into(),
            expected: ".msh (Gmsh) or .inp (Abaqus, CalculiX)",
        }),
    }
}

/// As [`read_mesh`], of a file whose content is at hand.
///
/// # Errors
/// [`FileError::Format`], [`FileError::Mesh`].
pub fn mesh_of<const D: usize>(
    path: &Path,
    bytes: &[u8],
) -> Result<(Mesh<D>, Vec<Loss>), FileError> {
    known(path)?;
    let mesh = match ending(path).as_str() {
        "inp" => read_abaqus_noting(&String::from_utf8_lossy(bytes)),
        _ => read_gmsh_noting(bytes),
    };
    mesh.map_err(|source| FileError::Mesh {
        path: path.into(),
        source,
    })
}

/// The surface of a file, `.stl` or `.msh` (Gmsh); of the latter that of a physical group, or all.
///
/// # Errors
/// [`FileError`], as of [`read_mesh`].
pub fn read_skin(path: &Path, group: Option<&str>) -> Result<Skin, FileError> {
    let read: fn(&[u8], Option<&str>) -> Result<Skin, ReadError> = match ending(path).as_str() {
        "stl" => |bytes, _| read_stl(bytes),
        "msh" => read_gmsh_skin,
        _ => {
            return Err(FileError::Format {
                path: path.into(),
                expected: ".stl or .msh (Gmsh)",
            });
        }
    };
    read(&read_bytes(path)?, group).map_err(|source| FileError::Mesh {
        path: path.into(),
        source,
    })
}

/// The content of a file.
///
/// # Errors
/// [`FileError::Read`], [`FileError::TooLarge`].
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, FileError> {
    let size = fs::metadata(path).map(|m| m.len());
    if let Ok(bytes @ LARGEST..) = size {
        let path = path.into();
        return Err(FileError::TooLarge { path, bytes });
    }
    size.and_then(|_| fs::read(path))
        .map_err(|source| FileError::Read {
            nearest: match source.kind() {
                std::io::ErrorKind::NotFound => nearest_file(path, &["msh", "inp", "stl"]),
                _ => None,
            },
            path: path.into(),
            source,
        })
}

/// The file in the folder of a missing one whose name is nearest, of those with some endings.
pub(crate) fn nearest_file(missing: &Path, endings: &[&str]) -> Option<String> {
    let folder = match missing.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let entries = fs::read_dir(folder).ok()?;
    let names: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| endings.contains(&ending(Path::new(name)).as_str()))
        .collect();
    let name = missing.file_name()?.to_string_lossy();
    nearest(&name, names.iter().map(String::as_str)).map(Into::into)
}

/// Writes a mesh: `.msh` (MSH 2.2, text, groups as physical groups) or `.vtu` (groups as arrays of
/// 0 and 1 on cells and points).
///
/// # Errors
/// [`FileError::Format`], [`FileError::Write`].
pub fn write_mesh<const D: usize>(path: &Path, mesh: &Mesh<D>) -> Result<(), FileError> {
    let bytes = match ending(path).as_str() {
        "msh" => write_gmsh(mesh).into_bytes(),
        "vtu" => crate::vtu::vtu_of_mesh(mesh),
        _ => {
            return Err(FileError::Format {
                path: path.into(),
                expected: ".msh (Gmsh) or .vtu (VTK)",
            });
        }
    };
    fs::write(path, bytes).map_err(|source| FileError::Write {
        path: path.into(),
        source,
    })
}
