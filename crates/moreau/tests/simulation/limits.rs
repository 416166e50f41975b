//! Limit loads: what has none, and what the load factor is of.

use super::*;

/// A bar of 1 mm² that flows at 300 MPa, hardens as told, and is stressed at the start; its steps follow.
fn bar(hardening: &str, stress: f64, steps: &str) -> String {
    let initial = match stress == 0.0 {
        true => String::new(),
        false => format!("initial = [{{ on = \"b\", stress = {{ yy = {stress:?} }} }}]"),
    };
    format!(
        r#"units = "mm-N-MPa"
analysis = "solid"
mesh = {{ block = [{{ name = "b", element = "hex20", x = [0, 1], y = [0, 1], z = [0, 1], cells = [1, 1, 1] }}] }}
material = [{{ on = "b", young = 210e3, poisson = 0.3, yield-stress = 300.0{hardening} }}]
{initial}
{steps}"#
    )
}

const HELD: &str = r#"fix = [{ on = "b.left", u = ["x"] }, { on = "b.bottom", u = ["y"] }, { on = "b.back", u = ["z"] }]"#;

fn pulled(name: &str, load: f64, more: &str) -> String {
    format!(
        "[[step]]\nname = \"{name}\"\nincrements = 5\n{more}\n{HELD}\nload = [{{ on = \"b.top\", pressure = {:?} }}]\n",
        -load
    )
}

const COLLAPSE: &str = "until = \"collapse\"";

#[test]
fn what_hardens_has_no_limit_load() {
    let ended = |hardening: &str, until: &str| {
        let mut run = simulation(&bar(hardening, 0.0, &pulled("s", 1000.0, until)));
        while let Ok(Some(_)) = run.advance(&mut |_, _| ControlFlow::Continue(())) {}
        (run.outcome().status, run.outcome().collapse)
    };
    for hardening in ["linear = 10", "voce = [100, 1]", "voce = [100, 0.01]"] {
        for until in [COLLAPSE, ""] {
            let (status, collapse) = ended(&format!(", hardening = {{ {hardening} }}"), until);
            let told = matches!(&status, RunStatus::NotConverged(text) if text.contains("no limit load up to"));
            assert!(told && collapse.is_none(), "{hardening} {until} {status:?}");
        }
    }
    let (status, collapse) = ended(", hardening = { voce = [100, 20] }", COLLAPSE);
    let (_, collapse) = collapse.expect("a limit");
    assert!(status == RunStatus::Done && !collapse.added, "{status:?}");
    assert!((collapse.load_factor - 0.4).abs() < 1e-6);
    assert_eq!(collapse.is_strict(), Some(true));
}

/// From 200 N of a step before to −1000 N: −300 N is an eighth of 800 N beyond, and told as such.
#[test]
fn a_load_factor_under_forces_is_a_part_of_the_way() {
    let steps = pulled("pull", 200.0, "") + &pulled("more", 1000.0, COLLAPSE);
    let run = finish(simulation(&bar("", 0.0, &steps)));
    let (_, collapse) = run.outcome().collapse.clone().expect("a limit");
    assert!(
        collapse.added && (collapse.load_factor - 0.125).abs() < 1e-6,
        "{collapse}"
    );
    assert!(
        collapse
            .to_string()
            .contains("of the way from the forces at its start")
    );
}

/// What holds a stress at the start would be a part of the load; let go before, it is none.
#[test]
fn a_stress_at_the_start_is_let_go_before_a_limit_load() {
    let at_once = bar("", 100.0, &pulled("s", 1000.0, COLLAPSE));
    let (refused, findings) = Simulation::open(&at_once, &examples(), &Given::default());
    let said = findings.render("deck", &at_once, false);
    assert!(refused.is_none());
    assert!(
        said.contains("in the first step with a stress at the start"),
        "{said}"
    );
    let before = format!("[[step]]\nname = \"let-go\"\nincrements = 1\n{HELD}\n");
    let run = finish(simulation(&bar(
        "",
        100.0,
        &(before + &pulled("s", 1000.0, COLLAPSE)),
    )));
    let (_, collapse) = run.outcome().collapse.clone().expect("a limit");
    assert!(
        !collapse.added && (collapse.load_factor - 0.3).abs() < 1e-6,
        "{collapse}"
    );
}

