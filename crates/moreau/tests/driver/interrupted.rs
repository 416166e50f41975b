//! Increments that whoever watches them breaks off: nothing is lost, and going on changes no bit.

use crate::collapse::{cylinder, limit, pressed};
use crate::steps::on_floor;
use moreau_driver::{Axis, Driver, IncrementError, IncrementReport, Seam, Settings, Step};
use std::ops::ControlFlow;

fn bits(driver: &Driver<2>) -> Vec<u64> {
    let mut numbers = Vec::new();
    driver.write(&mut numbers);
    numbers.into_iter().map(f64::to_bits).collect()
}

/// Steps to their end; each increment is interrupted at every `every`-th of its iterates, and begun again.
fn run(
    mut driver: Driver<2>,
    steps: &[Step<2>],
    every: Option<usize>,
) -> (Driver<2>, Vec<IncrementReport>) {
    let (mut reports, mut interruptions) = (Vec::new(), 0);
    for step in steps {
        let mut ramp = driver.begin(step, 4).expect("valid");
        while !ramp.is_done() {
            let mut allowed = every.map_or(usize::MAX, |every| every - 1);
            let (before, committed) = (ramp.clone(), bits(&driver));
            let outcome = loop {
                let mut left = allowed;
                let outcome = driver.proceed(&mut ramp, &mut |_| match left.checked_sub(1) {
                    Some(fewer) => {
                        left = fewer;
                        ControlFlow::Continue(())
                    }
                    None => ControlFlow::Break(()),
                });
                let Err(IncrementError::Interrupted) = outcome else {
                    break outcome;
                };
                assert_eq!(bits(&driver), committed, "after {allowed} iterates");
                assert_eq!(ramp, before);
                interruptions += 1;
                allowed += every.unwrap_or(1);
            };
            match outcome {
                Ok(report) => reports.push(report),
                Err(IncrementError::Collapse { .. }) => break,
                Err(error) => panic!("{error}"),
            }
        }
    }
    assert!(every.is_none() || interruptions > 2 * reports.len());
    (driver, reports)
}

fn interrupted_is_undisturbed(make: impl Fn() -> Driver<2>, steps: &[Step<2>]) {
    let (undisturbed, reports) = run(make(), steps, None);
    let (other, others) = run(make(), steps, Some(1));
    assert_eq!(others, reports);
    assert_eq!(bits(&other), bits(&undisturbed));
}

#[test]
fn an_increment_that_is_interrupted_and_begun_again_has_the_same_bits() {
    let press = Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.1);
    let lift = Step::new("lift").fix("block.left", &[Axis::X]);
    for (iterations, seam) in [
        (50, Seam::Condensed),
        (50, Seam::Tied),
        // Increments that are cut on the way.
        (3, Seam::Cheaper),
    ] {
        let settings = || Settings {
            iterations,
            seam,
            ..Settings::default()
        };
        let make = || on_floor([6, 2], 0.0, 0.3, settings());
        interrupted_is_undisturbed(make, &[press.clone(), lift.clone()]);
    }
}

/// Loads beyond collapse: attempts that fail, the path and its end.
#[test]
fn a_path_that_is_interrupted_has_the_same_bits() {
    let make = || cylinder(Settings::default());
    interrupted_is_undisturbed(make, &[pressed(1.25 * limit())]);
    // A path that passes the end of the step.
    let settings = || Settings {
        iterations: 4,
        ..Settings::default()
    };
    interrupted_is_undisturbed(|| cylinder(settings()), &[pressed(0.97 * limit())]);
}
