//! Tables over the time of a step.

use super::{DECK, folder, says, shown};
use moreau::deck::{Given, open, open_in};
use moreau::simulation::Simulation;
use std::ops::ControlFlow;

/// What the punch does in the example.
const MOVE: &str = "u = { y = -0.2 } }";

fn with(table: &str) -> String {
    MOVE.replace(" } }", &format!(" }}, table = {table} }}"))
}

#[test]
fn rows_that_make_no_table_are_pointed_at() {
    for table in [
        "[]",
        "[[0, 1]]",
        "[[0.1, 0], [1, 1]]",
        "[[0, 0], [0.9, 1]]",
        "[[0, 0], [0.6, 1], [0.4, 0.5], [1, 1]]",
        "[[0, 0], [0.5, 1], [0.5, 0], [1, 1]]",
    ] {
        says(
            MOVE,
            &with(table),
            "table =",
            &["times of the table", "rise from 0 to 1"],
        );
    }
    for (table, words) in [
        ("1", "rows of time and share"),
        ("[0, 1]", "2 numbers"),
        ("[[0, 0, 0], [1, 1]]", "2 numbers"),
        ("[[0, 0], [1, nan]]", "number"),
    ] {
        says(MOVE, &with(table), "table =", &[words]);
    }
    // What is fixed has no value to vary.
    let fixed = "on = \"block.left\", u = [\"x\"]";
    let varied = format!("{fixed}, table = [[0, 0], [1, 1]]");
    says(fixed, &varied, "table =", &["unknown key \"table\""]);
}

#[test]
fn what_would_jump_is_pointed_at_with_the_row_that_does_not() {
    let words = [
        "the displacement of \"punch\" would jump from 0 to -0.1",
        "[0, 0] as the first row",
    ];
    says(MOVE, &with("[[0, 0.5], [1, 1]]"), "table =", &words);
    let more = |kind: &str, table: &str| {
        let second = format!(
            "\n[[step]]\nname = \"more\"\nincrements = 2\nfix = [{{ on = \"block.left\", u = [\"x\"] }}]\n{kind}, table = {table} }}]\n\n[expect]"
        );
        shown("\n[expect]", &second)
    };
    let shift = "move = [{ on = \"punch\", u = { y = -0.4 }";
    assert!(more(shift, "[[0, 0], [1, 1]]").contains("[0, 0.5] as the first row"));
    assert_eq!(more(shift, "[[0, 0.5], [1, 1]]"), "");
    // A load that was not there starts at nothing.
    let load = "load = [{ on = \"block.top\", pressure = 10.0";
    assert!(
        more(load, "[[0, 1], [1, 1]]")
            .contains("the pressure of \"block.top\" would jump from 0 to 10")
    );
    assert_eq!(more(load, "[[0, 0], [0.5, 1], [1, 0.5]]"), "");
}

/// Loads of one kind on one group act together: what a table varies begins at nothing beside what goes on.
#[test]
fn a_load_that_varies_beside_one_that_stays_jumps_from_nothing() {
    let more = |loads: &str| {
        let second = format!(
            "load = [{{ on = \"block.top\", pressure = 5.0 }}]\n\n[[step]]\nname = \"more\"\nincrements = 2\nfix = [{{ on = \"block.left\", u = [\"x\"] }}]\nmove = [{{ on = \"punch\", u = {{ y = -0.2 }} }}]\nload = [{loads}]\n\n[expect]"
        );
        shown("\n[expect]", &second)
    };
    let stays = "{ on = \"block.top\", pressure = 5.0 }";
    let varies = |first: f64| {
        format!(
            "{{ on = \"block.top\", pressure = 2.0, table = [[0, {first}], [0.5, 1], [1, 0]] }}"
        )
    };
    assert_eq!(more(&format!("{stays}, {}", varies(0.0))), "");
    assert_eq!(more(&format!("{}, {}", varies(0.5), varies(2.0))), "");
    let jumps = more(&format!("{}, {}", varies(0.5), varies(0.5)));
    assert!(
        jumps.contains("would jump from 5 to 2") && jumps.contains("[0, 2]"),
        "{jumps}"
    );
}

