//! Two bodies against closed formulas: an incline, Hertz' line contact, a shrink fit.

use super::*;
use moreau::laws::Status;
use moreau::mesh::NodeKind;
use std::f64::consts::FRAC_PI_2;
use verification::problems::shapes::graded;

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
            action_is_reaction(&driver, stack.surfaces())?;
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
