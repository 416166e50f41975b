//! What must not change the answer, and what must change it in a known way: units, axes, numbering,
//! limits of friction and of the penalty, subdivision, symmetry; no numbers from the literature.

use crate::close;
use moreau::contact::{ContactSolver, GaussSeidel, Penalty, Plane, SemismoothNewton, Uzawa};
use moreau::driver::{Axis, Driver, IncrementReport, Model, Settings, Step};
use moreau::laws::{Coulomb, Status, VonMises};
use moreau::mesh::{CellKind, Integration, Mesh, PlaneStrain, block2, uniform};
use nalgebra::{Matrix2, Rotation2, Vector2};
use verification::problems::Fallible;
use verification::problems::disguise::{Disguised, disguise};
use verification::problems::punched::Punched;

/// Round-off that the iteration leaves.
const SOLVER: f64 = 1e-9;
/// Stress that is never reached [MPa].
const ELASTIC: f64 = 1e9;

/// Largest of some norms.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

fn max_displacement(driver: &Driver<2>) -> f64 {
    largest((0..driver.mesh().nodes().len()).map(|n| driver.displacement(n).norm()))
}

fn max_force(driver: &Driver<2>) -> f64 {
    largest(driver.contacts().iter().map(|c| c.t.norm()))
}

/// Asserts that two drivers of one mesh hold the same state.
#[track_caller]
fn assert_same(a: &Driver<2>, b: &Driver<2>, tolerance: f64, what: &str) {
    let (u, t) = (max_displacement(a), max_force(a));
    for node in 0..a.mesh().nodes().len() {
        let error = (a.displacement(node) - b.displacement(node)).norm() / u;
        assert!(error <= tolerance, "{what}: node {node} off by {error:.2e}");
    }
    for (c, d) in a.contacts().iter().zip(b.contacts()) {
        let error = (c.t - d.t).norm() / t;
        assert!(
            error <= tolerance,
            "{what}: contact of node {} off by {error:.2e}",
            c.node
        );
    }
}

/// Forces, displacements and reports in millimetres and megapascals, computed in other units.
fn in_units(length: f64, stress: f64) -> Fallible<(Driver<2>, Vec<IncrementReport>)> {
    let punched = Punched {
        length,
        stress,
        ..Punched::default()
    };
    let mut driver = punched.half()?;
    let reports = driver.run(&punched.press(0.1), 10, |_, _| {})?;
    Ok((driver, reports))
}

/// Asserts that a run in other units is the first one, to a tolerance.
#[track_caller]
fn assert_converted(
    (first, expected): &(Driver<2>, Vec<IncrementReport>),
    (driver, reports): &(Driver<2>, Vec<IncrementReport>),
    (length, stress): (f64, f64),
    tolerance: f64,
) {
    let what = format!("{length} mm, {stress} MPa");
    let (u, t) = (max_displacement(first), max_force(first));
    for node in 0..first.mesh().nodes().len() {
        let error = (driver.displacement(node) * length - first.displacement(node)).norm() / u;
        assert!(error <= tolerance, "{what}: node {node} off by {error:.2e}");
    }
    for (a, b) in driver.contacts().iter().zip(first.contacts()) {
        let error = (a.t * stress * length.powi(2) - b.t).norm() / t;
        assert!(error <= tolerance, "{what}: force off by {error:.2e}");
        assert_eq!(a.status, b.status, "{what}");
    }
    for (a, b) in reports.iter().zip(expected) {
        let counts = |r: &IncrementReport| {
            (
                r.newton_iterations,
                r.factorisations,
                r.shortened_steps,
                r.cuts,
            )
        };
        assert_eq!(counts(a), counts(b), "{what}: increment {}", a.increment);
        let work = a.energies.external_work * stress * length.powi(3);
        close("work", work, b.energies.external_work, tolerance);
    }
}

/// Metres and pascals; inches and pounds a square inch; and others.
#[test]
fn units_do_not_matter() -> Fallible {
    let first = in_units(1.0, 1.0)?;
    for units in [
        (1e3, 1e-6),
        (25.4, 6.894757e-3),
        (1e-3, 1.0),
        (1e3, 1.0),
        (1.0, 1e-6),
    ] {
        assert_converted(&first, &in_units(units.0, units.1)?, units, SOLVER);
    }
    Ok(())
}

/// Powers of two do not even round: no constant of the program has a unit.
#[test]
fn units_do_not_matter_to_the_bit() -> Fallible {
    let first = in_units(1.0, 1.0)?;
    let two = |exponent: i32| 2f64.powi(exponent);
    for units in [
        (two(10), two(-20)),
        (two(-10), 1.0),
        (two(30), 1.0),
        (1.0, two(40)),
    ] {
        let other = in_units(units.0, units.1)?;
        assert_converted(&first, &other, units, 0.0);
        for (a, b) in other.1.iter().zip(&first.1) {
            assert_eq!(a.contact_iterations, b.contact_iterations, "{units:?}");
        }
    }
    Ok(())
}

