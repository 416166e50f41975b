//! A law of friction from outside: a bound that saturates smoothly, checked by the contract and dragged
//! under a block; not a law with a memory or a direction.

use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Elastic, ShearBound, contract};
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

/// g(t_n) = g₀ tanh(μ t_n/g₀): Coulomb's law at small pressures, the shear g₀ at great ones.
#[derive(Debug)]
struct Saturating {
    friction: f64,
    limit: f64,
}

impl ShearBound for Saturating {
    fn bound(&self, t_n: f64) -> f64 {
        self.limit * (self.friction * t_n / self.limit).tanh()
    }

    fn slope(&self, t_n: f64) -> f64 {
        self.friction / (self.friction * t_n / self.limit).cosh().powi(2)
    }
}

/// A flat pad of 10 mm, pressed on a floor that moves until all of it slides: the shear of every node
/// is that of its pressure; the mean of all \[MPa\].
fn rubbed(law: &'static Saturating, pressure: f64) -> Fallible<f64> {
    let mesh = block2(
        "pad",
        CellKind::Quad8,
        &uniform(0.0, 10.0, 10),
        &[0.0, 0.05],
    )?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material("pad", Elastic::new(1e3, 0.0)?, Integration::Reduced)?
        .tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
        .contact("pad.bottom", "floor", law)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let press = Step::new("press").fix("pad.top", &[Axis::X]).displace(
        "pad.top",
        Axis::Y,
        -0.05 * pressure / 1e3,
    );
    driver.run(&press, 1, |_, _| {})?;
    let reports = driver.run(&press.tool("floor", [1.0, 0.0]), 1, |_, _| {})?;
    assert!(
        reports
            .iter()
            .all(|r| r.stick == 0 && r.relative_gap() < 1e-10)
    );
    for c in driver.contacts() {
        let shear = c.area * law.bound(c.t[0] / c.area);
        assert!(
            (c.t[1].abs() / shear - 1.0).abs() < 1e-9,
            "{} {shear}",
            c.t[1]
        );
    }
    Ok(driver.tool_force("floor")?[0].abs() / 10.0)
}

pub(crate) fn main() -> Fallible<()> {
    static LAW: Saturating = Saturating {
        friction: 0.2,
        limit: 50.0,
    };
    contract::friction::<2>(&LAW)?;
    contract::friction::<3>(&LAW)?;
    for pressure in [1.0, 100.0, 250.0, 400.0] {
        let (found, expected) = (rubbed(&LAW, pressure)?, LAW.bound(pressure));
        assert!(
            (found / expected - 1.0).abs() < 0.01,
            "{pressure}: {found} {expected}"
        );
    }
    Ok(())
}
