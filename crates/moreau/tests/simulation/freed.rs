//! What is let go may move as a rigid body, which is no instability.

use super::*;

/// A block is squeezed between two tools and then free.
#[test]
fn a_body_that_is_let_go_is_not_unstable() {
    let freed = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [-10, 10]
y = [0, 4]
cells = [9, 2]
[[material]]
on = "b"
young = 70e3
poisson = 0.33
yield-stress = 150.0
hardening = { linear = 500 }
[[tool]]
name = "f"
plane = { point = [0, 0], normal = [0, 1] }
[[tool]]
name = "d"
plane = { point = [0, 4], normal = [0, -1] }
[[contact]]
surface = "b.bottom"
against = "f"
friction = 0.6
[[contact]]
surface = "b.top"
against = "d"
friction = 0.6
[[step]]
name = "press"
increments = 4
tools = [{ name = "d", move = [0, -0.09] }]
[[step]]
name = "drag"
increments = 6
tools = [{ name = "d", move = [0.05, -0.09] }]
[[step]]
name = "release"
increments = 4
tools = [{ name = "d", move = [0.05, 0.05] }]
"#,
    ));
    let warnings = &freed.outcome().warnings;
    assert!(
        warnings
            .iter()
            .any(|w| w.contains("rigid motions are free")),
        "{warnings:?}"
    );
    assert!(
        !warnings.iter().any(|w| w.contains("unstable")),
        "{warnings:?}"
    );
}

/// The last value of a column.
fn ended(of: &Simulation, column: &str) -> f64 {
    *of.history().numbers(column).last().expect("an increment")
}

/// Two elastic strips bent on a roll by a punch that is withdrawn: they spring back to where they were, whatever the punch
/// and the increments before let expect.
#[test]
fn elastic_strips_that_come_loose_lie_where_they_were() {
    for strain in ["small", "finite"] {
        let freed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
[[mesh.block]]
name = "lo"
element = "quad8"
x = [0, 30]
y = [0, 1]
cells = [15, 1]
[[mesh.block]]
name = "hi"
element = "quad8"
x = [0, 30]
y = [1, 2]
cells = [18, 1]
[[mesh.group]]
name = "lm"
on = "lo.left"
nearest = [0, 0]
[[mesh.group]]
name = "hm"
on = "hi.left"
nearest = [0, 2]
[[material]]
on = "lo"
young = 200e3
poisson = 0.3
[[material]]
on = "hi"
young = 200e3
poisson = 0.3
[[tool]]
name = "punch"
cylinder = {{ center = [0, 8], radius = 6 }}
[[tool]]
name = "die"
cylinder = {{ center = [25, -4], radius = 4 }}
[[contact]]
surface = "hi.top"
against = "punch"
friction = 0.1
[[contact]]
surface = "lo.bottom"
against = "die"
friction = 0.1
[[contact]]
surface = "hi.bottom"
against = "lo.top"
friction = 0.1
[output]
probes = ["lm", "hm"]
[[step]]
name = "bend"
increments = 3
fix = [{{ on = "lo.left", u = ["x"] }}, {{ on = "hi.left", u = ["x"] }}]
tools = [{{ name = "punch", move = [0, -1] }}]
[[step]]
name = "release"
increments = 5
fix = [{{ on = "lo.left", u = ["x"] }}, {{ on = "hi.left", u = ["x"] }}]
tools = [{{ name = "punch", move = [0, 2] }}]
"#
        )));
        for column in ["u.lm.y", "u.hm.y"] {
            let left = ended(&freed, column);
            assert!(left.abs() < 2e-3, "{strain}, {column}: {left}");
        }
        // Once they lie there, nothing takes them away for a solution to bring them back.
        let iterations = freed.history().numbers("newton_iterations");
        assert!(
            iterations[6..].iter().sum::<f64>() <= 8.0,
            "{strain}: {iterations:?}"
        );
    }
}

/// A strip bent beyond its yield stress lies where it came loose, in whatever increments the punch is withdrawn.
#[test]
fn a_strip_comes_loose_in_the_same_place_in_any_increments() {
    let places = [2, 16].map(|releases| {
        let freed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "s"
element = "quad8"
x = [0, 30]
y = [0, 2]
cells = [20, 2]
[[mesh.group]]
name = "mid"
on = "s.left"
nearest = [0, 0]
[[mesh.group]]
name = "tip"
on = "s.right"
nearest = [30, 0]
[[material]]
on = "s"
young = 200e3
poisson = 0.3
yield-stress = 300.0
hardening = {{ linear = 1000 }}
[[tool]]
name = "punch"
cylinder = {{ center = [0, 8], radius = 6 }}
[[tool]]
name = "die"
cylinder = {{ center = [25, -4], radius = 4 }}
[[contact]]
surface = "s.top"
against = "punch"
friction = 0.1
[[contact]]
surface = "s.bottom"
against = "die"
friction = 0.1
[output]
probes = ["mid", "tip"]
[[step]]
name = "bend"
increments = 5
fix = [{{ on = "s.left", u = ["x"] }}]
tools = [{{ name = "punch", move = [0, -3] }}]
[[step]]
name = "release"
increments = {releases}
fix = [{{ on = "s.left", u = ["x"] }}]
tools = [{{ name = "punch", move = [0, 2] }}]
"#
        )));
        ["u.mid.y", "u.tip.y"].map(|column| ended(&freed, column))
    });
    for (few, many) in places[0].iter().zip(places[1]) {
        assert!((few - many).abs() < 1e-3, "{places:?}");
    }
}

