//! Tools turned by a moment: the same states as tools that turn as told, free rolls, and what no friction carries.

use moreau_contact::{Ball, Plane, Polyline};
use moreau_driver::{
    Analysis, Axis, Driver, IncrementError, IncrementReport, Increments, Model, ModelError,
    Numbers, Saved, Seam, Settings, Step,
};
use moreau_laws::{Coulomb, Elastic, Isotropic, VonMises};
use moreau_mesh::{
    Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use nalgebra::Vector3;
use std::ops::ControlFlow;

const Z: [f64; 3] = [0.0, 0.0, 1.0];
const RADIUS: f64 = 20.0;
const BOTH: [Seam; 2] = [Seam::Condensed, Seam::Tied];

fn steel(yield_stress: f64) -> VonMises {
    let law = VonMises::new(210e3, 0.3, yield_stress).expect("valid");
    law.with_hardening(Isotropic::linear(2000.0).expect("valid"))
}

fn block() -> Mesh<2> {
    let (x, y) = (uniform(-12.0, 12.0, 24), uniform(0.0, 6.0, 4));
    block2("block", CellKind::Quad8, &x, &y).expect("valid")
}

/// A roll that touches a block.
fn rolled<H: Analysis<2>>(
    model: Model<2, H>,
    (yield_stress, mu): (f64, f64),
    seam: Seam,
) -> Driver<2> {
    let model = model
        .material("block", steel(yield_stress), Integration::Reduced)
        .and_then(|m| {
            m.tool(
                "roll",
                Ball::new([0.0, 6.0 + RADIUS], RADIUS).expect("valid"),
            )
        })
        .and_then(|m| m.contact("block.top", "roll", Coulomb::new(mu).expect("valid")))
        .expect("valid");
    let settings = Settings {
        seam,
        ..Settings::default()
    };
    Driver::new(model, settings).expect("valid")
}

fn small(mu: f64, seam: Seam) -> Driver<2> {
    rolled(Model::new(block(), PlaneStrain::default()), (1e6, mu), seam)
}

fn large(yield_stress: f64, mu: f64, seam: Seam) -> Driver<2> {
    let model = Model::with_large_strains(block(), PlaneStrain::default());
    rolled(model, (yield_stress, mu), seam)
}

fn held(name: &str, by: f64) -> Step<2> {
    Step::new(name)
        .displace("block.bottom", Axis::X, by)
        .fix("block.bottom", &[Axis::Y])
}

fn run<const D: usize>(
    driver: &mut Driver<D>,
    step: &Step<D>,
    count: usize,
) -> Vec<IncrementReport> {
    let all = driver.run(step, count, |_, _| {});
    all.unwrap_or_else(|error| panic!("{}: {error}", step.name()))
}

fn about<const D: usize>(driver: &Driver<D>, tool: &str, axis: [f64; 3]) -> [f64; 2] {
    let axis = Vector3::from(axis).normalize();
    let moment = driver.tool_moment(tool).expect("exists");
    let turn = driver.tool_turn(tool).expect("exists");
    [moment.dot(&axis), turn.dot(&axis)]
}

fn same<const D: usize>(a: &Driver<D>, b: &Driver<D>, tolerance: f64) {
    let nodes = 0..a.mesh().nodes().len();
    let size = nodes.clone().map(|n| a.displacement(n).norm());
    let size = size.fold(0.0, f64::max);
    for n in nodes {
        let apart = (a.displacement(n) - b.displacement(n)).norm();
        assert!(apart <= tolerance * size, "node {n}: {apart:e} of {size:e}");
    }
    let scale = a.contacts().iter().map(|c| c.t.norm()).fold(0.0, f64::max);
    for (a, b) in a.contacts().iter().zip(b.contacts()) {
        assert!(
            (a.force - b.force).norm() <= tolerance * scale,
            "{a:?} {b:?}"
        );
        assert_eq!(a.status, b.status);
    }
}

/// Turned as told, and by the moment that this took; the last reports of both.
fn by_turn_and_by_moment<const D: usize>(
    make: impl Fn() -> Driver<D>,
    (press, turn): (&Step<D>, &Step<D>),
    (axis, angle): ([f64; 3], f64),
) -> [IncrementReport; 2] {
    let mut told = make();
    run(&mut told, press, 2);
    let first = run(&mut told, &turn.clone().turn("roll", axis, angle), 1);
    let [moment, turned] = about(&told, "roll", axis);
    assert!((turned - angle).abs() <= 1e-14);
    let mut driven = make();
    run(&mut driven, press, 2);
    let second = run(&mut driven, &turn.clone().moment("roll", axis, moment), 1);
    let [carried, found] = about(&driven, "roll", axis);
    assert!((carried / moment - 1.0).abs() <= 1e-9, "{carried} {moment}");
    assert!((found / angle - 1.0).abs() <= 1e-9, "{found} {angle}");
    same(&told, &driven, 1e-8);
    // The same increment does the same work.
    let works = [&told, &driven].map(|d| d.energies().external_work);
    assert!((works[0] / works[1] - 1.0).abs() < 1e-9, "{works:?}");
    [first[0].clone(), second[0].clone()]
}

#[test]
fn a_given_moment_turns_a_roll_as_far_as_the_turn_that_takes_it() {
    for seam in BOTH {
        let press = held("press", 0.0).tool("roll", [0.0, -0.02]);
        let turn = held("turn", 0.0).tool("roll", [0.0, -0.02]);
        for angle in [1e-4, -1e-4] {
            by_turn_and_by_moment(|| small(0.3, seam), (&press, &turn), (Z, angle));
        }
        // Steel that flows, a roll that a force presses as well: the last steps of both are quadratic.
        let press = held("press", 0.0).push("roll", Axis::Y, -1500.0);
        let turn = held("turn", 0.0).push("roll", Axis::Y, -1800.0);
        let both = by_turn_and_by_moment(|| large(300.0, 0.4, seam), (&press, &turn), (Z, 2e-3));
        for report in both {
            let r = &report.residuals;
            // Quadratic in the end: of less than a newton a thousandth is left, and of that rounding.
            let near = r.iter().position(|r| *r < 5.0).expect("balance");
            assert!(r.len() <= near + 5 && r[near + 2] < 1e-6, "{seam:?} {r:?}");
            assert!(report.newton_iterations <= 12, "{r:?}");
        }
    }
}

/// A ball on a cube, about an axis that is none of the frame's.
#[test]
fn a_moment_about_any_axis_turns_a_tool_in_space() {
    let lines = uniform(-4.0, 4.0, 4);
    let make = |large: bool, seam: Seam| {
        let cube = block3(
            "block",
            CellKind::Hex8,
            &lines,
            &uniform(0.0, 4.0, 2),
            &lines,
        );
        let cube = cube.expect("valid");
        let model = match large {
            true => Model::with_large_strains(cube, Solid),
            false => Model::new(cube, Solid),
        };
        let ball = Ball::new([0.3, 4.0 + RADIUS, -0.2], RADIUS).expect("valid");
        let model = model
            .material("block", steel(1e6), Integration::Full)
            .and_then(|m| m.tool("roll", ball))
            .and_then(|m| m.contact("block.top", "roll", Coulomb::new(0.3).expect("valid")))
            .expect("valid");
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        Driver::new(model, settings).expect("valid")
    };
    let all = [Axis::X, Axis::Y, Axis::Z];
    let held = |name: &str| {
        Step::new(name)
            .fix("block.bottom", &all)
            .tool("roll", [0.0, -0.1, 0.0])
    };
    let axis = [-0.6, 0.5, -1.4];
    for (large, seam) in [
        (false, Seam::Condensed),
        (true, Seam::Condensed),
        (true, Seam::Tied),
    ] {
        by_turn_and_by_moment(
            || make(large, seam),
            (&held("press"), &held("turn")),
            (axis, 2e-4),
        );
    }
    let mut driver = make(true, Seam::Condensed);
    run(
        &mut driver,
        &held("press").turn("roll", [1.0, 0.0, 0.0], 1e-4),
        1,
    );
    let tilted = driver.loading(&held("tilt").moment("roll", axis, 1.0));
    assert!(
        matches!(tilted, Err(ModelError::TiltedAxle { .. })),
        "{tilted:?}"
    );
    // Back along the same axis, given the other way round.
    let [moment, _] = about(&driver, "roll", [1.0, 0.0, 0.0]);
    run(
        &mut driver,
        &held("half").moment("roll", [-2.0, 0.0, 0.0], -0.5 * moment),
        1,
    );
    let [half, turn] = about(&driver, "roll", [1.0, 0.0, 0.0]);
    assert!(
        (half / moment - 0.5).abs() < 1e-9 && turn < 1e-4,
        "{half} {moment} {turn}"
    );
}

/// A block moved below a roll that no moment holds: it rolls, as far as the block has moved, without slip, and nothing
/// drags the block back.
#[test]
fn a_free_roll_rolls_without_slip() {
    for seam in BOTH {
        let mut driver = large(1e6, 0.3, seam);
        let free = |name: &str, by: f64| {
            held(name, by)
                .push("roll", Axis::Y, -600.0)
                .moment("roll", Z, 0.0)
        };
        run(&mut driver, &free("press", 0.0), 2);
        assert!(about(&driver, "roll", Z)[1].abs() < 1e-12);
        let way = 5.0;
        let reports = run(&mut driver, &free("roll", way), 10);
        let [moment, turn] = about(&driver, "roll", Z);
        let force = driver.tool_force("roll").expect("exists");
        assert!(moment.abs() <= 1e-9 * 600.0 * RADIUS, "{moment:e}");
        assert!((force[1] + 600.0).abs() <= 1e-6);
        assert!(
            (turn * RADIUS / way - 1.0).abs() < 5e-3,
            "{}",
            turn * RADIUS / way
        );
        assert!(force[0].abs() < 5.0, "{force}");
        let friction = driver.energies().friction_dissipation;
        assert!(
            friction > -1e-9 && friction < 0.02 * 0.3 * 600.0 * way,
            "{friction}"
        );
        assert!(
            reports
                .iter()
                .all(|r| r.cuts == 0 && r.newton_iterations <= 12)
        );
        // Held from here on, it does not turn.
        run(
            &mut driver,
            &held("hold", way).push("roll", Axis::Y, -600.0),
            1,
        );
        assert_eq!(about(&driver, "roll", Z)[1].to_bits(), turn.to_bits());
    }
}

/// From a turn that was told to its moment nothing changes; half of it turns the roll back.
#[test]
fn a_roll_is_handed_over_from_turn_to_moment() {
    let mut driver = large(300.0, 0.3, Seam::Cheaper);
    let press = |name: &str| held(name, 0.0).tool("roll", [0.0, -0.05]);
    run(&mut driver, &press("press").turn("roll", Z, 5e-4), 3);
    let [moment, turn] = about(&driver, "roll", Z);
    run(&mut driver, &press("on").moment("roll", Z, moment), 2);
    let [on, at] = about(&driver, "roll", Z);
    assert!(
        (on / moment - 1.0).abs() < 1e-9 && (at - turn).abs() < 1e-12,
        "{on} {at}"
    );
    run(
        &mut driver,
        &press("back").moment("roll", Z, 0.5 * moment),
        2,
    );
    let [half, back] = about(&driver, "roll", Z);
    assert!(
        (half / moment - 0.5).abs() < 1e-9 && back < turn,
        "{half} {back}"
    );
}

#[test]
fn moments_that_nothing_stands_up_to_are_told_by_name() {
    let press = |name: &str| held(name, 0.0).push("roll", Axis::Y, -600.0);
    // Not halved over and over.
    let increments = Increments {
        start: 0.5,
        min: Some(0.25),
        max: 0.5,
    };
    let refused = |driver: &mut Driver<2>, step: &Step<2>| {
        driver.run(step, increments, |_, _| {}).expect_err("spins")
    };
    // More than friction carries, 0.3 · 600 N · 20 mm: followed to what it carries, and where something moves, refused.
    let most = 0.3 * 600.0 * RADIUS;
    let spin = press("spin").moment("roll", Z, 1.2 * most);
    let mut driver = large(1e6, 0.3, Seam::Cheaper);
    run(&mut driver, &press("press"), 2);
    let spun = driver.run(&spin, 2, |_, _| {}).expect_err("spins");
    let IncrementError::Collapse { collapse, .. } = &spun else {
        panic!("{spun:?}");
    };
    assert!((collapse.load_factor * 1.2 - 1.0).abs() < 1e-4, "{spun}");
    let mut driver = large(1e6, 0.3, Seam::Cheaper);
    run(&mut driver, &press("press"), 2);
    let spun = refused(&mut driver, &spin.tool("roll", [1e-3, 0.0]));
    let IncrementError::Model(ModelError::SpinningTool {
        tool,
        moment,
        carried,
    }) = &spun
    else {
        panic!("{spun:?}");
    };
    assert!(tool == "roll" && *carried < 1.001 * most, "{spun}");
    assert!((moment / (1.2 * most) - 1.0).abs() < 1e-12, "{spun}");
    let mut driver = large(1e6, 0.3, Seam::Cheaper);
    run(&mut driver, &press("press"), 2);
    run(
        &mut driver,
        &press("less").moment("roll", Z, -0.9 * most),
        2,
    );
    assert!((about(&driver, "roll", Z)[0] / (-0.9 * most) - 1.0).abs() < 1e-9);
    // Without friction nothing resists at all, nor where nothing touches, or where the analysis knows no turn.
    let smooth = refused(
        &mut large(1e6, 0.0, Seam::Cheaper),
        &press("spin").moment("roll", Z, 1.0),
    );
    assert!(
        matches!(&smooth, IncrementError::Model(ModelError::FreeTool { motion, .. }) if motion.contains("rotation")),
        "{smooth:?}"
    );
    let right_of_the_axis = block().map(|x| [x[0] + 12.0, x[1]]).expect("valid");
    let model = Model::with_large_strains(right_of_the_axis, Axisymmetric);
    let mut round = rolled(model, (300.0, 0.1), Seam::Cheaper);
    let turned = refused(&mut round, &press("spin").moment("roll", Z, 1.0));
    assert!(
        matches!(turned, IncrementError::Model(ModelError::OutOfRange { .. })),
        "{turned:?}"
    );
    let other = Model::new(block(), PlaneStrain::default())
        .material("block", steel(300.0), Integration::Reduced)
        .and_then(|m| m.tool("roll", Plane::new([0.0, 6.0], [0.0, -1.0]).expect("valid")))
        .expect("valid");
    let mut other = Driver::new(other, Settings::default()).expect("valid");
    let alone = refused(&mut other, &held("spin", 0.0).moment("roll", Z, 1.0));
    assert!(
        matches!(
            alone,
            IncrementError::Model(ModelError::UntouchedTool { .. })
        ),
        "{alone:?}"
    );
}

/// A flap that a moment presses on a block, and a moment that lifts it.
#[test]
fn a_flap_is_pressed_by_its_moment() {
    let make = |large: bool| {
        let model = match large {
            true => Model::with_large_strains(block(), PlaneStrain::default()),
            false => Model::new(block(), PlaneStrain::default()),
        };
        let flap = Plane::new([0.0, 6.0], [0.0, -1.0]).expect("valid");
        let model = model
            .material("block", steel(1e6), Integration::Reduced)
            .and_then(|m| m.tool("flap", flap)?.reference([-12.0, 6.0]))
            .and_then(|m| m.contact("block.top", "flap", Coulomb::new(0.1).expect("valid")))
            .expect("valid");
        Driver::new(model, Settings::default()).expect("valid")
    };
    let press = |moment: f64| held("press", 0.0).moment("flap", Z, moment);
    for large in [false, true] {
        let mut driver = make(large);
        run(&mut driver, &press(-3e6), 2);
        let [moment, turn] = about(&driver, "flap", Z);
        assert!(
            (moment / -3e6 - 1.0).abs() < 1e-9 && turn < -1e-4,
            "{moment} {turn}"
        );
        let lifted = make(large)
            .run(&press(1.0), 1, |_, _| {})
            .expect_err("lifts off");
        assert!(
            matches!(
                lifted,
                IncrementError::Model(ModelError::TurnedAwayTool { .. })
            ),
            "{lifted:?}"
        );
    }
}

/// A flap with a sharp tip at a node, turned by a moment: at the corner too the moment is that of the contact force.
#[test]
fn a_flap_presses_with_its_tip() {
    let (x, y) = (uniform(-4.0, 4.0, 8), uniform(0.0, 4.0, 4));
    let make = |large: bool| {
        let mesh = block2("block", CellKind::Quad4, &x, &y).expect("valid");
        let model = match large {
            true => Model::with_large_strains(mesh, PlaneStrain::default()),
            false => Model::new(mesh, PlaneStrain::default()),
        };
        let tip = Polyline::new(&[[10.0, 9.0], [0.0, 4.0], [-10.0, 9.0]]).expect("valid");
        let model = model
            .material("block", steel(1e6), Integration::Full)
            .and_then(|m| m.tool("roll", tip)?.reference([-8.0, 4.0]))
            .and_then(|m| m.contact("block.top", "roll", Coulomb::new(0.3).expect("valid")))
            .expect("valid");
        Driver::new(model, Settings::default()).expect("valid")
    };
    let moment = -4e3;
    for large in [false, true] {
        let mut driver = make(large);
        let press = held("press", 0.0).moment("roll", Z, moment);
        let reports = run(&mut driver, &press, 2);
        assert!(!reports[1].corners.is_empty(), "{reports:?}");
        let [carried, turn] = about(&driver, "roll", Z);
        assert!(
            (carried / moment - 1.0).abs() < 1e-9 && turn < 0.0,
            "{carried} {turn}"
        );
        let force = driver.tool_force("roll").expect("exists");
        assert!((force[1] * 8.0 / moment - 1.0).abs() < 5e-3, "{force}");
    }
}

#[test]
fn a_roll_that_a_moment_turns_is_read_back_to_the_bit() {
    let make = || large(300.0, 0.3, Seam::Cheaper);
    let press = held("press", 0.0).push("roll", Axis::Y, -1500.0);
    let turn = held("turn", 0.5)
        .push("roll", Axis::Y, -1500.0)
        .moment("roll", Z, 2000.0);
    let mut driver = make();
    run(&mut driver, &press, 2);
    let mut ramp = driver.begin(&turn, 4).expect("a step");
    let watch = &mut |_: &moreau_driver::Iteration<'_>| ControlFlow::Continue(());
    for _ in 0..2 {
        driver.proceed(&mut ramp, watch).expect("converges");
    }
    let mut numbers = Vec::new();
    driver.write(&mut numbers);
    ramp.write(&mut numbers);
    let mut other = make();
    let mut again = other.begin(&turn, 4).expect("a step");
    let mut from = Numbers::Read(&numbers);
    other.read(&mut from).expect("fits");
    again.read(&mut from).expect("fits");
    while !ramp.is_done() {
        driver.proceed(&mut ramp, watch).expect("converges");
        other.proceed(&mut again, watch).expect("converges");
    }
    let bits = |d: &Driver<2>| {
        let mut numbers = Vec::new();
        d.write(&mut numbers);
        numbers.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    assert_eq!(bits(&driver), bits(&other));
}

/// A flat tool that turns about a hinge beside the block presses it: pressures push across r × n, and what they do is
/// what the block stores and rubs away: exactly under small strains without friction, else but for an error of second
/// order in the increments.
#[test]
fn a_flap_does_the_work_that_the_block_takes() {
    let flap = |is_large: bool, mu: f64| {
        let (x, y) = (uniform(0.0, 12.0, 8), uniform(0.0, 6.0, 4));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        let model = match is_large {
            true => Model::with_large_strains(mesh, PlaneStrain::default()),
            false => Model::new(mesh, PlaneStrain::default()),
        };
        let model = model
            .material(
                "block",
                Elastic::new(1000.0, 0.3).expect("valid"),
                Integration::Reduced,
            )
            .and_then(|m| m.tool("flap", Plane::new([0.0, 6.1], [0.0, -1.0]).expect("valid")))
            .and_then(|m| m.reference([-8.0, 9.0]))
            .and_then(|m| m.contact("block.top", "flap", Coulomb::new(mu).expect("valid")))
            .expect("valid");
        Driver::new(model, Settings::default()).expect("valid")
    };
    let held = |name: &str| Step::new(name).fix("block.bottom", &[Axis::X, Axis::Y]);
    for (is_large, mu) in [(false, 0.0), (true, 0.0), (true, 0.3)] {
        let mut errors = Vec::new();
        for increments in [4, 8, 16] {
            let mut driver = flap(is_large, mu);
            let step = held("shut").turn("flap", Z, -0.05);
            run(&mut driver, &step, increments);
            let energies = driver.energies();
            let error = energies.external_work / energies.taken() - 1.0;
            errors.push(error.abs());
        }
        let exact = !is_large && mu == 0.0;
        let is_right = match exact {
            true => errors[0] < 1e-12,
            false => errors[1] < 0.4 * errors[0] && errors[2] < 0.4 * errors[1],
        };
        assert!(errors[2] < 1e-3 && is_right, "{is_large}, {mu}: {errors:?}");
    }
}

/// A plate that a force presses and a moment tilts does the work that the block stores, in as many increments as one likes:
/// no turn of the increments before counts once more.
#[test]
fn a_tilted_plate_does_the_work_that_the_block_stores() {
    for increments in [1, 2, 10] {
        let (x, y) = (uniform(0.0, 10.0, 4), uniform(0.0, 4.0, 2));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        let law = Elastic::new(1000.0, 0.3).expect("valid");
        let plate = Plane::new([5.0, 4.0], [0.0, -1.0]).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material("block", law, Integration::Reduced)
            .and_then(|m| m.tool("plate", plate))
            .and_then(|m| m.contact("block.top", "plate", Coulomb::new(0.0).expect("valid")))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = Step::new("press")
            .fix("block.bottom", &[Axis::X, Axis::Y])
            .push("plate", Axis::Y, -100.0)
            .moment("plate", Z, 100.0);
        run(&mut driver, &step, increments);
        let [moment, turn] = about(&driver, "plate", Z);
        assert!(
            (moment - 100.0).abs() < 1e-6 && turn > 1e-3,
            "{moment} {turn}"
        );
        let energies = driver.energies();
        let error = energies.external_work / energies.stored - 1.0;
        assert!(error.abs() < 1e-9, "{increments}: {error}");
    }
}

/// A ball that rubs a block about one axis and then about another does the work that friction takes, but for an error that
/// vanishes with the increments.
#[test]
fn a_ball_that_turns_about_two_axes_does_its_work() {
    let error = |increments: usize| {
        let (x, y) = (uniform(-3.0, 3.0, 4), uniform(0.0, 2.0, 1));
        let mesh = block3("block", CellKind::Hex8, &x, &y, &x).expect("valid");
        let law = Elastic::new(1000.0, 0.3).expect("valid");
        let ball = Ball::new([0.0, 12.0, 0.0], 10.0).expect("valid");
        let model = Model::new(mesh, Solid)
            .material("block", law, Integration::Full)
            .and_then(|m| m.tool("ball", ball))
            .and_then(|m| m.contact("block.top", "ball", Coulomb::new(0.3).expect("valid")))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = |name| {
            Step::new(name)
                .fix("block.bottom", &[Axis::X, Axis::Y, Axis::Z])
                .tool("ball", [0.0, -0.15, 0.0])
        };
        run(&mut driver, &step("press"), 2);
        let by = 60f64.to_radians();
        run(
            &mut driver,
            &step("spin").turn("ball", [0.0, 1.0, 0.0], by),
            increments,
        );
        let before = driver.energies();
        run(
            &mut driver,
            &step("roll").turn("ball", [1.0, 0.0, 0.0], by),
            increments,
        );
        let after = driver.energies();
        (after.external_work - before.external_work) / (after.taken() - before.taken()) - 1.0
    };
    let errors = [8, 16].map(error);
    let [few, many] = errors.map(f64::abs);
    assert!(many < 0.05 && many < 0.6 * few, "{errors:?}");
}

/// A block against a wall under a plate that turns freely: where the node in the corner belongs to both tools what holds the
/// plate is not seen on a dense matrix, and is in the factor.
#[test]
fn a_plate_that_turns_freely_presses_a_block_in_a_corner() {
    let (x, y) = (uniform(0.0, 10.0, 2), uniform(0.0, 8.0, 2));
    let mesh = block2("block", CellKind::Quad4, &x, &y).expect("valid");
    let law = Elastic::new(1000.0, 0.3).expect("valid");
    let smooth = || Coulomb::new(0.0).expect("valid");
    let plane = |point, normal| Plane::new(point, normal).expect("valid");
    let model = Model::new(mesh, PlaneStrain::default())
        .material("block", law, Integration::Full)
        .and_then(|m| m.tool("plate", plane([5.0, 8.0], [0.0, -1.0])))
        .and_then(|m| m.tool("wall", plane([0.0; 2], [1.0, 0.0])))
        .and_then(|m| m.contact("block.top", "plate", smooth()))
        .and_then(|m| m.contact("block.left", "wall", smooth()))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("press")
        .fix("block.bottom", &[Axis::Y])
        .pressure("block.right", 7.5)
        .push("plate", Axis::Y, -100.0)
        .moment("plate", Z, 0.0);
    let reports = run(&mut driver, &step, 1);
    assert_eq!(reports[0].cuts, 0);
    let force = |name: &str| driver.tool_force(name).expect("exists");
    // But for the tilt by which the plate follows the centre of the block.
    assert!((force("wall")[0] - 60.0).abs() < 0.05, "{}", force("wall"));
    assert!(
        (force("plate")[1] + 100.0).abs() < 1e-6,
        "{}",
        force("plate")
    );
    assert!(about(&driver, "plate", Z)[0].abs() < 1e-6);
}
