//! Bodies whose limit load is known, with their supports; not how they are loaded.

use super::Fallible;
use super::limit::{final_slope, load_curve};
use super::shapes::{Hole, holed_plate, notched_plate, quarter_ring};
use moreau::driver::{Analysis, Axis, Driver, Model, Settings, Step};
use moreau::laws::{BulkLaw, VonMises};
use moreau::mesh::{Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, block2, uniform};
use std::f64::consts::{PI, TAU};

fn driver(
    mesh: Mesh<2>,
    hypothesis: impl Analysis<2>,
    law: impl BulkLaw,
    rule: Integration,
) -> Fallible<Driver<2>> {
    let model = Model::new(mesh, hypothesis).material("body", law, rule)?;
    Ok(Driver::new(model, Settings::default())?)
}

/// A quarter of a strip with a central hole of half its width in plane strain tension.
pub mod strip {
    use super::*;

    /// Width \[mm\].
    pub const WIDTH: f64 = 10.0;
    /// Young's modulus \[MPa\].
    pub const E: f64 = 210e3;
    /// Yield stress \[MPa\].
    pub const YIELD: f64 = 300.0;
    /// Remote stress at collapse over the yield stress: (1 − ½) 2/√3.
    pub const EXACT: f64 = 0.577_350_269_189_625_8;

    /// The strip, n cells from the hole to the edge.
    ///
    /// # Errors
    /// A rule that the cells do not have.
    pub fn body(
        hole: Hole,
        length: f64,
        kind: CellKind,
        rule: Integration,
        n: usize,
    ) -> Fallible<Driver<2>> {
        let mesh = holed_plate(kind, hole, (WIDTH, length, 0.5 * WIDTH), n)?;
        driver(
            mesh,
            PlaneStrain::default(),
            VonMises::new(E, 0.3, YIELD)?,
            rule,
        )
    }

    /// Held on its lines of symmetry.
    pub fn held(name: &str) -> Step<2> {
        Step::new(name)
            .fix("body.top", &[Axis::X])
            .fix("body.bottom", &[Axis::Y])
    }
}

/// A quarter of a plate with deep notches from both edges in plane strain tension.
pub mod notch {
    use super::*;

    /// Yield stress \[MPa\].
    pub const YIELD: f64 = 0.45;

    /// The plate, n cells in half of its ligament.
    ///
    /// # Errors
    /// A rule that the cells do not have.
    pub fn body(kind: CellKind, rule: Integration, n: usize) -> Fallible<Driver<2>> {
        let law = VonMises::new(206.9, 0.29, YIELD)?;
        driver(notched_plate(kind, n)?, PlaneStrain::default(), law, rule)
    }

    /// Held on its lines of symmetry.
    pub fn held(name: &str) -> Step<2> {
        Step::new(name)
            .fix("body.left", &[Axis::X])
            .fix("ligament", &[Axis::Y])
    }

    /// The load at collapse, (2 + π) k over half a ligament \[N/mm\].
    pub fn exact() -> f64 {
        (2.0 + PI) * YIELD / 3f64.sqrt() * 0.5
    }

    /// Net stress over the exact one, (2 + π) k, and the final slope, after 0.3 mm in 60 increments.
    ///
    /// # Errors
    /// Those of the increments.
    pub fn net_stress(kind: CellKind, rule: Integration, n: usize) -> Fallible<(f64, f64)> {
        let mut driver = body(kind, rule, n)?;
        let step = held("pull").displace("body.top", Axis::Y, 0.3);
        let curve = load_curve(&mut driver, &step, 60, |driver| {
            driver.reaction("body.top").map_or(f64::NAN, |f| f[1])
        })?;
        Ok((curve[59] / exact(), final_slope(&curve)))
    }
}

/// A thick cylinder in plane strain under internal pressure, b = 2a.
pub mod cylinder {
    use super::*;

    /// Inner radius \[mm\].
    pub const A: f64 = 100.0;
    /// Outer radius \[mm\].
    pub const B: f64 = 200.0;
    /// Height of the slice \[mm\].
    pub const HEIGHT: f64 = 10.0;
    /// Young's modulus \[MPa\].
    pub const E: f64 = 210e3;
    /// Yield stress \[MPa\].
    pub const YIELD: f64 = 240.0;

    /// Hill's limit pressure, 2/√3 σ_y ln(b/a) \[MPa\], exact for any ν.
    pub fn limit() -> f64 {
        2.0 * YIELD / 3f64.sqrt() * (B / A).ln()
    }

    /// A slice, n cells through the wall.
    ///
    /// # Errors
    /// A rule that the cells do not have; ν beyond its range.
    pub fn body(kind: CellKind, rule: Integration, n: usize, nu: f64) -> Fallible<Driver<2>> {
        let mesh = block2("body", kind, &uniform(A, B, n), &uniform(0.0, HEIGHT, 1))?;
        driver(mesh, Axisymmetric, VonMises::new(E, nu, YIELD)?, rule)
    }

    /// In plane strain.
    pub fn held(name: &str) -> Step<2> {
        Step::new(name).fix("body", &[Axis::Y])
    }

    /// Pressure over the limit pressure and the final slope, after the bore has moved outwards by
    /// 2 mm in 30 increments.
    ///
    /// # Errors
    /// Those of the increments.
    pub fn collapse(kind: CellKind, rule: Integration, n: usize) -> Fallible<(f64, f64)> {
        let mut driver = body(kind, rule, n, 0.3)?;
        let step = held("grow").displace("body.left", Axis::X, 2.0);
        let curve = load_curve(&mut driver, &step, 30, |driver| {
            driver.reaction("body.left").map_or(f64::NAN, |f| f[0]) / (TAU * A * HEIGHT)
        })?;
        Ok((curve[29] / limit(), final_slope(&curve)))
    }
}

/// A quarter of the section of a hollow sphere under internal pressure, b = 2a.
pub mod sphere {
    use super::*;

    /// Inner radius \[mm\].
    pub const A: f64 = 100.0;
    /// Outer radius \[mm\].
    pub const B: f64 = 200.0;
    /// Young's modulus \[MPa\].
    pub const E: f64 = 210e3;
    /// Poisson's ratio.
    pub const NU: f64 = 0.3;
    /// Yield stress \[MPa\].
    pub const YIELD: f64 = 240.0;

    /// The limit pressure, 2 σ_y ln(b/a) \[MPa\].
    pub fn limit() -> f64 {
        2.0 * YIELD * (B / A).ln()
    }

    /// The sphere of a law, 12 × 6 cells.
    ///
    /// # Errors
    /// None.
    pub fn body(law: impl BulkLaw) -> Fallible<Driver<2>> {
        let mesh = quarter_ring(CellKind::Quad8, (A, B), (12, 6))?;
        driver(mesh, Axisymmetric, law, Integration::Reduced)
    }

    /// Held on its axis and its plane of symmetry.
    pub fn held(name: &str) -> Step<2> {
        Step::new(name)
            .fix("body.bottom", &[Axis::Y])
            .fix("body.top", &[Axis::X])
    }
}
