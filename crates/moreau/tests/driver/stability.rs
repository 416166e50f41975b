//! Loads from which on columns are unstable whose sides may touch: negative eigenvalues on what contacts leave free.

use moreau_contact::{Ball, ContactSolver, Penalty, Plane, SemismoothNewton};
use moreau_driver::{Axis, Driver, IncrementReport, Model, Numbers, Seam, Settings, Step};
use moreau_laws::{Coulomb, Elastic, Friction, Status};
use moreau_mesh::{CellKind, Integration, Pairing, PlaneStrain, Solid, block2, block3, uniform};
use std::f64::consts::PI;

const YOUNG: f64 = 1000.0;
const LENGTH: f64 = 100.0;
const HEIGHT: f64 = 2.0;

/// E I / L² of the column, of unit thickness.
fn bending() -> f64 {
    YOUNG * HEIGHT.powi(3) / 12.0 / LENGTH.powi(2)
}

/// Euler's load of the column, clamped at one end and free at the other.
fn euler() -> f64 {
    0.25 * PI.powi(2) * bending()
}

type Columns = Model<2, PlaneStrain>;

fn frictionless() -> Friction {
    Coulomb::new(0.0).expect("valid").into()
}

/// A column along x without Poisson's effect over a floor that it does not reach, what stands beside it, and how its
/// contacts are solved.
fn column(
    beside: impl Fn(Columns) -> Columns,
    (seam, contact): (Seam, Box<dyn ContactSolver<2>>),
) -> Driver<2> {
    let (x, y) = (uniform(0.0, LENGTH, 20), uniform(0.0, HEIGHT, 1));
    let strip = block2("strip", CellKind::Quad8, &x, &y).expect("valid");
    let y = uniform(-7.0, -5.0, 1);
    let floor = block2("floor", CellKind::Quad8, &x, &y).expect("valid");
    let mut mesh = strip.joined(floor).expect("two bodies");
    let at = |place: f64| move |x: &[f64; 2]| (x[0] - place).abs() < 1e-9;
    mesh.node_group_where("middle", "strip.top", at(0.5 * LENGTH))
        .expect("a node");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material(
            "strip",
            Elastic::new(YOUNG, 0.0).expect("valid"),
            Integration::Reduced,
        )
        .and_then(|m| {
            let elastic = Elastic::new(YOUNG, 0.0).expect("valid");
            m.material("floor", elastic, Integration::Reduced)
        })
        .expect("valid");
    let settings = Settings {
        seam,
        contact,
        ..Settings::default()
    };
    Driver::new(beside(model), settings).expect("valid")
}

fn exact() -> Box<dyn ContactSolver<2>> {
    Box::new(SemismoothNewton::default())
}

/// Compresses a column by parts of a load, up to 1.2 of it in steps of a fiftieth, after `first` has acted. Returns the
/// part of the load at which an eigenvalue becomes negative.
fn unstable_from(
    driver: &mut Driver<2>,
    first: impl Fn(Step<2>) -> Step<2>,
    load: f64,
) -> Option<f64> {
    let step = |name: &str, part: f64| {
        first(Step::new(name).fix("strip.left", &[Axis::X, Axis::Y]))
            .fix("floor.bottom", &[Axis::X, Axis::Y])
            .traction("strip.right", [-part * load / HEIGHT, 0.0])
    };
    driver.run(&step("press", 0.0), 1, |_, _| {}).expect("held");
    let mut found = None;
    let mut look = |report: &IncrementReport, part: f64| match found {
        None if report.negative_eigenvalues > 0 => {
            assert_eq!(report.negative_eigenvalues, 1);
            assert!(report.mode.is_some());
            found = Some(part);
        }
        None => assert_eq!(report.mode, None),
        Some(_) => assert!(report.negative_eigenvalues > 0, "{part}"),
    };
    for k in 0..=20 {
        let part = 0.8 + 0.02 * f64::from(k);
        driver
            .run(&step("compress", part), 1, |_, report| {
                look(report, part - 0.01)
            })
            .expect("in balance");
    }
    found
}

