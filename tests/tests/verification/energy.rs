//! Balance of energy: what the loads do is stored or dissipated, to the order of the time
//! integration; not the certificate of the contact law, which is exact in every increment.

use moreau::contact::Penalty;
use moreau::driver::{Driver, Energies, Settings};
use verification::problems::Fallible;
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
