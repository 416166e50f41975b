//! Values that vary within a step: the same path as steps of their own, whatever the increments.

use crate::steps::on_floor;
use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, ModelError, Settings, Step};
use moreau_laws::{Coulomb, VonMises};
use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

/// Pressed, let go in part, and pressed again further.
const ROWS: [[f64; 2]; 4] = [[0.0, 0.0], [0.3, 0.8], [0.5, 0.2], [1.0, 1.0]];

fn block() -> Driver<2> {
    on_floor([8, 3], 0.0, 0.2, Settings::default())
}

fn held(name: &str) -> Step<2> {
    Step::new(name).fix("block.left", &[Axis::X])
}

fn press(name: &str, share: f64) -> Step<2> {
    held(name).displace("punch", Axis::Y, -0.2 * share)
}

#[test]
fn a_value_over_time_is_the_path_of_several_steps() {
    let mut one = block();
    let reports = one
        .run(&press("press", 1.0).over(1, &ROWS), 10, |_, _| {})
        .expect("converges");
    let fractions: Vec<f64> = reports.iter().map(|r| r.fraction).collect();
    for row in &ROWS[1..] {
        let met = fractions.iter().any(|f| (f - row[0]).abs() < 1e-12);
        assert!(met, "{fractions:?}");
    }
    let mut several = block();
    let mut loads = Vec::new();
    for (k, increments) in [(1, 3), (2, 2), (3, 5)] {
        let step = press(&format!("part {k}"), ROWS[k][1]);
        several
            .run(&step, increments, |_, _| {})
            .expect("converges");
        loads.push(several.reaction("punch").expect("exists")[1]);
    }
    assert!(several.points().iter().any(|p| p.plastic_strain > 0.0));
    let load = one.reaction("punch").expect("exists")[1];
    assert!(
        (load / loads[2] - 1.0).abs() < 1e-9,
        "{load} against {loads:?}"
    );
    for (a, b) in one.points().iter().zip(&several.points()) {
        assert!((a.stress - b.stress).amax() < 1e-6);
    }
    // It is another path than straight on: friction and yielding remember.
    let mut straight = block();
    straight
        .run(&press("press", 1.0), 10, |_, _| {})
        .expect("converges");
    let other = straight.reaction("punch").expect("exists")[1];
    assert!((load / other - 1.0).abs() > 1e-6, "{load} and {other}");
}

