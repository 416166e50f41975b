//! What is said about a deck that is wrong or doubtful, and that nothing said about it is a panic.

mod meshes;
mod metamorphic;
mod mutants;
mod schema;
mod supports;

use moreau::deck::{Class, Problem, open, open_in};
use std::path::{Path, PathBuf};

const DECK: &str = include_str!("../../../../docs/examples/punched-block.toml");

/// A folder of the repository.
fn folder(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// A path for what a test writes.
fn temporary(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

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
    assert!((setup.bodies[0].volume - 1000.0).abs() < 1e-9);
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
    let locks = "locks in plastic flow";
    says(
        "quad8",
        "tri3",
        "yield-stress",
        &["tri3", locks, "a quadratic element"],
    );
    let full = DECK
        .replace("quad8", "quad4")
        .replace("0.3", "0.3\nquadrature = \"full\"");
    let (_, _, findings) = open(&full);
    let out = flat(&findings.render("deck.toml", &full, false));
    assert!(out.contains(locks) && out.contains("\"b-bar\""), "{out}");
    let (deck, _, findings) = open(&DECK.replace("quad8", "quad4"));
    assert_eq!(findings.iter().count(), 0);
    assert_eq!(deck.quadrature(&deck.materials[0]), "b-bar");
    let twice = "[[tool]]\nname = \"idle\"\nplane = { point = [0, 9], normal = [0, 1] }\n[[tool]]";
    says(
        "[[tool]]",
        twice,
        "\"idle\"",
        &["no [[contact]] uses the tool \"idle\""],
    );
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

/// Keys that are asked for in several places are listed once.
#[test]
fn the_keys_of_a_table_are_listed_once() {
    let out = shown("poisson = 0.3", "poisson = 0.3\npossion = 0.3");
    assert!(out.contains("did you mean \"poisson\"?"), "{out}");
    assert_eq!(out.matches("kinematic").count(), 1, "{out}");
}

#[test]
fn tools_and_contacts_out_of_their_range_are_pointed_at() {
    let plane = "plane = { point = [0, 0], normal = [0, 1] }";
    says(
        plane,
        "polyline = [[0, 0], [1, 0], [0.5, 0]]",
        "polyline",
        &["no turn back on itself"],
    );
    says(
        plane,
        "polyline = [[0, 0]]",
        "polyline",
        &["number of points of the polyline is 1, expected at least 2"],
    );
    says(
        plane,
        "polyline = [[0, 0], [1, 0]]\ninside = true",
        "inside",
        &["a polyline has no inside", "reverse the order"],
    );
    says(
        plane,
        "cylinder = { center = [0, -9], radius = 0 }",
        "cylinder",
        &["radius is 0"],
    );
    says(
        "friction = 0.1",
        "friction = 0.1\nadjust = -1",
        "adjust",
        &["expected true, or a distance"],
    );
    for part in ["0", "1.5"] {
        let solver = format!("[solver]\ncontact = {{ penetration = {part} }}\n[expect]");
        says(
            "[expect]",
            &solver,
            "penetration",
            &["a part of the size of a cell"],
        );
    }
    says(
        "increments = 20",
        "increments = { start = 0.1, min = 0.2, max = 0.5 }",
        "increments",
        &["0 < min ≤ start ≤ max ≤ 1"],
    );
}

/// Every class of findings has its section.
#[test]
fn every_class_of_findings_is_explained() {
    let page = include_str!("../../../../docs/errors.md");
    for class in Class::ALL {
        let section = format!("\n## {}\n", class.name());
        assert!(page.contains(&section), "{section:?}");
    }
    let classes = |from: &str, to: &str| -> Vec<Class> {
        let (_, _, findings) = open(&DECK.replacen(from, to, 1));
        findings.iter().map(|f| f.class).collect()
    };
    assert_eq!(classes("young =", "young")[0], Class::Syntax);
    assert_eq!(classes("title", "titel"), [Class::Keys]);
    assert_eq!(classes("0.3", "0.7"), [Class::Values]);
    assert_eq!(classes("on = \"punch\"", "on = \"pinch\""), [Class::Names]);
    assert_eq!(classes("x = [0, 25]", "x = [60, 70]"), [Class::Groups]);
    assert_eq!(classes("u = [\"x\"]", "u = [\"y\"]")[0], Class::Steps);
    assert_eq!(classes("friction = 0.1", "friction = 0"), [Class::Warnings]);
    let out = shown("title", "titel");
    assert!(out.contains("see docs/errors.md#keys"), "{out}");
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
        include_str!("../../../../docs/examples/indentation-flat-punch.toml"),
        include_str!("../../../../docs/examples/block-dragged-on-block.toml"),
        include_str!("../../../../docs/examples/block-opening-sliding-sticking.toml"),
        include_str!("../../../../docs/examples/cylinder-pressed-into-block.toml"),
        include_str!("../../../../docs/examples/pad-dragged-over-plate.toml"),
        include_str!("../../../../docs/examples/punch-on-gmsh-mesh.toml"),
        include_str!("../../../../docs/examples/strip-between-rough-platens.toml"),
        &DECK
            .replace(
                "increments = 20",
                "increments = { start = 0.1, min = 1e-5, max = 0.5 }",
            )
            .replace(
                "friction = 0.1",
                "friction = 0.1\ngap-offset = 0.5\nadjust = true",
            )
            .replace(
                "[expect]",
                "[solver]\ncontact = { penetration = 1e-4 }\n[expect]",
            )
            .replace(
                "plane = { point = [0, 0], normal = [0, 1] }",
                "polyline = [[-9, 0], [99, 0]]",
            ),
    ] {
        let once = open_in(text, &folder("docs/examples")).0.resolved();
        let (deck, problem, findings) = open(&once);
        assert!(
            problem.is_some(),
            "{}",
            findings.render("resolved", &once, false)
        );
        assert_eq!(deck.resolved(), once);
    }
}

/// Kinds of hardening and of friction that a deck can ask for.
const LAWS: [(&str, &str); 8] = [
    ("300.0", "300.0\nhardening = { linear = 1000 }"),
    ("300.0", "300.0\nhardening = { voce = [150.0, 20] }"),
    (
        "300.0",
        "300.0\nhardening = { swift = [700.0, 0.0145, 0.2] }",
    ),
    (
        "300.0",
        "300.0\nhardening = { table = [[0, 300], [0.01, 350.0], [0.1, 380]] }",
    ),
    (
        "300.0",
        "300.0\nhardening = { table = [[0.01, 350.0], [0.1, 380]] }",
    ),
    (
        "300.0",
        "300.0\nkinematic = [ { modulus = 2e3 }, { modulus = 6e4, recall = 400.0 } ]",
    ),
    ("friction = 0.1", "friction = { tresca = 50.0 }"),
    (
        "friction = 0.1",
        "friction = { coulomb = 0.1, tau-max = 170.0 }",
    ),
];

/// What is possible and hardly ever meant: said, and the deck can be run.
#[test]
fn units_and_normals_that_look_wrong_are_doubted() {
    says(
        "young = 210000.0",
        "young = 210.0",
        "young = 210.0",
        &[
            "yields at 300 MPa",
            "Young's modulus of 210 MPa",
            "another unit?",
        ],
    );
    says(
        "y = -0.2",
        "y = -200",
        "y = -200",
        &["moved by 200 mm", "the whole mesh is", "another unit?"],
    );
    says(
        "normal = [0, 1]",
        "normal = [0, -1]",
        "normal = [0, -1]",
        &["all cells at \"block.bottom\" lie inside", "turned round?"],
    );
    says(
        "surface = \"block.bottom\"",
        "surface = \"foundation\"",
        "surface = \"foundation\"",
        &["\"foundation\" is a tool, expected a group of the mesh"],
    );
}

#[test]
fn laws_of_every_kind_are_built_and_echoed() {
    for (from, to) in LAWS {
        let text = DECK.replacen(from, to, 1);
        let (deck, problem, findings) = open(&text);
        let shown = findings.render("deck.toml", &text, false);
        assert!(problem.is_some() && findings.warnings() == 0, "{shown}");
        let once = deck.resolved();
        let (again, problem, findings) = open(&once);
        assert!(
            problem.is_some(),
            "{}",
            findings.render("resolved", &once, false)
        );
        assert_eq!(again.resolved(), once);
        // What was given is there, in the numbers it was given in.
        let line = to.lines().last().expect("a line");
        let digits = |text: &str| -> Vec<f64> {
            text.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == 'e'))
                .filter_map(|n| n.parse().ok())
                .collect()
        };
        let key = line.split(' ').next().expect("a key");
        let echoed = once.lines().find(|l| l.starts_with(key)).expect("echoed");
        let wanted = digits(line);
        let found = digits(echoed);
        assert!(wanted.iter().all(|n| found.contains(n)), "{line}: {echoed}");
    }
}

