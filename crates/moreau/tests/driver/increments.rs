//! How steps are divided into increments, and what is told of them.

use crate::steps::on_floor;
use moreau_contact::{Ball, ContactSolver, Penalty, Plane, SemismoothNewton};
use moreau_driver::{Axis, Driver, IncrementError, Increments, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic, VonMises};
use moreau_mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use std::ops::ControlFlow;

#[test]
fn a_step_that_is_too_long_is_cut_and_ends_where_it_should() {
    let press = |increments, iterations| {
        let settings = Settings {
            iterations,
            ..Settings::default()
        };
        let mut driver = on_floor([10, 2], 0.0, 0.1, settings);
        let step =
            Step::new("press")
                .fix("block.left", &[Axis::X])
                .displace("punch", Axis::Y, -0.2);
        let reports = driver
            .run(&step, increments, |_, _| {})
            .expect("converges when cut");
        (-driver.reaction("punch").expect("exists")[1], reports)
    };
    let (load, reports) = press(4, 4);
    let cuts: usize = reports.iter().map(|r| r.cuts).sum();
    assert!(
        cuts > 0,
        "four iterations should not do for 0.05 mm at once"
    );
    assert_eq!(reports.last().map(|r| r.fraction), Some(1.0));
    let fractions: Vec<f64> = reports.iter().map(|r| r.fraction).collect();
    assert!(fractions.windows(2).all(|w| w[0] < w[1]));
    for whole in [0.25, 0.5, 0.75] {
        assert!(
            fractions.contains(&whole),
            "the ends of whole increments are met: {fractions:?}"
        );
    }
    // Increments grow again: fewer than if all had the shortest length.
    let shortest = fractions
        .windows(2)
        .map(|w| w[1] - w[0])
        .fold(fractions[0], f64::min);
    assert!((fractions.len() as f64) < 1.0 / shortest);
    let (fine, _) = press(40, 40);
    assert!((load / fine - 1.0).abs() < 1e-3, "{load} against {fine}");
}

/// Every iterate is told, those of attempts that fail too.
#[test]
fn iterates_are_told() {
    let settings = Settings {
        iterations: 3,
        ..Settings::default()
    };
    let mut driver = on_floor([6, 2], 0.0, 0.3, settings);
    let press = Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.1);
    let mut ramp = driver.begin(&press, 1).expect("valid");
    let mut seen = Vec::new();
    let report = driver.proceed(&mut ramp, &mut |i| {
        assert_eq!(i.d_u.len(), i.residual.len());
        let largest = i.residual.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        assert_eq!(largest, i.out_of_balance);
        seen.push((i.cuts, i.newton, i.out_of_balance));
        ControlFlow::Continue(())
    });
    let report = report.expect("converges once it is short enough");
    assert!(report.cuts > 0 && seen[0].0 == 0);
    let last: Vec<f64> = seen
        .iter()
        .filter(|s| s.0 == report.cuts && s.1 > 0)
        .map(|s| s.2)
        .collect();
    assert_eq!(last, report.residuals);
}

/// Increments that grow: few of them, of at most the greatest length, and the end is met exactly.
#[test]
fn easy_increments_grow() {
    let increments = Increments {
        start: 0.02,
        min: None,
        max: 0.3,
    };
    let step = Step::new("load").pressure("block.top", 40.0);
    let mut equal = on_floor([6, 2], 0.0, 0.3, Settings::default());
    equal.run(&step, 50, |_, _| {}).expect("held");
    let mut driver = on_floor([6, 2], 0.0, 0.3, Settings::default());
    let reports = driver.run(&step, increments, |_, _| {}).expect("held");
    let ends: Vec<f64> = reports.iter().map(|r| r.fraction).collect();
    assert!(ends.len() < 20 && ends[0] == 0.02, "{ends:?}");
    assert_eq!(ends.last(), Some(&1.0));
    assert!(
        ends.windows(2)
            .all(|e| e[1] > e[0] && e[1] - e[0] <= 0.3 + 1e-12)
    );
    // Proportional loading of an elastic block: the path does not matter.
    for node in 0..driver.mesh().nodes().len() {
        let difference = driver.displacement(node) - equal.displacement(node);
        assert!(difference.norm() < 1e-10);
    }
}

/// Where Newton is given too few iterations, increments are cut down to the least length, and no
/// further.
#[test]
fn increments_are_cut_to_the_least() {
    let increments = Increments {
        start: 0.1,
        min: Some(1e-3),
        max: 0.2,
    };
    let settings = Settings {
        iterations: 1,
        ..Settings::default()
    };
    let mut driver = on_floor([6, 2], 0.0, 0.3, settings);
    let step = Step::new("load")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.2);
    match driver.run(&step, increments, |_, _| {}) {
        Err(IncrementError::Stopped {
            reached, smallest, ..
        }) => {
            assert!(reached < 0.9, "{reached}");
            assert!((1e-3..2e-3).contains(&smallest), "{smallest}");
        }
        other => panic!("{other:?}"),
    }
}

