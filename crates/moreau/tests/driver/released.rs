//! Bodies that are pressed and let go: what stays behind is no force, and the way there is as short as
//! the way in.

use moreau_contact::{Ball, Plane};
use moreau_driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic, VonMises};
use moreau_mesh::{CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform};

const PLANE: [CellKind; 5] = [
    CellKind::Tri3,
    CellKind::Tri6,
    CellKind::Quad4,
    CellKind::Quad8,
    CellKind::Quad9,
];
const SPACE: [CellKind; 5] = [
    CellKind::Tet4,
    CellKind::Tet10,
    CellKind::Hex8,
    CellKind::Hex20,
    CellKind::Hex27,
];
const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

fn coulomb(mu: f64) -> Coulomb {
    Coulomb::new(mu).expect("valid")
}

fn rule(kind: CellKind) -> Integration {
    match kind {
        CellKind::Tri3 | CellKind::Quad4 | CellKind::Tet4 | CellKind::Hex8 => Integration::Full,
        CellKind::Quad8 | CellKind::Hex20 => Integration::Reduced,
        _ => Integration::Full,
    }
}

/// Largest contact force [N].
fn pressed<const D: usize>(driver: &Driver<D>) -> f64 {
    driver
        .contacts()
        .iter()
        .map(|c| c.t.norm())
        .fold(0.0, f64::max)
}

