//! Reader of discrete frictional contact problems in the text format of the program Siconos; not of
//! HDF5.
//!
//! ```text
//! local :  d  contacts  MATRIX W            q  μ
//! global:  d  contacts  MATRIX M  MATRIX H  f  w  μ
//! ```
//!
//! Numbers stand between white space; what follows the last μ is ignored. A matrix is dense (by
//! columns), of blocks (compressed by rows, each block by columns) or sparse (a dump of triplets or of
//! compressed columns).

use super::{Entries, Form, Global, Problem, SiconosError};
use moreau::contact::{BlockMatrix, LocalProblem};
use moreau::laws::{Coulomb, Local};

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
