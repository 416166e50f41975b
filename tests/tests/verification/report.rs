//! Cases of `cargo xtask verify` in their quick form, but for the slowest; not what they compute, which is in the
//! library of this package.

use verification::{Options, cases};

/// Checks of a case by name. Times are left to the report: a test is no place to measure them.
fn assert_passes(name: &str) {
    let all = cases::all();
    let case = all
        .iter()
        .find(|c| c.name == name)
        .expect("the case exists");
    let options = Options {
        quick: true,
        progress: &|_| {},
    };
    let outcome = (case.run)(&options).expect("the case runs");
    let timed = |name: &str| name.starts_with("time of");
    let failed: Vec<_> = outcome
        .checks
        .iter()
        .filter(|c| !c.pass && !timed(&c.name))
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(outcome.checks.len() >= 8 && !outcome.figures.is_empty());
    for figure in &outcome.figures {
        assert!(
            figure.svg.starts_with("<svg") && figure.svg.ends_with("</svg>"),
            "{}",
            figure.name
        );
    }
    for table in &outcome.tables {
        assert!(
            table.rows.iter().all(|r| r.len() == table.header.len()),
            "{}",
            table.name
        );
    }
}

#[test]
fn prandtl_indentation() {
    assert_passes("prandtl");
}

#[test]
fn punched_block() {
    assert_passes("block");
}

#[test]
fn punch_in_space() {
    assert_passes("punch-in-space");
}

#[test]
fn penalty_study() {
    assert_passes("penalty");
}

#[test]
fn greco_block() {
    assert_passes("greco");
}

#[test]
fn two_bodies_pressed_and_dragged() {
    assert_passes("cattaneo");
}

#[test]
fn punch_with_a_rounded_edge() {
    assert_passes("rounded-punch");
}

#[test]
fn ring_compression() {
    assert_passes("ring");
}

#[test]
fn loads_beyond_collapse() {
    assert_passes("collapse");
}
