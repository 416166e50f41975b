//! Contacts that are condensed and contacts that are tied in the factor: one problem, one answer.

use crate::collapse::collapse;
use moreau_contact::{Ball, ContactSolver, Penalty, Plane, SemismoothNewton};
use moreau_driver::{Axis, Driver, IncrementReport, Model, Numbers, Seam, Settings, Step};
use moreau_laws::{
    AnisotropicCoulomb, Coulomb, Friction, Isotropic, LimitedCoulomb, Tresca, VonMises,
};
use moreau_mesh::{
    CellKind, Integration, Mesh, Pairing, PlaneStrain, Solid, block2, block3, uniform,
};

fn steel() -> VonMises {
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    steel.with_hardening(Isotropic::linear(2000.0).expect("valid"))
}

fn coulomb(mu: f64) -> Friction {
    Coulomb::new(mu).expect("valid").into()
}

fn settings<const D: usize>(seam: Seam) -> Settings<D> {
    Settings {
        seam,
        ..Settings::default()
    }
}

const BOTH: [Seam; 2] = [Seam::Condensed, Seam::Tied];

/// Applies steps by both seams and compares displacements, forces and statuses.
fn compare<const D: usize>(
    make: impl Fn(Seam) -> Driver<D>,
    steps: &[Step<D>],
    increments: usize,
    tolerance: f64,
) -> [Vec<IncrementReport>; 2] {
    let run = |seam: Seam| {
        let mut driver = make(seam);
        let mut reports = Vec::new();
        for step in steps {
            let all = driver.run(step, increments, |_, _| {});
            reports.extend(all.unwrap_or_else(|error| panic!("{seam:?}: {error}")));
        }
        (driver, reports)
    };
    let [(own, reports), (other, others)] = BOTH.map(run);
    let nodes = 0..own.mesh().nodes().len();
    let size = nodes.clone().map(|a| own.displacement(a).norm());
    let size = size.fold(0.0, f64::max);
    let apart = nodes.map(|a| (own.displacement(a) - other.displacement(a)).norm());
    let apart = apart.fold(0.0, f64::max);
    assert!(apart <= tolerance * size, "{apart:e} of {size:e}");
    let scale = own
        .contacts()
        .iter()
        .map(|c| c.t.norm())
        .fold(0.0, f64::max);
    assert!(scale > 0.0);
    for (a, b) in own.contacts().iter().zip(other.contacts()) {
        assert!((a.t - b.t).norm() <= tolerance * scale, "{a:?}\n{b:?}");
        let slips = a.u.norm().max(b.u.norm()) > 1e-9 * size && a.t.norm() > 1e-6 * scale;
        assert!(!slips || a.status == b.status, "{a:?}\n{b:?}");
    }
    for (a, b) in reports.iter().zip(&others) {
        assert!(b.relative_gap().abs() < 1e-10, "{b:?}");
        assert!(
            b.newton_iterations <= a.newton_iterations + 3,
            "{a:?}\n{b:?}"
        );
        assert_eq!(a.cuts, b.cuts);
    }
    [reports, others]
}

