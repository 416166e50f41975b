//! Keys and names that do not exist.

use super::{says, shown};

#[test]
fn unknown_keys_and_values_name_the_nearest() {
    says(
        "poisson",
        "poison",
        "poison",
        &["unknown key \"poison\"", "did you mean \"poisson\"?"],
    );
    says(
        "poisson",
        "poison",
        "[[material]]",
        &["has no key \"poisson\""],
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
