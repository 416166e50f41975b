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
    let vector = |name: &str, values: &[f64]| Array {
        name: name.to_owned(),
        components: 3,
        values: nodes
            .iter()
            .flat_map(|n| three(&values[D * n..][..D]))
            .collect(),
    };
    grid.point_data[0] = vector("displacement", displacement);
    grid.point_data.push(vector("out_of_balance", residual));
    grid
}
