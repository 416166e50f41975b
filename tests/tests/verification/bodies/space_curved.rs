//! Two bodies in space that touch along curved surfaces: Hertz' point contact.

use super::*;
use moreau::mesh::{Solid, block3};
use verification::problems::shapes::graded;

/// 7.4: a ball and a half-space, both elastic and of unlike stiffness and mesh.
#[test]
fn hertz_point_contact_of_two_elastic_bodies() -> Fallible {
    const A: f64 = 1.0;
    const RADIUS: f64 = 500.0;
    const SIZE: f64 = 12.0;
    let young = [E, E / 3.0];
    let e_star = 1.0 / young.iter().map(|e| (1.0 - NU * NU) / e).sum::<f64>();
    let lines = |n: usize, inner: f64| {
        let cells = (inner * n as f64).ceil() as usize;
        let h = inner / cells as f64;
        let mut lines = uniform(0.0, inner, cells);
        lines.extend_from_slice(&graded(inner, SIZE, h, 1.7)[1..]);
        lines
    };
    let body = |name: &str, n: usize, up: bool| -> Fallible<Mesh<3>> {
        let mut y = lines(n, 0.5);
        if !up {
            y = y.iter().rev().map(|y| -y).collect();
        }
        let plane = lines(n, 1.2);
        Ok(block3(name, CellKind::Hex8, &plane, &y, &plane)?)
    };
    for swapped in [false, true] {
        let upper = body("upper", 6, true)?;
        let upper = upper.map(|[x, y, z]| [x, y + (x * x + z * z) / (2.0 * RADIUS), z])?;
        let mut mesh = upper.joined(body("lower", 5, false)?)?;
        for (zone, surface) in [("upper zone", "upper.bottom"), ("lower zone", "lower.top")] {
            mesh.facet_group_where(zone, surface, |x| x[0].max(x[2]) <= 1.5 * A)?;
        }
        let mut zones = ["upper zone", "lower zone"];
        if swapped {
            zones.reverse();
        }
        let model = Model::new(mesh, Solid)
            .material("upper", Elastic::new(young[0], NU)?, Integration::Full)?
            .material("lower", Elastic::new(young[1], NU)?, Integration::Full)?
            .contact(zones[0], zones[1], Coulomb::new(0.0)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
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
        let a = (3.0 * load * RADIUS / (4.0 * e_star)).cbrt();
        let p0 = 3.0 * load / (2.0 * PI * a * a);
        assert!(a > 0.8 * A && a < 1.2 * A, "{a}");
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
