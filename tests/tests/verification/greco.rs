//! The block of the GRECO group: opening, slip and stick at once, with a coefficient of friction of
//! one; not a case that a step size or a penalty could influence.
//!
//! Source: M. Raous, P. Chabrand and F. Lebon, *Journal de Mécanique Théorique et Appliquée*,
//! special issue (1988) 111-128; also SSNV128 of Code_Aster's validation manual.

use crate::close;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic, Status};
use moreau::mesh::{CellKind, Integration, PlaneStrain, Solid, block2, block3, uniform};
use verification::problems::Fallible;

fn block(kind: CellKind, n: usize, settings: Settings<2>) -> Fallible<Driver<2>> {
    let lines = uniform(0.0, 40.0, n);
    let rule = if kind == CellKind::Quad4 {
        Integration::Full
    } else {
        Integration::Reduced
    };
    let model = Model::new(
        block2("block", kind, &lines, &lines)?,
        PlaneStrain::default(),
    )
    .material("block", Elastic::new(130e3, 0.2)?, rule)?
    .tool("floor", Plane::new([0.0, 0.0], [0.0, 1.0])?)?
    .contact("block.bottom", "floor", Coulomb::new(1.0)?)?;
    Ok(Driver::new(model, settings)?)
}

fn squeeze() -> Step<2> {
    Step::new("squeeze")
        .fix("block.right", &[Axis::X])
        .pressure("block.top", 50.0)
        .pressure("block.left", 150.0)
}

/// Slip of the floor's side at x, in micrometres.
fn slip(driver: &Driver<2>, x: f64) -> f64 {
    let at = |c: &&moreau::driver::ContactRecord<2>| (c.position[0] - x).abs() < 1e-9;
    let contact = driver.contacts().iter().find(at);
    1e3 * contact.map_or(f64::NAN, |c| driver.displacement(c.node)[0])
}

#[test]
fn raous_chabrand_lebon_block_opens_slips_and_sticks() -> Fallible {
    let mut driver = block(CellKind::Quad8, 16, Settings::default())?;
    let reports = driver.run(&squeeze(), 1, |_, _| {})?;
    // Published, as the mean of several codes, gated at 5 %; and converged.
    let published = [
        (0.0, 28.6),
        (1.25, 27.2),
        (5.0, 22.8),
        (7.5, 19.8),
        (11.25, 15.0),
    ];
    let converged = [
        (0.0, 28.60),
        (1.25, 27.22),
        (5.0, 22.87),
        (7.5, 19.81),
        (10.0, 16.85),
        (11.25, 15.41),
        (15.0, 11.33),
        (20.0, 6.457),
    ];
    for (x, u) in published {
        close(&format!("published u_x({x})"), slip(&driver, x), u, 5e-2);
    }
    for (x, u) in converged {
        close(&format!("u_x({x})"), slip(&driver, x), u, 3e-3);
    }
    let sum: nalgebra::Vector2<f64> = driver.contacts().iter().map(|c| c.t).sum();
    close("normal force", sum[0], 2000.0, 1e-10);
    close("tangential force", sum[1], -1405.4, 3e-3);
    // Open up to 3.1, slip up to 29.5, stick beyond: to half an edge.
    for contact in driver.contacts() {
        let expected = match contact.position[0] {
            x if x < 3.1 - 1.25 => Status::Open,
            x if x > 3.1 + 1.25 && x < 29.5 - 1.25 => Status::Slip,
            x if x > 29.5 + 1.25 => Status::Stick,
            _ => contact.status,
        };
        assert_eq!(contact.status, expected, "at x = {}", contact.position[0]);
        assert!(contact.t[1].abs() <= contact.t[0] * (1.0 + 1e-10) && contact.t[0] >= 0.0);
    }
    assert!(reports[0].certificate.penetration < 1e-12);
    assert!(reports[0].relative_gap() < 1e-10);
    Ok(())
}

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
