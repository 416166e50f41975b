//! Tools that a force drives, over all of a body's boundary and over single nodes.

use super::*;

/// A block on its held base under a cylinder that a force presses, moves aside until it only just touches, and lets rise.
fn pressed(surface: &str, strain: &str) -> Simulation {
    let held = r#"fix = [{ on = "block.bottom", u = ["x", "y"] }]"#;
    let step = |name: &str, x: f64, force: f64| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = 2\n{held}\n\
             tools = [{{ name = \"punch\", move = [{x:?}, 0], force = [0, {force:?}] }}]\n"
        )
    };
    let steps = [
        ("press", 0.0, -105.0),
        ("drag", 2.0, -105.0),
        ("rise", 0.0, -10.5),
    ];
    let steps: String = steps.iter().map(|&(n, x, f)| step(n, x, f)).collect();
    finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
mesh = {{ block = [{{ name = "block", element = "quad8", x = [-8, 8], y = [0, 5], cells = [12, 3] }}] }}
material = [{{ on = "block", young = 210000, poisson = 0.3, yield-stress = 210, hardening = {{ linear = 1050 }} }}]
tool = [{{ name = "punch", cylinder = {{ center = [-0.4, 9], radius = 4 }} }}]
contact = [{{ surface = {surface}, against = "punch", friction = 0.3 }}]
{steps}"#
    )))
}

/// Corners that are held touch nothing: that they are of the surface changes nothing. What they would leave a tool is no
/// stiffness, and what rounding makes of that is of either sign.
#[test]
fn held_corners_of_a_surface_leave_a_driven_tool_as_it_is() {
    for strain in ["small", "finite"] {
        let top = pressed(r#""block.top""#, strain);
        let all = pressed(r#"["block.top", "block.left", "block.right"]"#, strain);
        for name in ["u.punch.y", "force.punch.x", "force.punch.y"] {
            let [a, b] = [&top, &all].map(|s| s.history().numbers(name));
            let size = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            assert!(a.len() == 6 && size > 0.0, "{name}: {a:?}");
            for (a, b) in a.iter().zip(&b) {
                assert!((a - b).abs() <= 1e-8 * size, "{strain} {name}: {a} {b}");
            }
        }
    }
}

/// A roll on a bar, pressed by a force and moved, free to turn.
struct Roll {
    element: &'static str,
    cells: [usize; 2],
    /// Along the bar, of its axle at first.
    x: f64,
    radius: f64,
    friction: f64,
    force: f64,
    way: f64,
}

/// A roll that turns freely on the one node that it touches turns by its way over its radius, though with the contact open
/// a motion of metres to kilometres would be in balance too.
#[test]
fn a_free_roll_on_one_node_turns_by_its_way() {
    let light = Roll {
        element: "quad4",
        cells: [12, 5],
        x: -0.1856,
        radius: 20.0,
        friction: 0.1,
        force: -140.0,
        way: 0.25,
    };
    let small = Roll {
        element: "quad8",
        cells: [12, 3],
        x: 2.156,
        radius: 4.0,
        friction: 0.6,
        force: -105.0,
        way: 0.15,
    };
    for roll in [light, small] {
        let Roll {
            element,
            cells,
            x,
            radius,
            friction,
            force,
            way,
        } = roll;
        let top = 5.0 + radius;
        let step = |name: &str, moved: &str| {
            format!(
                "[[step]]\nname = \"{name}\"\nincrements = 2\nfix = [{{ on = \"bar.bottom\", u = [\"x\", \"y\"] }}]\n\
                 tools = [{{ name = \"roll\", {moved} force = [0, {force:?}], moment = 0 }}]\n"
            )
        };
        let steps = step("press", "") + &step("roll", &format!("move = [{way:?}, 0],"));
        let mut simulation = simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
mesh = {{ block = [{{ name = "bar", element = "{element}", x = [-8, 8], y = [0, 5], cells = {cells:?} }}] }}
material = [{{ on = "bar", young = 210000, poisson = 0.3 }}]
tool = [{{ name = "roll", cylinder = {{ center = [{x:?}, {top:?}], radius = {radius:?} }} }}]
contact = [{{ surface = ["bar.top", "bar.left", "bar.right"], against = "roll", friction = {friction:?} }}]
{steps}"#
        ));
        while advance(&mut simulation) {}
        let history = simulation.history();
        let last = |name: &str| history.numbers(name).last().copied().unwrap_or(f64::NAN);
        let expected = -(way / radius).to_degrees();
        let turn = last("turn.roll");
        assert!((turn / expected - 1.0).abs() < 0.05, "{turn} {expected}");
        assert!(last("moment.roll").abs() < 1e-6 * force.abs() * radius);
        assert!(history.numbers("stick").iter().all(|&n| n == 1.0));
    }
}

/// Past the largest moment that a roll transmits its turn is followed along the path of equilibria: the strip goes on by as
/// much as the roll's surface does, and by the forward slip of some parts in a hundred.
#[test]
fn a_roll_turns_as_far_as_it_has_drawn_the_strip_past_the_largest_moment() {
    let steps = [("bite", 4, "turn = 0"), ("roll", 10, "moment = 1900.0")].map(|(name, increments, turned)| {
        format!(
            "[[step]]\nname = \"{name}\"\nincrements = {increments}\nfix = [{{ on = \"s.bottom\", u = [\"y\"] }}]\n\
             tools = [{{ name = \"r\", move = [0, -0.2], {turned} }}]\n"
        )
    });
    let run = finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
mesh = {{ block = [{{ name = "s", element = "quad8", x = [0, 10], y = [0, 1], cells = [16, 1] }}] }}
material = [{{ on = "s", young = 70e3, poisson = 0.33, yield-stress = 100, hardening = {{ linear = 100 }} }}]
tool = [{{ name = "r", cylinder = {{ center = [6, 61], radius = 60 }} }}]
contact = [{{ surface = "s.top", against = "r", friction = 0.15 }}]
output = {{ probes = ["s.right"] }}
{}"#,
        steps.join("")
    )));
    let of = |name: &str| run.history().numbers(name);
    let (front, turn, moment) = (of("u.s.right.x"), of("turn.r"), of("moment.r"));
    let falls = moment.windows(2).skip(4).filter(|m| m[1] < m[0]).count();
    assert!(falls > 0, "the moment has no limit: {moment:?}");
    for (front, turn) in front.windows(2).zip(turn.windows(2)).skip(4) {
        let drawn = (front[1] - front[0]) / (60.0 * (turn[1] - turn[0]).to_radians());
        assert!(
            (0.99..1.05).contains(&drawn),
            "{drawn} of the roll's way at {} degrees",
            turn[1]
        );
    }
}
