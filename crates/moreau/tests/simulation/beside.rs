//! Surfaces with nodes that are tied, or held along the surface: what those say is not said twice, nor is any of it lost.

use super::*;

/// A beam cut along its middle and tied on its left half, its right ends pulled apart; the contact of the right half is with
/// the last tied node, or begins one node later.
fn split(strain: &str, element: &str, contact: &str, from: f64) -> f64 {
    let beam = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
[[mesh.block]]
name = "a"
element = "{element}"
x = [0, 40]
y = [0, 2]
cells = [20, 2]
[[mesh.block]]
name = "b"
element = "{element}"
x = [0, 40]
y = [-2, 0]
cells = [20, 2]
[[mesh.group]]
name = "al"
on = "a.bottom"
x = [0, 20]
[[mesh.group]]
name = "bl"
on = "b.top"
x = [0, 20]
[[mesh.group]]
name = "ar"
on = "a.bottom"
x = [{from:?}, 40]
[[mesh.group]]
name = "br"
on = "b.top"
x = [{from:?}, 40]
[[material]]
on = ["a", "b"]
young = 1000
poisson = 0.3
[[tie]]
surface = "al"
to = "bl"
[[contact]]
{contact}
friction = 0.2
[[step]]
name = "open"
increments = 2
fix = [{{ on = "b.left", u = ["x", "y"] }}, {{ on = "a.left", u = ["x", "y"] }}]
move = [{{ on = "a.right", u = {{ y = 0.5 }} }}, {{ on = "b.right", u = {{ y = -0.5 }} }}]
"#
    )));
    let forces = beam.history().numbers("force.a.right.y");
    forces[forces.len() - 1]
}

#[test]
fn a_contact_ends_at_a_tied_node() {
    let sides = [
        "surface = \"ar\"\nagainst = \"br\"",
        "surface = \"br\"\nagainst = \"ar\"",
    ];
    for strain in ["small", "finite"] {
        for element in ["quad4", "quad8"] {
            let expected = split(strain, element, sides[0], 22.0);
            for contact in sides {
                let force = split(strain, element, contact, 20.0);
                let what = format!("{strain} {element} {contact}");
                assert!(
                    (force - expected).abs() < 1e-9,
                    "{what}: {force} {expected}"
                );
            }
        }
    }
}

/// A corner that is tied to the body below is pressed by one beside all the same.
#[test]
fn what_is_tied_to_one_body_touches_another() {
    for strain in ["small", "finite"] {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
[[mesh.block]]
name = "a"
element = "quad4"
x = [0, 4]
y = [0, 2]
cells = [4, 2]
[[mesh.block]]
name = "b"
element = "quad4"
x = [0, 4]
y = [-2, 0]
cells = [3, 2]
[[mesh.block]]
name = "c"
element = "quad4"
x = [4, 6]
y = [-2, 2]
cells = [2, 3]
[[material]]
on = ["a", "b", "c"]
young = 1000
poisson = 0.3
[[tie]]
surface = "a.bottom"
to = "b.top"
[[contact]]
surface = "a.right"
against = "c.left"
friction = 0.1
[[step]]
name = "p"
increments = 1
fix = [{{ on = "b.bottom", u = ["x", "y"] }}, {{ on = "a.left", u = ["x"] }}]
move = [{{ on = "c.right", u = {{ x = -0.01, y = 0 }} }}]
"#
        )));
        let contacts = pressed.contacts();
        let [y, t] = ["y", "t_n"].map(|name| contacts.numbers(name));
        let side = (0..contacts.rows()).filter(|&r| contacts.line(r).contains("a.right,"));
        let corner: Vec<f64> = side.filter(|&r| y[r] == 0.0).map(|r| t[r]).collect();
        assert!(corner[0] > 1e-3, "{strain}: {corner:?}");
    }
}

/// A block whose cells are a quarter as long as those of the bed below, guided so that it does not move along that, under a
/// pressure on a part of its top: all of its nodes touch the bed there.
#[test]
fn what_is_held_along_a_surface_presses_node_by_node() {
    for strain in ["small", "finite"] {
        let block = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "quad4"
x = [0, 4]
y = [2, 3]
cells = [8, 2]
[[mesh.block]]
name = "c"
element = "quad4"
x = [0, 4]
y = [0, 2]
cells = [2, 2]
[[mesh.group]]
name = "press"
on = "b.top"
x = [2, 3]
[[material]]
on = ["b", "c"]
young = 70e3
poisson = 0.3
[[contact]]
surface = "b.bottom"
against = "c.top"
friction = 0
[[step]]
name = "p"
increments = 1
fix = [{{ on = "c.bottom", u = ["x", "y"] }}, {{ on = "b", u = ["x"] }}]
load = [{{ on = "press", pressure = 100 }}]
"#
        )));
        let (nodes, u) = (block.nodes(), block.displacements());
        let at = |body: usize, x: f64| {
            let all = (0..nodes.len() / 2).filter(|a| (nodes[2 * a] - x).abs() < 1e-9);
            let on: Vec<usize> = all
                .filter(|a| (nodes[2 * a + 1] - 2.0).abs() < 1e-9)
                .collect();
            u[2 * on[body] + 1]
        };
        // Under the pressure the surfaces are one.
        for (x, left) in [(2.0, 1.0), (2.5, 0.75), (3.0, 0.5), (3.5, 0.25), (4.0, 0.0)] {
            let bed = left * at(1, 2.0) + (1.0 - left) * at(1, 4.0);
            let off = (at(0, x) - bed).abs();
            let exact = if strain == "small" { 1e-9 } else { 1e-4 };
            assert!(off < exact * bed.abs(), "{strain} {x}: {off} of {bed}");
        }
    }
}

