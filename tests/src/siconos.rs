//! Discrete frictional contact problems in the files of other programs: the text format of the program
//! Siconos, and FCLIB's layout in HDF5 behind the feature `hdf5`; not how they are solved.

#[cfg(feature = "hdf5")]
mod fclib;
#[cfg(test)]
mod tests;
mod text;

pub use text::read;

use moreau::contact::{ContactError, GlobalProblem, LocalProblem};
use moreau::laws::{Coulomb, LawError, Local};
use std::path::Path;

/// Entries of a matrix: row, column, value.
pub type Entries = Vec<(usize, usize, f64)>;

/// A problem of either form in two or three dimensions.
#[derive(Debug)]
pub enum Problem {
    /// Local form, plane.
    Local2(LocalProblem<2>),
    /// Local form, spatial.
    Local3(LocalProblem<3>),
    /// Global form, plane.
    Global2(Global<2>),
    /// Global form, spatial.
    Global3(Global<3>),
}

/// The parts of a problem in global form, not reduced yet: a program that is timed has to reduce it.
#[derive(Debug, Clone)]
pub struct Global<const D: usize> {
    /// Entries of M.
    pub stiffness: Entries,
    /// Entries of H.
    pub directions: Entries,
    /// Loads f of the bodies.
    pub load: Vec<f64>,
    /// Free displacements w of the contacts.
    pub free: Vec<Local<D>>,
    /// The law of every contact.
    pub friction: Vec<Coulomb>,
}

impl<const D: usize> Global<D> {
    /// The problem, reduced to its local form.
    ///
    /// # Errors
    /// Those of [`GlobalProblem::new`].
    pub fn problem(self) -> Result<GlobalProblem<D>, ContactError> {
        GlobalProblem::new(
            self.stiffness,
            self.directions,
            self.load,
            self.free,
            self.friction,
        )
    }
}

/// The form of a file; the file itself does not say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// u = W r + q.
    Local,
    /// M v = H r + f, u = Hᵀ v + w.
    Global,
}

impl Form {
    /// The form that a file's name tells, by the customs of the collection: `GFC3D_…`, `gfc2d_…` and
    /// `….fclib-global.dat` are global, unless condensed.
    pub fn of_name(name: &str) -> Self {
        let global = name.starts_with("GFC3D_")
            || name.starts_with("gfc2d_")
            || name.contains("fclib-global");
        if global && !name.contains("condensed") {
            Self::Global
        } else {
            Self::Local
        }
    }
}

/// Why a text is not a problem.
#[derive(Debug, Clone, PartialEq)]
pub enum SiconosError {
    /// Something else stands where a part of the format is due.
    Syntax {
        /// Line, from 1.
        line: usize,
        /// What stands there.
        found: String,
        /// What is due.
        expected: &'static str,
    },
    /// Sizes that do not fit together.
    Size {
        /// Line, from 1.
        line: usize,
        /// What has the size.
        what: &'static str,
        /// The size found.
        found: usize,
        /// The size that fits.
        expected: usize,
    },
    /// A file that cannot be read.
    File(String),
    /// A file in HDF5, and a build without the feature that reads it.
    Feature,
    /// An object of a file in HDF5 that is not as it should be.
    Hdf5 {
        /// Where it is in the file.
        object: String,
        /// What is wrong with it.
        what: String,
    },
    /// A coefficient of friction that is none.
    Law(LawError),
    /// A problem that cannot be posed.
    Contact(ContactError),
}

impl std::fmt::Display for SiconosError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Syntax {
                line,
                found,
                expected,
            } => write!(f, "line {line}: `{found}`, expected {expected}"),
            Self::Size {
                line,
                what,
                found,
                expected,
            } => write!(f, "line {line}: {what} is {found}, expected {expected}"),
            Self::File(what) => f.write_str(what),
            Self::Feature => f.write_str(
                "HDF5 is read by builds with the feature `hdf5`, which need the library: \
                 `cargo run --release -p xtask --features hdf5 -- contact-bench …`",
            ),
            Self::Hdf5 { object, what } => write!(f, "{object}: {what}"),
            Self::Law(error) => error.fmt(f),
            Self::Contact(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SiconosError {}

impl From<LawError> for SiconosError {
    fn from(error: LawError) -> Self {
        Self::Law(error)
    }
}

impl From<ContactError> for SiconosError {
    fn from(error: ContactError) -> Self {
        Self::Contact(error)
    }
}

/// Reads the problem of a file: `*.hdf5` in the layout of FCLIB, all else as text whose form the name
/// tells.
///
/// # Errors
/// [`SiconosError::File`], [`SiconosError::Feature`], and those of the formats.
pub fn open(path: &Path) -> Result<Problem, SiconosError> {
    if path
        .extension()
        .is_some_and(|extension| extension == "hdf5")
    {
        #[cfg(feature = "hdf5")]
        return fclib::read(path);
        #[cfg(not(feature = "hdf5"))]
        return Err(SiconosError::Feature);
    }
    let text = std::fs::read_to_string(path);
    let text = text.map_err(|error| SiconosError::File(error.to_string()))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    read(&text, Form::of_name(&name))
}
