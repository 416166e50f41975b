//! Tools that move far in one increment: contact is found on the side that they come from.

use moreau_contact::Ball;
use moreau_driver::{Axis, Driver, IncrementError, Increments, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic};
use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

/// A cylinder above a block, in the air.
fn above(height: f64, radius: f64) -> Driver<2> {
    let (x, y) = (uniform(0.0, 20.0, 20), uniform(0.0, 10.0, 5));
    let mesh = block2("b", CellKind::Quad8, &x, &y).expect("valid");
    let ball = Ball::new([10.0, 10.0 + height + radius], radius).expect("valid");
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "b",
            Elastic::new(1000.0, 0.3).expect("valid"),
            Integration::Reduced,
        )
        .and_then(|m| m.tool("t", ball))
        .and_then(|m| m.contact("b.top", "t", Coulomb::new(0.2).expect("valid")))
        .expect("valid");
    Driver::new(model, Settings::default()).expect("valid")
}

fn to(moved: [f64; 2]) -> Step<2> {
    Step::new("to")
        .fix("b.bottom", &[Axis::X, Axis::Y])
        .tool("t", moved)
}

fn down(by: f64) -> Step<2> {
    to([0.0, -by])
}

/// Into the block from above, not out of its far side: the increment is cut as often as it takes.
#[test]
fn a_tool_that_would_jump_through_a_surface_is_followed_instead() {
    let mut driver = above(100.0, 2.0);
    // To where its centre is below the surface: every node that it meets would be pushed down.
    let reports = driver.run(&down(102.5), 1, |_, _| {}).expect("converges");
    assert!(reports.iter().map(|r| r.cuts).sum::<usize>() > 0);
    let force = driver.tool_force("t").expect("exists");
    assert!(force[1] < 0.0, "{force}");
    for c in driver.contacts().iter().filter(|c| c.t[0] > 0.0) {
        assert!(driver.displacement(c.node)[1] < 0.0, "{c:?}");
    }
}

/// With increments that must not be as short, it is told which tool went through which node.
#[test]
fn a_passage_that_may_not_be_cut_is_told() {
    let mut driver = above(100.0, 2.0);
    let whole = Increments {
        start: 1.0,
        min: Some(0.6),
        max: 1.0,
    };
    match driver.run(&down(112.0), whole, |_, _| {}) {
        Err(IncrementError::Stopped { cause, .. }) => match *cause {
            IncrementError::Passage { tool, depth, .. } => {
                assert_eq!(tool, "t");
                assert!(depth > 0.02 && depth < 2.1, "{depth}");
            }
            other => panic!("{other}"),
        },
        other => panic!("{other:?}"),
    }
}

/// Through the air it may go as far as it likes.
#[test]
fn a_way_through_the_air_is_not_cut() {
    let mut driver = above(100.0, 2.0);
    let reports = driver.run(&down(100.2), 1, |_, _| {}).expect("converges");
    assert_eq!((reports.len(), reports[0].cuts), (1, 0));
}

/// From one side of a round tool to the other a surface that lies against it goes along the arc: the
/// chord of the way is in the tool, and nothing passes through it.
#[test]
fn a_tool_that_slides_along_the_surface_is_not_cut() {
    let mut driver = above(0.0, 10.0);
    driver.run(&down(0.5), 2, |_, _| {}).expect("converges");
    let reports = driver
        .run(&to([2.0, -0.5]), 1, |_, _| {})
        .expect("converges");
    assert_eq!((reports.len(), reports[0].cuts), (1, 0));
}