/// An elastoplastic block squeezed into a corner: a rough floor and a smooth wall, pressed from the
/// two other sides. Nothing is held, so that any rotation is as good as another.
fn cornered() -> Fallible<Mesh<2>> {
    let lines = uniform(0.0, 40.0, 16);
    let mut mesh = block2("block", CellKind::Quad8, &lines, &lines)?;
    // The corner itself touches the floor only.
    mesh.facet_group_where("wall", "block.right", |x| x[1] >= 2.5)?;
    Ok(mesh)
}

const SIDES: [&str; 4] = ["block.left", "block.bottom", "block.top", "wall"];

/// Its state under the load, with floor and wall moved by x ↦ A x + b.
fn squeezed(mesh: Mesh<2>, a: Matrix2<f64>, b: Vector2<f64>) -> Fallible<Driver<2>> {
    let plane = |point: Vector2<f64>, normal: Vector2<f64>| {
        Plane::<2>::new((a * point + b).into(), (a * normal).into())
    };
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "block",
            VonMises::new(130e3, 0.2, 142.0)?,
            Integration::Reduced,
        )?
        .tool("floor", plane(Vector2::zeros(), Vector2::y())?)?
        .tool("wall", plane(Vector2::new(40.0, 0.0), -Vector2::x())?)?
        .contact("block.bottom", "floor", Coulomb::new(1.0)?)?
        .contact("wall", "wall", Coulomb::new(0.0)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("squeeze")
        .pressure("block.top", 50.0)
        .pressure("block.left", 150.0);
    let reports = driver.run(&step, 4, |_, _| {})?;
    let last = &reports[3];
    assert!(
        last.plastic_fraction > 0.0 && last.plastic_fraction < 1.0,
        "{last:?}"
    );
    assert!(last.open > 0 && last.stick > 0 && last.slip > 0, "{last:?}");
    Ok(driver)
}

/// Asserts that a disguised run is the first one, moved by A and seen through the renumbering.
#[track_caller]
fn assert_disguised(
    first: &Driver<2>,
    disguised: &Driver<2>,
    node: &[usize],
    a: Matrix2<f64>,
    what: &str,
) {
    let (u, t) = (max_displacement(first), max_force(first));
    for (old, &new) in node.iter().enumerate() {
        let error = (disguised.displacement(new) - a * first.displacement(old)).norm() / u;
        assert!(error <= SOLVER, "{what}: node {old} off by {error:.2e}");
    }
    for old in first.contacts() {
        let new = disguised
            .contacts()
            .iter()
            .find(|c| c.node == node[old.node]);
        let new = new.expect("a contact at the same node");
        let error = (new.force - a * old.force).norm() / t;
        assert!(
            error <= SOLVER,
            "{what}: force at node {} off by {error:.2e}",
            old.node
        );
        assert!(
            (new.t[0] - old.t[0]).abs() <= SOLVER * t,
            "{what}: normal force"
        );
        assert!(
            (new.t[1] - a.determinant() * old.t[1]).abs() <= SOLVER * t,
            "{what}: friction"
        );
        assert_eq!(
            new.status, old.status,
            "{what}: status of node {}",
            old.node
        );
    }
}

#[test]
fn rotation_mirror_and_numbering_do_not_matter() -> Fallible {
    let first = squeezed(cornered()?, Matrix2::identity(), Vector2::zeros())?;
    let turn = |degrees: f64| *Rotation2::new(degrees.to_radians()).matrix();
    let mirror = Matrix2::new(-1.0, 0.0, 0.0, 1.0);
    let away = Vector2::new(310.0, -70.0);
    let guises = [
        ("turned by 37°", turn(37.0), Vector2::zeros(), false, false),
        ("turned by 180° and moved", turn(180.0), away, false, false),
        ("mirrored", mirror, Vector2::zeros(), true, false),
        (
            "renumbered",
            Matrix2::identity(),
            Vector2::zeros(),
            false,
            true,
        ),
        ("all together", turn(-112.0) * mirror, away, true, true),
    ];
    for (what, a, b, mirrored, shuffled) in guises {
        let place = |x: [f64; 2]| (a * Vector2::from(x) + b).into();
        let Disguised { mesh, node } = disguise(
            &cornered()?,
            (&["block"], &SIDES, &[]),
            place,
            mirrored,
            shuffled,
        )?;
        assert_disguised(&first, &squeezed(mesh, a, b)?, &node, a, what);
    }
    Ok(())
}