/// A steel plate under a ball, on a floor, all laws of friction, from elastic to plastic and away again.
#[test]
fn a_plate_between_tools_has_one_answer() {
    let make = |law: Friction, contact: fn() -> Box<dyn ContactSolver<3>>| {
        move |seam: Seam| {
            let (side, height) = (uniform(0.0, 8.0, 3), uniform(0.0, 2.0, 1));
            let mesh = block3("plate", CellKind::Hex20, &side, &height, &side).expect("valid");
            let ball = Ball::new([0.0, 12.0, 0.0], 10.0).expect("valid");
            let floor = Plane::new([0.0; 3], [0.0, 1.0, 0.0]).expect("valid");
            let model = Model::new(mesh, Solid)
                .material("plate", steel(), Integration::Reduced)
                .and_then(|m| m.tool("ball", ball))
                .and_then(|m| m.tool("floor", floor))
                .and_then(|m| m.contact("plate.top", "ball", law))
                .and_then(|m| m.contact("plate.bottom", "floor", law))
                .expect("valid");
            let settings = Settings {
                contact: contact(),
                ..settings(seam)
            };
            Driver::new(model, settings).expect("valid")
        }
    };
    let symmetric = |name: &str| {
        Step::new(name)
            .fix("plate.left", &[Axis::X])
            .fix("plate.back", &[Axis::Z])
    };
    let press = symmetric("press").tool("ball", [0.0, -0.06, 0.0]);
    let lift = symmetric("lift").tool("ball", [0.0, 0.5, 0.0]);
    let exact: fn() -> Box<dyn ContactSolver<3>> = || Box::new(SemismoothNewton::default());
    let penalty: fn() -> Box<dyn ContactSolver<3>> =
        || Box::new(Penalty::new(1e6, 1e5).expect("valid"));
    let laws = [
        coulomb(0.0),
        coulomb(0.3),
        Tresca::new(20.0).expect("valid").into(),
        LimitedCoulomb::new(0.3, 15.0).expect("valid").into(),
        AnisotropicCoulomb::new(0.05, 0.2).expect("valid").into(),
    ];
    for law in laws {
        let [reports, _] = compare(make(law, exact), std::slice::from_ref(&press), 3, 1e-8);
        assert!(reports[2].plastic_fraction > 0.0);
    }
    compare(
        make(coulomb(0.2), penalty),
        std::slice::from_ref(&press),
        2,
        1e-8,
    );
    // Let go: what it keeps is residual stress, and no force.
    let mut driver = make(coulomb(0.2), exact)(Seam::Tied);
    driver.run(&press, 2, |_, _| {}).expect("converges");
    driver.run(&lift, 2, |_, _| {}).expect("converges");
    let force = driver.tool_force("ball").expect("exists").norm();
    assert!(force < 1e-9, "{force:e}");
}

/// Driven by a force, through a gap.
#[test]
fn a_tool_under_a_force_has_one_answer() {
    let make = |seam: Seam| {
        let (side, height) = (uniform(0.0, 8.0, 3), uniform(0.0, 2.0, 1));
        let mesh = block3("plate", CellKind::Hex20, &side, &height, &side).expect("valid");
        let ball = Ball::new([0.0, 12.05, 0.0], 10.0).expect("valid");
        let floor = Plane::new([0.0; 3], [0.0, 1.0, 0.0]).expect("valid");
        let model = Model::new(mesh, Solid)
            .material("plate", steel(), Integration::Reduced)
            .and_then(|m| m.tool("ball", ball))
            .and_then(|m| m.tool("floor", floor))
            .and_then(|m| m.contact("plate.top", "ball", coulomb(0.2)))
            .and_then(|m| m.contact("plate.bottom", "floor", coulomb(0.2)))
            .expect("valid");
        Driver::new(model, settings(seam)).expect("valid")
    };
    let press = Step::new("press")
        .fix("plate.left", &[Axis::X])
        .fix("plate.back", &[Axis::Z])
        .push("ball", Axis::Y, -300.0);
    compare(make, &[press], 2, 1e-7);
}

