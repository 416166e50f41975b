//! Shears that a law allows without pressure: none acts across a gap.

use super::*;

/// A clamped block under a plane that is pressed on it, dragged along and lifted off.
fn lifted(strain: &str, friction: &str, apart: f64) -> Simulation {
    finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
mesh = {{ block = [{{ name = "a", element = "quad4", x = [0, 8], y = [0, 2], cells = [4, 1] }}] }}
material = [{{ on = "a", young = 2000.0, poisson = 0.3 }}]
tool = [{{ name = "roll", plane = {{ point = [0, {:?}], normal = [0, -1] }} }}]
contact = [{{ surface = "a.top", against = "roll", friction = {{ {friction} }} }}]
[[step]]
name = "press"
increments = 1
fix = [{{ on = "a.bottom", u = ["x", "y"] }}]
tools = [{{ name = "roll", move = [0, -0.01] }}]
[[step]]
name = "drag"
increments = 2
fix = [{{ on = "a.bottom", u = ["x", "y"] }}]
tools = [{{ name = "roll", move = [0.1, -0.01] }}]
[[step]]
name = "lift"
increments = 2
fix = [{{ on = "a.bottom", u = ["x", "y"] }}]
tools = [{{ name = "roll", move = [0.2, 1] }}]
"#,
        2.0 + apart
    )))
}

#[test]
fn no_shear_acts_across_a_gap() {
    for strain in ["small", "finite"] {
        for friction in ["table = [[0, 5], [10, 10]]", "tresca = 5"] {
            let touched = lifted(strain, friction, 0.0);
            let forces = touched.history().numbers("force.roll.x");
            // 40 mm² under a shear of 5 MPa at least, as long as it presses.
            assert!(
                forces[2] >= 5.0 * 8.0 - 1e-6,
                "{strain} {friction}: {forces:?}"
            );
            assert_eq!(forces[4], 0.0, "{strain} {friction}");
            let apart = lifted(strain, friction, 0.5);
            let forces = apart.history().numbers("force.roll.x");
            assert!(
                forces.iter().all(|&f| f == 0.0),
                "{strain} {friction}: {forces:?}"
            );
        }
    }
}

/// A roll that is 0.11 mm away from the nearest node after it has moved: nothing to find.
#[test]
fn nothing_happens_under_large_strains_where_nothing_touches() {
    let block = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
mesh = { block = [{ name = "a", element = "quad4", x = [0, 8], y = [0, 2], cells = [3, 1] }] }
material = [{ on = "a", young = 2000.0, poisson = 0.3 }]
tool = [{ name = "roll", cylinder = { center = [2, 4], radius = 2 } }]
contact = [{ surface = "a.top", against = "roll", friction = { tresca = 10 } }]
[[step]]
name = "press"
increments = 1
fix = [{ on = "a.bottom", u = ["x", "y"] }]
tools = [{ name = "roll", move = [0, -0.003] }]
"#,
    ));
    assert_eq!(block.history().numbers("newton_iterations"), [1.0]);
    assert_eq!(block.history().numbers("force.roll.x"), [0.0]);
}

/// A roll whose apex is between the nodes of one cell goes on under its force until they carry it.
#[test]
fn a_driven_tool_is_borne_by_what_presses() {
    let block = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
thickness = 3.0
mesh = { block = [{ name = "a", element = "quad4", x = [0, 8], y = [0, 4], cells = [1, 1] }] }
material = [{ on = "a", young = 1000.0, poisson = 0.0 }]
tool = [{ name = "t0", cylinder = { center = [4, 10], radius = 6 } }]
contact = [{ surface = "a.top", against = "t0", friction = { tresca = 35 } }]
[[step]]
name = "s0"
increments = 1
fix = [{ on = "a.bottom", u = ["y"] }]
tools = [{ name = "t0", force = [0, -200] }]
"#,
    ));
    let contacts = block.contacts();
    for (i, t) in contacts.numbers("t_n").into_iter().enumerate() {
        assert!(t > 0.0, "{}", contacts.line(i));
        assert!(
            contacts.numbers("gap")[i].abs() < 1e-9,
            "{}",
            contacts.line(i)
        );
    }
    assert!((block.history().numbers("force.t0.y")[0] + 200.0).abs() < 1e-6);
}

/// A block dragged over a tool with a limit of its shear at any pressure: a corner that opens under the shear and presses
/// without it has none, which is told; of a shear that falls with the pressure nothing is.
#[test]
fn a_corner_that_presses_without_its_shear_is_told() {
    let told = |friction: &str| {
        let dragged = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "small"
[[mesh.block]]
name = "b"
element = "quad4"
x=[0,10]
y=[0,4]
cells=[10,3]
[[material]]
on = "b"
young=7000.0
poisson=0.3
[[tool]]
name = "t"
plane={{point=[0,0],normal=[0,1]}}
[[contact]]
surface = "b.bottom"
against = "t"
friction = {friction}
[[step]]
name = "a"
increments=4
fix=[{{on = "b.top",u=["x"]}}]
move=[{{on = "b.top",u={{y=-0.01}}}}]
[[step]]
name = "c"
increments=6
fix=[{{on = "b.top",u=["x"]}}]
move=[{{on = "b.top",u={{y=-0.01}}}}]
tools=[{{name = "t",move=[0.04,0]}}]
"#
        )));
        let warnings = dragged.outcome().warnings;
        let force = *dragged.history().numbers("force.t.x").last().expect("one");
        (
            warnings.iter().any(|w| w.contains("without the shear")),
            force.abs(),
        )
    };
    let (is_told, force) = told("{ tresca = 8 }");
    assert!(is_told && force < 79.9, "{force}");
    let (is_told, _) = told("{ coulomb = 0.5, tau-max = 8 }");
    assert!(!is_told);
}