/// A push down held while a tool that rubs goes there and back, each with its own amplitude.
#[test]
fn each_condition_has_its_own() {
    let model = || {
        let (x, y) = (uniform(0.0, 40.0, 8), uniform(0.0, 10.0, 2));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        Model::new(mesh, PlaneStrain::default())
            .material(
                "block",
                VonMises::new(210e3, 0.3, 300.0).expect("valid"),
                Integration::Reduced,
            )
            .and_then(|m| m.tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid")))
            .and_then(|m| m.contact("block.bottom", "floor", Coulomb::new(0.3).expect("valid")))
            .expect("valid")
    };
    let driver = || Driver::new(model(), Settings::default()).expect("valid");
    let step = |name: &str, pressure: f64, slide: f64| {
        Step::new(name)
            .pressure("block.top", 100.0 * pressure)
            .tool("floor", [0.02 * slide, 0.0])
    };
    let both = Step::new("both")
        .pressure("block.top", 100.0)
        .over(1, &[[0.0, 0.0], [0.4, 1.0], [1.0, 1.0]])
        .tool("floor", [0.02, 0.0])
        .over(1, &[[0.0, 0.0], [0.4, 0.0], [0.7, 1.0], [1.0, -1.0]]);
    let mut one = driver();
    one.run(&both, 10, |_, _| {}).expect("converges");
    let mut several = driver();
    for (name, pressure, slide, increments) in
        [("a", 1.0, 0.0, 4), ("b", 1.0, 1.0, 3), ("c", 1.0, -1.0, 3)]
    {
        several
            .run(&step(name, pressure, slide), increments, |_, _| {})
            .expect("converges");
    }
    let forces = [&one, &several].map(|d| d.tool_force("floor").expect("exists"));
    assert!((forces[0][1] - 4000.0).abs() < 1e-6, "{forces:?}");
    assert!(
        (forces[0] - forces[1]).amax() < 1e-8 * forces[1].amax(),
        "{forces:?}"
    );
}

/// Two loads of a block that is held like a drawer: at the end of every increment each is what its own rows say then,
/// between them too, and from a share on that is not none.
#[test]
fn every_load_is_that_of_its_own_rows() {
    let lines = uniform(0.0, 10.0, 2);
    let mesh = block2("block", CellKind::Quad8, &lines, &lines).expect("valid");
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    let model =
        Model::new(mesh, PlaneStrain::default()).material("block", steel, Integration::Reduced);
    let mut driver = Driver::new(model.expect("valid"), Settings::default()).expect("valid");
    let held = |name: &str| {
        Step::new(name)
            .fix("block.left", &[Axis::X])
            .fix("block.bottom", &[Axis::Y])
    };
    driver
        .run(&held("start").pressure("block.top", 10.0), 1, |_, _| {})
        .expect("linear");
    let both = held("both")
        .pressure("block.top", 10.0)
        .over(1, &[[0.0, 1.0], [0.5, 2.0], [1.0, 0.5]])
        .traction("block.right", [5.0, 0.0])
        .over(1, &[[0.0, 0.0], [0.25, 4.0], [0.75, -2.0], [1.0, 1.0]]);
    let expected = [
        [1.25, 2.0],
        [1.5, 4.0],
        [1.75, 2.5],
        [2.0, 1.0],
        [1.625, -0.5],
        [1.25, -2.0],
        [0.875, -0.5],
        [0.5, 1.0],
    ];
    let mut found = Vec::new();
    driver
        .run(&both, 8, |driver, _| {
            let force = |group: &str| driver.reaction(group).expect("exists");
            found.push([
                force("block.bottom")[1] / 100.0,
                -force("block.left")[0] / 50.0,
            ]);
        })
        .expect("linear");
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(&expected) {
        let off = (found[0] - expected[0])
            .abs()
            .max((found[1] - expected[1]).abs());
        assert!(off < 1e-9, "{found:?} {expected:?}");
    }
}

#[test]
fn rows_between_the_ends_of_increments_are_met() {
    let mut driver = block();
    let reports = driver
        .run(&press("press", 1.0).over(1, &ROWS), 4, |_, _| {})
        .expect("converges");
    let fractions: Vec<f64> = reports.iter().map(|r| r.fraction).collect();
    assert_eq!(fractions, [0.25, 0.3, 0.5, 0.75, 1.0]);
}

#[test]
fn a_straight_amplitude_changes_no_bit() {
    let run = |step: Step<2>| {
        let mut driver = block();
        driver.run(&step, 4, |_, _| {}).expect("converges");
        driver.displacements().to_vec()
    };
    let rows = [[0.0, 0.0], [1.0, 1.0]];
    assert_eq!(
        run(press("press", 1.0)),
        run(press("press", 1.0).over(1, &rows))
    );
    // And from what the step before left.
    let twice = |second: Step<2>| {
        let mut driver = block();
        for step in [press("press", 0.5), second] {
            driver.run(&step, 2, |_, _| {}).expect("converges");
        }
        driver.displacements().to_vec()
    };
    let from_half = press("more", 1.0).over(1, &[[0.0, 0.5], [1.0, 1.0]]);
    assert_eq!(twice(press("more", 1.0)), twice(from_half));
}

#[test]
fn what_is_no_amplitude_is_refused() {
    for rows in [
        &[][..],
        &[[0.0, 1.0]],
        &[[0.1, 0.0], [1.0, 1.0]],
        &[[0.0, 0.0], [0.9, 1.0]],
        &[[0.0, 0.0], [0.6, 1.0], [0.4, 0.5], [1.0, 1.0]],
        &[[0.0, 0.0], [0.5, 1.0], [0.5, 0.0], [1.0, 1.0]],
        &[[0.0, 0.0], [f64::NAN, 1.0], [1.0, 1.0]],
        &[[0.0, f64::INFINITY], [1.0, 1.0]],
    ] {
        let refused = block().loading(&press("press", 1.0).over(1, rows));
        let message = match refused {
            Err(error @ ModelError::OutOfRange { .. }) => error.to_string(),
            other => panic!("{rows:?}: {other:?}"),
        };
        assert!(message.contains("press"), "{message}");
    }
}
