//! Keys and names that do not exist.

use super::{DECK, says, shown};
use moreau::deck::open;

#[test]
fn unknown_keys_and_values_name_the_nearest() {
    says(
        "poisson",
        "poison",
        "poison",
        &["unknown key \"poison\"", "did you mean \"poisson\"?"],
    );
    says(
        "units = \"mm-N-MPa\"",
        "units = \"mm-N-Mpa\"",
        "units =",
        &[
            "expected \"mm-N-MPa\", \"m-N-Pa\" or \"in-lbf-psi\"",
            "did you mean \"mm-N-MPa\"?",
        ],
    );
    says("quad8", "quad88", "quad88", &["did you mean \"quad8\"?"]);
    says("title =", "titel =", "titel", &["did you mean \"title\"?"]);
    // A word that belongs one table further in.
    says(
        "increments = 20",
        "increments = 20\npressure = 3",
        "pressure = 3",
        &["unknown key \"pressure\" in [[step]]; did you mean \"load\"?"],
    );
    says(
        "friction = 0.1",
        "friction = 0.1\nmu = 0.1",
        "mu = 0.1",
        &["did you mean \"friction\"?"],
    );
    says(
        "increments = 20",
        "increments = 20\nincrement = 3",
        "increment = 3",
        &["unknown key"],
    );
    says(
        "[[tool]]",
        "[[tols]]\na = 1\n[[tool]]",
        "[[tols]]",
        &["did you mean \"tool\"?"],
    );
}

/// A misspelt key that must be there is one mistake, not an unknown key and a missing one.
#[test]
fn a_misspelt_key_is_told_once() {
    let place = "\"poisson\" is missing here";
    says("poisson", "poison", "poison", &[place]);
    let out = shown("poisson", "poison");
    assert!(
        out.matches("error: ").count() == 1 && !out.contains("has no key"),
        "{out}"
    );
    let out = shown("poisson = 0.3", "poison = 0.3\npoissson = 0.3");
    assert!(
        out.matches("error: ").count() == 2 && !out.contains("has no key"),
        "{out}"
    );
    // What is near to another key is missing all the same.
    let out = shown("poisson = 0.3", "yuong = 0.3");
    assert!(
        out.contains("has no key \"poisson\"") && out.contains("unknown key \"yuong\""),
        "{out}"
    );
}

/// What was given and what holds, not that it is a table; where a surface is, not that nothing is found.
#[test]
fn numbers_that_do_not_fit_each_other_are_told() {
    says(
        "increments = 20",
        "increments = { start = 0.5, min = 1.0, max = 0.1 }",
        "increments =",
        &[
            "start with 0.5 of the step, are at least 1 and at most 0.1",
            "0 < min ≤ start ≤ max ≤ 1",
        ],
    );
    says(
        "x = [0, 25]",
        "x = [60, 75]",
        "[[mesh.group]]",
        &["no node of \"block.top\"", "x = [0, 50], y = [20, 20]"],
    );
}

#[test]
fn names_that_do_not_exist_name_the_nearest() {
    says(
        "on = \"punch\"",
        "on = \"puncg\"",
        "puncg",
        &["no group \"puncg\"", "\"punch\"?"],
    );
    says(
        "\"block.bottom\"",
        "\"block.botom\"",
        "botom",
        &["did you mean \"block.bottom\"?"],
    );
    says(
        "against = \"foundation\"",
        "against = \"fundation\"",
        "fundation",
        &["no tool \"fundation\"; did you mean \"foundation\"?"],
    );
    says(
        "on = \"block\"",
        "on = \"blok\"",
        "blok",
        &["did you mean \"block\"?"],
    );
    says(
        "on = \"block\"",
        "on = \"punch\"",
        "on = \"punch\"",
        &["holds facets", "a body"],
    );
    // Shared by the nodes of a body a force would depend on the size of its cells.
    let load = |on: &str| format!("increments = 20\nload = [{{ on = \"{on}\", force = [0, -9] }}]");
    says(
        "increments = 20",
        &load("block"),
        "force = [0, -9]",
        &[
            "\"block\" holds cells, expected a group of facets",
            "`body-force`",
        ],
    );
    for on in ["punch", "block.right"] {
        let out = shown("increments = 20", &load(on));
        assert!(!out.contains("holds"), "{out}");
    }
    says(
        "\"force.punch.y\"",
        "\"force.pnch.y\"",
        "pnch",
        &["did you mean \"force.punch.y\"?"],
    );
}

/// Keys that are asked for in several places are listed once.
#[test]
fn the_keys_of_a_table_are_listed_once() {
    let out = shown("poisson = 0.3", "poisson = 0.3\npossion = 0.3");
    assert!(out.contains("did you mean \"poisson\"?"), "{out}");
    assert_eq!(out.matches("kinematic").count(), 1, "{out}");
}

/// Symbols of formulas, and keys that are nothing like any.
#[test]
fn symbols_are_known_and_strangers_suggest_nothing() {
    for (from, to, meant) in [
        ("young =", "E =", "did you mean \"young\"?"),
        ("poisson =", "nu =", "did you mean \"poisson\"?"),
        (
            "friction = 0.1",
            "friction = { mu = 0.1 }",
            "did you mean \"coulomb\"?",
        ),
    ] {
        says(from, to, to, &[meant]);
    }
    let out = shown("young =", "wwww = 1\nyoung =");
    assert!(
        out.contains("unknown key") && !out.contains("did you mean"),
        "{out}"
    );
}

/// Two brackets are forgotten easily; the table is read all the same.
#[test]
fn one_table_for_a_list_is_one_mistake() {
    for header in ["tool", "contact", "step", "material", "mesh.block"] {
        let text = DECK.replace(&format!("[[{header}]]"), &format!("[{header}]"));
        assert!(text.len() < DECK.len(), "{header}");
        let (_, problem, findings) = open(&text);
        let out = findings.render("deck.toml", &text, false);
        assert!(problem.is_none() && findings.errors() == 1, "{out}");
        assert!(
            out.contains(&format!("[[{header}]] with two brackets")),
            "{out}"
        );
    }
}

#[test]
fn what_is_no_toml_is_told_in_words_of_the_deck() {
    says(
        "friction = 0.1",
        "friction = 0.1\nfriction = 0.2",
        "friction = 0.2",
        &["the key \"friction\" stands twice in one table"],
    );
    says("0.3", "0,3", "0,3", &["decimals have a point"]);
    says(
        "young = 210000.0",
        "young 210000.0",
        "young 2",
        &["not TOML: "],
    );
}

/// Coulomb's coefficient is the tangent of the angle that is meant.
#[test]
fn an_angle_of_friction_is_told_as_that() {
    says(
        "friction = 0.1",
        "friction = { angle = 10 }",
        "{ angle = 10 }",
        &["friction has an angle, expected coulomb, the tangent of that"],
    );
}
