//! Keyword lines and the data lines below them; knows the meaning of none.

use crate::read::{Place, ReadError};

/// A keyword line and its data.
#[derive(Debug)]
pub(super) struct Block<'a> {
    /// Line of the keyword, from 1.
    pub(super) line: usize,
    /// In upper case, words separated by one space.
    pub(super) keyword: String,
    /// Parameters, their names in upper case.
    parameters: Vec<(String, Option<&'a str>)>,
    /// Data lines that are not blank, with their numbers.
    pub(super) data: Vec<(usize, &'a str)>,
}

impl<'a> Block<'a> {
    pub(super) fn place(&self) -> Place {
        Place::Line(self.line)
    }

    pub(super) fn has(&self, parameter: &str) -> bool {
        self.parameters.iter().any(|(name, _)| name == parameter)
    }

    /// The value of a parameter, without quotes.
    pub(super) fn value(&self, parameter: &str) -> Option<&'a str> {
        let found = self.parameters.iter().find(|(name, _)| name == parameter);
        found.and_then(|(_, value)| *value)
    }

    /// The value of a parameter that must be given.
    pub(super) fn needed(&self, parameter: &str) -> Result<&'a str, ReadError> {
        let value = self.value(parameter).filter(|value| !value.is_empty());
        value.ok_or_else(|| ReadError::Unexpected {
            place: self.place(),
            found: format!("*{}", self.keyword),
            expected: format!("the parameter {parameter}="),
        })
    }
}

/// The fields of a data line; a comma at its end adds none.
pub(super) fn fields(line: &str) -> impl Iterator<Item = &str> {
    let line = line.strip_suffix(',').unwrap_or(line);
    line.split(',').map(unquoted)
}

/// A field as a number of a node or element.
pub(super) fn number(line: usize, field: &str) -> Result<u64, ReadError> {
    field
        .parse()
        .map_err(|_| unexpected(line, field, "the number of a node or element"))
}

pub(super) fn unexpected(line: usize, found: &str, expected: &str) -> ReadError {
    ReadError::Unexpected {
        place: Place::Line(line),
        found: found.chars().take(40).collect(),
        expected: expected.into(),
    }
}

fn unquoted(field: &str) -> &str {
    let field = field.trim();
    let inner = field.strip_prefix('"').and_then(|f| f.strip_suffix('"'));
    inner.unwrap_or(field)
}

/// The blocks of a file: comments dropped, a keyword line that ends in a comma goes on in the next.
pub(super) fn blocks(text: &str) -> Result<Vec<Block<'_>>, ReadError> {
    let mut blocks: Vec<Block<'_>> = Vec::new();
    let mut continued = false;
    let lines = text.trim_start_matches('\u{feff}').lines();
    for (number, line) in (1..).zip(lines.map(str::trim)) {
        if line.is_empty() || line.starts_with("**") {
            continue;
        }
        let mut parameters = line;
        if let Some(rest) = line.strip_prefix('*') {
            let (keyword, rest) = rest.split_once(',').unwrap_or((rest, ""));
            let words: Vec<&str> = keyword.split_whitespace().collect();
            blocks.push(Block {
                line: number,
                keyword: words.join(" ").to_uppercase(),
                parameters: Vec::new(),
                data: Vec::new(),
            });
            parameters = rest;
            continued = true;
        }
        let Some(block) = blocks.last_mut() else {
            return Err(unexpected(number, line, "a keyword, *NAME,"));
        };
        if !continued {
            block.data.push((number, line));
            continue;
        }
        for parameter in parameters.split(',').filter(|p| !p.trim().is_empty()) {
            let (name, value) = match parameter.split_once('=') {
                Some((name, value)) => (name, Some(unquoted(value))),
                None => (parameter, None),
            };
            let name = name.trim().to_uppercase();
            block.parameters.push((name, value));
        }
        continued = line.ends_with(',');
    }
    Ok(blocks)
}
