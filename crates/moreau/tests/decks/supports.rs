//! What stops the rigid motions of every body.

use super::{DECK, flat};
use moreau::deck::{Body, Problem, open};
use moreau::driver::{RigidMotion, Stopper};

const DRAGGED: &str = include_str!("../../../../docs/examples/block-dragged-on-block.toml");

/// Bodies of a deck.
fn bodies(text: &str) -> Vec<Body> {
    match open(text) {
        (_, Some(Problem::Plane(setup)), _) => setup.bodies,
        (_, Some(Problem::Solid(setup)), _) => setup.bodies,
        (_, None, findings) => panic!("{}", findings.render("deck.toml", text, false)),
    }
}

/// A motion in words, what stops it, with the groups and contacts that resist it.
type Stopped<'a> = (&'a str, Stopper, Vec<&'a str>, Vec<usize>);

fn stopped(motion: &RigidMotion) -> Stopped<'_> {
    let groups = motion.groups.iter().map(|g| g.0.as_str()).collect();
    let stopper = motion.stopper.expect("stopped");
    (&motion.name, stopper, groups, motion.contacts.clone())
}

fn stoppers(body: &Body, step: usize) -> Vec<Stopped<'_>> {
    body.motions[step].iter().map(stopped).collect()
}

/// What is said of a deck that has a free body, on one line.
fn refused(text: &str) -> String {
    let (_, problem, findings) = open(text);
    let out = findings.render("deck.toml", text, false);
    assert!(problem.is_none(), "{out}");
    flat(&out)
}

use Stopper::{Contact, Displacement, Friction};

#[test]
fn in_the_plane() {
    // Only the foundation holds the block up, once the punch is gone.
    let head = DECK.split("[expect]").next().expect("a deck");
    let fix = "fix = [{ on = \"block.left\", u = [\"x\"] }]";
    let released = format!("{head}[[step]]\nname = \"release\"\nincrements = 1\n{fix}\n");
    let body = &bodies(&released)[0];
    let [x, y, turn] = [
        "translation along x",
        "translation along y",
        "rotation in the plane",
    ];
    let (left, punch) = (vec!["block.left"], vec!["punch"]);
    assert_eq!(
        stoppers(body, 0),
        [
            (x, Displacement, left.clone(), vec![]),
            (y, Displacement, punch.clone(), vec![]),
            // The punch has no mean lever, but one for each node.
            (turn, Displacement, vec!["block.left", "punch"], vec![]),
        ]
    );
    assert_eq!(
        stoppers(body, 1),
        [
            (x, Displacement, left.clone(), vec![]),
            (y, Contact, vec![], vec![0]),
            (turn, Displacement, left, vec![]),
        ]
    );
    // Without the symmetry plane friction holds the block, and nothing does without friction.
    let loose = released.replace(fix, "");
    let body = &bodies(&loose)[0];
    assert_eq!(stoppers(body, 1)[0], (x, Friction, vec![], vec![0]));
    assert_eq!(stoppers(body, 1)[2].1, Contact);
    let out = refused(&loose.replace("friction = 0.1", "friction = 0"));
    for step in ["press", "release"] {
        let said = format!("step \"{step}\": the body \"block\" is free to move");
        assert!(out.contains(&said), "{said} in {out}");
    }
    assert!(
        out.contains("nothing resists translation along x."),
        "{out}"
    );
}

/// A node held in both directions is a hinge: what is left is the turn about it, whatever the point
/// that modes are written about.
#[test]
fn a_hinge_leaves_the_rotation() {
    let head = DECK.split("[expect]").next().expect("a deck");
    let hinge = head
        .replace(
            "[[material]]",
            "[[mesh.group]]\nname = \"pin\"\non = \"block\"\nnearest = [0, 0]\n[[material]]",
        )
        .replace("\"block.left\", u = [\"x\"]", "\"pin\", u = [\"x\", \"y\"]")
        .replace(
            "move = [{ on = \"punch\", u = { y = -0.2 } }]",
            "load = [{ on = \"punch\", pressure = 1 }]",
        );
    let body = &bodies(&hinge)[0];
    let found: Vec<Stopper> = stoppers(body, 0).iter().map(|s| s.1).collect();
    assert_eq!(found, [Displacement, Displacement, Contact]);
    let (head, rest) = hinge.split_once("[[tool]]").expect("a tool");
    let step = rest.split_once("[[step]]").expect("a step").1;
    let out = refused(&format!(
        "{head}[[step]]{}",
        step.split("[expect]").next().expect("a deck")
    ));
    assert!(out.contains("with rotation in the plane"), "{out}");
}

