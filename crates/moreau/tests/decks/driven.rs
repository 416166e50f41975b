//! Tools that forces drive in some steps and that others move.

use super::flat;
use moreau::deck::open;

/// What is said of a die in steps.
fn said(steps: &[&str]) -> String {
    let mut deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 10], y = [0, 4], cells = [2, 2] }]
material = [{ on = "b", young = 2e5, poisson = 0.3 }]
tool = [{ name = "die", plane = { point = [0, 4], normal = [0, -1] } }]
contact = [{ surface = "b.top", against = "die", friction = 0.1 }]
"#
    .to_owned();
    for (k, told) in steps.iter().enumerate() {
        let tools = match told.is_empty() {
            true => String::new(),
            false => format!("tools = [{{ name = \"die\", {told} }}]\n"),
        };
        deck += &format!(
            "[[step]]\nname = \"s{k}\"\nincrements = 1\nfix = [{{ on = \"b.bottom\", u = [\"x\", \"y\"] }}]\n{tools}"
        );
    }
    let (_, problem, findings) = open(&deck);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    flat(&findings.render("deck.toml", &deck, false))
}

/// A force is not kept by a step that takes its tool back along it; that of a tool that is not named goes on.
#[test]
fn a_tool_that_is_taken_back_from_under_its_force_is_told() {
    for steps in [
        &["force = [0, -1000]", "move = [0.02, 0]"][..],
        &["force = [0, -1000]", "", "move = [0.02, 0]"],
        &[
            "move = [0.01, 0]",
            "force = [0, -1000]",
            "move = [0.02, 0], turn = 0.1",
        ],
    ] {
        let said = said(steps);
        for word in [
            "takes \"die\" back to 0 along y",
            "force = [0, -1000] keeps it, zeros let go of it",
            "#warnings",
        ] {
            assert!(said.contains(word), "{word:?} of {steps:?} in {said}");
        }
    }
}

#[test]
fn a_tool_that_is_let_go_on_purpose_is_not_told() {
    for steps in [
        &["force = [0, -1000]", "force = [0, -1000], move = [0.02, 0]"][..],
        &["force = [0, -1000]", "force = [0, 0], move = [0.02, 0]"],
        // To the other direction, and home.
        &["force = [0, -1000]", "move = [0.02, 0.5]"],
        &["force = [0, -1000]", "move = [0, 0]"],
        &["force = [0, -1000]", "turn = 0.1"],
        // It is gone before.
        &[
            "force = [0, -1000], table = [[0, 0], [0.5, 1], [1, 0]]",
            "move = [0.02, 0]",
        ],
        &["force = [0, -1000]", "move = [0, 0.5]", "move = [0.02, 0]"],
    ] {
        assert_eq!(said(steps), "", "{steps:?}");
    }
}

/// It would not move: the force that another step has along x would be zero here.
#[test]
fn a_motion_along_an_axis_of_a_force_is_refused() {
    let steps = ["force = [0, -1000], move = [0.05, 0]", "force = [5, -1000]"];
    let told = said(&steps);
    for word in [
        "a motion of \"die\" along x",
        "another step",
        "deck.toml:12",
    ] {
        assert!(told.contains(word), "{word:?} in {told}");
    }
    assert_eq!(said(&["move = [0.05, 0]", "force = [5, -1000]"]), "");
}
