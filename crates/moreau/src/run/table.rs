//! The CSV files of a run, read back: columns by name; nothing is computed.

use super::RunError;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Rows of a CSV file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Table {
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// The rows of a file for which `keep` says so, from the names and the fields.
    pub(super) fn read(
        path: &Path,
        mut keep: impl FnMut(&[String], &[&str]) -> bool,
    ) -> Result<Self, RunError> {
        let error = |source| RunError::Read {
            path: path.to_owned(),
            source,
        };
        let mut lines = BufReader::new(File::open(path).map_err(error)?).lines();
        let header = lines.next().transpose().map_err(error)?.unwrap_or_default();
        // A unit in brackets follows the name.
        let name = |h: &str| h.split(" [").next().unwrap_or_default().to_owned();
        let names: Vec<String> = header.split(',').map(name).collect();
        let mut rows = Vec::new();
        for line in lines {
            let line = line.map_err(error)?;
            let fields: Vec<&str> = line.split(',').collect();
            if fields.len() == names.len() && keep(&names, &fields) {
                rows.push(fields.into_iter().map(str::to_owned).collect());
            }
        }
        Ok(Self { names, rows })
    }

    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// A column as text.
    pub(super) fn texts(&self, name: &str) -> Vec<&str> {
        match self.names.iter().position(|n| n == name) {
            Some(k) => self.rows.iter().map(|row| row[k].as_str()).collect(),
            None => Vec::new(),
        }
    }

    /// A column as numbers; what is none is NaN.
    pub(super) fn numbers(&self, name: &str) -> Vec<f64> {
        let number = |t: &str| t.parse().unwrap_or(f64::NAN);
        self.texts(name).into_iter().map(number).collect()
    }
}
