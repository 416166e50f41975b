//! Uniform states that pass between meshes that do not match, in the plane.

use super::*;
use moreau::laws::Status;
use moreau::mesh::Axisymmetric;

/// Every pairing of elements and meshes of the patch tests; the kink of the last lines is not that
/// of the others.
fn patches() -> Vec<Stack> {
    let mut all = Vec::new();
    let kinds = [
        [CellKind::Quad4, CellKind::Quad4],
        [CellKind::Quad8, CellKind::Quad8],
        [CellKind::Tri6, CellKind::Quad4],
        [CellKind::Tri3, CellKind::Quad9],
    ];
    let shift = 2f64.sqrt() / 5.0;
    let shifted: Vec<f64> = uniform(0.0, WIDTH, 5)
        .into_iter()
        .map(|x| x + shift * (PI * x / WIDTH).sin())
        .collect();
    for kinds in kinds {
        for lines in [
            [uniform(0.0, WIDTH, 3), uniform(0.0, WIDTH, 3)],
            [uniform(0.0, WIDTH, 3), uniform(0.0, WIDTH, 4)],
            [uniform(0.0, WIDTH, 5), uniform(0.0, WIDTH, 2)],
            [uniform(0.0, WIDTH, 4), shifted.clone()],
        ] {
            for swapped in [false, true] {
                all.push(Stack {
                    kinds,
                    lines: lines.clone(),
                    swapped,
                    ..Stack::new(kinds[0], [1, 1])
                });
            }
        }
    }
    all
}

/// In plane strain between frictionless surfaces.
const SQUEEZED: [f64; 6] = [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0];

/// 4.7 and 4.8: the upper body is held by its contact and a symmetry line alone.
#[test]
fn a_uniform_pressure_passes_between_meshes_that_do_not_match() -> Fallible {
    for stack in patches() {
        for ratio in [1.0, 10.0, 1000.0] {
            let stack = Stack {
                young: [E, E / ratio],
                ..stack.clone()
            };
            let what = format!(
                "{:?} {:?} swapped {}",
                stack.kinds, stack.lines, stack.swapped
            );
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let step = Step::new("press")
                .fix("upper.left", &[Axis::X])
                .fix("lower.left", &[Axis::X])
                .fix("lower.bottom", &[Axis::Y])
                .pressure("upper.top", PRESSURE);
            let reports = driver.run(&step, 1, |_, _| {})?;
            uniform_stress(&driver, SQUEEZED, &format!("{what}, 1:{ratio}"));
            let force = action_is_reaction(&driver, stack.surfaces())?;
            close("resultant", force[1], PRESSURE * WIDTH, 1e-11);
            for c in driver.contacts() {
                assert_ne!(c.status, Status::Open);
                close(&what, c.t[0] / c.area, PRESSURE, 1e-9);
            }
            let report = &reports[0];
            assert!(report.relative_gap().abs() < 1e-12 && report.certificate.penetration < 1e-12);
            let work = report.energies.external_work;
            close("energy", report.energies.stored, work, 1e-9);
        }
    }
    Ok(())
}

/// 4.8: pressure also on the part of the lower block that the upper does not cover.
#[test]
fn a_uniform_pressure_passes_beside_an_overhang() -> Fallible {
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        for swapped in [false, true] {
            let stack = Stack {
                lines: [uniform(0.0, WIDTH, 7), uniform(-1.5, 7.5, 6)],
                swapped,
                ..Stack::new(kind, [1, 1])
            };
            let mut mesh = stack.mesh()?;
            mesh.facet_group_where("beside", "lower.top", |x| x[0] <= 0.0 || x[0] >= WIDTH)?;
            mesh.node_group_where("corner", "lower.bottom", |x| x[0] < -1.0)?;
            mesh.node_group_where("edge", "upper.top", |x| x[0] == 0.0)?;
            let mut driver = stack.driver(mesh, Settings::default())?;
            let step = Step::new("press")
                .fix("corner", &[Axis::X])
                .fix("edge", &[Axis::X])
                .fix("lower.bottom", &[Axis::Y])
                .pressure("beside", PRESSURE)
                .pressure("upper.top", PRESSURE);
            driver.run(&step, 1, |_, _| {})?;
            uniform_stress(&driver, SQUEEZED, &format!("{kind} {swapped}"));
            action_is_reaction(&driver, stack.surfaces())?;
        }
    }
    Ok(())
}