/// Prescribed displacements turn with the axes, by right angles.
#[test]
fn a_quarter_turn_does_not_matter() -> Fallible {
    let punched = Punched::default();
    let mut first = punched.half()?;
    first.run(&punched.press(0.1), 10, |_, _| {})?;
    let turn = Matrix2::new(0.0, -1.0, 1.0, 0.0);
    let Disguised { mesh, node } = disguise(
        &punched.half_mesh()?,
        (&["block"], &["block.bottom", "block.left"], &["punch"]),
        |x| (turn * Vector2::from(x)).into(),
        false,
        true,
    )?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "block",
            VonMises::new(210e3, 0.3, 300.0)?,
            Integration::Reduced,
        )?
        .tool("foundation", Plane::new([0.0, 0.0], [-1.0, 0.0])?)?
        .contact("block.bottom", "foundation", Coulomb::new(0.1)?)?;
    let mut turned = Driver::new(model, Settings::default())?;
    let press = Step::new("press")
        .fix("block.left", &[Axis::Y])
        .displace("punch", Axis::X, 0.1);
    turned.run(&press, 10, |_, _| {})?;
    assert_disguised(&first, &turned, &node, turn, "turned by 90°");
    close(
        "load",
        turned.reaction("punch")?[0],
        -first.reaction("punch")?[1],
        SOLVER,
    );
    Ok(())
}

#[test]
fn rigid_translation_does_not_matter() -> Fallible {
    let run = |origin: [f64; 2]| -> Fallible<Driver<2>> {
        let punched = Punched {
            origin,
            ..Punched::default()
        };
        let mut driver = punched.half()?;
        driver.run(&punched.press(0.1), 10, |_, _| {})?;
        Ok(driver)
    };
    let base = run([0.0, 0.0])?;
    assert_same(&base, &run([64.0, -128.0])?, SOLVER, "moved by 140 mm");
    assert_same(&base, &run([1e6, 1e6])?, 1e-6, "moved by a kilometre");
    Ok(())
}

#[test]
fn half_of_a_symmetric_body_stands_for_the_whole() -> Fallible {
    let punched = Punched::default();
    let mut half = punched.half()?;
    half.run(&punched.press(0.1), 10, |_, _| {})?;
    let mut full = punched.driver(punched.full_mesh()?, Settings::default())?;
    full.run(
        &Step::new("press").displace("punch", Axis::Y, -0.1),
        10,
        |_, _| {},
    )?;
    close(
        "load",
        punched.load(&full)?,
        2.0 * punched.load(&half)?,
        SOLVER,
    );
    let (u, t) = (max_displacement(&half), max_force(&half));
    for (node, x) in full.mesh().nodes().iter().enumerate() {
        let there = |y: &[f64; 2]| (y[0] - x[0].abs()).hypot(y[1] - x[1]) < 1e-9;
        let other = half
            .mesh()
            .nodes()
            .iter()
            .position(there)
            .ok_or("no such node")?;
        let mut expected = half.displacement(other);
        expected[0] *= if x[0] < 0.0 { -1.0 } else { 1.0 };
        let error = (full.displacement(node) - expected).norm() / u;
        assert!(error <= SOLVER, "displacement at {x:?} off by {error:.2e}");
    }
    for contact in full.contacts() {
        let x = contact.position[0];
        let there = |c: &&moreau::driver::ContactRecord<2>| (c.position[0] - x.abs()).abs() < 1e-9;
        let other = half
            .contacts()
            .iter()
            .find(there)
            .ok_or("no such contact")?;
        // On the axis of symmetry the half has half the force.
        let (share, side) = if x == 0.0 {
            (2.0, 0.0)
        } else {
            (1.0, x.signum())
        };
        let expected = Vector2::new(share * other.t[0], side * other.t[1]);
        assert!(
            (contact.t - expected).norm() <= SOLVER * t,
            "{} {expected}",
            contact.t
        );
        assert!(x == 0.0 || contact.status == other.status, "status at {x}");
    }
    Ok(())
}

#[test]
fn vanishing_friction_is_no_friction() -> Fallible {
    let run = |friction: f64| -> Fallible<Driver<2>> {
        let punched = Punched {
            friction,
            ..Punched::default()
        };
        let mut driver = punched.half()?;
        driver.run(&punched.press(0.1), 10, |_, _| {})?;
        Ok(driver)
    };
    let smooth = run(0.0)?;
    assert_same(&smooth, &run(1e-13)?, SOLVER, "mu = 1e-13");
    // And in proportion to μ on the way.
    let load = |driver: &Driver<2>| Punched::default().load(driver);
    let (one, two) = (load(&run(1e-5)?)?, load(&run(2e-5)?)?);
    let base = load(&smooth)?;
    close(
        "twice the friction, twice the effect",
        two - base,
        2.0 * (one - base),
        1e-2,
    );
    Ok(())
}

