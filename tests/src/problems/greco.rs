//! The block of the GRECO group: an elastic square pressed on a rigid floor from above and from the
//! side, with a coefficient of friction of one; not what is published of it.

use crate::problems::Fallible;
use moreau::contact::Plane;
use moreau::driver::{Axis, Driver, Model, Settings, Step};
use moreau::laws::{Coulomb, Elastic};
use moreau::mesh::{CellKind, Integration, PlaneStrain, block2, uniform};

/// Half of the block, n × n cells.
///
/// # Errors
/// Those of [`Driver::new`].
pub fn block(kind: CellKind, n: usize, settings: Settings<2>) -> Fallible<Driver<2>> {
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

/// Pressed by 50 MPa from above and by 150 MPa from the side.
pub fn squeeze() -> Step<2> {
    Step::new("squeeze")
        .fix("block.right", &[Axis::X])
        .pressure("block.top", 50.0)
        .pressure("block.left", 150.0)
}

/// Slip of the floor's side at x \[µm\]; NaN where no contact point is.
pub fn slip(driver: &Driver<2>, x: f64) -> f64 {
    let at = |c: &&moreau::driver::ContactRecord<2>| (c.position[0] - x).abs() < 1e-9;
    let contact = driver.contacts().iter().find(at);
    1e3 * contact.map_or(f64::NAN, |c| driver.displacement(c.node)[0])
}
