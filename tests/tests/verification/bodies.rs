//! Contact of two deformable bodies, meshed as they like: patches, a block on an incline, Hertz,
//! rings shrunk on each other, and what no choice of meshes or methods may change; not tools.

use crate::close;
use moreau::contact::{ContactSolver, GaussSeidel, SemismoothNewton, Uzawa};
use moreau::driver::{Axis, Driver, Loading, Model, ModelError, Nesting, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mandel::Sym2;
use moreau::mesh::{
    Axisymmetric, CellKind, Integration, Mesh, NodeKind, Pairing, PlaneStrain, Solid, block2,
    block3, uniform,
};
use nalgebra::{Rotation2, Vector2};
use std::f64::consts::{FRAC_PI_2, PI};
use verification::problems::Fallible;
use verification::problems::fields::prescribed;
use verification::problems::shapes::graded;

const E: f64 = 210e3;
const NU: f64 = 0.3;
const PRESSURE: f64 = 80.0;
const WIDTH: f64 = 6.0;
const HEIGHT: f64 = 2.0;

/// Two blocks, the upper on the lower.
#[derive(Clone)]
struct Stack {
    kinds: [CellKind; 2],
    /// Lines along x of the upper and of the lower block.
    lines: [Vec<f64>; 2],
    young: [f64; 2],
    friction: f64,
    pairing: Pairing,
    /// Whether the lower block is the non-mortar side.
    swapped: bool,
    /// The whole turned by this angle.
    angle: f64,
}

impl Stack {
    fn new(kind: CellKind, cells: [usize; 2]) -> Self {
        Self {
            kinds: [kind; 2],
            lines: cells.map(|n| uniform(0.0, WIDTH, n)),
            young: [E; 2],
            friction: 0.0,
            pairing: Pairing::Mortar,
            swapped: false,
            angle: 0.0,
        }
    }

    fn turn(&self, v: [f64; 2]) -> [f64; 2] {
        (Rotation2::new(self.angle) * Vector2::from(v)).into()
    }

    fn mesh(&self) -> Fallible<Mesh<2>> {
        let upper = uniform(0.0, HEIGHT, 2);
        let lower = uniform(-HEIGHT, 0.0, 2);
        let mesh = block2("upper", self.kinds[0], &self.lines[0], &upper)?.joined(block2(
            "lower",
            self.kinds[1],
            &self.lines[1],
            &lower,
        )?)?;
        Ok(if self.angle == 0.0 {
            mesh
        } else {
            mesh.map(|x| self.turn(x))?
        })
    }

    /// Names of the non-mortar and of the mortar surface.
    fn surfaces(&self) -> [&'static str; 2] {
        let mut surfaces = ["upper.bottom", "lower.top"];
        if self.swapped {
            surfaces.reverse();
        }
        surfaces
    }

    fn driver(&self, mesh: Mesh<2>, settings: Settings<2>) -> Fallible<Driver<2>> {
        let [own, other] = self.surfaces();
        let rule = |kind: CellKind| match kind {
            CellKind::Quad8 | CellKind::Tri6 => Integration::Reduced,
            _ => Integration::Full,
        };
        let model = Model::new(mesh, PlaneStrain::default())
            .material(
                "upper",
                Elastic::new(self.young[0], NU)?,
                rule(self.kinds[0]),
            )?
            .material(
                "lower",
                Elastic::new(self.young[1], NU)?,
                rule(self.kinds[1]),
            )?
            .pair(own, other, Coulomb::new(self.friction)?, self.pairing)?;
        Ok(Driver::new(model, settings)?)
    }
}

/// What holds for every pair: the forces on both surfaces cancel, and the law is obeyed.
fn action_is_reaction(driver: &Driver<2>, stack: &Stack) -> Fallible<Vector2<f64>> {
    let [own, other] = stack.surfaces();
    let (on_own, on_other) = (driver.contact_force(own)?, driver.contact_force(other)?);
    let size: f64 = driver.contacts().iter().map(|c| c.force.norm()).sum();
    let left = (on_own + on_other).norm();
    assert!(
        left <= 1e-13 * size,
        "{left} N of {size} N are not returned"
    );
    let records: Vector2<f64> = driver.contacts().iter().map(|c| c.force).sum();
    assert!((records - on_own).norm() <= 1e-13 * size);
    Ok(if stack.swapped { on_other } else { on_own })
}

fn stress_error(driver: &Driver<2>, exact: [f64; 6]) -> f64 {
    let exact = Sym2::from_column_slice(&exact);
    let error = |s: Sym2| (s - exact).norm() / exact.norm();
    driver
        .points()
        .iter()
        .map(|p| error(p.stress))
        .fold(0.0, f64::max)
}

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
            let error = stress_error(&driver, [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0]);
            assert!(
                error <= 1e-10,
                "{what}, 1:{ratio}: stress off by {error:.2e}"
            );
            let force = action_is_reaction(&driver, &stack)?;
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
            let error = stress_error(&driver, [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0]);
            assert!(
                error <= 1e-10,
                "{kind} {swapped}: stress off by {error:.2e}"
            );
            action_is_reaction(&driver, &stack)?;
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
            let exact = [
                s[(0, 0)],
                s[(1, 1)],
                s[(2, 2)],
                0.0,
                0.0,
                2f64.sqrt() * s[(0, 1)],
            ];
            let error = stress_error(&driver, exact);
            let what = format!(
                "{:?} {:?} swapped {}",
                stack.kinds, stack.lines, stack.swapped
            );
            assert!(error <= 1e-10, "{what} {angle}: stress off by {error:.2e}");
            let force = action_is_reaction(&driver, &stack)?;
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
            let error = stress_error(&driver, [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0]);
            assert!(
                error <= 1e-10,
                "{kind} {swapped}: stress off by {error:.2e}"
            );
            action_is_reaction(&driver, &stack)?;
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
    let error = stress_error(&driver, [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0]);
    assert!(error > 1e-3, "{error:.2e}");
    close(
        "resultant",
        action_is_reaction(&driver, &stack)?[1],
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
        let error = stress_error(&driver, [0.0, -PRESSURE, -NU * PRESSURE, 0.0, 0.0, 0.0]);
        assert!(error <= 1e-10, "stress off by {error:.2e}");
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
            let error = stress_error(&driver, [0.0, -PRESSURE, 0.0, 0.0, 0.0, 0.0]);
            assert!(
                error <= 1e-10,
                "{kind} {other} {swapped}: stress off by {error:.2e}"
            );
            let force = action_is_reaction(&driver, &stack)?;
            close("resultant", force[1], PRESSURE * PI * WIDTH * WIDTH, 1e-11);
        }
    }
    Ok(())
}

