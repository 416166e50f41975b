//! CSV as RFC 4180 has it: a field as it is written, and the files of a run read back, columns by
//! name; nothing is computed.

use super::RunError;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;

/// A text as a field: within quotes, its own doubled, where it holds anything that ends a field.
pub(super) fn field(text: &str) -> Cow<'_, str> {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")).into(),
        false => text.into(),
    }
}

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
        keep: impl FnMut(&[String], &[Cow<'_, str>]) -> bool,
    ) -> Result<Self, RunError> {
        let table = File::open(path).and_then(|file| Self::of(BufReader::new(file), keep));
        table.map_err(|source| RunError::Read {
            path: path.to_owned(),
            source,
        })
    }

    fn of(
        mut text: impl BufRead,
        mut keep: impl FnMut(&[String], &[Cow<'_, str>]) -> bool,
    ) -> io::Result<Self> {
        let mut record = String::new();
        next_record(&mut text, &mut record)?;
        // A unit in brackets follows the name.
        let name = |h: &Cow<'_, str>| match h.rsplit_once(" [") {
            Some((name, unit)) if unit.ends_with(']') => name.to_owned(),
            _ => h.clone().into_owned(),
        };
        let names: Vec<String> = fields(&record).iter().map(name).collect();
        let mut rows = Vec::new();
        while next_record(&mut text, &mut record)? {
            let fields = fields(&record);
            if fields.len() == names.len() && keep(&names, &fields) {
                rows.push(fields.into_iter().map(Cow::into_owned).collect());
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

/// Reads the next record, without the line break at its end: lines as long as a quote is open.
/// Whether there was one.
fn next_record(text: &mut impl BufRead, record: &mut String) -> io::Result<bool> {
    record.clear();
    let open = |record: &str| record.bytes().filter(|&b| b == b'"').count() % 2 == 1;
    while text.read_line(record)? > 0 && open(record) {}
    let some = !record.is_empty();
    for end in ['\n', '\r'] {
        if record.ends_with(end) {
            record.pop();
        }
    }
    Ok(some)
}

/// The fields of a record.
fn fields(record: &str) -> Vec<Cow<'_, str>> {
    if !record.contains('"') {
        return record.split(',').map(Cow::Borrowed).collect();
    }
    let mut list = vec![String::new()];
    let (mut quoted, mut closed) = (false, false);
    for c in record.chars() {
        let field = list.last_mut();
        match (c, quoted) {
            (',', false) => list.push(String::new()),
            ('"', _) => {
                // A quote right after a closing one stands for itself.
                if !quoted && closed {
                    field.into_iter().for_each(|f| f.push('"'));
                }
                quoted = !quoted;
            }
            (c, _) => field.into_iter().for_each(|f| f.push(c)),
        }
        closed = c == '"' && !quoted;
    }
    list.into_iter().map(Cow::Owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names that end a field, a row or a quote, and such that look like a unit.
    const NAMES: [&str; 9] = [
        "plain",
        "a,b",
        "\"",
        "say \"a\", \"b\"",
        "two\nlines",
        "carriage\r\nreturn",
        ",\"\n,\"",
        "",
        "a [b] c",
    ];

    #[test]
    fn names_of_any_letters_are_read_back_as_they_were_written() {
        let header = NAMES.map(|n| field(&format!("{n} [mm]")).into_owned());
        let row = NAMES.map(|n| field(n).into_owned());
        for end in ["\n", "\r\n"] {
            let text = format!("{}{end}{}{end}", header.join(","), row.join(","));
            let table = Table::of(text.as_bytes(), |_, _| true).expect("a table");
            assert_eq!(table.names(), NAMES);
            assert_eq!(table.rows, [NAMES.map(str::to_owned)]);
        }
    }

    #[test]
    fn what_is_cut_off_is_no_row() {
        let table = |text: &str| Table::of(text.as_bytes(), |_, _| true).expect("a table");
        assert_eq!(table("a,b [mm]\n1,2\n3").rows.len(), 1);
        assert_eq!(table("a,b\n1,2\n\"3,4\n5,6\n").rows.len(), 1);
        assert_eq!(table("").rows.len(), 0);
        assert_eq!(table("a,b\n1,2\n3,4").numbers("b"), [2.0, 4.0]);
    }
}
