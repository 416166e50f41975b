//! A body in the corners between tools, under forces that rise and fall.

use super::*;

/// A block between a floor, a wall and a lid that expands against them and shrinks again. Its corners stick to one tool
/// and close what is left to another only to the rounding of the largest forces, which those at the end are far below.
fn heated(element: &str, [wall, lid]: [f64; 2], friction: f64) -> Simulation {
    finish(simulation(&format!(
        r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = {{ block = [{{ name = "block", element = "{element}", x = [0, 8], y = [0, 3], cells = [8, 3] }}] }}
material = [{{ on = "block", young = 70e3, poisson = 0.3, expansion = 1.2e-5 }}]
tool = [
    {{ name = "floor", plane = {{ point = [0, 0], normal = [0, 1] }} }},
    {{ name = "wall", plane = {{ point = [{wall:?}, 0], normal = [-1, 0] }} }},
    {{ name = "lid", plane = {{ point = [0, {lid:?}], normal = [0, -1] }} }},
]
contact = [
    {{ surface = "block.bottom", against = "floor", friction = 0.3 }},
    {{ surface = "block.right", against = "wall", friction = 0.1 }},
    {{ surface = ["block.top", "block.right"], against = "lid", friction = {friction:?} }},
]
[[step]]
name = "hot"
increments = 3
fix = [{{ on = "block.left", u = ["x"] }}]
load = [{{ on = "block", temperature = 300 }}, {{ on = "block", body-force = [0, -0.07] }}]
[[step]]
name = "cold"
increments = 10
fix = [{{ on = "block.left", u = ["x"] }}]
load = [{{ on = "block", body-force = [0, -0.07] }}]
"#
    )))
}

#[test]
fn a_block_that_is_heated_and_cools_between_tools_lets_go_of_them() {
    for (element, room, friction) in [
        ("quad4", [8.003, 3.002], 0.0),
        ("quad4", [8.0, 3.002], 0.05),
        ("quad4", [8.003, 3.0], 0.05),
        ("quad4", [8.0, 3.0], 0.05),
        ("quad8", [8.003, 3.002], 0.05),
    ] {
        let block = heated(element, room, friction);
        let history = block.history();
        let of = |name: &str| history.numbers(name);
        let what = format!("{element} {room:?} {friction}");
        assert!(of("cuts").iter().all(|&n| n == 0.0), "{what}");
        let [floor, wall, lid] = ["floor", "wall", "lid"].map(|t| of(&format!("force.{t}.y")));
        let weight = |i: usize| 0.07 * 24.0 * (1.0f64).min((i + 1) as f64 / 3.0);
        for i in 0..floor.len() {
            let sum = floor[i] + wall[i] + lid[i] - weight(i);
            assert!(sum.abs() < 1e-9 * lid[2].abs(), "{what}: {sum}");
        }
        let [hottest, last] = [lid[2], lid[12]];
        assert!(hottest < -1e3 && last > 1e-6 * hottest, "{what}: {lid:?}");
        for gap in of("penetration") {
            assert!(gap <= 1e-12, "{what}: {gap}");
        }
    }
}

