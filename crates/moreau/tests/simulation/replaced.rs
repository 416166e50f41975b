//! Steps that are replaced under way.

use super::{DECK, advance, bits, finish, simulation};

const RELEASE: &str =
    "name = \"release\"\nincrements = 4\nfix = [{ on = \"block.left\", u = [\"x\"] }]";

/// Pressed by half and released: as a deck that says so.
#[test]
fn a_step_that_replaces_what_is_left_goes_on_from_there() {
    let mut reacting = simulation(DECK);
    (0..10).for_each(|_| assert!(advance(&mut reacting)));
    let findings = reacting.replace_step(RELEASE).expect("a step");
    assert_eq!(findings.errors(), 0);
    let reacting = finish(reacting);
    let head = DECK.split("[expect]").next().expect("a deck");
    let half = head
        .replace("increments = 20", "increments = 10")
        .replace("-0.2", "-0.1");
    let said = finish(simulation(&format!("{half}\n[[step]]\n{RELEASE}\n")));
    let (found, expected) = (reacting.displacements(), said.displacements());
    let size = expected.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
    for (u, v) in found.iter().zip(expected) {
        assert!((u - v).abs() < 1e-10 * size, "{u} {v}");
    }
    let history = reacting.history();
    assert_eq!(history.rows(), 14);
    assert_eq!(history.numbers("step")[9..11], [1.0, 2.0]);
    // Of the release there is a certificate too.
    assert!(reacting.outcome().relative_gap < 1e-10);
}

/// Groups that only the new step holds have columns of their own; after the end there may be more steps.
#[test]
fn a_step_after_the_end_may_hold_other_groups() {
    let mut more = finish(simulation(DECK));
    let top = RELEASE
        .replace("block.left", "block.right")
        .replace("4", "1");
    more.replace_step(&top).expect("a step");
    let more = finish(more);
    let force = more.history().numbers("force.block.right.x");
    assert_eq!(force.len(), 21);
    assert!(force[19].is_nan() && force[20].is_finite(), "{force:?}");
}

/// What is said of steps that no longer come is no error.
#[test]
fn expectations_of_the_end_that_is_given_up_go_with_it() {
    let (head, _) = DECK.split_once("[expect]").expect("two parts");
    let later = RELEASE.replace("block.left", "block.right");
    let expect = "[expect]\n\"force.block.right.x\" = { value = 0.0, absolute = 1.0 }\n";
    let mut pressed = simulation(&format!("{head}\n[[step]]\n{later}\n{expect}"));
    assert!(advance(&mut pressed));
    pressed.replace_step(RELEASE).expect("a step");
    let released = finish(pressed);
    assert!(released.outcome().verdicts.is_empty());
    assert!(released.history().column("force.block.right.x").is_none());
    assert_eq!(released.history().rows(), 5);
}

#[test]
fn a_step_that_is_wrong_is_shown_and_changes_nothing() {
    let mut pressed = simulation(DECK);
    assert!(advance(&mut pressed));
    let before = bits(&pressed);
    let wrong = RELEASE.replace("block.left", "block.lift");
    let refused = pressed
        .replace_step(&wrong)
        .expect_err("no such group")
        .to_string();
    assert!(
        refused.contains("did you mean \"block.left\"?"),
        "{refused}"
    );
    assert!(
        refused.contains("fix = [{ on = \"block.lift\""),
        "{refused}"
    );
    assert_eq!(bits(&pressed), before);
    let whole = finish(simulation(DECK));
    assert_eq!(bits(&finish(pressed)), bits(&whole));
}
