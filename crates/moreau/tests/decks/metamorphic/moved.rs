//! Places, axes and numbers of nodes.

use super::*;
use moreau::deck::{Problem, open_in};
use moreau::mesh::{Mesh, block2, uniform, write_gmsh};
use std::path::PathBuf;

/// A deck whose mesh is a file with the nodes of another mesh moved and numbered anew.
fn moved(
    name: &str,
    deck: &Table,
    number: impl Fn(usize, usize) -> usize,
    place: impl Fn([f64; 3]) -> [f64; 3],
) -> (Table, PathBuf) {
    let (_, problem, _) = open_in(&deck.to_string(), &folder("docs/examples"));
    let text = match problem.expect("a problem") {
        Problem::Plane(setup) => text_of(setup.driver.mesh(), number, place),
        Problem::Solid(setup) => text_of(setup.driver.mesh(), number, place),
    };
    let at = temporary("metamorphic");
    fs::create_dir_all(&at).expect("a folder");
    fs::write(at.join(format!("{name}.msh")), text).expect("a mesh");
    let mut deck = deck.clone();
    let mut mesh = Table::new();
    mesh.insert("file".into(), format!("{name}.msh").into());
    deck.insert("mesh".into(), mesh.into());
    (deck, at)
}

/// A mesh with its nodes elsewhere and numbered anew as text of Gmsh: cells of which it makes mirror
/// images are turned round by the reader.
fn text_of<const D: usize>(
    mesh: &Mesh<D>,
    number: impl Fn(usize, usize) -> usize,
    place: impl Fn([f64; 3]) -> [f64; 3],
) -> String {
    let count = mesh.nodes().len();
    let number = |n: usize| number(n, count);
    let mut nodes = vec![[0.0; 3]; count];
    for (n, x) in mesh.nodes().iter().enumerate() {
        let x = [0, 1, 2].map(|i| x.get(i).copied().unwrap_or(0.0));
        nodes[number(n)] = place(x);
    }
    // Written as it is, with coordinates and numbers replaced line by line.
    let text = write_gmsh(mesh);
    let (mut out, mut section) = (String::new(), "");
    for line in text.lines() {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let renumbered =
            |n: &&str| (1 + number(n.parse::<usize>().expect("a node") - 1)).to_string();
        if let Some(name) = line.strip_prefix('$') {
            section = name;
        }
        out += &match (section, fields.len()) {
            ("Nodes", 4) => {
                let new = number(fields[0].parse::<usize>().expect("a node") - 1);
                let [x, y, z] = nodes[new];
                format!("{} {x:?} {y:?} {z:?}", new + 1)
            }
            ("Elements", 6..) => {
                let tags: usize = fields[2].parse().expect("a count");
                let (head, own) = fields.split_at(3 + tags);
                let own: Vec<String> = own.iter().map(renumbered).collect();
                format!("{} {}", head.join(" "), own.join(" "))
            }
            _ => line.to_owned(),
        };
        out.push('\n');
    }
    out
}

/// Moves tools, directions of friction and loads.
fn tools_moved(deck: &mut Table, change: impl Fn(&str, f64) -> f64) {
    let only = |keys: &str, v: f64| {
        let first = keys.split('.').next().expect("a key");
        match ["tool", "contact", "step"].contains(&first) {
            true => change(keys, v),
            false => v,
        }
    };
    numbers(deck, &only);
}

/// A profile has its tool on the right: its mirror image is gone through the other way, and turns about the same point.
fn profiles_reversed(deck: &mut Table) {
    let tools = deck.get_mut("tool").and_then(Value::as_array_mut);
    for tool in tools.into_iter().flatten().filter_map(Value::as_table_mut) {
        let Some(profile) = tool.get_mut("profile").and_then(Value::as_table_mut) else {
            continue;
        };
        let first = profile["points"][0].clone();
        for key in ["points", "radii"] {
            let list = profile.get_mut(key).and_then(Value::as_array_mut);
            list.expect("a list").reverse();
        }
        tool.entry("reference").or_insert(first);
    }
}

/// Number of a node that has nothing to do with where it was.
fn shuffled(n: usize, count: usize) -> usize {
    let primes = [7919, 104_729, 1_299_709];
    let prime = primes.into_iter().find(|p| !count.is_multiple_of(*p));
    (n * prime.expect("a small mesh") + 17) % count
}

#[test]
fn numbers_of_nodes_change_nothing() {
    for (name, deck) in examples() {
        let (other, at) = moved(&format!("{name}-shuffled"), &deck, shuffled, |x| x);
        let found = history(&other, &at, &format!("{name}-shuffled"), false);
        beside_itself(&name, &deck, |base| {
            same(base, &found, &format!("{name}, shuffled"), |_, _| 1.0);
        });
    }
}

