//! Materials and friction of every kind: built and echoed, or refused.

use super::{DECK, says};
use moreau::deck::open;

/// Kinds of hardening and of friction that a deck can ask for.
const LAWS: [(&str, &str); 12] = [
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
    (
        "300.0",
        "300.0\nhill = { f = 0.3, g = 0.4, h = 0.6, l = 1.5, m = 1.5, n = 1.2 }",
    ),
    ("300.0", "300.0\nhill = { r0 = 1.8, r45 = 1.2, r90 = 2.3 }"),
    (
        "300.0",
        "300.0\nhill = { r0 = 1.8, r45 = 1.2, r90 = 2.3 }\naxes = 30.0",
    ),
    (
        "young = 210000.0\npoisson = 0.3",
        "orthotropic = { young = [12e4, 9e4, 5e4], poisson = [0.4, 0.45, 0.6], shear = [8e4, 7e4, 6e4] }",
    ),
    ("friction = 0.1", "friction = { tresca = 50.0 }"),
    (
        "friction = 0.1",
        "friction = { coulomb = 0.1, tau-max = 170.0 }",
    ),
];

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
fn hardening_that_is_none_is_pointed_at() {
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
            "hardening starts at a stress of 441.670141, but yield-stress is 300, which it does with e0 = 0.0144583",
        ),
        (
            "{ table = [[0, 200], [1, 300]] }",
            "the hardening table starts at a stress of 200.0, but yield-stress is 300.0: let both be the same number",
        ),
        (
            "{ table = [[0, 301], [1, 400]] }",
            "starts at a stress of 301.0, but yield-stress is 300.0",
        ),
        (
            "{ table = [[0.1, 350], [0.2, 340]] }",
            "row 2 of the hardening table softens",
        ),
        ("{ table = [[0.1, 350, 1]] }", "expected [p, stress]"),
        (
            "{ swift = [1, 1, 1], voce = [1, 2] }",
            "hardening has 2 curves, expected one",
        ),
        ("{ line = 1.0 }", "did you mean \"linear\"?"),
    ];
    for (law, message) in hardening {
        let to = format!("300.0\nhardening = {law}");
        says("300.0", &to, "hardening =", &[message]);
    }
}

#[test]
fn kinematic_hardening_that_is_none_is_pointed_at() {
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
    says(
        "yield-stress = 300.0",
        "kinematic = [ { modulus = 1.0 } ]",
        "kinematic =",
        &["given without a yield-stress"],
    );
}

/// What has axes, and what does not go with them.
#[test]
fn axes_that_are_none_are_pointed_at() {
    const YIELD: &str = "yield-stress = 300.0";
    let hill = "hill = { r0 = 1.8, r45 = 1.2, r90 = 2.3 }";
    for (to, at, message) in [
        (
            hill.to_owned(),
            "hill =",
            "hill is given without a yield-stress",
        ),
        (
            format!("{YIELD}\naxes = 30"),
            "axes =",
            "axes are given without orthotropic or hill",
        ),
        (
            format!("{YIELD}\n{hill}\naxes = [1, 0]"),
            "axes =",
            "axes is an array of 2",
        ),
        (
            format!("{YIELD}\n{hill}\nkinematic = [{{ modulus = 1 }}]"),
            "kinematic =",
            "a material with axes has kinematic",
        ),
        (
            format!("{YIELD}\nhill = {{ r0 = 1.8, f = 1 }}"),
            "hill =",
            "expected { f, g, h, l, m, n } or Lankford's { r0, r45, r90 }",
        ),
        (
            format!("{YIELD}\nhill = {{ r0 = 1.8, r45 = 1.2 }}"),
            "hill =",
            "has no key \"r90\"",
        ),
        (
            format!("{YIELD}\nhill = {{ r0 = 0, r45 = 1.2, r90 = 1 }}"),
            "hill =",
            "Lankford's ratio r0 must be positive",
        ),
        (
            format!("{YIELD}\nhill = {{ f = 0, g = 0, h = 1, l = 1, m = 1, n = 1 }}"),
            "hill =",
            "Hill's criterion is not positive definite",
        ),
        (
            format!(
                "{YIELD}\northotropic = {{ young = [1, 1, 1], poisson = [0, 0, 0], shear = [1, 1, 1] }}"
            ),
            "young = 210000.0",
            "the material has orthotropic and young, expected one elasticity",
        ),
    ] {
        says(YIELD, &to, at, &[message]);
    }
    for (moduli, message) in [
        (
            "young = [1e3, 1e3, 1e3], poisson = [0.9, 0.9, 0.9], shear = [1, 1, 1]",
            "orthotropic elasticity is not positive definite",
        ),
        (
            "young = [1e3, 0, 1e3], poisson = [0, 0, 0], shear = [1, 1, 1]",
            "Young's modulus along an axis must be positive",
        ),
        (
            "young = [1e3, 1e3], poisson = [0, 0, 0], shear = [1, 1, 1]",
            "expected [E1, E2, E3]",
        ),
        (
            "young = [1e3, 1e3, 1e3], poisson = [0, 0, 0]",
            "has no key \"shear\"",
        ),
    ] {
        let to = format!("orthotropic = {{ {moduli} }}");
        says(
            "young = 210000.0\npoisson = 0.3",
            &to,
            "orthotropic =",
            &[message],
        );
    }
}

