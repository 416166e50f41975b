//! Nodes between several tools, and at sharp corners of one.

use moreau_contact::{Penalty, Plane, Polyline, Triangulated};
use moreau_driver::{Axis, Driver, Increments, Model, Seam, Settings, Step};
use moreau_laws::{Coulomb, Elastic, Status, VonMises};
use moreau_mesh::{CellKind, Integration, PlaneStrain, Solid, block2, block3, uniform};

fn coulomb(mu: f64) -> Coulomb {
    Coulomb::new(mu).expect("valid")
}

/// A square between a floor and a wall, under the same pressure from above and from the right.
fn cornered(mu: f64, pressure: f64, kind: CellKind) -> (Driver<2>, Step<2>) {
    cornered_with(Settings::default(), mu, pressure, kind)
}

fn cornered_with(
    settings: Settings<2>,
    mu: f64,
    pressure: f64,
    kind: CellKind,
) -> (Driver<2>, Step<2>) {
    let lines = uniform(0.0, 10.0, 6);
    let rule = match kind {
        CellKind::Quad8 => Integration::Reduced,
        _ => Integration::Full,
    };
    let steel = VonMises::new(210e3, 0.3, 300.0).expect("valid");
    let mesh = block2("b", kind, &lines, &lines).expect("valid");
    let model = Model::new(mesh, PlaneStrain::default())
        .material("b", steel, rule)
        .and_then(|m| m.tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid")))
        .and_then(|m| m.tool("wall", Plane::new([0.0, 0.0], [1.0, 0.0]).expect("valid")))
        .and_then(|m| m.contact("b.bottom", "floor", coulomb(mu)))
        .and_then(|m| m.contact("b.left", "wall", coulomb(mu)))
        .expect("valid");
    let press = Step::new("press")
        .pressure("b.top", pressure)
        .pressure("b.right", pressure);
    (Driver::new(model, settings).expect("valid"), press)
}

/// Without friction the stress is uniform, and each wall has the pressure on its nodes, the one in the
/// corner too.
#[test]
fn a_block_pressed_into_a_smooth_corner_is_uniformly_stressed() {
    for kind in [
        CellKind::Tri3,
        CellKind::Tri6,
        CellKind::Quad4,
        CellKind::Quad8,
    ] {
        let (mut driver, press) = cornered(0.0, 50.0, kind);
        let reports = driver.run(&press, 2, |_, _| {}).expect("converges");
        assert!(reports.iter().all(|r| r.cuts == 0));
        for c in driver.contacts() {
            let p = c.traction()[0];
            assert!((p - 50.0).abs() < 1e-7, "{kind:?} {c:?}");
            assert!(c.u[0].abs() < 1e-13, "{kind:?} {c:?}");
        }
        for p in driver.points() {
            assert!((p.stress[0] + 50.0).abs() < 1e-7 && (p.stress[1] + 50.0).abs() < 1e-7);
        }
        // Let go, and pressed again.
        let release = Step::new("release")
            .pressure("b.top", 0.0)
            .pressure("b.right", 0.0);
        driver.run(&release, 1, |_, _| {}).expect("converges");
        let left = driver
            .contacts()
            .iter()
            .map(|c| c.t.norm())
            .fold(0.0, f64::max);
        assert!(left < 1e-7, "{kind:?} {left}");
        driver.run(&press, 1, |_, _| {}).expect("converges");
        let c = &driver.contacts()[0];
        assert!((c.traction()[0] - 50.0).abs() < 1e-7, "{kind:?} {c:?}");
    }
}

/// With friction both walls obey the law at the node of the corner, the forces on both faces balance the
/// loads, and mirroring the block on its diagonal changes nothing.
#[test]
fn a_node_in_a_corner_obeys_the_law_on_both_tools() {
    for (kind, mu) in [
        (CellKind::Quad4, 0.3),
        (CellKind::Quad8, 0.3),
        (CellKind::Quad8, 0.8),
    ] {
        let (mut driver, press) = cornered(mu, 50.0, kind);
        let reports = driver.run(&press, 2, |_, _| {}).expect("converges");
        for r in &reports {
            assert!(
                r.certificate.penetration < 1e-13 && r.relative_gap() < 1e-10,
                "{r:?}"
            );
        }
        let [floor, wall] = ["floor", "wall"].map(|t| driver.tool_force(t).expect("exists"));
        let sum = floor + wall;
        assert!(
            (sum[0] - 500.0).abs() < 1e-7 && (sum[1] - 500.0).abs() < 1e-7,
            "{sum}"
        );
        // How both share what the corner bears, nothing decides.
        let nodes = driver.mesh().nodes();
        for (a, x) in nodes.iter().enumerate() {
            let mirrored = |y: &[f64; 2]| (y[0] - x[1]).abs() + (y[1] - x[0]).abs() < 1e-9;
            let b = nodes.iter().position(mirrored).expect("a mirror image");
            let (u, v) = (driver.displacement(a), driver.displacement(b));
            assert!(
                (u[0] - v[1]).abs() < 1e-10 && (u[1] - v[0]).abs() < 1e-10,
                "{u} {v}"
            );
        }
    }
}

/// The block of [`cornered`] with springs of a penalty.
fn sprung(seam: Seam, stiffness: f64, iterations: usize) -> (Driver<2>, Step<2>) {
    let penalty = || Penalty::new(stiffness, stiffness).expect("a stiffness");
    let settings = Settings {
        seam,
        contact: Box::new(penalty()),
        iterations,
        ..Settings::default()
    };
    cornered_with(settings, 0.3, 50.0, CellKind::Quad8)
}

const SEAMS: [Seam; 2] = [Seam::Condensed, Seam::Tied];

/// By the penalty method too, however stiff its springs: they carry the loads, and give by as much as they are soft.
#[test]
fn springs_in_a_corner_carry_what_presses() {
    for (seam, stiffness) in SEAMS
        .into_iter()
        .flat_map(|seam| [1e4, 1e6, 1e8, 1e11, 1e15].map(|stiffness| (seam, stiffness)))
    {
        let case = format!("{seam:?}, {stiffness:e}");
        let (mut driver, press) = sprung(seam, stiffness, 40);
        let outcome = driver.run(&press, 2, |_, _| {});
        let reports = outcome.unwrap_or_else(|error| panic!("{case}: {error}"));
        let [floor, wall] = ["floor", "wall"].map(|t| driver.tool_force(t).expect("exists"));
        let off = floor + wall - nalgebra::Vector2::repeat(500.0);
        assert!(off.norm() < 1e-5, "{case}: {off}");
        for c in driver.contacts() {
            let given = -c.t[0] / stiffness;
            assert!(
                (c.u[0] - given).abs() < 1e-6 * given.abs() + 1e-12,
                "{case}: {c:?}"
            );
        }
        let newton = reports.iter().map(|r| r.newton_iterations).max();
        assert!(newton <= Some(24), "{case}: {newton:?}");
    }
}

/// Forces balance after an iteration, of what is elastic; the law on both tools takes more. What is told is that.
#[test]
fn a_law_that_is_not_met_in_a_corner_is_told_as_that() {
    for seam in SEAMS {
        let (mut driver, press) = sprung(seam, 1e6, 1);
        let error = driver.run(&press, 1, |_, _| {}).expect_err("too few");
        let message = error.to_string();
        assert!(message.contains("the law of contact left"), "{message}");
    }
}

#[test]
fn a_node_may_touch_three_tools_in_space() {
    let lines = uniform(0.0, 10.0, 2);
    let mesh = block3("b", CellKind::Hex20, &lines, &lines, &lines).expect("valid");
    let plane = |k: usize| {
        let mut normal = [0.0; 3];
        normal[k] = 1.0;
        Plane::new([0.0; 3], normal).expect("valid")
    };
    let mut model = Model::new(mesh, Solid)
        .material(
            "b",
            Elastic::new(1000.0, 0.3).expect("valid"),
            Integration::Reduced,
        )
        .expect("valid");
    for (k, side) in ["left", "bottom", "back"].into_iter().enumerate() {
        model = model
            .tool(side, plane(k))
            .and_then(|m| m.contact(&format!("b.{side}"), side, coulomb(0.2)))
            .expect("valid");
    }
    let mut press = Step::new("press");
    for side in ["right", "top", "front"] {
        press = press.pressure(&format!("b.{side}"), 2.0);
    }
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let reports = driver.run(&press, 1, |_, _| {}).expect("converges");
    assert_eq!(reports[0].cuts, 0);
    let sum = ["left", "bottom", "back"]
        .iter()
        .map(|t| driver.tool_force(t).expect("exists"))
        .fold(nalgebra::Vector3::zeros(), |a, b| a + b);
    assert!(
        (sum - nalgebra::Vector3::repeat(200.0)).norm() < 1e-7,
        "{sum}"
    );
}

/// A wedge pressed into a block, its tip over a node: it goes straight down, and the smallest offset does
/// not decide where.
#[test]
fn a_tip_on_a_node_presses_straight_down() {
    let run = |offset: f64, mu: f64| {
        let (x, y) = (uniform(-10.0, 10.0, 10), uniform(0.0, 10.0, 5));
        let mesh = block2("b", CellKind::Quad8, &x, &y).expect("valid");
        let tip = [[10.0 + offset, 20.0], [offset, 10.0], [offset - 10.0, 20.0]];
        let model = Model::new(mesh, PlaneStrain::default())
            .material(
                "b",
                Elastic::new(210e3, 0.3).expect("valid"),
                Integration::Reduced,
            )
            .and_then(|m| m.tool("t", Polyline::new(&tip).expect("valid")))
            .and_then(|m| m.contact("b.top", "t", coulomb(mu)))
            .expect("valid");
        let step = Step::new("press")
            .fix("b.bottom", &[Axis::X, Axis::Y])
            .tool("t", [0.0, -0.1]);
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let reports = driver.run(&step, 2, |_, _| {}).expect("converges");
        let corners = reports.last().expect("two").corners.clone();
        let at: Vec<f64> = corners
            .iter()
            .map(|&k| driver.contacts()[k].position[0])
            .collect();
        assert_eq!(at, [0.0]);
        assert_eq!(driver.contacts()[corners[0]].status, Status::Stick);
        driver.tool_force("t").expect("exists")
    };
    for mu in [0.0, 0.2] {
        let straight = run(0.0, mu);
        assert!(
            straight[1] < -1000.0 && straight[0].abs() < 1e-9 * straight[1].abs(),
            "{straight}"
        );
        for offset in [1e-9, -1e-9] {
            let beside = run(offset, mu);
            assert!(
                (beside - straight).norm() < 1e-6 * straight.norm(),
                "{beside} {straight}"
            );
        }
    }
}

/// Pulled sideways, the tip leaves the node once the force leaves the cone of its normals and their
/// friction, and the node slides up a face.
#[test]
fn a_tip_that_is_drawn_sideways_slides_off_its_node() {
    let (x, y) = (uniform(-4.0, 4.0, 8), uniform(0.0, 4.0, 4));
    let mesh = block2("b", CellKind::Quad4, &x, &y).expect("valid");
    // Faces of 30 degrees: the cone of normals has half an angle of 30 degrees.
    let rise = 10.0 * 30f64.to_radians().tan();
    let tip = [[10.0, 4.0 + rise], [0.0, 4.0], [-10.0, 4.0 + rise]];
    let model = Model::new(mesh, PlaneStrain::default())
        .material(
            "b",
            Elastic::new(1000.0, 0.3).expect("valid"),
            Integration::Full,
        )
        .and_then(|m| m.tool("t", Polyline::new(&tip).expect("valid")))
        .and_then(|m| m.contact("b.top", "t", coulomb(0.1)))
        .expect("valid");
    let fixed = |name: &str| Step::new(name).fix("b.bottom", &[Axis::X, Axis::Y]);
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    driver
        .run(&fixed("press").tool("t", [0.0, -0.05]), 1, |_, _| {})
        .expect("converges");
    let cone = 0.1f64.atan() + 30f64.to_radians();
    let mut slid = false;
    let drag = fixed("drag").tool("t", [0.1, -0.05]);
    driver
        .run(&drag, Increments::equal(20), |driver, report| {
            let force = driver.tool_force("t").expect("exists");
            assert!(force[0] <= -force[1] * cone.tan() + 1e-9, "{force}");
            if report.corners.is_empty() {
                // On a face at last, which it slides along: at the edge of the cone.
                slid = true;
            }
        })
        .expect("converges");
    assert!(slid);
}

/// A block in the corner of one tool, moved by its other sides: the same as between two tools, evenly stressed, whatever
/// the cells, the strains and the way that contacts are solved; what a friction law asks of the corner, two tools ask too.
#[test]
fn a_concave_corner_of_one_tool_is_two_tools() {
    let pressed = |kind: CellKind, mu: f64, large: bool, seam: Seam, one: bool| {
        let lines = uniform(0.0, 10.0, 2);
        let mut mesh = block2("b", kind, &lines, &lines).expect("valid");
        let sides = ["b.left", "b.bottom"].map(|g| mesh.facet_group(g).expect("there"));
        let sides = sides.concat();
        mesh.add_facet_group("sides", sides).expect("a new name");
        let model = match large {
            true => Model::with_large_strains(mesh, PlaneStrain::default()),
            false => Model::new(mesh, PlaneStrain::default()),
        };
        let law = Elastic::new(1000.0, 0.3).expect("valid");
        let model = model.material("b", law, kind.integration()).expect("valid");
        let line = |points: &[[f64; 2]]| Polyline::new(points).expect("valid");
        let corner = [[20.0, 0.0], [0.0, 0.0], [0.0, 20.0]];
        let model = match one {
            true => model
                .tool("die", line(&[corner[2], corner[1], corner[0]]))
                .and_then(|m| m.contact("sides", "die", coulomb(mu)))
                .expect("valid"),
            false => model
                .tool("floor", Plane::new([0.0; 2], [0.0, 1.0]).expect("valid"))
                .and_then(|m| m.tool("wall", Plane::new([0.0; 2], [1.0, 0.0]).expect("valid")))
                .and_then(|m| m.contact("sides", "wall", coulomb(mu)))
                .and_then(|m| m.contact("sides", "floor", coulomb(mu)))
                .expect("valid"),
        };
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let step = Step::new("press")
            .displace("b.right", Axis::X, -0.1)
            .displace("b.top", Axis::Y, -0.2);
        driver.run(&step, 2, |_, _| {}).expect("converges");
        ["b.right", "b.top"].map(|g| driver.reaction(g).expect("there"))
    };
    for kind in [CellKind::Quad4, CellKind::Quad8, CellKind::Tri6] {
        for (mu, large) in [(0.0, false), (0.0, true), (0.2, false), (0.2, true)] {
            for seam in [Seam::Condensed, Seam::Tied] {
                let [one, two] = [true, false].map(|one| pressed(kind, mu, large, seam, one));
                for (a, b) in one.iter().zip(&two) {
                    assert!(
                        (a - b).norm() < 1e-6 * b.norm(),
                        "{kind:?} {mu} {large}: {a} {b}"
                    );
                }
            }
        }
    }
    let smooth = pressed(CellKind::Quad4, 0.0, false, Seam::Condensed, true);
    // E / ((1 + ν)(1 − 2ν)) ((1 − ν) ε_x + ν ε_y) over a side of 10 mm.
    let expected = [-250.0, -1000.0 / 0.52 * (0.7 * 0.02 + 0.3 * 0.01) * 10.0];
    assert!((smooth[0][0] - expected[0]).abs() < 1e-6, "{smooth:?}");
    assert!((smooth[1][1] - expected[1]).abs() < 1e-6, "{smooth:?}");
}

/// The walls of a room from the origin to (20, 20, 20).
fn room() -> Triangulated {
    let points: Vec<[f64; 3]> = (0..8)
        .map(|k| [k & 1, (k >> 1) & 1, k >> 2].map(|b| 20.0 * f64::from(b)))
        .collect();
    let walls = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let halves = walls.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let room = Triangulated::new(&points, halves.as_flattened(), 0.5);
    room.expect("closed").hollow()
}

/// The same in space: a block in the corner of a room touches three walls, which are one tool of triangles or three planes.
#[test]
fn a_concave_corner_of_a_surface_is_three_tools() {
    let pressed = |kind: CellKind, mu: f64, large: bool, one: bool| {
        let lines = uniform(0.0, 10.0, 2);
        let mut mesh = block3("b", kind, &lines, &lines, &lines).expect("valid");
        let sides = ["b.left", "b.bottom", "b.back"];
        let sides = sides.map(|g| mesh.facet_group(g).expect("there")).concat();
        mesh.add_facet_group("sides", sides).expect("a new name");
        let model = match large {
            true => Model::with_large_strains(mesh, Solid),
            false => Model::new(mesh, Solid),
        };
        let law = Elastic::new(1000.0, 0.3).expect("valid");
        let mut model = model.material("b", law, kind.integration()).expect("valid");
        if one {
            model = (model.tool("room", room()))
                .and_then(|m| m.contact("sides", "room", coulomb(mu)))
                .expect("valid");
        }
        for (k, name) in ["x", "y", "z"].into_iter().enumerate().filter(|_| !one) {
            let normal = std::array::from_fn(|i| f64::from(i == k));
            let wall = Plane::new([0.0; 3], normal).expect("valid");
            model = (model.tool(name, wall))
                .and_then(|m| m.contact("sides", name, coulomb(mu)))
                .expect("valid");
        }
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let step = Step::new("press")
            .displace("b.right", Axis::X, -0.1)
            .displace("b.top", Axis::Y, -0.2)
            .displace("b.front", Axis::Z, -0.15);
        driver.run(&step, 2, |_, _| {}).expect("converges");
        ["b.right", "b.top", "b.front"].map(|g| driver.reaction(g).expect("there"))
    };
    for (kind, mu, large) in [
        (CellKind::Hex8, 0.0, false),
        (CellKind::Hex8, 0.0, true),
        (CellKind::Hex8, 0.2, true),
        (CellKind::Hex20, 0.0, true),
    ] {
        let [one, three] = [true, false].map(|one| pressed(kind, mu, large, one));
        for (a, b) in one.iter().zip(&three) {
            assert!(
                (a - b).norm() < 1e-6 * b.norm(),
                "{kind:?} {mu} {large}: {a} {b}"
            );
        }
    }
}
