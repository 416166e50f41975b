//! Versions of foreign packages that must not be locked because they compute wrong results; security
//! advisories are the business of other tools.

use super::Violation;

/// Package, first sound version, and what older ones do.
const SOUND: [(&str, [u64; 3], &str); 1] = [(
    "private-gemm-x86",
    [0, 1, 22],
    "older ones corrupt parallel products silently",
)];

/// Packages of a `Cargo.lock` that are too old.
pub fn violations(lock: &str) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut name = "";
    for (at, line) in lock.lines().enumerate() {
        if let Some(value) = value(line, "name") {
            name = value;
        }
        let Some(version) = value(line, "version") else {
            continue;
        };
        let Some((_, sound, why)) = SOUND.iter().find(|(package, ..)| *package == name) else {
            continue;
        };
        if numbers(version).is_none_or(|numbers| numbers < *sound) {
            let [major, minor, patch] = sound;
            let expected = format!("at least {major}.{minor}.{patch} ({why})");
            violations.push(Violation::new(
                "Cargo.lock",
                at + 1,
                format!("{name} {version}"),
                expected,
            ));
        }
    }
    violations
}

/// The value of a line `key = "value"`.
fn value<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    line.strip_prefix(key)?
        .strip_prefix(" = \"")?
        .strip_suffix('"')
}

/// Major, minor and patch; none for a pre-release, which is older than its numbers say.
fn numbers(version: &str) -> Option<[u64; 3]> {
    let release = version.split('+').next()?;
    let numbers: Vec<u64> = release
        .split('.')
        .map(str::parse)
        .collect::<Result<_, _>>()
        .ok()?;
    numbers.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(version: &str) -> Vec<usize> {
        let lock = format!(
            "version = 4\n\n[[package]]\nname = \"a\"\nversion = \"0.0.1\"\n\n[[package]]\n\
             name = \"private-gemm-x86\"\nversion = \"{version}\"\n"
        );
        violations(&lock).into_iter().map(|v| v.line).collect()
    }

    #[test]
    fn unsound_versions_are_found() {
        for version in ["0.1.21", "0.0.99", "0.1.22-alpha.1"] {
            assert_eq!(lines(version), [9], "{version}");
        }
    }

    #[test]
    fn sound_versions_pass() {
        for version in ["0.1.22", "0.1.100", "0.2.0", "1.0.0", "0.1.22+build"] {
            assert!(lines(version).is_empty(), "{version}");
        }
    }
}