/// The rules of plane stress, and what it does not go with.
#[test]
fn plane_stress_has_rules_of_its_own() {
    const ANALYSIS: &str = "analysis = \"plane-strain\"";
    let stress = "analysis = \"plane-stress\"\nthickness = 2.5";
    for (element, rule) in [("tri3", "full"), ("quad4", "full"), ("quad8", "reduced")] {
        let text = DECK.replace(ANALYSIS, stress).replace("quad8", element);
        let (deck, problem, findings) = open(&text);
        let shown = findings.render("deck.toml", &text, false);
        // Of triangles that lock in plane strain nothing is said.
        assert!(problem.is_some() && findings.warnings() == 0, "{shown}");
        assert_eq!(deck.quadrature(&deck.materials[0]), rule);
        let once = deck.resolved();
        let is_echoed = stress.lines().all(|line| once.contains(line));
        assert!(is_echoed, "{once}");
        assert_eq!(open(&once).0.resolved(), once);
    }
    for (given, at, message) in [
        (
            "analysis = \"plane-stress\"\nstrain = \"finite\"",
            "strain =",
            "analysis = \"plane-stress\" with strain = \"finite\": its thickness is not followed",
        ),
        (
            "analysis = \"plane-stress\"\nthickness = 0",
            "thickness =",
            "thickness",
        ),
        (
            "analysis = \"plane-stres\"",
            "analysis =",
            "did you mean \"plane-stress\"?",
        ),
    ] {
        says(ANALYSIS, given, at, &[message]);
    }
    let text = DECK
        .replace(ANALYSIS, stress)
        .replace("300.0", "300.0\nquadrature = \"b-bar\"")
        .replace("quad8", "quad4");
    let (_, problem, findings) = open(&text);
    let shown = findings.render("deck.toml", &text, false);
    assert!(problem.is_none(), "{shown}");
    assert!(
        shown.contains("with quadrature = \"b-bar\": no flow keeps an area"),
        "{shown}"
    );
}

#[test]
fn friction_that_is_none_is_pointed_at() {
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

/// A solid on a rough floor whose friction has two coefficients.
const SOLID: &str = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "hex8", x = [0, 9], y = [0, 9], z = [0, 3], cells = [2, 2, 1] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "floor", plane = { point = [0, 0, 0], normal = [0, 0, 1] } }]
[[contact]]
surface = "b.back"
against = "floor"
friction = { coulomb = [0.1, 0.4], axis = [1.0, 1.0, 0.0] }
[[step]]
name = "press"
increments = 1
move = [{ on = "b.front", u = { x = 1, y = 0, z = -0.01 } }]
"#;

