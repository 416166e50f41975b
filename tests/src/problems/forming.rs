//! Forming between rigid tools: rolling and drawing of a strip, a ball pressed into a plate; not the theories that
//! they are compared with but for that of slabs.

pub mod slab;

use super::Fallible;
use moreau::contact::{Ball, Polyline};
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Isotropic, VonMises};
use moreau::mesh::{Axisymmetric, CellKind, Integration, PlaneStrain, block2, uniform};

/// A strip that is rolled from one thickness to another by rolls of a radius \[mm\] with friction, of a yield stress and
/// a modulus of hardening \[MPa\].
#[derive(Debug, Clone, Copy)]
pub struct Pass {
    /// Before and after.
    pub thickness: [f64; 2],
    /// Of the rolls.
    pub radius: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
    /// Of the strip.
    pub yield_stress: f64,
    /// Of the strip, linear.
    pub hardening: f64,
}

/// The pass of the example `strip-rolled`.
pub const PASS: Pass = Pass {
    thickness: [2.0, 1.6],
    radius: 60.0,
    friction: 0.15,
    yield_stress: 100.0,
    hardening: 100.0,
};

impl Pass {
    /// Half of the strip, 40 mm long, under its roll, with cells of 0.4 mm.
    ///
    /// # Errors
    /// None for numbers in their ranges.
    pub fn driver(&self, young: f64) -> Fallible<Driver<2>> {
        let half = 0.5 * self.thickness[0];
        let (x, y) = (uniform(0.0, 40.0, 100), uniform(0.0, half, 3));
        let mesh = block2("strip", CellKind::Quad8, &x, &y)?;
        let law = VonMises::new(young, 0.33, self.yield_stress)?.with_isotropic(self.hardening)?;
        let roll = Ball::new([32.0, half + self.radius], self.radius)?;
        let model = Model::with_large_strains(mesh, PlaneStrain::default())
            .material("strip", law, Integration::Reduced)?
            .tool("roll", roll)?
            .contact("strip.top", "roll", Coulomb::new(self.friction)?)?;
        Ok(Driver::new(model, Settings::default())?)
    }

    /// The roll comes down to the thickness after.
    pub fn bite(&self) -> Step<2> {
        let down = 0.5 * (self.thickness[0] - self.thickness[1]);
        Step::new("bite")
            .fix("strip.bottom", &[Axis::Y])
            .tool("roll", [0.0, -down])
    }

    /// And turns by an angle \[rad\].
    pub fn roll(&self, angle: f64) -> Step<2> {
        self.bite().turn("roll", [0.0, 0.0, 1.0], angle)
    }
}

/// Half of a strip of perfectly plastic metal, 24 mm × 2 mm of yield stress 100 MPa, in a die without friction that takes
/// a part r = 2 sin α / (1 + 2 sin α) of its thickness, where the lines of slip are known.
///
/// # Errors
/// None for an angle between 0 and a right one.
pub fn drawn(angle: f64) -> Fallible<Driver<2>> {
    let mesh = block2(
        "strip",
        CellKind::Quad8,
        &uniform(0.0, 24.0, 72),
        &uniform(0.0, 2.0, 6),
    )?;
    let law = VonMises::new(200e3, 0.3, 100.0)?;
    // Out of the die, its land, and the cone.
    let line = [
        [24.0, 4.0],
        [20.0, 2.0],
        [19.2, 2.0],
        [19.2 - 10.0 * angle.cos(), 2.0 + 10.0 * angle.sin()],
    ];
    let model = Model::with_large_strains(mesh, PlaneStrain::default())
        .material("strip", law, Integration::Reduced)?
        .tool("die", Polyline::rounded(&line, &[0.2, 0.2])?)?
        .contact("strip.top", "die", Coulomb::new(0.0)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Brinell's ball of 10 mm over a thick plate of steel that hardens as [`hardened`] says, with cells of 0.05 mm.
///
/// # Errors
/// None.
pub fn ball_on_plate() -> Fallible<Driver<2>> {
    let mut x = uniform(0.0, 2.0, 40);
    x.extend([
        2.1, 2.25, 2.5, 2.9, 3.5, 4.5, 6.0, 8.0, 11.0, 15.0, 20.0, 28.0, 40.0,
    ]);
    let mut y: Vec<f64> = [
        40.0, 28.0, 20.0, 15.0, 11.0, 8.0, 6.0, 4.5, 3.5, 2.8, 2.3, 1.9, 1.6, 1.35, 1.15, 1.0, 0.9,
        0.8, 0.7, 0.6, 0.5,
    ]
    .map(|y: f64| -y)
    .to_vec();
    y.extend(uniform(-0.4, 0.0, 8));
    let mesh = block2("plate", CellKind::Quad4, &x, &y)?;
    let law =
        VonMises::new(210e3, 0.3, 300.0)?.with_hardening(Isotropic::swift(900.0, 0.00412, 0.2)?);
    let model = Model::with_large_strains(mesh, Axisymmetric)
        .material("plate", law, Integration::BBar)?
        .tool("ball", Ball::new([0.0, 5.0], 5.0)?)?
        .contact("plate.top", "ball", Coulomb::new(0.2)?)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// Yield stress of the plate under the ball at a plastic strain \[MPa\].
pub fn hardened(strain: f64) -> f64 {
    900.0 * (0.00412 + strain).powf(0.2)
}
