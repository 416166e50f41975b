//! Klarbring's two degrees of freedom as a body: several solutions at once, wedging, and a path that
//! breaks off; not the discrete problem.
//!
//! Source: A. Klarbring, *Ingenieur-Archiv* 60 (1990) 529-541.

use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic};
use moreau_mesh::{CellKind, Integration, Mesh, PlaneStrain};

/// One triangle that stands on its tip, its opposite side held. With ν = 1/4 and G = 1 the stiffness of
/// the tip is K = [[1, −1/2], [−1/2, 1]], so that its critical friction is K_tt/|K_tn| = 2.
fn triangle(mu: f64) -> Driver<2> {
    let nodes = vec![[0.0, 0.0], [0.0, 2.0], [-1.0, 1.0]];
    let mut mesh = Mesh::new(nodes, vec![(CellKind::Tri3, vec![0, 1, 2])]).expect("a cell");
    let sides = mesh.boundary_facets();
    mesh.add_cell_group("body", vec![0]).expect("new");
    mesh.add_facet_group("sides", sides).expect("new");
    mesh.add_node_group("tip", vec![0]).expect("new");
    mesh.add_node_group("held", vec![1, 2]).expect("new");
    let law = Elastic::new(2.5, 0.25).expect("valid");
    let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
    let model = Model::new(mesh, PlaneStrain::default())
        .material("body", law, Integration::Full)
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| m.contact("sides", "floor", Coulomb::new(mu).expect("valid")))
        .expect("valid");
    Driver::new(model, Settings::default()).expect("valid")
}

fn load([t, n]: [f64; 2]) -> Step<2> {
    let held = Step::new("load").fix("held", &[Axis::X, Axis::Y]);
    held.force("tip", [t, n])
}

/// (u_t, u_n; r_t, r_n).
fn state(driver: &Driver<2>) -> [f64; 4] {
    let (u, r) = (driver.displacement(0), driver.tool_force("floor"));
    let r = r.expect("a tool");
    [u[0], u[1], r[0], r[1]]
}

fn is(found: &[f64; 4], expected: &[f64; 4]) -> bool {
    let pairs = found.iter().zip(expected);
    pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9)
}

/// From nothing in one increment: the one solution, or one of several; and how many there may be is
/// reported wherever it touches.
#[test]
fn one_of_its_solutions_is_found_and_others_are_reported_as_possible() {
    type Case = (f64, [f64; 2], Vec<[f64; 4]>);
    let cases: [Case; 6] = [
        (1.0, [1.9, -1.0], vec![[1.8, 0.0, -0.1, 0.1]]),
        (1.0, [2.9, -1.0], vec![[3.2, 0.6, 0.0, 0.0]]),
        (
            1.0,
            [-3.5, -1.0],
            vec![[-5.0 / 3.0, 0.0, 11.0 / 6.0, 11.0 / 6.0]],
        ),
        (
            3.0,
            [2.9, -1.0],
            vec![
                [0.0, 0.0, -2.9, 1.0],
                [0.2, 0.0, -2.7, 0.9],
                [3.2, 0.6, 0.0, 0.0],
            ],
        ),
        (
            3.0,
            [2.0, -1.0],
            vec![[0.0, 0.0, -2.0, 1.0], [2.0, 0.0, 0.0, 0.0]],
        ),
        (3.0, [-3.5, -1.0], vec![[-0.2, 0.0, 3.3, 1.1]]),
    ];
    for (mu, force, solutions) in cases {
        let mut driver = triangle(mu);
        let reports = driver.run(&load(force), 1, |_, _| {}).expect("solvable");
        let found = state(&driver);
        let one = solutions.iter().any(|s| is(&found, s));
        assert!(one, "mu = {mu}, {force:?}: {found:?}");
        match reports[0].criticality {
            Some((0, ratio)) => assert!((ratio - mu / 2.0).abs() < 1e-12 && found[3] > 0.0),
            None => assert_eq!(found[3], 0.0),
            other => panic!("{other:?}"),
        }
    }
}

/// Above the critical friction a tip that was pushed aside stays, under a force of its own.
#[test]
fn it_wedges_above_the_critical_friction_and_not_below() {
    for (mu, left) in [(1.0, [0.0; 4]), (3.0, [-0.2, 0.0, -0.2, 0.1])] {
        let mut driver = triangle(mu);
        driver
            .run(&load([-3.5, -1.0]), 1, |_, _| {})
            .expect("slides");
        driver
            .run(&load([0.0, 0.0]), 1, |_, _| {})
            .expect("goes back");
        let found = state(&driver);
        assert!(is(&found, &left), "mu = {mu}: {found:?}");
    }
}

/// Pressed, then dragged by a growing force s. Below the critical friction it sticks, slides from s = 1
/// on and is lifted from s = 2 on. Above it sticks to s = 3, beyond which nothing near is in balance:
/// it jumps, without a cut, and the report says so.
#[test]
fn a_path_that_breaks_off_is_announced_and_jumped() {
    let drag = |mu: f64| {
        let mut driver = triangle(mu);
        driver
            .run(&load([0.0, -1.0]), 1, |_, _| {})
            .expect("pressed");
        let mut path = Vec::new();
        let step = load([3.5, -1.0]);
        let end = driver.run(&step, 28, |driver, report| {
            path.push((3.5 * report.fraction, state(driver), report.clone()));
        });
        end.expect("a solution under every load");
        path
    };
    let lifted = |s: f64| [(4.0 * s - 2.0) / 3.0, (2.0 * s - 4.0) / 3.0, 0.0, 0.0];
    for (s, found, report) in drag(1.0) {
        let expected = match s {
            s if s <= 1.0 => [0.0, 0.0, -s, 1.0],
            s if s <= 2.0 => [2.0 * (s - 1.0), 0.0, s - 2.0, 2.0 - s],
            s => lifted(s),
        };
        assert!(is(&found, &expected), "s = {s}: {found:?}");
        assert!(report.criticality.is_none_or(|c| c.1 < 1.0) && report.cuts == 0);
    }
    let path = drag(3.0);
    assert_eq!(path.len(), 28);
    for (s, found, report) in path {
        let sticks = s <= 3.0;
        let expected = if sticks {
            [0.0, 0.0, -s, 1.0]
        } else {
            lifted(s)
        };
        assert!(is(&found, &expected), "s = {s}: {found:?}");
        assert_eq!(report.cuts, 0);
        // Told up to the jump, and with it.
        let told = report.criticality.is_some_and(|c| c.1 >= 1.0);
        assert_eq!(told, s < 3.2, "s = {s}");
    }
}
