//! Files of a run: streams that grow line by line and can be cut back to where they were, and files
//! that are written at once; not what is in them.

use super::RunError;
use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A text file that grows line by line.
pub(super) struct Stream {
    path: PathBuf,
    file: BufWriter<File>,
    length: u64,
}

impl Stream {
    /// A new file.
    pub(super) fn create(path: PathBuf) -> Result<Self, RunError> {
        match File::create(&path) {
            Ok(file) => Ok(Self {
                file: BufWriter::new(file),
                path,
                length: 0,
            }),
            Err(source) => Err(RunError::Write { path, source }),
        }
    }

    /// The file as it was when it had a length: what was written since is cut off.
    pub(super) fn reopen(path: PathBuf, length: u64) -> Result<Self, RunError> {
        let open = || {
            let mut file = OpenOptions::new().write(true).open(&path)?;
            let found = file.metadata()?.len();
            if found < length {
                let short = format!("it has {found} bytes, expected at least {length}");
                return Err(std::io::Error::other(short));
            }
            file.set_len(length)?;
            file.seek(SeekFrom::End(0))?;
            Ok(file)
        };
        match open() {
            Ok(file) => Ok(Self {
                file: BufWriter::new(file),
                path,
                length,
            }),
            Err(source) => Err(RunError::Read { path, source }),
        }
    }

    /// Bytes written.
    pub(super) fn length(&self) -> u64 {
        self.length
    }

    pub(super) fn line(&mut self, line: &str) -> Result<(), RunError> {
        self.length += line.len() as u64 + 1;
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

    /// Makes sure that all of it is on the disk.
    pub(super) fn sync(&mut self) -> Result<(), RunError> {
        self.flush()?;
        let synced = self.file.get_ref().sync_data();
        synced.map_err(|source| self.error(source))
    }

    fn error(&self, source: std::io::Error) -> RunError {
        let path = self.path.clone();
        RunError::Write { path, source }
    }
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