/// Two bodies, one held along x on a side, under a plane: what gives way to what must not change from iterate to iterate.
#[test]
fn a_block_that_is_held_on_a_side_is_pressed_on_a_coarser_one() {
    let force = |strain: &str, moved: f64| {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "solid"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 4]
y = [2, 4]
z = [0, 3]
cells = [3, 1, 3]
[[mesh.block]]
name = "c"
element = "hex8"
x = [-1, 5]
y = [0, 2]
z = [-1, 4]
cells = [2, 1, 2]
[[material]]
on = ["b", "c"]
young = 70000.0
poisson = 0.3
[[tool]]
name = "t"
plane = {{ point = [0, 4, 0], normal = [0, -1, 0] }}
[[contact]]
surface = "b.top"
against = "t"
friction = 0.3
[[contact]]
surface = "b.bottom"
against = "c.top"
friction = 0.3
[[step]]
name = "p"
increments = 1
fix = [{{ on = "c.bottom", u = ["x", "y", "z"] }}, {{ on = "b.left", u = ["x"] }}]
tools = [{{ name = "t", move = [0, {moved:?}, 0] }}]
"#
        )));
        let of = |name: &str| pressed.history().numbers(name)[0];
        let [above, below] = [of("force.t.y"), of("force.c.bottom.y")];
        assert!((above + below).abs() < 1e-9 * below, "{above} {below}");
        assert_eq!(of("cuts"), 0.0);
        below / moved
    };
    let [small, finite] = ["small", "finite"].map(|strain| force(strain, -2e-4));
    assert!((small / finite - 1.0).abs() < 1e-3, "{small} {finite}");
    assert!((force("finite", -0.02) / finite - 1.0).abs() < 0.02);
}

/// The same in plastic flow under a ball, held along an oblique line of the surface: an increment that says that it is in
/// balance is.
#[test]
fn what_is_done_is_in_balance() {
    let force = |strain: &str| {
        let pressed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "solid"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 4]
y = [2, 4]
z = [0, 3]
cells = [4, 1, 4]
[[mesh.block]]
name = "c"
element = "hex8"
x = [-1, 5]
y = [0, 2]
z = [-1, 4]
cells = [2, 1, 2]
[[material]]
on = "b"
young = 70000.0
poisson = 0.3
yield-stress = 150
hardening = {{ linear = 500 }}
kinematic = [{{ modulus = 5000, recall = 50 }}]
[[material]]
on = "c"
young = 210000.0
poisson = 0.3
[[tool]]
name = "t"
sphere = {{ center = [2, 6.5, 1.4], radius = 2.5 }}
[[contact]]
surface = "b.top"
against = "t"
friction = 0.2
[[contact]]
surface = "b.bottom"
against = "c.top"
friction = 0.3
[[step]]
name = "p"
increments = 1
fix = [{{ on = "c.bottom", u = ["x", "y", "z"] }}, {{ on = "b.left", along = [1, 0, -0.5] }}]
tools = [{{ name = "t", move = [0, -0.1, 0] }}]
"#
        )));
        let of = |name: &str| pressed.history().numbers(name)[0];
        let [above, below] = [of("force.t.y"), of("force.c.bottom.y")];
        assert!((above + below).abs() < 1e-6 * below, "{above} {below}");
        below
    };
    let [small, finite] = ["small", "finite"].map(force);
    assert!((finite / small - 1.0).abs() < 0.05, "{small} {finite}");
}

/// A block on a bed, pressed by a roll beyond yield and let go: where nothing touches it any more it stays where it is.
#[test]
fn what_nothing_touches_stays_where_it_is() {
    for lifts in [2, 3, 4, 5] {
        let block = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 4]
y = [0, 2]
cells = [4, 2]
[[mesh.block]]
name = "c"
element = "quad8"
x = [-1, 5]
y = [-2, 0]
cells = [5, 2]
[[material]]
on = "b"
young = 210e3
poisson = 0.3
yield-stress = 150
hardening = {{ linear = 500 }}
[[material]]
on = "c"
young = 210e3
poisson = 0.3
[[tool]]
name = "t"
cylinder = {{ center = [2, 7], radius = 5 }}
[[contact]]
surface = "b.top"
against = "t"
friction = 0.2
[[contact]]
surface = "b.bottom"
against = "c.top"
friction = 0.2
[[step]]
name = "press"
increments = 3
fix = [{{ on = "b.left", u = ["x"] }}, {{ on = "c.bottom", u = ["x", "y"] }}]
tools = [{{ name = "t", move = [0, -0.1] }}]
[[step]]
name = "lift"
increments = {lifts}
fix = [{{ on = "b.left", u = ["x"] }}, {{ on = "c.bottom", u = ["x", "y"] }}]
tools = [{{ name = "t", move = [0, 2] }}]
"#
        )));
        let up = block.history().numbers("u.b.left.y");
        for u in &up[3..] {
            assert!((u - up[3]).abs() < 1e-5, "{lifts}: {up:?}");
        }
        assert!(up[3].abs() < 0.01, "{lifts}: {up:?}");
    }
}

