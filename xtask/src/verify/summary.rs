//! `summary.json`: every check of every case, for programs; the page for people is the report.

use serde::Serialize;
use verification::Check;

use super::execute::Run;

#[derive(Serialize)]
struct Summary<'a> {
    cases: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    name: &'a str,
    title: &'a str,
    seconds: f64,
    checks: &'a [Check],
    /// Only when the case erred.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

/// The text of the file. Numbers that are not finite become `null`, for JSON has no others.
pub fn json(runs: &[Run<'_>]) -> serde_json::Result<String> {
    let cases = runs
        .iter()
        .map(|run| Entry {
            name: run.case.name,
            title: run.case.title,
            seconds: (run.seconds * 1e3).round() / 1e3,
            checks: run.checks(),
            error: run.error(),
        })
        .collect();
    Ok(serde_json::to_string_pretty(&Summary { cases })? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::execute::execute;
    use crate::verify::progress::Progress;
    use crate::verify::samples;

    #[test]
    fn the_keys_are_those_agreed_on() {
        let cases = samples::cases();
        let runs: Vec<_> = cases
            .iter()
            .map(|case| execute(case, true, Progress::Silent))
            .collect();
        let value: serde_json::Value = serde_json::from_str(&json(&runs).unwrap()).unwrap();
        let keys = |value: &serde_json::Value| -> Vec<String> {
            let mut keys: Vec<String> = value.as_object().unwrap().keys().cloned().collect();
            keys.sort();
            keys
        };
        assert_eq!(keys(&value), ["cases"]);
        let [sound, flawed, erring] = [0, 1, 2].map(|i| &value["cases"][i]);
        assert_eq!(keys(sound), ["checks", "name", "seconds", "title"]);
        assert_eq!(
            keys(&sound["checks"][1]),
            [
                "kind",
                "name",
                "pass",
                "reference",
                "source",
                "tolerance",
                "unit",
                "value"
            ]
        );
        assert_eq!(sound["checks"][1]["kind"], "at-most");
        assert!(flawed["checks"][0]["value"].is_null(), "NaN is null");
        assert_eq!(flawed["checks"][0]["pass"], false);
        assert_eq!(
            keys(erring),
            ["checks", "error", "name", "seconds", "title"]
        );
    }
}
