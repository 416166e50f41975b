//! What is said about a deck that is wrong or doubtful, and that nothing said about it is a panic.

use moreau::deck::{Problem, open};

const DECK: &str = include_str!("../../../docs/examples/punched-block.toml");

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
    assert!((setup.volumes[0] - 1000.0).abs() < 1e-9);
    let punch = setup
        .groups
        .iter()
        .find(|g| g.name == "punch")
        .expect("punch");
    assert_eq!((punch.kind, punch.members, punch.nodes), ("facets", 5, 11));
    assert!((punch.measure.expect("an area") - 25.0).abs() < 1e-9);
    assert_eq!(deck.quadrature(&deck.materials[0]), "reduced");
}

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

#[test]
fn values_out_of_their_range_are_pointed_at() {
    says(
        "0.3",
        "0.5",
        "0.5",
        &["Poisson's ratio must lie in ]-1, 0.5[", "got 0.5"],
    );
    says("210000.0", "-1.0", "-1.0", &["Young", "must be positive"]);
    says(
        "300.0",
        "0",
        "yield-stress = 0",
        &["yield stress must be positive"],
    );
    says(
        "friction = 0.1",
        "friction = -0.1",
        "-0.1",
        &["non-negative"],
    );
    says(
        "normal = [0, 1]",
        "normal = [0, 0]",
        "normal",
        &["length of the plane's normal"],
    );
    says(
        "x = [0, 50]",
        "x = [50, 0]",
        "[50, 0]",
        &["expected [from, to] with from < to"],
    );
    says(
        "cells = [10, 2]",
        "cells = [10, 0]",
        "[10, 0]",
        &["0 cells along y"],
    );
    says(
        "cells = [10, 2]",
        "cells = [99999, 9999]",
        "[[mesh",
        &["cells, expected at most"],
    );
    says(
        "increments = 20",
        "increments = 0",
        "increments = 0",
        &["an integer from 1"],
    );
    says(
        "analysis",
        "thickness = -2.0\nanalysis",
        "thickness",
        &["must be positive"],
    );
    says("y = -0.2", "y = nan", "nan", &["a finite number"]);
    says(
        "friction = 0.1",
        "friction = \"0.1\"",
        "friction = \"",
        &["the text", "expected a number"],
    );
    says(
        "normal = [0, 1]",
        "normal = [0, 1, 0]",
        "normal",
        &["expected 2 numbers"],
    );
}

#[test]
fn groups_that_are_empty_twice_or_unused_are_found() {
    says(
        "x = [0, 25]",
        "x = [60, 70]",
        "[[mesh.group]]",
        &["the group \"punch\" is empty"],
    );
    says(
        "name = \"punch\"",
        "name = \"block.top\"",
        "name = \"block.top\"",
        &["exists already"],
    );
    says(
        "[[material]]",
        "[[mesh.group]]\nname = \"idle\"\non = \"block\"\nx = [0, 25]\n[[material]]",
        "\"idle\"",
        &["no condition uses the group \"idle\""],
    );
    let half = "[[mesh.group]]\nname = \"half\"\non = \"block\"\nx = [0, 25]\n\n[[material]]\non = \"half\"";
    says(
        "[[material]]\non = \"block\"",
        half,
        "name = \"block\"",
        &["cells have no material"],
    );
    // 27.5 is the middle of an edge.
    says(
        "x = [0, 25]",
        "x = [0, 28]",
        "[[mesh.group]]",
        &["cut through the mesh", "(11 nodes)", "(12)"],
    );
}

#[test]
fn what_is_doubtful_is_a_warning() {
    says(
        "friction = 0.1",
        "friction = 0",
        "friction = 0",
        &["frictionless"],
    );
    says(
        "y = -0.2",
        "y = 0",
        "name = \"press\"",
        &["nothing loads the model"],
    );
    says("quad8", "quad4", "yield-stress", &["locks in plastic flow"]);
    says(
        "[expect]",
        "[output]\ncheckpoint = 5\n[expect]",
        "checkpoint",
        &["not available yet"],
    );
    let twice = "[[tool]]\nname = \"idle\"\nplane = { point = [0, 9], normal = [0, 1] }\n[[tool]]";
    says(
        "[[tool]]",
        twice,
        "\"idle\"",
        &["no [[contact]] uses the tool \"idle\""],
    );
}

