//! Laws that are given in place of those of materials.

use super::{DECK, advance, examples, finish, simulation};
use moreau::deck::{Findings, Given, Laws};
use moreau::driver::{IncrementError, LawFault};
use moreau::laws::{NoAnswer, Panel, PanelLaw, PointByPoint, VonMises};
use moreau::simulation::{RunStatus, Simulation, StepError};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// That of the deck.
fn steel() -> PointByPoint<VonMises> {
    PointByPoint(VonMises::new(210e3, 0.3, 300.0).expect("valid"))
}

fn open(text: &str, on: &str, law: impl PanelLaw + 'static) -> (Option<Simulation>, Findings) {
    let law: Arc<dyn PanelLaw> = Arc::new(law);
    let given = Given {
        laws: Laws::from([(on.to_owned(), law)]),
        ..Given::default()
    };
    Simulation::open(text, &examples(), &given)
}

#[test]
fn a_law_that_is_given_stands_in_place_of_that_of_the_deck() {
    let softer = DECK.replace("yield-stress = 300.0", "yield-stress = 200.0");
    assert_ne!(softer, DECK);
    let (given, findings) = open(&softer, "block", steel());
    let mut given = given.unwrap_or_else(|| panic!("{}", findings.render("deck", &softer, false)));
    let mut own = simulation(DECK);
    for _ in 0..10 {
        assert!(advance(&mut given) && advance(&mut own));
    }
    // Also for a step that follows.
    let release =
        "name = \"release\"\nincrements = 2\nfix = [{ on = \"block.left\", u = [\"x\"] }]";
    for simulation in [&mut given, &mut own] {
        simulation.replace_step(release).expect("a step");
    }
    let (given, own) = (finish(given), finish(own));
    assert_eq!(given.displacements(), own.displacements());
    let load = |s: &Simulation| s.history().numbers("force.punch.y");
    assert_eq!(load(&given), load(&own));
}

#[test]
fn a_law_must_be_on_a_material_and_for_small_strains() {
    let told = |text: &str, on: &str| {
        let (simulation, findings) = open(text, on, steel());
        assert!(simulation.is_none());
        findings.render("deck", text, false)
    };
    let text = told(DECK, "blok");
    assert!(
        text.contains(
            "a law is given on \"blok\", and no material is on that; did you mean \"block\"?"
        ),
        "{text}"
    );
    let large = DECK.replacen("analysis", "strain = \"finite\"\nanalysis", 1);
    let text = told(&large, "block");
    assert!(
        text.contains("it answers for small strains") && text.contains("strain = \"small\""),
        "{text}"
    );
}

/// Refuses one call.
#[derive(Debug)]
struct Refusing(AtomicUsize);

impl PanelLaw for Refusing {
    fn initial(&self) -> Vec<f64> {
        steel().initial()
    }

    fn respond(&self, panel: Panel<'_>) -> Result<(), NoAnswer> {
        match self.0.fetch_add(1, Ordering::Relaxed) {
            9 => Err(NoAnswer("not now".into())),
            _ => steel().respond(panel),
        }
    }
}

#[test]
fn a_law_that_refuses_is_no_end() {
    let (simulation_of, _) = open(DECK, "block", Refusing(AtomicUsize::new(0)));
    let mut simulation_of = simulation_of.expect("a deck");
    let refused = loop {
        match simulation_of.advance(&mut |_, _| ControlFlow::Continue(())) {
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    let problem = "not now".to_owned();
    let fault = IncrementError::Law(LawFault::NoAnswer { problem });
    assert_eq!(refused, StepError::Increment(fault));
    let increments = simulation_of.increments();
    assert_eq!(
        simulation_of.outcome().status,
        RunStatus::Interrupted(increments)
    );
    let whole = finish(simulation_of);
    assert_eq!(
        whole.displacements(),
        finish(simulation(DECK)).displacements()
    );
}

/// Hill's criterion with all ratios 1 is von Mises': as many iterations lead there under large strains, and to the same forces,
/// and back stresses that are nearly none cost hardly more.
#[test]
fn laws_that_have_directions_take_no_more_iterations_under_large_strains() {
    let sheared = |more: &str| {
        let block = finish(simulation(&format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
[[mesh.block]]
name = "b"
element = "quad8"
x = [0, 4]
y = [0, 2]
cells = [12, 6]
[[material]]
on = "b"
young = 210000
poisson = 0.3
yield-stress = 300
hardening = {{ linear = 500 }}
{more}
[[step]]
name = "a"
increments = 6
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
move = [{{ on = "b.top", u = {{ x = 0.2, y = -0.1 }} }}]
[[step]]
name = "b"
increments = 6
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
move = [{{ on = "b.top", u = {{ x = -0.2, y = 0.1 }} }}]
"#
        )));
        let of = |name: &str| block.history().numbers(name);
        let forces = of("force.b.top.x");
        let newton: f64 = of("newton_iterations").iter().sum();
        (newton, forces[forces.len() - 1])
    };
    let (newton, force) = sheared("");
    for more in [
        "hill = { r0 = 1, r45 = 1, r90 = 1 }",
        "kinematic = [{ modulus = 1e-3, recall = 0 }]",
    ] {
        let (iterations, found) = sheared(more);
        assert!(
            (found / force - 1.0).abs() < 1e-6,
            "{more}: {found} {force}"
        );
        assert!(iterations < 1.2 * newton, "{more}: {iterations} {newton}");
    }
}

/// A square that is sheared, drawn, sheared back and pressed back: what is elastic along axes keeps a hundredth of what was
/// stored, as these do not come back, and what is isotropic nothing but the error of the trapezoidal rule.
#[test]
fn a_cycle_of_orthotropic_elasticity_does_not_return_all_energy() {
    let left = |elastic: &str| {
        let mut deck = format!(
            r#"units = "mm-N-MPa"
analysis = "plane-strain"
strain = "finite"
mesh.block = [{{ name = "b", element = "quad4", x = [0, 1], y = [0, 1], cells = [1, 1] }}]
material = [{{ on = "b", {elastic} }}]
"#
        );
        for (k, [x, y]) in [[1.0, 0.0], [1.0, 0.5], [0.0, 0.5], [0.0, 0.0]]
            .into_iter()
            .enumerate()
        {
            deck += &format!(
                r#"[[step]]
name = "s{k}"
increments = 50
fix = [{{ on = "b.bottom", u = ["x", "y"] }}]
move = [{{ on = "b.top", u = {{ x = {x:?}, y = {y:?} }} }}]
"#
            );
        }
        let work = finish(simulation(&deck)).history().numbers("external_work");
        let most = work.iter().fold(0.0, |most: f64, w| most.max(*w));
        work.last().expect("an increment") / most
    };
    let orthotropic = "orthotropic = { young = [120e3, 90e3, 50e3], poisson = [0.4, 0.45, 0.35], \
                       shear = [40e3, 35e3, 20e3] }";
    let found = left(orthotropic);
    assert!((0.009..0.011).contains(&found), "{found}");
    let found = left("young = 90e3, poisson = 0.3");
    assert!(found.abs() < 1e-4, "{found}");
}
