//! Tools driven by a force: the same states as tools that are moved, from one to the other and back.

use moreau_contact::{Ball, Plane};
use moreau_driver::{
    Analysis, Axis, Collapse, Driver, IncrementError, Increments, Model, ModelError, Numbers,
    Saved, Seam, Settings, Step,
};
use moreau_laws::{Coulomb, Status, VonMises};
use moreau_mesh::{
    Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use std::ops::ControlFlow;

fn steel() -> VonMises {
    VonMises::new(210e3, 0.3, 300.0).expect("valid")
}

fn coulomb(mu: f64) -> Coulomb {
    Coulomb::new(mu).expect("valid")
}

fn block() -> Mesh<2> {
    let (x, y) = (uniform(0.0, 40.0, 16), uniform(0.0, 20.0, 6));
    block2("block", CellKind::Quad8, &x, &y).expect("valid")
}

/// A block with a ball above it, at a distance.
fn indented<const D: usize, H: Analysis<D>>(
    (mesh, rule): (Mesh<D>, Integration),
    hypothesis: H,
    (center, radius): ([f64; D], f64),
    mu: f64,
) -> Driver<D> {
    // In space elastic: increments may be cut, and plastic flow depends on them.
    let yield_stress = if D == 2 { 300.0 } else { 1e6 };
    let law = VonMises::new(210e3, 0.3, yield_stress).expect("valid");
    let model = Model::new(mesh, hypothesis)
        .material("block", law, rule)
        .and_then(|m| m.tool("ball", Ball::new(center, radius).expect("valid")))
        .and_then(|m| m.contact("block.top", "ball", coulomb(mu)))
        .expect("valid");
    Driver::new(model, Settings::default()).expect("valid")
}

/// A cylinder over half of a block.
fn cylinder(mu: f64) -> Driver<2> {
    indented(
        (block(), Integration::Reduced),
        PlaneStrain::default(),
        ([0.0, 120.3], 100.0),
        mu,
    )
}

fn held<const D: usize>(name: &str) -> Step<D> {
    let axes = [Axis::X, Axis::Y, Axis::Z];
    Step::new(name).fix("block.bottom", &axes[..D])
}

/// Same displacements and contact forces.
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
        assert!((a.t - b.t).norm() <= tolerance * scale, "{a:?} {b:?}");
        assert_eq!(a.status, b.status);
    }
}

/// Moves the ball by `motion`, and another by the force that this took.
fn by_motion_and_by_force<const D: usize>(
    make: impl Fn() -> Driver<D>,
    step: &Step<D>,
    (axis, motion): (usize, f64),
) {
    let mut moved = make();
    let mut to = [0.0; D];
    to[axis] = motion;
    moved
        .run(&step.clone().tool("ball", to), 1, |_, _| {})
        .expect("converges");
    let force = moved.tool_force("ball").expect("exists")[axis];
    let mut pushed = make();
    let axes = [Axis::X, Axis::Y, Axis::Z];
    let push = step.clone().push("ball", axes[axis], force);
    let report = &pushed.run(&push, 1, |_, _| {}).expect("converges")[0];
    let reached = pushed.tool_displacement("ball").expect("exists")[axis];
    assert!((reached / motion - 1.0).abs() < 1e-9, "{reached} {motion}");
    let found = pushed.tool_force("ball").expect("exists")[axis];
    assert!((found / force - 1.0).abs() < 1e-9, "{found} {force}");
    same(&moved, &pushed, 1e-8);
    assert!(report.relative_gap() < 1e-10, "{report:?}");
    let work = [moved.energies(), pushed.energies()].map(|e| e.external_work);
    assert!(work[1] > 0.0);
}

