//! Wrong decks that an editor with the schema marks while they are typed: all that a schema can say.

use super::DECK;
use super::schema::{fits, read, schema};
use moreau::deck::open;

const SOLID: &str = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "hex8", x = [0, 4], y = [0, 4], z = [0, 4], cells = [2, 2, 2] }]
mesh.group = [{ name = "g", on = "b.top", nearest = [0, 4, 0] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "roll", cylinder = { center = [0, 14, 0], axis = [0, 0, 1], radius = 10 } }]
contact = [{ surface = "b.top", against = "roll", friction = { coulomb = [0.3, 0.1], axis = [1, 0, 0] } }]
[[step]]
name = "press"
increments = 2
fix = [
  { on = "b.bottom", u = ["x", "y", "z"] },
]
load = [{ on = "b.right", traction = [0, 0, 1] }]
tools = [{ name = "roll", move = [0, -0.2, 0] }]
"#;

/// Pieces of the plane deck, each with what is wrong in its place.
const IN_THE_PLANE: [(&str, &[&str]); 22] = [
    (
        "units = \"mm-N-MPa\"",
        &["", "units = \"cm-N-MPa\"", "units = 1"],
    ),
    (
        "analysis = \"plane-strain\"",
        &[
            "",
            "analysis = \"plane-stres\"",
            "analysis = \"plane-stress\"\nstrain = \"finite\"",
            "analysis = \"plane-stress\"\nthickness = 0",
            "analysis = \"solid\"",
            "analysis = \"plane-strain\"\nthickness = 0",
            "analysis = \"plane-strain\"\nthickness = -1.0",
            "analysis = \"axisymmetric\"\nthickness = 1",
        ],
    ),
    ("title =", &["titel ="]),
    (
        "name = \"block\"",
        &["", "name = \"a b\"", "name = \"\"", "name = 1"],
    ),
    (
        "element = \"quad8\"",
        &["", "element = \"quad7\"", "element = \"hex8\""],
    ),
    (
        "x = [0, 50]",
        &[
            "",
            "x = [0]",
            "x = [0, 25, 50]",
            "x = { lines = [0] }",
            "x = { line = [0, 50] }",
            "x = [0, 50]\nz = [0, 1]",
        ],
    ),
    (
        "cells = [10, 2]",
        &[
            "",
            "cells = [10]",
            "cells = [10, 2, 2]",
            "cells = [0, 2]",
            "cells = [10, 0]",
            "cells = [10, -2]",
            "cells = [10, 2.5]",
        ],
    ),
    (
        "x = [0, 25]",
        &[
            "",
            "x = [0, 25]\nz = [0, 1]",
            "x = [0, 25]\nnearest = [0, 20]",
            "nearest = [0, 20, 0]",
            "nearest = [0]",
        ],
    ),
    (
        "young = 210000.0",
        &[
            "",
            "young = 0",
            "young = -1.0",
            "young = \"210 GPa\"",
            "E = 210000.0",
        ],
    ),
    (
        "poisson = 0.3",
        &["", "poisson = 0.5", "poisson = -1", "poisson = 3"],
    ),
    (
        "yield-stress = 300.0",
        &[
            "yield-stress = 0",
            "yield-stress = -300.0",
            "hardening = { linear = 1 }",
            "kinematic = [{ modulus = 1 }]",
            "yield-stress = 300.0\nhardening = {}",
            "yield-stress = 300.0\nhardening = { linear = -1 }",
            "yield-stress = 300.0\nhardening = { voce = [1, 1], table = [[0, 300], [1, 300]] }",
            "yield-stress = 300.0\nhardening = { voce = [1] }",
            "yield-stress = 300.0\nhardening = { voce = [-1, 1] }",
            "yield-stress = 300.0\nhardening = { voce = [1, -1] }",
            "yield-stress = 300.0\nhardening = { swift = [300, 1] }",
            "yield-stress = 300.0\nhardening = { swift = [300, 0, 0.1] }",
            "yield-stress = 300.0\nhardening = { swift = [300, 1, -0.1] }",
            "yield-stress = 300.0\nhardening = { table = [] }",
            "yield-stress = 300.0\nhardening = { table = [[0]] }",
            "yield-stress = 300.0\nhardening = { table = [[0, 300, 1]] }",
            "yield-stress = 300.0\nhardening = { table = [[-0.1, 300]] }",
            "yield-stress = 300.0\nkinematic = [{ modulus = -1 }]",
            "yield-stress = 300.0\nkinematic = [{ modulus = 1, recall = -1 }]",
            "yield-stress = 300.0\nkinematic = [{ recall = 1 }]",
            "yield-stress = 300.0\nkinematic = { modulus = 1 }",
            "yield-stress = 300.0\nkinematic = [{ modulus = 1, recall = 1 }, { modulus = 1, recall = 1 }, \
             { modulus = 1, recall = 1 }, { modulus = 1, recall = 1 }, { modulus = 1, recall = 1 }]",
            "yield-stress = 300.0\ncohesion = 1\nfriction-angle = 30",
            "yield-stress = 300.0\nfriction-angle = 30",
            "cohesion = 1",
            "cohesion = 0\nfriction-angle = 30",
            "cohesion = 1\nfriction-angle = 0",
            "cohesion = 1\nfriction-angle = 90",
            "cohesion = 1\nfriction-angle = 30\ndilatancy-angle = -1",
            "dilatancy-angle = 10",
            "quadrature = \"exact\"",
            "expansion = \"steel\"",
            "expansion = [1e-5]",
            "[[initial]]\non = \"block\"",
            "[[initial]]\np = 0.1",
            "[[initial]]\non = \"block\"\np = -0.1",
            "[[initial]]\non = \"block\"\nstress = 10",
            "[[initial]]\non = \"block\"\nstress = {}",
            "[[initial]]\non = \"block\"\nstress = { x = 10 }",
            "[[initial]]\non = \"block\"\nstress = { xx = \"10 MPa\" }",
        ],
    ),
    (
        "plane = { point = [0, 0], normal = [0, 1] }",
        &[
            "",
            "plane = { point = [0, 0] }",
            "plane = { normal = [0, 1] }",
            "plane = { point = [0, 0], normal = [0, 0.0] }",
            "plane = { point = [0, 0, 0], normal = [0, 1] }",
            "plane = { point = [0, 0], normal = [0, 1, 0] }",
            "plane = { point = [0, 0], normal = [0, 1] }\ninside = true",
            "plane = { point = [0, 0], normal = [0, 1] }\npolyline = [[0, 0], [1, 0]]",
            "cylinder = { center = [0, -5], radius = 0 }",
            "cylinder = { center = [0, -5], radius = -5 }",
            "cylinder = { center = [0, -5] }",
            "cylinder = { center = [0, -5, 0], radius = 5 }",
            "cylinder = { center = [0, -5], axis = [0, 0], radius = 5 }",
            "sphere = { center = [0, -5], radius = 5 }",
            "polyline = []",
            "polyline = [[0, 0]]",
            "polyline = [[0, 0, 0], [1, 0, 0]]",
            "polyline = [[1, 0], [0, 0]]\ninside = true",
            "profile = { points = [[9, 0], [4, 0], [4, -5]] }",
            "profile = { points = [[9, 0], [4, 0], [4, -5]], radii = [-1] }",
            "profile = { points = [[9, 0]], radii = [] }",
            "profile = { points = [[9, 0], [4, 0]], radii = [], radius = 1 }",
        ],
    ),
    (
        "friction = 0.1",
        &[
            "",
            "friction = -0.1",
            "friction = [0.1, 0.2]",
            "friction = {}",
            "friction = { coulomb = -0.1 }",
            "friction = { tresca = -1 }",
            "friction = { tresca = 1, coulomb = 0.1 }",
            "friction = { tresca = 1, tau-max = 1 }",
            "friction = { tresca = 1, axis = [1, 0, 0] }",
            "friction = { tau-max = 1 }",
            "friction = { coulomb = 0.1, tau-max = -1 }",
            "friction = { coulomb = [0.1, 0.2], axis = [1, 0, 0] }",
            "friction = { coulomb = 0.1, axis = [1, 0, 0] }",
            "friction = 0.1\nadjust = -1",
        ],
    ),
    ("surface = \"block.bottom\"", &["", "surface = 1"]),
    ("against = \"foundation\"", &["", "on = \"foundation\""]),
    ("name = \"press\"", &["", "name = \"press it\""]),
    (
        "increments = 20",
        &[
            "",
            "increments = 0",
            "increments = -1",
            "increments = 2.5",
            "increments = 100001",
            "increments = { start = 0.1 }",
            "increments = { start = 0, min = 0.1, max = 0.1 }",
            "increments = { start = 0.1, min = 0, max = 0.1 }",
            "increments = { start = 0.1, min = 0.1, max = 2 }",
            "increments = { start = 1e-6, min = 1e-6, max = 0.1 }",
            "increments = 20\nuntil = \"the end\"",
        ],
    ),
    (
        "fix = [{ on = \"block.left\", u = [\"x\"] }]",
        &[
            "fix = [{ on = \"block.left\", u = [] }]",
            "fix = [{ on = \"block.left\", u = [\"x\", \"x\"] }]",
            "fix = [{ on = \"block.left\", u = [\"z\"] }]",
            "fix = [{ on = \"block.left\", u = \"x\" }]",
            "fix = [{ on = \"block.left\" }]",
            "fix = [{ u = [\"x\"] }]",
            "fix = { on = \"block.left\", u = [\"x\"] }",
        ],
    ),
    (
        "u = { y = -0.2 }",
        &[
            "u = {}",
            "u = { z = -0.2 }",
            "u = [0, -0.2]",
            "u = { y = \"-0.2\" }",
            "v = { y = -0.2 }",
        ],
    ),
    (
        "move = [{ on = \"punch\", u = { y = -0.2 } }]",
        &[
            "load = [{ on = \"punch\" }]",
            "load = [{ on = \"punch\", pressure = 1, traction = [0, 1] }]",
            "load = [{ on = \"punch\", traction = [0, 1, 0] }]",
            "load = [{ on = \"punch\", force = [0] }]",
            "load = [{ on = \"block\", body-force = 1 }]",
            "load = [{ on = \"block\", temperature = \"hot\" }]",
            "load = [{ on = \"block\", temperature = [1, 2] }]",
            "load = [{ on = \"block\", temperature = 1, pressure = 1 }]",
            "tools = [{ name = \"foundation\" }]",
            "tools = [{ name = \"foundation\", moment = [1] }]",
            "tools = [{ name = \"foundation\", moment = 1, turn = 1 }]",
            "tools = [{ name = \"foundation\", moment = { axis = [0, 0, 1], value = 1 } }]",
            "tools = [{ name = \"foundation\", move = [0, 1, 0] }]",
            "tools = [{ name = \"foundation\", force = [0] }]",
        ],
    ),
    (
        "[expect]",
        &[
            "[solver]\ncontact = \"penalty\"\n[expect]",
            "[solver]\ncontact = {}\n[expect]",
            "[solver]\ncontact = { penetration = 1 }\n[expect]",
            "[solver]\ncontact = { penetration = 0 }\n[expect]",
            "[solver]\ncontact = { penalty = { normal = 1 } }\n[expect]",
            "[solver]\ncontact = { penalty = { normal = 0, tangent = 1 } }\n[expect]",
            "[solver]\ncontact = { penalty = { normal = 1, tangent = -1 } }\n[expect]",
            "[solver]\ncontact = { penalty = { normal = 1, tangent = 1 }, penetration = 0.1 }\n[expect]",
            "[solver]\nnesting = \"around\"\n[expect]",
            "[solver]\nthreads = -1\n[expect]",
            "[solver]\nthreads = 2000\n[expect]",
            "[output]\nvtu = \"some\"\n[expect]",
            "[output]\npoints = true\n[expect]",
            "[output]\ncheckpoint = -1\n[expect]",
            "[output]\ncheckpoint = 2000000\n[expect]",
            "[output]\ndirectory = 1\n[expect]",
        ],
    ),
    (
        "value = -10519.5378, absolute = 1e-3",
        &[
            "value = -10519.5378",
            "absolute = 1e-3",
            "value = -10519.5378, absolute = -1",
            "value = -10519.5378, within = 1e-3",
        ],
    ),
];