/// Cells that do not match, in the plane and in space.
#[test]
fn two_bodies_have_one_answer() {
    let pairing = Pairing::default();
    let plane = |seam: Seam| {
        let (x, y) = (uniform(0.0, 6.0, 5), uniform(0.0, 2.0, 2));
        let lower = block2("lower", CellKind::Quad8, &x, &y).expect("valid");
        let (x, y) = (uniform(0.0, 4.0, 4), uniform(2.0, 4.0, 2));
        let upper = block2("upper", CellKind::Quad8, &x, &y).expect("valid");
        let mesh: Mesh<2> = lower.joined(upper).expect("valid");
        let model = Model::new(mesh, PlaneStrain::default())
            .material("lower", steel(), Integration::Reduced)
            .and_then(|m| m.material("upper", steel(), Integration::Reduced))
            .and_then(|m| m.pair("upper.bottom", "lower.top", coulomb(0.2), pairing))
            .expect("valid");
        Driver::new(model, settings(seam)).expect("valid")
    };
    let step = Step::new("press")
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .displace("upper.top", Axis::Y, -0.004)
        .displace("upper.top", Axis::X, 0.002);
    compare(plane, &[step], 3, 1e-8);
    let space = |seam: Seam| {
        let (x, y) = (uniform(0.0, 4.0, 3), uniform(0.0, 2.0, 1));
        let lower = block3("lower", CellKind::Hex20, &x, &y, &x).expect("valid");
        let (x, y) = (uniform(0.0, 3.0, 2), uniform(2.0, 4.0, 1));
        let upper = block3("upper", CellKind::Hex20, &x, &y, &x).expect("valid");
        let mesh: Mesh<3> = lower.joined(upper).expect("valid");
        let model = Model::new(mesh, Solid)
            .material("lower", steel(), Integration::Reduced)
            .and_then(|m| m.material("upper", steel(), Integration::Reduced))
            .and_then(|m| m.pair("upper.bottom", "lower.top", coulomb(0.2), pairing))
            .expect("valid");
        Driver::new(model, settings(seam)).expect("valid")
    };
    let step = Step::new("press")
        .fix("lower.bottom", &[Axis::X, Axis::Y, Axis::Z])
        .displace("upper.top", Axis::Y, -0.004)
        .displace("upper.top", Axis::X, 0.002);
    compare(space, &[step], 2, 1e-8);
}

/// Beside each other on a rough floor, where a floor and a body hold the nodes at the foot of the joint.
#[test]
fn bodies_side_by_side_have_one_answer() {
    let side_by_side = |seam: Seam| {
        let (side, height) = (uniform(0.0, 10.0, 3), uniform(0.0, 10.0, 3));
        let one = block3("one", CellKind::Hex20, &side, &height, &side).expect("valid");
        let beyond = uniform(10.0, 20.0, 3);
        let two = block3("two", CellKind::Hex20, &beyond, &height, &side).expect("valid");
        let floor = Plane::new([0.0; 3], [0.0, 1.0, 0.0]).expect("valid");
        let model = Model::new(one.joined(two).expect("valid"), Solid)
            .material("one", steel(), Integration::Reduced)
            .and_then(|m| m.material("two", steel(), Integration::Reduced))
            .and_then(|m| m.tool("floor", floor))
            .and_then(|m| m.contact("one.bottom", "floor", coulomb(0.3)))
            .and_then(|m| m.contact("two.bottom", "floor", coulomb(0.3)))
            .and_then(|m| m.pair("one.right", "two.left", coulomb(0.2), Pairing::default()))
            .expect("valid");
        Driver::new(model, settings(seam)).expect("valid")
    };
    let step = Step::new("press")
        .fix("one.left", &[Axis::X])
        .fix("two.right", &[Axis::X])
        .fix("one.back", &[Axis::Z])
        .fix("two.back", &[Axis::Z])
        .pressure("one.top", 100.0)
        .pressure("two.top", 30.0);
    compare(side_by_side, &[step], 3, 1e-8);
}

fn punched(seam: Seam) -> Driver<2> {
    let (x, y) = (uniform(0.0, 50.0, 10), uniform(0.0, 20.0, 4));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
    mesh.facet_group_where("pressed", "block.top", |x| x[0] <= 25.0)
        .expect("not empty");
    let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid");
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    let model = Model::new(mesh, PlaneStrain::default())
        .material("block", steel, Integration::Reduced)
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| m.contact("block.bottom", "floor", coulomb(0.1)))
        .expect("valid");
    Driver::new(model, settings(seam)).expect("valid")
}