/// A bar that does not harden, pulled: the force σ_y a shrinks with its section from where it begins to flow, at
/// exp(−σ_y/E) σ_y A. Told is what was in balance, and no more.
#[test]
fn a_limit_that_is_told_was_carried() {
    for increments in [3, 7, 10] {
        let mut pulled = simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "axisymmetric"
strain = "finite"
[[mesh.block]]
name = "bar"
element = "quad8"
x = [0, 2]
y = [0, 10]
cells = [1, 2]
[[material]]
on = "bar"
young = 200000
poisson = 0.3
yield-stress = 300
[[step]]
name = "pull"
increments = {increments}
fix = [{{ on = "bar.bottom", u = ["y"] }}]
load = [{{ on = "bar.top", traction = [0, 600] }}]
"#
        ));
        for _ in 0..increments + 2 {
            advance(&mut pulled);
        }
        let exact = 0.5 * (-300.0f64 / 200e3).exp();
        let warnings = pulled.outcome().warnings;
        let told = warnings.iter().find(|w| w.contains("passes its limit"));
        let told = told.unwrap_or_else(|| panic!("{increments}: {warnings:?}"));
        let (_, after) = told.split_once("after ").expect("a load factor");
        let factor: f64 = after
            .split(' ')
            .next()
            .and_then(|f| f.parse().ok())
            .expect("a number");
        assert!(
            factor <= exact * (1.0 + 1e-6) && factor > 0.99 * exact,
            "{increments}: {told}"
        );
    }
}

/// A block that two jaws squeeze by 10 MPa on 10 mm and that weighs 70.4 N is held up to 2 μ N of friction if all are rigid. Under
/// small strains, too, surfaces are paired where the loads have taken them: normals turn with the bodies, and what that takes is in
/// proportion to the strains.
#[test]
fn jaws_hold_what_normals_of_the_bodies_as_they_are_let_them() {
    let factor = |young: f64| {
        let fix = r#"fix = [{ on = "a.left", u = ["x", "y"] }, { on = "b.right", u = ["y"] }]"#;
        let squeezed = r#"{ on = "b.right", pressure = 10.0 }"#;
        let deck = format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh.block = [
    {{ name = "a", element = "quad8", x = [0, 3], y = [0, 10], cells = [2, 6] }},
    {{ name = "c", element = "quad8", x = [3, 7], y = [1, 9], cells = [3, 5] }},
    {{ name = "b", element = "quad8", x = [7, 10], y = [0, 10], cells = [2, 7] }},
]
material = [{{ on = ["a", "b", "c"], young = {young:?}, poisson = 0.3 }}]
contact = [
    {{ surface = "c.left", against = "a.right", friction = 0.3 }},
    {{ surface = "c.right", against = "b.left", friction = 0.3 }},
]
[[step]]
name = "grip"
increments = 1
{fix}
load = [{squeezed}]
[[step]]
name = "pull"
increments = 4
{COLLAPSE}
{fix}
load = [{squeezed}, {{ on = "c", body-force = [0, -2.2] }}]
"#
        );
        let run = finish(simulation(&deck));
        run.outcome().collapse.expect("a limit").1.load_factor
    };
    let rigid = 2.0 * 0.3 * 10.0 * 10.0 / (2.2 * 4.0 * 8.0);
    let [soft, stiff] = [1e3, 1e5].map(|young| (rigid - factor(young)) * young / 1e3);
    assert!(
        soft > 0.02 && (soft / stiff - 1.0).abs() < 0.1,
        "{soft}, {stiff}"
    );
}