/// The same of the deck in space.
const IN_SPACE: [(&str, &[&str]); 8] = [
    (
        "element = \"hex8\"",
        &["element = \"quad8\"", "element = \"hex9\""],
    ),
    (", z = [0, 4]", &["", ", z = 4"]),
    (
        "cells = [2, 2, 2]",
        &["cells = [2, 2]", "cells = [2, 2, 0]"],
    ),
    ("nearest = [0, 4, 0]", &["nearest = [0, 4]"]),
    (
        "cylinder = { center = [0, 14, 0], axis = [0, 0, 1], radius = 10 }",
        &[
            "cylinder = { center = [0, 14, 0], radius = 10 }",
            "cylinder = { center = [0, 14], axis = [0, 0, 1], radius = 10 }",
            "cylinder = { center = [0, 14, 0], axis = [0, 0, 0], radius = 10 }",
            "cylinder = { center = [0, 14, 0], axis = [0, 1], radius = 10 }",
            "sphere = { center = [0, 14], radius = 10 }",
            "sphere = { center = [0, 14, 0], radius = 0 }",
            "plane = { point = [0, 4], normal = [0, -1] }",
            "polyline = [[0, 4], [4, 4]]",
        ],
    ),
    (
        "friction = { coulomb = [0.3, 0.1], axis = [1, 0, 0] }",
        &[
            "friction = { coulomb = [0.3, 0.1] }",
            "friction = { coulomb = [0.3, 0], axis = [1, 0, 0] }",
            "friction = { coulomb = [0.3], axis = [1, 0, 0] }",
            "friction = { coulomb = 0.3, axis = [1, 0, 0] }",
            "friction = { coulomb = [0.3, 0.1], axis = [1, 0] }",
            "friction = { coulomb = [0.3, 0.1], axis = [0, 0, 0] }",
            "friction = { coulomb = [0.3, 0.1], axis = [1, 0, 0], tau-max = 1 }",
        ],
    ),
    (
        "traction = [0, 0, 1]",
        &["traction = [0, 1]", "force = [0, 1]", "body-force = [0, 1]"],
    ),
    (
        "move = [0, -0.2, 0]",
        &[
            "move = [0, -0.2]",
            "force = [0, -1]",
            "moment = 1",
            "moment = { axis = [0, 1], value = 1 }",
            "moment = { axis = [0, 1, 0] }",
        ],
    ),
];