#[test]
fn laws_that_are_none_are_pointed_at() {
    let hardening = [
        (
            "{ voce = [150.0] }",
            "voce is an array of 1, expected [q_inf, b]",
        ),
        (
            "{ voce = [-1.0, 2] }",
            "saturation of hardening must be non-negative and finite, got -1",
        ),
        (
            "{ swift = [700.0, 0.0, 0.2] }",
            "offset of hardening must be positive",
        ),
        (
            "{ swift = [700.0, 0.1, 0.2] }",
            "hardening starts at a stress of 441.67",
        ),
        (
            "{ table = [[0, 200], [1, 300]] }",
            "hardening starts at a stress of 200",
        ),
        (
            "{ table = [[0.1, 350], [0.2, 340]] }",
            "row 2 of the hardening table softens",
        ),
        ("{ table = [[0.1, 350, 1]] }", "expected [p, stress]"),
        (
            "{ linear = 1.0, voce = [1, 2] }",
            "hardening has 2 laws, expected one",
        ),
        ("{ line = 1.0 }", "did you mean \"linear\"?"),
    ];
    for (law, message) in hardening {
        let to = format!("300.0\nhardening = {law}");
        says("300.0", &to, "hardening =", &[message]);
    }
    let term = "{ modulus = 1.0, recall = 2.0 }";
    let terms = [
        (
            "{ modulus = 1.0, recall = -2.0 }".to_owned(),
            "recall of kinematic hardening must",
        ),
        (
            "{ modulus = -1.0, recall = 2.0 }".to_owned(),
            "kinematic hardening modulus must",
        ),
        ("{ recall = 2.0 }".to_owned(), "has no key \"modulus\""),
        (
            [term; 5].join(", "),
            "5 terms of kinematic hardening with recall, at most 4",
        ),
    ];
    for (terms, message) in terms {
        let to = format!("300.0\nkinematic = [ {terms} ]");
        says("300.0", &to, "kinematic =", &[message]);
    }
    for (law, message) in [
        ("{ tresca = -5.0 }", "friction limit must be non-negative"),
        (
            "{ coulomb = 0.1, tau-max = -1.0 }",
            "friction limit must be non-negative",
        ),
        (
            "{ coulomb = -0.1, tau-max = 1.0 }",
            "coefficient of friction must be",
        ),
        ("{ tau-max = 1.0 }", "has no key \"coulomb\""),
        (
            "{ tresca = 5.0, coulomb = 0.1 }",
            "friction has tresca and coulomb",
        ),
        ("{ tresca = 0.0 }", "frictionless"),
    ] {
        let to = format!("friction = {law}");
        says("friction = 0.1", &to, "friction =", &[message]);
    }
    says(
        "yield-stress = 300.0",
        "kinematic = [ { modulus = 1.0 } ]",
        "kinematic =",
        &["given without a yield-stress"],
    );
}

