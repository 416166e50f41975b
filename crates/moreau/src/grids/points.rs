//! The quadrature points with what was computed there, nothing recovered and nothing averaged, as a
//! grid of one vertex each.

use super::body::{fields, own_fields};
use crate::driver::{Driver, PointState};
use crate::mandel::von_mises;
use crate::vtu::{Array, Grid, three};
use std::collections::BTreeMap;

/// VTK type of a single point.
const VERTEX: u8 = 1;

/// The quadrature points with what was computed there, cell by cell, as a grid of one vertex each.
pub fn points<const D: usize>(driver: &Driver<D>) -> Grid {
    let mesh = driver.mesh();
    let all = driver.points();
    // Blocks are sets of cells in any order; the points of a cell stay in theirs.
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|&k| all[k].cell);
    let states: Vec<_> = order.iter().map(|&k| all[k]).collect();
    drop(all);
    let mut of_laws = driver.fields();
    of_laws.extend(driver.temperatures());
    for field in &mut of_laws {
        let n = field.components;
        field.values = order
            .iter()
            .flat_map(|&k| field.values[n * k..n * (k + 1)].to_vec())
            .collect();
    }
    let mut shapes = BTreeMap::new();
    let (mut displacement, mut numbers) = (Vec::new(), Vec::new());
    for own in states.chunk_by(|a, b| a.cell == b.cell) {
        let cell = own[0].cell;
        let (kind, count) = (mesh.kind(cell), own.len());
        let shapes = shapes
            .entry((kind, count))
            .or_insert_with(|| kind.shapes_at_points(count).unwrap_or_default());
        let nodes = mesh.cell_nodes(cell).iter();
        let values: Vec<_> = nodes.map(|&n| driver.displacement(n)).collect();
        for shape in shapes.iter() {
            let mut u = [0.0; 3];
            for (n, value) in shape.iter().zip(&values) {
                u.iter_mut().zip(value).for_each(|(u, v)| *u += n * v);
            }
            displacement.extend(u);
        }
        numbers.extend((0..count).map(|k| k as f64));
    }
    let at = |(p, u): (&PointState<D>, &[f64])| match driver.has_large_strains() {
        true => three(&std::array::from_fn::<f64, D, _>(|i| p.position[i] + u[i])),
        false => three(&p.position),
    };
    let points = states.iter().zip(displacement.chunks_exact(3));
    let points = points.map(at).collect();
    let array = |name: &str, components, values| Array {
        name: String::from(name),
        components,
        values,
    };
    let of = |value: &dyn Fn(&PointState<D>) -> f64| states.iter().map(value).collect();
    let shown = |p: &PointState<D>| (p.stress, von_mises(&p.stress), p.plastic_strain);
    let mut data = vec![array("displacement", 3, displacement)];
    data.extend(fields(&states.iter().map(shown).collect::<Vec<_>>()));
    data.extend(own_fields(&of_laws));
    data.push(array("cell", 1, of(&|p| p.cell as f64)));
    data.push(array("point", 1, numbers));
    data.push(array("volume", 1, of(&|p| p.weight)));
    Grid {
        points,
        cells: (0..states.len())
            .map(|k| (vec![k as i64], VERTEX))
            .collect(),
        point_data: data,
        cell_data: Vec::new(),
    }
}