#[test]
fn a_mirror_and_a_shift_change_nothing() {
    for (name, deck) in examples() {
        if deck["analysis"].as_str() == Some("axisymmetric") {
            continue; // The axis has its place.
        }
        let mirrored = |[x, y, z]: [f64; 3]| [-x, y, z];
        let (mut mirror, at) = moved(&format!("{name}-mirror"), &deck, |n, _| n, mirrored);
        let horizontal = |keys: &str, v: f64| {
            let last = keys.rsplit('.').next().expect("a key");
            let vectors = [
                "point",
                "normal",
                "center",
                "axis",
                "along",
                "traction",
                "force",
                "move",
                "points",
                "reference",
            ];
            let in_vector = keys.split('.').any(|k| vectors.contains(&k));
            let first = last == "0" && in_vector && !keys.contains(".radii.");
            let in_move = keys.contains("move.") && last == "x";
            // In the plane; in space both are about an axis.
            let turns = ["turn", "moment"].contains(&last);
            if first || in_move || turns { -v } else { v }
        };
        tools_moved(&mut mirror, horizontal);
        profiles_reversed(&mut mirror);
        formulas(&mut mirror, &|text| text.replace('x', "(-x)"));
        let found = history(&mirror, &at, &format!("{name}-mirror"), false);
        // Moments and turns are about axes: those about the axis of the mirror stay.
        let turns = |column: &str| column.starts_with("moment.") || column.starts_with("turn.");
        let factor = |column: &str, _: &str| match column.ends_with(".x") != turns(column) {
            true => -1.0,
            false => 1.0,
        };
        beside_itself(&name, &deck, |base| {
            same(base, &found, &format!("{name}, mirrored"), factor);
        });

        let by = match is_solid(&deck) {
            true => [37.5, -12.25, 8.0],
            false => [37.5, -12.25, 0.0],
        };
        let shift = |x: [f64; 3]| [0, 1, 2].map(|i| x[i] + by[i]);
        let (mut shifted, at) = moved(&format!("{name}-shift"), &deck, |n, _| n, shift);
        let along = |keys: &str, v: f64| {
            let place = [".point.", ".points.", ".center.", ".reference."];
            let place = place.iter().any(|p| keys.contains(p));
            let axis = keys
                .rsplit('.')
                .next()
                .and_then(|k| k.parse::<usize>().ok());
            v + axis.filter(|_| place).map_or(0.0, |axis| by[axis])
        };
        tools_moved(&mut shifted, along);
        formulas(&mut shifted, &|text| {
            AXES.iter()
                .zip(by)
                .fold(text.to_owned(), |text, (axis, by)| {
                    text.replace(axis, &format!("({axis} - {by:?})"))
                })
        });
        let found = history(&shifted, &at, &format!("{name}-shift"), false);
        beside_itself(&name, &deck, |base| {
            same(base, &found, &format!("{name}, shifted"), |_, _| 1.0);
        });
    }
}

/// Exchanges the axes in whatever stands under the tools, contacts and steps of a deck: what is along axis i goes
/// along `to[i]`.
fn axes_exchanged(value: &mut Value, to: [usize; 3]) {
    let other = |name: &str| axis(name).map(|i| AXES[to[i]]);
    match value {
        Value::String(name) => {
            if let Some(other) = other(name) {
                *name = other.into();
            }
        }
        Value::Array(items) => {
            let is_vector = |v: &Value| v.is_float() || v.is_integer();
            if items.len() == 3 && items.iter().all(is_vector) {
                let old = items.clone();
                (0..3).for_each(|i| items[to[i]] = old[i].clone());
            }
            items.iter_mut().for_each(|v| axes_exchanged(v, to));
        }
        Value::Table(table) => {
            let entries = std::mem::take(table);
            for (key, mut value) in entries {
                axes_exchanged(&mut value, to);
                table.insert(other(&key).unwrap_or(&key).into(), value);
            }
        }
        _ => {}
    }
}

fn axis(name: &str) -> Option<usize> {
    AXES.iter().position(|a| *a == name)
}

