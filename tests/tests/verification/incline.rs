//! A block pushed up an incline by a horizontal force: the force at which it slides follows from
//! statics alone, whatever the block is made of; not a rigid body.
//!
//! Source: Q. Feng and N. K. Prinja, *NAFEMS Benchmark Tests for Finite Element Modelling of
//! Contact, Gapping and Sliding*, report R0081 (2001), CGS-4.

use crate::close;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic};
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};
use nalgebra::{Rotation2, Vector2};
use verification::problems::Fallible;

#[test]
fn nafems_block_slides_up_its_incline() -> Fallible {
    const SLOPE: f64 = 0.1;
    let turn = Rotation2::new(SLOPE.atan());
    let weight = 12.0;
    for (mu, expected) in [
        (0.0, 0.1),
        (0.1, 0.2020202),
        (0.2, 0.3061224),
        (0.3, 0.4123711),
    ] {
        let exact = (SLOPE + mu) / (1.0 - mu * SLOPE);
        close("formula", exact, expected, 1e-6);
        let mut mesh = block2(
            "block",
            CellKind::Quad8,
            &uniform(0.0, 4.0, 8),
            &uniform(0.0, 1.0, 3),
        )?;
        // Not where it touches: what is prescribed there would not slide freely.
        mesh.node_group_where("pushed", "block.left", |x| x[1] > 0.0)?;
        let mesh = mesh.map(|x| (turn * Vector2::from(x)).into())?;
        let model = Model::new(mesh, PlaneStrain::default())
            .material("block", Elastic::new(1e3, 0.3)?, Integration::Reduced)?
            .tool(
                "incline",
                Plane::new([0.0, 0.0], (turn * Vector2::y()).into())?,
            )?
            .contact("block.bottom", "incline", Coulomb::new(mu)?)?;
        let mut driver = Driver::new(model, Settings::default())?;
        let rest = Step::new("rest")
            .fix("pushed", &[Axis::X])
            .body_force("block", [0.0, -weight / 4.0]);
        driver.run(&rest, 1, |_, _| {})?;
        // Pushed until all points slide.
        let push = Step::new("push")
            .displace("pushed", Axis::X, 0.5)
            .body_force("block", [0.0, -weight / 4.0]);
        let reports = driver.run(&push, 5, |_, _| {})?;
        assert_eq!((reports[4].stick, reports[4].open), (0, 0), "all slide");
        let reaction = driver.reaction("pushed")?;
        close(&format!("mu = {mu}"), reaction[0] / weight, exact, 1e-9);
    }
    Ok(())
}
