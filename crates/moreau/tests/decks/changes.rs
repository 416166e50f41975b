//! What changes from step to step: nothing, which is told, and loads, without which nothing collapses.

use super::{flat, folder};
use moreau::deck::{Class, open, open_in};
use std::fs;

/// What is said of steps of a block under a die, each the lines beside its name.
fn said(steps: &[&str]) -> String {
    let mut deck = r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 10], y = [0, 4], cells = [2, 2] }]
material = [{ on = "b", young = 2e5, poisson = 0.3, yield-stress = 300.0, expansion = 1e-5 }]
tool = [{ name = "die", plane = { point = [0, 4], normal = [0, -1] } }]
contact = [{ surface = "b.top", against = "die", friction = 0.1 }]
"#
    .to_owned();
    for (k, told) in steps.iter().enumerate() {
        deck += &format!("[[step]]\nname = \"s{k}\"\nincrements = 2\n{told}\n");
    }
    let (_, problem, findings) = open(&deck);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    let but_expansion = findings.iter().filter(|f| !f.message.contains("expansion"));
    let said: Vec<&str> = but_expansion.map(|f| f.message.as_str()).collect();
    said.join("\n")
}

const FIX: &str = "fix = [{ on = \"b.bottom\", u = [\"x\", \"y\"] }]\n";

fn with(more: &str) -> String {
    format!("{FIX}{more}")
}

fn die(told: &str) -> String {
    with(&format!("tools = [{{ name = \"die\", {told} }}]"))
}

fn load(told: &str) -> String {
    with(&format!("load = [{told}]"))
}

fn all(steps: &[String]) -> String {
    said(&steps.iter().map(String::as_str).collect::<Vec<_>>())
}

/// A move is taken for one that is added to that of the step before.
#[test]
fn a_step_in_which_nothing_changes_is_told() {
    let push = "{ on = \"b.top\", traction = [1, 0] }";
    let part = "fix = [{ on = \"b.bottom\", u = [\"y\"] }, { on = \"b.bottom\", u = [\"x\"] }]\n";
    let right = |u: f64| {
        with(&format!(
            "move = [{{ on = \"b.top\", u = {{ x = {u:?} }} }}]"
        ))
    };
    for [first, last] in [
        [die("move = [0, -0.05]"), die("move = [0, -0.05]")],
        // It stays where it is.
        [die("move = [0, -0.05]"), with("")],
        // The end of a table is what holds.
        [
            die("move = [0, -0.1], table = [[0, 0], [1, 0.5]]"),
            die("move = [0, -0.05]"),
        ],
        [die("move = [0, -0.05], turn = 1"), die("turn = 1")],
        [die("force = [0, -9]"), die("force = [0, -9]")],
        [
            die("force = [0, -9], move = [0.1, 0]"),
            die("force = [0, -9], move = [0.1, 0]"),
        ],
        [right(0.1), right(0.1)],
        [load(push), load(push)],
        [
            load(&format!("{push}, {push}")),
            load("{ on = \"b.top\", traction = [2, 0] }"),
        ],
        [with(""), part.to_owned()],
        [
            load("{ on = \"b\", temperature = \"= 2 * x\" }"),
            load("{ on = \"b\", temperature = \"= x + x\" }"),
        ],
    ] {
        let said = all(&[first, last.clone()]);
        let told = "nothing changes in step \"s1\": what it holds, moves and loads is as at the end of step \"s0\"";
        assert!(
            said.contains(told) && said.contains("Values are totals"),
            "{last}: {said}"
        );
    }
    // Where another step is between them.
    let said = all(&[
        die("move = [0, -0.05]"),
        load(push),
        die("move = [0, -0.05]"),
        die("move = [0, -0.05]"),
    ]);
    assert!(
        said.contains("in step \"s3\"") && !said.contains("in step \"s2\""),
        "{said}"
    );
}