#[test]
fn what_a_check_refuses_and_a_schema_can_say_the_schema_refuses() {
    let root = schema();
    let mut count = 0;
    let mut passed = Vec::new();
    for (deck, pieces) in [(DECK, &IN_THE_PLANE[..]), (SOLID, &IN_SPACE)] {
        assert_eq!(open(deck).2.errors(), 0);
        fits(&read(deck), &root, &root).expect("a deck without mistakes");
        for (from, wrong) in pieces {
            assert!(deck.contains(from), "{from}");
            for to in *wrong {
                let text = deck.replacen(from, to, 1);
                assert!(
                    open(&text).2.errors() > 0,
                    "nobody refuses {to:?} for {from}"
                );
                if fits(&read(&text), &root, &root).is_ok() {
                    passed.push(format!("{to:?} for {from}"));
                }
                count += 1;
            }
        }
    }
    assert!(
        passed.is_empty(),
        "{} of {count}: {passed:#?}",
        passed.len()
    );
}

/// Whole sections that are missing, empty, or of the wrong kind.
#[test]
fn sections_that_are_missing_or_empty_are_refused_by_both() {
    let root = schema();
    let table: toml::Table = SOLID.parse().expect("toml");
    for key in ["units", "analysis", "mesh", "material", "step"] {
        for value in [None, Some("[]"), Some("{}"), Some("1")] {
            let mut table = table.clone();
            table.remove(key);
            let rest = table.to_string();
            let text = value.map_or_else(String::new, |v| format!("{key} = {v}\n")) + &rest;
            assert!(open(&text).2.errors() > 0, "{key} = {value:?}");
            assert!(
                fits(&read(&text), &root, &root).is_err(),
                "{key} = {value:?}"
            );
        }
    }
}

