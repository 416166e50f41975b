//! The decks of the golden rules: what is wrong is told in the words that the page quotes, and what is right says nothing.

use super::{flat, folder};
use moreau::deck::Given;
use moreau::simulation::{RunStatus, Simulation};
use std::fs;
use std::ops::ControlFlow;

/// All that is said of a deck before, while and after it is run; whether that is nothing.
fn said(text: &str) -> (String, bool) {
    let (simulation, findings) =
        Simulation::open(text, &folder("docs/guide/rules"), &Given::default());
    let mut said = findings.render("deck", text, false);
    let Some(mut simulation) = simulation else {
        return (said, false);
    };
    while let Ok(Some(_)) = simulation.advance(&mut |_, _| ControlFlow::Continue(())) {}
    let outcome = simulation.outcome();
    let failed = outcome.verdicts.iter().filter(|v| !v.passed());
    let failed: Vec<String> = failed.map(|v| v.column.clone()).collect();
    let good = outcome.status == RunStatus::Done
        && findings.iter().next().is_none()
        && outcome.warnings.is_empty()
        && failed.is_empty();
    said.push_str(outcome.error().unwrap_or_default());
    for more in [&outcome.warnings, &failed] {
        said.push_str(&more.join("\n"));
    }
    (said, good)
}

#[test]
fn every_rule_has_a_deck_that_breaks_it_and_one_that_keeps_it() {
    let page = fs::read_to_string(folder("docs/guide/golden-rules.md")).expect("a page");
    let mut pairs = 0;
    for entry in fs::read_dir(folder("docs/guide/rules")).expect("decks") {
        let path = entry.expect("an entry").path();
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        assert!(page.contains(&name), "{name} is not on the page");
        let text = fs::read_to_string(&path).expect("a deck");
        let (said, good) = said(&text);
        match text.strip_prefix("# says: ") {
            Some(rest) => {
                let words = rest.lines().next().expect("a line");
                assert!(
                    !good && flat(&said).contains(words),
                    "{name}: {words} in {said}"
                );
                assert!(
                    page.contains(&format!("> {words}")),
                    "{words} is not quoted"
                );
                let other = path.with_file_name(name.replace("-wrong", "-right"));
                assert!(other.is_file(), "{}", other.display());
                pairs += 1;
            }
            None => assert!(good, "{name}: {said}"),
        }
    }
    assert_eq!(pairs, 10);
}
