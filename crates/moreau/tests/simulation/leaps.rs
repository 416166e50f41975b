//! What tools move under large strains stays near where it was as long as it may; else it leaps, and is said to.

use super::*;

/// A block that nothing but the friction under a roll holds along it, pressed in increments that are short or long: there is
/// another equilibrium, in which the roll has pushed it out.
#[test]
fn what_a_roll_holds_is_not_pushed_out_in_longer_increments() {
    let press = |increments: usize| {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "a"
element = "quad4"
x = [0, 8]
y = [0, 2]
cells = [4, 1]
[[material]]
on = "a"
young = 70000
poisson = 0.3
[[tool]]
name = "roll"
cylinder = {{ center = [6.2, 8.01], radius = 6 }}
[[contact]]
surface = "a.top"
against = "roll"
friction = 0.1
[[step]]
name = "press"
increments = {increments}
fix = [{{ on = "a.bottom", u = ["y"] }}]
tools = [{{ name = "roll", move = [0, -0.055] }}]
"#
        )));
        let leaps = |said: &String| said.contains("leaps");
        assert!(!pressed.outcome().warnings.iter().any(leaps));
        let forces = pressed.history().numbers("force.roll.y");
        forces[forces.len() - 1]
    };
    let (long, short) = (press(2), press(64));
    assert!((long / short - 1.0).abs() < 0.05, "{long} {short}");
}

/// A strip whose end a pin bends down until it slips past: it springs back, straight, and the run says that it did.
#[test]
fn a_strip_that_is_flicked_leaps_and_is_at_rest() {
    let flicked = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "strip"
element = "quad8"
x = [0, 40]
y = [0, 1]
cells = [20, 1]
[[material]]
on = "strip"
young = 1000
poisson = 0.3
[[tool]]
name = "pin"
cylinder = { center = [37, 4], radius = 3 }
[[contact]]
surface = ["strip.top", "strip.right"]
against = "pin"
friction = 0
[[step]]
name = "flick"
increments = 30
fix = [{ on = "strip.left", u = ["x", "y"] }]
tools = [{ name = "pin", move = [6, -9] }]
"#,
    ));
    let warnings = flicked.outcome().warnings;
    let said = warnings.iter().filter(|w| w.contains("the body leaps"));
    assert_eq!(said.count(), 1, "{warnings:?}");
    let strip = flicked.displacements();
    assert!(strip.iter().all(|u| u.abs() < 1e-9), "{strip:?}");
}

/// A roll that a force drives along a block over the most that this resists: the path falls until it has left the block, and
/// the run ends there, with the limit, and not with the way of a roll that nothing holds.
#[test]
fn a_path_ends_where_the_body_has_left_its_tool() {
    let mut driven = simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 14]
y = [0, 4]
cells = [20, 4]
[[material]]
on = "b"
young = 70e3
poisson = 0.33
yield-stress = 100.0
hardening = { linear = 500 }
[[tool]]
name = "i"
cylinder = { center = [4, 9], radius = 5 }
[[contact]]
surface = "b.top"
against = "i"
friction = 0.1
[[step]]
name = "press"
increments = 6
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "i", move = [0, -0.15] }]
[[step]]
name = "slide"
increments = 24
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "i", move = [0, -0.15], force = [250, 0] }]
"#,
    );
    let error = loop {
        if let Err(error) = driven.advance(&mut |_, _| ControlFlow::Continue(())) {
            break error;
        }
    };
    let StepError::Increment(IncrementError::SnapsAway { limit, .. }) = error else {
        panic!("{error}");
    };
    assert!((0.4..0.6).contains(&limit), "{limit}");
    // Beyond the limit no number of increments decides how long they are.
    let warnings = driven.outcome().warnings;
    let told = |w: &&String| w.contains("along \"b.top\" in increment");
    let asked = warnings.iter().find(told).expect("told");
    assert!(
        asked.contains("use smaller increments in that step"),
        "{asked}"
    );
    let way = driven.history().numbers("u.i.x");
    assert!(way.last().is_some_and(|x| x.abs() < 100.0), "{way:?}");
}
