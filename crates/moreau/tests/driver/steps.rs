//! The driver on small problems whose answers are known: bodies that only contact holds, gaps that
//! close, tools that roll off, supports that are released.

use moreau_contact::{Ball, Penalty, Plane};
use moreau_driver::{
    Axis, Driver, Increments, Model, ModelError, Nesting, Numbers, Saved, Seam, Settings, Step,
};
use moreau_laws::{Coulomb, Elastic, Status, VonMises};
use moreau_mesh::{
    Axisymmetric, CellKind, Facet, Integration, Mesh, PlaneStrain, Solid, block2, block3, uniform,
};
use std::f64::consts::PI;
use std::ops::ControlFlow;

const YOUNG: f64 = 210e3;

fn coulomb(mu: f64) -> Coulomb {
    Coulomb::new(mu).expect("valid")
}

fn steel() -> VonMises {
    VonMises::new(YOUNG, 0.3, 300.0).expect("valid")
}

fn mesh(cells: [usize; 2]) -> Mesh<2> {
    let (x, y) = (uniform(0.0, 50.0, cells[0]), uniform(0.0, 20.0, cells[1]));
    let mut mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
    mesh.node_group_where("punch", "block.top", |x| x[0] <= 25.0 + 1e-9)
        .expect("not empty");
    mesh
}

/// The block above a floor at height `floor`.
pub(crate) fn on_floor(cells: [usize; 2], floor: f64, mu: f64, settings: Settings<2>) -> Driver<2> {
    let model = Model::new(mesh(cells), PlaneStrain::default())
        .material("block", steel(), Integration::Reduced)
        .and_then(|m| {
            m.tool(
                "floor",
                Plane::new([0.0, floor], [0.0, 1.0]).expect("valid"),
            )
        })
        .and_then(|m| m.contact("block.bottom", "floor", coulomb(mu)))
        .expect("valid");
    Driver::new(model, settings).expect("valid")
}

#[test]
fn a_block_that_only_contact_holds_carries_its_load() {
    let mut driver = on_floor([6, 2], 0.0, 0.3, Settings::default());
    let reports = driver
        .run(&Step::new("load").pressure("block.top", 40.0), 2, |_, _| {})
        .expect("held");
    // Friction hinders the lateral strain; the resultant is the load all the same.
    let force = driver.tool_force("floor").expect("exists");
    assert!(
        (force[1] - 40.0 * 50.0).abs() < 1e-8 && force[0].abs() < 1e-8,
        "{force}"
    );
    assert!(
        reports
            .iter()
            .all(|r| r.newton_iterations <= 2 && r.relative_gap() < 1e-12)
    );
    assert!(driver.contacts().iter().all(|c| c.status != Status::Open));
}

#[test]
fn a_hovering_block_falls_on_the_floor() {
    // Near, and twenty times its own size away.
    for gap in [0.05, 1000.0] {
        let mut driver = on_floor([6, 2], -gap, 0.0, Settings::default());
        let step = Step::new("load")
            .fix("block.left", &[Axis::X])
            .pressure("block.top", 40.0);
        driver.run(&step, 2, |_, _| {}).expect("the floor stops it");
        for c in driver.contacts() {
            assert!(
                (driver.displacement(c.node)[1] + gap).abs() < 1e-12 * (1.0 + gap),
                "not on the floor"
            );
        }
        // Frictionless: the state is uniform uniaxial stress in plane strain, but for what rounding of
        // the fall strains the cells by.
        let small = 1e-8 * (1.0 + gap);
        for p in driver.points() {
            assert!((p.stress[1] + 40.0).abs() < small && p.stress[0].abs() < small);
            assert!((p.stress[2] + 0.3 * 40.0).abs() < small);
        }
    }
}

