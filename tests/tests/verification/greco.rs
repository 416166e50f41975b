//! The block of the GRECO group: what neither cells nor steps may change; its published values are a
//! case of the report.

use crate::close;
use moreau::driver::Settings;
use moreau::mesh::CellKind;
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