#[test]
fn rigid_motions_that_are_free_are_named() {
    let fix = "fix = [{ on = \"block.left\", u = [\"x\"] }]";
    let text = DECK
        .replace("friction = 0.1", "friction = 0")
        .replace(fix, "");
    let (_, problem, findings) = open(&text);
    let out = findings.render("deck.toml", &text, false);
    assert!(problem.is_none() && out.contains("deck.toml:35:8"), "{out}");
    let flat = flat(&out);
    for word in ["body \"block\"", "free to move", "translation along x"] {
        assert!(flat.contains(word), "{word} in {out}");
    }
}

#[test]
fn one_displacement_is_prescribed_once() {
    says(
        "u = [\"x\"]",
        "u = [\"y\"]",
        "[[step]]",
        &["prescribes u_y", "as 0 and as -0.2"],
    );
}

#[test]
fn what_is_not_available_is_refused_by_name() {
    for (from, to, name) in [
        ("0.3", "0.3\nquadrature = \"b-bar\"", "b-bar"),
        ("300.0", "300.0\nhardening = { voce = [1, 2] }", "voce"),
        (
            "300.0",
            "300.0\nkinematic = [{ modulus = 1, recall = 2 }]",
            "recall",
        ),
        ("friction = 0.1", "friction = { tresca = 5.0 }", "tresca"),
        (
            "friction = 0.1",
            "friction = { coulomb = 0.1, tau-max = 5.0 }",
            "tau-max",
        ),
        (
            "friction = 0.1",
            "friction = 0.1\ngap-offset = 0.1",
            "gap-offset",
        ),
        (
            "plane = { point = [0, 0], normal = [0, 1] }",
            "polyline = [[0, 0], [1, 0]]",
            "polyline",
        ),
        (
            "[expect]",
            "[solver]\ncontact = { penetration = 1e-4 }\n[expect]",
            "penetration",
        ),
        (
            "[expect]",
            "[[step]]\nname=\"b\"\nincrements=1\ntools=[{name=\"foundation\",force=[0,1]}]\n[expect]",
            "driven by a force",
        ),
        (
            "[[mesh.block]]",
            "[mesh]\nfile = \"a.msh\"\n[[mesh.block]]",
            "mesh files",
        ),
    ] {
        let out = shown(from, to);
        assert!(
            out.contains("not available yet") && out.contains(name),
            "{name}: {out}"
        );
    }
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
    assert!(problem.is_none() && findings.errors() == 5, "{out}");
    for word in ["0.7", "frixion", "pinch", "botom"] {
        assert!(out.contains(word), "{word} in {out}");
    }
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

#[test]
fn a_resolved_deck_is_the_same_deck() {
    for text in [
        DECK,
        include_str!("../../../docs/examples/indentation-flat-punch.toml"),
        include_str!("../../../docs/examples/block-dragged-on-block.toml"),
        include_str!("../../../docs/examples/block-opening-sliding-sticking.toml"),
        include_str!("../../../docs/examples/cylinder-pressed-into-block.toml"),
    ] {
        let once = open(text).0.resolved();
        let (deck, problem, findings) = open(&once);
        assert!(
            problem.is_some(),
            "{}",
            findings.render("resolved", &once, false)
        );
        assert_eq!(deck.resolved(), once);
    }
}

/// Numbers from a seed: Knuth's linear congruence.
struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// Words, numbers, blanks and signs of a text, each by itself.
fn tokens(text: &str) -> Vec<String> {
    let word = |c: char| c.is_alphanumeric() || "-_.".contains(c);
    let mut list: Vec<String> = Vec::new();
    for c in text.chars() {
        match list.last_mut() {
            Some(last) if word(c) && last.chars().all(word) => last.push(c),
            _ => list.push(c.into()),
        }
    }
    list
}

#[test]
fn mutated_decks_never_panic() {
    let whole = tokens(DECK);
    let mut dice = Dice(7);
    let (mut wrong, mut right) = (0, 0);
    for _ in 0..600 {
        let mut list = whole.clone();
        for _ in 0..=dice.below(3) {
            let (a, b) = (dice.below(list.len()), dice.below(list.len()));
            match dice.below(4) {
                0 => drop(list.remove(a)),
                1 => list.insert(a, list[a].clone()),
                2 => list.swap(a, b),
                _ => list[a] = list[b].clone(),
            }
        }
        let text = list.concat();
        let (deck, problem, findings) = open(&text);
        let shown = findings.render("deck.toml", &text, false);
        if problem.is_none() {
            assert!(
                findings.errors() > 0 && shown.contains("deck.toml:"),
                "{text}\n{shown}"
            );
            wrong += 1;
        } else {
            assert!(
                open(&deck.resolved()).1.is_some(),
                "{text}\n{}",
                deck.resolved()
            );
            right += 1;
        }
    }
    assert!(wrong > 200 && right > 50, "{wrong} wrong, {right} right");
}
