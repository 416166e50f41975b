//! Values that are impossible, and such as are possible and hardly ever meant.

use super::{DECK, flat, says, shown};
use moreau::deck::open;

#[test]
fn what_is_told_twice_is_pointed_at() {
    says(
        "u = [\"x\"]",
        "u = [\"x\", \"x\"]",
        "\"x\", \"x\"",
        &["each direction once"],
    );
    let tools = |told: &str| {
        let tools = format!("increments = 20\ntools = [{told}]");
        shown("increments = 20", &tools)
    };
    for (twice, what) in [
        (
            "{ name = \"foundation\", move = [0, 0.1] }, { name = \"foundation\", move = [0, 0.2] }",
            "motion",
        ),
        (
            "{ name = \"foundation\", force = [0, 1] }, { name = \"foundation\", force = [0, 2] }",
            "force",
        ),
        (
            "{ name = \"foundation\", turn = 1 }, { name = \"foundation\", moment = 3 }",
            "turn",
        ),
    ] {
        let out = tools(twice);
        assert!(
            out.contains(&format!("the {what} of \"foundation\" is told already")),
            "{out}"
        );
    }
    // Pressed by a force and turned by an angle.
    let both = tools("{ name = \"foundation\", force = [0, 1], turn = 1 }");
    assert_eq!(
        both,
        tools("{ name = \"foundation\", force = [0, 1] }, { name = \"foundation\", turn = 1 }")
    );
    assert!(!both.contains("error"), "{both}");
    // Pressed by a force and moved, across it and along it.
    let across = tools("{ name = \"foundation\", force = [0, 1], move = [0.1, 0] }");
    assert!(!across.contains("error"), "{across}");
    let along = tools("{ name = \"foundation\", force = [0, 1], move = [0.1, 0.1] }");
    let expected = "a tool with a force and a motion along y, expected one of both";
    assert!(along.contains(expected), "{along}");
}

