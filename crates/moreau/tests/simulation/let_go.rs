//! Supports that a step leaves out: what they bore goes over the step, and is told as long as it acts.

use super::*;

/// A bar that is pulled, and let go in four increments.
const BAR: &str = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 10], y = [0, 2], cells = [5, 2] }]
mesh.group = [
    { name = "o", on = "b.left", nearest = [0, 0] },
    { name = "corner", on = "b.right", nearest = [10, 2] },
]
material = [{ on = "b", young = 2e5, poisson = 0.3 }]
output.probes = ["b.top"]
[[step]]
name = "pull"
increments = 1
fix = [{ on = "b.left", u = ["x"] }, { on = "o", u = ["y"] }]
move = [{ on = "b.right", u = { x = 0.01 } }]
[[step]]
name = "let"
increments = 4
fix = [{ on = "b.left", u = ["x"] }, { on = "o", u = ["y"] }]
"#;

/// Forces of these groups along x in every increment.
fn forces<const N: usize>(simulation: &Simulation, groups: [&str; N]) -> Vec<[f64; N]> {
    let columns = groups.map(|g| simulation.history().numbers(&format!("force.{g}.x")));
    let rows = 0..simulation.history().rows();
    rows.map(|k| columns.each_ref().map(|c| c[k])).collect()
}

#[test]
fn a_support_that_is_let_go_balances_the_others_until_the_end_of_the_step() {
    let freed = finish(simulation(BAR));
    let found = forces(&freed, ["b.left", "b.right"]);
    let full = found[0][1];
    assert!(full > 400.0);
    for ([left, right], share) in found.iter().zip([1.0, 0.75, 0.5, 0.25, 0.0]) {
        assert!((left + right).abs() < 1e-9 * full, "{found:?}");
        assert!((right - share * full).abs() < 1e-9 * full, "{found:?}");
    }
    // The probe has one end of the bar held, and the other let go.
    let top = forces(&freed, ["b.top"]);
    assert!(top.iter().all(|[f]| f.abs() < 1e-9 * full), "{top:?}");
    let end = freed.outcome().values;
    let right = end.iter().find(|(name, _)| name == "force.b.right.x");
    assert!(right.expect("a value").1.abs() < 1e-9 * full);
}

/// A node that a group of its own goes on holding is not let go, and what goes across the step is not listed.
#[test]
fn what_another_group_holds_is_its_own() {
    let across = "{ on = \"o\", u = [\"y\"] }, { on = \"corner\", u = [\"y\"] }";
    let bar = BAR.replacen("{ on = \"o\", u = [\"y\"] }", across, 1);
    let held = format!("{bar}move = [{{ on = \"corner\", u = {{ x = 0.01 }} }}]\n");
    let held = finish(simulation(&held));
    let found = forces(&held, ["b.left", "b.right", "corner"]);
    for [left, right, corner] in &found[1..] {
        assert!(
            (left + right + corner).abs() < 1e-9 * left.abs(),
            "{found:?}"
        );
    }
    let along_y = |group| held.history().numbers(&format!("force.{group}.y"));
    assert!(along_y("corner")[1].abs() > 0.1);
    assert!(along_y("b.right").iter().all(|f| *f == 0.0));
}

/// What is left of it when a step is given up goes with the next, also from a state that was saved.
#[test]
fn what_is_left_of_it_goes_with_the_step_that_replaces_this_one() {
    let mut first = simulation(BAR);
    (0..3).for_each(|_| assert!(advance(&mut first)));
    let mut second = simulation(BAR);
    second.restore(&first.save()).expect("its own state");
    let on = "name = \"on\"\nincrements = 2\nfix = [{ on = \"b.left\", u = [\"x\"] }, { on = \"o\", u = [\"y\"] }]";
    for freed in [&mut first, &mut second] {
        freed.replace_step(on).expect("a step");
        while advance(freed) {}
        let found = forces(freed, ["b.left", "b.right"]);
        let full = found[0][1];
        for ([left, right], share) in found.iter().zip([1.0, 0.75, 0.5, 0.25, 0.0]) {
            assert!((left + right).abs() < 1e-9 * full, "{found:?}");
            assert!((right - share * full).abs() < 1e-9 * full, "{found:?}");
        }
    }
    assert_eq!(bits(&first), bits(&second));
}

/// A load factor that rounds at its limit takes no time back.
#[test]
fn time_does_not_run_backwards_at_a_limit() {
    let dragged = r#"
units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 10], y = [0, 4], cells = [6, 3] }]
material = [{ on = "b", young = 210e3, poisson = 0.3, yield-stress = 300 }]
tool = [{ name = "die", plane = { point = [0, 4], normal = [0, -1] } }]
contact = [{ surface = "b.top", against = "die", friction = 0.1 }]
[[step]]
name = "press"
increments = 2
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "die", force = [0, -1000] }]
[[step]]
name = "drag"
increments = 2
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "die", force = [50, -1000] }]
[[step]]
name = "farther"
increments = 2
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "die", force = [99, -1000] }]
[[step]]
name = "away"
increments = 2
fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "die", force = [101, -1000] }]
"#;
    let mut dragged = simulation(dragged);
    while let Ok(Some(_)) = dragged.advance(&mut |_, _| ControlFlow::Continue(())) {}
    let times = dragged.history().numbers("time");
    assert!(times.len() > 7, "{times:?}");
    assert!(times.windows(2).all(|t| t[0] <= t[1]), "{times:?}");
}

/// A pad between a base and a roll that lifts, while a pressure on its side goes: what that has of no potential is solved for
/// step by step beside the surfaces that follow, and the step that is taken is the last one, which has all of it. With one from
/// before, the pad that nothing holds but its own stiffness kept an imbalance of which no iteration took anything away.
#[test]
fn a_pad_under_a_pressure_is_let_go_in_few_iterations() {
    let let_go = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "base"
element = "quad8"
x = [0, 20]
y = [-8, 0]
cells = [10, 4]
[[mesh.block]]
name = "pad"
element = "quad8"
x = [0, 9]
y = [0, 5]
cells = [7, 3]
[[material]]
on = ["base", "pad"]
young = 100e3
poisson = 0.33
[[tool]]
name = "die"
cylinder = { center = [0, 35], radius = 30 }
[[contact]]
surface = "pad.bottom"
against = "base.top"
friction = 0
[[contact]]
surface = "pad.top"
against = "die"
friction = 0.1
[[step]]
name = "press"
increments = 5
fix = [{ on = "base.bottom", u = ["x", "y"] }, { on = "base.left", u = ["x"] }, { on = "pad.left", u = ["x"] }]
load = [{ on = "pad.right", pressure = 50 }]
tools = [{ name = "die", move = [0, -0.05] }]
[[step]]
name = "lift"
increments = 6
fix = [{ on = "base.bottom", u = ["x", "y"] }, { on = "base.left", u = ["x"] }, { on = "pad.left", u = ["x"] }]
tools = [{ name = "die", move = [0, 0.5] }]
[output]
vtu = "none"
"#,
    ));
    let history = let_go.history();
    assert_eq!(history.numbers("cuts").iter().sum::<f64>(), 0.0);
    let iterations = history.numbers("newton_iterations");
    assert!(iterations.iter().all(|&n| n <= 10.0), "{iterations:?}");
    let force = history.numbers("force.die.y");
    assert!(
        force[4] < -100.0 && force[10..].iter().all(|&f| f == 0.0),
        "{force:?}"
    );
    let stored = history.numbers("elastic_energy");
    let last = stored.last().expect("an increment");
    assert!(*last < 1e-12 * stored[4], "{stored:?}");
}