/// Solids turned about the diagonal of space, and mirrored at the plane x = y, with supports along axes
/// and all.
#[test]
fn axes_in_space_are_alike() {
    for (name, deck) in examples().into_iter().filter(|(_, deck)| is_solid(deck)) {
        let base = folder("docs/examples");
        let base = history(&deck, &base, &format!("{name}-xyz"), false);
        for (what, to) in [("turned", [1, 2, 0]), ("mirrored", [1, 0, 2])] {
            let place = |x: [f64; 3]| {
                let mut out = [0.0; 3];
                (0..3).for_each(|i| out[to[i]] = x[i]);
                out
            };
            let (mut other, at) = moved(&format!("{name}-{what}"), &deck, |n, _| n, place);
            for key in ["tool", "contact", "step"] {
                if let Some(value) = other.get_mut(key) {
                    axes_exchanged(value, to);
                }
            }
            for material in other["material"].as_array_mut().expect("materials") {
                if let Some(axes) = material.get_mut("axes") {
                    axes_exchanged(axes, to);
                }
            }
            let mut found = history(&other, &at, &format!("{name}-{what}"), false);
            // What was along x is along another axis: columns stand where they stood.
            let place = |column: &String| {
                let along = column.rsplit_once('.');
                let along = along.and_then(|(of, name)| Some((of, axis(name)?)));
                let other = match along {
                    Some((of, i)) => format!("{of}.{}", AXES[to[i]]),
                    None => column.clone(),
                };
                let names = &mut found.names.iter();
                names.position(|n| *n == other).expect("the column")
            };
            let order: Vec<usize> = base.names.iter().map(place).collect();
            for row in &mut found.rows {
                *row = order.iter().map(|&k| row[k]).collect();
            }
            let factor = |column: &str, _: &str| match column.starts_with("moment.") {
                true if what == "mirrored" => -1.0,
                _ => 1.0,
            };
            same(&base, &found, &format!("{name}, {what}"), factor);
        }
    }
}

/// A block between two rough platens, which alone hold it: the whole turned by 37° has the same
/// answer in the turned frame.
#[test]
fn a_rotation_turns_the_answer() {
    for (strain, motion) in [("small", [0.03, -0.04]), ("finite", [0.3, -0.9])] {
        turned_by_37_degrees(strain, motion);
    }
}

fn turned_by_37_degrees(strain: &str, motion: [f64; 2]) {
    let turned = |degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        let turn = |[x, y]: [f64; 2]| [c * x - s * y, s * x + c * y];
        let show = |x: [f64; 2]| {
            let [x, y] = turn(x);
            format!("[{x:?}, {y:?}]")
        };
        let kind = moreau::mesh::CellKind::Quad8;
        let (x, y) = (uniform(0.0, 8.0, 4), uniform(0.0, 4.0, 3));
        let mesh = block2("b", kind, &x, &y).expect("a mesh");
        let at = temporary("metamorphic");
        fs::create_dir_all(&at).expect("a folder");
        let name = format!("turned-{strain}-{degrees}");
        fs::write(
            at.join(format!("{name}.msh")),
            text_of(
                &mesh,
                |n, _| n,
                |[x, y, _]| {
                    let [x, y] = turn([x, y]);
                    [x, y, 0.0]
                },
            ),
        )
        .expect("a mesh");
        let deck = format!(
            r#"
units = "mm-N-MPa"
analysis = "plane-strain"
strain = "{strain}"
mesh.file = "{name}.msh"
material = [{{ on = "b", young = 1000.0, poisson = 0.3, yield-stress = 5.0, hardening = {{ linear = 50 }} }}]
contact = [
  {{ surface = "b.bottom", against = "low", friction = 0.3 }},
  {{ surface = "b.top", against = "high", friction = 0.2 }},
]
tool = [
  {{ name = "low", plane = {{ point = {}, normal = {} }} }},
  {{ name = "high", plane = {{ point = {}, normal = {} }} }},
]
step = [{{ name = "press", increments = 3, tools = [{{ name = "high", move = {} }}] }}]
output = {{ directory = "out", vtu = "none", checkpoint = 0 }}
"#,
            show([0.0, 0.0]),
            show([0.0, 1.0]),
            show([0.0, 4.0]),
            show([0.0, -1.0]),
            show(motion),
        );
        history(&deck.parse().expect("toml"), &at, &name, false)
    };
    let (straight, oblique) = (turned(0.0), turned(37.0));
    let column = |h: &History, name: &str| -> Vec<f64> {
        let k = h.names.iter().position(|n| n == name).expect(name);
        h.rows.iter().map(|r| r[k]).collect()
    };
    for name in ["newton_iterations", "open", "stick", "slip"] {
        assert_eq!(column(&straight, name), column(&oblique, name), "{name}");
    }
    let (s, c) = 37f64.to_radians().sin_cos();
    let all = |h: &History| {
        ["low.x", "low.y", "high.x", "high.y"].map(|n| column(h, &format!("force.{n}")))
    };
    let (a, b) = (all(&straight), all(&oblique));
    for row in 0..3 {
        assert!(a[1][row] > 1.0, "pressed");
        for k in [0, 2] {
            let expected = [
                c * a[k][row] - s * a[k + 1][row],
                s * a[k][row] + c * a[k + 1][row],
            ];
            let found = [b[k][row], b[k + 1][row]];
            for i in 0..2 {
                assert!(
                    (found[i] - expected[i]).abs() < 1e-10 * a[1][row],
                    "{found:?} {expected:?}"
                );
            }
        }
    }
}
