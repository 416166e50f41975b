//! Which cases are meant by the names on the command line; not how they are run.

use std::fmt;

use verification::Case;

/// A name that no case bears.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownCase {
    /// The name as it was given.
    name: String,
    /// The name most like it, if one is like it at all.
    nearest: Option<&'static str>,
    /// All valid names.
    valid: Vec<&'static str>,
}

impl fmt::Display for UnknownCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "no case is named '{}'", self.name)?;
        if let Some(nearest) = self.nearest {
            write!(f, "; did you mean '{nearest}'?")?;
        }
        if self.valid.is_empty() {
            return write!(f, "\n\nthere are no cases");
        }
        write!(f, "\n\nthe cases are:")?;
        self.valid
            .iter()
            .try_for_each(|name| write!(f, "\n  {name}"))
    }
}

impl std::error::Error for UnknownCase {}

/// The cases named, in the order of the report and each once; all cases when none is named.
pub fn select<'a>(cases: &'a [Case], names: &[String]) -> Result<Vec<&'a Case>, UnknownCase> {
    let valid = || cases.iter().map(|case| case.name);
    if let Some(name) = names
        .iter()
        .find(|name| !valid().any(|known| known == *name))
    {
        return Err(UnknownCase {
            name: name.clone(),
            nearest: nearest(name, valid()),
            valid: valid().collect(),
        });
    }
    Ok(cases
        .iter()
        .filter(|c| names.is_empty() || names.iter().any(|n| n == c.name))
        .collect())
}

/// The valid name that begins or is spelt most like the given one.
fn nearest(name: &str, valid: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    let distance = |known: &str| {
        if known.contains(name) || name.contains(known) {
            1
        } else {
            edits(name, known)
        }
    };
    let (best, candidate) = valid.map(|known| (distance(known), known)).min()?;
    (best <= 1 + name.chars().count() / 2).then_some(candidate)
}

/// Levenshtein's distance: insertions, deletions and replacements from `a` to `b`.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::samples;

    fn names(asked: &[&str]) -> Result<Vec<&'static str>, UnknownCase> {
        let cases = samples::cases();
        let asked: Vec<String> = asked.iter().map(|&name| name.to_owned()).collect();
        select(&cases, &asked).map(|chosen| chosen.iter().map(|case| case.name).collect())
    }

    #[test]
    fn no_name_means_all_cases() {
        assert_eq!(names(&[]).unwrap().len(), samples::cases().len());
    }

    #[test]
    fn the_order_is_that_of_the_report_and_nothing_runs_twice() {
        assert_eq!(
            names(&["flawed", "sound", "flawed"]).unwrap(),
            ["sound", "flawed"]
        );
    }

    #[test]
    fn an_unknown_name_is_told_with_the_nearest_and_the_valid_ones() {
        let message = names(&["sonud"]).unwrap_err().to_string();
        assert!(message.contains("did you mean 'sound'?"), "{message}");
        assert!(message.contains("\n  erring"), "{message}");
    }

    #[test]
    fn nothing_is_suggested_for_a_name_like_no_other() {
        assert!(
            !names(&["zzzzzzzz"])
                .unwrap_err()
                .to_string()
                .contains("did you mean")
        );
    }

    #[test]
    fn distances_between_words() {
        assert_eq!(edits("", "abc"), 3);
        assert_eq!(edits("hertz", "hertz"), 0);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}
