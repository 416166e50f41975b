//! Supports and motions along a direction.

use super::{DECK, flat, says, shown};
use moreau::deck::{Action, open};

const FIX: &str = "u = [\"x\"] }";
const MOVE: &str = "u = { y = -0.2 } }";

#[test]
fn a_direction_is_read_and_echoed() {
    let text =
        DECK.replacen(FIX, "along = [3, 4] }", 1)
            .replacen(MOVE, "along = [0, -2], u = 0.2 }", 1);
    let (deck, problem, findings) = open(&text);
    assert!(
        problem.is_some(),
        "{}",
        findings.render("deck.toml", &text, false)
    );
    let actions: Vec<&Action> = deck.steps[0].conditions.iter().map(|c| &c.action).collect();
    assert_eq!(actions[0], &Action::FixAlong(vec![3.0, 4.0]));
    assert_eq!(actions[1], &Action::MoveAlong(vec![0.0, -2.0], 0.2));
    let echo = deck.resolved();
    assert!(echo.contains("along = [3.0, 4.0] }"), "{echo}");
    let (again, _, _) = open(&echo);
    let again: Vec<&Action> = again.steps[0]
        .conditions
        .iter()
        .map(|c| &c.action)
        .collect();
    assert_eq!(again, actions);
}

#[test]
fn what_is_no_direction_is_pointed_at() {
    for (along, words) in [
        ("along = [0, 0] }", "a direction, with a length"),
        ("along = [1, 2, 3] }", "2 numbers"),
        ("along = 1 }", "2 numbers"),
        ("along = [nan, 1] }", "number"),
        ("along = [0.6, 0.8], u = [\"x\"] }", "u or along, not both"),
        ("alog = [0.6, 0.8] }", "along"),
    ] {
        says(FIX, along, "on = \"block.left\"", &[words]);
    }
    for (moved, words) in [
        ("along = [0.6, 0.8] }", "\"u\""),
        ("along = [0.6, 0.8], u = { y = 1 } }", "a number"),
        ("u = 0.1 }", "a number beside along"),
        ("along = [0, 0], u = 0.1 }", "with a length"),
    ] {
        says(MOVE, moved, "on = \"punch\"", &[words]);
    }
}

#[test]
fn what_contradicts_is_told_with_the_groups() {
    let out = flat(&shown(
        MOVE,
        "along = [1, 1], u = -0.2 }, { on = \"block.left\", u = { y = 0.1 } }",
    ));
    for word in [
        "along (0.707106781187, 0.707106781187)",
        "\"block.left\" and \"punch\"",
        "remove one",
    ] {
        assert!(out.contains(word), "{word} in {out}");
    }
}

#[test]
fn a_body_held_along_one_direction_is_free_in_the_others() {
    let text =
        DECK.replacen(FIX, "along = [0.6, 0.8] }", 1)
            .replacen("friction = 0.1", "friction = 0", 1);
    let (_, problem, findings) = open(&text);
    // The punch holds y, and both together x.
    assert!(
        problem.is_some(),
        "{}",
        findings.render("deck.toml", &text, false)
    );
    let alone = text.replacen(MOVE, "along = [3, 4], u = 0.1 }", 1);
    let (_, problem, findings) = open(&alone);
    let out = flat(&findings.render("deck.toml", &alone, false));
    assert!(problem.is_none() || !out.contains("free"), "{out}");
}
