//! Friction where displacement conditions drag a surface along a tool; not where the contact problem decides of slip.

use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{AnisotropicCoulomb, Coulomb, Elastic, Friction, Tresca};
use moreau_mesh::{CellKind, Mesh, PlaneStrain, Solid, block2, block3, uniform};

const FRICTION: f64 = 0.3;
/// Of the block, on a length of 4 mm.
const WEIGHT: f64 = 4.0;

fn block(kind: CellKind, large: bool) -> Driver<2> {
    let lines = [uniform(0.0, 4.0, 4), uniform(0.0, 2.0, 2)];
    let mesh = block2("block", kind, &lines[0], &lines[1]).expect("valid");
    let floor = Plane::new([0.0, 0.0], [0.0, 1.0]).expect("a plane");
    let start = match large {
        true => Model::with_large_strains,
        false => Model::new,
    };
    let model = start(mesh, PlaneStrain::default())
        .material(
            "block",
            Elastic::new(1e5, 0.3).expect("elastic"),
            kind.integration(),
        )
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| {
            m.contact(
                "block.bottom",
                "floor",
                Coulomb::new(FRICTION).expect("a coefficient"),
            )
        })
        .expect("a model");
    Driver::new(model, Settings::default()).expect("a driver")
}

fn weight(name: &str) -> Step<2> {
    Step::new(name).body_force("block", [0.0, -WEIGHT / 8.0])
}

/// Half of the side that pushes stands on the floor: its corner, too, rubs.
#[test]
fn a_block_that_is_pushed_takes_the_friction_of_all_of_its_weight() {
    for kind in [CellKind::Quad4, CellKind::Tri6, CellKind::Quad8] {
        for large in [false, true] {
            let mut driver = block(kind, large);
            driver.run(&weight("stand"), 1, |_, _| ()).expect("stands");
            let push = weight("push").displace("block.left", Axis::X, 0.5);
            let reports = driver.run(&push, 4, |_, _| ()).expect("slides");
            let force = |d: &Driver<2>| d.reaction("block.left").expect("a group")[0];
            let case = format!("{kind:?}, large: {large}");
            assert!(
                (force(&driver) - FRICTION * WEIGHT).abs() < 1e-6,
                "{case}: {}",
                force(&driver)
            );
            let last = reports.last().expect("increments");
            assert_eq!([last.open, last.stick], [0, 0], "{case}");
            let [one, two] = [&reports[2], last].map(|r| r.energies);
            let work = two.external_work - one.external_work;
            let lost = two.friction_dissipation - one.friction_dissipation;
            // 0.125 mm of way in an increment that slides from its start to its end.
            for (what, found) in [("work", work), ("lost", lost)] {
                let expected = FRICTION * WEIGHT * 0.125;
                assert!(
                    (found - expected).abs() < 2e-4 * expected,
                    "{case}: {what} {found}"
                );
            }
            assert!(last.certificate.bipotential_gap.abs() < 1e-12, "{case}");
            // What stops keeps what it had, and turns with the way.
            let rest = weight("rest").displace("block.left", Axis::X, 0.5);
            driver.run(&rest, 1, |_, _| ()).expect("rests");
            assert!(
                (force(&driver) - FRICTION * WEIGHT).abs() < 1e-6,
                "{case}: at rest"
            );
            let back = weight("back").displace("block.left", Axis::X, 0.2);
            driver.run(&back, 2, |_, _| ()).expect("slides back");
            assert!(
                (force(&driver) + FRICTION * WEIGHT).abs() < 1e-6,
                "{case}: back"
            );
            // Let go, the reaction has gone and friction with it: what pushes is nothing.
            driver
                .run(&weight("let go"), 2, |_, _| ())
                .expect("stands again");
            let floor = driver.tool_force("floor").expect("a tool");
            assert!(
                floor[0].abs() < 1e-6 && (floor[1] - WEIGHT).abs() < 1e-6,
                "{case}: {floor:?}"
            );
        }
    }
}

/// On a plane of symmetry nothing slips, and nothing rubs.
#[test]
fn what_conditions_hold_in_place_has_no_friction() {
    let mut driver = block(CellKind::Quad8, false);
    let press = weight("press").fix("block.left", &[Axis::X]);
    driver.run(&press, 2, |_, _| ()).expect("stands");
    let held: Vec<_> = driver.contacts().iter().filter(|c| c.held).collect();
    assert_eq!(held.len(), 1);
    assert!(held[0].t[0] > 0.0 && held[0].t[1] == 0.0);
}

