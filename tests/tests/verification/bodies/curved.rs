//! Two bodies that touch along curved surfaces, against closed formulas: Hertz' line and point
//! contact, rings shrunk on each other.

use super::*;
use moreau::laws::Status;
use moreau::mesh::{NodeKind, Solid, block3};
use std::f64::consts::FRAC_PI_2;
use verification::problems::shapes::graded;

/// Of the lower of two bodies in Hertz' contact; the upper is three times as stiff.
const YOUNG: [f64; 2] = [E, E / 3.0];

fn e_star() -> f64 {
    1.0 / YOUNG.iter().map(|e| (1.0 - NU * NU) / e).sum::<f64>()
}

/// Lines from 0, n for every mm up to `inner`, then growing by a ratio to `size`.
fn lines(n: usize, inner: f64, (ratio, size): (f64, f64)) -> Vec<f64> {
    let cells = (inner * n as f64).ceil() as usize;
    let h = inner / cells as f64;
    let mut lines = uniform(0.0, inner, cells);
    lines.extend_from_slice(&graded(inner, size, h, ratio)[1..]);
    lines
}

fn downwards(lines: &[f64]) -> Vec<f64> {
    lines.iter().rev().map(|y| -y).collect()
}

/// Two bodies as they are before they touch in the origin, with zones within 1.5 mm of it.
fn facing<H: Blocks<D>, const D: usize>(
    [upper, lower]: [Mesh<D>; 2],
    swapped: bool,
) -> Fallible<(Driver<D>, [&'static str; 2])> {
    let kinds = [upper.kind(0), lower.kind(0)];
    let mut mesh = upper.joined(lower)?;
    for (zone, surface) in [("upper zone", "upper.bottom"), ("lower zone", "lower.top")] {
        let far = |x: &[f64; D]| if D == 3 { x[0].max(x[2]) } else { x[0] };
        mesh.facet_group_where(zone, surface, |x| far(x) <= 1.5)?;
    }
    let mut zones = ["upper zone", "lower zone"];
    if swapped {
        zones.reverse();
    }
    let model = Model::new(mesh, H::default())
        .material("upper", Elastic::new(YOUNG[0], NU)?, kinds[0].integration())?
        .material("lower", Elastic::new(YOUNG[1], NU)?, kinds[1].integration())?
        .contact(zones[0], zones[1], Coulomb::new(0.0)?)?;
    Ok((Driver::new(model, Settings::default())?, zones))
}

/// 7.1: two elastic bodies of unlike stiffness and mesh.
#[test]
fn hertz_line_contact_of_two_elastic_bodies() -> Fallible {
    const RADIUS: f64 = 1000.0;
    for swapped in [false, true] {
        let body = |name: &str, n: usize, y: fn(&[f64]) -> Vec<f64>| {
            let grows = (1.4, 30.0);
            let (x, y) = (lines(n, 1.4, grows), y(&lines(n, 0.7, grows)));
            block2(name, CellKind::Quad8, &x, &y)
        };
        let upper = body("upper", 8, <[f64]>::to_vec)?;
        let upper = upper.map(|[x, y]| [x, y + x * x / (2.0 * RADIUS)])?;
        let bodies = [upper, body("lower", 6, downwards)?];
        let (mut driver, _) = facing::<PlaneStrain, 2>(bodies, swapped)?;
        // The travel that makes the half width about 1 mm.
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
        let a = (4.0 * load * RADIUS / (PI * e_star())).sqrt();
        let p0 = 2.0 * load / (PI * a);
        assert!(a > 0.8 && a < 1.2, "{a}");
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
        assert!((edge - a).abs() <= 1.0 / 6.0, "edge at {edge}, not {a}");
    }
    Ok(())
}

/// 7.4: a ball and a half-space, both elastic and of unlike stiffness and mesh.
#[test]
fn hertz_point_contact_of_two_elastic_bodies() -> Fallible {
    const RADIUS: f64 = 500.0;
    for swapped in [false, true] {
        let body = |name: &str, n: usize, y: fn(&[f64]) -> Vec<f64>| {
            let grows = (1.7, 12.0);
            let (x, y) = (lines(n, 1.2, grows), y(&lines(n, 0.5, grows)));
            block3(name, CellKind::Hex8, &x, &y, &x)
        };
        let upper = body("upper", 6, <[f64]>::to_vec)?;
        let upper = upper.map(|[x, y, z]| [x, y + (x * x + z * z) / (2.0 * RADIUS), z])?;
        let bodies = [upper, body("lower", 5, downwards)?];
        let (mut driver, zones) = facing::<Solid, 3>(bodies, swapped)?;
        let mut step = Step::new("press").fix("lower.bottom", &[Axis::Y]).displace(
            "upper.top",
            Axis::Y,
            -2.1e-3,
        );
        for body in ["upper", "lower"] {
            step = step
                .fix(&format!("{body}.left"), &[Axis::X])
                .fix(&format!("{body}.back"), &[Axis::Z]);
        }
        driver.run(&step, 1, |_, _| {})?;
        action_is_reaction(&driver, zones)?;
        let quarter = driver.contact_force("upper zone")?[1];
        let load = 4.0 * quarter;
        let a = (3.0 * load * RADIUS / (4.0 * e_star())).cbrt();
        let p0 = 3.0 * load / (2.0 * PI * a * a);
        assert!(a > 0.8 && a < 1.2, "{a}");
        let (mut sum, mut count, mut centre) = (0.0, 0.0, 0.0);
        for c in driver.contacts() {
            let r = c.position[0].hypot(c.position[2]);
            if r < 0.8 * a {
                let exact = p0 * (1.0 - (r / a).powi(2)).sqrt();
                let p = c.t[0] / c.area;
                sum += ((p - exact) / p0).powi(2);
                count += 1.0;
                if r == 0.0 {
                    centre = p;
                }
            }
        }
        let what = format!("swapped {swapped}");
        close(&format!("pressure in the middle, {what}"), centre, p0, 3e-2);
        let off = f64::sqrt(sum / count);
        assert!(off <= 3e-2, "{what}: pressure off by {off:.2e}");
    }
    Ok(())
}

/// 5.6 and 4.10: two rings of unlike stiffness and mesh, one shrunk on the other; in space slices of
/// them between two smooth planes, which do not match along their axis either.
#[test]
fn a_ring_shrunk_on_another_is_pressed_evenly() -> Fallible {
    const RADII: [f64; 3] = [10.0, 20.0, 35.0];
    // Small against the radii, and large against the 1e-6 mm by which quadratic edges miss a circle:
    // these are felt as a ripple.
    const INTERFERENCE: f64 = 2e-2;
    fn check<H: Blocks<D>, const D: usize>(
        kinds: [CellKind; 2],
        cells: [[usize; D]; 2],
    ) -> Fallible {
        let [a, b, c] = RADII;
        let radii = [[b - 0.5 * INTERFERENCE, c], [a, b + 0.5 * INTERFERENCE]];
        let names = ["outer", "inner"];
        let young = [70e3, E];
        let ring = |k: usize| -> Fallible<Mesh<D>> {
            let lines = from_fn(|axis| match axis {
                0 => uniform(radii[k][0], radii[k][1], cells[k][0]),
                1 => uniform(0.0, FRAC_PI_2, cells[k][1]),
                _ => uniform(0.0, 2.0, cells[k][2]),
            });
            Ok(H::block(names[k], kinds[k], &lines)?.map(|mut x| {
                let (r, t) = (x[0], x[1]);
                // On the axis exactly.
                (x[0], x[1]) = match t == FRAC_PI_2 {
                    true => (0.0, r),
                    false => (r * t.cos(), r * t.sin()),
                };
                x
            })?)
        };
        let plane = |e: f64| (e / (1.0 - NU * NU), NU / (1.0 - NU));
        let ((e_o, nu_o), (e_i, nu_i)) = (plane(young[0]), plane(young[1]));
        let ratio = |p: f64, q: f64| (p * p + q * q) / (p * p - q * q);
        let exact = INTERFERENCE / (b * ((ratio(c, b) + nu_o) / e_o + (ratio(b, a) - nu_i) / e_i));
        for swapped in [false, true] {
            let mut surfaces = ["outer.left", "inner.right"];
            if swapped {
                surfaces.reverse();
            }
            let mut model = Model::new(ring(0)?.joined(ring(1)?)?, H::default());
            for k in [0, 1] {
                let law = Elastic::new(young[k], NU)?;
                model = model.material(names[k], law, kinds[k].integration())?;
            }
            let model = model.contact(surfaces[0], surfaces[1], Coulomb::new(0.0)?)?;
            let mut driver = Driver::new(model, Settings::default())?;
            let mut step = Step::new("release");
            for body in names {
                step = step
                    .fix(&format!("{body}.bottom"), &[Axis::Y])
                    .fix(&format!("{body}.top"), &[Axis::X]);
                if D == 3 {
                    step = step
                        .fix(&format!("{body}.back"), &[Axis::Z])
                        .fix(&format!("{body}.front"), &[Axis::Z]);
                }
            }
            driver.run(&step, 1, |_, _| {})?;
            let (force, area) = driver
                .contacts()
                .iter()
                .fold((0.0, 0.0), |(f, s), c| (f + c.t[0], s + c.area));
            let what = format!("{kinds:?} swapped {swapped}");
            close(&format!("mean pressure, {what}"), force / area, exact, 2e-3);
            for c in driver.contacts() {
                close(&format!("pressure, {what}"), c.t[0] / c.area, exact, 1e-2);
            }
        }
        Ok(())
    }
    use CellKind::{Hex20, Hex27, Quad8};
    check::<PlaneStrain, 2>([Quad8; 2], [[8, 32], [8, 23]])?;
    check::<Solid, 3>([Hex20; 2], [[4, 32, 2], [4, 23, 1]])?;
    check::<Solid, 3>([Hex27; 2], [[3, 32, 1], [3, 23, 2]])?;
    check::<Solid, 3>([Hex20, Hex27], [[4, 32, 1], [3, 23, 1]])
}
