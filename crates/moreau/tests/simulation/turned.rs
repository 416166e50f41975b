//! Tools that turn, under small strains: where they have turned back, and by how much in an increment.

use super::*;

/// A cube beside the axis of a disc that is pressed on it and turned to some angles [°], each in so many increments.
fn rubbed(friction: f64, angles: &[(f64, usize)]) -> Simulation {
    let mut deck = format!(
        r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "b"
element = "hex8"
x = [4, 5]
y = [-0.5, 0.5]
z = [0, 1]
cells = [1, 1, 1]
[[material]]
on = "b"
young = 1000.0
poisson = 0.3
[[tool]]
name = "disc"
plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}
[[contact]]
surface = "b.back"
against = "disc"
friction = {friction}
[[step]]
name = "press"
increments = 1
fix = [{{ on = "b.front", u = ["x", "y"] }}]
load = [{{ on = "b.front", pressure = 2 }}]
"#
    );
    for (k, (angle, increments)) in angles.iter().enumerate() {
        deck += &format!(
            r#"[[step]]
name = "turn{k}"
increments = {increments}
fix = [{{ on = "b.front", u = ["x", "y"] }}]
load = [{{ on = "b.front", pressure = 2 }}]
tools = [{{ name = "disc", turn = {{ axis = [0, 0, 1], angle = {angle} }} }}]
"#
        );
    }
    finish(simulation(&deck))
}

fn moments(simulation: &Simulation) -> Vec<f64> {
    simulation.history().numbers("moment.disc.z")
}

fn doubts(simulation: &Simulation) -> Vec<String> {
    let mut told = simulation.outcome().warnings.clone();
    told.retain(|w| w.contains("directions that change"));
    told
}

/// What sticks on a disc that turns there and back to where it was is where it was.
#[test]
fn what_sticks_on_a_tool_that_has_turned_back_is_unloaded() {
    let turned = rubbed(30.0, &[(0.02, 2), (0.0, 1)]);
    let moments = moments(&turned);
    let stored = turned.history().numbers("elastic_energy");
    assert!(moments[2].abs() > 1.0, "{moments:?}");
    assert!(moments[3].abs() < 1e-6 * moments[2].abs(), "{moments:?}");
    let (before, after) = (stored[0], stored[3]);
    assert!((after - before).abs() < 1e-9 * before, "{stored:?}");
    let told = &turned.outcome().warnings;
    assert!(!told.iter().any(|w| w.contains("energ")), "{told:?}");
}

/// A disc that is turned back through where it was rubs as much on the way through.
#[test]
fn what_slips_dissipates_as_much_where_the_turn_is_none() {
    let turned = rubbed(0.3, &[(1.0, 2), (-1.0, 4)]);
    let dissipated = turned.history().numbers("friction_dissipation");
    let parts: Vec<f64> = dissipated.windows(2).map(|d| d[1] - d[0]).collect();
    for part in &parts[3..] {
        assert!((part / parts[3] - 1.0).abs() < 1e-3, "{parts:?}");
    }
    assert_eq!(turned.history().numbers("slip")[1..], [4.0; 6]);
}

/// A whole turn in one increment ends where it began, and has rubbed all the way: no more than a quarter is taken at once.
#[test]
fn a_whole_turn_in_one_increment_rubs() {
    let turned = rubbed(0.3, &[(360.0, 1)]);
    let history = turned.history();
    assert!(history.rows() >= 5, "{}", history.rows());
    // Friction is beside the slip by half of an increment's turn.
    let moment = moments(&turned).pop().expect("a row");
    let slow = moments(&rubbed(0.3, &[(360.0, 72)])).pop().expect("a row");
    assert!(
        (moment / slow).clamp(0.7, 1.0) == moment / slow,
        "{moment} {slow}"
    );
    assert_eq!(doubts(&turned).len(), 1);
}

/// Told from 10° on, which a disc that turns by 20° makes; with the increments that are told no more.
#[test]
fn slips_that_change_their_direction_are_told_with_what_would_do() {
    assert!(doubts(&rubbed(0.3, &[(57.0, 3)])).is_empty());
    let told = doubts(&rubbed(0.3, &[(63.0, 3)]));
    let increments: usize = told[0]
        .split("increments = ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next()?.parse().ok())
        .expect("a number");
    assert_eq!(increments, 7, "{told:?}");
    assert!(told[0].contains("turns by 21°"), "{told:?}");
    assert!(doubts(&rubbed(0.3, &[(63.0, increments)])).is_empty());
    // What sticks does not rub.
    assert!(doubts(&rubbed(1e3, &[(63.0, 3)])).is_empty());
}

/// What is rough sticks by rounding of its slips, which the law widens by the coefficient.
#[test]
fn what_is_as_rough_as_may_be_sticks_at_once() {
    let rough = rubbed(1e4, &[(0.02, 2)]);
    let iterations = rough.history().numbers("newton_iterations");
    assert!(iterations.iter().all(|&n| n <= 4.0), "{iterations:?}");
}

/// A turn that is rounding, left by one that was taken back, has no axis that a moment would have to keep.
#[test]
fn a_tool_that_has_turned_back_is_turned_on_about_any_axis() {
    let deck = r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "b"
element = "hex8"
x = [-0.5, 0.5]
y = [-0.5, 0.5]
z = [0, 1]
cells = [1, 1, 1]
[[material]]
on = "b"
young = 1000.0
poisson = 0.3
[[tool]]
name = "disc"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[contact]]
surface = "b.back"
against = "disc"
friction = 30.0
[[step]]
name = "press"
increments = 1
fix = [{ on = "b.front", u = ["x", "y"] }]
load = [{ on = "b.front", pressure = 2 }]
tools = [{ name = "disc", turn = { axis = [1, 0, 0], angle = ANGLE } }]
[[step]]
name = "turn"
increments = 1
fix = [{ on = "b.front", u = ["x", "y"] }]
load = [{ on = "b.front", pressure = 2 }]
tools = [{ name = "disc", moment = { axis = [0, 0, 1], value = 1 } }]
"#;
    let turned = finish(simulation(&deck.replace("ANGLE", "1e-13")));
    let turns = turned.history().numbers("turn.disc.z");
    assert!(turns[1] > 0.0, "{turns:?}");
    // One that is more than rounding has.
    let mut tilted = simulation(&deck.replace("ANGLE", "1e-3"));
    assert!(advance(&mut tilted));
    let outcome = tilted.advance(&mut |_, _| ControlFlow::Continue(()));
    let error = outcome.expect_err("another axis").to_string();
    assert!(error.contains("expected the same axis"), "{error}");
}