/// A strip on two rolls, bent beside its middle by a punch, that nothing holds along its length: it stays where it was, and
/// turns as little as it can.
#[test]
fn a_strip_on_rolls_stays_between_them_when_it_comes_loose() {
    let places = [2, 10].map(|releases| {
        let freed = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "s"
element = "quad8"
x = [-30, 30]
y = [0, 2]
cells = [30, 2]
[[mesh.group]]
name = "mid"
on = "s.bottom"
nearest = [0, 0]
[[mesh.group]]
name = "tip"
on = "s.right"
nearest = [30, 0]
[[material]]
on = "s"
young = 200e3
poisson = 0.3
yield-stress = 300.0
hardening = {{ linear = 1000 }}
[[tool]]
name = "punch"
cylinder = {{ center = [2, 8], radius = 6 }}
[[tool]]
name = "die"
cylinder = {{ center = [25, -4], radius = 4 }}
[[tool]]
name = "other"
cylinder = {{ center = [-25, -4], radius = 4 }}
[[contact]]
surface = "s.top"
against = "punch"
friction = 0.1
[[contact]]
surface = "s.bottom"
against = "die"
friction = 0.1
[[contact]]
surface = "s.bottom"
against = "other"
friction = 0.1
[output]
probes = ["mid", "tip"]
[[step]]
name = "bend"
increments = 8
tools = [{{ name = "punch", move = [0, -3] }}]
[[step]]
name = "release"
increments = {releases}
tools = [{{ name = "punch", move = [0, 2] }}]
"#
        )));
        ["u.mid.x", "u.mid.y", "u.tip.x", "u.tip.y"].map(|column| ended(&freed, column))
    });
    for (few, many) in places[0].iter().zip(places[1]) {
        assert!((few - many).abs() < 0.05, "{places:?}");
    }
}

/// A strip is drawn over a die and springs free: the least that its stiffness against bending is, is less than what a rigid
/// motion rounds to.
#[test]
fn a_strip_that_springs_free_is_not_unstable() {
    let freed = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 35]
y = [0, 1]
cells = [30, 1]
[[material]]
on = "b"
young = 210e3
poisson = 0.3
yield-stress = 300.0
hardening = { linear = 500 }
[[tool]]
name = "punch"
profile = { points = [[10, 60], [10, 1], [-5, 1]], radii = [3] }
[[tool]]
name = "die"
profile = { points = [[11.1, -60], [11.1, 0], [80, 0]], radii = [3] }
[[tool]]
name = "hold"
plane = { point = [0, 1], normal = [0, -1] }
[[mesh.group]]
name = "in"
on = "b.top"
x = [0, 20]
[[mesh.group]]
name = "out"
on = "b.top"
x = [20, 35]
[[contact]]
surface = "b.bottom"
against = "die"
friction = 0.05
[[contact]]
surface = "in"
against = "punch"
friction = 0.05
[[contact]]
surface = "out"
against = "hold"
friction = 0.05
[[step]]
name = "hold"
increments = 2
fix = [{ on = "b.left", u = ["x", "y"] }]
tools = [{ name = "hold", force = [0, -50] }]
[[step]]
name = "bend"
increments = 40
fix = [{ on = "b.left", u = ["x"] }]
tools = [{ name = "hold", force = [0, -50] }, { name = "punch", move = [0, -10] }]
[[step]]
name = "open"
increments = 8
fix = [{ on = "b.left", u = ["x"] }]
tools = [{ name = "hold", move = [0, 5] }, { name = "punch", move = [0, 5] }]
"#,
    ));
    let outcome = freed.outcome();
    assert!(freed.history().numbers("force.die.y").last() == Some(&0.0));
    let told = |what: &str| outcome.warnings.iter().any(|w| w.contains(what));
    assert!(
        told("1 rigid motions are free") && !told("unstable"),
        "{:?}",
        outcome.warnings
    );
}

/// A sheet is bent between two rods and let go, and lies free between them. Its contacts are tied in the factor, whose pivot of
/// the motion that nothing resists is rounding, -2e-14 of the stiffness, and just more than what counts as none.
#[test]
fn a_sheet_that_lies_free_between_tools_is_not_unstable() {
    let freed = finish(simulation(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "s"
element = "quad8"
x = [0, 20]
y = [0, 1]
cells = [40, 2]
[[material]]
on = "s"
young = 70000
poisson = 0.3
yield-stress = 200
hardening = { linear = 0.0 }
[[tool]]
name = "punch"
cylinder = { center = [0, 6], radius = 5 }
[[tool]]
name = "die"
cylinder = { center = [10, -3], radius = 3 }
[[contact]]
surface = "s.top"
against = "punch"
friction = 0.1
[[contact]]
surface = "s.bottom"
against = "die"
friction = 0.1
[[step]]
name = "press"
increments = 40
fix = [{ on = "s.left", u = ["x"] }]
tools = [{ name = "punch", move = [0, -8] }]
[[step]]
name = "release"
increments = 40
fix = [{ on = "s.left", u = ["x"] }]
tools = [{ name = "punch", move = [0, 0] }]
"#,
    ));
    let outcome = freed.outcome();
    assert!(freed.history().numbers("force.die.y").last() == Some(&0.0));
    let told = |what: &str| outcome.warnings.iter().any(|w| w.contains(what));
    assert!(
        told("1 rigid motions are free") && !told("unstable"),
        "{:?}",
        outcome.warnings
    );
}
