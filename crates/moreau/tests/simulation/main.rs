//! A deck in memory, stepped from outside.

mod ahead;
mod around;
mod averaged;
mod axis;
mod beside;
mod beyond;
mod causes;
mod coarse;
mod cornered;
mod dilating;
mod driven;
mod edges;
mod flat;
mod freed;
mod heated;
mod interrupted;
mod inverted;
mod joints;
mod keys;
mod laws;
mod layers;
mod leaps;
mod let_go;
mod limits;
mod mechanisms;
mod methods;
mod narrow;
mod nearby;
mod opened;
mod opposite;
mod outside;
mod overhang;
mod points;
mod pressed;
mod replaced;
mod rolls;
mod saved;
mod sheared;
mod shears;
mod spins;
mod surfaces;
mod told;
mod turned;
mod unjoined;

use moreau::deck::{Given, Meshes};
use moreau::driver::IncrementError;
use moreau::simulation::{Grid, RunStatus, Simulation, StepError};
use moreau::table::Values;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

const DECK: &str = include_str!("../../../../docs/examples/punched-block.toml");

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/examples")
}

fn opened(text: &str, meshes: &Meshes) -> Simulation {
    let given = Given {
        meshes: meshes.clone(),
        ..Given::default()
    };
    let (simulation, findings) = Simulation::open(text, &examples(), &given);
    simulation.unwrap_or_else(|| panic!("{}", findings.render("deck", text, false)))
}

fn simulation(text: &str) -> Simulation {
    opened(text, &Meshes::new())
}

/// The next increment, with nobody watching; whether there was one.
fn advance(simulation: &mut Simulation) -> bool {
    let outcome = simulation.advance(&mut |_, _| ControlFlow::Continue(()));
    outcome.expect("converges").is_some()
}

fn finish(mut simulation: Simulation) -> Simulation {
    while advance(&mut simulation) {}
    simulation
}

/// All that is known of a state, but for times.
fn bits(simulation: &Simulation) -> (Vec<u64>, String) {
    let bits = |v: &[f64]| v.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    let history = simulation.history();
    let mut all = bits(simulation.displacements());
    all.extend(bits(&simulation.points().point_data.iter().fold(
        Vec::new(),
        |mut all, array| {
            all.extend(&array.values);
            all
        },
    )));
    let contacts = simulation.contacts();
    let mut lines: Vec<String> = (0..history.rows()).map(|r| history.line(r)).collect();
    lines.extend((0..contacts.rows()).map(|r| contacts.line(r)));
    (all, lines.join("\n"))
}

/// Linear between the quadrature points, and so at the nodes.
#[test]
fn what_is_heated_shows_its_temperature() {
    let with = DECK.replace("yield-stress = 300.0", "expansion = 1.2e-5");
    let moved = "move = [{ on = \"punch\", u = { y = -0.2 } }]";
    let load = "load = [{ on = \"block\", temperature = \"= 80 * (1 - x / 50)\" }]";
    let with = with.replace(moved, &format!("{moved}\n{load}"));
    let with = with.split("[expect]").next().expect("a deck");
    let mut simulation = simulation(with);
    let off = |grid: Grid, part: f64| {
        let field = grid.point_data.iter().find(|a| a.name == "temperature");
        let pairs = grid.points.iter().zip(&field.expect("a field").values);
        pairs.fold(0.0, |off: f64, (x, t)| {
            off.max((t - 80.0 * part * (1.0 - x[0] / 50.0)).abs())
        })
    };
    // On the boundary of the body a value stays between those of the points around it.
    let points_from_boundary = 80.0 * 1.06 / 50.0;
    let check = |simulation: &Simulation, part: f64| {
        assert!(off(simulation.points(), part) < 1e-10);
        assert!(off(simulation.body(), part) <= points_from_boundary * part);
    };
    check(&simulation, 0.0);
    assert!(advance(&mut simulation));
    check(&simulation, 0.05);
    check(&finish(simulation), 1.0);
}