#[test]
fn a_step_in_which_something_changes_is_not() {
    let warm = |t: &str| load(&format!("{{ on = \"b\", temperature = {t} }}"));
    let push = "{ on = \"b.top\", traction = [1, 0] }";
    let roller = "fix = [{ on = \"b.bottom\", u = [\"y\"] }]\ntools = [{ name = \"die\", move = [0, -0.05] }]";
    for steps in [
        &[die("move = [0, -0.05]"), die("move = [0, -0.1]")][..],
        &[die("move = [0, -0.05]"), die("move = [0, 0]")],
        // To and fro.
        &[
            die("move = [0, -0.05]"),
            die("move = [0, -0.05], table = [[0, 1], [0.5, 2], [1, 1]]"),
        ],
        &[die("move = [0, -0.05], turn = 1"), die("turn = 2")],
        &[die("turn = 1"), die("turn = 0")],
        // A support is let go, and one comes.
        &[die("move = [0, -0.05]"), roller.to_owned()],
        &[roller.to_owned(), die("move = [0, -0.05]")],
        // What a motion has reached a force holds, or a moment, and the other way round.
        &[die("move = [0, -0.05]"), die("force = [0, -9]")],
        &[die("force = [0, -9]"), with("")],
        &[die("force = [0, -9]"), die("force = [0, -8]")],
        &[
            die("force = [0, -9], move = [0.1, 0]"),
            die("force = [0, -9], move = [0.2, 0]"),
        ],
        &[
            die("move = [0, -0.05], turn = 0"),
            die("move = [0, -0.05], moment = 0"),
        ],
        &[load(push), with("")],
        &[load(push), load(&push.replace('1', "2"))],
        &[warm("1.0"), warm("2.0")],
        &[warm("\"= x\""), warm("\"= 2 * x\"")],
        &[warm("1.0"), with("")],
    ] {
        let said = all(steps);
        assert!(!said.contains("nothing changes"), "{steps:?}: {said}");
    }
    let later = [die("move = [0, -0.05]"), with(""), die("move = [0, -0.1]")];
    assert!(!all(&later).contains("in step \"s2\""));
    // A place that only the run knows.
    let freed = [die("force = [0, -9]"), with(""), die("move = [0, 0]")];
    assert!(!all(&freed).contains("in step \"s2\""));
}

/// Of what is undeformed nothing has been reached: a first step that lets go of stresses or only cools is none of these.
#[test]
fn no_example_has_a_step_in_which_nothing_changes() {
    let mut later = 0;
    for pages in ["docs/examples", "docs/guide/rules"] {
        for entry in fs::read_dir(folder(pages)).expect("decks") {
            let path = entry.expect("an entry").path();
            if path.extension().is_none_or(|end| end != "toml") {
                continue;
            }
            let text = fs::read_to_string(&path).expect("a deck");
            let (deck, _, findings) = open_in(&text, &folder(pages));
            later += deck.steps.len().saturating_sub(1);
            let told = findings
                .iter()
                .find(|f| f.message.contains("nothing changes"));
            assert!(told.is_none(), "{path:?}: {told:?}");
        }
    }
    assert!(later > 10, "{later}");
}

/// A limit load is one of loads.
#[test]
fn a_step_to_collapse_has_loads_that_grow() {
    let until = |told: String| format!("until = \"collapse\"\n{told}");
    let push = || load("{ on = \"b.top\", traction = [900, 0] }");
    let refused = "has until = \"collapse\", and no load grows in it";
    for steps in [
        &[until(die("move = [0, -0.05]"))][..],
        &[until(with(""))],
        &[until(with("move = [{ on = \"b.top\", u = { x = 0.1 } }]"))],
        &[until(load("{ on = \"b.top\", traction = [0, 0] }"))],
        // As large as before.
        &[push(), until(push())],
        &[die("force = [0, -9]"), until(die("force = [0, -9]"))],
    ] {
        let said = all(steps);
        assert!(said.contains(refused), "{steps:?}: {said}");
        assert!(!said.contains("nothing changes"), "{steps:?}: {said}");
    }
    for steps in [
        &[until(push())][..],
        &[until(load("{ on = \"b.top\", pressure = 900 }"))],
        &[until(load("{ on = \"b\", body-force = [0, 900] }"))],
        &[until(load("{ on = \"b.top\", force = [900, 0] }"))],
        &[until(die("force = [0, -900]"))],
        &[until(die("moment = 900"))],
        &[load("{ on = \"b.top\", traction = [9, 0] }"), until(push())],
        // A reaction goes, as the load that a force bore on its tool.
        &[
            with("move = [{ on = \"b.top\", u = { x = 0.1 } }]"),
            until(with("")),
        ],
        // What was carried of these is known in the run.
        &[until(push()), until(push())],
    ] {
        let said = all(steps);
        assert!(!said.contains(refused), "{steps:?}: {said}");
    }
    let text =
        fs::read_to_string(folder("docs/examples/cylinder-to-collapse.toml")).expect("a deck");
    let moves = text.replace(
        "load = [{ on = \"wall.left\", pressure = 384.1811628 }]",
        "move = [{ on = \"wall.left\", u = { x = 1 } }]",
    );
    let (_, problem, findings) = open(&moves);
    let said = flat(&findings.render("deck", &moves, false));
    assert!(problem.is_none(), "{said}");
    let refusal = findings
        .iter()
        .find(|f| f.message.contains(refused))
        .expect("refused");
    assert_eq!(refusal.class, Class::Steps);
    for key in ["pressure", "traction", "force", "body-force", "moment"] {
        assert!(
            refusal.help.as_ref().is_some_and(|help| help.contains(key)),
            "{key} in {said}"
        );
    }
}
