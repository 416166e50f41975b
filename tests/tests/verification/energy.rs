//! Balance of energy: what the loads do is stored or dissipated, to the order of the time
//! integration; not the certificate of the contact law, which is exact in every increment.

use moreau::contact::Penalty;
use moreau::driver::{Driver, Energies, Settings};
use moreau::mesh::PlaneStrain;
use verification::problems::Fallible;
use verification::problems::large::SQUARE;
use verification::problems::punched::Punched;

/// Stress that is never reached [MPa].
const ELASTIC: f64 = 1e9;

fn energies(
    punched: Punched,
    depth: f64,
    steps: usize,
    settings: Settings<2>,
) -> Fallible<Energies> {
    let mut driver: Driver<2> = punched.driver(punched.half_mesh()?, settings)?;
    let reports = driver.run(&punched.press(depth), steps, |_, _| {})?;
    assert!(reports.iter().all(|r| r.cuts == 0), "equal increments");
    Ok(driver.energies())
}

/// Asserts that a sequence at least halves, with one part in eight allowed for the increments in
/// which a contact or a point changes its status.
#[track_caller]
fn halves(imbalances: &[f64]) {
    for pair in imbalances.windows(2) {
        assert!(
            pair[1] <= 0.5 * 1.125 * pair[0],
            "not of first order: {imbalances:?}"
        );
    }
}

/// Every kind of energy is there, and the imbalance halves with the increment.
#[test]
fn punched_block_balances_energy_to_first_order() -> Fallible {
    for friction in [0.0, 0.1, 0.3] {
        let punched = Punched {
            friction,
            ..Punched::default()
        };
        let mut imbalances = Vec::new();
        for steps in [40, 80, 160] {
            let e = energies(punched, 0.1, steps, Settings::default())?;
            assert!(e.external_work > 0.0 && e.stored > 0.0 && e.plastic_dissipation > 0.0);
            assert_eq!(e.friction_dissipation > 0.0, friction > 0.0);
            assert_eq!(e.penalty, 0.0);
            let imbalance = e.imbalance().abs() / e.external_work;
            assert!(
                imbalance < 0.4 / steps as f64,
                "{steps} steps: {imbalance:.2e}"
            );
            imbalances.push(imbalance);
        }
        halves(&imbalances);
    }
    Ok(())
}

/// An elastic block balances its energy to rounding, in any number of increments.
fn balances(friction: f64, holds: impl Fn(&Energies) -> bool) -> Fallible {
    for steps in [1, 7] {
        let e = energies(elastic(friction), 0.1, steps, Settings::default())?;
        assert!(e.external_work > 0.0 && holds(&e), "{e:?}");
        assert!(e.imbalance().abs() < 1e-10 * e.external_work, "{e:?}");
    }
    Ok(())
}

fn elastic(friction: f64) -> Punched {
    Punched {
        friction,
        yield_stress: ELASTIC,
        ..Punched::default()
    }
}

#[test]
fn elastic_frictionless_block_balances_energy_exactly() -> Fallible {
    balances(0.0, |e| {
        e.stored > 0.0 && e.plastic_dissipation == 0.0 && e.friction_dissipation == 0.0
    })
}

/// Friction that never slips does no work.
#[test]
fn elastic_sticking_block_balances_energy_exactly() -> Fallible {
    balances(1e3, |e| {
        e.friction_dissipation.abs() < 1e-10 * e.external_work
    })
}

fn springs(k: f64) -> Fallible<Settings<2>> {
    Ok(Settings {
        contact: Box::new(Penalty::new(k, k)?),
        ..Settings::default()
    })
}

/// The springs of the penalty method hold what the balance would lack.
#[test]
fn penalty_springs_are_in_the_balance() -> Fallible {
    for k in [1e5, 1e6, 1e7] {
        for steps in [1, 5] {
            let e = energies(elastic(0.0), 0.1, steps, springs(k)?)?;
            assert!(e.penalty > 1e-10 * e.external_work, "{e:?}");
            assert!(
                e.imbalance().abs() < 1e-9 * e.external_work,
                "k = {k:e}: {e:?}"
            );
        }
    }
    // With friction and plastic flow: of the order of the step.
    let punched = Punched::default();
    let mut imbalances = Vec::new();
    for steps in [40, 80, 160] {
        let e = energies(punched, 0.1, steps, springs(1e6)?)?;
        let imbalance = e.imbalance().abs() / e.external_work;
        imbalances.push(imbalance);
    }
    halves(&imbalances);
    Ok(())
}

/// Under large strains the balance closes to the second order of the increment, while pressures grow, and points
/// slip.
#[test]
fn the_balance_of_large_strains_is_of_second_order() -> Fallible {
    let imbalance = |increments: usize| -> Fallible<f64> {
        let mut driver = SQUARE.driver(PlaneStrain::default(), 500.0, 0.2)?;
        let step = SQUARE.held("upset").tool("platen", [0.0, -2.0]);
        let mut course = vec![Energies::default()];
        driver.run(&step, increments, |_, report| course.push(report.energies))?;
        for pair in course.windows(2) {
            let spent = pair[1].plastic_dissipation - pair[0].plastic_dissipation;
            let rubbed = pair[1].friction_dissipation - pair[0].friction_dissipation;
            assert!(spent >= 0.0 && rubbed >= 0.0, "{spent} {rubbed}");
        }
        // The increment in which it first yields is counted by its ends.
        let part = &course[increments / 4..];
        let [first, last] = [part[0], part[part.len() - 1]].map(|e| e.imbalance());
        Ok((last - first) / course[increments].external_work)
    };
    let [coarse, fine] = [imbalance(16)?, imbalance(32)?];
    assert!(
        coarse.abs() < 2e-3 && fine.abs() < 0.3 * coarse.abs(),
        "{coarse} {fine}"
    );
    Ok(())
}