/// A load of unknown factor, and a stiffness that is singular at its largest.
#[test]
fn collapse_is_found_at_the_same_load() {
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .pressure("pressed", 900.0);
    let [own, other] = BOTH.map(|seam| collapse(&mut punched(seam), &step, 6).0);
    let apart = own.load_factor / other.load_factor - 1.0;
    assert!(apart.abs() < 1e-6, "{own:?}\n{other:?}");
}

#[test]
fn buckling_is_as_near_by_both() {
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .pressure("pressed", 100.0);
    let [own, other] = BOTH.map(|seam| {
        let mut driver = punched(seam);
        driver.run(&step, 1, |_, _| {}).expect("converges");
        driver.buckling().expect("compressed").load_factor
    });
    assert!((own / other - 1.0).abs() < 1e-3, "{own} {other}");
}

/// A run that is interrupted after any increment goes on to the bit.
#[test]
fn a_tied_state_is_read_back_to_the_bit() {
    let step = Step::new("press")
        .fix("block.left", &[Axis::X])
        .pressure("pressed", 300.0);
    let mut driver = punched(Seam::Tied);
    driver.run(&step, 3, |_, _| {}).expect("converges");
    let mut numbers = Vec::new();
    driver.write(&mut numbers);
    let mut other = punched(Seam::Tied);
    other.read(&mut Numbers::Read(&numbers)).expect("fits");
    let more = Step::new("more")
        .fix("block.left", &[Axis::X])
        .pressure("pressed", 360.0);
    let after = [&mut driver, &mut other].map(|driver| {
        let reports = driver.run(&more, 2, |_, _| {}).expect("converges");
        let mut numbers = Vec::new();
        driver.write(&mut numbers);
        let bits: Vec<u64> = numbers.iter().map(|n| n.to_bits()).collect();
        (reports, bits)
    });
    assert!(after[0].0[1].plastic_fraction > 0.0);
    assert_eq!(after[0], after[1]);
}

/// What is cheaper is decided by operations: a small interface is condensed, one that is all of a plate is
/// not, and neither is found otherwise by asking.
#[test]
fn a_plate_that_touches_everywhere_is_tied_and_a_block_on_its_foot_is_not() {
    let reports = |driver: &mut Driver<3>| {
        let step = Step::new("press")
            .fix("b.left", &[Axis::X])
            .fix("b.back", &[Axis::Z])
            .tool("t", [0.0, -1e-3, 0.0]);
        driver.run(&step, 1, |_, _| {}).expect("converges")
    };
    let make = |cells: [usize; 3], seam: Seam| {
        let line = |k: usize| uniform(0.0, 4.0 * cells[k] as f64, cells[k]);
        let mesh = block3("b", CellKind::Hex20, &line(0), &line(1), &line(2)).expect("valid");
        let tool = Plane::new([0.0, 4.0 * cells[1] as f64, 0.0], [0.0, -1.0, 0.0]);
        let floor = Plane::new([0.0; 3], [0.0, 1.0, 0.0]);
        let model = Model::new(mesh, Solid)
            .material("b", steel(), Integration::Reduced)
            .and_then(|m| m.tool("t", tool.expect("valid")))
            .and_then(|m| m.tool("f", floor.expect("valid")))
            .and_then(|m| m.contact("b.top", "t", coulomb(0.1)))
            .and_then(|m| m.contact("b.bottom", "f", coulomb(0.1)))
            .expect("valid");
        Driver::new(model, settings(seam)).expect("valid")
    };
    let entries = |cells: [usize; 3], seam: Seam| {
        let mut driver = make(cells, seam);
        reports(&mut driver);
        driver.factor_entries()
    };
    let plate = [6, 1, 6];
    assert_eq!(entries(plate, Seam::Cheaper), entries(plate, Seam::Tied));
    assert!(entries(plate, Seam::Tied) < entries(plate, Seam::Condensed));
    let tower = [1, 8, 1];
    assert_eq!(
        entries(tower, Seam::Cheaper),
        entries(tower, Seam::Condensed)
    );
}
