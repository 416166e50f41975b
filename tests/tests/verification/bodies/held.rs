//! Contact nodes that a displacement condition holds.

use super::*;

/// A side of the upper body moves as the exact solution does: its corner is a contact node without
/// a freedom of its own.
#[test]
fn a_contact_node_that_is_held_takes_part() -> Fallible {
    for kind in [CellKind::Quad4, CellKind::Quad8] {
        for swapped in [false, true] {
            let stack = Stack {
                swapped,
                ..Stack::<PlaneStrain, 2>::new([kind; 2], [[3, 2], [4, 2]])
            };
            let mut driver = stack.driver(stack.mesh()?, Settings::default())?;
            let e_y = -(1.0 - NU * NU) * PRESSURE / E;
            let e_x = NU * (1.0 + NU) * PRESSURE / E;
            let step = Step::new("press").pressure("upper.top", PRESSURE);
            let mut held = driver.mesh().node_group("upper.left")?;
            held.extend(driver.mesh().node_group("lower.bottom")?);
            let end = prescribed(&driver, &step, &held, |x| {
                [e_x * x[0], e_y * (x[1] + HEIGHT)]
            })?;
            driver.advance(&end)?;
            uniform_stress(&driver, squeezed::<PlaneStrain, 2>(), &stack.what());
            action_is_reaction(&driver, stack.surfaces())?;
        }
    }
    Ok(())
}