/// All that is free of a body is named at once.
#[test]
fn a_free_body_is_free_in_every_way() {
    let head = DECK.split("[[tool]]").next().expect("a deck");
    let step =
        "[[step]]\nname = \"fly\"\nincrements = 1\nload = [{ on = \"punch\", pressure = 1 }]\n";
    let out = refused(&format!("{head}{step}"));
    let all = "translation along x, translation along y, rotation in the plane";
    assert!(out.contains(all), "{out}");
    // A ring can move along its axis only.
    let ring = format!("{head}{step}").replace("plane-strain", "axisymmetric");
    let out = refused(&ring);
    assert!(
        out.contains("nothing resists translation along y."),
        "{out}"
    );
    let held = ring.replace(
        "load =",
        "fix = [{ on = \"block.bottom\", u = [\"y\"] }]\nload =",
    );
    let body = &bodies(&held)[0];
    let along = (
        "translation along y",
        Displacement,
        vec!["block.bottom"],
        vec![],
    );
    assert_eq!(stoppers(body, 0), [along]);
}

/// One body holds the other: what stops the pad is the contact, as the base is held.
#[test]
fn two_bodies() {
    let all = bodies(DRAGGED);
    let of = |name: &str| all.iter().find(|b| b.name == name).expect("a body");
    let (base, pad) = (stoppers(of("base"), 0), stoppers(of("pad"), 0));
    assert!(
        base.iter()
            .all(|s| s.1 == Displacement && s.2 == ["base.bottom"])
    );
    assert_eq!(pad[0].1, Displacement);
    assert_eq!(
        (pad[1].1, &pad[1].2, &pad[1].3),
        (Contact, &vec![], &vec![0])
    );
    // Held along x at one end, it could turn; the edge of that end stops it.
    assert_eq!((pad[2].1, &pad[2].2), (Displacement, &vec!["pad.right"]));

    // Nothing holds the base: both go up and down together, and each is told once.
    let loose = DRAGGED.replace(
        "{ on = \"base.bottom\", u = [\"x\", \"y\"] }",
        "{ on = \"base.bottom\", u = [\"x\"] }",
    );
    let out = refused(loose.split("[expect]").next().expect("a deck"));
    assert_eq!(
        out.matches("nothing resists translation along y.").count(),
        2,
        "{out}"
    );
}

#[test]
fn in_space() {
    let cube = r#"
units = "mm-N-MPa"
analysis = "solid"
mesh.block = [{ name = "b", element = "hex8", x = [0, 4], y = [0, 4], z = [0, 4], cells = [2, 2, 2] }]
material = [{ on = "b", young = 1000.0, poisson = 0.3 }]
tool = [{ name = "floor", plane = { point = [0, 0, 0], normal = [0, 1, 0] } }]
contact = [{ surface = "b.bottom", against = "floor", friction = 0.3 }]
[[step]]
name = "press"
increments = 1
fix = [{ on = "b.left", u = ["x"] }]
load = [{ on = "b.top", pressure = 1 }]
"#;
    let body = &bodies(cube)[0];
    let found: Vec<_> = stoppers(body, 0).into_iter().map(|s| (s.0, s.1)).collect();
    // The side held along x lets the cube slide in its plane and turn about x alone.
    let expected = [
        ("translation along x", Displacement),
        ("translation along y", Contact),
        ("translation along z", Friction),
        ("rotation about x", Contact),
        ("rotation about y", Displacement),
        ("rotation about z", Displacement),
    ];
    assert_eq!(found, expected);
    let out = refused(&cube.replace("friction = 0.3", "friction = 0"));
    assert!(
        out.contains("nothing resists translation along z."),
        "{out}"
    );
}
