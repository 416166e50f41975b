//! The pages of the files of results: their columns and keys; not how these are computed.

use std::fmt::Write;

use super::described::Entry;
use crate::markdown::{cell, code};

/// Where the units of a page are told.
const UNITS: &str = "Units are those of the deck: where three are given, of `mm-N-MPa`, `m-N-Pa` and `in-lbf-psi` in this \
     order.";

/// The page of `history.csv`.
pub fn history(columns: &[Entry]) -> String {
    page(
        "history.csv",
        "A row for each converged increment. The header has the name of each column and its unit in brackets. Words in \
         capitals stand for names: NAME for a group of the mesh, a tool or a surface, AXIS for `x`, `y` and in space `z`, \
         FIELD for a field of a law.",
        "column",
        columns,
    )
}

/// The page of `contact.csv`.
pub fn contact(columns: &[Entry]) -> String {
    page(
        "contact.csv",
        "A row for each contact point after an increment. The header has the name of each column and its unit in brackets. \
         Components that a problem in the plane does not have are zero.",
        "column",
        columns,
    )
}

/// The page of `run.json`.
pub fn run(keys: &[Entry]) -> String {
    page(
        "run.json",
        "How a run ended, for programs. While it goes on, and after it was killed, there is nothing but \
         `\"status\": \"running\"`. A key within another is there where that is not `null`, and is named by the way to it, with `[]` for the elements of a list. \
         Numbers that are not finite are `null`.",
        "key",
        keys,
    )
}

fn page(file: &str, about: &str, what: &str, entries: &[Entry]) -> String {
    let mut page = format!(
        "# {file}\n\nWritten by `cargo xtask docs` from the table that the program writes the file by. {about} {UNITS}\n\n\
         | {what} | unit | meaning | when |\n|---|---|---|---|\n"
    );
    for entry in entries {
        let when = match entry.when.as_str() {
            "" => "always".to_owned(),
            when => cell(when),
        };
        let (name, meaning) = (code(&entry.name), cell(&entry.meaning));
        let _ = writeln!(page, "| {name} | {} | {meaning} | {when} |", entry.unit);
    }
    page
}

/// What entries lack.
pub fn lacks(entries: &[Entry]) -> Vec<String> {
    let without = entries.iter().filter(|e| e.meaning.trim().is_empty());
    without
        .map(|e| format!("{} has no description", e.name))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(meaning: &str, when: &str) -> Entry {
        Entry {
            name: "force.NAME.AXIS".into(),
            unit: "N".into(),
            meaning: meaning.into(),
            when: when.into(),
        }
    }

    #[test]
    fn a_row_has_unit_meaning_and_when() {
        let page = history(&[entry("Size |f|.", ""), entry("Force.", "of tools")]);
        assert!(page.contains("\n| `force.NAME.AXIS` | N | Size \\|f\\|. | always |\n"));
        assert!(page.contains("| N | Force. | of tools |\n"), "{page}");
    }

    #[test]
    fn a_column_without_description_is_told() {
        let lacks = lacks(&[entry("Force.", ""), entry(" ", "")]);
        assert_eq!(lacks, ["force.NAME.AXIS has no description"]);
    }
}
