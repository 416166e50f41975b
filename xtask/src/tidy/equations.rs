//! `docs/equations.md` names every numbered equation of the paper once and tells where it is; whether
//! the code there says the same is for the reader and the tests.
//!
//! The format is a table with one row per equation or inclusive range of equations:
//!
//! ```text
//! | eq.       | what                  | where                                        |
//! |-----------|-----------------------|----------------------------------------------|
//! | [36]      | Coulomb's cone        | `moreau_laws::Coulomb::project`              |
//! | [39]–[41] | proof of extremality  | — a proof; its result is tested              |
//! | [80a]     | stress increments     | `moreau_laws::BulkLaw::respond`              |
//! ```
//!
//! A row `[80a]` covers 80 unless a row `[80]` does. Any words may surround the paths.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::Violation;
use super::items::Items;

/// The file.
pub const FILE: &str = "docs/equations.md";
/// The equations of the paper.
const EQUATIONS: RangeInclusive<u32> = 1..=90;

/// Equations that are missing, named twice, or said to be where they are not.
pub fn violations(text: &str, items: &Items) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut seen: BTreeMap<(u32, String), usize> = BTreeMap::new();
    let mut last_row = 1;
    for (at, line) in text.lines().enumerate() {
        let line_number = at + 1;
        let Some(cells) = row(line) else { continue };
        last_row = line_number;
        let mut add = |what: String, expected: &str| {
            violations.push(Violation::new(FILE, line_number, what, expected));
        };
        let [eq, what, place] = &cells[..] else {
            add(
                format!("{} columns", cells.len()),
                "three: eq., what, where",
            );
            continue;
        };
        let Some(labels) = labels(eq) else {
            add(format!("`{eq}`"), "`[n]`, `[na]` or `[n]–[m]`");
            continue;
        };
        if what.is_empty() {
            add(format!("{eq} without a description"), "what it is");
        }
        for label in labels {
            let name = format!("[{}{}]", label.0, label.1);
            if !EQUATIONS.contains(&label.0) {
                add(format!("equation {name}"), "equations [1] to [90]");
            } else if let Some(first) = seen.insert(label, line_number) {
                add(
                    format!("equation {name} again, after line {first}"),
                    "every equation once",
                );
            }
        }
        place_violations(eq, place, items, &mut add);
    }
    for number in EQUATIONS {
        if !seen.keys().any(|(n, _)| *n == number) {
            let what = format!("equation [{number}] is missing");
            violations.push(Violation::new(
                FILE,
                last_row,
                what,
                "a row for every equation",
            ));
        }
    }
    violations
}

/// Checks the column `where`.
fn place_violations(eq: &str, place: &str, items: &Items, add: &mut dyn FnMut(String, &str)) {
    if let Some(reason) = place.strip_prefix('—') {
        if reason.trim().is_empty() {
            add(
                format!("{eq} is nowhere, without a reason"),
                "`— ` and the reason",
            );
        }
        return;
    }
    let quoted: Vec<&str> = place.split('`').skip(1).step_by(2).collect();
    let paths: Vec<&&str> = quoted.iter().filter(|path| path.contains("::")).collect();
    if paths.is_empty() {
        add(
            format!("{eq} is nowhere"),
            "paths such as `moreau_laws::Coulomb`, or `—` and a reason",
        );
    }
    for path in paths {
        if !items.has(path) {
            add(
                format!("{eq} is said to be in `{path}`"),
                "an item of the sources",
            );
        }
    }
}

/// The cells of a row about equations: a line of a table whose first cell begins with a bracket.
fn row(line: &str) -> Option<Vec<String>> {
    let inner = line.trim().strip_prefix('|')?;
    inner.trim_start().strip_prefix('[')?;
    let inner = inner.replace("\\|", "\u{0}");
    let inner = inner.trim_end().strip_suffix('|').unwrap_or(&inner);
    Some(
        inner
            .split('|')
            .map(|cell| cell.trim().replace('\u{0}', "|"))
            .collect(),
    )
}