#[test]
fn a_given_force_leads_where_the_motion_does_that_takes_it() {
    for mu in [0.0, 0.2] {
        by_motion_and_by_force(
            || cylinder(mu),
            &held("press").fix("block.left", &[Axis::X]),
            (1, -0.35),
        );
        let axisymmetric = || {
            indented(
                (block(), Integration::Reduced),
                Axisymmetric,
                ([0.0, 120.3], 100.0),
                mu,
            )
        };
        by_motion_and_by_force(
            axisymmetric,
            &held("press").fix("block.left", &[Axis::X]),
            (1, -0.4),
        );
        let lines = uniform(0.0, 10.0, 4);
        let cube = || block3("block", CellKind::Hex8, &lines, &lines, &lines).expect("valid");
        by_motion_and_by_force(
            || {
                indented(
                    (cube(), Integration::Full),
                    Solid,
                    ([4.0, 60.02, 5.0], 50.0),
                    mu,
                )
            },
            &held("press"),
            (1, -0.1),
        );
    }
}

/// The sides of a block that is clamped are held in the surface that a tool comes to.
#[test]
fn a_given_force_leads_where_the_motion_does_beside_nodes_that_are_held() {
    let clamped = held("press")
        .fix("block.left", &[Axis::X, Axis::Y])
        .fix("block.right", &[Axis::X, Axis::Y]);
    let over_the_middle = || {
        let mesh = (block(), Integration::Reduced);
        indented(mesh, PlaneStrain::default(), ([20.0, 120.3], 100.0), 0.2)
    };
    by_motion_and_by_force(over_the_middle, &clamped, (1, -0.35));
    // Driven along as well: less than friction takes.
    let mut driver = over_the_middle();
    let both = |x: f64| {
        let push = clamped.clone().push("ball", Axis::Y, -3000.0);
        push.push("ball", Axis::X, x)
    };
    driver.run(&both(0.0), 2, |_, _| {}).expect("converges");
    driver.run(&both(100.0), 2, |_, _| {}).expect("sticks");
    let force = driver.tool_force("ball").expect("exists");
    assert!((force[0] - 100.0).abs() < 1e-6 && (force[1] + 3000.0).abs() < 1e-6);
    let lines = uniform(0.0, 10.0, 4);
    let on_a_cube = || {
        let cube = block3("block", CellKind::Hex8, &lines, &lines, &lines).expect("valid");
        let ball = ([5.0, 60.02, 5.0], 50.0);
        indented((cube, Integration::Full), Solid, ball, 0.2)
    };
    let all = [Axis::X, Axis::Y, Axis::Z];
    let clamped = held("press").fix("block.left", &all);
    by_motion_and_by_force(on_a_cube, &clamped, (1, -0.1));
}

