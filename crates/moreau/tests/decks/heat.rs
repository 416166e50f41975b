//! Temperatures and expansions of decks: formulas of the position, and what is wrong with them.

use super::{DECK, open, says, shown};
use moreau::deck::{Action, FieldEntry, Problem};

const MOVE: &str = "move = [{ on = \"punch\", u = { y = -0.2 } }]";
const YIELD: &str = "yield-stress = 300.0";

/// The example with a load.
fn load(text: &str) -> String {
    let with = DECK.replace(YIELD, "yield-stress = 300.0\nexpansion = 1.2e-5");
    with.replace(MOVE, &format!("{MOVE}\nload = [{{ {text} }}]"))
}

#[test]
fn a_formula_of_the_position_is_evaluated_there() {
    let text = load("on = \"block\", temperature = \"= t * (1 - x / 50) + y * 2\"");
    let text = format!("{text}\n[parameters]\nt = \"= 2 * 50\"\n");
    let (deck, problem, findings) = open(&text);
    assert_eq!((findings.errors(), findings.warnings()), (0, 0));
    let action =
        |deck: &moreau::deck::Deck| match &deck.steps[0].conditions.last().expect("one").action {
            Action::Temperature(field) => field.clone(),
            other => panic!("{other:?}"),
        };
    let field = action(&deck);
    assert_eq!(field.at(&[10.0, 3.0]), 86.0);
    // Written out again it needs no parameters.
    let resolved = deck.resolved();
    let (again, _, findings) = open(&resolved);
    assert_eq!(findings.errors(), 0, "{resolved}");
    assert_eq!(action(&again).at(&[10.0, 3.0]), 86.0);
    assert_eq!(again.resolved(), resolved);
    assert_eq!(
        again.materials[0].expansion.as_ref().map(|e| e.value),
        Some(1.2e-5)
    );

    let Some(Problem::Plane(setup)) = problem else {
        panic!("a plane problem")
    };
    let loading = setup.driver.loading(&setup.stages[0].step).expect("valid");
    let points = setup.driver.points();
    assert_eq!(loading.temperature.values().len(), points.len());
    for (point, found) in points.iter().zip(loading.temperature.values()) {
        let [x, y] = point.position;
        assert!((found - 100.0 * (1.0 - x / 50.0) - 2.0 * y).abs() < 1e-12);
    }
    // A formula of parameters alone is a number.
    let number = load("on = \"block\", temperature = \"= 2 * 50\"");
    assert_eq!(action(&open(&number).0), FieldEntry::Constant(100.0));
}

#[test]
fn what_is_wrong_with_temperatures_is_told() {
    let with = |load: &str| format!("{MOVE}\nload = [{load}]");
    for (load, words) in [
        (
            "{ on = \"block\", temperature = \"= z\" }",
            ["no parameter is called \"z\"", "not in [parameters]"],
        ),
        (
            "{ on = \"block\", temperature = \"= 2 x\" }",
            ["a formula with \"x\"", "an operator or the end"],
        ),
        (
            "{ on = \"block.top\", temperature = 10 }",
            ["block.top", "cells"],
        ),
        (
            "{ on = \"block\", temperature = \"= 1 / (x - x)\" }",
            ["temperature of cell 0", "expected a finite number"],
        ),
        (
            "{ on = \"block\", temperature = 1 }, { on = \"block\", temperature = 2 }",
            ["has a temperature already", "groups must not overlap"],
        ),
    ] {
        let out = super::flat(&shown(MOVE, &with(load)));
        for word in words {
            assert!(out.contains(word), "{load}: {word:?} in {out}");
        }
    }
    let twice = load("on = \"block\", temperature = \"= x\"") + "\n[parameters]\nx = 1\n";
    let (_, _, findings) = open(&twice);
    let out = super::flat(&findings.render("deck.toml", &twice, false));
    assert!(out.contains("a parameter is called \"x\""), "{out}");
}

/// A load factor is that of loads alone: what heats beside them is refused, and what stays as warm as it was is not.
#[test]
fn a_step_to_collapse_holds_the_temperature() {
    let until =
        |text: &str| text.replace("increments = 20", "increments = 20\nuntil = \"collapse\"");
    let said = |text: &str| {
        let (_, _, findings) = open(text);
        super::flat(&findings.render("deck.toml", text, false))
    };
    let at_once = said(&until(&load("on = \"block\", temperature = 10")));
    for word in [
        "the temperature of \"block\" changes from 0 to 10 K in a step with until",
        "a step before this one that brings it there",
    ] {
        assert!(at_once.contains(word), "{word} in {at_once}");
    }
    let after = |first: &str, last: &str| {
        let fix =
            "fix = [{ on = \"block.bottom\", u = [\"y\"] }, { on = \"block.left\", u = [\"x\"] }]";
        let (head, _) = DECK.split_once("[[step]]").expect("steps");
        let head = head.replace(YIELD, "yield-stress = 300.0\nexpansion = 1.2e-5");
        let step = |name: &str, load: &str, more: &str| {
            format!("[[step]]\nname = \"{name}\"\nincrements = 2\n{more}\n{fix}\nload = [{load}]\n")
        };
        let push = "{ on = \"block.top\", pressure = 1000.0 }";
        let last = format!("{push}{last}");
        let mut text = format!("{head}{}", step("warm", first, ""));
        text += &step("press", &last, "until = \"collapse\"");
        said(&text)
    };
    let warm = "{ on = \"block\", temperature = \"= 2 * x\" }";
    let held = after(warm, &format!(", {warm}"));
    assert!(!held.contains("until"), "{held}");
    let other = after(warm, ", { on = \"block\", temperature = \"= 2.1 * x\" }");
    assert!(
        other.contains("the temperature of \"block\" changes from"),
        "{other}"
    );
    let released = after(warm, "");
    for word in [
        "takes \"block\" back to where it was free of stress",
        "or a step before this one",
    ] {
        assert!(released.contains(word), "{word} in {released}");
    }
}

#[test]
fn heat_that_does_nothing_is_doubtful() {
    let expansion = "yield-stress = 300.0\nexpansion = 1.2e-5";
    let nothing = ["no step gives it a temperature"];
    says(YIELD, expansion, "expansion", &nothing);
    let heated = format!("{MOVE}\nload = [{{ on = \"block\", temperature = 10 }}]");
    let nothing = ["no material there has an expansion"];
    says(MOVE, &heated, "temperature", &nothing);
    // Heat alone is a load.
    let alone = load("on = \"block\", temperature = 10").replace(MOVE, "");
    let (_, _, findings) = open(&alone);
    let mut doubts = findings.iter().map(|f| f.message.as_str());
    assert!(!doubts.any(|m| m.contains("nothing loads")));
}