const BOTH: [Seam; 2] = [Seam::Condensed, Seam::Tied];

/// Sides that may touch walls far away are as free as sides that touch nothing.
#[test]
fn walls_that_are_not_reached_hold_nothing() {
    let alone = unstable_from(
        &mut column(|model| model, (Seam::Condensed, exact())),
        |step| step,
        euler(),
    );
    let alone = alone.expect("unstable");
    assert!((alone - 1.0).abs() < 0.015, "{alone}");
    for (seam, mu) in [
        (BOTH[0], 0.0),
        (BOTH[0], 0.3),
        (BOTH[1], 0.0),
        (BOTH[1], 0.3),
    ] {
        let law: Friction = Coulomb::new(mu).expect("valid").into();
        let walls = |model: Columns| {
            let wall = |y: f64, n: f64| Plane::new([0.0, y], [0.0, n]).expect("valid");
            model
                .tool("below", wall(-5.0, 1.0))
                .and_then(|m| m.tool("above", wall(HEIGHT + 5.0, -1.0)))
                .and_then(|m| m.contact("strip.bottom", "below", law))
                .and_then(|m| m.contact("strip.top", "above", law))
                .expect("valid")
        };
        let floor = |model: Columns| {
            let pairing = Pairing::default();
            let pair = model.pair("strip.bottom", "floor.top", law, pairing);
            pair.expect("valid")
        };
        for mut driver in [
            column(walls, (seam, exact())),
            column(floor, (seam, exact())),
        ] {
            let found = unstable_from(&mut driver, |step| step, euler());
            assert_eq!(found, Some(alone), "{seam:?}, {mu}");
        }
    }
}

/// Pressed against a wall all along one side, the column does not buckle.
#[test]
fn a_column_does_not_buckle_into_a_wall_that_it_is_pressed_to() {
    for seam in BOTH {
        let wall = |model: Columns| {
            let wall = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
            model
                .tool("wall", wall)
                .and_then(|m| m.contact("strip.bottom", "wall", frictionless()))
                .expect("valid")
        };
        let mut driver = column(wall, (seam, exact()));
        let press = |step: Step<2>| step.traction("strip.top", [0.0, -1e-3]);
        // The lowest load would be 2.47 E I/L².
        let found = unstable_from(&mut driver, press, 2.0 * euler());
        assert_eq!(found, None, "{seam:?}");
        assert!(driver.contacts().iter().any(|c| c.t[0] > 0.0));
    }
}