#[test]
fn two_coefficients_of_friction_have_an_axis() {
    let (deck, problem, findings) = open(SOLID);
    let shown = findings.render("deck.toml", SOLID, false);
    assert!(problem.is_some() && findings.iter().count() == 0, "{shown}");
    let once = deck.resolved();
    assert!(
        once.contains("friction = { coulomb = [0.1, 0.4], axis = [1.0, 1.0, 0.0] }"),
        "{once}"
    );
    assert_eq!(open(&once).0.resolved(), once);
    let friction = "{ coulomb = [0.1, 0.4], axis = [1.0, 1.0, 0.0] }";
    for (to, words) in [
        ("{ coulomb = [0.1, 0.4] }", &["has no key \"axis\""][..]),
        (
            "{ coulomb = 0.1, axis = [1, 0, 0] }",
            &["coulomb is the number 0.1, expected 2 numbers"],
        ),
        (
            "{ coulomb = [0.1, 0.4], axis = [1, 0] }",
            &["axis is an array of 2, expected 3 numbers"],
        ),
        (
            "{ coulomb = [0.1, 0], axis = [1, 0, 0] }",
            &["friction along the second tangent", "positive"],
        ),
        (
            "{ coulomb = [0.1, 0.4], axis = [0, 0, 2] }",
            &["axis of friction is normal to \"b.back\""],
        ),
        (
            "{ coulomb = [0.1, 0.4], axis = [0, 0, 0] }",
            &["length of the axis of friction"],
        ),
        (
            "{ coulomb = [0.1, 0.4], axis = [1, 0, 0], tau-max = 5 }",
            &["tau-max limits friction of one"],
        ),
        ("[0.1, 0.4]", &["axis"]),
    ] {
        let text = SOLID.replace(friction, to);
        let (_, problem, findings) = open(&text);
        let out = findings.render("deck.toml", &text, false);
        assert!(problem.is_none(), "{to}");
        let out = crate::flat(&out);
        assert!(words.iter().all(|w| out.contains(w)), "{to}: {out}");
    }
    says(
        "friction = 0.1",
        "friction = { coulomb = [0.1, 0.4], axis = [1, 0, 0] }",
        "friction =",
        &["needs analysis = \"solid\""],
    );
}

#[test]
fn a_table_of_friction_never_falls_and_is_concave() {
    let table = |rows: &str| format!("friction = {{ table = {rows} }}");
    let (deck, problem, findings) =
        open(&DECK.replace("friction = 0.1", &table("[[0, 0], [200, 30], [600, 60]]")));
    assert!(problem.is_some() && findings.errors() == 0);
    let once = deck.resolved();
    let shown = "friction = { table = [[0.0, 0.0], [200.0, 30.0], [600.0, 60.0]] }";
    assert!(once.contains(shown), "{once}");
    assert_eq!(open(&once).0.resolved(), once);
    for (rows, words) in [
        (
            "[[0, 0], [200, 30], [600, 20]]",
            "row 3 of the friction table falls",
        ),
        (
            "[[0, 0], [200, 10], [600, 60]]",
            "row 3 of the friction table is steeper",
        ),
        (
            "[[10, 0], [200, 10]]",
            "row 1 of the friction table does not start at no pressure",
        ),
        ("[[0, 0], [200]]", "expected [pressure, shear]"),
        ("[]", "row 1 of the friction table is missing"),
    ] {
        says("friction = 0.1", &table(rows), "friction =", &[words]);
    }
    says(
        "friction = 0.1",
        "friction = { table = [[0, 0], [1, 1]], coulomb = 0.1 }",
        "friction =",
        &["friction has table and coulomb, expected one law"],
    );
}

#[test]
fn a_tolerance_is_between_rounding_and_no_answer() {
    for value in ["1e-14", "0.1", "-1e-10"] {
        says(
            "[[tool]]",
            &format!("[solver]\ntolerance = {value}\n[[tool]]"),
            "tolerance =",
            &["expected a part of the largest force"],
        );
    }
}