/// What other forms of tools and hardening, of which none is in the examples, the schema lets pass as
/// the check does.
#[test]
fn what_is_right_fits() {
    let root = schema();
    let tool = "plane = { point = [0, 0], normal = [0, 1] }";
    let yields = "yield-stress = 300.0";
    for (from, to) in [
        (tool, "polyline = [[60, 0], [-10, 0]]"),
        (
            tool,
            "profile = { points = [[60, 0], [0, 0], [0, -9]], radii = [2] }",
        ),
        (
            tool,
            "profile = { points = [[60, 0], [0, 0], [0, -9]], radii = [0, 2, 0] }",
        ),
        (tool, "cylinder = { center = [0, -9], radius = 9 }"),
        (
            tool,
            "cylinder = { center = [25, 99], radius = 99 }\ninside = true",
        ),
        (yields, ""),
        (yields, "yield-stress = 300\nhardening = { linear = 0 }"),
        (yields, "yield-stress = 300\nexpansion = 1.2e-5"),
        (
            yields,
            "yield-stress = 300\n[[initial]]\non = \"block\"\nstress = { xx = -10, zz = \"= 2 * y\" }\np = \"= 1e-3 * x\"",
        ),
        (
            "move = [{ on = \"punch\", u = { y = -0.2 } }]",
            "load = [{ on = \"block\", temperature = \"= 100 * x\", table = [[0, 1], [1, 0]] }]",
        ),
        (yields, "yield-stress = 300\nhardening = { voce = [10, 2] }"),
        (
            yields,
            "yield-stress = 300\nhardening = { swift = [300, 1, 0.2] }",
        ),
        (
            yields,
            "yield-stress = 300\nhardening = { table = [[0.1, 310], [0.2, 320]] }",
        ),
        (
            yields,
            "yield-stress = 300\nkinematic = [{ modulus = 1 }, { modulus = 1, recall = 2 }]",
        ),
        (
            yields,
            "cohesion = 10\nfriction-angle = 30\ndilatancy-angle = 0",
        ),
        (
            "friction = 0.1",
            "friction = { coulomb = 0.1, tau-max = 10 }",
        ),
        ("friction = 0.1", "friction = { tresca = 10 }"),
        ("friction = 0.1", "friction = 0.1\nadjust = true"),
        (
            "cells = [10, 2]",
            "cells = [10, 2]\n[[mesh.block]]\nname = \"c\"\nelement = \"quad4\"\n\
          x = { lines = [60, 61] }\ny = { lines = [0, 1] }\n[[material]]\non = \"c\"\nyoung = 1\npoisson = 0\n\
          [[mesh.group]]\nname = \"n\"\non = \"c\"\nnearest = [60, 0]",
        ),
        (
            "increments = 20",
            "increments = { start = 0.1, min = 1e-6, max = 1 }\nuntil = \"collapse\"",
        ),
        (
            "analysis = \"plane-strain\"",
            "analysis = \"plane-strain\"\nthickness = 2",
        ),
    ] {
        assert!(DECK.contains(from), "{from}");
        let text = DECK.replacen(from, to, 1);
        // What a body needs to be held is beside the form.
        let said = open(&text).2;
        let form = said.iter().filter(|f| f.message.contains("expected"));
        assert_eq!(form.count(), 0, "{to}");
        fits(&read(&text), &root, &root).unwrap_or_else(|e| panic!("{to}: {e}"));
    }
}
