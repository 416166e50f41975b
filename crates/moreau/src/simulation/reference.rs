//! What is in the files of results, for whoever writes about them: columns and keys with units and meanings, from the
//! tables that the files are written by; not the values.

use super::{contact, json};
use crate::deck::{Described, Units, history_columns};

/// A column of a table or a key of an object; or those of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Name, with words in capitals for what is named elsewhere; of a key within another the way to it.
    pub name: String,
    /// Its unit in each system of units, in the order of [`Units::NAMES`], or once if it is the same in all; empty if
    /// there is none.
    pub unit: String,
    /// What it is.
    pub meaning: &'static str,
    /// When it is there; empty for always.
    pub when: &'static str,
}

impl Entry {
    fn new(way: &str, described: &Described) -> Self {
        let systems = Units::NAMES.into_iter().filter_map(Units::named);
        let all: Vec<&str> = systems.map(|units| described.unit.symbol(units)).collect();
        Self {
            name: format!("{way}{}", described.name),
            unit: match all.windows(2).all(|pair| pair[0] == pair[1]) {
                true => all.first().copied().unwrap_or_default().to_owned(),
                false => all.join(", "),
            },
            meaning: described.meaning,
            when: described.when,
        }
    }
}

/// The columns of `history.csv`.
pub fn history() -> Vec<Entry> {
    history_columns().map(|c| Entry::new("", c)).collect()
}

/// The columns of `contact.csv`.
pub fn contact() -> Vec<Entry> {
    contact::COLUMNS.iter().map(|c| Entry::new("", c)).collect()
}

/// The keys of `run.json`.
pub fn run() -> Vec<Entry> {
    let keys = json::keys().into_iter();
    keys.map(|(way, key)| Entry::new(way, key)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_described_once() {
        for list in [history(), contact(), run()] {
            let names: std::collections::BTreeSet<&str> =
                list.iter().map(|e| e.name.as_str()).collect();
            assert_eq!(names.len(), list.len());
            for entry in &list {
                assert!(entry.meaning.ends_with('.'), "{entry:?}");
            }
        }
    }

    #[test]
    fn units_are_those_of_all_systems() {
        let unit = |list: Vec<Entry>, name: &str| {
            let entry = list.into_iter().find(|e| e.name == name);
            entry.map(|e| e.unit)
        };
        assert_eq!(unit(history(), "penetration").as_deref(), Some("mm, m, in"));
        assert_eq!(unit(history(), "turn.NAME").as_deref(), Some("°"));
        assert_eq!(unit(contact(), "kind").as_deref(), Some(""));
        assert_eq!(
            unit(run(), "diagnosis.worst[].force").as_deref(),
            Some("N, N, lbf")
        );
    }
}