#[test]
fn immense_friction_is_stick() -> Fallible {
    for yield_stress in [300.0, ELASTIC] {
        let punched = |friction| Punched {
            friction,
            yield_stress,
            ..Punched::default()
        };
        // Pressed over the whole top: no point opens.
        let press =
            Step::new("press")
                .fix("block.left", &[Axis::X])
                .displace("block.top", Axis::Y, -0.05);
        let mut tied = punched(0.0).half()?;
        let hold = press.clone().fix("block.bottom", &[Axis::X, Axis::Y]);
        tied.run(&hold, 5, |_, _| {})?;
        for friction in [1e2, 1e6] {
            let mut rough = punched(friction).half()?;
            let reports = rough.run(&press, 5, |_, _| {})?;
            assert!(reports.iter().all(|r| r.open == 0 && r.slip == 0));
            let u = max_displacement(&tied);
            for node in 0..tied.mesh().nodes().len() {
                let error = (tied.displacement(node) - rough.displacement(node)).norm() / u;
                assert!(error <= SOLVER, "node {node} off by {error:.2e}");
            }
            close(
                "load",
                rough.reaction("block.top")?[1],
                tied.reaction("block.top")?[1],
                SOLVER,
            );
        }
    }
    Ok(())
}

/// The load does not fall with friction.
#[test]
fn friction_only_adds_to_the_load() -> Fallible {
    let mut before = 0.0;
    for friction in [0.0, 0.05, 0.1, 0.2, 0.4, 0.8] {
        let punched = Punched {
            friction,
            ..Punched::default()
        };
        let mut driver = punched.half()?;
        driver.run(&punched.press(0.1), 10, |_, _| {})?;
        let load = punched.load(&driver)?;
        assert!(load >= before, "mu = {friction}: {load} after {before}");
        before = load;
    }
    Ok(())
}

#[test]
fn penalty_converges_to_the_exact_contact_as_one_over_k() -> Fallible {
    let punched = Punched::default();
    let run = |settings: Settings<2>| -> Fallible<Driver<2>> {
        let mut driver = punched.driver(punched.half_mesh()?, settings)?;
        driver.run(&punched.press(0.02), 2, |_, _| {})?;
        Ok(driver)
    };
    let exact = run(Settings::default())?;
    let load = punched.load(&exact)?;
    let (u, t) = (max_displacement(&exact), max_force(&exact));
    let mut before: Option<[f64; 3]> = None;
    for k in [1e8, 1e9, 1e10] {
        let contact = Box::new(Penalty::new(k, k)?);
        let soft = run(Settings {
            contact,
            ..Settings::default()
        })?;
        let forces = exact.contacts().iter().zip(soft.contacts());
        let nodes = 0..exact.mesh().nodes().len();
        let errors = [
            (punched.load(&soft)? / load - 1.0).abs(),
            largest(forces.map(|(a, b)| (a.t - b.t).norm() / t)),
            largest(nodes.map(|n| (exact.displacement(n) - soft.displacement(n)).norm() / u)),
        ];
        for (k, error) in errors.iter().enumerate() {
            if let Some(before) = before {
                close(&format!("rate of error {k}"), before[k] / error, 10.0, 5e-2);
            }
        }
        before = Some(errors);
    }
    Ok(())
}

#[test]
fn exact_methods_agree() -> Fallible {
    let punched = Punched::default();
    let methods: [Box<dyn ContactSolver<2>>; 3] = [
        Box::new(SemismoothNewton::default()),
        Box::new(GaussSeidel::default()),
        Box::new(Uzawa::default()),
    ];
    let mut drivers = Vec::new();
    for contact in methods {
        let settings = Settings {
            contact,
            ..Settings::default()
        };
        let mut driver = punched.driver(punched.half_mesh()?, settings)?;
        driver.run(&punched.press(0.05), 5, |_, _| {})?;
        drivers.push(driver);
    }
    for other in &drivers[1..] {
        assert_same(&drivers[0], other, 1e-7, "another method");
        for (a, b) in drivers[0].contacts().iter().zip(other.contacts()) {
            assert_eq!(a.status, b.status, "status at {:?}", a.position);
        }
    }
    Ok(())
}

#[test]
fn subdivision_does_not_matter_to_an_elastic_body_without_friction() -> Fallible {
    let punched = Punched {
        friction: 0.0,
        yield_stress: ELASTIC,
        ..Punched::default()
    };
    let run = |steps: usize| -> Fallible<Driver<2>> {
        let mut driver = punched.half()?;
        driver.run(&punched.press(0.1), steps, |_, _| {})?;
        Ok(driver)
    };
    let one = run(1)?;
    assert!(
        one.contacts().iter().any(|c| c.status == Status::Open),
        "some points open"
    );
    for steps in [2, 10] {
        assert_same(&one, &run(steps)?, 1e-11, &format!("{steps} increments"));
    }
    Ok(())
}
