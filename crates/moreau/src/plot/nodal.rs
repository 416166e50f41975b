//! From quadrature points to nodes: fits and averages; not a recovery that satisfies equilibrium.

use crate::driver::PointState;
use crate::mesh::Mesh;
use std::collections::BTreeMap;

/// Least determinant of the moments of a cell's points over their squared trace for which a slope
/// can be fitted.
const COLLINEAR: f64 = 1e-9;

/// A point of a cell: position, weight and value.
type Known = ([f64; 2], f64, f64);

/// Nodal values of a quantity known at quadrature points: extrapolated in each cell from its
/// points (least-squares linear fit a cell), averaged over the cells of a node weighted by volume,
/// clipped to the range of the raw values.
///
/// A linear quantity is met exactly at every node where it does not exceed its range at the
/// points. A cell with fewer than three points, or with all of them in a line, counts with its
/// mean. Points with a value that is not finite and points of cells that the mesh does not have
/// are ignored; a node none of whose cells has a point is NaN.
pub fn nodal_average(
    mesh: &Mesh<2>,
    points: &[PointState<2>],
    value: impl Fn(&PointState<2>) -> f64,
) -> Vec<f64> {
    let mut cells: BTreeMap<usize, Vec<Known>> = BTreeMap::new();
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for point in points {
        let v = value(point);
        let [x, y] = point.position;
        let finite = [v, x, y, point.weight].iter().all(|v| v.is_finite());
        if finite && point.weight > 0.0 && point.cell < mesh.cell_count() {
            range = [range[0].min(v), range[1].max(v)];
            cells
                .entry(point.cell)
                .or_default()
                .push((point.position, point.weight, v));
        }
    }
    let mut sums = vec![(0.0, 0.0); mesh.nodes().len()];
    for (cell, known) in &cells {
        let volume: f64 = known.iter().map(|k| k.1).sum();
        let fit = Fit::new(known);
        for &node in mesh.cell_nodes(*cell) {
            sums[node].0 += volume * fit.at(mesh.nodes()[node]);
            sums[node].1 += volume;
        }
    }
    let clipped = |(sum, volume): (f64, f64)| {
        if volume > 0.0 {
            (sum / volume).max(range[0]).min(range[1])
        } else {
            f64::NAN
        }
    };
    sums.into_iter().map(clipped).collect()
}

/// A linear function: the value at the centre and a slope.
struct Fit {
    centre: [f64; 2],
    mean: f64,
    slope: [f64; 2],
}

impl Fit {
    /// The least-squares fit to some points, at least one.
    fn new(known: &[Known]) -> Self {
        let count = known.len() as f64;
        let centre = [0, 1].map(|i| known.iter().map(|k| k.0[i]).sum::<f64>() / count);
        let mean = known.iter().map(|k| k.2).sum::<f64>() / count;
        let (mut xx, mut xy, mut yy, mut xv, mut yv) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (x, _, v) in known {
            let (x, y, v) = (x[0] - centre[0], x[1] - centre[1], v - mean);
            xx += x * x;
            xy += x * y;
            yy += y * y;
            xv += x * v;
            yv += y * v;
        }
        let det = xx * yy - xy * xy;
        let slope = if known.len() >= 3 && det > COLLINEAR * (xx + yy) * (xx + yy) {
            [(yy * xv - xy * yv) / det, (xx * yv - xy * xv) / det]
        } else {
            [0.0; 2]
        };
        Self {
            centre,
            mean,
            slope,
        }
    }

    fn at(&self, x: [f64; 2]) -> f64 {
        self.mean
            + (0..2)
                .map(|i| self.slope[i] * (x[i] - self.centre[i]))
                .sum::<f64>()
    }
}