/// A material on several groups is one on each of them.
#[test]
fn a_material_may_be_on_several_groups() {
    let second = "[[mesh.block]]\nname = \"second\"\nelement = \"quad4\"\nx = [60, 70]\ny = [0, 1]\ncells = [1, 1]\n";
    let fixed = "fix = [{ on = \"second\", u = [\"x\", \"y\"] }, ";
    let with = |on: &str| {
        let deck = DECK.replace(
            "[[material]]\non = \"block\"",
            &format!("{second}[[material]]\non = {on}"),
        );
        deck.replace("fix = [", fixed)
    };
    let (list, problem, findings) = open(&with("[\"block\", \"second\"]"));
    assert!(problem.is_some() && findings.warnings() == 0);
    let (_, material) = DECK
        .split_once("[[material]]\non = \"block\"")
        .expect("a material");
    let (material, _) = material.split_once("[[tool]]").expect("a tool");
    let each = with("\"block\"").replace(
        "[[tool]]",
        &format!("[[material]]\non = \"second\"{material}[[tool]]"),
    );
    assert_eq!(list.resolved(), open(&each).0.resolved());
    for (on, words) in [
        ("[]", "on is an array of 0, expected at least one"),
        ("[1]", "on is the integer 1, expected a text in quotes"),
        ("[\"block\", \"sekond\"]", "did you mean \"second\"?"),
        ("[\"block\", \"block.top\"]", "\"block.top\" holds facets"),
        (
            "[\"block\", \"second\", \"block\"]",
            "\"block\" has a material already",
        ),
    ] {
        let text = with(on);
        let (_, problem, findings) = open(&text);
        let out = findings.render("deck.toml", &text, false);
        assert!(problem.is_none() && out.contains(words), "{words} in {out}");
    }
    // What is wrong with it is said once.
    let text = with("[\"block\", \"second\"]").replace("0.3", "0.7");
    assert_eq!(open(&text).2.errors(), 1);
}

/// One dilatation a cell is too stiff where flow dilates, and no remedy there for the full rule.
#[test]
fn the_mean_dilatation_of_what_dilates_is_told() {
    let told = |element: &str, rule: &str, strength: &str| -> Vec<String> {
        let text = DECK
            .replace("quad8", element)
            .replace("yield-stress = 300.0", &format!("{strength}\n{rule}"));
        let (_, problem, findings) = open(&text);
        let shown = findings.render("deck.toml", &text, false);
        assert!(problem.is_some(), "{shown}");
        findings.iter().map(|f| f.message.clone()).collect()
    };
    let soil = "cohesion = 1\nfriction-angle = 30";
    let still = format!("{soil}\ndilatancy-angle = 0");
    let little = format!("{soil}\ndilatancy-angle = 1");
    for (rule, strength) in [("", soil), ("quadrature = \"b-bar\"", &little)] {
        let said = told("quad4", rule, strength);
        let [said] = said.as_slice() else {
            panic!("{said:?}")
        };
        let words = "quad4 with quadrature = \"b-bar\" is too stiff where plastic flow dilates";
        assert!(
            said.contains(words) && said.contains("use a quadratic element"),
            "{said}"
        );
    }
    for (element, strength) in [
        ("quad4", still.as_str()),
        ("quad4", "yield-stress = 300.0"),
        ("quad8", soil),
        ("quad9", soil),
        ("tri6", soil),
    ] {
        let said = told(element, "", strength);
        assert!(said.is_empty(), "{element}, {strength}: {said:?}");
    }
    let full = "quadrature = \"full\"";
    for (strength, remedy) in [
        (soil, "use a quadratic element"),
        (still.as_str(), "use quadrature = \"b-bar\""),
    ] {
        let said = told("quad4", full, strength);
        let words = "quad4 with full quadrature locks in plastic flow";
        let [said] = said.as_slice() else {
            panic!("{said:?}")
        };
        assert!(said.contains(words) && said.contains(remedy), "{said}");
    }
}
