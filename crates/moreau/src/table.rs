//! Tables: columns with a name, a unit and values of one kind; and CSV, as RFC 4180 has it. What is in them
//! comes from elsewhere.

use crate::numbers::number as digits;
use std::borrow::Cow;
use std::io::{self, BufRead};

/// The values of a column, a row each.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers.
    Numbers(Vec<f64>),
    /// Whole numbers.
    Counts(Vec<i64>),
    /// Names.
    Texts(Vec<String>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(values) => values.len(),
            Self::Counts(values) => values.len(),
            Self::Texts(values) => values.len(),
        }
    }

    /// As numbers; a text that is none is NaN.
    pub fn numbers(&self) -> Vec<f64> {
        (0..self.len()).map(|row| self.number(row)).collect()
    }

    /// The number in a row that there is.
    fn number(&self, row: usize) -> f64 {
        match self {
            Self::Numbers(values) => values[row],
            Self::Counts(values) => values[row] as f64,
            Self::Texts(values) => values[row].parse().unwrap_or(f64::NAN),
        }
    }

    fn truncate(&mut self, rows: usize) {
        match self {
            Self::Numbers(values) => values.truncate(rows),
            Self::Counts(values) => values.truncate(rows),
            Self::Texts(values) => values.truncate(rows),
        }
    }

    fn field(&self, row: usize) -> Cow<'_, str> {
        match self {
            Self::Numbers(values) => digits(values[row]).into(),
            Self::Counts(values) => values[row].to_string().into(),
            Self::Texts(values) => field(&values[row]),
        }
    }
}

/// A column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit; empty if there is none.
    pub unit: String,
    /// A value for each row.
    pub values: Values,
}

impl Column {
    /// Name, and unit in brackets if there is one.
    fn label(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }
}

/// Columns of equal length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    columns: Vec<Column>,
}

impl Table {
    /// A table of columns; rows that not all of them have are left out.
    pub(crate) fn new(mut columns: Vec<Column>) -> Self {
        let rows = columns.iter().map(|c| c.values.len()).min().unwrap_or(0);
        for column in &mut columns {
            column.values.truncate(rows);
        }
        Self { columns }
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |c| c.values.len())
    }

    /// A column, by name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|c| c.name == name)
    }

    /// A column of numbers, by name; empty if there is none.
    pub fn numbers(&self, name: &str) -> Vec<f64> {
        let column = self.column(name);
        column.map_or_else(Vec::new, |c| c.values.numbers())
    }

    /// A column of texts, by name; empty if there is none.
    pub fn texts(&self, name: &str) -> Vec<&str> {
        match self.column(name).map(|c| &c.values) {
            Some(Values::Texts(values)) => values.iter().map(String::as_str).collect(),
            _ => Vec::new(),
        }
    }

    /// The line of CSV with the names, each with its unit in brackets.
    pub fn header(&self) -> String {
        let labels = self.columns.iter().map(Column::label);
        let fields: Vec<String> = labels.map(|label| field(&label).into_owned()).collect();
        fields.join(",")
    }

    /// A row as a line of CSV; numbers are read back exactly, but for the sign of zero.
    pub fn line(&self, row: usize) -> String {
        let fields = self.columns.iter().map(|c| c.values.field(row));
        fields.collect::<Vec<_>>().join(",")
    }

    /// Appends a row of numbers, as many as there are columns, none of which holds texts.
    pub(crate) fn push(&mut self, row: &[f64]) {
        for (column, &value) in self.columns.iter_mut().zip(row) {
            match &mut column.values {
                Values::Numbers(values) => values.push(value),
                Values::Counts(values) => values.push(value as i64),
                Values::Texts(values) => values.push(digits(value)),
            }
        }
    }

    /// The last row as numbers; `None` of an empty table.
    pub(crate) fn last(&self) -> Option<Vec<f64>> {
        let row = self.rows().checked_sub(1)?;
        let columns = self.columns.iter();
        Some(columns.map(|c| c.values.number(row)).collect())
    }

    /// Removes all rows.
    pub(crate) fn clear(&mut self) {
        for column in &mut self.columns {
            column.values.truncate(0);
        }
    }

    /// The rows of CSV for which `keep` says so, from the names and the fields; all columns are texts.
    pub(crate) fn read(
        mut text: impl BufRead,
        mut keep: impl FnMut(&[String], &[Cow<'_, str>]) -> bool,
    ) -> io::Result<Self> {
        let mut record = String::new();
        next_record(&mut text, &mut record)?;
        // A unit in brackets follows the name.
        let label = |h: &Cow<'_, str>| match h.rsplit_once(" [") {
            Some((name, unit)) if unit.ends_with(']') => {
                (name.to_owned(), unit[..unit.len() - 1].to_owned())
            }
            _ => (h.clone().into_owned(), String::new()),
        };
        let (names, units): (Vec<String>, Vec<String>) = fields(&record).iter().map(label).unzip();
        let mut columns = vec![Vec::new(); names.len()];
        while next_record(&mut text, &mut record)? {
            let fields = fields(&record);
            if fields.len() == names.len() && keep(&names, &fields) {
                for (column, field) in columns.iter_mut().zip(fields) {
                    column.push(field.into_owned());
                }
            }
        }
        let column = |((name, unit), values)| Column {
            name,
            unit,
            values: Values::Texts(values),
        };
        let columns = names.into_iter().zip(units).zip(columns).map(column);
        Ok(Self::new(columns.collect()))
    }
}

/// A text as a field: within quotes, its own doubled, where it holds anything that ends a field.
fn field(text: &str) -> Cow<'_, str> {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")).into(),
        false => text.into(),
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
        let column = |name: &str| Column {
            name: name.to_owned(),
            unit: "mm".to_owned(),
            values: Values::Texts(vec![name.to_owned()]),
        };
        let written = Table::new(NAMES.map(column).to_vec());
        for end in ["\n", "\r\n"] {
            let text = format!("{}{end}{}{end}", written.header(), written.line(0));
            let read = Table::read(text.as_bytes(), |_, _| true).expect("a table");
            assert_eq!(read, written);
        }
    }

    #[test]
    fn numbers_are_read_back_as_they_were_written() {
        let numbers = vec![0.1 + 0.2, -1e300, 3.0, f64::NAN];
        let counts = vec![-1, 0, 1 << 40, 7];
        let column = |name: &str, values| Column {
            name: name.to_owned(),
            unit: String::new(),
            values,
        };
        let written = Table::new(vec![
            column("x", Values::Numbers(numbers.clone())),
            column("n", Values::Counts(counts.clone())),
        ]);
        let lines = (0..4).map(|row| written.line(row) + "\n");
        let text = written.header() + "\n" + &lines.collect::<String>();
        let read = Table::read(text.as_bytes(), |_, _| true).expect("a table");
        let bits = |v: Vec<f64>| v.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        assert_eq!(bits(read.numbers("x")), bits(numbers));
        let counts: Vec<f64> = counts.iter().map(|&n| n as f64).collect();
        assert_eq!(read.numbers("n"), counts);
    }

    #[test]
    fn what_is_cut_off_is_no_row() {
        let table = |text: &str| Table::read(text.as_bytes(), |_, _| true).expect("a table");
        assert_eq!(table("a,b [mm]\n1,2\n3").rows(), 1);
        assert_eq!(table("a,b\n1,2\n\"3,4\n5,6\n").rows(), 1);
        assert_eq!(table("").rows(), 0);
        assert_eq!(table("a,b\n1,2\n3,4").numbers("b"), [2.0, 4.0]);
    }
}
