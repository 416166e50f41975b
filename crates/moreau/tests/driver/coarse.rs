//! Systems whose factor has no room: conjugate gradients with a coarse space give the same answer.

use crate::collapse::{collapse, cylinder, limit, pressed};
use moreau_contact::{Penalty, Plane};
use moreau_driver::{Analysis, Axis, Driver, IncrementReport, Model, Nesting, Settings, Step};
use moreau_laws::{Coulomb, Isotropic, VonMises};
use moreau_mesh::{CellKind, Mesh, PlaneStrain, Solid, block2, block3, uniform};

fn steel() -> VonMises {
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    steel.with_hardening(Isotropic::linear(500.0).expect("valid"))
}

const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

/// Pressed at a part of its top against a rough floor, from elastic to plastic.
fn press<H: Analysis<D>, const D: usize>(
    mesh: Mesh<D>,
    hypothesis: H,
    settings: Settings<D>,
) -> (Driver<D>, Vec<IncrementReport>) {
    press_by(0.06, mesh, hypothesis, settings)
}

fn press_by<H: Analysis<D>, const D: usize>(
    depth: f64,
    mut mesh: Mesh<D>,
    hypothesis: H,
    settings: Settings<D>,
) -> (Driver<D>, Vec<IncrementReport>) {
    let rule = mesh.kind(0).integration();
    let top = if D == 2 { "body.top" } else { "body.front" };
    let bottom = if D == 2 { "body.bottom" } else { "body.back" };
    mesh.node_group_where("punch", top, |x| x[0] <= 5.0 + 1e-9)
        .expect("not empty");
    let (mut up, up_axis) = ([0.0; D], AXES[D - 1]);
    up[D - 1] = 1.0;
    let model = Model::new(mesh, hypothesis)
        .material("body", steel(), rule)
        .and_then(|m| m.tool("floor", Plane::new([0.0; D], up).expect("valid")))
        .and_then(|m| m.contact(bottom, "floor", Coulomb::new(0.2).expect("valid")))
        .expect("valid");
    let mut driver = Driver::new(model, settings).expect("valid");
    let step = Step::new("press")
        .fix("body.left", &AXES[..D - 1])
        .displace("punch", up_axis, -depth);
    let reports = driver.run(&step, 3, |_, _| {}).expect("converges");
    (driver, reports)
}

/// Settings with room for a little less than this factor.
fn short<const D: usize>(driver: &Driver<D>) -> Settings<D> {
    Settings {
        memory: Some(8 * driver.factor_entries() as u64 - 8),
        ..Settings::default()
    }
}

/// The same with its own factor and without.
fn compare<H: Analysis<D>, const D: usize>(mesh: &Mesh<D>, hypothesis: &H) {
    let kind = mesh.kind(0);
    let (own, reports) = press(mesh.clone(), *hypothesis, Settings::default());
    assert!(reports.iter().all(|r| r.linear_iterations == 0));
    assert!(reports[2].plastic_fraction > 0.01, "{kind}");
    let (other, others) = press(mesh.clone(), *hypothesis, short(&own));
    assert!(other.factor_entries() < own.factor_entries());
    let nodes = 0..mesh.nodes().len();
    let distance = |a| (own.displacement(a) - other.displacement(a)).norm();
    let far = nodes.map(distance).fold(0.0, f64::max);
    assert!(far < 1e-9 * 0.06, "{kind}: {far:e}");
    let contacts = own.contacts().iter().zip(other.contacts());
    let force = own.tool_force("floor").expect("exists").norm();
    for (a, b) in contacts {
        assert!((a.force - b.force).norm() < 1e-8 * force, "{kind}");
        assert_eq!(a.status, b.status, "{kind}");
    }
    let newton =
        |reports: &[IncrementReport]| reports.iter().map(|r| r.newton_iterations).sum::<usize>();
    let [a, b] = [&reports, &others].map(|r| newton(r));
    assert!(4 * b <= 7 * a, "{kind}: {a}, {b}");
    for (a, b) in reports.iter().zip(&others) {
        assert!(b.linear_iterations > 0, "{kind}");
        // A Newton step that is solved to a hundredth gains two digits: ten take five of them.
        assert!(b.newton_iterations <= a.newton_iterations + 5, "{kind}");
        assert!(b.certificate.bipotential_gap < 1e-9 * a.energies.external_work);
        let [a, b] = [a, b].map(|r| r.energies.plastic_dissipation);
        assert!((a - b).abs() <= 1e-8 * a, "{kind}: {a} {b}");
    }
}

