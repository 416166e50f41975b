//! Increments as transactions, and independence of the number of threads, to the last bit; not
//! restart from files.

use moreau::driver::{Axis, Driver, Energies, IncrementError, IncrementReport, Step};
use verification::problems::Fallible;
use verification::problems::punched::Punched;

/// All that a driver tells, as bits.
#[derive(Debug, PartialEq)]
struct Snapshot {
    displacement: Vec<u64>,
    contacts: Vec<u64>,
    stress: Vec<u64>,
    energies: [u64; 5],
    increments: usize,
}

fn snapshot(driver: &Driver<2>) -> Snapshot {
    let bits = |v: &f64| v.to_bits();
    let nodes = 0..driver.mesh().nodes().len();
    let Energies {
        external_work,
        stored,
        plastic_dissipation,
        friction_dissipation,
        penalty,
    } = driver.energies();
    let energies = [
        external_work,
        stored,
        plastic_dissipation,
        friction_dissipation,
        penalty,
    ];
    Snapshot {
        displacement: nodes
            .flat_map(|n| driver.displacement(n).iter().map(bits).collect::<Vec<_>>())
            .collect(),
        contacts: driver
            .contacts()
            .iter()
            .flat_map(|c| c.u.iter().chain(&c.t).map(bits).collect::<Vec<_>>())
            .collect(),
        stress: driver
            .points()
            .iter()
            .flat_map(|p| {
                p.stress
                    .iter()
                    .chain([&p.plastic_strain])
                    .map(bits)
                    .collect::<Vec<_>>()
            })
            .collect(),
        energies: energies.map(f64::to_bits),
        increments: driver.increments(),
    }
}

/// What a report says of the increment itself; factorisations depend on what was at hand.
fn said(report: &IncrementReport) -> IncrementReport {
    IncrementReport {
        factorisations: 0,
        ..report.clone()
    }
}

/// Increments that must fail: a crushing pressure, with the punch held or let go.
fn crushing(punched: &Punched, driver: &Driver<2>) -> Fallible<Vec<moreau::driver::Loading<2>>> {
    let held = punched.press(0.1).pressure("block.right", 1e4);
    let free = Step::new("crush")
        .fix("block.left", &[Axis::X])
        .pressure("block.top", 1e4);
    Ok(vec![driver.loading(&held)?, driver.loading(&free)?])
}

#[test]
fn failed_increment_leaves_no_trace() -> Fallible {
    let punched = Punched::default();
    let (mut clean, mut tried) = (punched.half()?, punched.half()?);
    for step in 1..=8 {
        let press = punched.press(0.01 * f64::from(step));
        let loading = clean.loading(&press)?;
        let expected = clean.advance(&loading)?;
        let before = snapshot(&tried);
        for bad in crushing(&punched, &tried)? {
            match tried.advance(&bad) {
                Err(
                    IncrementError::NotConverged { .. }
                    | IncrementError::Mechanism { .. }
                    | IncrementError::Contact { .. },
                ) => {}
                other => panic!("expected a failure, found {other:?}"),
            }
            assert_eq!(
                snapshot(&tried),
                before,
                "a failed increment changed the state"
            );
        }
        let found = tried.advance(&loading)?;
        assert_eq!(said(&found), said(&expected), "increment {step}");
        assert_eq!(snapshot(&tried), snapshot(&clean), "increment {step}");
    }
    Ok(())
}

#[test]
fn one_and_two_threads_agree_to_the_bit() -> Fallible {
    // More cells than a thread takes at once.
    let punched = Punched {
        cells: (20, 8),
        ..Punched::default()
    };
    let run = |threads: usize| -> Fallible<(Vec<IncrementReport>, Snapshot)> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let outcome = pool.install(|| -> Result<_, String> {
            let mut driver = punched.half().map_err(|e| e.to_string())?;
            let reports = driver
                .run(&punched.press(0.1), 5, |_, _| {})
                .map_err(|e| e.to_string())?;
            Ok((reports, snapshot(&driver)))
        });
        Ok(outcome?)
    };
    let one = run(1)?;
    assert!(
        one.0.iter().any(|r| r.plastic_fraction > 0.1),
        "nothing happened"
    );
    for threads in [2, 3] {
        assert_eq!(run(threads)?, one, "{threads} threads");
    }
    Ok(())
}

/// The same run twice, in one process.
#[test]
fn the_same_run_gives_the_same_bits() -> Fallible {
    let punched = Punched::default();
    let run = || -> Fallible<Snapshot> {
        let mut driver = punched.half()?;
        driver.run(&punched.press(0.05), 5, |_, _| {})?;
        Ok(snapshot(&driver))
    };
    assert_eq!(run()?, run()?);
    Ok(())
}