/// Presses a ball into a block that is held at its bottom, lifts it off, goes on, and presses again.
fn lifted<const D: usize, H: Analysis<D>>(
    (mesh, size): (Mesh<D>, f64),
    hypothesis: H,
    (kind, young): (CellKind, f64),
) {
    let mut center = [0.5 * size; D];
    center[1] = 0.1 * size;
    let model = Model::new(mesh, hypothesis)
        .material("b", Elastic::new(young, 0.38).expect("valid"), rule(kind))
        .and_then(|m| m.tool("t", Ball::new(center, 0.1 * size).expect("valid")))
        .and_then(|m| m.contact("b.top", "t", coulomb(0.2)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = |name: &str, y: f64| {
        let mut motion = [0.0; D];
        motion[1] = y * size;
        Step::new(name)
            .fix("b.bottom", &AXES[..D])
            .tool("t", motion)
    };
    let run = |driver: &mut Driver<D>, name: &str, y: f64, increments: usize| {
        let reports = driver.run(&step(name, y), increments, |_, _| {});
        let reports =
            reports.unwrap_or_else(|e| panic!("{kind:?} of {size} mm, {young} MPa, {name}: {e}"));
        assert_eq!(
            reports.iter().map(|r| r.cuts).sum::<usize>(),
            0,
            "{kind:?} {name}"
        );
        reports
    };
    run(&mut driver, "press", -0.01, 2);
    let force = pressed(&driver);
    assert!(force > 0.0);
    run(&mut driver, "lift", 0.05, 4);
    assert!(pressed(&driver) == 0.0, "{kind:?}");
    let stress = driver
        .points()
        .iter()
        .map(|p| p.stress.amax())
        .fold(0.0, f64::max);
    assert!(stress < 1e-11 * young, "{kind:?}: {stress}");
    run(&mut driver, "press again", -0.01, 3);
    // Friction remembers the way, and elastic cells do not.
    let again = pressed(&driver);
    assert!(
        (again / force - 1.0).abs() < 0.2,
        "{kind:?}: {again} {force}"
    );
}

/// The stress that is left is rounding of the largest so far, which the balance must not be asked to beat.
#[test]
fn an_elastic_body_that_is_let_go_is_at_rest_and_can_be_pressed_again() {
    for (size, young) in [(20.0, 2400.0), (20.0, 210e3), (0.02, 5.0)] {
        let (x, y) = (uniform(0.0, size, 8), uniform(-0.5 * size, 0.0, 4));
        for kind in PLANE {
            let mesh = block2("b", kind, &x, &y).expect("valid");
            lifted((mesh, size), PlaneStrain::default(), (kind, young));
        }
        let (x, y) = (uniform(0.0, size, 4), uniform(-0.5 * size, 0.0, 2));
        for kind in SPACE {
            let mesh = block3("b", kind, &x, &y, &x).expect("valid");
            lifted((mesh, size), Solid, (kind, young));
        }
    }
}

/// A block that contact and friction alone hold, on a tool or on a body, pressed and relieved in one
/// increment each.
fn relieved<const D: usize, H: Analysis<D>>(
    mut mesh: Mesh<D>,
    hypothesis: H,
    (kind, mu, on_body): (CellKind, f64, bool),
    floor: Option<Mesh<D>>,
) {
    if let Some(floor) = floor {
        mesh = mesh.joined(floor).expect("valid");
    }
    let elastic = Elastic::new(1000.0, 0.3).expect("valid");
    let mut point = [0.0; D];
    let mut normal = [0.0; D];
    (point[0], normal[1]) = (0.0, 1.0);
    let mut model = Model::new(mesh, hypothesis)
        .material("b", elastic, rule(kind))
        .expect("valid");
    let mut press = Step::new("press").pressure("b.top", 2.0);
    let mut relieve = Step::new("relieve").pressure("b.top", 0.0);
    if on_body {
        model = model
            .material("f", elastic, rule(kind))
            .and_then(|m| m.contact("b.bottom", "f.top", coulomb(mu)))
            .expect("valid");
        press = press.fix("f.bottom", &AXES[..D]);
        relieve = relieve.fix("f.bottom", &AXES[..D]);
    } else {
        model = model
            .tool("g", Plane::new(point, normal).expect("valid"))
            .and_then(|m| m.contact("b.bottom", "g", coulomb(mu)))
            .expect("valid");
    }
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let what = format!("{kind:?}, μ = {mu}, on a body: {on_body}");
    for step in [press, relieve] {
        let reports = driver.run(&step, 1, |_, _| {});
        let reports = reports.unwrap_or_else(|e| panic!("{what}, {}: {e}", step.name()));
        assert_eq!(
            (reports.len(), reports[0].cuts),
            (1, 0),
            "{what}: {}",
            step.name()
        );
        if step.name() == "press" {
            assert!(pressed(&driver) > 0.1, "{what}");
        }
    }
    assert!(pressed(&driver) < 1e-9, "{what}: {}", pressed(&driver));
    let stress = driver
        .points()
        .iter()
        .map(|p| p.stress.amax())
        .fold(0.0, f64::max);
    assert!(stress < 1e-9, "{what}: {stress}");
}

/// Where no pressure is, friction carries nothing.
#[test]
fn a_block_that_friction_holds_is_relieved_in_its_own_increment() {
    let mut failed = Vec::new();
    for mu in [0.05, 0.1, 0.15, 0.3, 0.5, 0.8] {
        for on_body in [false, true] {
            for kind in PLANE {
                let (x, y) = (uniform(0.0, 4.0, 3), uniform(0.0, 4.0, 2));
                let mesh = block2("b", kind, &x, &y).expect("valid");
                let (x, y) = (uniform(-1.0, 5.0, 5), uniform(-2.0, 0.0, 2));
                let floor = on_body.then(|| block2("f", kind, &x, &y).expect("valid"));
                let go = || relieved(mesh, PlaneStrain::default(), (kind, mu, on_body), floor);
                if std::panic::catch_unwind(std::panic::AssertUnwindSafe(go)).is_err() {
                    failed.push((kind, mu, on_body));
                }
            }
            for kind in SPACE {
                let (x, y) = (uniform(0.0, 4.0, 2), uniform(0.0, 4.0, 2));
                let mesh = block3("b", kind, &x, &y, &x).expect("valid");
                let (x, y) = (uniform(-1.0, 5.0, 3), uniform(-2.0, 0.0, 1));
                let floor = on_body.then(|| block3("f", kind, &x, &y, &x).expect("valid"));
                let go = || relieved(mesh, Solid, (kind, mu, on_body), floor);
                if std::panic::catch_unwind(std::panic::AssertUnwindSafe(go)).is_err() {
                    failed.push((kind, mu, on_body));
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} {failed:?}", failed.len());
}

/// A block on a rough floor of which every node slips, half to each side: the forces are those of a block
/// that a node in the middle holds, and the position is told to be free.
#[test]
fn a_block_of_which_all_nodes_slip_stays_where_it_is() {
    for (mu, kind) in [
        (0.05, CellKind::Quad4),
        (0.0, CellKind::Quad8),
        (0.02, CellKind::Tri6),
    ] {
        let mesh = block2("b", kind, &[0.0, 1.0, 3.0, 4.0], &[0.0, 3.0]).expect("valid");
        let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material("b", Elastic::new(1000.0, 0.3).expect("valid"), rule(kind))
            .and_then(|m| m.tool("g", floor))
            .and_then(|m| m.contact("b.bottom", "g", coulomb(mu)))
            .expect("valid");
        let press = Step::new("press").pressure("b.top", 3.0);
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        if mu == 0.0 {
            // Nothing could ever hold it: that is no model.
            assert!(driver.run(&press, 2, |_, _| {}).is_err());
            continue;
        }
        let reports = driver.run(&press, 2, |_, _| {}).expect("converges");
        assert!(reports.iter().all(|r| r.cuts == 0), "{kind:?}");
        let force = driver.tool_force("g").expect("exists");
        assert!(
            (force[1] - 12.0).abs() < 1e-9 && force[0].abs() < 1e-9,
            "{force}"
        );
        if kind != CellKind::Quad4 {
            continue;
        }
        for c in driver.contacts() {
            assert!((c.t[1].abs() - mu * c.t[0]).abs() < 1e-9, "{kind:?} {c:?}");
        }
        let last = &reports[1];
        assert!(last.slip == driver.contacts().len(), "{last:?}");
        assert_eq!(last.free_motions.len(), 1, "{last:?}");
        assert!(
            last.free_motions[0].contains("translation along x"),
            "{last:?}"
        );
    }
}

/// On supports that leave it free to shrink: the stress that stays in it is in balance with itself, and
/// no force is left that its rounding could be measured by.
#[test]
fn a_plastic_body_that_is_let_go_keeps_its_stress_and_no_force() {
    for kind in PLANE {
        let (x, y) = (uniform(0.0, 20.0, 8), uniform(-10.0, 0.0, 4));
        let mut mesh = block2("b", kind, &x, &y).expect("valid");
        for (name, at) in [("pin", 0.0), ("roll", 20.0)] {
            mesh.node_group_where(name, "b.bottom", |x| (x[0] - at).abs() < 1e-9)
                .expect("a corner");
        }
        let steel = VonMises::new(210e3, 0.3, 250.0).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material("b", steel, rule(kind))
            .and_then(|m| m.tool("t", Ball::new([10.0, 5.0], 5.0).expect("valid")))
            .and_then(|m| m.contact("b.top", "t", coulomb(0.2)))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        for (name, y, increments) in [("press", -0.1, 4), ("lift", 1.0, 6), ("wait", 1.0, 2)] {
            let step = Step::new(name)
                .fix("pin", &AXES[..2])
                .fix("roll", &[Axis::Y])
                .tool("t", [0.0, y]);
            let reports = driver.run(&step, increments, |_, _| {});
            let reports = reports.unwrap_or_else(|e| panic!("{kind:?}, {name}: {e}"));
            let cuts: usize = reports.iter().map(|r| r.cuts).sum();
            assert_eq!((reports.len(), cuts), (increments, 0), "{kind:?}, {name}");
        }
        assert_eq!(pressed(&driver), 0.0, "{kind:?}");
        let points = driver.points();
        let stress = points.iter().map(|p| p.stress.amax()).fold(0.0, f64::max);
        assert!(stress > 50.0, "{kind:?}");
        let left = driver.reaction("pin").expect("held");
        assert!(left.iter().all(|f| f.abs() < 1e-7), "{kind:?}: {left:?}");
    }
}