#[test]
fn an_opened_contact_closes_again_when_its_gap_is_used_up() {
    // An elastic column on a floor, lifted by its top and set down again.
    let elastic = Elastic::new(YOUNG, 0.3).expect("valid");
    let model = Model::new(mesh([4, 2]), PlaneStrain::default())
        .material("block", elastic, Integration::Reduced)
        .and_then(|m| m.tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0]).expect("valid")))
        .and_then(|m| m.contact("block.bottom", "floor", coulomb(0.2)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let top = |v| {
        Step::new("move")
            .fix("block.left", &[Axis::X])
            .displace("block.top", Axis::Y, v)
    };
    driver.run(&top(-0.01), 1, |_, _| {}).expect("presses");
    let pressed = driver.tool_force("floor").expect("exists")[1];
    assert!(pressed > 1.0);
    driver.run(&top(0.03), 2, |_, _| {}).expect("lifts");
    // The gap closes at a rate, but is still open at every increment down to zero travel.
    let mut gaps = Vec::new();
    driver
        .run(&top(0.001), 3, |d, r| {
            assert_eq!((r.open, r.stick, r.slip), (d.contacts().len(), 0, 0));
            assert!(
                d.contacts()
                    .iter()
                    .all(|c| c.t.norm() == 0.0 && c.u[0] > 0.0)
            );
            gaps.push(d.contacts()[0].u[0]);
        })
        .expect("lowers");
    assert!(gaps.windows(2).all(|g| g[1] < g[0]), "{gaps:?}");
    driver
        .run(&top(-0.01), 1, |_, _| {})
        .expect("presses again");
    assert!(driver.contacts().iter().all(|c| c.u[0].abs() < 1e-15));
    let again = driver.tool_force("floor").expect("exists")[1];
    assert!((again / pressed - 1.0).abs() < 1e-9, "{again} {pressed}");
}

#[test]
fn a_cylinder_pressed_into_the_block_touches_without_penetration() {
    let model = Model::new(mesh([40, 8]), PlaneStrain::default())
        .material("block", steel(), Integration::Reduced)
        .and_then(|m| m.tool("roll", Ball::new([0.0, 120.0], 100.0).expect("valid")))
        .and_then(|m| m.contact("block.top", "roll", coulomb(0.2)))
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let held = Step::new("press")
        .fix("block.left", &[Axis::X])
        .fix("block.bottom", &[Axis::Y]);
    let reports = driver
        .run(&held.tool("roll", [0.0, -0.1]), 5, |_, _| {})
        .expect("converges");
    let closed: Vec<_> = driver
        .contacts()
        .iter()
        .filter(|c| c.status != Status::Open)
        .collect();
    assert!(closed.len() > 3 && closed.len() < driver.contacts().len());
    for c in driver.contacts() {
        let x = nalgebra::Vector2::from(c.position) + driver.displacement(c.node);
        let center = nalgebra::Vector2::new(0.0, 119.9);
        let gap = (x - center).norm() - 100.0;
        assert!(gap > -1e-10, "penetration {gap}");
        if c.status != Status::Open {
            assert!(gap.abs() < 1e-10, "gap {gap} under load");
            // The normal force points away from the centre.
            let n = (x - center) / 100.0;
            assert!((c.force.dot(&n) - c.t[0]).abs() < 1e-8 * c.t[0]);
        }
    }
    assert!(
        reports.iter().all(|r| r.newton_iterations < 12),
        "curvature costs few iterations"
    );
}

#[test]
fn a_released_support_lets_an_elastic_body_return() {
    let elastic = Elastic::new(YOUNG, 0.3).expect("valid");
    let model = Model::new(mesh([6, 2]), PlaneStrain::default())
        .material("block", elastic, Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let held = || {
        Step::new("held")
            .fix("block.left", &[Axis::X])
            .fix("block.bottom", &[Axis::Y])
    };
    driver
        .run(&held().displace("block.top", Axis::Y, -0.1), 1, |_, _| {})
        .expect("elastic");
    let pressed = driver.reaction("block.top").expect("exists")[1];
    assert!(pressed < -1.0);
    let mut halfway = 0.0;
    let reports = driver
        .run(&held(), 2, |d, r| {
            if r.fraction < 1.0 {
                halfway = d.displacement(d.mesh().node_group("block.top").expect("exists")[0])[1];
            }
        })
        .expect("elastic");
    // The reaction is ramped to zero, so that half of it is left halfway.
    assert!((halfway + 0.05).abs() < 1e-12, "{halfway}");
    for node in 0..driver.mesh().nodes().len() {
        assert!(driver.displacement(node).norm() < 1e-12);
    }
    let energies = reports.last().expect("two").energies;
    assert!(energies.external_work.abs() < 1e-9 && energies.imbalance().abs() < 1e-9);
}

#[test]
fn the_papers_nesting_ends_where_the_exact_method_ends() {
    let press = |settings| {
        let mut driver = on_floor([4, 2], 0.0, 0.2, settings);
        let step =
            Step::new("press")
                .fix("block.left", &[Axis::X])
                .displace("punch", Axis::Y, -0.015);
        let reports = driver.run(&step, 2, |_, _| {}).expect("converges");
        (driver, reports)
    };
    let (exact, _) = press(Settings::default());
    let largest = exact
        .contacts()
        .iter()
        .map(|c| c.t.norm())
        .fold(0.0, f64::max);
    let [plain, extrapolated] = [false, true].map(|extrapolated| {
        let nesting = Nesting::Outside {
            tolerance: 1e-8,
            iterations: 20_000,
            extrapolated,
        };
        let (nested, reports) = press(Settings {
            nesting,
            ..Settings::default()
        });
        for (a, b) in exact.contacts().iter().zip(nested.contacts()) {
            assert!((a.t - b.t).norm() < 1e-6 * largest, "{} {}", a.t, b.t);
        }
        reports.iter().map(|r| r.nonlinear_solves).sum::<usize>()
    });
    assert!(extrapolated > 20, "{extrapolated}");
    assert!(3 * extrapolated < plain, "{extrapolated} {plain}");
}

#[test]
fn a_solid_block_is_dragged_by_a_sliding_plate() {
    for kind in [CellKind::Hex8, CellKind::Tet4] {
        let lines = uniform(0.0, 10.0, 2);
        let mesh = block3("block", kind, &lines, &lines, &lines).expect("valid");
        let model = Model::new(mesh, Solid)
            .material(
                "block",
                Elastic::new(YOUNG, 0.3).expect("valid"),
                Integration::Full,
            )
            .and_then(|m| {
                m.tool(
                    "plate",
                    Plane::new([0.0, 10.0, 0.0], [0.0, -1.0, 0.0]).expect("valid"),
                )
            })
            .and_then(|m| m.contact("block.top", "plate", coulomb(0.25)))
            .expect("valid");
        let mut driver = Driver::new(model, Settings::default()).expect("valid");
        let held = || Step::new("held").fix("block.bottom", &[Axis::X, Axis::Y, Axis::Z]);
        driver
            .run(&held().tool("plate", [0.0, -0.01, 0.0]), 1, |_, _| {})
            .expect("presses");
        let pressed = driver.tool_force("plate").expect("exists");
        assert!(pressed[1] < -1000.0, "{kind}: {pressed}");
        // Moved along (3, 4)/5 in the plane by far more than the block can follow: all slides.
        let reports = driver
            .run(&held().tool("plate", [0.3, -0.01, 0.4]), 4, |_, _| {})
            .expect("slides");
        let dragged = driver.tool_force("plate").expect("exists");
        let friction = 0.25 * dragged[1].abs();
        assert!(
            (dragged[0] - 0.6 * friction).abs() < 0.02 * friction,
            "{kind}: {dragged}"
        );
        assert!(
            (dragged[2] - 0.8 * friction).abs() < 0.02 * friction,
            "{kind}: {dragged}"
        );
        let last = reports.last().expect("four");
        assert_eq!((last.open, last.stick), (0, 0), "{kind}");
        assert!(last.energies.friction_dissipation > 0.0 && last.relative_gap() < 1e-10);
        // Friction is opposed to the slip at every point, not only in the sum.
        for c in driver.contacts() {
            let (t, u) = (c.t.fixed_rows::<2>(1), c.u.fixed_rows::<2>(1));
            assert!((t.norm() - 0.25 * c.t[0]).abs() < 1e-9 * c.t[0].max(1.0));
            assert!(t.dot(&u) < -0.999_999 * t.norm() * u.norm());
        }
    }
}

#[test]
fn energies_of_the_penalty_add_up_where_all_is_elastic_and_smooth() {
    let settings = Settings {
        contact: Box::new(Penalty::new(1e4, 1e4).expect("valid")),
        ..Settings::default()
    };
    let mut driver = on_floor([6, 2], 0.0, 0.0, settings);
    let step = Step::new("load")
        .fix("block.left", &[Axis::X])
        .pressure("block.top", 40.0);
    let reports = driver.run(&step, 3, |_, _| {}).expect("converges");
    let energies = reports.last().expect("three").energies;
    assert!(
        energies.penalty > 0.1 * energies.stored,
        "soft springs hold much"
    );
    assert!(energies.imbalance().abs() < 1e-9 * energies.external_work);
}

/// Written before each of its increments and read by a virgin driver of the same model, a run goes
/// on to the bit, with the same work.
#[test]
fn a_state_that_is_read_back_goes_on_to_the_bit() {
    let press = Step::new("press")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.1);
    let lift = Step::new("lift").fix("block.left", &[Axis::X]);
    let bits = |driver: &Driver<2>| -> Vec<u64> {
        let mut numbers = Vec::new();
        driver.write(&mut numbers);
        numbers.into_iter().map(f64::to_bits).collect()
    };
    let virgin = || on_floor([6, 2], 0.0, 0.3, Settings::default());
    for step in [&press, &lift] {
        let mut driver = virgin();
        if step == &lift {
            driver.run(&press, 2, |_, _| {}).expect("converges");
        }
        let mut ramp = driver.begin(step, 4).expect("valid");
        let mut saved = Vec::new();
        let mut reports = Vec::new();
        while !ramp.is_done() {
            let mut numbers = Vec::new();
            driver.write(&mut numbers);
            ramp.write(&mut numbers);
            saved.push(numbers);
            reports.push(
                driver
                    .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
                    .expect("converges"),
            );
        }
        assert!(step == &lift || reports.iter().any(|r| r.plastic_fraction > 0.0));
        for (k, numbers) in saved.iter().enumerate() {
            let mut other = virgin();
            let mut from = Numbers::Read(numbers);
            other.read(&mut from).expect("fits");
            let mut ramp = other.begin(step, Increments::equal(4)).expect("valid");
            ramp.read(&mut from).expect("fits");
            for report in &reports[k..] {
                let again = other
                    .proceed(&mut ramp, &mut |_| ControlFlow::Continue(()))
                    .expect("converges");
                assert_eq!(&again, report);
            }
            assert_eq!(bits(&other), bits(&driver));
        }
        // Of another mesh, or too short.
        let mut other = on_floor([5, 2], 0.0, 0.3, Settings::default());
        let error = other
            .read(&mut Numbers::Read(&saved[0]))
            .expect_err("unlike");
        assert!(matches!(error, ModelError::Saved { .. }), "{error}");
        let half = &saved[0][..saved[0].len() / 2];
        assert!(virgin().read(&mut Numbers::Read(half)).is_err());
        // The first is a count.
        for wrong in [f64::NAN, -1.0, 0.5] {
            let mut numbers = saved[0].clone();
            numbers[0] = wrong;
            assert!(virgin().read(&mut Numbers::Read(&numbers)).is_err());
        }
    }
}

/// A surface that touches at a distance, or where it is, carries what one on the floor does.
#[test]
fn gap_offsets_and_adjusted_gaps_move_nothing() {
    let load = Step::new("load")
        .fix("block.left", &[Axis::X])
        .displace("punch", Axis::Y, -0.05);
    let mut flush = on_floor([6, 2], 0.0, 0.2, Settings::default());
    flush.run(&load, 2, |_, _| {}).expect("converges");
    let model = |floor: f64| {
        Model::new(mesh([6, 2]), PlaneStrain::default())
            .material("block", steel(), Integration::Reduced)
            .and_then(|m| {
                let plane = Plane::new([0.0, floor], [0.0, 1.0])?;
                m.tool("floor", plane)
            })
            .and_then(|m| m.contact("block.bottom", "floor", coulomb(0.2)))
            .expect("valid")
    };
    let models = [
        model(-0.3).gap_offset(0.3),
        model(-0.01).adjust(0.02),
        model(0.015).adjust(0.02),
        model(-0.31).gap_offset(0.3).and_then(|m| m.adjust(0.02)),
    ];
    for driver in models {
        let mut driver = Driver::new(driver.expect("valid"), Settings::default()).expect("valid");
        driver.run(&load, 2, |_, _| {}).expect("converges");
        let (a, b) = (
            driver.tool_force("floor").expect("exists"),
            flush.tool_force("floor").expect("exists"),
        );
        assert!((a - b).norm() < 1e-8 * b.norm(), "{a} {b}");
    }
    // A gap beyond the tolerance stays one.
    let far = model(-0.3).adjust(0.02).expect("valid");
    let mut far = Driver::new(far, Settings::default()).expect("valid");
    let held = load.fix("block.right", &[Axis::X, Axis::Y]);
    far.run(&held, 1, |_, _| {}).expect("converges");
    assert_eq!(far.tool_force("floor").expect("exists").norm(), 0.0);
    assert!(model(0.0).gap_offset(f64::NAN).is_err());
    assert!(model(0.0).adjust(-1.0).is_err());
}

/// What is said of the contact added last is said of one.
#[test]
fn nothing_is_said_of_a_contact_that_there_is_not() {
    let model = || Model::new(mesh([6, 2]), PlaneStrain::default());
    for refused in [
        model().gap_offset(0.3),
        model().adjust(0.02),
        model().along([1.0, 0.0]),
    ] {
        let error = refused.err().expect("refused").to_string();
        assert!(error.contains("a contact before it"), "{error}");
    }
}

/// Bodies that overlap a little, or do not quite meet, and whose contact is adjusted, touch without stress: pressed
/// together they carry what bodies do that meet.
#[test]
fn adjusted_bodies_touch_where_they_are() {
    let pressed = |gap: f64, adjusted: Option<f64>| {
        let (x, y) = (uniform(0.0, 4.0, 4), uniform(0.0, 2.0, 2));
        let lower = block2("lower", CellKind::Quad8, &x, &y).expect("valid");
        let (x, y) = (uniform(0.0, 4.0, 3), uniform(2.0 + gap, 4.0 + gap, 2));
        let upper = block2("upper", CellKind::Quad8, &x, &y).expect("valid");
        let model = Model::new(lower.joined(upper).expect("valid"), PlaneStrain::default())
            .material("lower", steel(), Integration::Reduced)
            .and_then(|m| m.material("upper", steel(), Integration::Reduced))
            .and_then(|m| m.contact("upper.bottom", "lower.top", coulomb(0.2)))
            .and_then(|m| match adjusted {
                Some(within) => m.adjust(within),
                None => Ok(m),
            });
        let mut driver = Driver::new(model.expect("valid"), Settings::default()).expect("valid");
        let found = driver.least_gaps()[0].gap;
        let step = Step::new("press")
            .fix("lower.bottom", &[Axis::X, Axis::Y])
            .fix("upper.left", &[Axis::X])
            .displace("upper.top", Axis::Y, -0.001);
        driver.run(&step, 1, |_, _| {}).expect("converges");
        (found, driver.reaction("upper.top").expect("exists")[1])
    };
    let (_, flush) = pressed(0.0, None);
    assert!(flush < 0.0);
    for gap in [-0.01, 0.01] {
        let (found, force) = pressed(gap, Some(0.02));
        assert!(found.abs() < 1e-12, "{found}");
        assert!((force / flush - 1.0).abs() < 1e-3, "{force} {flush}");
        let (found, far) = pressed(gap, Some(0.005));
        assert!((found - gap).abs() < 1e-12, "{found}");
        assert!((far / flush - 1.0).abs() > 0.5, "{far}");
    }
}

/// A soft ring that lies on a floor and is squeezed by a lid, both without friction, beside a wall:
/// it could go there, and does not.
#[test]
fn a_ring_without_friction_is_squeezed_in_few_iterations() {
    let (sides, radii) = (48, [2.0, 2.25, 2.5]);
    let around = |layer: usize, k: usize| layer * sides + k % sides;
    let at = |layer: usize, k: usize| {
        let (s, c) = (2.0 * PI * k as f64 / sides as f64).sin_cos();
        [radii[layer] * s, 2.5 - radii[layer] * c]
    };
    let nodes = (0..3).flat_map(|layer| (0..sides).map(move |k| at(layer, k)));
    let cells = (0..2).flat_map(|layer| (0..sides).map(move |k| (layer, k)));
    let cells = cells.map(|(layer, k)| {
        let corners = [
            (layer + 1, k),
            (layer + 1, k + 1),
            (layer, k + 1),
            (layer, k),
        ];
        (CellKind::Quad4, corners.map(|(l, k)| around(l, k)).to_vec())
    });
    let mut ring = Mesh::new(nodes.collect(), cells.collect()).expect("valid");
    ring.add_cell_group("ring", (0..2 * sides).collect())
        .expect("valid");
    let outer = (sides..2 * sides).map(|cell| Facet { cell, facet: 0 });
    ring.add_facet_group("skin", outer.collect())
        .expect("valid");
    let plane = |y: f64| Plane::new([0.0, y], [0.0, 2.5 - y]).expect("valid");
    let model = Model::with_large_strains(ring, PlaneStrain::default())
        .material(
            "ring",
            Elastic::new(6.0, 0.49).expect("valid"),
            Integration::Full,
        )
        .and_then(|m| m.tool("floor", plane(0.0)))
        .and_then(|m| m.tool("lid", plane(5.0)))
        .and_then(|m| m.contact("skin", "floor", coulomb(0.0)))
        .and_then(|m| m.contact("skin", "lid", coulomb(0.0)))
        .and_then(|m| m.tool("wall", Plane::new([2.9, 0.0], [-1.0, 0.0]).expect("valid")))
        .and_then(|m| m.contact("skin", "wall", coulomb(0.0)));
    let mut driver = Driver::new(model.expect("valid"), Settings::default()).expect("valid");
    let step = Step::new("squeeze").tool("lid", [0.0, -1.0]);
    let mut iterations = Vec::new();
    driver
        .run(&step, 10, |_, report| {
            iterations.push(report.newton_iterations)
        })
        .expect("converges");
    let all: usize = iterations.iter().sum();
    assert!(all < 150, "{iterations:?}");
}

/// A block on a floor, pressed by a roll that is lifted again: once nothing presses it stays where it is, whatever the roll
/// does, and the motion that no force decides is told.
#[test]
fn what_is_let_go_stays_behind() {
    for (large, seam) in [
        (false, Seam::Condensed),
        (false, Seam::Tied),
        (true, Seam::Condensed),
        (true, Seam::Tied),
    ] {
        let (x, y) = (uniform(0.0, 40.0, 8), uniform(0.0, 20.0, 4));
        let mesh = block2("block", CellKind::Quad8, &x, &y).expect("valid");
        let model = match large {
            true => Model::with_large_strains(mesh, PlaneStrain::default()),
            false => Model::new(mesh, PlaneStrain::default()),
        };
        let model = model
            .material("block", steel(), Integration::Reduced)
            .and_then(|m| m.tool("roll", Ball::new([0.0, 40.0], 20.0).expect("valid")))
            .and_then(|m| m.tool("floor", Plane::new([0.0; 2], [0.0, 1.0]).expect("valid")))
            .and_then(|m| m.contact("block.top", "roll", coulomb(0.1)))
            .and_then(|m| m.contact("block.bottom", "floor", coulomb(0.1)))
            .expect("valid");
        let settings = Settings {
            seam,
            ..Settings::default()
        };
        let mut driver = Driver::new(model, settings).expect("valid");
        let step = |y: f64| {
            Step::new("move")
                .fix("block.left", &[Axis::X])
                .tool("roll", [0.0, y])
        };
        driver.run(&step(-0.1), 5, |_, _| {}).expect("converges");
        let at = |driver: &Driver<2>| driver.displacement(0)[1];
        let mut seen = Vec::new();
        let reports = driver.run(&step(0.3), 20, |driver, report| {
            let force = driver.tool_force("roll").expect("there").norm();
            seen.push((force, at(driver), report.free_motions.len()));
        });
        let what = format!("{large} {seam:?}: {seen:?}");
        assert!(
            reports.expect("converges").iter().all(|r| r.cuts == 0),
            "{what}"
        );
        let free = seen.iter().position(|s| s.0 < 1e-6).expect("it is let go");
        assert!((1..10).contains(&free), "{what}");
        for (_, u, motions) in &seen[free..] {
            assert!((u - seen[free].1).abs() < 1e-6 && *motions == 1, "{what}");
        }
    }
}

/// A force on facets is a traction that is the same everywhere: what it pulls stretches evenly.
#[test]
fn a_force_on_facets_pulls_evenly() {
    let lines = [0.0, 1.0, 3.0, 4.0];
    let law = Elastic::new(1000.0, 0.0).expect("valid");
    let mesh = block2("bar", CellKind::Quad8, &lines, &lines).expect("valid");
    let model = Model::new(mesh, Axisymmetric)
        .material("bar", law, Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("pull").fix("bar.bottom", &[Axis::Y]);
    let step = step.force("bar.top", [0.0, 10.0 * PI * 16.0]);
    driver.run(&step, 1, |_, _| {}).expect("converges");
    let nodes = driver.mesh().nodes().iter().enumerate();
    let even = |(a, x): (usize, &[f64; 2])| (driver.displacement(a)[1] - 0.01 * x[1]).abs() < 1e-12;
    assert!(nodes.clone().all(even));
    // Facets on the axis have no area: their nodes share the force.
    let axial = Step::new("axial").fix("bar.bottom", &[Axis::Y]);
    let axial = axial.force("bar.left", [0.0, 7.0]);
    driver.run(&axial, 1, |_, _| {}).expect("converges");
    let reaction = driver.reaction("bar.bottom").expect("exists")[1];
    assert!((reaction + 7.0).abs() < 1e-9, "{reaction}");

    let mesh = block3("bar", CellKind::Hex20, &lines, &lines, &lines).expect("valid");
    let model = Model::new(mesh, Solid)
        .material("bar", law, Integration::Reduced)
        .expect("valid");
    let mut driver = Driver::new(model, Settings::default()).expect("valid");
    let step = Step::new("pull")
        .fix("bar.bottom", &[Axis::Y])
        .fix("bar.left", &[Axis::X])
        .fix("bar.back", &[Axis::Z])
        .force("bar.top", [0.0, 160.0, 0.0]);
    driver.run(&step, 1, |_, _| {}).expect("converges");
    let nodes = driver.mesh().nodes().iter().enumerate();
    let even = |(a, x): (usize, &[f64; 3])| (driver.displacement(a)[1] - 0.01 * x[1]).abs() < 1e-12;
    assert!(nodes.clone().all(even));
}