/// A stiff block on a soft bed between a wall and a lid, lighter than what friction at the wall carries: as it cools it hangs
/// there, on nothing but what sticks. Its increments need no smaller ones.
#[test]
fn a_light_block_that_cools_at_a_wall_hangs_there() {
    let fix = r#"fix = [{ on = "bed.bottom", u = ["x", "y"] }, { on = "block.left", u = ["x"] }]"#;
    for friction in [0.1, 0.2] {
        let block = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = {{ block = [
    {{ name = "block", element = "quad4", x = [0, 8], y = [0, 3], cells = [8, 3] }},
    {{ name = "bed", element = "quad8", x = [-2, 10], y = [-2, 0], cells = [9, 2] }},
] }}
material = [
    {{ on = "block", young = 210e3, poisson = 0.2, expansion = 1.2e-5 }},
    {{ on = "bed", young = 2000, poisson = 0.3, yield-stress = 2 }},
]
tool = [
    {{ name = "wall", plane = {{ point = [8.003, 0], normal = [-1, 0] }} }},
    {{ name = "lid", plane = {{ point = [0, 3.002], normal = [0, -1] }} }},
]
contact = [
    {{ surface = "block.bottom", against = "bed.top", friction = {friction:?} }},
    {{ surface = "block.right", against = "wall", friction = {friction:?} }},
    {{ surface = ["block.top", "block.right"], against = "lid", friction = 0.3 }},
]
[[step]]
name = "hot"
increments = 6
{fix}
load = [{{ on = "block", temperature = 300 }}, {{ on = "block", body-force = [0, -0.002] }}]
[[step]]
name = "cold"
increments = 6
{fix}
load = [{{ on = "block", body-force = [0, -0.002] }}]
"#
        )));
        let of = |name: &str| block.history().numbers(name);
        assert_eq!(of("cuts"), [0.0; 12], "{friction}");
        // The bed carries what the wall does not.
        let carried = [
            of("force.wall.y"),
            of("force.lid.y"),
            of("force.bed.bottom.y"),
        ];
        let weight = |i: usize| 0.002 * 24.0 * (1.0f64).min((i + 1) as f64 / 6.0);
        for i in 0..12 {
            let sum: f64 = carried.iter().map(|f| f[i]).sum();
            assert!((sum - weight(i)).abs() < 1e-6, "{friction} {i}: {sum}");
        }
    }
}

/// One surface may meet several tools: each point touches what is next to it, as with a part of the surface for each.
#[test]
fn a_surface_meets_several_tools() {
    let squeezed = |contacts: &str| {
        finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
mesh = {{ block = [{{ name = "block", element = "quad8", x = [0, 6], y = [0, 4], cells = [6, 4] }}] }}
material = [{{ on = "block", young = 70e3, poisson = 0.3, yield-stress = 200, hardening = {{ linear = 500 }} }}]
tool = [
    {{ name = "table", plane = {{ point = [0, 0], normal = [0, 1] }} }},
    {{ name = "roll", cylinder = {{ center = [3, 12], radius = 8 }} }},
]
contact = [{contacts}]
[[step]]
name = "squeeze"
increments = 3
fix = [{{ on = "block.left", u = ["x"] }}]
tools = [{{ name = "roll", move = [0, -0.05] }}]
"#
        )))
    };
    let contact = |surface: &str, tool: &str| {
        format!("{{ surface = {surface}, against = \"{tool}\", friction = 0.2 }},")
    };
    let sides = [("\"block.bottom\"", "table"), ("\"block.top\"", "roll")];
    let own: String = sides.map(|(s, t)| contact(s, t)).concat();
    let all = r#"["block.bottom", "block.right", "block.top"]"#;
    let all: String = sides.map(|(_, t)| contact(all, t)).concat();
    let [own, all] = [own, all].map(|c| squeezed(&c));
    for name in ["force.roll.x", "force.roll.y", "force.table.y"] {
        let [a, b] = [&own, &all].map(|s| s.history().numbers(name));
        assert_eq!(a.len(), 3, "{name}");
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 1e-6, "{name}: {a} {b}");
        }
    }
    // In the table and in the grid each contact has its own.
    let contacts = all.contacts();
    let pressing = |tool: &str| {
        let rows = contacts
            .numbers("t_n")
            .into_iter()
            .zip(contacts.texts("against"));
        rows.filter(|&(t_n, against)| t_n > 0.0 && against == tool)
            .count()
    };
    let [table, roll] = ["table", "roll"].map(pressing);
    assert!(table >= 13 && (1..8).contains(&roll), "{table} {roll}");
    let grid = all.surface().expect("contacts");
    let field = |name: &str| grid.point_data.iter().find(|a| a.name == name);
    let pressures = &field("pressure").expect("there").values;
    let places: Vec<[f64; 3]> = grid.points.clone();
    let pressed = |contact: f64| {
        let cells = grid.cells.iter().zip(&grid.cell_data[0].values);
        let own = cells.filter(move |&(_, &k)| k == contact);
        let points = own.flat_map(|((points, _), _)| points);
        let points = points.filter(|&&p| pressures[p as usize] > 0.0);
        points.map(|&p| places[p as usize][1]).collect::<Vec<f64>>()
    };
    assert!(!pressed(0.0).is_empty() && pressed(0.0).iter().all(|&y| y == 0.0));
    assert!(!pressed(1.0).is_empty() && pressed(1.0).iter().all(|&y| y == 4.0));
}