/// A soil has a cohesion and angles, which belong together and have ranges.
#[test]
fn what_is_no_soil_is_told() {
    let soil = |strength: &str, at: &str, word: &str| {
        says("yield-stress = 300.0", strength, at, &[word]);
    };
    for (angles, at, word) in [
        (
            "friction-angle = 90",
            "friction-angle",
            "must lie in ]0, 90[",
        ),
        (
            "friction-angle = 30\ndilatancy-angle = 31",
            "dilatancy-angle",
            "[0, friction angle]",
        ),
        (
            "yield-stress = 1\nfriction-angle = 30",
            "cohesion",
            "expected one law",
        ),
        ("", "cohesion", "without a friction-angle"),
        (
            "friction-angel = 30",
            "friction-angel",
            "did you mean \"friction-angle\"?",
        ),
        (
            "friction-angle = 30\nhardening = { linear = 1 }",
            "hardening =",
            "given without",
        ),
    ] {
        soil(&format!("cohesion = 1\n{angles}"), at, word);
    }
    soil(
        "cohesion = -1\nfriction-angle = 30",
        "cohesion",
        "cohesion must be positive",
    );
    soil(
        "dilatancy-angle = 30",
        "dilatancy-angle",
        "without a cohesion",
    );
    let strength = "cohesion = 1\nfriction-angle = 30";
    let text = DECK.replace("yield-stress = 300.0", strength);
    let (deck, problem, findings) = open(&text);
    assert!(
        problem.is_some(),
        "{}",
        findings.render("deck.toml", &text, false)
    );
    let soil = deck.materials[0].soil.as_ref().expect("a soil");
    assert_eq!(soil.dilatancy_angle.value, 30.0);
}