/// A plate with a layer 0.4 mm above it, tied across the gap: the nodes behind bear a part, and action is reaction.
#[test]
fn both_sides_of_a_tie_across_a_gap_bear_the_same() {
    let plate = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "a"
element = "hex8"
x = [0, 10]
y = [0, 10]
z = [0, 5]
cells = [3, 3, 2]
[[mesh.block]]
name = "c"
element = "hex8"
x = [0, 10]
y = [0, 10]
z = [5.4, 9]
cells = [4, 4, 2]
[[material]]
on = ["a", "c"]
young = 1000
poisson = 0.3
[[tie]]
surface = "c.back"
to = "a.front"
[[step]]
name = "p"
increments = 1
fix = [{ on = "a.back", u = ["x", "y", "z"] }]
move = [{ on = "c.front", u = { z = -0.01 } }]
"#,
    ));
    let of = |name: &str| plate.history().numbers(name)[0];
    let [held, layer, base] = ["a.back", "c.back", "a.front"].map(|g| of(&format!("force.{g}.z")));
    assert!((layer - held).abs() < 1e-9 * held, "{layer} {held}");
    assert!((layer + base).abs() < 1e-9 * held, "{layer} {base}");
}

/// A plane that just touches, moved along the surface with friction: no force, and no end to rounding.
#[test]
fn what_touches_without_pressing_is_not_moved_along() {
    for strain in ["small", "finite"] {
        let block = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "solid"
strain = "{strain}"
mesh = {{ block = [{{ name = "a", element = "hex8", x = [0, 1], y = [0, 1], z = [0, 0.3], cells = [3, 3, 3] }}] }}
material = [{{ on = "a", young = 1000, poisson = 0.3 }}]
tool = [{{ name = "t", plane = {{ point = [0, 0, 0.3], normal = [0, 0, -1] }} }}]
contact = [{{ surface = "a.front", against = "t", friction = 0.2 }}]
[[step]]
name = "p"
increments = 5
fix = [{{ on = "a.back", u = ["x", "y", "z"] }}]
tools = [{{ name = "t", move = [0.1, 0.03, 0] }}]
"#
        )));
        for force in block.history().numbers("force.t.x") {
            assert!(force.abs() < 1e-9, "{strain}: {force}");
        }
        assert!(
            block.history().numbers("cuts").iter().all(|&n| n == 0.0),
            "{strain}"
        );
    }
}

/// A finer block held along two sides, on a coarser one that is not: with and without friction all points press, in balance and
/// without a cut, and what friction changes vanishes with it.
#[test]
fn what_is_held_on_two_sides_presses_on_a_coarser_body() {
    let pressed = |cells: [usize; 3], friction: f64| {
        let cubes = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "solid"
[[mesh.block]]
name = "a"
element = "hex8"
x = [0, 1]
y = [0, 1]
z = [0, 1]
cells = {cells:?}
[[mesh.block]]
name = "b"
element = "hex8"
x = [0, 1]
y = [0, 1]
z = [-1, 0]
cells = [2, 2, 1]
[[material]]
on = ["a", "b"]
young = 1000
poisson = 0.3
[[contact]]
surface = "a.back"
against = "b.front"
friction = {friction:?}
[[step]]
name = "p"
increments = 3
fix = [{{ on = "b.back", u = ["x", "y", "z"] }}, {{ on = "a.left", u = ["x"] }}, {{ on = "a.bottom", u = ["y"] }}]
load = [{{ on = "a.front", pressure = 1 }}]
"#
        )));
        let history = cubes.history();
        let most = |name: &str| history.numbers(name).into_iter().fold(0.0, f64::max);
        assert!(most("out_of_balance") < 1e-11, "{cells:?} {friction}");
        assert_eq!(most("cuts"), 0.0, "{cells:?} {friction}");
        let bears = cubes.contacts().numbers("t_n").iter().all(|&t| t > 1e-3);
        assert!(bears, "{cells:?} {friction}");
        most("elastic_energy")
    };
    for cells in [[6, 6, 2], [3, 2, 2]] {
        let [without, hardly, much] = [0.0, 1e-9, 0.3].map(|friction| pressed(cells, friction));
        assert!((hardly / without - 1.0).abs() < 1e-8, "{hardly} {without}");
        assert!(much < 0.999 * without, "{much} {without}");
    }
}
