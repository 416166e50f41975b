//! Files of a run: streams that grow line by line and can be cut back to where they were, and files
//! that are written at once; tables read back; not what is in them.

use super::RunError;
use crate::table::Table;
use flate2::Crc;
use std::borrow::Cow;
use std::collections::HashSet;
use std::fs::{self, File, OpenOptions};
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A place in a stream, and what is before it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Mark {
    /// Bytes before it.
    pub(super) length: u64,
    /// Their CRC-32.
    pub(super) crc: u32,
}

/// A text file that grows line by line.
pub(super) struct Stream {
    path: PathBuf,
    file: BufWriter<File>,
    length: u64,
    crc: Crc,
}

impl Stream {
    /// A new file.
    pub(super) fn create(path: PathBuf) -> Result<Self, RunError> {
        match File::create(&path) {
            Ok(file) => Ok(Self {
                file: BufWriter::new(file),
                path,
                length: 0,
                crc: Crc::new(),
            }),
            Err(source) => Err(RunError::Write { path, source }),
        }
    }

    /// The file as it was at a mark: what was written since is cut off by [`Stream::cut`].
    ///
    /// # Errors
    /// [`RunError::Read`] also if the bytes before the mark are not those that were written.
    pub(super) fn reopen(path: PathBuf, mark: Mark) -> Result<Self, RunError> {
        let open = || {
            let mut file = OpenOptions::new().read(true).write(true).open(&path)?;
            let found = file.metadata()?.len();
            let Mark { length, crc } = mark;
            if found < length {
                let short = format!("it has {found} bytes, expected at least {length}");
                return Err(std::io::Error::other(short));
            }
            let before = crc_of(BufReader::new(&file).take(length))?;
            if before.sum() != crc {
                let changed = format!("its first {length} bytes are not those that were written");
                return Err(std::io::Error::other(changed));
            }
            file.seek(SeekFrom::Start(length))?;
            Ok((file, before))
        };
        match open() {
            Ok((file, crc)) => Ok(Self {
                file: BufWriter::new(file),
                path,
                length: mark.length,
                crc,
            }),
            Err(source) => Err(RunError::Read { path, source }),
        }
    }

    /// Cuts off what is in the file beyond what was written here.
    pub(super) fn cut(&mut self) -> Result<(), RunError> {
        self.flush()?;
        let cut = self.file.get_ref().set_len(self.length);
        cut.map_err(|source| self.error(source))
    }

    /// The end of what was written.
    pub(super) fn mark(&self) -> Mark {
        Mark {
            length: self.length,
            crc: self.crc.sum(),
        }
    }

    pub(super) fn line(&mut self, line: &str) -> Result<(), RunError> {
        self.length += line.len() as u64 + 1;
        self.crc.update(line.as_bytes());
        self.crc.update(b"\n");
        let written = writeln!(self.file, "{line}");
        written.map_err(|source| self.error(source))
    }

    /// Text after the end, which the next line replaces.
    pub(super) fn tail(&mut self, text: &str) -> Result<(), RunError> {
        let write = |file: &mut BufWriter<File>, length| {
            file.write_all(text.as_bytes())?;
            file.flush()?;
            file.seek(SeekFrom::Start(length))
        };
        let written = write(&mut self.file, self.length);
        written.map(|_| ()).map_err(|source| self.error(source))
    }

    pub(super) fn flush(&mut self) -> Result<(), RunError> {
        self.file.flush().map_err(|source| self.error(source))
    }

    fn error(&self, source: std::io::Error) -> RunError {
        let path = self.path.clone();
        RunError::Write { path, source }
    }
}

fn crc_of(mut bytes: impl Read) -> std::io::Result<Crc> {
    let mut crc = Crc::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match bytes.read(&mut buffer)? {
            0 => return Ok(crc),
            n => crc.update(&buffer[..n]),
        }
    }
}

/// Makes sure that what was written to a file is on the disk.
pub(super) fn sync(path: &Path) -> Result<(), RunError> {
    let synced = OpenOptions::new().write(true).open(path);
    let synced = synced.and_then(|file| file.sync_data());
    synced.map_err(|source| RunError::Write {
        path: path.to_owned(),
        source,
    })
}

/// A name beside a file, of this thread alone, under which it is written before it takes its place.
pub(super) fn beside(path: &Path) -> PathBuf {
    let thread = format!("{:?}", std::thread::current().id());
    let digits: String = thread.chars().filter(char::is_ascii_digit).collect();
    path.with_extension(format!("{digits}.tmp"))
}

/// Writes a file so that it is there as a whole or as it was before, whoever else writes it.
pub(super) fn replace_file(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    let beside = beside(path);
    let placed = fs::write(&beside, bytes).and_then(|()| fs::rename(&beside, path));
    placed.map_err(|source| {
        // What there is of it only takes room.
        let _ = fs::remove_file(&beside);
        RunError::Write {
            path: path.to_owned(),
            source,
        }
    })
}

pub(super) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    fs::write(path, bytes).map_err(|source| RunError::Write {
        path: path.to_owned(),
        source,
    })
}

pub(super) fn read_text(path: &Path) -> Result<String, RunError> {
    fs::read_to_string(path).map_err(|source| RunError::Read {
        path: path.to_owned(),
        source,
    })
}

/// All rows of `history.csv`.
pub(super) fn history_table(directory: &Path) -> Result<Table, RunError> {
    read_table(&directory.join("history.csv"), |_, _| true)
}

/// Rows of `contact.csv` of some increments.
pub(super) fn contact_table(directory: &Path, increments: &[usize]) -> Result<Table, RunError> {
    let wanted: HashSet<String> = increments.iter().map(usize::to_string).collect();
    read_table(&directory.join("contact.csv"), |names, fields| {
        let column = names.iter().position(|n| n == "increment");
        column.is_some_and(|k| wanted.contains(&*fields[k]))
    })
}

fn read_table(
    path: &Path,
    keep: impl FnMut(&[String], &[Cow<'_, str>]) -> bool,
) -> Result<Table, RunError> {
    let table = File::open(path).and_then(|file| Table::read(BufReader::new(file), keep));
    table.map_err(|source| RunError::Read {
        path: path.to_owned(),
        source,
    })
}
