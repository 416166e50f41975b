//! Every method for the contact problem under every law of friction: one answer.

use super::*;

/// A block pressed and dragged by its top on a rough floor, so far that most of it flows.
fn dragged(friction: &str, method: &str, hardening: &str, [press, drag]: [f64; 2]) -> String {
    format!(
        r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 10]
y = [0, 6]
z = [0, 8]
cells = [3, 2, 2]
[[material]]
on = "b"
young = 210000
poisson = 0.3
yield-stress = 300
{hardening}
[[tool]]
name = "floor"
plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
[[contact]]
surface = "b.bottom"
against = "floor"
friction = {friction}
[[step]]
name = "press"
increments = 2
move = [{{ on = "b.top", u = {{ x = 0, y = {press:?}, z = 0 }} }}]
[[step]]
name = "drag"
increments = 2
move = [{{ on = "b.top", u = {{ x = {drag:?}, y = {press:?}, z = {:?} }} }}]
[solver]
{method}
"#,
        0.5 * drag
    )
}

const LAWS: [&str; 7] = [
    "0",
    "0.3",
    "{ tresca = 50 }",
    "{ coulomb = 0.3, tau-max = 40 }",
    "{ coulomb = [0.3, 0.1], axis = [1, 0, 1] }",
    "{ table = [[0, 0], [200, 30], [600, 60]] }",
    "{ table = [[0, 10], [200, 40], [600, 60]] }",
];

/// The forces of a deck at the end of every increment, of which none is cut.
fn forces(deck: &str) -> Vec<f64> {
    let run = finish(simulation(deck));
    let history = run.history();
    assert_eq!(history.numbers("cuts"), [0.0; 4], "{deck}");
    let all = ["x", "y", "z"].map(|axis| history.numbers(&format!("force.floor.{axis}")));
    all.concat()
}

fn agree(friction: &str, methods: &[(&str, f64)], hardening: &str, motion: [f64; 2]) {
    let of = |method: &str| forces(&dragged(friction, method, hardening, motion));
    let exact = of("contact = \"exact\"");
    let size = exact.iter().fold(0.0, |size: f64, f| size.max(f.abs()));
    assert!(size > 1e3, "{size}");
    for (method, tolerance) in methods {
        let found = of(method);
        assert_eq!(found.len(), exact.len());
        for (a, b) in exact.iter().zip(&found) {
            let off = (a - b).abs() / size;
            assert!(
                off <= *tolerance,
                "{friction} {method}: {off:.1e} off {a:e}"
            );
        }
    }
}

/// Where all of a body flows without hardening its tangent is a small part of its stiffness, by which displacements are weighed.
#[test]
fn every_method_solves_every_law_of_friction() {
    let methods = [
        ("contact = \"uzawa\"", 1e-9),
        ("contact = \"gauss-seidel\"", 1e-9),
        // Its springs give way by some 1e4 N over 1e12 N/mm, of 0.05 mm.
        (
            "contact = { penalty = { normal = 1e12, tangent = 1e12 } }",
            1e-7,
        ),
    ];
    for friction in LAWS {
        agree(friction, &methods, "", [-0.05, 0.1]);
    }
}

/// A body that hardens bears any contact forces, as the paper's nesting asks of it.
#[test]
fn the_papers_nesting_solves_every_law_of_friction() {
    for friction in LAWS {
        let methods = [("nesting = \"outside\"", 1e-7)];
        agree(
            friction,
            &methods,
            "hardening = { linear = 5000 }",
            [-0.03, 0.05],
        );
    }
}

/// One that does not harden cannot bear all forces that corrections come by: that is told of the method, and not of the load.
#[test]
fn a_method_that_fails_is_not_a_limit_of_the_load() {
    let deck = dragged("0.3", "nesting = \"outside\"", "", [-0.05, 0.1]).replace(
        "increments = 2",
        "increments = { start = 0.5, min = 0.5, max = 0.5 }",
    );
    let mut run = simulation(&deck);
    let error = loop {
        match run.advance(&mut |_, _| ControlFlow::Continue(())) {
            Ok(more) => assert!(more.is_some(), "converges"),
            Err(error) => break error.to_string(),
        }
    };
    for told in [
        "Uzawa around the nonlinear solve",
        "left a residual of",
        "expected at most",
        "take the method \"exact\"",
        "tells nothing of the load",
    ] {
        assert!(error.contains(told), "{told:?} in {error}");
    }
    assert!(!error.contains("limit"), "{error}");
    let outcome = run.outcome();
    let diagnosis = outcome.diagnosis.expect("a diagnosis").to_string();
    assert!(diagnosis.contains("set contact = \"exact\""), "{diagnosis}");
}
