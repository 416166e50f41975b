//! Licences of all packages that are built into the programs, told by their manifests: those that go with MIT and
//! Apache-2.0; not their texts.

use super::Violation;
use serde::Deserialize;
use std::error::Error;
use std::path::Path;
use std::process::Command;

/// Licences that ask for no more than their text to be kept.
const ACCEPTED: [&str; 8] = [
    "0BSD",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "ISC",
    "MIT",
    "Unicode-3.0",
    "Zlib",
];

#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    license: Option<String>,
}

/// Packages that this machine builds under other licences.
pub fn violations(root: &Path) -> Result<Vec<Violation>, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let host = Command::new(&cargo).arg("-vV").output()?;
    let host = String::from_utf8(host.stdout)?;
    let host = host.lines().find_map(|line| line.strip_prefix("host: "));
    let host = host.ok_or("cargo does not say what it runs on")?;
    let output = Command::new(cargo)
        .args(["metadata", "--locked", "--format-version", "1"])
        .args(["--filter-platform", host])
        .current_dir(root)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).trim().into());
    }
    let metadata: Metadata = serde_json::from_slice(&output.stdout)?;
    let refused = metadata.packages.into_iter().filter_map(|package| {
        let licence = package.license.unwrap_or_default();
        let what = format!("{} under \"{licence}\"", package.name);
        let expected = format!("a choice of {}", ACCEPTED.join(", "));
        (!accepted(&licence)).then(|| Violation::new("Cargo.lock", 1, what, expected))
    });
    Ok(refused.collect())
}

/// Whether an expression of SPDX leaves a choice that is accepted; an old one has "/" for "OR".
fn accepted(expression: &str) -> bool {
    let spaced = expression.replace('/', " OR ");
    let spaced = spaced.replace('(', " ( ").replace(')', " ) ");
    let mut words = spaced.split_whitespace().peekable();
    any(&mut words) && words.next().is_none()
}

type Words<'a> = std::iter::Peekable<std::str::SplitWhitespace<'a>>;

fn any(words: &mut Words<'_>) -> bool {
    let mut one = all(words);
    while words.next_if_eq(&"OR").is_some() {
        one |= all(words);
    }
    one
}

fn all(words: &mut Words<'_>) -> bool {
    let mut every = licence(words);
    while words.next_if_eq(&"AND").is_some() {
        every &= licence(words);
    }
    every
}

fn licence(words: &mut Words<'_>) -> bool {
    match words.next() {
        Some("(") => {
            let inside = any(words);
            words.next() == Some(")") && inside
        }
        Some(name) => {
            // An exception only gives more leave.
            if words.next_if_eq(&"WITH").is_some() {
                words.next();
            }
            ACCEPTED.contains(&name)
        }
        None => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_suffices_and_all_of_a_conjunction_are_needed() {
        for yes in [
            "MIT",
            "Unlicense/MIT",
            "MIT OR Apache-2.0 OR LGPL-2.1-or-later",
            "(MIT OR Apache-2.0) AND Unicode-3.0",
            "Apache-2.0 WITH LLVM-exception",
        ] {
            assert!(accepted(yes), "{yes}");
        }
        for no in [
            "",
            "GPL-3.0",
            "MIT AND GPL-3.0",
            "(MIT OR GPL-3.0) AND LGPL-2.1",
            "(MIT",
        ] {
            assert!(!accepted(no), "{no}");
        }
    }
}
