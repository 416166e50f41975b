//! Friction where displacement conditions drag a surface along a tool; not where the contact problem decides of slip.

use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, Seam, Settings, Step};
use moreau_laws::{AnisotropicCoulomb, Coulomb, Elastic, Friction, Tresca};
use moreau_mesh::{CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform};

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

/// Unit cubes of a solid on a floor, with 2 MPa on top.
fn pushed(kind: CellKind, law: Friction, seam: Seam) -> Driver<3> {
    let line = uniform(0.0, 2.0, 2);
    let mesh: Mesh<3> = block3("block", kind, &line, &line, &line).expect("valid");
    let floor = Plane::new([0.0, 0.0, 0.0], [0.0, 1.0, 0.0]).expect("a plane");
    let steel = Elastic::new(1e5, 0.3).expect("elastic");
    let model = Model::new(mesh, Solid)
        .material("block", steel, kind.integration())
        .and_then(|m| m.tool("floor", floor))
        .and_then(|m| m.contact("block.bottom", "floor", law))
        .expect("a model");
    let settings = Settings {
        seam,
        ..Settings::default()
    };
    Driver::new(model, settings).expect("a driver")
}

const SEAMS: [Seam; 2] = [Seam::Condensed, Seam::Tied];

/// Of a solid whose side is pushed alone: nodes of that are dragged in one direction and free in the other.
#[test]
fn a_solid_that_is_pushed_by_its_side_takes_the_friction_of_all_of_its_weight() {
    let coulomb: Friction = Coulomb::new(FRICTION).expect("a coefficient").into();
    for (kind, seam) in [CellKind::Hex8, CellKind::Hex20]
        .into_iter()
        .flat_map(|kind| SEAMS.map(|seam| (kind, seam)))
    {
        let mut driver = pushed(kind, coulomb, seam);
        let stand = |name: &str| Step::new(name).pressure("block.top", 1.0);
        driver.run(&stand("stand"), 1, |_, _| ()).expect("stands");
        let weight = 4.0;
        let force = |d: &Driver<3>| d.reaction("block.left").expect("a group")[0];
        for (name, way, sign) in [("push", 0.1, 1.0), ("rest", 0.1, 1.0), ("back", 0.05, -1.0)] {
            let step = stand(name).displace("block.left", Axis::X, way);
            let reports = driver.run(&step, 2, |_, _| ()).expect("slides");
            let expected = sign * FRICTION * weight;
            let off = (force(&driver) - expected).abs();
            assert!(off < 1e-8, "{kind:?}, {seam:?}, {name}: {}", force(&driver));
            let certificate = reports[1].certificate;
            assert!(
                certificate.bipotential_gap.abs() < 1e-9 * weight,
                "{name}: {certificate:?}"
            );
        }
    }
}

/// All nodes are dragged along x, and a force pulls them along z: once the body is strained as it stays, it creeps that
/// way by just as much as turns friction into balance, in increments however short; and it begins to from rest.
#[test]
fn what_is_dragged_creeps_across_under_a_force() {
    let (weight, pull) = (8.0, 1.0);
    let coulomb = Coulomb::new(0.25).expect("a coefficient");
    let tresca = Tresca::new(0.4).expect("a limit");
    let ellipse = AnisotropicCoulomb::new(0.2, 0.3).expect("coefficients");
    // Force along x, and the way across over that along.
    let round = |g: f64| {
        let along = f64::sqrt(g * g - pull * pull);
        (along, pull / along)
    };
    let (a, b) = (0.2 * weight, 0.3 * weight);
    let along = a * f64::sqrt(1.0 - (pull / b) * (pull / b));
    let cases: [(Friction, (f64, f64)); 3] = [
        (coulomb.into(), round(0.25 * weight)),
        (tresca.into(), round(0.4 * 4.0)),
        // The slip is along the normal of the ellipse, (t_x/a², t_z/b²).
        (
            ellipse.into(),
            (along, (pull / (b * b)) / (along / (a * a))),
        ),
    ];
    for ((law, (along, slope)), seam) in cases
        .into_iter()
        .flat_map(|case| SEAMS.map(|seam| (case, seam)))
    {
        let drag = |driver: &mut Driver<3>, to: f64| {
            let step = Step::new("drag")
                .pressure("block.top", weight / 4.0)
                .displace("block", Axis::X, to)
                .body_force("block", [0.0, 0.0, pull / 8.0]);
            let outcome = driver.run(&step, 4, |_, _| ());
            let reports =
                outcome.unwrap_or_else(|error| panic!("{law:?}, {seam:?}, to {to:e}: {error}"));
            // However short the way.
            for newton in reports.iter().map(|r| r.newton_iterations) {
                assert!(newton <= 24, "{law:?}, {seam:?}, to {to:e}: {newton}");
            }
            let floor = driver.tool_force("floor").expect("a tool");
            assert!(
                (floor[2] + pull).abs() < 1e-7,
                "{law:?}, {seam:?}, to {to:e}: {floor:?}"
            );
            (floor[0], driver.displacement(0)[2])
        };
        let mut driver = pushed(CellKind::Hex8, law, seam);
        let (mut at, (_, mut before)) = (0.1, drag(&mut driver, 0.1));
        for way in [0.1, 1e-3, 1e-5, 1e-7] {
            at += way;
            let (force, across) = drag(&mut driver, at);
            let (case, crept) = (format!("{law:?}, {seam:?}, {way:e}"), across - before);
            assert!(
                (force + along).abs() < 1e-5 * along,
                "{case}: {force} for {along}"
            );
            assert!(
                (crept - way * slope).abs() < 1e-4 * way * slope,
                "{case}: {crept:e} for {}",
                way * slope
            );
            before = across;
        }
        for first in [1e-4, 1e-6, 1e-8] {
            drag(&mut pushed(CellKind::Hex8, law, seam), first);
        }
    }
}