/// 4.9 and 4.10: a uniform shear under stick, the upper body held by friction alone, on an
/// interface that is turned.
#[test]
fn a_uniform_shear_sticks_on_a_turned_interface() -> Fallible {
    const SHEAR: f64 = 20.0;
    for stack in patches() {
        for angle in [0.0, PI / 6.0] {
            let stack = Stack {
                friction: 1.2 * SHEAR / PRESSURE,
                angle,
                ..stack.clone()
            };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let turned = |t: [f64; 2]| stack.turn(t);
            let mut step = Step::new("shear").traction("upper.top", turned([SHEAR, -PRESSURE]));
            for body in ["upper", "lower"] {
                step = step
                    .traction(&format!("{body}.right"), turned([0.0, SHEAR]))
                    .traction(&format!("{body}.left"), turned([0.0, -SHEAR]));
            }
            let bottom = driver.mesh().node_group("lower.bottom")?;
            let back = Rotation2::new(-angle);
            let field = |x: &[f64; 2]| {
                let [x, y]: [f64; 2] = (back * Vector2::from(*x)).into();
                let (e_x, e_y) = (
                    NU * (1.0 + NU) * PRESSURE / E,
                    -(1.0 - NU * NU) * PRESSURE / E,
                );
                let slope = 2.0 * SHEAR * (1.0 + NU) / E;
                turned([e_x * x + slope * y, e_y * y])
            };
            let end = prescribed(&driver, &step, &bottom, field)?;
            driver.advance(&end)?;
            let turn = nalgebra::Rotation3::from_axis_angle(&nalgebra::Vector3::z_axis(), angle);
            let mut stress = nalgebra::Matrix3::zeros();
            stress[(0, 1)] = SHEAR;
            stress[(1, 0)] = SHEAR;
            stress[(1, 1)] = -PRESSURE;
            stress[(2, 2)] = -NU * PRESSURE;
            let s = turn.matrix() * stress * turn.matrix().transpose();
            let what = format!(
                "{:?} {:?} swapped {}",
                stack.kinds, stack.lines, stack.swapped
            );
            uniform_stress(&driver, mandel(&s), &format!("{what} {angle}"));
            let force = action_is_reaction(&driver, stack.surfaces())?;
            let exact = Vector2::from(turned([-SHEAR * WIDTH, PRESSURE * WIDTH]));
            assert!((force - exact).norm() <= 1e-9 * exact.norm());
            assert!(driver.contacts().iter().all(|c| c.status == Status::Stick));
        }
    }
    Ok(())
}

/// A side of the upper body moves as the exact solution does: its corner is a contact node without
/// a freedom of its own.
#[test]
fn a_contact_node_that_is_held_takes_part() -> Fallible {
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        for swapped in [false, true] {
            let stack = Stack {
                swapped,
                ..Stack::new(kind, [3, 4])
            };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let e_y = -(1.0 - NU * NU) * PRESSURE / E;
            let e_x = NU * (1.0 + NU) * PRESSURE / E;
            let step = Step::new("press").pressure("upper.top", PRESSURE);
            let mut held = driver.mesh().node_group("upper.left")?;
            held.extend(driver.mesh().node_group("lower.bottom")?);
            let end = prescribed(&driver, &step, &held, |x| {
                [e_x * x[0], e_y * (x[1] + HEIGHT)]
            })?;
            driver.advance(&end)?;
            uniform_stress(&driver, SQUEEZED, &format!("{kind} {swapped}"));
            action_is_reaction(&driver, stack.surfaces())?;
        }
    }
    Ok(())
}

#[test]
fn node_to_surface_fails_the_patch_test_and_keeps_the_balance() -> Fallible {
    let stack = Stack {
        pairing: Pairing::NodeToSurface,
        ..Stack::new(CellKind::Quad4, [3, 4])
    };
    let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
    let step = Step::new("press")
        .fix("upper.left", &[Axis::X])
        .fix("lower.left", &[Axis::X])
        .fix("lower.bottom", &[Axis::Y])
        .pressure("upper.top", PRESSURE);
    driver.run(&step, 1, |_, _| {})?;
    let error = stress_error(&driver, SQUEEZED);
    assert!(error > 1e-3, "{error:.2e}");
    close(
        "resultant",
        action_is_reaction(&driver, stack.surfaces())?[1],
        PRESSURE * WIDTH,
        1e-11,
    );
    Ok(())
}

