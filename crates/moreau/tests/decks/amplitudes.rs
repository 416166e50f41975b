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
