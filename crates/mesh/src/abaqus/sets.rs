//! Named sets of numbers of nodes or elements; not of sides.

use super::keyword::{Block, fields, number, unexpected};
use crate::GroupKind;
use crate::nearest::nearest;
use crate::read::{Place, ReadError};
use std::collections::{BTreeMap, BTreeSet};

/// Number of characters of an unknown name that an error shows.
const SHOWN: usize = 80;

/// Sets by name, whatever its case.
#[derive(Debug)]
pub(super) struct Sets {
    kind: GroupKind,
    sets: BTreeMap<String, Set>,
}

#[derive(Debug)]
struct Set {
    /// The name as it is first written.
    name: String,
    /// Not a group of its own: a list that a program has put there for a surface.
    internal: bool,
    members: BTreeSet<u64>,
}

impl Sets {
    pub(super) fn new(kind: GroupKind) -> Self {
        let sets = BTreeMap::new();
        Self { kind, sets }
    }

    /// Adds to a set, which comes into being.
    pub(super) fn extend(
        &mut self,
        name: &str,
        internal: bool,
        members: impl IntoIterator<Item = u64>,
    ) {
        let set = self.sets.entry(name.to_uppercase());
        let set = set.or_insert_with(|| Set {
            name: name.into(),
            internal,
            members: BTreeSet::new(),
        });
        set.members.extend(members);
    }

    /// Members of a set referred to in some line.
    pub(super) fn members(&self, line: usize, name: &str) -> Result<&BTreeSet<u64>, ReadError> {
        let found = self.sets.get(&name.to_uppercase());
        found.map(|set| &set.members).ok_or_else(|| {
            let upper = name.to_uppercase();
            // The distance of long names takes long, and nobody mistypes them.
            let short = |name: &&str| name.len() + upper.len() <= 2 * SHOWN;
            let near = nearest(&upper, self.sets.keys().map(String::as_str).filter(short));
            ReadError::UnknownSet {
                place: Place::Line(line),
                kind: self.kind,
                name: name.chars().take(SHOWN).collect(),
                nearest: near
                    .and_then(|name| self.sets.get(name))
                    .map(|set| set.name.clone()),
            }
        })
    }

    /// Members that a block of `*NSET` or `*ELSET` lists, all among the numbers of the file.
    pub(super) fn listed(
        &self,
        block: &Block<'_>,
        numbers: &BTreeSet<u64>,
    ) -> Result<BTreeSet<u64>, ReadError> {
        let mut members = BTreeSet::new();
        for &(line, text) in &block.data {
            if block.has("GENERATE") {
                members.extend(self.generated(line, text, numbers)?);
                continue;
            }
            for field in fields(text) {
                if field.starts_with(|c: char| c.is_ascii_digit()) {
                    members.insert(self.member(line, number(line, field)?, numbers)?);
                } else {
                    members.extend(self.members(line, field)?);
                }
            }
        }
        Ok(members)
    }

    /// A number, if the file has it.
    pub(super) fn member(
        &self,
        line: usize,
        number: u64,
        numbers: &BTreeSet<u64>,
    ) -> Result<u64, ReadError> {
        if numbers.contains(&number) {
            return Ok(number);
        }
        Err(ReadError::UnknownMember {
            place: Place::Line(line),
            kind: self.kind,
            number,
        })
    }

    /// The numbers of the file among first, first + step, …, last.
    fn generated<'n>(
        &self,
        line: usize,
        text: &str,
        numbers: &'n BTreeSet<u64>,
    ) -> Result<impl Iterator<Item = u64> + use<'n>, ReadError> {
        let values = fields(text)
            .map(|field| number(line, field))
            .collect::<Result<Vec<_>, _>>()?;
        let (first, last, step) = match values[..] {
            [first, last] => (first, last, 1),
            [first, last, step] => (first, last, step),
            _ => (1, 0, 0),
        };
        if last < first || step == 0 {
            let expected = "first, last and step of a range, with first ≤ last and step ≥ 1,";
            return Err(unexpected(line, text, expected));
        }
        let mut members = numbers
            .range(first..=last)
            .copied()
            .filter(move |number| (number - first).is_multiple_of(step))
            .peekable();
        if members.peek().is_none() {
            self.member(line, first, &BTreeSet::new())?;
        }
        Ok(members)
    }

    /// The sets that are groups, by the names first written.
    pub(super) fn groups(&self) -> impl Iterator<Item = (&str, &BTreeSet<u64>)> {
        self.sets
            .values()
            .filter(|set| !set.internal)
            .map(|set| (&*set.name, &set.members))
    }
}
