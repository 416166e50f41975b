//! What is said about a deck that is wrong or doubtful, and that nothing said about it is a panic.

mod along;
mod amplitudes;
mod axes;
mod changes;
mod contacts;
mod driven;
mod flat;
mod heat;
mod includes;
mod initial;
mod keys;
mod laws;
mod layers;
mod meshes;
mod metamorphic;
mod methods;
mod mutants;
mod parameters;
mod parts;
mod refused;
mod rules;
mod schema;
mod supports;
mod surfaces;
mod ties;
mod unjoined;
mod values;

use moreau::deck::{Class, Problem, open, open_in};
use std::path::{Path, PathBuf};

const DECK: &str = include_str!("../../../../docs/examples/punched-block.toml");

/// A folder of the repository.
fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// A path for what a test writes.
fn temporary(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// A text on one line, without the bars before the lines of a long message.
fn flat(text: &str) -> String {
    let words = text.split_whitespace().filter(|word| *word != "│");
    words.collect::<Vec<_>>().join(" ")
}

/// What is shown for the example with a piece of its text replaced.
fn shown(from: &str, to: &str) -> String {
    assert!(DECK.contains(from), "{from:?} is not in the example");
    let text = DECK.replacen(from, to, 1);
    let (_, problem, findings) = open(&text);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    findings.render("deck.toml", &text, false)
}

/// Asserts that the message for a replacement has the line of a text and these words.
fn says(from: &str, to: &str, at: &str, words: &[&str]) {
    let out = shown(from, to);
    let text = DECK.replacen(from, to, 1);
    let line = 1 + text.lines().position(|l| l.contains(at)).expect("a line");
    assert!(
        out.contains(&format!("deck.toml:{line}:")),
        "line {line} in {out}"
    );
    let flat = flat(&out);
    for word in words {
        assert!(flat.contains(word), "{word:?} in {out}");
    }
}

#[test]
fn the_example_is_clean() {
    let (deck, problem, findings) = open(DECK);
    assert_eq!((findings.errors(), findings.warnings()), (0, 0));
    let Some(Problem::Plane(setup)) = problem else {
        panic!("a plane problem")
    };
    assert_eq!(setup.driver.mesh().cell_count(), 20);
    assert!((setup.bodies[0].volume - 1000.0).abs() < 1e-9);
    let punch = setup
        .groups
        .iter()
        .find(|g| g.name == "punch")
        .expect("punch");
    assert_eq!((punch.kind, punch.members, punch.nodes), ("facets", 5, 11));
    assert!((punch.measure.expect("an area") - 25.0).abs() < 1e-9);
    assert_eq!(deck.quadrature(&deck.materials[0]), "reduced");
}

/// Every class of findings has its section.
#[test]
fn every_class_of_findings_is_explained() {
    let page = include_str!("../../../../docs/errors.md");
    for class in Class::ALL {
        let section = format!("\n## {}\n", class.name());
        assert!(page.contains(&section), "{section:?}");
    }
    let classes = |from: &str, to: &str| -> Vec<Class> {
        let (_, _, findings) = open(&DECK.replacen(from, to, 1));
        findings.iter().map(|f| f.class).collect()
    };
    assert_eq!(classes("young =", "young")[0], Class::Syntax);
    assert_eq!(classes("title", "titel"), [Class::Keys]);
    assert_eq!(classes("0.3", "0.7"), [Class::Values]);
    assert_eq!(classes("on = \"punch\"", "on = \"pinch\""), [Class::Names]);
    assert_eq!(classes("x = [0, 25]", "x = [60, 70]"), [Class::Groups]);
    assert_eq!(classes("u = [\"x\"]", "u = [\"y\"]")[0], Class::Steps);
    assert_eq!(classes("friction = 0.1", "friction = 0"), [Class::Warnings]);
    let out = shown("title", "titel");
    assert!(out.contains("see docs/errors.md#keys"), "{out}");
}

#[test]
fn all_errors_are_shown_at_once() {
    let text = DECK
        .replace("poisson = 0.3", "poisson = 0.7")
        .replace("friction = 0.1", "frixion = 0.1")
        .replace("block.bottom", "block.botom")
        .replace("on = \"punch\"", "on = \"pinch\"");
    let (_, problem, findings) = open(&text);
    let out = findings.render("deck.toml", &text, false);
    assert!(problem.is_none() && findings.errors() == 4, "{out}");
    for word in ["0.7", "frixion", "pinch", "botom"] {
        assert!(out.contains(word), "{word} in {out}");
    }
}

/// What is wrong in `[expect]` keeps no problem from being built, and is told whatever else is wrong.
#[test]
fn all_that_cannot_be_expected_is_shown_at_once() {
    let (head, _) = DECK.split_once("[expect]").expect("expectations");
    let expected = |lines: &str| {
        let text = format!("{head}[expect]\n{lines}");
        let (_, problem, findings) = open(&text);
        assert_eq!(problem.is_none(), findings.errors() > 0);
        findings
            .iter()
            .map(|f| f.message.clone())
            .collect::<Vec<_>>()
    };
    let good = "\"force.punch.y\" = { value = -1, absolute = 1 }\n";
    assert_eq!(expected(good), [""; 0]);
    let both = expected("\"force.punsh.y\" = { value = -1 }\nopen = { value = 1, relative = -1 }");
    let told = [
        "no result is called \"force.punsh.y\"; did you mean \"force.punch.y\"?",
        "\"force.punsh.y\" has no tolerance ≥ 0",
        "\"open\" has no tolerance ≥ 0",
    ];
    assert_eq!(both, told);
    let text = format!("{head}[expect]\nopen = {{ value = 1 }}").replace("0.3", "0.7");
    let (_, _, findings) = open(&text);
    assert_eq!(findings.errors(), 2, "{findings:?}");
}

#[test]
fn syntax_errors_have_a_place() {
    let text = DECK.replace("young = 210000.0", "young 210000.0");
    let (_, problem, findings) = open(&text);
    let out = findings.render("deck.toml", &text, false);
    let line = 1 + text
        .lines()
        .position(|l| l.contains("young 2"))
        .expect("a line");
    assert!(
        problem.is_none() && out.contains(&format!("deck.toml:{line}:")),
        "{out}"
    );
}

/// In characters, whatever bytes they take.
#[test]
fn findings_have_line_and_column() {
    let from = "contact = [{ surface = \"é\", frixion = 0.1 }]\n";
    for (text, wrong) in [
        (DECK.replace("friction = 0.1", "frixion = 0.1"), "frixion"),
        (format!("{from}{DECK}"), "frixion"),
        (DECK.replacen('#', "titel = \"\"\n#", 1), "titel"),
    ] {
        let (_, _, findings) = open(&text);
        let mut places = findings.places(&text);
        let found = places.find(|(finding, ..)| finding.message.contains(wrong));
        let (_, line, column) = found.expect("a finding");
        let own = text.lines().nth(line - 1).expect("a line");
        let from: String = own.chars().skip(column - 1).collect();
        assert!(from.starts_with(wrong), "{line}:{column} is {from:?}");
    }
}

#[test]
fn a_resolved_deck_is_the_same_deck() {
    for text in [
        DECK,
        include_str!("../../../../docs/examples/coated-block.toml"),
        include_str!("../../../../docs/examples/indentation-flat-punch.toml"),
        include_str!("../../../../docs/examples/block-dragged-on-block.toml"),
        include_str!("../../../../docs/examples/block-opening-sliding-sticking.toml"),
        include_str!("../../../../docs/examples/cylinder-pressed-into-block.toml"),
        include_str!("../../../../docs/examples/pad-dragged-over-plate.toml"),
        include_str!("../../../../docs/examples/punch-on-gmsh-mesh.toml"),
        include_str!("../../../../docs/examples/strip-between-rough-platens.toml"),
        &include_str!("../../../../docs/large/punch-in-space.toml")
            .replace("cells = [30, 30, 15]", "cells = [3, 3, 2]"),
        &DECK
            .replace(
                "increments = 20",
                "increments = { start = 0.1, min = 1e-5, max = 0.5 }",
            )
            .replace(
                "friction = 0.1",
                "friction = 0.1\ngap-offset = 0.5\nadjust = true",
            )
            .replace(
                "[expect]",
                "[solver]\ncontact = { penetration = 1e-4 }\n[expect]",
            )
            .replace(
                "plane = { point = [0, 0], normal = [0, 1] }",
                "polyline = [[-9, 0], [99, 0]]",
            ),
    ] {
        let once = open_in(text, &folder("docs/examples")).0.resolved();
        let (deck, problem, findings) = open(&once);
        assert!(
            problem.is_some(),
            "{}",
            findings.render("resolved", &once, false)
        );
        assert_eq!(deck.resolved(), once);
    }
}
