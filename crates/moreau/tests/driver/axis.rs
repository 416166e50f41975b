//! The node on the axis of symmetry is a contact point like any other, also where quadratic shape
//! functions give it no share of the surface; not the pairing of surfaces that do not match.

use moreau_contact::{Ball, Obstacle, Plane};
use moreau_driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Elastic, Friction, LimitedCoulomb, Status, Tresca};
use moreau_mesh::{Axisymmetric, CellKind, Mesh, Solid, block2, block3, uniform};
use nalgebra::SVector;
use std::f64::consts::PI;

const KINDS: [CellKind; 5] = [
    CellKind::Tri3,
    CellKind::Quad4,
    CellKind::Tri6,
    CellKind::Quad8,
    CellKind::Quad9,
];
const RADIUS: f64 = 4.0;
const PRESSURE: f64 = 10.0;

fn disc(name: &str, kind: CellKind, cells: usize, z: [f64; 2]) -> Mesh<2> {
    let lines = [uniform(0.0, RADIUS, cells), uniform(z[0], z[1], 2)];
    block2(name, kind, &lines[0], &lines[1]).expect("valid")
}

/// A disc on a rigid plane or on a stiffer disc of another mesh, as the non-mortar side or not.
fn supported(kind: CellKind, support: Support, friction: f64) -> Driver<2> {
    let upper = disc("disc", kind, 4, [0.0, 3.0]);
    let law = Coulomb::new(friction).expect("a coefficient");
    let mesh = match support {
        Support::Plane => upper,
        Support::Disc { cells, .. } => upper
            .joined(disc("base", kind, cells, [-2.0, 0.0]))
            .expect("valid"),
    };
    let elastic = |young| Elastic::new(young, 0.3).expect("elastic");
    let model = Model::new(mesh, Axisymmetric)
        .material("disc", elastic(1000.0), kind.integration())
        .expect("a group");
    let model = match support {
        Support::Plane => model
            .tool("base", Plane::new([0.0, 0.0], [0.0, 1.0]).expect("a plane"))
            .and_then(|m| m.contact("disc.bottom", "base", law)),
        Support::Disc { swapped, .. } => {
            let [own, other] = match swapped {
                false => ["disc.bottom", "base.top"],
                true => ["base.top", "disc.bottom"],
            };
            model
                .material("base", elastic(20e3), kind.integration())
                .and_then(|m| m.contact(own, other, law))
        }
    };
    Driver::new(model.expect("a contact"), Settings::default()).expect("a model")
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Support {
    Plane,
    Disc { cells: usize, swapped: bool },
}

const SUPPORTS: [Support; 5] = [
    Support::Plane,
    Support::Disc {
        cells: 4,
        swapped: false,
    },
    Support::Disc {
        cells: 3,
        swapped: false,
    },
    Support::Disc {
        cells: 3,
        swapped: true,
    },
    Support::Disc {
        cells: 7,
        swapped: false,
    },
];

fn held(name: &str, support: Support) -> Step<2> {
    let step = Step::new(name).fix("disc.left", &[Axis::X]);
    match support {
        Support::Plane => step,
        Support::Disc { .. } => step
            .fix("base.left", &[Axis::X])
            .fix("base.bottom", &[Axis::Y]),
    }
}

#[test]
fn a_uniform_pressure_reaches_the_axis() {
    for (kind, support) in KINDS.into_iter().flat_map(|k| SUPPORTS.map(|s| (k, s))) {
        let mut driver = supported(kind, support, 0.0);
        let press = held("press", support).pressure("disc.top", PRESSURE);
        driver.run(&press, 1, |_, _| {}).expect("converges");
        let mut force = 0.0;
        for c in driver.contacts() {
            let what = format!("{kind} {support:?} at r = {}", c.position[0]);
            let found = c.traction()[0];
            assert!((found / PRESSURE - 1.0).abs() < 1e-9, "{what}: {found} MPa");
            assert!(c.u[0].abs() < 1e-15, "{what}: gap {}", c.u[0]);
            assert_ne!(c.status, Status::Open, "{what}");
            force += c.t[0];
        }
        let whole = PRESSURE * PI * RADIUS * RADIUS;
        assert!((force / whole - 1.0).abs() < 1e-11, "{kind} {support:?}");
    }
}

/// Where large strains leave a node on the axis no share of the surface, it has none of a limit of the shear either, whatever
/// the sign of its rounding: a disc that is hardly pressed carries what it does under small strains.
#[test]
fn limits_of_the_shear_reach_the_axis_under_large_strains() {
    let limits: [Friction; 2] = [
        Tresca::new(0.02).expect("a limit").into(),
        LimitedCoulomb::new(0.3, 0.02).expect("a limit").into(),
    ];
    let force = |kind: CellKind, law: &Friction, model: Model<2, Axisymmetric>| {
        let plane = |y: f64, n: f64| Plane::new([0.0, y], [0.0, n]).expect("a plane");
        let elastic = Elastic::new(1000.0, 0.3).expect("elastic");
        let model = model
            .material("disc", elastic, kind.integration())
            .and_then(|m| m.tool("base", plane(0.0, 1.0)))
            .and_then(|m| m.tool("press", plane(3.0, -1.0)))
            .and_then(|m| m.contact("disc.bottom", "base", *law))
            .and_then(|m| m.contact("disc.top", "press", *law));
        let mut driver = Driver::new(model.expect("valid"), Settings::default()).expect("valid");
        let step = Step::new("press")
            .fix("disc.left", &[Axis::X])
            .tool("press", [0.0, -3e-4]);
        driver.run(&step, 1, |_, _| {}).expect("converges");
        assert!(driver.contacts().iter().any(|c| c.status == Status::Slip));
        driver.tool_force("press").expect("exists")[1]
    };
    for (kind, law) in KINDS.into_iter().flat_map(|k| limits.map(|l| (k, l))) {
        for cells in 3..7 {
            let mesh = || disc("disc", kind, cells, [0.0, 3.0]);
            let small = force(kind, &law, Model::new(mesh(), Axisymmetric));
            let large = force(kind, &law, Model::with_large_strains(mesh(), Axisymmetric));
            assert!(
                (large / small - 1.0).abs() < 1e-3,
                "{kind} {cells}: {large} {small}"
            );
        }
    }
}

/// Pressed, spread over the support with friction, and lifted: on the axis there is the pressure of the
/// surface beside it, no shear, and the gap is that of the lift.
#[test]
fn a_disc_that_is_pressed_spread_and_lifted_obeys_the_law_on_the_axis() {
    let kinds = [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9];
    for (kind, support) in kinds.into_iter().flat_map(|k| SUPPORTS.map(|s| (k, s))) {
        let what = format!("{kind} {support:?}");
        let mut driver = supported(kind, support, 0.1);
        let pressed = |name| held(name, support).displace("disc.top", Axis::Y, -0.06);
        let press = pressed("press");
        let spread = pressed("spread").displace("disc.right", Axis::X, 0.05);
        for step in [&press, &spread] {
            let reports = driver.run(step, 2, |_, _| {}).expect("converges");
            let report = reports.last().expect("two increments");
            assert!(report.relative_gap().abs() < 1e-10, "{what}");
            assert!(report.certificate.penetration < 1e-12, "{what}");
            let mut contacts: Vec<_> = driver.contacts().iter().collect();
            contacts.sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
            // Even in r: what the corners at one and two edges from the axis say about it.
            let edges = contacts.len() / 4;
            let [axis, one, two] = [0, edges, 2 * edges].map(|k| contacts[k].traction());
            assert!(axis[1].abs() < 1e-9 * PRESSURE, "{what}: {axis}");
            let extrapolated = one[0] - (two[0] - one[0]) / 3.0;
            let off = (axis[0] / extrapolated - 1.0).abs();
            // Shear that turns round on the axis bends the pressure there.
            assert!(off < 0.2, "{what}: {} MPa, not {extrapolated}", axis[0]);
            assert_ne!(contacts[0].status, Status::Open, "{what}");
            let rest: Vec<_> = contacts.iter().filter(|c| !c.held).collect();
            if step.name() == "spread" {
                let slips = rest
                    .iter()
                    .all(|c| c.status == Status::Slip && c.u[1] != 0.0);
                let all = || rest.iter().map(|c| (c.status, c.u[1])).collect::<Vec<_>>();
                assert!(slips, "{what}: {:?}", all());
            }
        }
        let lift = held("lift", support).displace("disc.top", Axis::Y, 0.05);
        // Once more: normals are those of the start of an increment, flat once the stress is gone.
        for _ in 0..2 {
            driver.run(&lift, 2, |_, _| {}).expect("converges");
        }
        for c in driver.contacts() {
            assert!((c.u[0] - 0.05).abs() < 1e-9, "{what}: {}", c.u[0]);
            assert_eq!((c.status, c.traction().norm()), (Status::Open, 0.0));
        }
    }
}

/// Points of a changed basis on a curved tool: no node is within it, and those that touch are on it.
fn touches_a_ball<const D: usize>(mesh: Mesh<D>, hypothesis: impl Analysis<D>, from: [f64; D]) {
    const BALL: f64 = 10.0;
    let kind = mesh.kind(0);
    let ball = || Ball::new(from, BALL).expect("a ball");
    let model = Model::new(mesh, hypothesis)
        .material(
            "disc",
            Elastic::new(1000.0, 0.3).expect("elastic"),
            kind.integration(),
        )
        .and_then(|m| m.tool("ball", ball()))
        .and_then(|m| {
            m.contact(
                "disc.top",
                "ball",
                Coulomb::new(0.1).expect("a coefficient"),
            )
        })
        .expect("a model");
    let mut driver = Driver::new(model, Settings::default()).expect("a model");
    let mut step = Step::new("press").fix("disc.bottom", &[Axis::Y]);
    for (side, axis) in [("left", Axis::X), ("back", Axis::Z)]
        .into_iter()
        .take(D - 1)
    {
        step = step.fix(&format!("disc.{side}"), &[axis]);
    }
    let mut motion = [0.0; D];
    motion[1] = -0.3;
    let step = step.tool("ball", motion);
    driver.run(&step, 3, |_, _| {}).expect("converges");
    let mut touching = 0;
    for c in driver.contacts() {
        let at = SVector::from(c.position) + driver.displacement(c.node) - SVector::from(motion);
        let gap = ball().distance(&at);
        assert!(gap > -1e-9, "{kind}: {} is {gap} mm inside", at.transpose());
        touching += usize::from(gap < 1e-9);
        if c.position
            .iter()
            .enumerate()
            .all(|(i, x)| i == 1 || *x == 0.0)
        {
            assert!(c.traction()[0] > 0.0 && gap < 1e-9, "{kind}: on the axis");
        }
    }
    assert!(touching > 3, "{kind}: {touching} nodes touch");
}

#[test]
fn no_node_is_inside_a_ball_whatever_the_basis() {
    let lines = uniform(0.0, RADIUS, 5);
    for kind in [CellKind::Tri6, CellKind::Quad8, CellKind::Quad9] {
        let mesh = disc("disc", kind, 5, [-3.0, 0.0]);
        touches_a_ball(mesh, Axisymmetric, [0.0, 10.0]);
    }
    for kind in [CellKind::Hex20, CellKind::Tet10] {
        let mesh = block3("disc", kind, &lines, &uniform(-3.0, 0.0, 2), &lines).expect("valid");
        touches_a_ball(mesh, Solid, [0.0, 10.0, 0.0]);
    }
}