/// The equations of a first cell, as number and suffix.
fn labels(cell: &str) -> Option<Vec<(u32, String)>> {
    let bare = cell.replace(['[', ']', ' '], "");
    let mut ends = bare.splitn(2, ['–', '-']);
    let first = label(ends.next()?)?;
    let Some(last) = ends.next() else {
        return Some(vec![first]);
    };
    let last = label(last)?;
    let plain = first.1.is_empty() && last.1.is_empty();
    (plain && first.0 < last.0).then(|| (first.0..=last.0).map(|n| (n, String::new())).collect())
}

/// `80a` as 80 and `a`.
fn label(text: &str) -> Option<(u32, String)> {
    let digits = text
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(text.len());
    let suffix = &text[digits..];
    let allowed = suffix
        .chars()
        .all(|c| c.is_ascii_lowercase() || c == '′' || c == '\'');
    Some((text[..digits].parse().ok()?, suffix.to_owned())).filter(|_| allowed)
}

#[cfg(test)]
mod tests {
    use super::super::source::Source;
    use super::*;

    fn found(rows: &str) -> Vec<String> {
        let law = "pub struct Coulomb;\nimpl Coulomb { pub fn project(&self) {} }";
        let items = Items::of(&[Source::new("crates/laws/src/coulomb.rs", law)]);
        let text = format!("# Equations\n\n| eq. | what | where |\n|---|---|---|\n{rows}");
        violations(&text, &items)
            .into_iter()
            .map(|v| format!("{}: {}", v.line, v.what))
            .collect()
    }

    const REST: &str = "| [3]–[90] | the rest | — not needed |\n";

    #[test]
    fn a_complete_table_passes() {
        let rows = "| [1] | a | `moreau_laws::Coulomb` |\n\
                    | [2] | \\|x\\| | `moreau_laws::Coulomb::project`, with care |\n";
        assert!(found(&format!("{rows}{REST}")).is_empty());
        let rows = "| [1–2] | a | — a definition |\n| [90′] | a | `moreau_laws::Coulomb` |\n";
        assert!(found(&format!("{rows}{REST}")).is_empty());
        let rows = "| [1] | a | — x |\n| [2a] | a | — x |\n| [2b] | a | — x |\n";
        assert!(found(&format!("{rows}{REST}")).is_empty());
    }

    #[test]
    fn missing_and_repeated_equations_are_found() {
        let list = found(&format!("| [1] | a | — x |\n{REST}"));
        assert_eq!(list, ["6: equation [2] is missing"]);
        let list = found(&format!("| [1]-[3] | a | — x |\n{REST}"));
        assert_eq!(list, ["6: equation [3] again, after line 5"]);
        let list = found(&format!(
            "| [1]–[2] | a | — x |\n{REST}| [91] | a | — x |\n"
        ));
        assert_eq!(list, ["7: equation [91]"]);
    }

    #[test]
    fn places_that_do_not_exist_are_found() {
        let list = found(&format!(
            "| [1] | a | `moreau_laws::Coulomb::prox` |\n| [2] | a | — |\n{REST}"
        ));
        let expected = [
            "5: [1] is said to be in `moreau_laws::Coulomb::prox`",
            "6: [2] is nowhere, without a reason",
        ];
        assert_eq!(list, expected);
        let list = found(&format!("| [1] | a | see `text` |\n| [2] | a | |\n{REST}"));
        assert_eq!(list, ["5: [1] is nowhere", "6: [2] is nowhere"]);
    }

    #[test]
    fn malformed_rows_are_found() {
        let list = found(&format!("| [x] | a | — x |\n| [1]–[2] | — x |\n{REST}"));
        assert!(list.contains(&"5: `[x]`".to_owned()) && list.contains(&"6: 2 columns".to_owned()));
        assert_eq!(labels("[5]–[3]"), None);
    }
}
