//! Keys of decks by what they do to the answer.

use super::{DECK, finish, simulation};
use moreau::simulation::Simulation;

/// Forces and displacements of every increment.
fn course(deck: &str) -> (Simulation, Vec<f64>) {
    let simulation = finish(simulation(
        &deck.replace("increments = 20", "increments = 5"),
    ));
    let history = simulation.history();
    let of = |name: &str| name.starts_with("force.") || name.starts_with("u.");
    let columns = history.columns().iter().filter(|c| of(&c.name));
    let values = columns.flat_map(|c| history.numbers(&c.name)).collect();
    (simulation, values)
}

fn same(a: &[f64], b: &[f64]) -> bool {
    let scale = a.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * scale)
}

/// A line through the origin is Coulomb's law, one that ends Coulomb's with a limit; another slope is another answer.
#[test]
fn a_table_of_friction_is_the_law_that_it_lists() {
    let with = |law: &str| course(&DECK.replace("friction = 0.1", &format!("friction = {law}"))).1;
    let (coulomb, limited) = (with("0.1"), with("{ coulomb = 0.1, tau-max = 20.0 }"));
    assert!(same(&coulomb, &with("{ table = [[0, 0], [1e5, 1e4]] }")));
    assert!(same(&limited, &with("{ table = [[0, 0], [200, 20]] }")));
    assert!(same(
        &limited,
        &with("{ table = [[0, 0], [50, 5], [200, 20], [900, 20]] }")
    ));
    assert!(
        !same(&coulomb, &limited) && !same(&coulomb, &with("{ table = [[0, 0], [1e5, 1.1e4]] }"))
    );
}

/// What is out of balance is below the tolerance, and a looser one costs fewer iterations.
#[test]
fn an_increment_is_as_balanced_as_the_deck_asks() {
    let run = |tolerance: &str| {
        let (simulation, values) = course(&format!("{DECK}\n[solver]\ntolerance = {tolerance}\n"));
        let history = simulation.history();
        let largest = |name: &str| {
            history
                .numbers(name)
                .into_iter()
                .fold(0.0f64, |m, v| m.max(v.abs()))
        };
        let left = largest("out_of_balance") / largest("force.punch.y");
        (
            left,
            largest("newton_iterations"),
            values,
            simulation.outcome().tolerance,
        )
    };
    let (fine, loose) = (run("1e-10"), run("1e-4"));
    assert!(
        fine.0 <= 1e-10 && loose.0 <= 1e-4 && loose.0 > 1e-8,
        "{} {}",
        fine.0,
        loose.0
    );
    assert!(loose.1 < fine.1, "{} {}", loose.1, fine.1);
    assert_eq!((fine.3, loose.3), (1e-10, 1e-4));
    // The default to the bit.
    assert_eq!(fine.2, course(DECK).1);
}