#[test]
fn a_step_without_end_has_no_table() {
    let text = include_str!("../../../../docs/examples/cylinder-to-collapse.toml");
    let until = text.replacen("pressure = ", "table = [[0, 0], [1, 1]], pressure = ", 1);
    assert_ne!(until, text);
    let (_, problem, findings) = open(&until);
    let said = findings.render("deck.toml", &until, false);
    assert!(
        problem.is_none() && said.contains("until = \"collapse\""),
        "{said}"
    );
}

/// The force that a block stands on is what the rows of its pressure say, at the end of every increment.
#[test]
fn a_table_is_followed() {
    let deck = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad4", x = [0, 2], y = [0, 1], cells = [2, 1] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
[[step]]
name = "press"
increments = 4
fix = [{ on = "b.bottom", u = ["y"] }, { on = "b.left", u = ["x"] }]
load = [{ on = "b.top", pressure = 3.0, table = [[0, 0], [0.5, 2], [1, -1]] }]
"#;
    let (simulation, findings) = Simulation::open(deck, ".".as_ref(), &Given::default());
    let shown = || findings.render("deck.toml", deck, false);
    let mut simulation = simulation.unwrap_or_else(|| panic!("{}", shown()));
    let mut advance = || simulation.advance(&mut |_, _| ControlFlow::Continue(()));
    while advance().expect("an increment").is_some() {}
    let forces = simulation.history().numbers("force.b.bottom.y");
    let last = &forces[forces.len() - 4..];
    for (found, share) in last.iter().zip([1.0, 2.0, 0.5, -1.0]) {
        assert!((found - 6.0 * share).abs() < 1e-9, "{forces:?}");
    }
}

/// A deck that is written out is the deck again, where a table varies what has a table of its own.
#[test]
fn a_motion_with_a_table_is_written_out_whole() {
    let text = DECK.replacen(MOVE, &with("[[0, 0], [0.5, 1], [1, 0.5]]"), 1);
    let (deck, problem, findings) = open_in(&text, &folder("docs/examples"));
    assert!(
        problem.is_some(),
        "{}",
        findings.render("deck.toml", &text, false)
    );
    let once = deck.resolved();
    assert!(
        once.contains("table = [[0.0, 0.0], [0.5, 1.0], [1.0, 0.5]] }"),
        "{once}"
    );
    let (again, problem, findings) = open_in(&once, &folder("docs/examples"));
    assert!(
        problem.is_some(),
        "{}",
        findings.render("deck.toml", &once, false)
    );
    assert_eq!(again.resolved(), once);
}

/// Two steps on a block under a tool: what is said of them.
fn steps(first: &str, second: &str) -> String {
    let sides = "fix = [{ on = \"b.bottom\", u = [\"y\"] }, { on = \"b.left\", u = [\"x\"] }]";
    let deck = format!(
        r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{{ name = "b", element = "quad8", x = [0, 10], y = [0, 10], cells = [2, 2] }}]
mesh.group = [{{ name = "part", on = "b.right", y = [5, 10] }}]
material = [{{ on = "b", young = 2e5, poisson = 0.3 }}]
tool = [{{ name = "t", plane = {{ point = [0, 10], normal = [0, -1] }} }}]
contact = [{{ surface = "b.top", against = "t", friction = 0.1 }}]
[[step]]
name = "a"
increments = 1
{sides}
{first}
[[step]]
name = "b"
increments = 4
{sides}
{second}
"#
    );
    let (_, problem, findings) = open(&deck);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    super::flat(&findings.render("deck.toml", &deck, false))
}

