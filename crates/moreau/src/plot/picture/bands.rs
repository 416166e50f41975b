//! Cells filled with the colours of a field: patches of a reference cell, bands in a patch; not
//! their place in a mesh.

use crate::mesh::{CellKind, Element, Quad4, Quad8, Quad9, Tri3, Tri6};
use crate::plot::clip::cut;
use crate::plot::colour::{LEVELS, level};
use crate::plot::pen::Pen;

/// Bands of colour in half a patch.
const MOST_BANDS: usize = 5;

/// Σ N_a v_a.
pub(super) fn combine(shape: &[f64], nodes: &[usize], value: impl Fn(usize) -> f64) -> f64 {
    shape.iter().zip(nodes).map(|(s, &n)| s * value(n)).sum()
}

/// Shape functions of a plane cell.
fn shape(kind: CellKind, xi: [f64; 2]) -> Vec<f64> {
    match kind {
        CellKind::Tri3 => Tri3::shape(xi).to_vec(),
        CellKind::Tri6 => Tri6::shape(xi).to_vec(),
        CellKind::Quad4 => Quad4::shape(xi).to_vec(),
        CellKind::Quad8 => Quad8::shape(xi).to_vec(),
        CellKind::Quad9 => Quad9::shape(xi).to_vec(),
        // A plane mesh has no such cells.
        _ => Vec::new(),
    }
}

/// A reference cell divided into patches.
pub(super) struct Table {
    /// Shape functions at the corners of the patches.
    pub(super) corners: Vec<Vec<f64>>,
    /// Corners of each patch, three or four.
    pub(super) patches: Vec<Vec<usize>>,
}

impl Table {
    pub(super) fn new(kind: CellKind, [n, m]: [usize; 2]) -> Self {
        let triangle = kind.corner_count() == 3;
        let mut corners = Vec::new();
        let mut patches = Vec::new();
        for j in 0..=m {
            for i in 0..=n {
                let [s, t] = [i as f64 / n as f64, j as f64 / m as f64];
                let xi = if triangle {
                    [s, t]
                } else {
                    [2.0 * s - 1.0, 2.0 * t - 1.0]
                };
                corners.push(shape(kind, xi));
            }
        }
        let at = |i: usize, j: usize| j * (n + 1) + i;
        for j in 0..m {
            for i in 0..n {
                let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                if !triangle || i + j + 1 < n {
                    patches.push(corners.to_vec());
                } else if i + j + 1 == n {
                    // On the slanted side.
                    patches.push(vec![corners[0], corners[1], corners[3]]);
                }
            }
        }
        Self { corners, patches }
    }
}

/// A place on paper and its part of the colour bar.
pub(super) type Corner = [f64; 3];

/// Fills a patch, linear on triangles, in the colours of its levels.
pub(super) fn fill_bands(pens: &mut [Pen], patch: &[Corner]) {
    let levels = || patch.iter().map(|c| level(c[2]));
    let (lowest, highest) = (levels().min().unwrap_or(0), levels().max().unwrap_or(0));
    if lowest == highest {
        polygon(&mut pens[lowest], patch);
    } else if let &[a, b, c, d] = patch {
        // The diagonal along which the values differ less follows the bands.
        if (a[2] - c[2]).abs() < (b[2] - d[2]).abs() {
            fill_bands(pens, &[a, b, c]);
            fill_bands(pens, &[a, c, d]);
        } else {
            fill_bands(pens, &[a, b, d]);
            fill_bands(pens, &[b, c, d]);
        }
    } else {
        // Where a field is steep, bands of several levels are still narrow.
        let stride = (highest + 1 - lowest).div_ceil(MOST_BANDS);
        for k in (lowest..=highest).step_by(stride) {
            let bounds = [k, k + stride].map(|k| k as f64 / LEVELS as f64);
            let above = cut(patch, |c| c[2] - bounds[0]);
            let band = cut(&above, |c| bounds[1] - c[2]);
            polygon(&mut pens[(k + stride / 2).min(highest)], &band);
        }
    }
}

fn polygon(pen: &mut Pen, corners: &[Corner]) {
    if corners.len() > 2 {
        pen.polyline(corners.iter().map(|&[x, y, _]| [x, y]));
        pen.close();
    }
}
