//! The body with its fields as a grid: recovered at points, as means of what was computed in cells.

use crate::driver::{Driver, PointField, PointState, recover};
use crate::mandel::{Sym2, von_mises};
use crate::vtu::{Array, Grid, three, vtk_cell};
use std::f64::consts::FRAC_1_SQRT_2;

/// Components of a stress in the order of VTK.
fn components(stress: &Sym2) -> [f64; 6] {
    let [x, y, z, yz, xz, xy] = (*stress).into();
    let shear = |s: f64| FRAC_1_SQRT_2 * s;
    [x, y, z, shear(xy), shear(yz), shear(xz)]
}

/// Stress, von Mises stress and equivalent plastic strain.
pub(super) fn fields(values: &[(Sym2, f64, f64)]) -> Vec<Array> {
    let scalar = |name: &str, of: &dyn Fn(&(Sym2, f64, f64)) -> f64| Array {
        name: name.to_owned(),
        components: 1,
        values: values.iter().map(of).collect(),
    };
    vec![
        scalar("von_mises", &|v| v.1),
        scalar("equivalent_plastic_strain", &|v| v.2),
        Array {
            name: "stress".into(),
            components: 6,
            values: values.iter().flat_map(|v| components(&v.0)).collect(),
        },
    ]
}

/// The fields that laws have of their own.
pub(super) fn own_fields(fields: &[PointField]) -> impl Iterator<Item = Array> + '_ {
    fields.iter().map(|field| Array {
        name: field.name.clone(),
        components: field.components,
        values: match field.components {
            6 => (field.values.chunks_exact(6))
                .flat_map(|v| components(&Sym2::from_column_slice(v)))
                .collect(),
            _ => field.values.clone(),
        },
    })
}

/// Means by volume of fields in every cell.
fn means<const D: usize>(
    fields: Vec<PointField>,
    points: &[PointState<D>],
    volumes: &[f64],
) -> Vec<PointField> {
    let mean = |field: PointField| {
        let count = field.components;
        let mut means = vec![0.0; count * volumes.len()];
        for (p, values) in points.iter().zip(field.values.chunks_exact(count)) {
            let own = means[count * p.cell..][..count].iter_mut();
            own.zip(values)
                .for_each(|(mean, v)| *mean += v * p.weight / volumes[p.cell]);
        }
        PointField {
            values: means,
            ..field
        }
    };
    fields.into_iter().map(mean).collect()
}

/// Where a node is drawn: under large strains where it is, else where it was, so that its displacement can be
/// magnified.
pub(super) fn place<const D: usize>(driver: &Driver<D>, node: usize) -> [f64; D] {
    let at = driver.mesh().nodes()[node];
    match driver.has_large_strains() {
        true => std::array::from_fn(|i| at[i] + driver.displacement(node)[i]),
        false => at,
    }
}

/// The body with its fields, recovered at points and as means of cells. Nodes where materials meet are a point for each
/// material.
pub fn body<const D: usize>(driver: &Driver<D>) -> Grid {
    body_and_nodes(driver).0
}

/// The grid of a body, and the node of each of its points.
pub(super) fn body_and_nodes<const D: usize>(driver: &Driver<D>) -> (Grid, Vec<usize>) {
    let mesh = driver.mesh();
    let points = driver.points();
    let mut of_laws = driver.fields();
    of_laws.extend(driver.temperatures());
    let recovered = recover(mesh, driver.materials(), &points, &of_laws);
    let values: Vec<_> = recovered
        .stress
        .iter()
        .zip(&recovered.plastic_strain)
        .map(|(stress, &p)| (*stress, von_mises(stress), p))
        .collect();
    let nodes = recovered.nodes;
    let displacement = Array {
        name: "displacement".into(),
        components: 3,
        values: nodes
            .iter()
            .flat_map(|&n| three(driver.displacement(n).as_slice()))
            .collect(),
    };
    // Means by volume of what was computed at the quadrature points.
    let mut means = vec![(Sym2::zeros(), 0.0, 0.0); mesh.cell_count()];
    let mut volumes = vec![0.0; mesh.cell_count()];
    for p in &points {
        let mean = &mut means[p.cell];
        mean.0 += p.stress * p.weight;
        mean.1 += von_mises(&p.stress) * p.weight;
        mean.2 += p.plastic_strain * p.weight;
        volumes[p.cell] += p.weight;
    }
    for (mean, &volume) in means.iter_mut().zip(&volumes) {
        *mean = (mean.0 / volume, mean.1 / volume, mean.2 / volume);
    }
    let of_laws = self::means(of_laws, &points, &volumes);
    let cell = |(c, points): (usize, &Vec<usize>)| vtk_cell(mesh.kind(c), points);
    let numbers = Array {
        name: "cell".into(),
        components: 1,
        values: (0..mesh.cell_count()).map(|c| c as f64).collect(),
    };
    let grid = Grid {
        points: nodes.iter().map(|&n| three(&place(driver, n))).collect(),
        cells: recovered.cells.iter().enumerate().map(cell).collect(),
        point_data: std::iter::once(displacement)
            .chain(fields(&values))
            .chain(own_fields(&recovered.fields))
            .collect(),
        cell_data: std::iter::once(numbers)
            .chain(fields(&means))
            .chain(own_fields(&of_laws))
            .collect(),
    };
    (grid, nodes)
}
