//! A driver's body, its contact surfaces and its quadrature points with their fields, as grids and VTK files; tools, of which
//! a deck says how they look.
//!
//! ```no_run
//! # fn after_an_increment(driver: &moreau::driver::Driver<2>) -> std::io::Result<()> {
//! std::fs::write("body.vtu", moreau::grids::body(driver).vtu())?;
//! # Ok(())
//! # }
//! ```

mod body;
mod points;
mod sheet;
mod surface;
mod tools;
mod touch;

pub use body::body;
use body::body_and_nodes;
pub use points::points;
pub(crate) use sheet::{Pose, Sheet};
pub use surface::surface;
pub(crate) use tools::tools;
pub(crate) use touch::{Touch, touches};

use crate::driver::Driver;
use crate::vtu::three;
pub use crate::vtu::{Array, Grid};

/// A candidate that did not converge: its displacement and what nothing balances.
pub(crate) fn failed<const D: usize>(
    driver: &Driver<D>,
    displacement: &[f64],
    residual: &[f64],
) -> Grid {
    let (mut grid, nodes) = body_and_nodes(driver);
    grid.point_data[0] = vector::<D>("displacement", &nodes, displacement);
    let residual = vector::<D>("out_of_balance", &nodes, residual);
    grid.point_data.push(residual);
    grid
}

/// The body with the motion in which it gives way.
pub(crate) fn mode<const D: usize>(driver: &Driver<D>, motion: &[f64]) -> Grid {
    let (mut grid, nodes) = body_and_nodes(driver);
    grid.cell_data.clear();
    grid.point_data.truncate(1);
    grid.point_data.push(vector::<D>("mode", &nodes, motion));
    grid
}

/// A vector at the nodes of all points, from those at all nodes.
fn vector<const D: usize>(name: &str, nodes: &[usize], values: &[f64]) -> Array {
    let of = |node: &usize| three(&values[D * node..][..D]);
    Array {
        name: name.to_owned(),
        components: 3,
        values: nodes.iter().flat_map(of).collect(),
    }
}
