//! Contact of two bodies under large strains: weights, normals and slips of the end of the increment.

use moreau_contact::Plane;
use moreau_driver::{Axis, Driver, Model, Settings, Step};
use moreau_laws::{Coulomb, Isotropic, VonMises};
use moreau_mesh::{CellKind, PlaneStrain, block2, uniform};

fn steel() -> VonMises {
    let hardening = Isotropic::linear(500.0).expect("valid");
    VonMises::new(210e3, 0.3, 300.0)
        .expect("valid")
        .with_hardening(hardening)
}

fn stack(kinds: [CellKind; 2], cells: [usize; 2], mu: f64) -> Driver<2> {
    let (lower, upper) = (
        uniform(-10.0, 10.0, cells[0]),
        uniform(-10.0, 10.0, cells[1]),
    );
    let mut mesh = block2("lower", kinds[0], &lower, &uniform(-10.0, 2.0, 6))
        .and_then(|m| m.joined(block2("upper", kinds[1], &upper, &uniform(2.0, 10.0, 3))?))
        .expect("valid");
    mesh.node_group_where("pin", "lower", |x| x[0].hypot(x[1]) < 1e-9)
        .expect("there");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("lower", steel(), kinds[0].integration())
        .expect("valid")
        .material("upper", steel(), kinds[1].integration())
        .expect("valid")
        .tool("top", Plane::new([0.0, 10.0], [0.0, -1.0]).expect(""))
        .expect("valid")
        .reference([0.0, 0.0])
        .expect("valid")
        .contact("upper.top", "top", Coulomb::new(0.0).expect(""))
        .expect("valid")
        .tool("bottom", Plane::new([0.0, -10.0], [0.0, 1.0]).expect(""))
        .expect("valid")
        .reference([0.0, 0.0])
        .expect("valid")
        .contact("lower.bottom", "bottom", Coulomb::new(0.0).expect(""))
        .expect("valid")
        .contact("upper.bottom", "lower.top", Coulomb::new(mu).expect(""))
        .expect("valid");
    Driver::new(model, Settings::default()).expect("valid")
}

#[test]
fn what_is_turned() {
    let mut driver = stack([CellKind::Quad8; 2], [6, 5], 0.3);
    let n = 10;
    let step = |angle: f64, closed: f64| {
        let (s, c) = angle.sin_cos();
        let axis = [0.0, 0.0, 1.0];
        Step::new("squeeze")
            .fix("pin", &[Axis::X, Axis::Y])
            .tool("top", [s * closed, -c * closed])
            .turn("top", axis, angle)
            .tool("bottom", [-s * closed, c * closed])
            .turn("bottom", axis, angle)
    };
    let show = |driver: &Driver<2>, r: &moreau_driver::IncrementReport, angle: f64| {
        let rot = nalgebra::Rotation2::new(angle);
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for c in driver.contacts().iter().filter(|c| c.contact == 2) {
            low = low.min(c.t[0] / c.area);
            high = high.max(c.t[0] / c.area);
        }
        let p = driver.points();
        let _ = rot;
        println!(
            "{angle:.3} newton {} res {:?} cuts {} p {low:.10} {high:.10} {} {} {}",
            r.newton_iterations, r.residuals, r.cuts, r.open, r.stick, r.slip
        );
        let _ = p;
    };
    for k in 1..=5 {
        driver
            .run(&step(0.0, 2.0 * k as f64 / 5.0), 1, |d, r| show(d, r, 0.0))
            .expect("runs");
    }
    for k in 1..=n {
        let a = std::f64::consts::FRAC_PI_2 * k as f64 / n as f64;
        driver
            .run(&step(a, 2.0), 1, |d, r| show(d, r, a))
            .expect("runs");
    }
}

fn dragged(mu: f64, kinds: [CellKind; 2], young: [f64; 2]) -> Driver<2> {
    let mesh = block2(
        "base",
        kinds[0],
        &uniform(-5.0, 50.0, 44),
        &uniform(-5.0, 0.0, 4),
    )
    .and_then(|m| {
        m.joined(block2(
            "slider",
            kinds[1],
            &uniform(0.0, 8.0, 9),
            &uniform(0.0, 4.0, 4),
        )?)
    })
    .expect("valid");
    let law = |e: f64| VonMises::new(e, 0.3, 1e6).expect("valid");
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("base", law(young[0]), kinds[0].integration())
        .expect("valid")
        .material("slider", law(young[1]), kinds[1].integration())
        .expect("valid")
        .contact("slider.bottom", "base.top", Coulomb::new(mu).expect(""))
        .expect("valid");
    Driver::new(model, Settings::default()).expect("valid")
}

#[test]
fn what_is_dragged() {
    let mut driver = dragged(0.3, [CellKind::Quad8; 2], [10e3, 10e3]);
    let step = |x: f64, y: f64| {
        Step::new("drag")
            .fix("base.bottom", &[Axis::X, Axis::Y])
            .displace("slider.top", Axis::X, x)
            .displace("slider.top", Axis::Y, y)
    };
    let show = |driver: &Driver<2>, r: &moreau_driver::IncrementReport| {
        let own = driver.contact_force("slider.bottom").expect("a group");
        let other = driver.contact_force("base.top").expect("a group");
        let moment = |g: &str| -> f64 {
            let nodes: Vec<usize> = driver.mesh().node_group(g).unwrap();
            nodes
                .iter()
                .map(|&a| {
                    let x = nalgebra::SVector::<f64, 2>::from(driver.mesh().nodes()[a])
                        + driver.displacement(a);
                    let f = driver.nodal_contact_force(a);
                    x[0] * f[1] - x[1] * f[0]
                })
                .sum()
        };
        let (m1, m2) = (moment("slider.bottom"), moment("base.top"));
        let mut pen = 0.0f64;
        for c in driver.contacts() {
            pen = pen.min(c.u[0]);
        }
        println!(
            "newton {} res {:.1e} {:?} cuts {} F {:.8} {:.8} ratio {:.3e} sum {:.1e} M {m1:.6} {:.1e} | {} {} {} pen {pen:.1e} en {:.3e}",
            r.newton_iterations,
            r.out_of_balance,
            r.residuals
                .iter()
                .map(|x| format!("{x:.0e}"))
                .collect::<Vec<_>>(),
            r.cuts,
            own[0],
            own[1],
            own[0] / own[1] + 0.3,
            (own + other).norm(),
            m1 + m2,
            r.open,
            r.stick,
            r.slip,
            r.energies.imbalance() / r.energies.external_work.abs()
        );
    };
    driver
        .run(&step(0.0, -0.2), 2, |d, r| show(d, r))
        .expect("runs");
    driver
        .run(&step(24.0, -0.2), 48, |d, r| show(d, r))
        .expect("runs");
}
