//! The quadrature points with what was computed there, nothing recovered and nothing averaged, as a
//! grid of one vertex each.

use super::body::{fields, own_fields};
use crate::driver::{Driver, PointState};
use crate::mandel::von_mises;
use crate::vtu::{Array, Grid, three};
use std::collections::BTreeMap;

/// VTK type of a single point.
const VERTEX: u8 = 1;

/// All quadrature points, cell by cell.
pub(in crate::simulation) fn points<const D: usize>(driver: &Driver<D>) -> Grid {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::driver::{Analysis, Model, Settings};
    use crate::laws::{BulkLaw, Elastic, VonMises};
    use crate::mandel::from_matrix;
    use crate::mesh::{
        Axisymmetric, CellKind, Integration, Mesh, PlaneStrain, Solid, block2, block3,
    };
    use crate::simulation::grids::body;
    use nalgebra::Matrix3;

    /// Rounding of sums and of Newton's end.
    const ROUND_OFF: f64 = 1e-11;
    const RULES: [Integration; 3] = [Integration::Reduced, Integration::Full, Integration::BBar];

    /// All nodes of a body displaced as a function says; its volume and its state.
    fn displaced<const D: usize, H: Analysis<D>>(
        (mesh, hypothesis): (&Mesh<D>, H),
        (law, rule): (impl BulkLaw, Integration),
        u: impl Fn(&[f64; D]) -> [f64; 3],
    ) -> (f64, Driver<D>) {
        let all: Vec<usize> = (0..mesh.cell_count()).collect();
        let volume = mesh.measure(&all, &hypothesis);
        let model = Model::new(mesh.clone(), hypothesis)
            .material("b", law, rule)
            .expect("a material");
        let mut driver = Driver::new(model, Settings::default()).expect("a driver");
        let mut loading = driver.applied().clone();
        for (node, x) in mesh.nodes().iter().enumerate() {
            let u = u(x);
            loading
                .displacement
                .extend((0..D).map(|i| (D * node + i, u[i])));
        }
        driver.advance(&loading).expect("converges");
        (volume, driver)
    }

    /// Bodies of every kind of cell, distorted but with straight edges, in which the rules of volumes
    /// and of forces are exact.
    fn plane() -> impl Iterator<Item = Mesh<2>> {
        let kinds = CellKind::ALL.into_iter().filter(|k| k.dimension() == 2);
        kinds.map(|kind| {
            let mesh = block2("b", kind, &[1.0, 1.4, 2.0], &[0.0, 0.5, 1.5]).expect("a mesh");
            let skewed = |x: [f64; 2]| [x[0] + 0.3 * x[1], x[1] + 0.1 * x[0]];
            mesh.map(skewed).expect("a mesh")
        })
    }

    fn space() -> impl Iterator<Item = Mesh<3>> {
        let kinds = CellKind::ALL.into_iter().filter(|k| k.dimension() == 3);
        kinds.map(|kind| {
            let lines = [[0.0, 0.4, 1.0], [0.0, 0.5, 1.5], [0.0, 0.6, 0.9]];
            let mesh = block3("b", kind, &lines[0], &lines[1], &lines[2]).expect("a mesh");
            let skewed = |x: [f64; 3]| [x[0] + 0.3 * x[1], x[1] - 0.2 * x[2], x[2] + 0.1 * x[0]];
            mesh.map(skewed).expect("a mesh")
        })
    }

    fn values<'a>(arrays: &'a [Array], name: &str) -> &'a [f64] {
        let array = arrays.iter().find(|a| a.name == name);
        &array.unwrap_or_else(|| panic!("no {name}")).values
    }

    fn near(a: f64, b: f64, size: f64, what: &str) {
        assert!((a - b).abs() <= ROUND_OFF * size, "{what}: {a} {b}");
    }

    /// Under an affine displacement every point has it, and the one stress that it makes.
    fn uniform<const D: usize, H: Analysis<D>>(
        meshes: impl Iterator<Item = Mesh<D>>,
        hypothesis: &H,
        gradient: Matrix3<f64>,
    ) {
        let law = Elastic::new(1000.0, 0.3).expect("a law");
        let strain = from_matrix(&(0.5 * (gradient + gradient.transpose())));
        let [x, y, z, yz, xz, xy]: [f64; 6] =
            law.respond(&Default::default(), &strain).stress.into();
        let root = 2f64.sqrt();
        let exact = [x, y, z, xy / root, yz / root, xz / root];
        let at = |x: &[f64]| gradient * nalgebra::Vector3::from(three(x));
        for mesh in meshes {
            for rule in RULES {
                let state = ((&mesh, *hypothesis), (law, rule));
                let (volume, driver) = displaced(state.0, state.1, |x| at(x).into());
                let grid = points(&driver);
                let what = format!("{} {rule:?}", mesh.kind(0));
                let sum: f64 = values(&grid.point_data, "volume").iter().sum();
                near(sum, volume, volume, &what);
                let u = values(&grid.point_data, "displacement").chunks_exact(3);
                let stress = values(&grid.point_data, "stress").chunks_exact(6);
                for ((x, u), stress) in grid.points.iter().zip(u).zip(stress) {
                    (0..3).for_each(|i| near(u[i], at(x)[i], 0.1, &what));
                    (0..6).for_each(|i| near(stress[i], exact[i], 100.0, &what));
                }
            }
        }
    }

    #[test]
    fn a_uniform_stress_is_exact_at_every_point_and_their_volumes_are_that_of_the_body() {
        let strained = Matrix3::new(2.0, 5.0, 0.0, -1.0, -3.0, 0.0, 0.0, 0.0, 0.0) * 1e-2;
        uniform(plane(), &PlaneStrain::new(2.5).expect("a slice"), strained);
        // Hoops are strained like radii.
        let strained = Matrix3::new(2.0, 0.0, 0.0, 4.0, -3.0, 0.0, 0.0, 0.0, 2.0) * 1e-2;
        uniform(plane(), &Axisymmetric, strained);
        let strained = Matrix3::new(2.0, 5.0, 1.0, -1.0, -3.0, 2.0, 4.0, 0.0, 1.0) * 1e-2;
        uniform(space(), &Solid, strained);
    }

    /// What the body has in a cell is the mean by volume of what the points have that name it.
    fn means<const D: usize, H: Analysis<D>>(
        meshes: impl Iterator<Item = Mesh<D>>,
        hypothesis: &H,
    ) {
        let law = VonMises::new(1000.0, 0.3, 5.0)
            .and_then(|law| law.with_kinematic(100.0))
            .expect("a law");
        let bent = |x: &[f64; D]| three(&x.map(|x| 0.02 * x * x));
        for mesh in meshes {
            let rule = mesh.kind(0).integration();
            let (_, driver) = displaced((&mesh, *hypothesis), (law.clone(), rule), bent);
            let (body, grid) = (body(&driver).0, points(&driver));
            let volume = values(&grid.point_data, "volume");
            let cell = values(&grid.point_data, "cell");
            let point = values(&grid.point_data, "point");
            assert!(cell.iter().zip(point).is_sorted(), "cell by cell");
            for array in &body.cell_data[1..] {
                let raw = values(&grid.point_data, &array.name);
                let n = array.components;
                for (c, mean) in array.values.chunks_exact(n).enumerate() {
                    let own = (0..cell.len()).filter(|&p| cell[p] == c as f64);
                    let total: f64 = own.clone().map(|p| volume[p]).sum();
                    for (i, &mean) in mean.iter().enumerate() {
                        let sum: f64 = own.clone().map(|p| volume[p] * raw[n * p + i]).sum();
                        near(sum / total, mean, 10.0, &array.name);
                    }
                }
            }
            let flowed = values(&grid.point_data, "equivalent_plastic_strain");
            assert!(flowed.iter().any(|&p| p > 0.0));
            let pushed = values(&grid.point_data, "back_stress").chunks_exact(6);
            for (p, x) in flowed.iter().zip(pushed) {
                assert_eq!(
                    *p > 0.0,
                    x.iter().any(|c| *c != 0.0),
                    "the point of its state"
                );
            }
        }
    }

    #[test]
    fn cells_have_the_means_of_their_points() {
        means(plane(), &PlaneStrain::default());
        means(plane(), &Axisymmetric);
        means(space(), &Solid);
    }
}