/// A node that conditions push up an incline of angle α takes W tan(α + φ), and down it W tan(α − φ).
#[test]
fn friction_on_an_incline_bears_on_what_is_free() {
    let (angle, phi) = (0.3f64, FRICTION.atan());
    for (seam, large) in SEAMS
        .into_iter()
        .flat_map(|seam| [(seam, false), (seam, true)])
    {
        let lines = [uniform(0.0, 1.0, 1), uniform(0.0, 1.0, 1)];
        let kind = CellKind::Quad4;
        let mesh = block2("block", kind, &lines[0], &lines[1]).expect("valid");
        let incline = Plane::new([0.0, 0.0], [-angle.sin(), angle.cos()]).expect("a plane");
        let start = match large {
            true => Model::with_large_strains,
            false => Model::new,
        };
        let steel = Elastic::new(1e5, 0.3).expect("elastic");
        let model = start(mesh, PlaneStrain::default())
            .material("block", steel, kind.integration())
            .and_then(|m| m.tool("incline", incline))
            .and_then(|m| {
                m.contact(
                    "block.bottom",
                    "incline",
                    Coulomb::new(FRICTION).expect("a coefficient"),
                )
            })
            .expect("a model");
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("a driver");
        let weight = |name: &str| Step::new(name).body_force("block", [0.0, -WEIGHT]);
        let mut at = 0.0;
        for (name, way, expected) in [
            ("up", 0.1, (angle + phi).tan()),
            ("rest", 0.0, (angle + phi).tan()),
            ("down", -0.05, (angle - phi).tan()),
            ("creep", -1e-6, (angle - phi).tan()),
        ] {
            at += way;
            let step = weight(name).displace("block", Axis::X, at);
            let case = format!("{name}, {seam:?}, large: {large}");
            let outcome = driver.run(&step, 2, |_, _| ());
            outcome.unwrap_or_else(|error| panic!("{case}: {error}"));
            let push = driver.reaction("block").expect("a group")[0];
            assert!(
                (push - WEIGHT * expected).abs() < 1e-7,
                "{case}: {push} for {}",
                WEIGHT * expected
            );
        }
    }
}

/// A block drawn to twice its length on a floor that then slides below it: a shear of a given limit acts on the surface as
/// it is, and the areas of the contact points are those of that.
#[test]
fn shears_on_tools_act_on_surfaces_as_they_are() {
    let drawn = |kind: CellKind| {
        let (x, y) = (uniform(0.0, 10.0, 2), uniform(0.0, 5.0, 1));
        let mesh = block2("block", kind, &x, &y).expect("valid");
        let model = Model::with_large_strains(mesh, PlaneStrain::default())
            .material(
                "block",
                Elastic::new(1000.0, 0.3).expect("valid"),
                Integration::Full,
            )
            .and_then(|m| m.tool("floor", Plane::new([0.0; 2], [0.0, 1.0]).expect("valid")))
            .and_then(|m| m.contact("block.bottom", "floor", Tresca::new(5.0).expect("valid")))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = |floor: f64| {
            Step::new("draw")
                .fix("block.left", &[Axis::X])
                .displace("block.right", Axis::X, 10.0)
                .displace("block.top", Axis::Y, -2.5)
                .tool("floor", [floor, 0.0])
        };
        driver.run(&step(0.0), 10, |_, _| {}).expect("converges");
        driver.run(&step(-20.0), 2, |_, _| {}).expect("converges");
        let area: f64 = driver.contacts().iter().map(|c| c.area).sum();
        (area, driver.tool_force("floor").expect("there")[0])
    };
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        let (area, shear) = drawn(kind);
        assert!((area - 20.0).abs() < 1e-9, "{area}");
        assert!((shear.abs() - 5.0 * 20.0).abs() < 1e-6, "{shear}");
    }
}