/// A block pressed against a wider one: that its side wall is of the contact too changes nothing, however that looks at
/// what is opposite.
#[test]
fn a_side_wall_beside_what_touches_turns_no_normal() {
    let pressed = |strain: &str, element: &str, surface: &str| {
        let (analysis, z, depth, fixed) = match element {
            "hex8" => (
                "solid",
                "z = [0, 1]",
                ", 1",
                r#", { on = "b.back", u = ["z"] }, { on = "d.back", u = ["z"] }"#,
            ),
            _ => ("plane-strain", "", "", ""),
        };
        let blocks = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "{analysis}"
strain = "{strain}"
[[mesh.block]]
name = "b"
element = "{element}"
x = [0, 3]
y = [0, 3]
{z}
cells = [4, 4{depth}]
[[mesh.block]]
name = "d"
element = "{element}"
x = [0, 5]
y = [3, 5]
{z}
cells = [5, 3{depth}]
[[material]]
on = ["b", "d"]
young = 210000
poisson = 0.3
[[contact]]
surface = {surface}
against = "d.bottom"
friction = 0.3
[[step]]
name = "s"
increments = 1
fix = [{{ on = "b.bottom", u = ["y"] }}, {{ on = "b.left", u = ["x"] }}, {{ on = "d.left", u = ["x"] }}{fixed}]
move = [{{ on = "d.top", u = {{ y = -0.02 }} }}]
"#
        )));
        blocks.history().numbers("force.d.top.y")[0]
    };
    for (strain, element) in [
        ("small", "quad4"),
        ("small", "quad8"),
        ("finite", "quad4"),
        ("small", "hex8"),
    ] {
        let top = pressed(strain, element, r#""b.top""#);
        let both = pressed(strain, element, r#"["b.top", "b.right"]"#);
        assert!(
            (both / top - 1.0).abs() < 1e-9,
            "{strain} {element}: {both} {top}"
        );
    }
}

/// A block under a die of its width: the nodes under the edges of the die are pressed by it, whether it moves or the block does.
#[test]
fn a_die_presses_what_is_under_its_edges() {
    let pressed = |strain: &str, wider: f64, moves: &str| {
        let [left, right] = [-wider, 1.0 + wider];
        let block = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
mesh = {{ block = [{{ name = "b", element = "quad4", x = [0, 1], y = [0, 1], cells = [4, 4] }}] }}
material = [{{ on = "b", young = 1000, poisson = 0.3 }}]
contact = [{{ surface = "b.top", against = "die", friction = 0.8 }}]
[[tool]]
name = "die"
polyline = [[{right:?}, 5], [{right:?}, 1], [{left:?}, 1], [{left:?}, 5]]
[[step]]
name = "press"
increments = 2
{moves}
"#
        )));
        block.history().numbers("force.die.y")[1]
    };
    for strain in ["small", "finite"] {
        let die = r#"fix = [{ on = "b.bottom", u = ["x", "y"] }]
tools = [{ name = "die", move = [0, -0.1] }]"#;
        let body = r#"move = [{ on = "b.bottom", u = { x = 0, y = 0.1 } }]"#;
        let wide = pressed(strain, 0.5, die);
        for moves in [die, body] {
            let narrow = pressed(strain, 0.0, moves);
            assert!(
                (narrow / wide - 1.0).abs() < 1e-9,
                "{strain}: {narrow} {wide}"
            );
        }
    }
}