/// Three bodies, two pairs; the middle one is held by its contacts alone.
#[test]
fn a_pressure_passes_through_a_body_between_two_others() -> Fallible {
    let block = |name: &str, kind, n, y: f64| {
        block2(name, kind, &uniform(0.0, WIDTH, n), &uniform(y, y + 1.0, 1))
    };
    for middle_first in [false, true] {
        let mesh = block("low", CellKind::Quad8, 3, 0.0)?
            .joined(block("middle", CellKind::Quad4, 5, 1.0)?)?
            .joined(block("high", CellKind::Tri6, 4, 2.0)?)?;
        let mut pairs = [("middle.bottom", "low.top"), ("high.bottom", "middle.top")];
        if middle_first {
            pairs[1] = (pairs[1].1, pairs[1].0);
        }
        let law = Coulomb::new(0.3)?;
        let mut model = Model::new(mesh, PlaneStrain::default());
        for name in ["low", "middle", "high"] {
            model = model.material(name, Elastic::new(E, NU)?, Integration::Full)?;
        }
        for (own, other) in pairs {
            model = model.contact(own, other, law)?;
        }
        let mut driver = Driver::new(model, Settings::default())?;
        let step = Step::new("press")
            .fix("low.left", &[Axis::X])
            .fix("low.bottom", &[Axis::Y])
            .pressure("high.top", PRESSURE);
        driver.run(&step, 1, |_, _| {})?;
        uniform_stress(&driver, SQUEEZED, "through the middle");
        let middle = driver.contact_force("middle")?;
        assert!(middle.norm() <= 1e-10 * PRESSURE * WIDTH, "{middle}");
    }
    Ok(())
}

/// The corner of a block is a contact point on the floor, and opposite to those of a wall.
#[test]
fn a_block_in_a_corner_is_held_by_two_other_bodies() -> Fallible {
    const SIDE: f64 = 3.0;
    const PUSH: f64 = 30.0;
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        let block = |name: &str, x: [f64; 2], y: [f64; 2], n: usize| {
            block2(name, kind, &uniform(x[0], x[1], n), &uniform(y[0], y[1], n))
        };
        let mut mesh = block("block", [0.0, SIDE], [0.0, SIDE], 3)?
            .joined(block("floor", [0.0, SIDE], [-1.0, 0.0], 4)?)?
            .joined(block("wall", [-1.0, 0.0], [0.0, SIDE], 2)?)?;
        mesh.node_group_where("foot", "wall.left", |x| x[1] == 0.0)?;
        let law = Coulomb::new(0.0)?;
        let mut model = Model::new(mesh, PlaneStrain::default());
        for name in ["block", "floor", "wall"] {
            model = model.material(name, Elastic::new(E, NU)?, Integration::Full)?;
        }
        let model = model.contact("block.bottom", "floor.top", law)?.contact(
            "wall.right",
            "block.left",
            law,
        )?;
        let mut driver = Driver::new(model, Settings::default())?;
        let step = Step::new("push")
            .fix("floor.bottom", &[Axis::Y])
            .fix("floor.left", &[Axis::X])
            .fix("wall.left", &[Axis::X])
            .fix("foot", &[Axis::Y])
            .pressure("block.top", PRESSURE)
            .pressure("block.right", PUSH);
        driver.run(&step, 1, |_, _| {})?;
        for point in driver.points() {
            let [x, y] = point.position;
            let x_stress = if y > 0.0 { -PUSH } else { 0.0 };
            let y_stress = if x > 0.0 { -PRESSURE } else { 0.0 };
            let z_stress = NU * (x_stress + y_stress);
            let exact = Sym2::from_column_slice(&[x_stress, y_stress, z_stress, 0.0, 0.0, 0.0]);
            let error = (point.stress - exact).norm() / PRESSURE;
            assert!(
                error <= 1e-10,
                "{kind}: stress off by {error:.2e} at {x}, {y}"
            );
        }
    }
    Ok(())
}

#[test]
fn a_uniform_pressure_passes_between_two_discs() -> Fallible {
    for (kind, other) in [
        (CellKind::Quad4, CellKind::Quad8),
        (CellKind::Quad8, CellKind::Quad8),
        (CellKind::Quad8, CellKind::Tri3),
    ] {
        for swapped in [false, true] {
            let stack = Stack {
                kinds: [kind, other],
                swapped,
                ..Stack::new(kind, [3, 4])
            };
            let [own, opposite] = stack.surfaces();
            let model = Model::new(stack.mesh()?, Axisymmetric)
                .material("upper", Elastic::new(E, NU)?, Integration::Full)?
                .material("lower", Elastic::new(E / 9.0, NU)?, Integration::Full)?
                .contact(own, opposite, Coulomb::new(0.0)?)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let step = Step::new("press")
                .fix("upper.left", &[Axis::X])
                .fix("lower.left", &[Axis::X])
                .fix("lower.bottom", &[Axis::Y])
                .pressure("upper.top", PRESSURE);
            driver.run(&step, 1, |_, _| {})?;
            uniform_stress(
                &driver,
                [0.0, -PRESSURE, 0.0, 0.0, 0.0, 0.0],
                &format!("{kind} {other} {swapped}"),
            );
            let force = action_is_reaction(&driver, stack.surfaces())?;
            close("resultant", force[1], PRESSURE * PI * WIDTH * WIDTH, 1e-11);
        }
    }
    Ok(())
}
