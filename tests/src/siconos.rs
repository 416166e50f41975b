//! Reader of discrete frictional contact problems in the text format of the program Siconos; that of
//! the same problems in HDF5 is `fclib`, behind the feature `hdf5`.
//!
//! ```text
//! local :  d  contacts  MATRIX W            q  μ
//! global:  d  contacts  MATRIX M  MATRIX H  f  w  μ
//! ```
//!
//! Numbers stand between white space; what follows the last μ is ignored. A matrix is dense (by
//! columns), of blocks (compressed by rows, each block by columns) or sparse (a dump of triplets or of
//! compressed columns).

#[cfg(feature = "hdf5")]
mod fclib;
#[cfg(test)]
mod tests;

use moreau::contact::{BlockMatrix, ContactError, GlobalProblem, LocalProblem};
use moreau::laws::{Coulomb, LawError, Local};
use std::path::Path;

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

/// Reads a problem of the given form.
///
/// # Errors
/// [`SiconosError`] with the line where the text is not what the format says.
pub fn read(text: &str, form: Form) -> Result<Problem, SiconosError> {
    let mut reader = Reader::new(text);
    let dimension = reader.count("the dimension, 2 or 3")?;
    match (dimension, form) {
        (2, Form::Local) => local(reader).map(Problem::Local2),
        (3, Form::Local) => local(reader).map(Problem::Local3),
        (2, Form::Global) => global(reader).map(Problem::Global2),
        (3, Form::Global) => global(reader).map(Problem::Global3),
        _ => Err(reader.wrong(&dimension.to_string(), "the dimension, 2 or 3")),
    }
}

fn local<const D: usize>(mut reader: Reader) -> Result<LocalProblem<D>, SiconosError> {
    let contacts = reader.count("the number of contacts")?;
    let operator = reader.matrix("W", [D * contacts; 2])?;
    let q = reader.locals(contacts)?;
    let friction = reader.friction(contacts)?;
    let operator = BlockMatrix::from_entries(contacts, operator);
    Ok(LocalProblem::new(operator, q, friction)?)
}

fn global<const D: usize>(mut reader: Reader) -> Result<Global<D>, SiconosError> {
    let contacts = reader.count("the number of contacts")?;
    let line = reader.line;
    let (size, stiffness) = reader.any_matrix()?;
    if size[0] != size[1] {
        return Err(SiconosError::Size {
            line,
            what: "columns of M",
            found: size[1],
            expected: size[0],
        });
    }
    let directions = reader.matrix("H", [size[0], D * contacts])?;
    let load = (0..size[0])
        .map(|_| reader.number("a load"))
        .collect::<Result<_, _>>()?;
    let free = reader.locals(contacts)?;
    let friction = reader.friction(contacts)?;
    Ok(Global {
        stiffness,
        directions,
        load,
        free,
        friction,
    })
}

/// Entries of a matrix: row, column, value.
pub type Entries = Vec<(usize, usize, f64)>;

