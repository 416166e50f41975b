//! What friction dissipates where a contact opens within an increment of large strains.

use super::{finish, simulation};

/// What presses an elastic block, draws on it, and in one increment goes on and to a height.
#[derive(Debug, Clone, Copy)]
enum Drawn {
    /// A platen on its top.
    Platen,
    /// Conditions, which hold all of its foot along a floor.
    Foot,
}

impl Drawn {
    /// The conditions of a step at the end of which the way along is this, and the height.
    fn conditions(self, along: f64, height: f64) -> String {
        match self {
            Self::Platen => format!(
                r#"fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
tools = [{{ name = "tool", move = [{along:?}, {height:?}] }}]"#
            ),
            Self::Foot => format!(
                r#"move = [{{ on = "b.bottom", u = {{ x = {along:?} }} }}, {{ on = "b.top", u = {{ x = {along:?}, y = {height:?} }} }}]"#
            ),
        }
    }
}

/// How many points are open at the end, and what the last increment dissipates, over what it did before.
fn lifted(drawn: Drawn, ways: [f64; 2], height: f64) -> (u64, f64) {
    let (surface, plane) = match drawn {
        Drawn::Platen => ("b.top", "point = [0, 2], normal = [0, -1]"),
        Drawn::Foot => ("b.bottom", "point = [0, 0], normal = [0, 1]"),
    };
    let mut deck = format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 4]
y = [0, 2]
cells = [4, 2]
[[material]]
on = "b"
young = 1000
poisson = 0.3
[[tool]]
name = "tool"
plane = {{ {plane} }}
[[contact]]
surface = "{surface}"
against = "tool"
friction = 0.2
"#
    );
    let steps = [
        ("press", 2, 0.0, -0.02),
        ("draw", 4, ways[0], -0.02),
        ("lift", 1, ways[1], height),
    ];
    for (name, increments, along, height) in steps {
        let conditions = drawn.conditions(along, height);
        deck += &format!("[[step]]\nname = \"{name}\"\nincrements = {increments}\n{conditions}\n");
    }
    let done = finish(simulation(&deck));
    let history = done.history();
    let (open, lost) = (
        history.numbers("open"),
        history.numbers("friction_dissipation"),
    );
    let last = lost.len() - 1;
    let of_last = lost[last] - lost[last - 1];
    (open[last] as u64, of_last / lost[last - 1])
}

/// A point that a height leaves with no pressure, and one a trifle below with a trifle of it, have rubbed as much: on along its
/// slip, and back against it.
#[test]
fn what_a_point_dissipates_does_not_leap_where_it_opens() {
    let back = (0.1, 0.0..0.01);
    for (drawn, (way, expected)) in [Drawn::Platen, Drawn::Foot]
        .into_iter()
        .flat_map(|drawn| [(drawn, (0.3, 0.01..1.0)), (drawn, back.clone())])
    {
        let (mut closed, mut open) = (-0.02, 0.05);
        let at = |height: f64| lifted(drawn, [0.2, way], height);
        let none = at(closed).0;
        assert!(at(open).0 > none);
        while open - closed > 1e-10 {
            let middle = 0.5 * (open + closed);
            match at(middle).0 > none {
                true => open = middle,
                false => closed = middle,
            }
        }
        let [below, above] = [closed, open].map(at);
        assert!(expected.contains(&below.1), "{drawn:?}: {below:?}");
        assert!(
            (below.1 - above.1).abs() < 1e-6,
            "{drawn:?}: {below:?} {above:?}"
        );
    }
}

/// Conditions hold the way of the foot: half of what a pressure that stays dissipates on it, as the work of what draws it is
/// counted.
#[test]
fn what_opens_dissipates_under_the_mean_of_its_pressures() {
    let [stays, opens] = [-0.02, 0.02].map(|height| lifted(Drawn::Foot, [0.2, 0.3], height).1);
    assert!((opens / stays - 0.5).abs() < 1e-9, "{opens} {stays}");
}

/// What let go with a shear that goes along with it has rubbed nothing.
#[test]
fn what_goes_back_as_it_is_lifted_does_not_rub() {
    for drawn in [Drawn::Platen, Drawn::Foot] {
        let (_, lost) = lifted(drawn, [0.2, 0.1], 0.02);
        assert!(lost.abs() < 1e-9, "{drawn:?}: {lost}");
    }
}