/// 3.6, NAFEMS CGS-4: F/G = (tan α + μ)/(1 − μ tan α), for any meshes.
#[test]
fn a_block_is_pushed_up_an_incline() -> Fallible {
    const TAN: f64 = 0.1;
    /// So light that the deformed surface is as steep as the undeformed one.
    const DENSITY: f64 = 1e-2;
    for (friction, expected) in [
        (0.0, 0.1),
        (0.1, 0.202_020_2),
        (0.2, 0.306_122_4),
        (0.3, 0.412_371_1),
    ] {
        for swapped in [false, true] {
            let stack = Stack {
                lines: [uniform(0.0, WIDTH, 5), uniform(-1.0, 8.0, 6)],
                friction,
                swapped,
                angle: f64::atan(TAN),
                ..Stack::new(CellKind::Quad8, [1, 1])
            };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let hold = |travel: f64| {
                Step::new("push")
                    .fix("lower.bottom", &[Axis::X, Axis::Y])
                    .displace("upper.left", Axis::X, travel)
                    .body_force("upper", [0.0, -DENSITY])
            };
            let reports = driver.run(&hold(1e-3), 2, |_, _| {})?;
            assert!(reports.iter().all(|r| r.cuts == 0), "no increment was cut");
            let weight = DENSITY * WIDTH * HEIGHT;
            let force = driver.reaction("upper.left")?[0];
            close(
                &format!("F/G at μ = {friction}"),
                force / weight,
                expected,
                1e-6,
            );
            action_is_reaction(&driver, &stack)?;
            let closed = driver
                .contacts()
                .iter()
                .filter(|c| c.status != Status::Open);
            assert!(friction == 0.0 || closed.clone().all(|c| c.status == Status::Slip));
            assert!(closed.count() >= 3);
        }
    }
    Ok(())
}