/// An elastic block that a plate comes down on through a gap: no work is done on the way there, and all that is done
/// from there on is stored, in the block and in the springs of a penalty, however many increments it takes.
#[test]
fn what_a_tool_does_is_stored_and_the_way_to_the_block_is_free() {
    const STIFF: f64 = 1e5;
    let energies = |contact: Box<dyn ContactSolver<2>>, increments: usize| {
        let (x, y) = (uniform(0.0, 2.0, 2), uniform(0.0, 1.0, 2));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        let plate = Plane::new([0.0, 1.01], [0.0, -1.0]).expect("valid");
        let steel = Elastic::new(210e3, 0.3).expect("valid");
        let smooth = Coulomb::new(0.0).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material("block", steel, Integration::Reduced)
            .and_then(|m| m.tool("plate", plate))
            .and_then(|m| m.contact("block.top", "plate", smooth))
            .expect("valid");
        let settings = Settings {
            contact,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let press = Step::new("press")
            .fix("block.left", &[Axis::X])
            .fix("block.bottom", &[Axis::Y])
            .tool("plate", [0.0, -0.03]);
        driver.run(&press, increments, |_, _| {}).expect("solved");
        let squares = driver.contacts().iter().map(|c| c.t[0] * c.t[0]);
        (driver.energies(), 0.5 * squares.sum::<f64>() / STIFF)
    };
    for increments in [1, 2, 5] {
        let (exact, _) = energies(Box::<SemismoothNewton>::default(), increments);
        assert!(exact.stored > 1.0 && exact.penalty == 0.0, "{exact:?}");
        assert!(exact.imbalance().abs() < 1e-9 * exact.stored, "{exact:?}");
        let penalty = Penalty::new(STIFF, STIFF).expect("valid");
        let (soft, springs) = energies(Box::new(penalty), increments);
        assert!(springs > 1e-2 * soft.stored);
        assert!(
            (soft.penalty - springs).abs() < 1e-9 * springs,
            "{soft:?} {springs}"
        );
        assert!(soft.imbalance().abs() < 1e-9 * soft.stored, "{soft:?}");
    }
}

/// What is told of every iterate and what is reported in the end agree, ways that led to no balance included: an increment
/// that folds cells at its first guess goes there in parts.
#[test]
fn every_iteration_of_an_increment_is_counted() {
    let side = uniform(0.0, 1.0, 3);
    let mesh = block2("b", CellKind::Quad8, &side, &side).expect("valid");
    let law = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("b", law, Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("press")
        .fix("b.bottom", &[Axis::X, Axis::Y])
        .fix("b.top", &[Axis::X])
        .displace("b.top", Axis::Y, -0.6);
    let mut ramp = driver.begin(&step, 1).expect("valid");
    let (mut told, mut ways) = (0, 0);
    let report = driver.proceed(&mut ramp, &mut |now| {
        match now.newton {
            0 => ways += 1,
            _ => told += 1,
        }
        ControlFlow::Continue(())
    });
    let report = report.expect("converges");
    assert!(ways > 2 && report.cuts == 0, "{ways} {report:?}");
    assert_eq!(report.newton_iterations, told);
}

/// A roll that has bitten a strip and begins to turn makes all that it touches slip the other way at once: contacts that do
/// not settle do when the increment is followed in parts, and iterates do not wander for it.
#[test]
fn contacts_that_turn_round_settle_in_parts() {
    let (x, y) = (uniform(0.0, 20.0, 50), uniform(0.0, 1.0, 2));
    let mesh = block2("strip", CellKind::Quad8, &x, &y).expect("valid");
    let law = VonMises::new(70e3, 0.33, 100.0)
        .and_then(|law| law.with_isotropic(100.0))
        .expect("valid");
    let roll = Ball::new([13.0, 61.0], 60.0).expect("valid");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("strip", law, Integration::Reduced)
        .and_then(|m| m.tool("roll", roll))
        .and_then(|m| m.contact("strip.top", "roll", Coulomb::new(0.15).expect("valid")))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let bite = Step::new("bite")
        .fix("strip.bottom", &[Axis::Y])
        .tool("roll", [0.0, -0.2]);
    driver.run(&bite, 6, |_, _| {}).expect("bites");
    let turn = bite.turn("roll", [0.0, 0.0, 1.0], 0.2f64.to_radians());
    let mut ramp = driver.begin(&turn, 1).expect("valid");
    let mut ways = 0;
    let report = driver.proceed(&mut ramp, &mut |now| {
        ways += usize::from(now.newton == 0);
        ControlFlow::Continue(())
    });
    let report = report.expect("turns");
    assert!(ways > 1, "the increment is too easy to tell");
    assert!(
        report.cuts == 0 && report.newton_iterations <= 40,
        "{ways} ways, {} iterations",
        report.newton_iterations
    );
}