#[test]
fn the_load_of_the_paper_is_in_the_history_with_its_unit() {
    let simulation = finish(simulation(DECK));
    let history = simulation.history();
    let load = history.column("force.punch.y").expect("a column");
    let values = load.values.numbers();
    assert_eq!((load.unit.as_str(), values.len()), ("N", 20));
    assert!((values[19] + 10519.537829953842).abs() < 1e-9 * 10519.5);
    let counts = history.column("increment").expect("a column");
    assert_eq!(counts.values, Values::Counts((1..=20).collect()));
    assert!(simulation.is_done() && simulation.outcome().status == RunStatus::Done);
    assert!(simulation.outcome().as_expected());
    assert_eq!(simulation.displacements().len(), simulation.nodes().len());
    let (body, points) = (simulation.body(), simulation.points());
    assert_eq!((body.cells.len(), points.points.len()), (20, 80));
    assert_eq!(simulation.surface().expect("contacts").points.len(), 21);
    assert_eq!(simulation.contacts().rows(), 21);
}

#[test]
fn what_ends_a_simulation_is_told_again() {
    let text = fs::read_to_string(examples().join("cylinder-to-collapse.toml")).expect("a deck");
    // Loads that are carried are no collapse.
    let light = text.replace("384.1811628", "10.0");
    let (head, _) = light.split_once("[expect]").expect("two parts");
    let (mut carried, mut told) = (simulation(head), Vec::new());
    while told.len() < 2 {
        if let Err(error) = carried.advance(&mut |_, _| ControlFlow::Continue(())) {
            told.push(error);
        }
    }
    assert_eq!(told[0], told[1]);
    assert!(matches!(told[0], StepError::Carried { .. }), "{}", told[0]);
    assert_eq!(carried.outcome().status.name(), "not converged");
    // Collapse that the step is not for is an error, and its load is a number all the same.
    let mut collapsed = simulation(
        &head
            .replace("until = \"collapse\"", "")
            .replace("10.0", "384.0"),
    );
    let error = loop {
        if let Err(error) = collapsed.advance(&mut |_, _| ControlFlow::Continue(())) {
            break error;
        }
    };
    let StepError::Increment(IncrementError::Collapse { collapse, .. }) = &error else {
        panic!("{error}");
    };
    let outcome = collapsed.outcome();
    assert_eq!(outcome.status, RunStatus::Collapsed(error.to_string()));
    assert_eq!(outcome.collapse.expect("a collapse").1, *collapse);
}

/// The same bits from a mesh file on disk and from its content.
#[test]
fn a_mesh_file_need_not_be_on_disk() {
    let text = fs::read_to_string(examples().join("punch-on-gmsh-mesh.toml")).expect("a deck");
    let content = fs::read(examples().join("punch-on-gmsh-mesh.msh")).expect("a mesh");
    let text = text.replace("increments = 20", "increments = 2");
    let text = text.split("[expect]").next().expect("a deck");
    let given = text.replace("punch-on-gmsh-mesh.msh", "nowhere.msh");
    let (refused, findings) = Simulation::open(&given, &examples(), &Given::default());
    assert!(refused.is_none());
    let shown = findings.render("deck", &given, false);
    assert!(shown.contains("nowhere.msh"), "{shown}");
    let meshes = Meshes::from([(PathBuf::from("nowhere.msh"), content)]);
    let (mut given, mut on_disk) = (opened(&given, &meshes), simulation(text));
    let back = "name = \"back\"\nincrements = 1\nfix = [{ on = \"symmetry\", u = [\"x\"] }]";
    for simulation in [&mut given, &mut on_disk] {
        assert!(advance(simulation));
        simulation
            .replace_step(back)
            .unwrap_or_else(|refused| panic!("{refused}"));
    }
    assert_eq!(bits(&finish(given)), bits(&finish(on_disk)));
}
