//! Bodies side by side on one floor: at the foot of a joint the floor holds both, and what the force between them is there
//! follows from the rest of the joint.

use super::*;

/// Blocks of 10 mm beside each other on a rough floor, each with its cells across and its pressure \[MPa\]; held at both ends.
fn row(
    analysis: &str,
    element: &str,
    friction: f64,
    blocks: &[(usize, f64)],
    more: &str,
) -> String {
    let (depth, cells_deep) = match analysis {
        "solid" => ("z = [0, 10]\n", ", 3"),
        _ => ("", ""),
    };
    let axes = if analysis == "solid" { ", 0" } else { "" };
    let mut deck = format!(
        "units = \"mm-N-MPa\"\nanalysis = \"{analysis}\"\n{more}\n[[tool]]\nname = \"floor\"\n\
         plane = {{ point = [0, 0{axes}], normal = [0, 1{axes}] }}\n"
    );
    let mut loads = Vec::new();
    for (k, (cells, pressure)) in blocks.iter().enumerate() {
        let (from, to) = (10 * k, 10 * k + 10);
        deck += &format!(
            "[[mesh.block]]\nname = \"b{k}\"\nelement = \"{element}\"\nx = [{from}, {to}]\ny = [0, 10]\n{depth}\
             cells = [{cells}, {cells}{cells_deep}]\n[[material]]\non = \"b{k}\"\nyoung = 210e3\npoisson = 0.3\n\
             [[contact]]\nsurface = \"b{k}.bottom\"\nagainst = \"floor\"\nfriction = {friction}\n"
        );
        if k > 0 {
            deck += &format!(
                "[[contact]]\nsurface = \"b{}.right\"\nagainst = \"b{k}.left\"\nfriction = 0.2\n",
                k - 1
            );
        }
        loads.push(format!("{{ on = \"b{k}.top\", pressure = {pressure:?} }}"));
    }
    let last = blocks.len() - 1;
    let mut held =
        format!("{{ on = \"b0.left\", u = [\"x\"] }}, {{ on = \"b{last}.right\", u = [\"x\"] }}");
    if analysis == "solid" {
        for k in 0..=last {
            held += &format!(", {{ on = \"b{k}.back\", u = [\"z\"] }}");
        }
    }
    for (name, way) in [
        ("press", ""),
        ("drag", "tools = [{ name = \"floor\", move = [0.1, 0] }]\n"),
    ] {
        if analysis == "solid" && name == "drag" {
            break;
        }
        deck += &format!(
            "[[step]]\nname = \"{name}\"\nincrements = 4\nfix = [{held}]\nload = [{}]\n{way}",
            loads.join(", ")
        );
    }
    deck
}

/// Without shear a row that is held at its ends is in uniform strain: the pressure between blocks is ν/(1 − ν) of that above,
/// whether the floor is rough enough to hold them or not, in each increment.
#[test]
fn the_pressure_of_a_joint_is_uniform_down_to_its_foot() {
    for friction in [0.0, 0.3, 0.9] {
        for cells in [4, 5] {
            let blocks = [(cells, 100.0); 2];
            let run = finish(simulation(&row(
                "plane-strain",
                "quad8",
                friction,
                &blocks,
                "",
            )));
            let forces = run.history().numbers("force.b0.right.x");
            for (k, force) in forces[..4].iter().enumerate() {
                let expected = -0.3 / 0.7 * 10.0 * 25.0 * (k + 1) as f64;
                assert!(
                    (force / expected - 1.0).abs() < 1e-9,
                    "friction {friction}, {cells} cells, increment {k}: {force}, expected {expected}"
                );
            }
        }
    }
}

/// What one block is pressed more than the next is borne by the ends and the floor; a few iterations find it, and springs in
/// place of the exact law find the same.
#[test]
fn blocks_under_unlike_pressures_push_each_other() {
    let blocks = [(4, 100.0), (4, 30.0), (5, 60.0)];
    let exact = row("plane-strain", "quad8", 0.3, &blocks, "");
    let springs = "[solver]\ncontact = { penalty = { normal = 1e10, tangent = 1e10 } }\n";
    let penalty = row("plane-strain", "quad8", 0.3, &blocks, springs);
    let [exact, penalty] = [exact, penalty].map(|deck| finish(simulation(&deck)));
    let of = |run: &Simulation, name: &str| run.history().numbers(name);
    let forces = [
        "b0.left.x",
        "b2.right.x",
        "floor.x",
        "b0.right.x",
        "b0.right.y",
        "b1.right.x",
        "b1.right.y",
    ];
    for name in forces.map(|name| format!("force.{name}")) {
        for (a, b) in of(&exact, &name).iter().zip(of(&penalty, &name)) {
            assert!((a - b).abs() < 0.02, "{name}: {a}, by springs {b}");
        }
    }
    let floor = of(&exact, "force.floor.x");
    for (k, floor) in floor.iter().enumerate() {
        let ends = of(&exact, "force.b0.left.x")[k] + of(&exact, "force.b2.right.x")[k];
        assert!(
            (ends + floor).abs() < 1e-8,
            "{ends} at the ends, {floor} at the floor"
        );
    }
    // Dragged far enough all of it slips.
    assert!((floor[7] - 0.3 * 1900.0).abs() < 1e-8, "{}", floor[7]);
    let iterations: f64 = of(&exact, "newton_iterations").iter().sum();
    assert!(iterations < 25.0, "{iterations} iterations");
}

/// In space the foot of a joint is an edge, of which some nodes stick and some slip. All of the pressure of the joint has its
/// friction: the shear of a joint that slips hardly changes with the mesh.
#[test]
fn blocks_in_space_push_each_other() {
    for (element, cells, apart) in [("hex8", [3, 5], 0.02), ("hex20", [2, 3], 0.005)] {
        let shears = cells.map(|cells| {
            let blocks = [(cells, 100.0), (cells, 30.0)];
            let run = finish(simulation(&row("solid", element, 0.3, &blocks, "")));
            let of = |name: &str| *run.history().numbers(name).last().expect("increments");
            let sum = of("force.b0.left.x") + of("force.b1.right.x") + of("force.floor.x");
            assert!(sum.abs() < 1e-6, "{sum}");
            let iterations: f64 = run.history().numbers("newton_iterations").iter().sum();
            assert!(iterations < 12.0, "{element}: {iterations} iterations");
            of("force.b0.right.y")
        });
        let [coarse, fine] = shears;
        assert!(
            (coarse / fine - 1.0).abs() < apart,
            "{element}: {coarse}, finer {fine}"
        );
    }
}
