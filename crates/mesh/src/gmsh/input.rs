//! The numbers of an MSH file, one after the other, in text or binary; knows no section.

use crate::read::{Place, ReadError};

/// How the numbers of a file are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    Text,
    Binary { big_endian: bool },
}

/// A file and how far it has been read.
#[derive(Debug)]
pub(super) struct Input<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(super) coding: Coding,
}

/// What one item of a list takes at least, to check a count before memory is reserved for it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Least {
    pub(super) ints: usize,
    pub(super) sizes: usize,
    pub(super) reals: usize,
}

impl<'a> Input<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: 0,
            coding: Coding::Text,
        }
    }

    /// Where the byte `at` is.
    pub(super) fn place_of(&self, at: usize) -> Place {
        match self.coding {
            Coding::Text => {
                let before = self.bytes.iter().take(at).filter(|&&byte| byte == b'\n');
                Place::Line(1 + before.count())
            }
            Coding::Binary { .. } => Place::Byte(at),
        }
    }

    /// Where reading goes on.
    pub(super) fn at(&self) -> usize {
        self.at
    }

    fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    pub(super) fn truncated(&self, expected: &str) -> ReadError {
        ReadError::Truncated {
            place: self.place_of(self.bytes.len()),
            expected: expected.into(),
        }
    }

    pub(super) fn unexpected(&self, at: usize, found: &[u8], expected: &str) -> ReadError {
        let found = String::from_utf8_lossy(found);
        ReadError::Unexpected {
            place: self.place_of(at),
            found: found.chars().take(40).collect(),
            expected: expected.into(),
        }
    }

    /// The number just read, which starts at `at`, is not what is expected.
    pub(super) fn wrong(&self, at: usize, found: impl ToString, expected: &str) -> ReadError {
        self.unexpected(at, found.to_string().as_bytes(), expected)
    }

    fn skip_space(&mut self) {
        let space = self.rest().iter().take_while(|b| b.is_ascii_whitespace());
        self.at += space.count();
    }

    /// The rest of the line, without the spaces around it.
    pub(super) fn line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&byte| byte == b'\n');
        self.at += length.map_or(rest.len(), |length| length + 1);
        rest[..length.unwrap_or(rest.len())].trim_ascii()
    }

    /// The next section's name, without `$`; `None` at the end of the file.
    pub(super) fn section(&mut self) -> Result<Option<&'a [u8]>, ReadError> {
        self.skip_space();
        if self.rest().is_empty() {
            return Ok(None);
        }
        let at = self.at;
        let line = self.line();
        match line.strip_prefix(b"$") {
            Some(name) if is_name(name) => Ok(Some(name)),
            _ => Err(self.unexpected(at, line, "the start of a section, $Name,")),
        }
    }

    /// Reads the end of a section.
    pub(super) fn end(&mut self, section: &[u8]) -> Result<(), ReadError> {
        self.skip_space();
        let expected = format!("$End{}", String::from_utf8_lossy(section));
        if self.rest().is_empty() {
            return Err(self.truncated(&expected));
        }
        let at = self.at;
        let line = self.line();
        match line.strip_prefix(b"$End") {
            Some(name) if name == section => Ok(()),
            _ => Err(self.unexpected(at, line, &expected)),
        }
    }

    /// Skips what is in a section, and its end.
    pub(super) fn skip(&mut self, section: &[u8]) -> Result<(), ReadError> {
        let end = [b"$End", section].concat();
        let found = self.rest().windows(end.len()).position(|w| w == end);
        let Some(length) = found else {
            return Err(self.truncated(&String::from_utf8_lossy(&end)));
        };
        self.at += length + end.len();
        self.line();
        Ok(())
    }

    /// The next word of a text, and where it starts.
    pub(super) fn word(&mut self, expected: &str) -> Result<(usize, &'a [u8]), ReadError> {
        self.skip_space();
        let (at, rest) = (self.at, self.rest());
        let length = rest.iter().take_while(|b| !b.is_ascii_whitespace()).count();
        if length == 0 {
            return Err(self.truncated(expected));
        }
        self.at += length;
        Ok((at, &rest[..length]))
    }

    fn parsed<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, ReadError> {
        let (at, word) = self.word(expected)?;
        let value = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        value.ok_or_else(|| self.unexpected(at, word, expected))
    }

    fn taken<const N: usize>(
        &mut self,
        big_endian: bool,
        expected: &str,
    ) -> Result<[u8; N], ReadError> {
        let Some(bytes) = self.rest().first_chunk::<N>() else {
            return Err(self.truncated(expected));
        };
        self.at += N;
        let mut bytes = *bytes;
        if big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// An integer of a line of text, which the binary format has as well.
    pub(super) fn text_int(&mut self, expected: &str) -> Result<i32, ReadError> {
        self.parsed(expected)
    }

    /// An `int`, of 4 bytes.
    pub(super) fn int(&mut self, expected: &str) -> Result<i32, ReadError> {
        match self.coding {
            Coding::Text => self.parsed(expected),
            Coding::Binary { big_endian } => {
                Ok(i32::from_le_bytes(self.taken(big_endian, expected)?))
            }
        }
    }

    /// A `size_t`, of 8 bytes.
    pub(super) fn size(&mut self, expected: &str) -> Result<u64, ReadError> {
        match self.coding {
            Coding::Text => self.parsed(expected),
            Coding::Binary { big_endian } => {
                Ok(u64::from_le_bytes(self.taken(big_endian, expected)?))
            }
        }
    }

    /// A `double`, of 8 bytes.
    pub(super) fn real(&mut self, expected: &str) -> Result<f64, ReadError> {
        match self.coding {
            Coding::Text => self.parsed(expected),
            Coding::Binary { big_endian } => {
                Ok(f64::from_le_bytes(self.taken(big_endian, expected)?))
            }
        }
    }

    /// Coordinates of a node \[mm\], finite.
    pub(super) fn point(&mut self) -> Result<[f64; 3], ReadError> {
        let mut x = [0.0; 3];
        for x in &mut x {
            let at = self.at;
            *x = self.real("a coordinate")?;
            if !x.is_finite() {
                return Err(self.wrong(at, x, "a finite coordinate"));
            }
        }
        Ok(x)
    }

    /// Number of a node or element written as an `int`.
    pub(super) fn number(&mut self, expected: &str) -> Result<u64, ReadError> {
        let at = self.at;
        let number = self.int(expected)?;
        u64::try_from(number).map_err(|_| self.wrong(at, number, expected))
    }

    /// A count as a length, if the rest of the file can hold as many items.
    pub(super) fn checked(
        &self,
        count: u64,
        what: &'static str,
        least: Least,
    ) -> Result<usize, ReadError> {
        let Least { ints, sizes, reals } = least;
        let bytes = match self.coding {
            // A digit and a space for each number; no space need follow the last.
            Coding::Text => 2 * (ints + sizes + reals),
            Coding::Binary { .. } => 4 * ints + 8 * (sizes + reals),
        };
        let remaining = self.rest().len();
        usize::try_from(count)
            .ok()
            .filter(|&n| n <= (remaining + 1) / bytes.max(1))
            .ok_or_else(|| ReadError::TooMany {
                place: self.place_of(self.at),
                what,
                count,
                remaining,
            })
    }

    /// What is left of the file, at least one whole line of it, after a header in text.
    pub(super) fn end_of_header(&mut self) -> Result<(), ReadError> {
        let at = self.at;
        match self.line() {
            [] => Ok(()),
            line => Err(self.unexpected(at, line, "the end of the line")),
        }
    }
}

/// Whether bytes can name a section, and a message can show them.
fn is_name(bytes: &[u8]) -> bool {
    let printable = |byte: &u8| byte.is_ascii_graphic() || *byte == b' ';
    (1..=80).contains(&bytes.len()) && bytes.iter().all(printable)
}
