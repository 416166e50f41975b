//! Contact methods that need bodies held by displacements: what a step leaves to contacts, ties or forces is refused.

use super::flat;
use moreau::deck::open;

/// What is said of a block on a plate, tied to it or not, before a die, in a last step and under a method.
fn said(joint: &str, step: &str, method: &str) -> String {
    let deck = format!(
        r#"
units = "mm-N-MPa"
analysis = "plane-strain"
material = [{{ on = "b", young = 2e5, poisson = 0.3 }}, {{ on = "plate", young = 2e5, poisson = 0.3 }}]
tool = [{{ name = "die", plane = {{ point = [0, 4], normal = [0, -1] }} }}]
[[contact]]
surface = "b.top"
against = "die"
friction = 0.1
{joint}
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 10]
y = [0, 4]
cells = [2, 2]
[[mesh.block]]
name = "plate"
element = "quad8"
x = [0, 10]
y = [-4, 0]
cells = [3, 2]
[[step]]
name = "first"
increments = 1
fix = [{{ on = "plate.bottom", u = ["x", "y"] }}, {{ on = "b.left", u = ["x", "y"] }}]
[[step]]
name = "then"
increments = 1
{step}
[solver]
{method}
"#
    );
    let (_, problem, findings) = open(&deck);
    assert_eq!(problem.is_none(), findings.errors() > 0);
    flat(&findings.render("deck.toml", &deck, false))
}

const TIED: &str = "[[tie]]\nsurface = \"b.bottom\"\nto = \"plate.top\"";
const HELD: &str = "fix = [{ on = \"plate.bottom\", u = [\"x\", \"y\"] }, { on = \"b.left\", u = [\"x\", \"y\"] }]";
const PLATE: &str = "fix = [{ on = \"plate.bottom\", u = [\"x\", \"y\"] }]";

const INVERTING: [&str; 3] = [
    "contact = \"uzawa\"",
    "contact = \"gauss-seidel\"",
    "nesting = \"outside\"",
];

#[test]
fn what_needs_bodies_held_by_displacements_says_so() {
    let touching = "[[contact]]\nsurface = \"b.bottom\"\nagainst = \"plate.top\"\nfriction = 0.2";
    let slippery = touching.replace("0.2", "0");
    let along =
        "fix = [{ on = \"plate.bottom\", u = [\"x\", \"y\"] }, { on = \"b.left\", u = [\"x\"] }]";
    let pressed = format!("{HELD}\ntools = [{{ name = \"die\", force = [0, -100] }}]");
    let turned = format!("{HELD}\ntools = [{{ name = \"die\", moment = 0 }}]");
    let driven = "the tool \"die\" is driven, and nothing but its contacts resists that";
    for (joint, step, problem) in [
        (
            TIED,
            PLATE,
            "ties alone stop the translation along x of the body \"b\"",
        ),
        (
            touching,
            PLATE,
            "friction alone stops the translation along x of the body \"b\"",
        ),
        (
            &slippery,
            along,
            "contacts alone stop the translation along y of the body \"b\"",
        ),
        (TIED, &pressed, driven),
        (TIED, &turned, driven),
    ] {
        for method in INVERTING {
            let said = said(joint, step, method);
            for word in [
                &format!("error: {method} in step \"then\": {problem}"),
                "needs the inverse of a stiffness",
                "`contact = \"exact\"`",
            ] {
                assert!(said.contains(word), "{word:?} in {said}");
            }
        }
        for method in [
            "contact = \"exact\"",
            "contact = { penetration = 1e-4 }",
            "",
        ] {
            let said = said(joint, step, method);
            assert!(!said.contains("error:"), "{method}: {said}");
        }
    }
}

#[test]
fn what_displacements_hold_goes_with_every_method() {
    let moved = format!("{HELD}\ntools = [{{ name = \"die\", move = [0.01, -0.01] }}]");
    for method in INVERTING {
        for step in [HELD, &moved] {
            let said = said(TIED, step, method);
            assert!(!said.contains("error:"), "{said}");
        }
    }
}
