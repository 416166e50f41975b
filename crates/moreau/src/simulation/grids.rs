//! A body, its contact surfaces, its tools and its quadrature points with their fields, as grids; not the files.

mod body;
mod points;
mod surface;
mod tools;

pub(super) use body::body;
pub(super) use points::points;
pub(super) use surface::surface;
pub(crate) use tools::tools;

use crate::driver::Driver;
use crate::vtu::{Array, Grid, three};

/// A candidate that did not converge: its displacement and what nothing balances.
pub(super) fn failed<const D: usize>(
    driver: &Driver<D>,
    displacement: &[f64],
    residual: &[f64],
) -> Grid {
    let (mut grid, nodes) = body(driver);
    grid.point_data[0] = vector::<D>("displacement", &nodes, displacement);
    let residual = vector::<D>("out_of_balance", &nodes, residual);
    grid.point_data.push(residual);
    grid
}

/// The body with the motion in which it gives way.
pub(super) fn mode<const D: usize>(driver: &Driver<D>, motion: &[f64]) -> Grid {
    let (mut grid, nodes) = body(driver);
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
