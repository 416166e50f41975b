//! Doubts of steps to collapse: displacements of a mechanism have no size, stresses have.

use super::*;

/// The doubts of a run that ends in collapse at a load factor.
fn doubts(deck: &str, factor: f64) -> Vec<String> {
    let run = finish(simulation(deck));
    let outcome = run.outcome();
    let (_, collapse) = outcome.collapse.clone().expect("a limit");
    assert!(
        (collapse.load_factor / factor - 1.0).abs() < 0.02,
        "{collapse}"
    );
    outcome.warnings
}

/// A block that is weighed down by 10 MPa on half of its width of 10, and pushed at its height of 20, topples at 2.5 of 20 MPa: about
/// its corner nothing holds it, which is no buckling.
#[test]
fn what_topples_does_not_buckle() {
    let deck = r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 10], y = [0, 20], cells = [10, 16] }]
material = [{ on = "b", young = 200e3, poisson = 0.3 }]
tool = [{ name = "f", plane = { point = [0, 0], normal = [0, 1] } }]
contact = [{ surface = "b.bottom", against = "f", friction = 0.9 }]
[[step]]
name = "w"
increments = 1
load = [{ on = "b.top", pressure = 10.0 }]
[[step]]
name = "a"
increments = 4
until = "collapse"
load = [{ on = "b.top", pressure = 10.0 }, { on = "b.top", traction = [20, 0] }]
"#;
    let told = doubts(deck, 0.125);
    assert!(!told.iter().any(|t| t.contains("buckling")), "{told:#?}");
}

/// A column 20 times as high as wide yields in plane strain at 2/√3 · 300 of 500 MPa, and has buckled before: at
/// π² E/(1 − ν²)/12/40² of its stresses, with the whole height free.
#[test]
fn what_buckles_before_it_collapses_is_told() {
    let deck = r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 1], y = [0, 20], cells = [2, 20] }]
material = [{ on = "b", young = 200e3, poisson = 0.3, yield-stress = 300.0 }]
[[step]]
name = "a"
increments = 8
until = "collapse"
fix = [{ on = "b.bottom", u = ["x", "y"] }]
load = [{ on = "b.top", pressure = 500.0 }]
"#;
    let yields = 300.0 * 2.0 / 3f64.sqrt();
    let told = doubts(deck, yields / 500.0);
    let buckling = told.iter().find(|t| t.contains("buckling")).expect("told");
    assert!(buckling.contains("has buckled before"), "{buckling}");
    let (_, after) = buckling.split_once(", at ").expect("a factor");
    let (factor, _) = after.split_once(" times").expect("a factor");
    let factor: f64 = factor.parse().expect("a number");
    let euler = std::f64::consts::PI.powi(2) * 200e3 / 0.91 / 12.0 / 1600.0 / yields;
    assert!((factor / euler - 1.0).abs() < 0.05, "{factor} of {euler}");
}

/// A strip is pressed by a plate of its width: once it flows the plate sinks as far as it takes to know the load, and what has
/// flowed out at its side is then within the plane of the plate.
#[test]
fn what_a_tool_has_passed_in_a_mechanism_is_no_doubt() {
    let deck = r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [{ name = "b", element = "quad8", x = [0, 20], y = [0, 5], cells = [20, 5] }]
material = [{ on = "b", young = 200e3, poisson = 0.3, yield-stress = 300.0 }]
tool = [{ name = "w", plane = { point = [0, 5], normal = [0, -1] } }]
contact = [{ surface = "b.top", against = "w", friction = 0.1 }]
[[step]]
name = "press"
increments = 10
until = "collapse"
fix = [{ on = "b.bottom", u = ["y"] }, { on = "b.left", u = ["x"] }]
tools = [{ name = "w", force = [0, -1e4] }]
"#;
    // Siebel: 2/√3 · 300 · 20 N, and half of μ a/h of it more.
    let siebel = 2.0 / 3f64.sqrt() * 300.0 * 20.0 * (1.0 + 0.5 * 0.1 * 4.0) / 1e4;
    let told = doubts(deck, siebel);
    for words in ["between its nodes", "are within the tool"] {
        assert!(!told.iter().any(|t| t.contains(words)), "{told:#?}");
    }
}