fn plate(law: Friction, axis: Option<[f64; 3]>, way: [f64; 3]) -> [f64; 3] {
    let lines = [
        uniform(0.0, 2.0, 2),
        uniform(0.0, 1.0, 1),
        uniform(0.0, 2.0, 2),
    ];
    let mesh: Mesh<3> =
        block3("block", CellKind::Hex8, &lines[0], &lines[1], &lines[2]).expect("valid");
    let floor = Plane::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]).expect("a plane");
    let kind = CellKind::Hex8;
    let model = Model::new(mesh, Solid)
        .material(
            "block",
            Elastic::new(1e5, 0.0).expect("elastic"),
            kind.integration(),
        )
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| m.contact("block.bottom", "floor", law))
        .expect("a model");
    let model = match axis {
        Some(axis) => model.along(axis).expect("along the floor"),
        None => model,
    };
    let mut driver = Driver::new(model, Settings::default()).expect("a driver");
    let drag = Step::new("drag").pressure("block.top", 2.0);
    let drag = drag
        .displace("block", Axis::X, way[0])
        .displace("block", Axis::Z, way[2]);
    driver.run(&drag, 1, |_, _| ()).expect("slides");
    driver.tool_force("floor").expect("a tool").into()
}

/// A block all of whose nodes are dragged in the plane of the floor: the law of a point, over 4 mm² under 2 MPa.
#[test]
fn laws_hold_where_conditions_prescribe_the_slip_in_space() {
    let close = |found: [f64; 3], expected: [f64; 3]| {
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9, "{found:?} for {expected:?}");
    };
    let coulomb = Coulomb::new(0.25).expect("a coefficient");
    close(
        plate(coulomb.into(), None, [0.3, 0.0, -0.4]),
        [-1.2, 8.0, 1.6],
    );
    let tresca = Tresca::new(0.1).expect("a limit");
    close(
        plate(tresca.into(), None, [0.0, 0.0, 0.1]),
        [0.0, 8.0, -0.4],
    );
    // Of an ellipse the force is that of most dissipation: −t_n (μ₁² u₁, μ₂² u₂) / |(μ₁ u₁, μ₂ u₂)|.
    let ellipse = AnisotropicCoulomb::new(0.1, 0.3).expect("coefficients");
    let size = f64::hypot(0.1 * 0.2, 0.3 * 0.1);
    let [along, across] = [(0.1, 0.2), (0.3, 0.1)].map(|(mu, u)| -8.0 * mu * mu * u / size);
    let found = plate(ellipse.into(), Some([0.0, 0.0, 1.0]), [0.1, 0.0, 0.2]);
    close(found, [across, 8.0, along]);
}

/// A solid that is pushed by its side alone: what friction lacks there is told, and nothing else.
#[test]
fn nodes_that_are_dragged_in_one_direction_alone_are_told() {
    for (also, told) in [(Some("block.left"), 0), (None, 3)] {
        let line = uniform(0.0, 2.0, 2);
        let mesh: Mesh<3> = block3("block", CellKind::Hex8, &line, &line, &line).expect("valid");
        let floor = Plane::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]).expect("a plane");
        let model = Model::new(mesh, Solid)
            .material(
                "block",
                Elastic::new(1e5, 0.3).expect("elastic"),
                CellKind::Hex8.integration(),
            )
            .and_then(|m| m.tool("floor", floor))
            .and_then(|m| m.contact("block.bottom", "floor", Coulomb::new(0.3).expect("valid")))
            .expect("a model");
        let mut driver = Driver::new(model, Settings::default()).expect("a driver");
        let push = Step::new("push").pressure("block.top", 1.0);
        let push = push.displace("block.left", Axis::X, 0.1);
        let push = match also {
            Some(side) => push.fix(side, &[Axis::Z]),
            None => push,
        };
        let reports = driver.run(&push, 1, |_, _| ()).expect("slides");
        assert_eq!(reports[0].half_dragged.len(), told);
        let friction = -driver.tool_force("floor").expect("a tool")[0];
        // All of the weight rubs but that of the nodes that are told.
        assert_eq!((friction - 0.3 * 4.0).abs() < 1e-9, told == 0, "{friction}");
    }
}