/// One finding for what is no number of TOML, whatever its sign, among others in an array or alone: it has no value that could be
/// wrong, too.
#[test]
fn numbers_begin_and_end_with_digits() {
    let told = |number: &str| {
        let alone = DECK.replacen("friction = 0.1", &format!("friction = {number}"), 1);
        let one_of = DECK.replacen("x = [0, 50]", &format!("x = [{number}, 50]"), 1);
        [alone, one_of].map(|text| {
            let (_, _, findings) = open(&text);
            let told: Vec<String> = findings.iter().map(|f| f.message.clone()).collect();
            assert_eq!(told.len(), 1, "{number}: {told:?}");
            told[0].clone()
        })
    };
    for (number, expected) in [
        (".1", "a number begins with a digit, as in 0.3"),
        ("-.1", "a number begins with a digit, as in -0.3"),
        ("+.1e3", "a number begins with a digit, as in +0.3"),
        ("5.", "a number ends with a digit, as in 5.0"),
        ("-5.e3", "a number ends with a digit, as in 5.0"),
    ] {
        assert_eq!(told(number), [expected; 2], "{number}");
    }
    for number in ["1.5.2", "1..2", "--5", "05", "-", "- 5", "0.3."] {
        told(number);
    }
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
    let grid = "x = [0, 50]\ny = [0, 20]\ncells = [10, 2]";
    let lines = |cells: &str| {
        format!("x = {{ lines = [0, 10, 25, 50] }}\ny = [0, 20]\ncells = [{cells}, 2]")
    };
    says(
        grid,
        &lines("400"),
        "cells",
        &[
            "400 cells along x, expected the 3 between its lines",
            "0 where grid lines",
        ],
    );
    for cells in ["0", "3"] {
        let out = shown(grid, &lines(cells));
        assert!(!out.contains("cells along"), "{out}");
    }
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
    let profile = |radii: &str| {
        format!("profile = {{ points = [[60, 0], [20, 0], [20, -9], [0, -9]], radii = {radii} }}")
    };
    for (radii, expected) in [
        ("[1]", "expected 2 radii, one for each corner"),
        ("[4, 6]", "one whose arc leaves room"),
        ("[4, -1]", "a number that is not negative"),
        ("[4, \"r\"]", "number"),
    ] {
        says(plane, &profile(radii), "profile", &[expected]);
    }
    says(
        plane,
        "profile = { points = [[9, 0], [4, 0], [4, 5], [6, 5], [6, -5]], radii = [0, 0, 0] }",
        "profile",
        &["crossing of the polyline with itself"],
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
fn one_displacement_is_prescribed_once() {
    says(
        "u = [\"x\"]",
        "u = [\"y\"]",
        "[[step]]",
        &["prescribes u_y", "as 0 and as -0.2"],
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
fn values_of_another_shape_say_what_is_expected() {
    says(
        "young = 210000.0",
        "young = \"210 GPa\"",
        "210 GPa",
        &[
            "the text \"210 GPa\"",
            "without quotes, and in the units of the deck",
        ],
    );
    says(
        "u = { y = -0.2 }",
        "u = -0.2",
        "u = -0.2",
        &["as in { y = -0.2 }"],
    );
    says(
        "point = [0, 0]",
        "point = 0",
        "point = 0",
        &["the integer 0, expected 2 numbers, [ …, … ]"],
    );
    says(
        "point = [0, 0]",
        "point = [0, 0, 0]",
        "point =",
        &["an array of 3, expected 2 numbers, [ …, … ]"],
    );
}

#[test]
fn moduli_and_friction_in_another_unit_are_doubted() {
    let unit = "units = \"mm-N-MPa\"";
    for (from, to, told) in [
        (
            unit,
            "units = \"m-N-Pa\"",
            ["softer than rubber", "another unit?"],
        ),
        (
            "young = 210000.0",
            "young = 210e9",
            ["stiffer than diamond", "another unit?"],
        ),
        (
            "friction = 0.1",
            "friction = 10",
            ["a tenth is 0.1", "in percent?"],
        ),
    ] {
        let at = to.split(" =").next().expect("a key");
        let at = if from == unit { "young" } else { at };
        says(from, to, &format!("{at} ="), &told);
    }
}

#[test]
fn a_surface_has_one_contact_with_a_tool() {
    let again = "[[contact]]\nsurface = \"block.bottom\"\nagainst = \"foundation\"\nfriction = 0.2 # again\n\n[[step]]";
    let out = shown("[[step]]", again);
    let told = "\"block.bottom\" has a contact with \"foundation\" already";
    assert!(flat(&out).contains(told), "{out}");
}

/// What is pressed on by its interference is loaded, and meant; a tool that just touches is not inside of the body,
/// whatever the facets.
#[test]
fn fits_and_touching_tools_are_not_doubted() {
    let fit = r#"
units = "mm-N-MPa"
analysis = "axisymmetric"
mesh.block = [
  { name = "shaft", element = "quad8", x = [0, 20], y = [0, 10], cells = [2, 2] },
  { name = "hub", element = "quad8", x = [20, 40], y = [0, 10], cells = [2, 3] },
]
material = [{ on = "shaft", young = 210e3, poisson = 0.3 }, { on = "hub", young = 210e3, poisson = 0.3 }]
contact = [{ surface = "hub.left", against = "shaft.right", friction = 0.1, gap-offset = 0.02 }]
step = [{ name = "fit", increments = 1, fix = [{ on = "shaft.bottom", u = ["y"] }, { on = "hub.bottom", u = ["y"] }] }]
"#;
    let said =
        |deck: &str| -> Vec<String> { open(deck).2.iter().map(|f| f.message.clone()).collect() };
    assert_eq!(said(fit), Vec::<String>::new());
    let overlap = fit.replace("x = [20, 40]", "x = [19.99, 40]");
    let told = said(&overlap);
    assert!(
        told.len() == 1
            && told[0].contains("overlap, by 0.01 mm at node")
            && told[0].contains("7 nodes in all"),
        "{told:?}"
    );
    let touching = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "tet10", x = [0, 10], y = [0, 5], z = [0, 10], cells = [2, 1, 2] }]
material = [{ on = "b", young = 210e3, poisson = 0.3 }]
tool = [{ name = "ball", sphere = { center = [5, 25, 5], radius = 20 } }]
contact = [{ surface = "b.top", against = "ball", friction = 0.1 }]
step = [{ name = "s", increments = 1, fix = [{ on = "b.bottom", u = ["x", "y", "z"] }], tools = [{ name = "ball", move = [0, -0.01, 0] }] }]
"#;
    assert_eq!(said(touching), Vec::<String>::new());
    let within = touching.replace("[5, 25, 5]", "[5, 24.9, 5]");
    let told = said(&within);
    assert!(
        told.len() == 1 && told[0].contains("begins inside of the body"),
        "{told:?}"
    );
}

/// A table of a tensile test by its total strains, a plateau of a stress, and a modulus beyond that of elasticity.
#[test]
fn hardening_that_is_hardly_meant_is_told() {
    let told = |hardening: &str| {
        let hard = format!("yield-stress = 300.0\nhardening = {hardening}");
        let text = DECK.replacen("yield-stress = 300.0", &hard, 1);
        let (_, problem, findings) = open(&text);
        assert!(problem.is_some());
        findings
            .iter()
            .map(|f| f.message.clone())
            .collect::<Vec<_>>()
    };
    let total = told("{ table = [[0.0015, 300], [0.0035, 700]] }");
    assert!(
        total[0].contains("plastic strain of 0.0015 with the yield stress"),
        "{total:?}"
    );
    let steep = told("{ linear = 1e9 }");
    assert!(
        steep[0].contains("more than its Young's modulus"),
        "{steep:?}"
    );
    for hardening in [
        "{ table = [[0.02, 300], [0.1, 400]] }",
        "{ table = [[0.0015, 330], [0.1, 400]] }",
        "{ table = [[0, 300], [0.1, 400]] }",
        "{ linear = 2000 }",
    ] {
        assert!(told(hardening).is_empty(), "{hardening}");
    }
}

/// What is misspelt is the only thing that is said of it.
#[test]
fn a_misspelt_kind_of_hardening_is_told_once() {
    let text = DECK.replacen(
        "yield-stress = 300.0",
        "yield-stress = 300.0\nhardening = { linera = 500 }",
        1,
    );
    let (_, _, findings) = open(&text);
    let all: Vec<_> = findings.iter().map(|f| f.message.as_str()).collect();
    assert!(
        all.len() == 1 && all[0].contains("did you mean \"linear\"?"),
        "{all:?}"
    );
    let text = text.replacen("{ linera = 500 }", "{}", 1);
    assert!(open(&text).2.iter().any(|f| f.message.contains("0 curves")));
}

/// What the analysis lets no tool do is told by what the deck says.
#[test]
fn what_a_tool_cannot_do_is_told_as_it_is_given() {
    let text = |what: &str| {
        format!(
            r#"units = "mm-N-MPa"
analysis = "axisymmetric"
mesh = {{ block = [{{ name = "b", element = "quad4", x = [0, 10], y = [0, 10], cells = [2, 2] }}] }}
material = [{{ on = "b", young = 1000, poisson = 0.3 }}]
tool = [{{ name = "p", plane = {{ point = [0, 10], normal = [0, -1] }} }}]
contact = [{{ surface = "b.top", against = "p", friction = 0.1 }}]
step = [{{ name = "s", increments = 1, fix = [{{ on = "b.bottom", u = ["y"] }}], tools = [{{ name = "p", {what} }}] }}]
"#
        )
    };
    for (what, said) in [
        (
            "move = [0, -0.1], turn = 2",
            "turn in degrees of tool \"p\" is 2,",
        ),
        ("move = [0, -0.1], moment = 0", "moment on tool \"p\" is 0,"),
        (
            "force = [-5000, 0]",
            "force along x of tool \"p\" is -5000,",
        ),
        (
            "move = [0.2, -0.1]",
            "motion along x of tool \"p\" is 0.2, expected none",
        ),
        (
            "force = [0, -100], move = [0.2, 0]",
            "motion along x of tool \"p\" is 0.2, expected none",
        ),
    ] {
        let text = text(what);
        let (_, problem, findings) = open(&text);
        let shown = flat(&findings.render("deck.toml", &text, false));
        assert!(problem.is_none() && shown.contains(said), "{shown}");
    }
}

/// A checksum is one of files.
#[test]
fn a_checksum_of_no_file_is_told() {
    let text = format!("checksum = \"00000000\"\n{DECK}");
    let (_, problem, findings) = open(&text);
    let told = |f: &moreau::deck::Finding| f.message.contains("reads no file");
    assert!(problem.is_some() && findings.iter().any(told));
}

/// A side of a body that lies across a tool, alone and beside the side that faces it, and a tool that turns towards it.
#[test]
fn a_side_that_does_not_face_its_tool_is_told() {
    let told_at = |height: &str, surface: &str, turn: &str| {
        let text = format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = {{ block = [{{ name = "b", element = "quad8", x = [0, 40], y = [0, 10], cells = [8, 4] }}] }}
material = [{{ on = "b", young = 1000, poisson = 0.3 }}]
tool = [{{ name = "die", plane = {{ point = [0, {height}], normal = [0, -1] }} }}]
contact = [{{ surface = {surface}, against = "die", friction = 0.1 }}]
step = [{{ name = "s", increments = 1, fix = [{{ on = "b.bottom", u = ["x", "y"] }}], tools = [{{ name = "die", move = [0, -0.05]{turn} }}] }}]
"#
        );
        let (_, problem, findings) = open(&text);
        let shown = findings.render("deck.toml", &text, false);
        assert!(problem.is_some(), "{shown}");
        flat(&shown).contains("\"b.left\" does not face the tool \"die\" anywhere")
    };
    let told = |surface: &str, turn: &str| told_at("10", surface, turn);
    assert!(told("\"b.left\"", ""));
    // What begins inside is told as that.
    assert!(!told_at("8", "\"b.left\"", ""));
    assert!(!told("\"b.top\"", ""));
    assert!(!told("[\"b.left\", \"b.top\"]", ""));
    assert!(!told("\"b.left\"", ", turn = 90"));
}