/// Rigid meets rigid: a tool that comes to held nodes goes no further than the nearest lets it, and all
/// of its force is borne; what several at one distance bear together is decided, not their parts.
#[test]
fn a_tool_that_is_driven_on_held_nodes_stops_at_the_nearest() {
    let lines = uniform(0.0, 10.0, 4);
    let cube = || block3("block", CellKind::Hex8, &lines, &lines, &lines).expect("valid");
    let all = [Axis::X, Axis::Y, Axis::Z];
    let press = held("press").fix("block.left", &all);
    // Over the clamped edge, beside the middle of it, and over the middle between two of its nodes.
    for (z, nearest) in [(4.0, 1.0), (6.25, 1.25)] {
        let height = 3.0;
        let ball = ([0.0, 10.0 + 50.0 + height, z], 50.0);
        let mut driver = indented((cube(), Integration::Full), Solid, ball, 0.2);
        let push = press.clone().push("ball", Axis::Y, -100.0);
        let reports = driver.run(&push, 2, |_, _| {}).expect("is stopped");
        assert!(reports.iter().all(|r| r.cuts == 0));
        let reached = driver.tool_displacement("ball").expect("exists")[1];
        let expected = f64::sqrt(50.0 * 50.0 - nearest * nearest) - 50.0 - height;
        assert!((reached - expected).abs() < 1e-9, "{reached} {expected}");
        let force = driver.tool_force("ball").expect("exists")[1];
        assert!((force + 100.0).abs() < 1e-7, "{force}");
        let supports = driver.reaction("block.left").expect("held")[1];
        assert!((supports - 100.0).abs() < 1e-6, "{supports}");
        for c in driver.contacts() {
            let x = nalgebra::Vector3::from(c.position) + driver.displacement(c.node);
            let center = nalgebra::Vector3::new(0.0, ball.0[1] + reached, z);
            assert!((x - center).norm() - 50.0 > -1e-9, "{c:?}");
        }
    }
    // A lid on all of the top, which the clamped edge holds alone.
    let lid = Plane::new([0.0, 10.5, 0.0], [0.0, -1.0, 0.0]).expect("valid");
    let model = Model::new(cube(), Solid)
        .material("block", steel(), Integration::Full)
        .and_then(|m| m.tool("lid", lid))
        .and_then(|m| m.contact("block.top", "lid", coulomb(0.3)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let push = press.push("lid", Axis::Y, -100.0);
    driver.run(&push, 2, |_, _| {}).expect("is stopped");
    let reached = driver.tool_displacement("lid").expect("exists")[1];
    let force = driver.tool_force("lid").expect("exists")[1];
    assert!((reached + 0.5).abs() < 1e-12 && (force + 100.0).abs() < 1e-9);
    assert!((0..driver.mesh().nodes().len()).all(|n| driver.displacement(n).norm() < 1e-12));
}

/// Moved, then driven by what the motion took: nothing changes. More of it, less of it, and none.
#[test]
fn a_tool_is_handed_over_from_motion_to_force_and_back() {
    let mut driver = cylinder(0.2);
    let supports = |name: &str| held(name).fix("block.left", &[Axis::X]);
    let press = supports("press").tool("ball", [0.0, -0.5]);
    driver.run(&press, 4, |_, _| {}).expect("converges");
    let (at, force) = (
        driver.tool_displacement("ball").expect("exists"),
        driver.tool_force("ball").expect("exists")[1],
    );
    let run = |driver: &mut Driver<2>, part: f64, increments: usize| {
        let step = supports("push").push("ball", Axis::Y, part * force);
        driver.run(&step, increments, |_, _| {}).expect("converges");
        let found = driver.tool_force("ball").expect("exists")[1];
        assert!((found - part * force).abs() < 1e-9 * force.abs(), "{found}");
        driver.tool_displacement("ball").expect("exists")
    };
    let held_on = run(&mut driver, 1.0, 2);
    assert!((held_on - at).norm() < 1e-12, "{held_on} {at}");
    let deeper = run(&mut driver, 1.2, 2);
    assert!(deeper[1] < at[1]);
    let less = run(&mut driver, 0.4, 3);
    assert!(less[1] > deeper[1] && less[1] < -0.3);
    // Not mentioned, it stays where it is, and so does what it presses.
    let stay = supports("stay");
    driver.run(&stay, 1, |_, _| {}).expect("converges");
    let found = driver.tool_force("ball").expect("exists")[1];
    assert!((found / (0.4 * force) - 1.0).abs() < 1e-9, "{found}");
    assert_eq!(driver.tool_displacement("ball").expect("exists"), less);
    // Without a force it lets go, and an imprint is left.
    let off = run(&mut driver, 0.0, 4);
    assert!(off[1] > less[1], "{off}");
    assert!(
        driver
            .contacts()
            .iter()
            .all(|c| c.t.norm() < 1e-9 * force.abs())
    );
    assert!(driver.points().iter().any(|p| p.plastic_strain > 1e-4));
}

/// A block that nothing holds but two plates with friction, one of them driven by a force.
#[test]
fn a_block_floats_between_a_floor_and_a_plate_under_a_force() {
    let plate = |y: f64, n: f64| Plane::new([0.0, y], [0.0, n]).expect("valid");
    let mesh = block2(
        "block",
        CellKind::Quad8,
        &uniform(0.0, 40.0, 8),
        &uniform(0.0, 20.0, 4),
    );
    let model = Model::new(mesh.expect("valid"), PlaneStrain::default())
        .material("block", steel(), Integration::Reduced)
        .and_then(|m| m.tool("floor", plate(0.0, 1.0)))
        .and_then(|m| m.tool("plate", plate(20.5, -1.0)))
        .and_then(|m| m.contact("block.bottom", "floor", coulomb(0.3)))
        .and_then(|m| m.contact("block.top", "plate", coulomb(0.3)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let press = Step::new("press").push("plate", Axis::Y, -8000.0);
    driver.run(&press, 2, |_, _| {}).expect("closes the gap");
    let [floor, plate] = ["floor", "plate"].map(|t| driver.tool_force(t).expect("exists"));
    assert!((plate[1] + 8000.0).abs() < 8e-6 && (floor + plate).norm() < 8e-6);
    // Driven along too, below what friction takes; beyond, the plate slides off at μ N.
    let along = |force: f64| {
        let step = Step::new("along").push("plate", Axis::Y, -8000.0);
        step.push("plate", Axis::X, force)
    };
    driver.run(&along(2000.0), 2, |_, _| {}).expect("sticks");
    let plate = driver.tool_force("plate").expect("exists");
    assert!((plate[0] - 2000.0).abs() < 8e-6, "{plate}");
    assert!(driver.contacts().iter().any(|c| c.status == Status::Stick));
    match driver.run(&along(6000.0), 4, |_, _| {}) {
        Err(IncrementError::Collapse { collapse, .. }) => {
            let Collapse { load_factor, .. } = collapse;
            // μ N = 2400 N, from 2000 on the way to 6000.
            assert!((load_factor - 0.1).abs() < 1e-6, "{collapse:?}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn forces_that_nothing_stands_up_to_are_refused_by_name() {
    let supports = || held("pull").fix("block.left", &[Axis::X]);
    let refused = |driver: &mut Driver<2>, step: &Step<2>| match driver.run(step, 1, |_, _| {}) {
        Err(IncrementError::Model(error)) => error,
        other => panic!("{other:?}"),
    };
    let mut driver = cylinder(0.0);
    let error = refused(&mut driver, &supports().push("ball", Axis::Y, 10.0));
    assert!(
        error.to_string().contains("along [0.0, 1.0], away"),
        "{error}"
    );
    match error {
        ModelError::PulledTool { tool, force } => {
            assert_eq!((tool.as_str(), force[1]), ("ball", 10.0))
        }
        other => panic!("{other:?}"),
    }
    let free = Plane::new([0.0, 21.0], [0.0, -1.0]).expect("valid");
    let model = Model::new(block(), PlaneStrain::default())
        .material("block", steel(), Integration::Reduced)
        .and_then(|m| m.tool("plate", free))
        .and_then(|m| m.contact("block.top", "plate", coulomb(0.0)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let both = supports()
        .push("plate", Axis::Y, -10.0)
        .push("plate", Axis::X, 0.0);
    match refused(&mut driver, &both) {
        ModelError::FreeTool { tool, motion } => {
            assert_eq!(
                (tool.as_str(), motion.as_str()),
                ("plate", "translation along x")
            );
        }
        other => panic!("{other:?}"),
    }
    let mut round = indented(
        (block(), Integration::Reduced),
        Axisymmetric,
        ([0.0, 120.3], 100.0),
        0.2,
    );
    let radial = supports().push("ball", Axis::X, 10.0);
    let grows = supports().tool("ball", [0.1, -0.1]);
    for (step, at) in [(radial, 10.0), (grows, 0.1)] {
        match refused(&mut round, &step) {
            ModelError::OutOfRange { value, .. } => assert_eq!(value, at),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(round.increments(), 0);
}

#[test]
fn a_driven_tool_is_read_back_to_the_bit() {
    let step = held("press")
        .fix("block.left", &[Axis::X])
        .push("ball", Axis::Y, -3000.0);
    let mut driver = cylinder(0.2);
    let mut ramp = driver.begin(&step, 3).expect("valid");
    driver
        .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
        .expect("converges");
    let mut numbers = Vec::new();
    driver.write(&mut numbers);
    ramp.write(&mut numbers);
    let mut other = cylinder(0.2);
    let mut from = Numbers::Read(&numbers);
    other.read(&mut from).expect("fits");
    let mut again = other.begin(&step, Increments::equal(3)).expect("valid");
    again.read(&mut from).expect("fits");
    while !ramp.is_done() {
        let first = driver
            .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
            .expect("converges");
        let second = other
            .proceed(&mut again, &mut |_| ControlFlow::Continue(()))
            .expect("converges");
        assert_eq!(first, second);
    }
    assert_eq!(
        driver.tool_displacement("ball"),
        other.tool_displacement("ball")
    );
}

/// A tool crosses any gap to press as it does from nearby: what closed the gap is not repeated. Without
/// friction: that knows the slip of the whole increment.
#[test]
fn a_driven_tool_comes_from_afar() {
    let at = |height: f64| {
        let ball = ([0.0, 120.0 + height], 100.0);
        let mesh = (block(), Integration::Reduced);
        indented(mesh, PlaneStrain::default(), ball, 0.0)
    };
    let press = held("press").fix("block.left", &[Axis::X]);
    let press = press.push("ball", Axis::Y, -3000.0);
    let [mut near, mut far] = [0.001, 150.0].map(at);
    for driver in [&mut near, &mut far] {
        let reports = driver.run(&press, 3, |_, _| {}).expect("converges");
        assert!(reports.iter().all(|r| r.cuts == 0 && r.fraction <= 1.0));
    }
    let force = far.tool_force("ball").expect("exists")[1];
    assert!((force / -3000.0 - 1.0).abs() < 1e-9, "{force}");
    let [a, b] = [&near, &far].map(|d| d.tool_displacement("ball").expect("exists")[1]);
    assert!((a - b - 149.999).abs() < 1e-8, "{a} {b}");
}

/// Through a gap to where its force takes it, free to move along the surface as well: one answer with contacts condensed
/// and tied in the factor.
#[test]
fn a_driven_tool_meets_what_its_force_takes_it_to() {
    let (x, y) = (uniform(-8.0, 8.0, 12), uniform(0.0, 5.0, 3));
    let pressed = |seam: Seam| {
        let mesh = block2("block", CellKind::Quad4, &x, &y).expect("valid");
        let ball = Ball::new([-2.82, 25.0], 20.0).expect("valid");
        let model = Model::with_large_strains(mesh, PlaneStrain::default())
            .material("block", steel(), Integration::Full)
            .and_then(|m| m.tool("ball", ball))
            .and_then(|m| m.contact("block.top", "ball", coulomb(0.05)))
            .expect("valid");
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let press = held("press").push("ball", Axis::X, 0.0);
        let press = press.push("ball", Axis::Y, -420.0);
        let reports = driver.run(&press, 2, |_, _| {}).expect("converges");
        assert!(reports.iter().all(|r| r.cuts == 0));
        let force = driver.tool_force("ball").expect("exists")[1];
        assert!((force / -420.0 - 1.0).abs() < 1e-9, "{force}");
        driver.tool_displacement("ball").expect("exists")
    };
    let [condensed, tied] = [Seam::Condensed, Seam::Tied].map(pressed);
    let size = condensed.norm();
    assert!(
        size > 1e-4 && (condensed - tied).norm() < 1e-7 * size,
        "{condensed} {tied}"
    );
}

/// A tool that its force takes past the body: told with its distance, and what to do.
#[test]
fn a_tool_that_meets_nothing_is_told_with_its_distance() {
    let beside = |x: f64| {
        let mesh = (block(), Integration::Reduced);
        indented(mesh, PlaneStrain::default(), ([x, 120.3], 100.0), 0.2)
    };
    let down = held("press").push("ball", Axis::Y, -10.0);
    match beside(200.0).run(&down, 1, |_, _| {}) {
        Err(IncrementError::Model(ModelError::ToolOutOfContact(loose))) => {
            let told = loose.to_string();
            // From (200, 120.3) to the corner (40, 20), less the radius.
            let gap = 160f64.hypot(100.3) - 100.0;
            assert!((loose.gap - gap).abs() < 1e-9, "{loose:?}");
            assert_eq!(
                (loose.tool.as_str(), loose.surface.as_str()),
                ("ball", "block.top")
            );
            assert_eq!((loose.position, loose.meets), (vec![40.0, 20.0], None));
            for word in ["\"ball\"", "nothing resists", "88.8", "meets nothing"] {
                assert!(told.contains(word), "{word} in {told}");
            }
        }
        other => panic!("{other:?}"),
    }
    // Pushed askew without friction it comes down on the top, and slides off.
    let mesh = (block(), Integration::Reduced);
    let mut smooth = indented(mesh, PlaneStrain::default(), ([20.0, 130.0], 100.0), 0.0);
    let askew = held("press")
        .push("ball", Axis::Y, -10.0)
        .push("ball", Axis::X, 5.0);
    match smooth.run(&askew, 1, |_, _| {}) {
        Err(IncrementError::Model(ModelError::ToolOutOfContact(loose))) => {
            let (gap, meets) = (loose.gap, loose.meets.expect("on its way"));
            let x = 20.0 + meets[0];
            // At the corner (40, 20), or on the flat top before it.
            let height = 130.0 + meets[1];
            let reach = match x < 40.0 {
                true => height - 20.0,
                false => (x - 40.0).hypot(height - 20.0),
            };
            assert!(
                (reach - 100.0).abs() < 1e-2 && (gap - 10.0).abs() < 1e-9,
                "{meets:?}"
            );
            assert!((meets[0] / meets[1] + 0.5).abs() < 1e-9, "{meets:?}");
        }
        other => panic!("{other:?}"),
    }
    let free = Plane::new([0.0, 21.0], [0.0, -1.0]).expect("valid");
    let model = Model::new(block(), PlaneStrain::default())
        .material("block", steel(), Integration::Reduced)
        .and_then(|m| m.tool("plate", free))
        .expect("valid");
    let push = held("press").push("plate", Axis::Y, -10.0);
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let untouched = driver.run(&push, 1, |_, _| {});
    assert!(matches!(
        untouched,
        Err(IncrementError::Model(
            ModelError::UntouchedTool { .. } | ModelError::FreeTool { .. }
        ))
    ));
}

/// A strip that only the friction of its roll holds: what stiffness it has along its way is that of forces that turn with
/// the roll's normal. The last steps of every way to a balance are quadratic: few leave less than 0.1 N of some hundreds.
#[test]
fn the_last_steps_to_the_balance_of_a_rolled_strip_are_quadratic() {
    let (x, y) = (uniform(0.0, 12.0, 12), uniform(0.0, 1.0, 1));
    let mesh = block2("strip", CellKind::Quad8, &x, &y).expect("valid");
    let metal = VonMises::new(70e3, 0.33, 100.0).and_then(|m| m.with_isotropic(100.0));
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("strip", metal.expect("valid"), Integration::Reduced)
        .and_then(|m| m.tool("roll", Ball::new([8.0, 61.0], 60.0).expect("valid")))
        .and_then(|m| m.contact("strip.top", "roll", coulomb(0.15)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let bite = Step::new("bite")
        .fix("strip.bottom", &[Axis::Y])
        .tool("roll", [0.0, -0.2]);
    let roll = bite
        .clone()
        .turn("roll", [0.0, 0.0, 1.0], 4f64.to_radians());
    for (step, increments) in [(bite, 4), (roll, 20)] {
        let reports = driver.run(&step, increments, |_, _| {}).expect("converges");
        for report in reports {
            let small: Vec<bool> = report.residuals.iter().map(|r| *r < 0.1).collect();
            let longest = small.split(|small| !small).map(<[bool]>::len).max();
            assert!(
                longest <= Some(5),
                "{}: {:?}",
                report.increment,
                report.residuals
            );
        }
    }
}