/// What a support or a motion takes is known in the run only: beneath a table it would go off in proportion.
#[test]
fn a_table_on_what_the_step_before_held_or_left_free_is_refused() {
    let there = "table = [[0, 0], [0.5, 1], [1, 0]]";
    let tool = |what: &str| format!("tools = [{{ name = \"t\", {what} }}]");
    let load = |what: &str| format!("load = [{{ on = \"b.right\", {what} }}]");
    let pull = "move = [{ on = \"b.right\", u = { x = 0.01 } }]";
    let moved = tool("move = [0, -0.005]");
    let pushed = tool("force = [0, -100]");
    let turned = tool("turn = 0.1");
    let varied = |what: &str| format!("{what}, {there}");
    let held = "the step before holds or moves it along";
    let free = "the step before leaves it free";
    for (first, second, words) in [
        (&moved, tool(&varied("force = [0, -20]")), held),
        // Not named, it stays where it is.
        (&"".to_owned(), tool(&varied("force = [0, -20]")), "along y"),
        (&turned, tool(&varied("moment = 5")), "holds or turns it"),
        (&pull.to_owned(), load(&varied("force = [-20, 0]")), held),
        (
            &pull.to_owned(),
            load(&varied("traction = [-2, 0]")),
            "along x",
        ),
        (&pull.to_owned(), load(&varied("pressure = 2")), held),
        (&pushed, tool(&varied("move = [0, -0.1]")), free),
        (
            &"".to_owned(),
            format!("move = [{{ on = \"b.right\", u = {{ x = 0.01 }}, {there} }}]"),
            free,
        ),
    ] {
        let said = steps(first, &second);
        let remedy = "in a step without a table before this one";
        for word in [words, remedy, "known in the run only", "deck.toml:18"] {
            assert!(
                said.contains(word),
                "{word:?} of {first} {second} in {said}"
            );
        }
    }
    // A step between that says nothing of the tool holds it, at a place that is no better known.
    let rest = |first: &str| {
        format!(
            "{first}\n[[step]]\nname = \"rest\"\nincrements = 1\nfix = [{{ on = \"b\", u = [\"x\", \"y\"] }}]"
        )
    };
    for (first, second, words) in [
        (
            &pushed,
            "move = [0, -0.1]",
            "the step before holds it along y where a force had left it, at a place that is known",
        ),
        (
            &tool("moment = 5"),
            "turn = 0.1",
            "the step before holds it where a moment had turned it, at an angle that is known",
        ),
    ] {
        let said = steps(&rest(first), &tool(&varied(second)));
        assert!(said.contains(words) && !said.contains("free"), "{said}");
    }
    // With a wrong beginning it is not told that it jumps from nothing.
    let wrong = steps(
        &moved,
        &tool("force = [0, -2000], table = [[0, 0.5], [1, 1]]"),
    );
    assert!(wrong.contains(held) && !wrong.contains("jump"), "{wrong}");
}

/// What acts at the end of the step before is known: a force, a place, or nothing.
#[test]
fn a_table_on_what_the_step_before_told_begins_with_that() {
    let varied = "table = [[0, 0.5], [0.5, 1], [1, 0]]";
    let tool = |what: &str| format!("tools = [{{ name = \"t\", {what} }}]");
    let pull = "move = [{ on = \"b.right\", u = { x = 0.01 } }]";
    let load = "load = [{ on = \"b.right\", force = [0, 20], table = [[0, 0], [1, 1]] }]";
    for (first, second) in [
        (
            tool("force = [0, -100]"),
            tool(&format!("force = [0, -200], {varied}")),
        ),
        (
            tool("force = [0, -100], move = [0.1, 0]"),
            tool(&format!("force = [0, -200], move = [0.2, 0], {varied}")),
        ),
        (
            tool("move = [0, -0.1]"),
            tool(&format!("move = [0, -0.2], {varied}")),
        ),
        (tool("moment = 5"), tool(&format!("moment = 10, {varied}"))),
        // Held or moved along another direction, and still held along this one.
        (pull.to_owned(), load.to_owned()),
        (
            pull.to_owned(),
            format!("{pull}\n{}", load.replace("0, 20]", "20, 20]")),
        ),
        // A part of what was moved, with a name of its own.
        (
            pull.to_owned(),
            "move = [{ on = \"part\", u = { x = 0.02 }, table = [[0, 0.5], [1, 1]] }]".to_owned(),
        ),
    ] {
        let said = steps(&first, &second);
        assert!(!said.contains("error: "), "{first} {second}: {said}");
    }
}