#[test]
fn every_quadratic_cell_has_the_answer_of_its_own_factor() {
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9] {
        let (x, y) = (uniform(0.0, 12.0, 6), uniform(0.0, 16.0, 10));
        let mesh = block2("body", kind, &x, &y).expect("valid");
        compare(&mesh, &PlaneStrain::default());
    }
    for kind in [CellKind::Tet10, CellKind::Hex20, CellKind::Hex27] {
        let (x, z) = (uniform(0.0, 12.0, 3), uniform(0.0, 24.0, 7));
        let mesh = block3("body", kind, &x, &x, &z).expect("valid");
        compare(&mesh, &Solid);
    }
}

/// A bar of cubes under a punch that covers a third of it, with room for no factor of its own.
fn bar(cells: usize) -> (usize, IncrementReport) {
    let lines = |n| uniform(0.0, 12.0, n);
    let mesh = block3(
        "body",
        CellKind::Hex20,
        &lines(cells),
        &lines(cells),
        &lines(cells),
    );
    let mesh = mesh.expect("valid");
    let (own, _) = press(mesh.clone(), Solid, Settings::default());
    let (driver, reports) = press(mesh, Solid, short(&own));
    (driver.unknowns(), reports[2].clone())
}

#[test]
fn the_iterations_of_a_step_do_not_grow_with_the_mesh() {
    let [(few, coarse), (many, fine)] = [4, 6].map(bar);
    assert!(many > 2 * few);
    let [coarse, fine] =
        [coarse, fine].map(|r| r.linear_iterations as f64 / r.newton_iterations as f64);
    assert!(coarse > 1.0 && fine < 1.5 * coarse, "{coarse} {fine}");
}

#[test]
fn other_ways_to_treat_contact_go_the_same_way() {
    let mesh = || {
        let (x, y) = (uniform(0.0, 12.0, 6), uniform(0.0, 16.0, 10));
        block2("body", CellKind::Quad8, &x, &y).expect("valid")
    };
    let (own, _) = press(mesh(), PlaneStrain::default(), Settings::default());
    let penalty = || Penalty::new(1e6, 1e6).expect("valid");
    let soft = |memory| Settings {
        contact: Box::new(penalty()),
        memory,
        ..Settings::default()
    };
    let nested = |memory| Settings {
        nesting: Nesting::Outside {
            tolerance: 1e-6,
            iterations: 500,
            extrapolated: true,
        },
        memory,
        ..Settings::default()
    };
    let room = short(&own).memory;
    // The nesting of the paper takes hundreds of solves for what is plastic.
    for (depth, settings) in [
        (0.06, [soft(None), soft(room)]),
        (0.006, [nested(None), nested(room)]),
    ] {
        let [a, b] = settings.map(|s| press_by(depth, mesh(), PlaneStrain::default(), s));
        let linear = |reports: &[IncrementReport]| -> usize {
            reports.iter().map(|r| r.linear_iterations).sum()
        };
        assert!(linear(&a.1) == 0 && linear(&b.1) > 0);
        let force = |d: &Driver<2>| d.tool_force("floor").expect("exists");
        let (a, b) = (force(&a.0), force(&b.0));
        assert!((a - b).norm() < 1e-5 * a.norm(), "{a} {b}");
    }
}

#[test]
fn the_answer_is_the_same_to_the_bit_on_any_number_of_threads() {
    let mesh = block3(
        "body",
        CellKind::Hex20,
        &uniform(0.0, 12.0, 5),
        &uniform(0.0, 12.0, 5),
        &uniform(0.0, 24.0, 8),
    );
    let mesh = mesh.expect("valid");
    let (own, _) = press(mesh.clone(), Solid, Settings::default());
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let press = || press(mesh.clone(), Solid, short(&own)).0;
        pool.build().expect("threads").install(press)
    };
    let [one, three] = [1, 3].map(run);
    let nodes = 0..mesh.nodes().len();
    assert!(
        nodes
            .into_iter()
            .all(|a| one.displacement(a) == three.displacement(a))
    );
    assert_eq!(one.contacts(), three.contacts());
}

/// A load of unknown factor, without any interface.
#[test]
fn collapse_is_found_at_the_same_load() {
    let press = |memory| {
        let settings = Settings {
            memory,
            ..Settings::default()
        };
        let mut driver = cylinder(settings);
        let (found, reports) = collapse(&mut driver, &pressed(1.25 * limit()), 10);
        let linear: usize = reports.iter().map(|r| r.linear_iterations).sum();
        (found.load_factor, linear, driver.factor_entries())
    };
    let (own, none, entries) = press(None);
    let (other, some, _) = press(Some(8 * entries as u64 - 8));
    assert!(none == 0 && some > 0);
    assert!((own - other).abs() < 1e-6 * own, "{own} {other}");
}