/// 7.1: two elastic bodies of unlike stiffness and mesh.
#[test]
fn hertz_line_contact_of_two_elastic_bodies() -> Fallible {
    const A: f64 = 1.0;
    const RADIUS: f64 = 1000.0;
    const SIZE: f64 = 30.0;
    let young = [E, E / 3.0];
    let e_star = 1.0 / young.iter().map(|e| (1.0 - NU * NU) / e).sum::<f64>();
    let lines = |n: usize, inner: f64| {
        let cells = (inner * n as f64).ceil() as usize;
        let h = inner / cells as f64;
        let mut lines = uniform(0.0, inner, cells);
        lines.extend_from_slice(&graded(inner, SIZE, h, 1.4)[1..]);
        lines
    };
    let body = |name: &str, n: usize, up: bool| -> Fallible<Mesh<2>> {
        let mut y = lines(n, 0.7);
        if !up {
            y = y.iter().rev().map(|y| -y).collect();
        }
        Ok(block2(name, CellKind::Quad8, &lines(n, 1.4), &y)?)
    };
    for swapped in [false, true] {
        let upper = body("upper", 8, true)?;
        let upper = upper.map(|[x, y]| [x, y + x * x / (2.0 * RADIUS)])?;
        let mut mesh = upper.joined(body("lower", 6, false)?)?;
        for (zone, surface) in [("above", "upper.bottom"), ("below", "lower.top")] {
            mesh.facet_group_where(zone, surface, |x| x[0] <= 1.5 * A)?;
        }
        let (own, other) = if swapped {
            ("below", "above")
        } else {
            ("above", "below")
        };
        let model = Model::new(mesh, PlaneStrain::default())
            .material("upper", Elastic::new(young[0], NU)?, Integration::Reduced)?
            .material("lower", Elastic::new(young[1], NU)?, Integration::Reduced)?
            .contact(own, other, Coulomb::new(0.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        // The travel that makes the half width about A.
        let step = Step::new("press")
            .fix("upper.left", &[Axis::X])
            .fix("lower.left", &[Axis::X])
            .fix("lower.bottom", &[Axis::X, Axis::Y])
            .fix("upper.top", &[Axis::X])
            .displace("upper.top", Axis::Y, -2e-3);
        driver.run(&step, 2, |_, _| {})?;
        let half = driver.contact_force("upper.bottom")?[1];
        close("reaction", -driver.reaction("upper.top")?[1], half, 1e-9);
        let load = 2.0 * half;
        let a = (4.0 * load * RADIUS / (PI * e_star)).sqrt();
        let p0 = 2.0 * load / (PI * a);
        assert!(a > 0.8 * A && a < 1.2 * A, "{a}");
        let mut most: f64 = 0.0;
        let mut edge: f64 = 0.0;
        for c in driver.contacts() {
            let x = c.position[0];
            if c.status != Status::Open {
                edge = edge.max(x);
            }
            if c.kind == NodeKind::Midside && x < 0.9 * a {
                let exact = p0 * (1.0 - (x / a).powi(2)).sqrt();
                most = most.max((c.t[0] / c.area - exact).abs() / p0);
            }
        }
        assert!(
            most <= 1e-2,
            "swapped {swapped}: pressure off by {most:.2e}"
        );
        assert!((edge - a).abs() <= A / 6.0, "edge at {edge}, not {a}");
    }
    Ok(())
}

/// 5.6: two rings of unlike stiffness and mesh, one shrunk on the other.
#[test]
fn a_ring_shrunk_on_another_is_pressed_evenly() -> Fallible {
    const RADII: [f64; 3] = [10.0, 20.0, 35.0];
    // Small against the radii, and large against the 1e-6 mm by which quadratic edges miss a circle:
    // these are felt as a ripple.
    const INTERFERENCE: f64 = 2e-2;
    let ring = |name: &str, radii: [f64; 2], cells: [usize; 2]| {
        let (r, angle) = (
            uniform(radii[0], radii[1], cells[0]),
            uniform(0.0, FRAC_PI_2, cells[1]),
        );
        block2(name, CellKind::Quad8, &r, &angle)?.map(|[r, t]| {
            // On the axis exactly.
            if t == FRAC_PI_2 {
                [0.0, r]
            } else {
                [r * t.cos(), r * t.sin()]
            }
        })
    };
    let young = [E, 70e3];
    let [a, b, c] = RADII;
    let plane = |e: f64| (e / (1.0 - NU * NU), NU / (1.0 - NU));
    let ((e_i, nu_i), (e_o, nu_o)) = (plane(young[0]), plane(young[1]));
    let ratio = |p: f64, q: f64| (p * p + q * q) / (p * p - q * q);
    let exact = INTERFERENCE / (b * ((ratio(c, b) + nu_o) / e_o + (ratio(b, a) - nu_i) / e_i));
    for swapped in [false, true] {
        let inner = ring("inner", [a, b + 0.5 * INTERFERENCE], [8, 23])?;
        let mesh = ring("outer", [b - 0.5 * INTERFERENCE, c], [8, 32])?.joined(inner)?;
        let mut surfaces = ["outer.left", "inner.right"];
        if swapped {
            surfaces.reverse();
        }
        let model = Model::new(mesh, PlaneStrain::default())
            .material("inner", Elastic::new(young[0], NU)?, Integration::Reduced)?
            .material("outer", Elastic::new(young[1], NU)?, Integration::Reduced)?
            .contact(surfaces[0], surfaces[1], Coulomb::new(0.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let mut step = Step::new("release");
        for body in ["inner", "outer"] {
            step = step
                .fix(&format!("{body}.bottom"), &[Axis::Y])
                .fix(&format!("{body}.top"), &[Axis::X]);
        }
        driver.run(&step, 1, |_, _| {})?;
        let (force, area) = driver
            .contacts()
            .iter()
            .fold((0.0, 0.0), |(f, s), c| (f + c.t[0], s + c.area));
        close("mean pressure", force / area, exact, 2e-3);
        for c in driver.contacts() {
            close("pressure", c.t[0] / c.area, exact, 1e-2);
        }
    }
    Ok(())
}

/// Pressed, then dragged, by displacements of the upper side in the frame of the stack.
fn grip(driver: &Driver<2>, stack: &Stack, motion: [f64; 2]) -> Fallible<Loading<2>> {
    let mesh = driver.mesh();
    let (top, bottom) = (
        mesh.node_group("upper.top")?,
        mesh.node_group("lower.bottom")?,
    );
    let held: Vec<usize> = top.iter().chain(&bottom).copied().collect();
    let motion = stack.turn(motion);
    let back = Rotation2::new(-stack.angle);
    let field = |x: &[f64; 2]| match (back * Vector2::from(*x))[1] > 0.0 {
        true => motion,
        false => [0.0; 2],
    };
    Ok(prescribed(driver, &Step::new("grip"), &held, field)?)
}

fn gripped() -> Stack {
    Stack {
        lines: [uniform(0.0, 4.0, 6), uniform(-1.1, 5.3, 7)],
        young: [E, E / 4.0],
        friction: 0.2,
        ..Stack::new(CellKind::Quad8, [1, 1])
    }
}

const PATH: [[f64; 2]; 3] = [[0.0, -2e-3], [4e-4, -2.5e-3], [-2e-4, -2e-3]];

fn run(stack: &Stack, path: &[[f64; 2]], settings: Settings<2>) -> Fallible<Driver<2>> {
    let mut driver = stack.driver(stack.mesh()?, settings)?;
    for motion in path {
        let end = grip(&driver, stack, *motion)?;
        driver.advance(&end)?;
    }
    action_is_reaction(&driver, stack)?;
    Ok(driver)
}

fn farthest(a: &Driver<2>, b: &Driver<2>, turn: f64) -> f64 {
    let turn = Rotation2::new(turn);
    let pairs = || a.contacts().iter().zip(b.contacts());
    let most = pairs().map(|(a, _)| a.force.norm()).fold(0.0, f64::max);
    pairs()
        .map(|(a, b)| (turn * a.force - b.force).norm())
        .fold(0.0, f64::max)
        / most
}

#[test]
fn all_methods_find_the_same_forces_between_two_bodies() -> Fallible {
    let stack = gripped();
    let first = run(&stack, &PATH, Settings::default())?;
    let slips = |s: Status| first.contacts().iter().any(|c| c.status == s);
    assert!(slips(Status::Slip) && slips(Status::Stick));
    let others: [Box<dyn ContactSolver<2>>; 3] = [
        Box::new(SemismoothNewton::default()),
        Box::new(GaussSeidel::default()),
        Box::new(Uzawa::default()),
    ];
    for contact in others {
        let name = format!("{contact:?}");
        let settings = Settings {
            contact,
            ..Settings::default()
        };
        let apart = farthest(&first, &run(&stack, &PATH, settings)?, 0.0);
        assert!(apart <= 1e-8, "{name}: {apart:.2e}");
    }
    let nesting = Nesting::Outside {
        tolerance: 1e-6,
        iterations: 20_000,
    };
    let settings = Settings {
        nesting,
        ..Settings::default()
    };
    let path = &PATH[..1];
    let first = run(&stack, path, Settings::default())?;
    let apart = farthest(&first, &run(&stack, path, settings)?, 0.0);
    assert!(apart <= 1e-4, "the paper's nesting: {apart:.2e}");
    Ok(())
}

#[test]
fn two_bodies_turned_feel_turned_forces() -> Fallible {
    let first = run(&gripped(), &PATH, Settings::default())?;
    for angle in [0.7, PI / 2.0, -2.5] {
        let stack = Stack { angle, ..gripped() };
        let apart = farthest(&first, &run(&stack, &PATH, Settings::default())?, angle);
        assert!(apart <= 1e-9, "{angle}: {apart:.2e}");
    }
    Ok(())
}

/// 4.11: which side carries the multipliers matters to the order of the mesh size.
#[test]
fn the_choice_of_the_non_mortar_side_fades_with_refinement() -> Fallible {
    let stored = |swapped: bool, n: usize| -> Fallible<f64> {
        let stack = Stack {
            lines: [uniform(0.0, 4.0, 3 * n), uniform(-1.1, 5.3, 4 * n)],
            swapped,
            ..gripped()
        };
        let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
        let end = grip(&driver, &stack, PATH[0])?;
        driver.advance(&end)?;
        action_is_reaction(&driver, &stack)?;
        Ok(driver.energies().stored)
    };
    let mut apart = Vec::new();
    for n in [1, 2, 4] {
        let (a, b) = (stored(false, n)?, stored(true, n)?);
        apart.push((a / b - 1.0).abs());
    }
    // The corners of the upper body are singular, and lie anywhere in the edges of the lower.
    assert!(apart[0] < 3e-2 && apart[2] < 0.5 * apart[0], "{apart:?}");
    Ok(())
}

/// Work is stored or dissipated, to the order of the increment.
#[test]
fn the_energy_of_two_bodies_is_balanced() -> Fallible {
    let stack = gripped();
    let mut left = Vec::new();
    for steps in [8, 16, 32] {
        let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
        let mut from = [0.0; 2];
        for to in PATH {
            for k in 1..=steps {
                let s = k as f64 / steps as f64;
                let motion = [0, 1].map(|i| from[i] + s * (to[i] - from[i]));
                let end = grip(&driver, &stack, motion)?;
                let report = driver.advance(&end)?;
                assert!(report.relative_gap().abs() < 1e-10);
            }
            from = to;
        }
        let energies = driver.energies();
        assert!(energies.friction_dissipation > 1e-3 * energies.external_work);
        left.push((energies.imbalance() / energies.friction_dissipation).abs());
    }
    assert!(
        left[2] < 0.05 && left[2] < 0.6 * left[1] && left[1] < 0.6 * left[0],
        "{left:?}"
    );
    Ok(())
}

#[test]
fn pairs_that_make_no_sense_are_refused() -> Fallible {
    let law = Coulomb::new(0.1)?;
    let stack = Stack::new(CellKind::Quad4, [2, 3]);
    let model = || -> Fallible<Model<2, PlaneStrain>> {
        Ok(Model::new(stack.mesh()?, PlaneStrain::default()))
    };
    match model()?.contact("upper.bottom", "lower.tip", law).err() {
        Some(ModelError::UnknownOpposite { nearest, .. }) => {
            assert_eq!(nearest.as_deref(), Some("lower.top"));
        }
        other => return Err(format!("{other:?}").into()),
    }
    match model()?.contact("upper.bottom", "upper.left", law).err() {
        Some(ModelError::SharedSurfaceNode { position, .. }) => assert_eq!(position, [0.0, 0.0]),
        other => return Err(format!("{other:?}").into()),
    }
    let lines = uniform(0.0, 1.0, 1);
    let cube = |name: &str| block3(name, CellKind::Hex8, &lines, &lines, &lines);
    let mesh = cube("a")?.joined(cube("b")?)?;
    let error = Model::new(mesh, Solid)
        .contact("a.front", "b.back", law)
        .err();
    assert!(matches!(error, Some(ModelError::SurfacesInSpace { .. })));
    // A body that flew off is not held: without an overlap there is no contact.
    let apart = Stack {
        lines: [uniform(0.0, 1.0, 2), uniform(2.0, 3.0, 2)],
        ..stack
    };
    let mut driver = apart.driver(apart.mesh()?, Settings::default())?;
    let step = Step::new("press")
        .fix("upper.left", &[Axis::X])
        .fix("lower.bottom", &[Axis::X, Axis::Y])
        .pressure("upper.top", PRESSURE);
    let error = driver.run(&step, 1, |_, _| {}).err();
    assert!(error.is_some_and(|e| e.to_string().contains("free to move")));
    Ok(())
}
