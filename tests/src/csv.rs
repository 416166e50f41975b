//! A table as comma-separated values (RFC 4180, lines ended by a line feed); not a CSV reader.

use crate::Table;

impl Table {
    /// The whole file: header, then rows.
    pub fn csv(&self) -> String {
        let line = |cells: &Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| field(cell)).collect();
            cells.join(",") + "\n"
        };
        std::iter::once(&self.header)
            .chain(&self.rows)
            .map(line)
            .collect()
    }
}

/// A field, quoted if it could be misread.
fn field(cell: &str) -> String {
    let special = cell.contains(['"', ',', ';', '\n', '\r', '\t']);
    if special || cell.trim() != cell {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_could_be_misread_are_quoted() {
        let row = |cells: &[&str]| cells.iter().map(|&cell| cell.to_owned()).collect();
        let table = Table {
            name: "a".into(),
            title: "b".into(),
            header: row(&["x [mm]", "the \"state\""]),
            rows: vec![row(&["1.5", "slip, then stick"]), row(&["", "two\nlines"])],
        };
        let expected = "x [mm],\"the \"\"state\"\"\"\n1.5,\"slip, then stick\"\n,\"two\nlines\"\n";
        assert_eq!(table.csv(), expected);
    }
}
