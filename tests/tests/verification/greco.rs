//! The block of the GRECO group: what neither cells nor steps may change; its published values are a
//! case of the report.

use crate::close;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{CellKind, Integration, PlaneStrain, Solid, block2, block3, uniform};
use verification::problems::Fallible;
use verification::problems::greco::{block, slip, squeeze};

#[test]
fn linear_quadrilaterals_give_the_same_block() -> Fallible {
    let mut driver = block(CellKind::Quad4, 32, Settings::default())?;
    driver.run(&squeeze(), 1, |_, _| {})?;
    for (x, u) in [
        (0.0, 28.594),
        (1.25, 27.217),
        (5.0, 22.850),
        (7.5, 19.796),
        (11.25, 15.406),
    ] {
        close(&format!("u_x({x})"), slip(&driver, x), u, 1e-4);
    }
    Ok(())
}

/// A proportional load: the answer does not depend on the number of steps.
#[test]
fn raous_chabrand_lebon_block_does_not_depend_on_the_steps() -> Fallible {
    let mut one = block(CellKind::Quad8, 16, Settings::default())?;
    one.run(&squeeze(), 1, |_, _| {})?;
    for steps in [5, 20] {
        let mut many = block(CellKind::Quad8, 16, Settings::default())?;
        many.run(&squeeze(), steps, |_, _| {})?;
        for (a, b) in one.contacts().iter().zip(many.contacts()) {
            assert_eq!(a.status, b.status, "{steps} steps, x = {}", a.position[0]);
            assert!((a.t - b.t).norm() < 1e-7 * 150.0, "{} {}", a.t, b.t);
            let (u, v) = (one.displacement(a.node), many.displacement(a.node));
            assert!((u - v).norm() < 1e-7 * 28.6e-3, "{u} {v}");
        }
    }
    Ok(())
}

/// The block as one layer of n × n solid cells, 2 mm thick and held across.
fn slab(kind: CellKind, n: usize) -> Fallible<Driver<3>> {
    let lines = uniform(0.0, 40.0, n);
    let mesh = block3("block", kind, &lines, &lines, &[0.0, 2.0])?;
    let model = Model::new(mesh, Solid)
        .material("block", Elastic::new(130e3, 0.2)?, kind.integration())?
        .tool("floor", Plane::new([0.0; 3], [0.0, 1.0, 0.0])?)?
        .contact("block.bottom", "floor", Coulomb::new(1.0)?)?;
    let mut driver = Driver::new(model, Settings::default())?;
    let step = Step::new("squeeze")
        .fix("block", &[Axis::Z])
        .fix("block.right", &[Axis::X])
        .pressure("block.top", 50.0)
        .pressure("block.left", 150.0);
    driver.run(&step, 1, |_, _| {})?;
    Ok(driver)
}

/// Fields of a layer of hex27 that do not depend on z are those of quad9, and the weights of its
/// contact points are products: the two solutions are the same.
#[test]
fn a_layer_of_triquadratic_cells_is_the_block_in_the_plane() -> Fallible {
    let solid = slab(CellKind::Hex27, 8)?;
    let mesh = block2(
        "block",
        CellKind::Quad9,
        &uniform(0.0, 40.0, 8),
        &uniform(0.0, 40.0, 8),
    )?;
    let model = Model::new(mesh, PlaneStrain::default())
        .material("block", Elastic::new(130e3, 0.2)?, Integration::Full)?
        .tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
        .contact("block.bottom", "floor", Coulomb::new(1.0)?)?;
    let mut plane = Driver::new(model, Settings::default())?;
    plane.run(&squeeze(), 1, |_, _| {})?;
    for a in solid.contacts() {
        let same = |c: &&moreau::driver::ContactRecord<2>| c.position[0] == a.position[0];
        let b = plane.contacts().iter().find(same).ok_or("no such point")?;
        assert_eq!(a.status, b.status, "at x = {}", a.position[0]);
        let (u, v) = (solid.displacement(a.node), plane.displacement(b.node));
        assert!((u[0] - v[0]).hypot(u[1] - v[1]) < 1e-9 * 28.6e-3);
        let (p, q) = (a.t[0] / a.area, b.t[0] / b.area);
        assert!((p - q).abs() < 1e-8 * 150.0, "{p} {q}");
    }
    Ok(())
}

/// Serendipity hexahedra and quadratic tetrahedra touch in their changed basis.
#[test]
fn quadratic_solids_open_slip_and_stick_as_the_block_does() -> Fallible {
    for kind in [CellKind::Hex20, CellKind::Tet10] {
        let driver = slab(kind, 16)?;
        for (x, u) in [(0.0, 28.60), (5.0, 22.87), (10.0, 16.85), (20.0, 6.457)] {
            for c in driver.contacts().iter().filter(|c| c.position[0] == x) {
                let found = 1e3 * driver.displacement(c.node)[0];
                close(&format!("{kind} u_x({x})"), found, u, 3e-3);
            }
        }
        let sum: nalgebra::Vector3<f64> = driver.contacts().iter().map(|c| c.force).sum();
        close("normal force", sum[1], 2.0 * 2000.0, 1e-10);
        close("tangential force", sum[0], -2.0 * 1405.4, 3e-3);
        for contact in driver.contacts() {
            let expected = match contact.position[0] {
                x if x < 3.1 - 2.5 => Status::Open,
                x if x > 3.1 + 2.5 && x < 29.5 - 2.5 => Status::Slip,
                x if x > 29.5 + 2.5 => Status::Stick,
                _ => contact.status,
            };
            assert_eq!(contact.status, expected, "{kind} {:?}", contact.position);
        }
    }
    Ok(())
}
