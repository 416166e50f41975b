//! What an engineer is told where a run ends, or says nothing of the part: the cause, the place and the size.

use super::*;

/// A strip under a die, as a profile, that comes down in the first step and draws it to the right in the second.
fn drawn(points: &str, radii: &str, down: f64, held: bool) -> Simulation {
    let bottom = r#"{ on = "b.bottom", u = ["y"] }"#;
    let [close, draw] = match held {
        true => [format!(", {bottom}"), format!("fix = [{bottom}]")],
        false => Default::default(),
    };
    simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 24]
y = [0, 2]
cells = [18, 2]
[[material]]
on = "b"
young = 70000.0
poisson = 0.33
yield-stress = 100.0
hardening = {{ linear = 100.0 }}
[[tool]]
name = "die"
profile = {{ points = {points}, radii = {radii} }}
[[contact]]
surface = "b.top"
against = "die"
friction = 0.05
[[step]]
name = "close"
increments = 4
fix = [{{ on = "b.right", u = ["x"] }}{close}]
tools = [{{ name = "die", move = [0, -{down}] }}]
[[step]]
name = "draw"
increments = 2
{draw}
move = [{{ on = "b.right", u = {{ x = 0.5 }} }}]
tools = [{{ name = "die", move = [0, -{down}] }}]
"#
    ))
}

fn told(simulation: &Simulation, what: &str) -> bool {
    let warnings = &simulation.outcome().warnings;
    warnings.iter().any(|w| w.contains(what))
}

/// What overlaps does so in an increment of any length: none is tried after the first.
#[test]
fn a_die_that_begins_within_the_body_is_told_at_once() {
    let die = "[[24, 5.4], [20, 1.4], [18, 1.4], [1, 4.4]]";
    let mut begun = drawn(die, "[1, 4]", 0.0, true);
    let mut cuts = 0;
    let error = loop {
        let outcome = begun.advance(&mut |_, iteration| {
            cuts = cuts.max(iteration.cuts);
            ControlFlow::Continue(())
        });
        match outcome {
            Ok(next) => assert!(next.is_some(), "no balance"),
            Err(error) => break error.to_string(),
        }
    };
    assert_eq!(cuts, 0);
    let place =
        "\"b.top\" and \"die\" are within each other before anything moves, by 0.600 mm at node";
    assert!(
        error.contains(place) && !error.contains("limit load") && !error.contains("were cut"),
        "{error}"
    );
    // 0.6 mm above 1.4: the corners and the middles of facets from 17.5 to 20.6, of 2/3 mm each.
    assert!(error.contains("9 nodes in all"), "{error}");
}

/// Without its plane of symmetry a strip is moved down by the die, and nothing else happens.
#[test]
fn a_body_that_is_pushed_and_not_held_is_told_by_its_name() {
    let die = "[[24, 6], [20, 2], [18, 2], [1, 5]]";
    let pushed = finish(drawn(die, "[1, 4]", 0.4, false));
    let words = "pushed and not held: nothing resists the translation along y of the body \"b\"";
    assert!(told(&pushed, words), "{:?}", pushed.outcome().warnings);
    assert!(!told(&pushed, "neither conditions"));
    let held = finish(drawn(die, "[1, 4]", 0.4, true));
    assert!(!told(&held, "not held"), "{:?}", held.outcome().warnings);
}

/// The same die, drawn on to where the strip is no longer touched, and ending where it still is.
#[test]
fn a_node_that_bears_beyond_the_last_point_of_a_profile_is_told() {
    let ends = |last: &str| {
        finish(drawn(
            &format!("[[24, 6], [20, 2], [18, 2], {last}]"),
            "[1, 0]",
            0.3,
            true,
        ))
    };
    let (long, short) = (ends("[1, 5]"), ends("[17.5, 2.0882352941176470]"));
    let loads = [&long, &short].map(|s| s.history().numbers("force.die.y"));
    for (long, short) in loads[0].iter().zip(&loads[1]) {
        assert!((long - short).abs() < 1e-6 * loads[0][0].abs(), "{loads:?}");
    }
    assert!(!told(&long, "beyond the"), "{:?}", long.outcome().warnings);
    let warnings = &short.outcome().warnings;
    let told: Vec<&String> = warnings
        .iter()
        .filter(|w| w.contains("beyond the last of its points"))
        .collect();
    assert_eq!(told.len(), 1, "{warnings:?}");
    assert!(
        told[0].starts_with("\"b.top\" bears on \"die\""),
        "{told:?}"
    );
}

/// A billet without friction is upset evenly, whatever the increments; a single one of 92 % has no tangent to judge by.
#[test]
fn an_increment_that_strains_far_is_told_as_that_and_not_as_unstable() {
    let upset = |increments: usize| {
        finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "axisymmetric"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 5]
y = [0, 6]
cells = [4, 4]
[[material]]
on = "b"
young = 70000.0
poisson = 0.33
yield-stress = 100.0
hardening = {{ table = [[0, 100], [0.1, 150], [0.3, 200], [1, 260]] }}
[[tool]]
name = "p"
plane = {{ point = [0, 6], normal = [0, -1] }}
[[contact]]
surface = "b.top"
against = "p"
friction = 0
[[step]]
name = "s"
increments = {increments}
fix = [{{ on = "b.bottom", u = ["y"] }}]
tools = [{{ name = "p", move = [0, -3.6] }}]
"#
        )))
    };
    for (increments, far) in [(1, true), (20, false)] {
        let upset = upset(increments);
        assert!(!told(&upset, "unstable"), "{:?}", upset.outcome().warnings);
        assert_eq!(told(&upset, "large for one increment"), far);
    }
}

/// A roll that was dragged without turning has all the friction there is as its moment; nothing decides how far it turns when that
/// is let go while it moves on, and a step in which it is let go at rest does.
#[test]
fn a_roll_whose_moment_is_all_of_its_friction_is_told_as_that() {
    let rolled = |between: &str| {
        simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 18]
y = [0, 2]
cells = [18, 1]
[[material]]
on = "b"
young = 70000.0
poisson = 0.33
yield-stress = 100.0
kinematic = [{{ modulus = 5000, recall = 50 }}]
[[tool]]
name = "ball"
cylinder = {{ center = [6, 4], radius = 2 }}
[[contact]]
surface = "b.top"
against = "ball"
friction = 0.15
[[step]]
name = "drag"
increments = 6
fix = [{{ on = "b.left", u = ["x"] }}, {{ on = "b.bottom", u = ["y"] }}]
tools = [{{ name = "ball", move = [1.5, -0.1] }}]
{between}
[[step]]
name = "roll"
increments = {{ start = 0.08, min = 0.01, max = 0.08 }}
fix = [{{ on = "b.left", u = ["x"] }}, {{ on = "b.bottom", u = ["y"] }}]
tools = [{{ name = "ball", move = [4.5, -0.1], moment = 0 }}]
"#
        ))
    };
    let mut spins = rolled("");
    let error = loop {
        match spins.advance(&mut |_, _| ControlFlow::Continue(())) {
            Ok(next) => assert!(next.is_some(), "nothing decides how far it turns"),
            Err(error) => break error.to_string(),
        }
    };
    let words = "friction alone holds tool \"ball\" against its moment, and carries hardly more";
    assert!(error.starts_with(words), "{error}");
    let rest = r#"[[step]]
name = "rest"
increments = 2
fix = [{ on = "b.left", u = ["x"] }, { on = "b.bottom", u = ["y"] }]
tools = [{ name = "ball", move = [1.5, -0.1], moment = 0 }]"#;
    finish(rolled(rest));
}