/// A ball holds the column in the middle of one side, from which all else of it is away: its load is that of a column
/// clamped at one end and pinned in the middle, from w″ + k² w = k² δ above the pin and w = A (cos kx − 1) + B (sin kx −
/// kx) below: with κ = kL/2, (κ − sin κ)(sin²κ − cos²κ) = sin κ (2 cos κ − 1)(cos κ − 1).
#[test]
fn a_column_that_a_contact_pins_has_the_load_of_its_next_mode() {
    let equation = |k: f64| {
        let (s, c) = k.sin_cos();
        (k - s) * (s * s - c * c) - s * (2.0 * c - 1.0) * (c - 1.0)
    };
    let (mut low, mut high) = (1.0, 1.5);
    assert!(equation(low) * equation(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match equation(low) * equation(middle) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    let load = 4.0 * low * low * bending();
    assert!(load > 2.5 * euler());
    let penalty: fn() -> Box<dyn ContactSolver<2>> =
        || Box::new(Penalty::new(1e5, 1e4).expect("valid"));
    let methods = [
        (BOTH[0], exact as fn() -> _),
        (BOTH[1], exact),
        (BOTH[0], penalty),
        (BOTH[1], penalty),
    ];
    for (seam, method) in methods {
        let ball = |model: Columns| {
            let ball = Ball::new([0.5 * LENGTH, -30.0], 30.0).expect("valid");
            model
                .tool("ball", ball)
                .and_then(|m| m.contact("strip.bottom", "ball", frictionless()))
                .expect("valid")
        };
        let mut driver = column(ball, (seam, method()));
        let press = |step: Step<2>| step.force("middle", [0.0, -0.05]);
        let found = unstable_from(&mut driver, press, load).expect("unstable");
        assert!((found - 1.0).abs() < 0.025, "{seam:?}: {found}");
        let closed = driver.contacts().iter().filter(|c| c.t[0] > 0.0).count();
        assert_eq!(closed, 1);
    }
}

/// Two columns side by side, lightly pressed together, without friction: they buckle as each alone, and from four times that
/// load on they would if they were one, so that what no contact force acts on is unstable itself.
#[test]
fn columns_that_lean_on_each_other_buckle_as_each_alone() {
    for seam in BOTH {
        let x = uniform(0.0, LENGTH, 20);
        let bodies = [("strip", 0.0), ("other", HEIGHT)].map(|(name, y)| {
            let y = uniform(y, y + HEIGHT, 1);
            block2(name, CellKind::Quad8, &x, &y).expect("valid")
        });
        let [strip, other] = bodies;
        let mesh = other.joined(strip).expect("two bodies");
        let elastic = || Elastic::new(YOUNG, 0.0).expect("valid");
        let model = Model::with_large_strains(mesh, PlaneStrain::default())
            .material("strip", elastic(), Integration::Reduced)
            .and_then(|m| m.material("other", elastic(), Integration::Reduced))
            .and_then(|m| {
                m.pair(
                    "other.bottom",
                    "strip.top",
                    frictionless(),
                    Pairing::default(),
                )
            })
            .expect("valid");
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let step = |part: f64| {
            let push = [-part * euler() / HEIGHT, 0.0];
            Step::new("compress")
                .fix("strip.left", &[Axis::X, Axis::Y])
                .fix("other.left", &[Axis::X, Axis::Y])
                .pressure("strip.bottom", 1e-6 * YOUNG)
                .pressure("other.top", 1e-6 * YOUNG)
                .traction("strip.right", push)
                .traction("other.right", push)
        };
        for (part, negative) in [(0.0, 0), (0.8, 0), (0.97, 0), (1.03, 1), (1.2, 1), (4.4, 1)] {
            let case = format!("{seam:?}, {part}");
            let reports = driver.run(&step(part), 1, |_, _| {});
            let reports = reports.unwrap_or_else(|error| panic!("{case}: {error}"));
            // But for the node that both supports hold.
            assert_eq!(reports[0].open, 1, "{case}");
            assert_eq!(reports[0].negative_eigenvalues, negative, "{case}");
        }
    }
}

/// Beyond its load a column stays straight, or buckles to the side that a guess along its mode leads to, as the elastica does:
/// its load is (2 K/π)² of Euler's, and its free end is 2 k L/K aside, with K the complete elliptic integral of the modulus k.
#[test]
fn a_guess_along_the_mode_leads_to_its_branch() {
    let over: f64 = 0.02;
    let bent = [1.0, -1.0].map(|side| {
        let mut driver = column(|model| model, (Seam::Cheaper, exact()));
        let step = |part: f64| {
            Step::new("compress")
                .fix("strip.left", &[Axis::X, Axis::Y])
                .fix("floor.bottom", &[Axis::X, Axis::Y])
                .traction("strip.right", [-part * euler() / HEIGHT, 0.0])
        };
        let mut mode = None;
        for part in [0.0, 0.9, 1.0 + over] {
            let reports = driver.run(&step(part), 1, |_, _| {}).expect("in balance");
            mode = reports[0].mode.clone();
        }
        let mode = mode.expect("unstable");
        let end = driver.applied().clone();
        let straight = driver.advance(&end).expect("in balance");
        assert_eq!(straight.negative_eigenvalues, 1);
        let guess: Vec<f64> = mode.iter().map(|u| side * 20.0 * u).collect();
        // What cannot be tried, or another state, forgets the guess.
        driver.guess(&guess).expect("valid");
        let mut nonsense = end.clone();
        nonsense.displacement.insert(0, f64::NAN);
        assert!(driver.advance(&nonsense).is_err());
        let mut saved = Vec::new();
        driver.write(&mut saved);
        for _ in 0..2 {
            let straight = driver.advance(&end).expect("in balance");
            assert_eq!(straight.negative_eigenvalues, 1);
            driver.guess(&guess).expect("valid");
            driver.read(&mut Numbers::Read(&saved)).expect("its own");
        }
        driver.guess(&guess).expect("valid");
        let buckled = driver.advance(&end).expect("in balance");
        assert_eq!(buckled.negative_eigenvalues, 0);
        let nodes = driver.mesh().nodes();
        let is_tip = |x: &[f64; 2]| (x[0] - LENGTH).hypot(x[1] - 0.5 * HEIGHT) < 1e-9;
        let node = nodes.iter().position(is_tip).expect("a node");
        let tip = driver.displacement(node);
        assert!(
            tip.y * guess[2 * node + 1] > 0.0,
            "to the side of the guess"
        );
        // Nothing is guessed twice.
        let again = driver.advance(&end).expect("in balance");
        assert!(again.newton_iterations <= 1, "{again:?}");
        tip
    });
    assert!((bent[0].y + bent[1].y).abs() < 1e-8, "{bent:?}");
    let integral = 0.5 * PI * (1.0 + over).sqrt();
    // K = π/2 (1 + m/4 + 9 m²/64 + …), m = k².
    let m = (0..50).fold(0.0, |m: f64, _| {
        4.0 * (integral / (0.5 * PI) - 1.0 - 9.0 / 64.0 * m * m - 25.0 / 256.0 * m.powi(3))
    });
    let aside = 2.0 * m.sqrt() * LENGTH / integral;
    assert!(
        (bent[0].y.abs() / aside - 1.0).abs() < 0.01,
        "{bent:?}, {aside}"
    );
    let mut driver = column(|model| model, (Seam::Cheaper, exact()));
    let nodes = driver.mesh().nodes().len();
    let few = driver.guess(&[0.0; 3]).expect_err("too few").to_string();
    assert!(
        few.contains("number of displacement increments is 3"),
        "{few}"
    );
    let mut guess = vec![0.0; 2 * nodes];
    guess[1] = f64::NAN;
    assert!(driver.guess(&guess).is_err());
}

/// A cube that spreads under friction between platens, whose shears are all inwards: they would spin it if they did not turn
/// with it.
#[test]
fn a_cube_that_spreads_under_friction_does_not_spin() {
    for seam in BOTH {
        let (wide, high) = (uniform(-5.0, 5.0, 2), uniform(0.0, 10.0, 2));
        let mesh = block3("cube", CellKind::Hex8, &wide, &high, &wide).expect("valid");
        let law = Coulomb::new(0.1).expect("valid");
        let platen = |y: f64, n: f64| Plane::new([0.0, y, 0.0], [0.0, n, 0.0]).expect("valid");
        let elastic = Elastic::new(YOUNG, 0.3).expect("valid");
        let model = Model::with_large_strains(mesh, Solid)
            .material("cube", elastic, CellKind::Hex8.integration())
            .and_then(|m| m.tool("floor", platen(0.0, 1.0)))
            .and_then(|m| m.tool("press", platen(10.0, -1.0)))
            .and_then(|m| m.contact("cube.bottom", "floor", law))
            .and_then(|m| m.contact("cube.top", "press", law))
            .expect("valid");
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let step = Step::new("press").tool("press", [0.0, -0.5, 0.0]);
        let mut slips = false;
        let reports = driver.run(&step, 2, |driver, _| {
            slips |= driver.contacts().iter().any(|c| c.status == Status::Slip);
        });
        assert!(slips);
        for report in reports.expect("in balance") {
            assert_eq!(report.negative_eigenvalues, 0, "{seam:?}");
        }
    }
}