/// A place in a text.
struct Reader<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            rest: text,
            line: 1,
        }
    }

    fn wrong(&self, found: &str, expected: &'static str) -> SiconosError {
        SiconosError::Syntax {
            line: self.line,
            found: found.to_owned(),
            expected,
        }
    }

    /// The next word; empty at the end.
    fn word(&mut self) -> &'a str {
        let begin = self
            .rest
            .find(|c: char| !c.is_whitespace())
            .unwrap_or(self.rest.len());
        self.line += self.rest[..begin].matches('\n').count();
        let rest = &self.rest[begin..];
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        self.rest = &rest[end..];
        &rest[..end]
    }

    /// The rest of the line.
    fn rest_of_line(&mut self) -> &'a str {
        let (line, rest) = self.rest.split_once('\n').unwrap_or((self.rest, ""));
        self.rest = rest;
        self.line += 1;
        line
    }

    fn number(&mut self, expected: &'static str) -> Result<f64, SiconosError> {
        let word = self.word();
        word.parse().map_err(|_| self.wrong(word, expected))
    }

    fn count(&mut self, expected: &'static str) -> Result<usize, SiconosError> {
        let word = self.word();
        word.parse().map_err(|_| self.wrong(word, expected))
    }

    fn counts(&mut self, n: usize, expected: &'static str) -> Result<Vec<usize>, SiconosError> {
        (0..n).map(|_| self.count(expected)).collect()
    }

    fn keyword(&mut self, keyword: &'static str) -> Result<(), SiconosError> {
        let word = self.word();
        if word == keyword {
            Ok(())
        } else {
            Err(self.wrong(word, keyword))
        }
    }

    fn locals<const D: usize>(&mut self, contacts: usize) -> Result<Vec<Local<D>>, SiconosError> {
        let mut all = vec![Local::<D>::zeros(); contacts];
        for value in all.iter_mut().flat_map(|v| v.iter_mut()) {
            *value = self.number("a component of a contact")?;
        }
        Ok(all)
    }

    fn friction(&mut self, contacts: usize) -> Result<Vec<Coulomb>, SiconosError> {
        (0..contacts)
            .map(|_| Ok(Coulomb::new(self.number("a coefficient of friction")?)?))
            .collect()
    }

    /// A matrix whose size is known.
    fn matrix(
        &mut self,
        what: &'static str,
        expected: [usize; 2],
    ) -> Result<Entries, SiconosError> {
        let line = self.line;
        let (size, entries) = self.any_matrix()?;
        match size.iter().zip(&expected).find(|(found, due)| found != due) {
            None => Ok(entries),
            Some((&found, &expected)) => Err(SiconosError::Size {
                line,
                what,
                found,
                expected,
            }),
        }
    }

    /// A matrix with its size.
    fn any_matrix(&mut self) -> Result<([usize; 2], Entries), SiconosError> {
        let storage = self.count("a storage: 0 dense, 1 blocks, 2 sparse")?;
        let size = [self.count("rows")?, self.count("columns")?];
        let entries = match storage {
            0 => self.dense()?,
            1 => self.blocks()?,
            2 => self.sparse()?,
            _ => {
                let expected = "a storage: 0 dense, 1 blocks, 2 sparse";
                return Err(self.wrong(&storage.to_string(), expected));
            }
        };
        for &(i, j, _) in &entries {
            for (found, expected, what) in [(i, size[0], "a row"), (j, size[1], "a column")] {
                if found >= expected {
                    return Err(SiconosError::Size {
                        line: self.line,
                        what,
                        found,
                        expected: expected.saturating_sub(1),
                    });
                }
            }
        }
        Ok((size, entries))
    }

    fn dense(&mut self) -> Result<Entries, SiconosError> {
        let (rows, columns) = (self.count("rows")?, self.count("columns")?);
        let mut entries = Vec::new();
        for k in 0..rows * columns {
            entries.push((k % rows, k / rows, self.number("an entry")?));
        }
        Ok(entries)
    }

    fn blocks(&mut self) -> Result<Entries, SiconosError> {
        let stored = self.count("the number of blocks")?;
        let [rows, columns] = [self.count("block rows")?, self.count("block columns")?];
        let row_ends = self.counts(rows, "the end of a block row")?;
        let column_ends = self.counts(columns, "the end of a block column")?;
        let lengths = [self.count("a length")?, self.count("a length")?];
        let starts = self.counts(lengths[0], "the start of a block row")?;
        let places = self.counts(lengths[1], "a block column")?;
        let mut entries = Vec::new();
        for (row, ends) in starts.windows(2).enumerate() {
            for block in ends[0]..ends[1] {
                let column = places.get(block).copied().unwrap_or(usize::MAX);
                if block >= stored || row >= rows || column >= columns {
                    return Err(SiconosError::Size {
                        line: self.line,
                        what: "a block",
                        found: block,
                        expected: stored.min(places.len()),
                    });
                }
                self.count("the number of a block")?;
                let begin = |ends: &[usize], at: usize| if at > 0 { ends[at - 1] } else { 0 };
                let (top, left) = (begin(&row_ends, row), begin(&column_ends, column));
                for j in left..column_ends[column] {
                    for i in top..row_ends[row] {
                        entries.push((i, j, self.number("an entry")?));
                    }
                }
            }
        }
        Ok(entries)
    }

    fn sparse(&mut self) -> Result<Entries, SiconosError> {
        let origin = self.count("an origin: 1 triplets, 2 compressed columns")?;
        self.rest_of_line();
        self.rest_of_line();
        let mut entries = Vec::new();
        match origin {
            1 => {
                self.keyword("triplet:")?;
                let header = self.rest_of_line();
                let stored = header
                    .rsplit(' ')
                    .next()
                    .and_then(|n| n.trim().parse().ok());
                let stored: usize = stored.ok_or_else(|| self.wrong(header, "nnz: a number"))?;
                for _ in 0..stored {
                    let (i, j) = (self.count("a row")?, self.count("a column")?);
                    self.keyword(":")?;
                    entries.push((i, j, self.number("an entry")?));
                }
            }
            2 => {
                let header = self.rest_of_line();
                let columns = (header.split_once("-by-"))
                    .and_then(|(_, rest)| rest.split_once(','))
                    .and_then(|(n, _)| n.trim().parse().ok());
                let columns: usize =
                    columns.ok_or_else(|| self.wrong(header, "rows-by-columns, …"))?;
                for j in 0..columns {
                    self.keyword("col")?;
                    self.count("a column")?;
                    self.keyword(":")?;
                    self.keyword("locations")?;
                    let first = self.count("the first location")?;
                    self.keyword("to")?;
                    let last = self.number("the last location")?;
                    for _ in 0..(last + 1.0 - first as f64) as usize {
                        let i = self.count("a row")?;
                        self.keyword(":")?;
                        entries.push((i, j, self.number("an entry")?));
                    }
                }
            }
            _ => {
                let expected = "an origin: 1 triplets, 2 compressed columns";
                return Err(self.wrong(&origin.to_string(), expected));
            }
        }
        Ok(entries)
    }
}
